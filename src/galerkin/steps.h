/* steps.h - the steps of the Galerkin curve (docs/method.md section 5): one text. The library compiles it for any
 * system, and for several members, with the loops of its tables (galerkin.c, batch.c); generated code for one system,
 * whose sizes are constants (generated_*.h). */
#ifndef TVI_SRC_GALERKIN_STEPS_H
#define TVI_SRC_GALERKIN_STEPS_H

#include "algebra/passes.h"
#include "galerkin/blocks.h"
#include "tvi.h"
#include "vector.h"

/* What all steps share. */
typedef struct galerkin_frame {
    const galerkin_loops *loops;
    const galerkin_nodes *nodes;
    const galerkin_motion *motion;
    const galerkin_weights *weights;
    const tvi_passes_rule *rule;
    const double *matrix, *c;
    const double *from_two, *from_last; /* of galerkin_extrapolation */
    double rough;              /* the size of a first movement behind which the last step alone predicts better */
    double *drift, *drift_low; /* [unknowns][width] h M^-1 p0 of a separable system, in two parts */
    double *share, *ratio;     /* [n][width] of the tail */
    double *const *impulses;   /* [GALERKIN_TURNS] of steps, in turns; in the history */
    void *own;                 /* of the form of the field: lagrangian_passes, hamiltonian_passes */
    const double *h;           /* the size of the step */
} galerkin_frame;

/* The field, as passes have it. */
typedef struct {
    /* The next pass from the unknowns where they are: moved as that of loops.h, [width]. Where roundoff is given, the
     * passes no longer shrink: sets it to what the roundoff of a pass moves, if that can be measured. */
    tvi_status (*pass)(void *of, const galerkin_nodes *nodes, double moved[], double *roundoff);
    void (*predict)(void *of, const galerkin_nodes *nodes, const galerkin_extrapolation *by);
    void (*made)(void *of); /* a step in a row; NULL: nothing is done */
    void *of;
} galerkin_drive;

/* How the passes of one member go. */
typedef struct {
    tvi_status status; /* TVI_ENOCONV where they are stuck, or too many */
    int count;
    tvi_passes passes;
    galerkin_pace pace; /* of an earlier step of the same size, then of this one */
} galerkin_trial;

/* What steps in a row have made, but for what they added to the state. */
typedef struct galerkin_outcome {
    tvi_status status;   /* of the step behind them, where they are less than asked for */
    int tried;           /* passes of the step that ended the row, which is made in another way */
    long made, count;    /* steps, and passes of all of them, */
    long factors;        /* in which so many took second derivatives at the nodes; of generated code */
    int turn, known;     /* where the impulses of the last one are; so many of the last two have this size */
    galerkin_pace pace;  /* of the last one, */
    double t;            /* where it began, */
    double moved, tail;  /* its last movement, a square as passes have it, and its tail */
    double largest_tail; /* of these steps, and of those before */
} galerkin_outcome;

/* ---- The parts of a step, of one member or several --------------------------------------------------------------- */

JET_INLINE void galerkin_start(const galerkin_frame *frame, const galerkin_nodes *nodes, const tvi_origin *origin)
{
    if (frame->motion->is_separable)
        GALERKIN_LOOP(frame->loops, start_drifting, nodes, frame->c, origin, frame->drift, frame->drift_low);
    else GALERKIN_LOOP(frame->loops, start, nodes, frame->motion->n, origin);
}

JET_INLINE double *galerkin_turn(const galerkin_frame *frame, int turn)
{
    return frame->impulses[turn < 0 ? turn + GALERKIN_TURNS : turn < GALERKIN_TURNS ? turn : turn - GALERKIN_TURNS];
}

/* Whether the last step alone is to predict the unknowns of a member, as a mask: all bits, or none. */
JET_INLINE long long galerkin_is_rough(const galerkin_frame *frame, int known, double first)
{
    return known < 2 || first > frame->rough ? -1 : 0;
}

JET_INLINE galerkin_extrapolation galerkin_from_steps(const galerkin_frame *frame, int turn, const long long *is_rough)
{
    return (galerkin_extrapolation){
        *frame->h, frame->from_two, frame->from_last, galerkin_turn(frame, turn), galerkin_turn(frame, turn - 1),
        is_rough};
}

/* Adds a pass of a member, which moved it by so much. */
JET_INLINE tvi_passes_verdict galerkin_judge(const tvi_passes_rule *rule, galerkin_trial *trial, double moved)
{
    const tvi_passes_verdict verdict = tvi_passes_judge(&trial->passes, rule, moved);
    if (trial->count++ == 0) trial->pace.first = moved;
    trial->pace.slowest = trial->passes.slowest;
    trial->status = !(moved < INFINITY) ? TVI_ENONFINITE : verdict == TVI_PASSES_MAY_END ? TVI_OK : TVI_ENOCONV;
    return trial->status == TVI_ENONFINITE ? TVI_PASSES_MAY_END : verdict;
}

/* Passes of the members that move, until the rule lets them end; one whose passes are stuck moves no more. */
JET_INLINE void galerkin_solve_members(const galerkin_frame *frame, const galerkin_nodes *nodes,
                                       const galerkin_drive *drive, galerkin_verdicts *of)
{
    int left = 0;
    for (int m = 0; m < nodes->width; m++) {
        of->size[m] = of->before[m] = INFINITY;
        of->part[m] = of->shown[m] = of->count[m] = 0;
        of->has_ended[m] = 0;
        left -= (int)of->is_moving[m];
    }
    for (int count = 1; left > 0 && count <= frame->rule->most; count++) {
        (void)drive->pass(drive->of, nodes, of->moved, NULL);
        left = frame->loops->judge(of, frame->rule, nodes->width, count);
    }
}

