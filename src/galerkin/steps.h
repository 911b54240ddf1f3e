/* steps.h - Makes steps of the Galerkin curve, whose unknowns are the values at m Gauss nodes. This is Gauss
 * collocation (docs/method.md sections 4 and 5). With its coefficients a, b, c and the force F_j at node j the
 * equations are, for a separable system,
 *    Q_i = q0 + c_i h M^-1 p0 + h^2 sum_j (a a)_ij M^-1 F_j,
 *    q1 = q0 + h M^-1 (p0 + h sum_j b_j (1 - c_j) F_j),   p1 = p0 + h sum_j b_j F_j;
 * and for any other system, with (V, F) = (H_p, -H_q), or L_v(Q, V) = P and F = L_q,
 *    (Q, P)_i = (q0, p0) + h sum_j a_ij (V, F)_j,   (q1, p1) = (q0, p0) + h sum_j b_j (V, F)_j.
 *
 * Lanes, impulses and rates are those of nodes.h. The last function, galerkin_make_steps, is a step on a page: it
 * predicts the unknowns, makes passes until they are at rest, sums the impulses and computes the tail (ends.h). The
 * library compiles this text in galerkin.c, once for each instruction set; generated code contains it, with the sizes
 * of its system as constants (emit_steps.c, generated.h). */
#ifndef TVI_SRC_GALERKIN_STEPS_H
#define TVI_SRC_GALERKIN_STEPS_H

#include "galerkin/ends.h"
#include "galerkin/hamiltonian_pass.h"
#include "galerkin/lagrangian_pass.h"

/* The forms of the equations. GALERKIN_PLAIN: the rates are outputs of the tape, and passes are a fixed-point
 * iteration. The passes of the others use second derivatives. */
typedef enum { GALERKIN_PLAIN, GALERKIN_LAGRANGIAN, GALERKIN_HAMILTONIAN } galerkin_form;

/* Measures of how the passes of a step converged, from which the convergence of the next step is estimated. A movement
 * is the sum of the squares of the changes of the unknowns, relative to their sizes. 0: unknown. */
typedef struct {
    double contraction;    /* the largest ratio of the movements of two successive passes */
    double first_movement; /* the movement of the first pass, which shows the error of the prediction */
} galerkin_convergence;

struct galerkin_probe;

/* What steps are computed with: the unknowns, the field and the tables. */
typedef struct galerkin_step {
    galerkin_form form;
    bool is_separable; /* the system is separable, so that the unknowns are the coordinates alone, with Q'' = F */
    double h;          /* the step size for which weights and scales are set; 0 before the first step */
    const tvi_system *system;
    galerkin_nodes nodes;
    galerkin_field_at_nodes field;
    const int *rate_row; /* [unknowns] the row of nodes.x that has the rate of each unknown */
    const double *c;     /* [lanes] the nodes c_i */
    /* [unknowns] the free motion of the positions of a separable system over the whole step, h M^-1 p0, in two parts */
    double *move, *move_low;
    galerkin_sum_weights sum_weights;
    galerkin_tail tail;
    tvi_stopping_rule rule; /* the rule that ends the passes */
    /* The factors by which the impulses of the last two steps, or of the last step alone, predict the unknowns
     * (galerkin_extrapolation). */
    double *two_step_prediction_table, *last_step_prediction_table;
    /* The next step is predicted from two steps if the first pass of this step moves the unknowns by no more than this,
     * as a sum of squares. */
    double two_step_max_movement;
    /* The impulses of the last steps and of the current one, stored in the history. */
    double *ring[GALERKIN_RING_LENGTH];
    lagrangian_pass *lagrangian;   /* NULL for other forms */
    hamiltonian_pass *hamiltonian; /* NULL for other forms */
    struct galerkin_probe *probe;  /* the memory in which the library measures roundoff (probe.c) */
} galerkin_step;

/* The numbers of what passes did (tvi_stats). */
typedef struct {
    long passes, evaluations, factorisations;
} galerkin_counts;

