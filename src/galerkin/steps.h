/* steps.h - Makes the steps of the Galerkin curve (docs/method.md section 5), in one text. The library compiles it for
 * any system, and for several members, with the loops of its tables (galerkin.c, batch.c). Generated code compiles it
 * for one system, whose sizes are constants (generated_*.h). */
#ifndef TVI_SRC_GALERKIN_STEPS_H
#define TVI_SRC_GALERKIN_STEPS_H

#include "algebra/passes.h"
#include "galerkin/blocks.h"
#include "tvi.h"
#include "vector.h"

/* The data that all steps share. */
typedef struct galerkin_frame {
    const galerkin_loops *loops;
    const galerkin_nodes *nodes;
    const galerkin_tail_inputs *tail_inputs;
    const galerkin_weights *weights;
    const tvi_passes_rule *rule;
    const double *matrix, *c;
    const double *from_two, *from_last; /* of galerkin_extrapolation */
    /* The size of a first movement beyond which the last step alone predicts better. */
    double rough_limit;
    double *drift, *drift_low; /* [unknowns][width] h M^-1 p0 of a separable system, in two parts */
    double *share, *ratio;     /* [n][width] of the tail */
    double *const *impulses;   /* [GALERKIN_RING] of steps; in the history */
    void *own;                 /* of the form of the field: lagrangian_passes, hamiltonian_passes */
    const double *h;           /* the size of the step */
} galerkin_frame;

/* The functions that evaluate the field for the passes of a step. */
typedef struct {
    /* Makes the next pass from the current unknowns. moved [width] is measured as in loops.h. A roundoff that is not
     * NULL asks, for passes that no longer shrink, for the movement by the roundoff of a pass, if it can be
     * measured; `moved` then has the movement of the pass before. */
    tvi_status (*pass)(void *work, const galerkin_nodes *nodes, double moved[], double *roundoff);
    void (*predict)(void *work, const galerkin_nodes *nodes, const galerkin_extrapolation *by);
    void (*made)(void *work); /* called after each step of a run; NULL: nothing */
    void *work;
} galerkin_solver;

/* The passes of one member in a step. */
typedef struct {
    tvi_status status; /* TVI_ENOCONV if they are stuck, or too many */
    int count;
    tvi_passes passes;
    galerkin_convergence convergence; /* of an earlier step of the same size, then of this one */
} galerkin_trial;

/* The results of several steps, apart from the increments of the state. */
typedef struct galerkin_outcome {
    tvi_status status; /* of the step after them, if fewer were made than asked for */
    /* Passes of the step that ended the run, which is made in another way. */
    int tried;
    long made, count; /* steps, and passes of all of them */
    /* How many of the passes evaluated second derivatives at the nodes, in generated code. */
    long factors;
    /* The index of the impulses of the last step in the ring, and how many of the last two steps have this size. */
    int ring_index, known;
    galerkin_convergence convergence; /* of the last step */
    double t;                         /* where the last step began */
    /* The last movement of the last step, a square as passes have it, and its tail. */
    double moved, tail;
    double largest_tail; /* of these steps, and of those before */
} galerkin_outcome;

/* ---- The parts of a step, of one member or several --------------------------------------------------------------- */

JET_INLINE void galerkin_start(const galerkin_frame *frame, const galerkin_nodes *nodes, const tvi_origin *origin)
{
    if (frame->tail_inputs->is_separable)
        GALERKIN_LOOP(frame->loops, start_drifting, nodes, frame->c, origin, frame->drift, frame->drift_low);
    else GALERKIN_LOOP(frame->loops, start, nodes, frame->tail_inputs->n, origin);
}

JET_INLINE double *galerkin_ring_buffer(const galerkin_frame *frame, int ring_index)
{
    return frame->impulses[ring_index < 0               ? ring_index + GALERKIN_RING
                           : ring_index < GALERKIN_RING ? ring_index
                                                        : ring_index - GALERKIN_RING];
}