/* Those of one, whose roundoff is measured where they are stuck. */
JET_INLINE void galerkin_solve(const galerkin_frame *frame, const galerkin_nodes *nodes, const galerkin_drive *drive,
                               galerkin_trial *trial, double *moved)
{
    const int most = frame->rule->most;
    bool is_stuck = false;
    tvi_passes_begin(&trial->passes, trial->pace.slowest);
    trial->count = 0;
    trial->status = most > 0 ? TVI_ENOCONV : TVI_OK;
    *moved = 0;
    while (trial->count < most) {
        const bool suspects = is_stuck && trial->passes.roundoff == 0 && trial->count + 1 < most;
        const tvi_status status = drive->pass(drive->of, nodes, moved, suspects ? &trial->passes.roundoff : NULL);
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

/* The increments of a step, by its impulses, and its tail, [width]. */
JET_INLINE void galerkin_end_step(const galerkin_frame *frame, const galerkin_nodes *nodes, const tvi_origin *origin,
                                  const tvi_increments *by, double tail[])
{
    galerkin_motion motion = *frame->motion;
    motion.q = origin->q;
    motion.p = origin->p;
    motion.dp = by->dp;
    GALERKIN_LOOP(frame->loops, integrate, nodes, frame->weights, &motion.sums);
    if (motion.is_separable)
        GALERKIN_LOOP(frame->loops, end_drifting, nodes, &motion.sums, frame->drift, frame->drift_low, by);
    else GALERKIN_LOOP(frame->loops, end, nodes, &motion.sums, motion.n, by);
    for (int m = 0; m < nodes->width; m++) tail[m] = 0;
    if (nodes->points > 1) GALERKIN_LOOP(frame->loops, tail, &motion, nodes->width, frame->share, frame->ratio, tail);
}

/* ---- Steps in a row ---------------------------------------------------------------------------------------------- */

JET_INLINE bool galerkin_sums_are_finite(int count, const double *x, const double *dx)
{
    uint64_t any = 0;
    for (int i = 0; i < count; i++) any |= tvi_bits_of_infinite(x[i] + dx[i]);
    return any == 0;
}

/* Adds the step to the state; false where it is not sure, or not finite. */
JET_INLINE bool galerkin_advance(int n, const tvi_row *row, const tvi_run_state *now, double tail, int passes)
{
    if (!(tail <= row->sure.tail && passes <= row->sure.passes)) return false;
    if (!tvi_row_is_in_time(row, now->q)) return false;
    if (!galerkin_sums_are_finite(n + 1, now->q, row->by.dq)) return false;
    if (!galerkin_sums_are_finite(n, now->p, row->by.dp)) return false;
    (void)tvi_add_all_compensated(n + 1, now->q, now->q_low, row->by.dq, row->by.dq_low);
    (void)tvi_add_all_compensated(n, now->p, now->p_low, row->by.dp, row->by.dp_low);
    return true;
}

/* Steps of one member from the origin, which is `now` and moves on, or NULL: one, which is not added. Where none is
 * known before the first one, `begin` of galerkin.c has set its unknowns. */
JET_INLINE void galerkin_make_steps(const galerkin_frame *frame, galerkin_nodes *nodes, const galerkin_drive *drive,
                                    const tvi_row *row, const tvi_origin *origin, const tvi_run_state *now,
                                    galerkin_outcome *to)
{
    const int n = frame->motion->n;
    while (to->made < row->steps) {
        const double t = now ? now->q[n] : origin->t;
        galerkin_trial trial = {.pace = to->pace};
        double moved, tail;
        nodes->impulse = galerkin_turn(frame, to->turn + 1);
        galerkin_start(frame, nodes, origin);
        if (to->known > 0) {
            const long long is_rough = galerkin_is_rough(frame, to->known, to->pace.first);
            const galerkin_extrapolation by = galerkin_from_steps(frame, to->turn, &is_rough);
            drive->predict(drive->of, nodes, &by);
        }
        GALERKIN_LOOP(frame->loops, set_sizes, nodes, n);
        galerkin_solve(frame, nodes, drive, &trial, &moved);
        to->status = trial.status;
        if (trial.status == TVI_OK) galerkin_end_step(frame, nodes, origin, &row->by, &tail);
        if (trial.status != TVI_OK || (now && !galerkin_advance(n, row, now, tail, trial.count))) {
            to->tried = trial.count;
            return;
        }
        to->made++;
        if (drive->made) drive->made(drive->of);
        to->count += trial.count;
        to->turn = (to->turn + 1) % GALERKIN_TURNS;
        to->known += to->known < 2;
        to->pace = trial.pace;
        to->t = t;
        to->moved = moved;
        to->tail = tail;
        to->largest_tail = tvi_larger(tail, to->largest_tail);
    }
}

/* Those of generated code: galerkin_make_steps. */
typedef struct galerkin_code {
    void (*steps)(const galerkin_frame *frame, const tvi_row *row, const tvi_origin *origin, const tvi_run_state *now,
                  galerkin_outcome *to);
} galerkin_code;

#endif
