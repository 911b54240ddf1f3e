/* steady.c - the steps of steady.h, which generated code makes, one or many in a row. */
#include "galerkin/step.h"

bool tvi_galerkin_make_steadily(galerkin *w, const tvi_origin *origin, galerkin_outcome *to)
{
    const galerkin_predictor *before = &w->predictor;
    w->field.nodes.impulse = tvi_galerkin_impulses(before, 1);
    for (int i = 0; i < 2; i++) to->impulses[i] = tvi_galerkin_impulses(before, -i);
    to->passes.count = 0;
    galerkin_begin_passes(w, &to->passes);
    to->factors = 0;
    return w->field.loops->steady(&w->frame, origin, to);
}

static bool sums_are_finite(int count, const double *x, const double *dx)
{
    uint64_t any = 0;
    for (int i = 0; i < count; i++) any |= tvi_infinite_bit(x[i] + dx[i]);
    return !(any >> 63);
}

/* One by one where they are few, as they were just stored: a vector of them would wait for that. */
static void add(int count, double *restrict x, double *restrict low, const double *restrict dx)
{
    const bool few = count < 8;
    for (int i = 0; i < count; i++) {
        x[i] = tvi_add_compensated(x[i], &low[i], dx[i]);
        if (few) __asm__("" : : : "memory");
    }
}

static bool is_sure(const galerkin_outcome *to, const tvi_sure *sure)
{
    return to->tail <= sure->tail && to->passes.count <= sure->passes;
}

/* Whether the step that begins at t is one of these. */
static bool is_steady(const galerkin *w, double h, double t)
{
    double part;
    return h == w->field.h && !w->field.system->uses_time && w->options->passes != TVI_PREDICT_ONLY &&
           tvi_galerkin_can_extrapolate(&w->predictor, &w->field, t, &part) &&
           tvi_galerkin_is_steady(&w->predictor, &w->field, part);
}

long tvi_galerkin_run(void *work, const tvi_row *row, const tvi_run_state *now, tvi_stats *stats)
{
    galerkin *w = work;
    const int n = w->n;
    long made = 0, passes = 0;
    double residual = 0;
    galerkin_outcome to;
    if (!w->field.loops->steady || !is_steady(w, row->h, now->q[n])) return 0;
    to.dq = row->dq;
    to.dp = row->dp;
    row->dq[n] = row->h;
    for (; made < row->steps; made++) {
        const tvi_origin origin = {now->q[n], now->q_low[n], now->q, now->q_low, now->p, now->p_low};
        if (!tvi_galerkin_make_steadily(w, &origin, &to) || !is_sure(&to, &row->sure)) break;
        if (!sums_are_finite(n + 1, now->q, row->dq) || !sums_are_finite(n, now->p, row->dp)) break;
        add(n + 1, now->q, now->q_low, row->dq);
        add(n, now->p, now->p_low, row->dp);
        tvi_galerkin_remember(&w->predictor, row->h, origin.t, to.passes.slowest);
        passes += to.passes.count;
        residual = to.passes.size;
        stats->tail = to.tail;
        stats->factorisations += to.factors * w->field.points;
        stats->largest_tail = tvi_larger(to.tail, stats->largest_tail);
    }
    if (made > 0) stats->residual = sqrt(residual);
    stats->passes += passes;
    stats->force_evaluations += passes * w->field.points;
    return made;
}
