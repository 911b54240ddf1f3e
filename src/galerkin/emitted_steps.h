/* emitted_steps.h - whole steps of generated code: a step of steady.h, by the passes of emitted_passes.h. */
#ifndef TVI_SRC_GALERKIN_EMITTED_STEPS_H
#define TVI_SRC_GALERKIN_EMITTED_STEPS_H

#include "galerkin/emitted_passes.h"

/* The step of steady.h. Small blocks are the function's own, where the compiler keeps them in registers. */
enum { STEADY_MOST = 4096 };

JET_INLINE void steady_start(const galerkin_frame *frame, const galerkin_nodes *nodes, const galerkin_motion *motion,
                             const tvi_origin *origin, int lanes)
{
    if (motion->is_separable) start_drifting_lanes(nodes, frame->c, origin, frame->drift, frame->drift_low, lanes);
    else start_lanes(nodes, motion->n, origin, lanes);
}

JET_INLINE void steady_predict(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                               const double *const impulses[], int fit, int lanes)
{
    const double *table = frame->extrapolation[fit];
    const int steps = GALERKIN_FITS - fit;
    if (form->lagrangian) lagrangian_predict(form->lagrangian, *frame->h, steps, table, impulses);
    else if (form->hamiltonian) hamiltonian_predict(form->hamiltonian, *frame->h, steps, table, impulses);
    else predict_lanes(nodes, steps, table, impulses, lanes);
}

/* The increments of a step, by its impulses. */
JET_INLINE void steady_sum(const galerkin_frame *frame, galerkin_nodes nodes, double *impulses,
                           const galerkin_motion *motion, const tvi_row *row, int lanes)
{
    nodes.impulse = impulses;
    integrate_lanes(&nodes, frame->weights, &motion->sums, lanes);
    if (motion->is_separable) end_drifting(&nodes, &motion->sums, frame->drift, frame->drift_low, &row->by);
    else galerkin_end(&nodes, &motion->sums, motion->n, &row->by);
}

JET_INLINE double steady_tail(const galerkin_frame *frame, galerkin_motion motion, const tvi_row *row,
                              const tvi_origin *origin, double known, int lanes)
{
    motion.q = origin->q;
    motion.p = origin->p;
    motion.dp = row->by.dp;
    return lanes < 2 || galerkin_tail_is_at_most(&motion, known) ? known : tail(&motion, frame->share, frame->ratio);
}

/* Few unknowns whose nodes are one vector, or fewer whose nodes are two short ones, are predicted for the next step,
 * and its first pass begins, before the increments of this one are added: that pass waits for them at its end. Passes
 * that are folded (folded.h) do not: the increments are summed behind the first of these, where both wait for less than
 * in any other order. Other steps are made one by one. */
#define STEADY_LEADS(unknowns, lanes)                                                                                  \
    ((unknowns) <= GALERKIN_FEW && (lanes) <= ((unknowns) <= GALERKIN_FEWEST && (int)WIDEST < 8 ? 2 : 1) * (int)WIDEST)

/* Leaves behind the impulses of this step, which are `next` then, what the next one begins with. */
JET_INLINE void steady_lead(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form, int fit,
                            const double *last, const double *drift, double *next, galerkin_folding *folding, int lanes)
{
    const int unknowns = nodes->unknowns, numbers = unknowns * lanes;
    const double *const impulses[] = {nodes->impulse, last};
    copy_lanes(next, nodes->impulse, unknowns, lanes);
    predict_steps(nodes, 2, frame->extrapolation[fit] + 2 * lanes * lanes, impulses, drift, lanes);
    copy_lanes(next + numbers, nodes->x, unknowns, lanes);
    if (!form->folds) return;
    set_next_origin(nodes, frame->c, drift, folding->origin);
    copy_lanes(next + 2 * numbers, (const double *)folding->origin, unknowns, lanes);
}

/* The impulses in a turn, or one beside those that there are. */
JET_INLINE double *steady_turn(double *const *impulses, int turn)
{
    return impulses[turn < 0 ? GALERKIN_TURNS - 1 : turn < GALERKIN_TURNS ? turn : 0];
}