/* The results of several steps in a row, apart from the increments of the state. */
typedef struct galerkin_outcome {
    /* TVI_OK, or the status of the step or the prediction that failed. It is TVI_OK, too, if the last step was not
     * added to the state (galerkin_add_to_state). */
    tvi_status status;
    long step_count;
    galerkin_counts counts;          /* the work of all passes */
    galerkin_counts counts_of_added; /* the work of the passes of the step_count steps that were added to the state */
    /* The index in the ring of the last step's impulses, and how many of the last two steps (0, 1 or 2) have the size
     * of the next step. */
    int ring_index, equal_step_count;
    bool is_extrapolated; /* whether the first step was predicted from earlier steps, not from its start alone */
    galerkin_convergence convergence; /* the convergence of the passes of the last step */
    double start_time;                /* the time at which the last step began */
    double last_movement;             /* the movement of the last pass of the last step, a sum of squares */
    double last_tail;                 /* the tail of the last step */
    double largest_tail;              /* the largest tail of these steps and of all earlier ones */
} galerkin_outcome;

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

static inline double *galerkin_ring_at(const galerkin_step *step, int index)
{
    return step->ring[(index + GALERKIN_RING_LENGTH) % GALERKIN_RING_LENGTH];
}

static inline void galerkin_set_free_motion(const galerkin_step *step, const tvi_step_origin *origin)
{
    if (step->is_separable) nodes_set_linear_free_motion(&step->nodes, step->c, origin, step->move, step->move_low);
    else nodes_set_constant_free_motion(&step->nodes, origin);
}

static inline void galerkin_predict(const galerkin_step *step, const galerkin_extrapolation *by)
{
    if (step->form == GALERKIN_PLAIN) nodes_predict(&step->nodes, by);
    else if (step->form == GALERKIN_LAGRANGIAN) lagrangian_predict(step->lagrangian, &step->nodes, step->rate_row, by);
    else hamiltonian_predict(step->hamiltonian, &step->nodes, step->rate_row, by);
}

/* Predicts the unknowns from the last two steps, or from the last one if only one has the size of this step, or if the
 * prediction of the last step was rough. */
static inline void galerkin_predict_from_ring(const galerkin_step *step, const galerkin_outcome *so_far)
{
    const galerkin_extrapolation by = {
        step->two_step_prediction_table, step->last_step_prediction_table, galerkin_ring_at(step, so_far->ring_index),
        galerkin_ring_at(step, so_far->ring_index - 1),
        so_far->equal_step_count < 2 || so_far->convergence.first_movement > step->two_step_max_movement};
    galerkin_predict(step, &by);
}

/* ---- A pass ------------------------------------------------------------------------------------------------------ */

/* Moves the unknowns by the rates, which the tape computes from them: nodes.x is the block of the tape, whose inputs
 * are the unknowns and whose outputs have the rates (forms.c). Returns false if an operand is outside its domain.
 * Generated code (GALERKIN_LANES is defined there alone, by emit_steps.c) may evaluate a small tape in registers. */
static inline bool galerkin_make_plain_pass(const galerkin_step *step, double *movement)
{
#ifdef GALERKIN_LANES
    if (GALERKIN_IS_SPLIT) {
        if (!galerkin_impulses_by_registers(&step->nodes)) return false;
        *movement = move_unknowns_by_impulses(&step->nodes, NULL, GALERKIN_LANES);
        return true;
    }
#endif
    if (!galerkin_sweep(&step->field, false)) return false;
    *movement = nodes_move_by_rates(&step->nodes, step->nodes.x, step->rate_row, NULL);
    return true;
}