/* Tells whether the last step alone predicts the unknowns of a member, as a mask: all bits, or none. */
JET_INLINE long long galerkin_is_rough(const galerkin_frame *frame, int known, double first)
{
    return known < 2 || first > frame->rough_limit ? -1 : 0;
}

JET_INLINE galerkin_extrapolation galerkin_from_steps(const galerkin_frame *frame, int ring_index,
                                                      const long long *is_rough)
{
    return (galerkin_extrapolation){*frame->h,
                                    frame->from_two,
                                    frame->from_last,
                                    galerkin_ring_buffer(frame, ring_index),
                                    galerkin_ring_buffer(frame, ring_index - 1),
                                    is_rough};
}

/* Adds a pass of a member, with its movement. */
JET_INLINE tvi_passes_verdict galerkin_judge(const tvi_passes_rule *rule, galerkin_trial *trial, double moved)
{
    const tvi_passes_verdict verdict = tvi_passes_add_and_judge(&trial->passes, rule, moved);
    if (trial->count++ == 0) trial->convergence.first = moved;
    trial->convergence.slowest = trial->passes.slowest;
    trial->status = !(moved < INFINITY) ? TVI_ENONFINITE : verdict == TVI_PASSES_MAY_END ? TVI_OK : TVI_ENOCONV;
    return trial->status == TVI_ENONFINITE ? TVI_PASSES_MAY_END : verdict;
}

/* Makes passes of the members that move, until the rule lets them end. A member whose passes are stuck moves no
 * more. */
JET_INLINE void galerkin_solve_members(const galerkin_frame *frame, const galerkin_nodes *nodes,
                                       const galerkin_solver *solver, galerkin_verdicts *verdicts)
{
    int left = 0;
    for (int m = 0; m < nodes->width; m++) {
        verdicts->size[m] = verdicts->before[m] = INFINITY;
        verdicts->part[m] = verdicts->shown[m] = verdicts->count[m] = 0;
        verdicts->has_ended[m] = 0;
        left -= (int)verdicts->is_moving[m];
    }
    for (int count = 1; left > 0 && count <= frame->rule->max_passes; count++) {
        (void)solver->pass(solver->work, nodes, verdicts->moved, NULL);
        left = frame->loops->judge(verdicts, frame->rule, nodes->width, count);
    }
}

/* Makes the passes of one member. Their roundoff is measured if they are stuck. */
JET_INLINE void galerkin_solve(const galerkin_frame *frame, const galerkin_nodes *nodes, const galerkin_solver *solver,
                               galerkin_trial *trial, double *moved)
{
    const int most = frame->rule->max_passes;
    bool is_stuck = false;
    tvi_passes_begin(&trial->passes, trial->convergence.slowest);
    trial->count = 0;
    trial->status = most > 0 ? TVI_ENOCONV : TVI_OK;
    *moved = 0;
    while (trial->count < most) {
        const bool suspects = is_stuck && trial->passes.roundoff == 0 && trial->count + 1 < most;
        const tvi_status status = solver->pass(solver->work, nodes, moved, suspects ? &trial->passes.roundoff : NULL);
        if (status != TVI_OK) {
            trial->status = status;
            return;
        }
        trial->count += suspects && trial->passes.roundoff > 0;
        const tvi_passes_verdict verdict = galerkin_judge(frame->rule, trial, *moved);
        if (verdict == TVI_PASSES_MAY_END) return;
        is_stuck |= verdict == TVI_PASSES_STUCK;
    }
}