JET_INLINE long steady_lanes(const galerkin_frame *frame, galerkin_nodes *nodes, const galerkin_motion *motion,
                             const steady_form *form, const tvi_row *row, const tvi_origin *origin,
                             const tvi_run_state *now, galerkin_outcome *to, int lanes)
{
    const bool leads = form->drive && STEADY_LEADS(nodes->unknowns, lanes);
    const int numbers = nodes->unknowns * lanes;
    double *const *const ring = to->impulses;
    int turn = to->turn;
    double *before = steady_turn(ring, turn - 1), *last = steady_turn(ring, turn), *next = steady_turn(ring, turn + 1);
    const double *const impulses[] = {last, before}, *drift = motion->is_separable ? frame->drift : NULL;
    galerkin_trial tried = {.pace = to->last.pace};
    galerkin_folding folding;
    int known = to->known;
    long made = 0;
    if (!leads) nodes->impulse = next;
    steady_start(frame, nodes, motion, origin, lanes);
    if (to->known < 1) copy_lanes(nodes->x, frame->nodes->x, nodes->x == frame->nodes->x ? 0 : form->rows, lanes);
    else if (to->leads) copy_lanes(nodes->x, last + numbers, nodes->unknowns, lanes);
    else steady_predict(frame, nodes, form, impulses, galerkin_fit(to->known, &tried.pace, *frame->rough), lanes);
    if (form->folds && to->leads) copy_lanes((double *)folding.origin, last + 2 * numbers, nodes->unknowns, lanes);
    else if (form->folds) set_origin(nodes, folding.origin);
    bool begins = steady_begin_first(frame, nodes, form, &tried, &folding, lanes) &&
                  steady_begin_others(frame, nodes, form, &tried, &folding, lanes);
    while (begins) {
        galerkin_set_sizes(nodes, motion->n);
        const bool ends = steady_passes(frame, nodes, form, &folding, &tried, lanes);
        tried.factors = form->lagrangian ? form->lagrangian->factors : 0;
        if (!ends) break;
        if (!form->folds) steady_sum(frame, *nodes, nodes->impulse, motion, row, lanes);
        if (leads) {
            const int fit = galerkin_fit(known + 1, &tried.pace, *frame->rough);
            steady_lead(frame, nodes, form, fit, known > 0 ? last : nodes->impulse, drift, next, &folding, lanes);
            begins = made + 1 < row->steps && steady_begin_first(frame, nodes, form, &tried, &folding, lanes);
        }
        if (form->folds) {
            steady_sum(frame, *nodes, next, motion, row, lanes);
            begins = begins && steady_begin_others(frame, nodes, form, &tried, &folding, lanes);
        }
        tried.tail = steady_tail(frame, *motion, row, origin, now ? galerkin_known_tail(row, to) : 0, lanes);
        const double t = now ? now->q[motion->n] : origin->t;
        if (now && !galerkin_advance(motion->n, row, now, &tried)) break;
        made++;
        known += known < 2;
        to->t = t;
        to->last = tried;
        to->count += tried.count;
        to->factors += tried.factors;
        to->largest_tail = tvi_larger(tried.tail, to->largest_tail);
        turn = turn + 1 < GALERKIN_TURNS ? turn + 1 : 0;
        before = last, last = next, next = steady_turn(ring, turn + 1);
        if (!leads) break;
        steady_start(frame, nodes, motion, origin, lanes);
    }
    to->turn = turn;
    to->known = known;
    to->leads = leads && (made > 0 || to->leads);
    if (made == 0) to->tried = tried;
    return made;
}

/* The rows of a block between its first ones, which are set anew, and `kept`. */
JET_INLINE void keep_rows(double *own, const double *block, int first, int kept, int lanes)
{
    for (int i = first * lanes; i < kept * lanes; i++) own[i] = block[i];
}

