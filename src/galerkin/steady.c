/* steady.c - the steps of steady.h, which generated code makes, one or many in a row. */
#include "galerkin/step.h"

static void set_folded(galerkin *w)
{
    if (!w->folded || w->folded_h == w->field.h) return;
    tvi_galerkin_coefficients_fold(&w->coefficients, &w->field.nodes, w->folded);
    w->folded_h = w->field.h;
}

long tvi_galerkin_make_steadily(galerkin *w, const tvi_row *row, const tvi_origin *origin, const tvi_run_state *now,
                                galerkin_outcome *to)
{
    galerkin_predictor *before = &w->predictor;
    galerkin_history *last = before->last;
    to->impulses = before->impulses;
    to->turn = last->turn;
    to->last = (galerkin_trial){.pace = galerkin_pace_before(w)};
    to->leads = last->leads && to->known > 0;
    to->count = to->factors = 0;
    set_folded(w);
    const long made = w->field.loops->steady(&w->frame, row, origin, now, to);
    if (made < 1) {
        to->count = to->tried.count;
        to->factors = to->tried.factors;
        return 0;
    }
    last->turn = (int)((last->turn + made - 1) % GALERKIN_TURNS);
    if (made > 1) last->h = row->h;
    tvi_galerkin_remember(before, row->h, to->t, to->last.pace);
    last->leads = to->leads;
    return made;
}

void tvi_galerkin_count(const galerkin *w, const galerkin_outcome *to, tvi_stats *stats)
{
    stats->passes += to->count;
    stats->force_evaluations += to->count * w->field.points;
    stats->factorisations += to->factors * w->field.points;
}

/* Of the last step of a row, by its impulses, from where it ended. */
static double tail_of_last(galerkin *w, const tvi_row *row, const tvi_run_state *now)
{
    galerkin_nodes nodes = w->field.nodes;
    const galerkin_sums *sums = &w->motion.sums;
    const bool is_separable = w->motion.is_separable;
    double *q = w->begun, *p = q + w->n;
    nodes.impulse = tvi_galerkin_impulses(&w->predictor, 0);
    w->field.loops->integrate(&nodes, &w->coefficients.weights, sums);
    if (!is_separable) galerkin_end(&nodes, sums, w->n, &row->by);
    for (int i = 0; i < w->n; i++) {
        if (is_separable) row->by.dp[i] = sums->once[i];
        p[i] = now->p[i] - row->by.dp[i];
        if (is_separable) row->by.dq[i] = nodes.scale[i] * (p[i] + sums->twice[i]);
        q[i] = now->q[i] - row->by.dq[i];
    }
    return tvi_galerkin_tail(w, &(tvi_origin){.q = q, .p = p}, row->by.dp);
}

long tvi_galerkin_run(void *work, const tvi_row *row, const tvi_run_state *now, tvi_stats *stats)
{
    galerkin *w = work;
    const tvi_origin origin = {now->q[w->n], now->q_low[w->n], now->q, now->q_low, now->p, now->p_low};
    galerkin_outcome to = {.largest_tail = stats->largest_tail};
    tvi_stats counted = *stats;
    if (!tvi_galerkin_is_steady(w) || w->field.system->uses_time) return 0;
    tvi_galerkin_set_size(w, row->h);
    row->by.dq[w->n] = row->h;
    if (tvi_galerkin_begin(w, &origin, &to.known, &counted) != TVI_OK) return 0;
    const long made = tvi_galerkin_make_steadily(w, row, &origin, now, &to);
    if (made < 1) return 0;
    *stats = counted;
    tvi_galerkin_count(w, &to, stats);
    stats->residual = sqrt(to.last.size);
    stats->tail = tail_of_last(w, row, now);
    stats->largest_tail = to.largest_tail;
    return made;
}