/* Computes the increments of a step from its impulses, and its tail, [width]. */
JET_INLINE void galerkin_end_step(const galerkin_frame *frame, const galerkin_nodes *nodes, const tvi_origin *origin,
                                  const tvi_increments *by, double tail[])
{
    galerkin_tail_inputs inputs = *frame->tail_inputs;
    inputs.q = origin->q;
    inputs.p = origin->p;
    inputs.dp = by->dp;
    GALERKIN_LOOP(frame->loops, integrate, nodes, frame->weights, &inputs.sums);
    if (inputs.is_separable)
        GALERKIN_LOOP(frame->loops, end_drifting, nodes, &inputs.sums, frame->drift, frame->drift_low, by);
    else GALERKIN_LOOP(frame->loops, end, nodes, &inputs.sums, inputs.n, by);
    for (int m = 0; m < nodes->width; m++) tail[m] = 0;
    if (nodes->points > 1) GALERKIN_LOOP(frame->loops, tail, &inputs, nodes->width, frame->share, frame->ratio, tail);
}

/* ---- Steps in a row ---------------------------------------------------------------------------------------------- */

JET_INLINE bool galerkin_sums_are_finite(int count, const double *x, const double *dx)
{
    uint64_t any = 0;
    for (int i = 0; i < count; i++) any |= tvi_nonfinite_bits(x[i] + dx[i]);
    return any == 0;
}

/* Adds the step to the state. Returns false if its energy has to be checked, or if it is not finite. */
JET_INLINE bool galerkin_advance(int n, const tvi_step_run *row, const tvi_run_state *now, double tail, int passes)
{
    if (!(tail <= row->skip_limits.tail && passes <= row->skip_limits.passes)) return false;
    if (!tvi_step_ends_before_limit(row, now->q)) return false;
    if (!galerkin_sums_are_finite(n + 1, now->q, row->increments.dq)) return false;
    if (!galerkin_sums_are_finite(n, now->p, row->increments.dp)) return false;
    (void)tvi_add_all_compensated(n + 1, now->q, now->q_low, row->increments.dq, row->increments.dq_low);
    (void)tvi_add_all_compensated(n, now->p, now->p_low, row->increments.dp, row->increments.dp_low);
    return true;
}

/* Makes steps of one member from the origin, which is `now` and is updated. If `now` is NULL, it makes one step, which
 * is not added. If no step precedes the first one, `begin` of galerkin.c has set its unknowns. */
JET_INLINE void galerkin_make_steps(const galerkin_frame *frame, galerkin_nodes *nodes, const galerkin_solver *solver,
                                    const tvi_step_run *row, const tvi_origin *origin, const tvi_run_state *now,
                                    galerkin_outcome *to)
{
    const int n = frame->tail_inputs->n;
    while (to->made < row->steps) {
        const double t = now ? now->q[n] : origin->t;
        galerkin_trial trial = {.convergence = to->convergence};
        double moved, tail;
        nodes->impulse = galerkin_ring_buffer(frame, to->ring_index + 1);
        galerkin_start(frame, nodes, origin);
        if (to->known > 0) {
            const long long is_rough = galerkin_is_rough(frame, to->known, to->convergence.first);
            const galerkin_extrapolation by = galerkin_from_steps(frame, to->ring_index, &is_rough);
            solver->predict(solver->work, nodes, &by);
        }
        GALERKIN_LOOP(frame->loops, set_sizes, nodes, n);
        galerkin_solve(frame, nodes, solver, &trial, &moved);
        to->status = trial.status;
        if (trial.status == TVI_OK) galerkin_end_step(frame, nodes, origin, &row->increments, &tail);
        if (trial.status != TVI_OK || (now && !galerkin_advance(n, row, now, tail, trial.count))) {
            to->tried = trial.count;
            return;
        }
        to->made++;
        if (solver->made) solver->made(solver->work);
        to->count += trial.count;
        to->ring_index = (to->ring_index + 1) % GALERKIN_RING;
        to->known += to->known < 2;
        to->convergence = trial.convergence;
        to->t = t;
        to->moved = moved;
        to->tail = tail;
        to->largest_tail = tvi_larger(tail, to->largest_tail);
    }
}

/* The steps of generated code: galerkin_make_steps. */
typedef struct galerkin_code {
    void (*steps)(const galerkin_frame *frame, const tvi_step_run *row, const tvi_origin *origin,
                  const tvi_run_state *now, galerkin_outcome *to);
} galerkin_code;

#endif