/* The state of few components, and what a step adds to it, are the function's own, too. */
JET_INLINE long steady_own(const galerkin_frame *frame, galerkin_nodes *nodes, const galerkin_motion *motion,
                           const steady_form *form, const tvi_row *of, const tvi_origin *begin,
                           const tvi_run_state *now, galerkin_outcome *to, int lanes)
{
    double q[GALERKIN_OWN + 1], q_low[GALERKIN_OWN + 1], p[GALERKIN_OWN], p_low[GALERKIN_OWN];
    double dq[GALERKIN_OWN + 1], dp[GALERKIN_OWN], dq_low[GALERKIN_OWN + 1], dp_low[GALERKIN_OWN];
    const int n = motion->n, numbers = now ? n + 1 : n;
    const tvi_run_state own = {q, q_low, p, p_low};
    const tvi_origin origin = {begin->t, begin->t_low, q, q_low, p, p_low};
    const tvi_row row = {of->h, of->steps, of->sure, of->time, of->t_end, {dq, dp, dq_low, dp_low}};
    keep_rows(q, begin->q, 0, numbers, 1);
    keep_rows(q_low, begin->q_low, 0, numbers, 1);
    keep_rows(p, begin->p, 0, n, 1);
    keep_rows(p_low, begin->p_low, 0, n, 1);
    dq[n] = of->h;
    dq_low[n] = 0;
    const long made = steady_lanes(frame, nodes, motion, form, &row, &origin, now ? &own : NULL, to, lanes);
    const int increments = made > 0 ? n : 0;
    keep_rows(of->by.dq, dq, 0, increments, 1);
    keep_rows(of->by.dp, dp, 0, increments, 1);
    keep_rows(of->by.dq_low, dq_low, 0, increments, 1);
    keep_rows(of->by.dp_low, dp_low, 0, increments, 1);
    if (!now) return made;
    keep_rows(now->q, q, 0, n + 1, 1);
    keep_rows(now->q_low, q_low, 0, n + 1, 1);
    keep_rows(now->p, p, 0, n, 1);
    keep_rows(now->p_low, p_low, 0, n, 1);
    return made;
}

/* All that changes is the function's own, where the compiler keeps it in registers. */
JET_INLINE long steady_few(const galerkin_frame *of, galerkin_nodes *nodes, galerkin_motion motion,
                           const steady_form *form, const tvi_row *row, const tvi_origin *origin,
                           const tvi_run_state *now, galerkin_outcome *to, int lanes)
{
    enum { BLOCK = GALERKIN_FEW * TVI_GALERKIN_MAX_LANES };
    _Alignas(64) double high[BLOCK], base[BLOCK], impulse[BLOCK];
    double start[GALERKIN_FEW], inverse_size[GALERKIN_FEW], drift[GALERKIN_FEW], drift_low[GALERKIN_FEW];
    double once[GALERKIN_FEW], twice[GALERKIN_FEW], last[GALERKIN_FEW], reach[GALERKIN_FEW];
    double once_low[GALERKIN_FEW], twice_low[GALERKIN_FEW];
    double share[GALERKIN_FEW], ratio[GALERKIN_FEW];
    galerkin_frame frame = *of;
    nodes->high = high;
    nodes->base = base;
    nodes->impulse = impulse;
    nodes->start = start;
    nodes->inverse_size = inverse_size;
    motion.sums = (galerkin_sums){once, twice, last, reach, once_low, twice_low};
    frame.drift = drift;
    frame.drift_low = drift_low;
    frame.share = share;
    frame.ratio = ratio;
    const long made = motion.n <= GALERKIN_OWN
                          ? steady_own(&frame, nodes, &motion, form, row, origin, now, to, lanes)
                          : steady_lanes(&frame, nodes, &motion, form, row, origin, now, to, lanes);
    keep_rows(of->drift, drift, 0, motion.is_separable ? motion.n : 0, 1);
    keep_rows(of->drift_low, drift_low, 0, motion.is_separable ? motion.n : 0, 1);
    return made;
}

#endif