/* Makes a pass: evaluates the field, moves the unknowns, and counts. */
static inline tvi_status galerkin_make_pass(const galerkin_step *step, double *movement, galerkin_counts *counts)
{
    tvi_status status = TVI_OK;
    counts->evaluations += NODE_COUNT_OF(&step->nodes);
    if (step->form == GALERKIN_PLAIN) status = galerkin_make_plain_pass(step, movement) ? TVI_OK : TVI_EDOMAIN;
    else if (step->form == GALERKIN_LAGRANGIAN) {
        const long before = step->lagrangian->inversions;
        status = lagrangian_make_pass(step->lagrangian, &step->nodes, &step->field, step->rate_row);
        counts->factorisations += (step->lagrangian->inversions - before) * NODE_COUNT_OF(&step->nodes);
        *movement = step->lagrangian->last_movement;
    } else {
        status = hamiltonian_make_pass(step->hamiltonian, &step->nodes, &step->field) ? TVI_OK : TVI_EDOMAIN;
        *movement = step->hamiltonian->last_movement;
    }
    if (status != TVI_OK) return status;
    counts->passes++;
    return isfinite(*movement) ? TVI_OK : TVI_ENONFINITE;
}

#ifndef GALERKIN_LANES
/* Makes the next pass, and measures its roundoff if the movement is as small as roundoff or the nodes are near the
 * start of the step: otherwise the step is too large, and its movements back and forth are no roundoff (probe.c). */
tvi_status tvi_galerkin_make_probed_pass(galerkin_step *step, const tvi_step_origin *origin, double *movement,
                                         double *roundoff, galerkin_counts *counts);
#endif

/* Makes passes until the rule ends them; the sizes that the rule sees are movements, sums of squares. If their
 * movements no longer shrink, the library measures the roundoff of a pass; generated code returns TVI_ENOCONV, and the
 * library makes the step again. */
static inline tvi_status galerkin_make_passes(galerkin_step *step, const tvi_step_origin *origin,
                                              galerkin_convergence *convergence, double *movement,
                                              galerkin_counts *counts)
{
    const tvi_stopping_rule *rule = &step->rule;
    const long before = counts->passes;
    tvi_convergence_test test;
    bool is_stuck = false;
    tvi_convergence_begin(&test, convergence->contraction);
    *movement = 0;
    for (long made = 0; made < rule->max_passes; made = counts->passes - before) {
        const bool may_be_roundoff = is_stuck && test.roundoff == 0 && made + 1 < rule->max_passes;
#ifdef GALERKIN_LANES
        (void)origin;
        const tvi_status status = may_be_roundoff ? TVI_ENOCONV : galerkin_make_pass(step, movement, counts);
#else
        const tvi_status status = may_be_roundoff
                                      ? tvi_galerkin_make_probed_pass(step, origin, movement, &test.roundoff, counts)
                                      : galerkin_make_pass(step, movement, counts);
#endif
        if (status != TVI_OK) return status;
        const tvi_passes_verdict verdict = tvi_convergence_add_pass(&test, rule, *movement);
        if (made == 0) convergence->first_movement = *movement;
        convergence->contraction = test.slowest_ratio;
        if (verdict == TVI_PASSES_MAY_END) return TVI_OK;
        is_stuck |= verdict == TVI_PASSES_STUCK;
        /* The unknowns have moved by more than their predicted sizes, which say nothing of them. */
        if (*movement > 1) nodes_set_sizes(&step->nodes);
    }
    return rule->max_passes > 0 ? TVI_ENOCONV : TVI_OK;
}

/* ---- The end of a step ------------------------------------------------------------------------------------------- */

/* Computes the increments of a step from its impulses. Returns the tail, an estimate of what the truncated series
 * leaves out. */
static inline double galerkin_set_increments(const galerkin_step *step, const tvi_step_origin *origin,
                                             const tvi_increments *increments)
{
    galerkin_tail tail = step->tail;
    tail.q = origin->q;
    tail.p = origin->p;
    tail.dp = increments->dp;
    nodes_sum_impulses(&step->nodes, &step->sum_weights, &tail.sums);
    if (step->is_separable)
        nodes_set_separable_increments(&step->nodes, &tail.sums, step->move, step->move_low, increments);
    else nodes_set_increments(&step->nodes, &tail.sums, increments);
    return step->nodes.node_count > 1 ? galerkin_compute_tail(&tail) : 0;
}

static inline bool galerkin_are_sums_finite(int count, const double *x, const double *dx)
{
    uint64_t any = 0;
    for (int i = 0; i < count; i++) any |= tvi_nonzero_if_nonfinite(x[i] + dx[i]);
    return any == 0;
}

/* Adds the increments of a step to the state. Returns false, and adds nothing, in three cases: the energy has to be
 * checked first, because the tail or the number of passes exceeds run->unchecked_limits; the step does not end before
 * run->t_end; or the sums are not finite. */
static inline bool galerkin_add_to_state(int n, const tvi_run_request *run, const tvi_run_state *state, double tail,
                                         long passes)
{
    const tvi_increments *d = &run->last_step_increments_out;
    if (!(tail <= run->unchecked_limits.max_tail && passes <= run->unchecked_limits.max_passes)) return false;
    if (!tvi_step_ends_before_t_end(run, state->q)) return false;
    if (!galerkin_are_sums_finite(n + 1, state->q, d->dq) || !galerkin_are_sums_finite(n, state->p, d->dp))
        return false;
    (void)tvi_add_all_compensated(n + 1, state->q, state->q_low, d->dq, d->dq_low);
    (void)tvi_add_all_compensated(n, state->p, state->p_low, d->dp, d->dp_low);
    return true;
}

/* ---- Steps in a row ---------------------------------------------------------------------------------------------- */

/* Makes steps of size step->h in a row from the origin, and adds them to `state`. The size acts through nodes.hb,
 * nodes.scale and nodes.m_over_h, which galerkin.c has set; run->h is the same number, which only
 * tvi_step_ends_before_t_end reads here. galerkin_add_to_state also adds run->last_step_increments_out.dq[n], which is
 * h, to the time state->q[n]. If `state` is NULL, makes a single step and adds nothing. If outcome->equal_step_count is
 * 0, the caller has set the unknowns of the first step. */
static inline void galerkin_make_steps(galerkin_step *step, const tvi_run_request *run, const tvi_step_origin *origin,
                                       const tvi_run_state *state, galerkin_outcome *outcome)
{
    const int n = step->nodes.n;
    while (outcome->step_count < run->max_steps) {
        const double t = state ? state->q[n] : origin->t;
        galerkin_convergence convergence = outcome->convergence;
        const long before = outcome->counts.passes;
        double movement, tail = 0;
        step->nodes.impulse = galerkin_ring_at(step, outcome->ring_index + 1);
        galerkin_set_free_motion(step, origin);
        if (outcome->equal_step_count > 0) galerkin_predict_from_ring(step, outcome);
        nodes_set_sizes(&step->nodes);
        outcome->status = galerkin_make_passes(step, origin, &convergence, &movement, &outcome->counts);
        if (outcome->status != TVI_OK) return;
        tail = galerkin_set_increments(step, origin, &run->last_step_increments_out);
        if (state && !galerkin_add_to_state(n, run, state, tail, outcome->counts.passes - before)) return;
        outcome->step_count++;
        outcome->counts_of_added = outcome->counts;
        outcome->ring_index = (outcome->ring_index + 1) % GALERKIN_RING_LENGTH;
        outcome->equal_step_count += outcome->equal_step_count < 2;
        outcome->convergence = convergence;
        outcome->start_time = t;
        outcome->last_movement = movement;
        outcome->last_tail = tail;
        outcome->largest_tail = tvi_larger(tail, outcome->largest_tail);
    }
}

/* The entry point of generated steps. The text that emit_steps.c writes defines a structure of this type with
 * .make_steps = galerkin_make_generated_steps, the function of generated.h. It makes steps as galerkin_make_steps
 * does. */
typedef struct galerkin_generated_steps {
    void (*make_steps)(const galerkin_step *step, const tvi_run_request *run, const tvi_step_origin *origin,
                       const tvi_run_state *state, galerkin_outcome *outcome);
} galerkin_generated_steps;

#endif
