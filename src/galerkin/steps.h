/* steps.h - Makes the steps of the Galerkin curve (docs/method.md section 5). The library compiles this code for any
 * system, and calls kernels through tables (galerkin.c). Generated code compiles it for one system, whose sizes are
 * constants (generated_*.h). */
#ifndef TVI_SRC_GALERKIN_STEPS_H
#define TVI_SRC_GALERKIN_STEPS_H

#include "algebra/passes.h"
#include "galerkin/blocks.h"
#include "tvi.h"
#include "vector.h"

/* The inputs of the functions of this file, apart from the state and the request: the kernels, the nodes, the
 * coefficient tables and the memory of a stepper. */
typedef struct galerkin_step_inputs {
    const galerkin_kernels *kernels;
    const galerkin_nodes *nodes;
    const galerkin_tail_inputs *tail_inputs;
    const galerkin_double_integral_and_tail_weights *impulse_sum_weights;
    const tvi_stopping_rule *passes_rule;
    const double *node_impulse_to_node_unknown_matrix, *node_abscissa;
    /* the fields of the same names in galerkin_predictor */
    const double *two_step_extrapolation, *last_step_extrapolation;
    /* The limit of the movement of the first pass of a step. If the movement is larger, the next step is predicted from
     * the last step alone. */
    double two_step_prediction_max_first_movement;
    /* [unknowns] h M^-1 p0 of a separable system, and its low-order part. */
    double *coordinate_drift_over_step, *coordinate_drift_over_step_low;
    /* [GALERKIN_RING_LENGTH] The impulses of the last steps, stored in the history. */
    double *const *impulse_ring;
    /* lagrangian_pass_context or hamiltonian_pass_context, or NULL if passes use no second derivatives. */
    void *lagrangian_or_hamiltonian_pass_workspace;
} galerkin_step_inputs;

/* The functions that make the passes of a step and predict its unknowns. The library and generated code supply
 * different ones. */
typedef struct {
    /* Makes the next pass from the current unknowns. `movement` is measured as by the kernel `move`.
     * If passes no longer shrink, the caller passes a roundoff that is not NULL: the function then also measures how
     * far the roundoff of a pass moves the unknowns, if it can. */
    tvi_status (*make_pass)(void *work, const galerkin_nodes *nodes, double *movement, double *roundoff);
    void (*predict)(void *work, const galerkin_nodes *nodes, const galerkin_extrapolation *extrapolation);
    /* This function is called after each completed step of a run. NULL: no function is called. */
    void (*after_step)(void *work);
    void *work;
} galerkin_pass_functions;

/* The state of the iteration that solves the equations of a step. */
typedef struct {
    tvi_status status; /* TVI_OK, or TVI_ENOCONV if the passes are stuck or too many */
    int pass_count;
    tvi_convergence_test passes_so_far;
    /* The convergence of an earlier step of the same size when the iteration begins, and of this step when the
     * iteration has ended. */
    galerkin_convergence convergence;
} galerkin_iteration;

/* The results of several steps in a row, apart from the increments of the state. */
typedef struct galerkin_steps_outcome {
    /* TVI_OK, or the status of the step or the prediction that failed. It is TVI_OK, too, if the last step was not
     * added to the state (galerkin_try_adding_step_to_state). */
    tvi_status status;
    /* The number of passes of the last step, if it failed or was not added to the state. The caller makes this step
     * again. */
    int pass_count_of_failed_step;
    /* The number of steps that were made, and of all their passes. */
    long step_count, pass_count;
    /* The number of passes that inverted L_vv at the nodes; the generated code of a Lagrangian alone sets it. */
    long inversion_pass_count;
    /* The index in impulse_ring of the last step's impulses, and how many of the last two steps (0, 1 or 2) have the
     * size of the next step. */
    int last_ring_index, equal_step_count;
    /* true: the first of these steps is predicted from earlier steps; false: from the state at its start alone. */
    bool is_first_step_extrapolated;
    galerkin_convergence convergence; /* the convergence of the last step */
    double start_time_of_last_step;   /* the time at which the last step began */
    /* The movement of the last pass of the last step, as a sum of squares, and the tail of that step. */
    double last_pass_movement_square, last_tail;
    double largest_tail; /* the largest tail of these steps and of all earlier ones */
} galerkin_steps_outcome;

/* ---- The parts of a step ----------------------------------------------------------------------------------------- */

JET_INLINE void galerkin_set_drift_values(const galerkin_step_inputs *step_inputs, const galerkin_nodes *nodes,
                                          const tvi_step_origin *origin)
{
    if (step_inputs->tail_inputs->is_separable)
        GALERKIN_KERNEL(step_inputs->kernels, set_linear_drift_values, nodes, step_inputs->node_abscissa, origin,
                        step_inputs->coordinate_drift_over_step, step_inputs->coordinate_drift_over_step_low);
    else GALERKIN_KERNEL(step_inputs->kernels, set_constant_drift_values, nodes, step_inputs->tail_inputs->n, origin);
}

JET_INLINE double *galerkin_find_impulses_in_ring(const galerkin_step_inputs *step_inputs, int ring_index)
{
    return step_inputs->impulse_ring[ring_index < 0                      ? ring_index + GALERKIN_RING_LENGTH
                                     : ring_index < GALERKIN_RING_LENGTH ? ring_index
                                                                         : ring_index - GALERKIN_RING_LENGTH];
}

/* The next step is predicted from the last step alone if only one earlier step has the same size, or the first movement
 * of the last step exceeded two_step_prediction_max_first_movement. */
JET_INLINE galerkin_extrapolation galerkin_select_extrapolation(const galerkin_step_inputs *step_inputs, int ring_index,
                                                                int equal_step_count, double first_movement_square)
{
    return (galerkin_extrapolation){step_inputs->two_step_extrapolation, step_inputs->last_step_extrapolation,
                                    galerkin_find_impulses_in_ring(step_inputs, ring_index),
                                    galerkin_find_impulses_in_ring(step_inputs, ring_index - 1),
                                    equal_step_count < 2 ||
                                        first_movement_square > step_inputs->two_step_prediction_max_first_movement};
}

/* Records a pass with this movement, and decides whether the iteration may end. */
JET_INLINE tvi_passes_verdict galerkin_judge_pass(const tvi_stopping_rule *rule, galerkin_iteration *iteration,
                                                  double movement)
{
    const tvi_passes_verdict verdict = tvi_convergence_test_add_pass(&iteration->passes_so_far, rule, movement);
    if (iteration->pass_count++ == 0) iteration->convergence.first_movement_square = movement;
    iteration->convergence.largest_contraction_ratio = iteration->passes_so_far.slowest_ratio;
    iteration->status = !(movement < INFINITY) ? TVI_ENONFINITE : verdict == TVI_PASSES_MAY_END ? TVI_OK : TVI_ENOCONV;
    return iteration->status == TVI_ENONFINITE ? TVI_PASSES_MAY_END : verdict;
}

/* Makes passes until they converge. If the movements no longer shrink, the roundoff of a pass is
 * measured. */
JET_INLINE void galerkin_make_passes(const galerkin_step_inputs *step_inputs, const galerkin_nodes *nodes,
                                     const galerkin_pass_functions *pass_functions, galerkin_iteration *iteration,
                                     double *movement)
{
    const int most = step_inputs->passes_rule->max_passes;
    bool is_stuck = false;
    tvi_convergence_test_begin_iteration(&iteration->passes_so_far, iteration->convergence.largest_contraction_ratio);
    iteration->pass_count = 0;
    iteration->status = most > 0 ? TVI_ENOCONV : TVI_OK;
    *movement = 0;
    while (iteration->pass_count < most) {
        const bool suspects = is_stuck && iteration->passes_so_far.roundoff == 0 && iteration->pass_count + 1 < most;
        const tvi_status status = pass_functions->make_pass(pass_functions->work, nodes, movement,
                                                            suspects ? &iteration->passes_so_far.roundoff : NULL);
        if (status != TVI_OK) {
            iteration->status = status;
            return;
        }
        iteration->pass_count += suspects && iteration->passes_so_far.roundoff > 0;
        const tvi_passes_verdict verdict = galerkin_judge_pass(step_inputs->passes_rule, iteration, *movement);
        if (verdict == TVI_PASSES_MAY_END) return;
        is_stuck |= verdict == TVI_PASSES_STUCK;
        /* The unknowns have moved by more than their predicted sizes, which say nothing of them. */
        if (*movement > 1) GALERKIN_KERNEL(step_inputs->kernels, set_sizes, nodes, step_inputs->tail_inputs->n);
    }
}

/* Computes the increments of a step from its impulses. Returns the tail, an estimate of what the truncated series
 * leaves out. */
JET_INLINE double galerkin_compute_increments(const galerkin_step_inputs *step_inputs, const galerkin_nodes *nodes,
                                              const tvi_step_origin *origin, const tvi_increments *increments)
{
    galerkin_tail_inputs inputs = *step_inputs->tail_inputs;
    inputs.start_q = origin->q;
    inputs.start_p = origin->p;
    inputs.momentum_increment = increments->dp;
    GALERKIN_KERNEL(step_inputs->kernels, sum_impulses, nodes, step_inputs->impulse_sum_weights,
                    &inputs.impulse_sums_over_nodes);
    if (inputs.is_separable)
        GALERKIN_KERNEL(step_inputs->kernels, compute_drifting_increments, nodes, &inputs.impulse_sums_over_nodes,
                        step_inputs->coordinate_drift_over_step, step_inputs->coordinate_drift_over_step_low,
                        increments);
    else
        GALERKIN_KERNEL(step_inputs->kernels, compute_increments, nodes, &inputs.impulse_sums_over_nodes, inputs.n,
                        increments);
    return nodes->node_count > 1 ? GALERKIN_KERNEL(step_inputs->kernels, compute_tail, &inputs) : 0;
}

/* ---- Steps in a row ---------------------------------------------------------------------------------------------- */

JET_INLINE bool galerkin_are_sums_finite(int count, const double *x, const double *dx)
{
    uint64_t any = 0;
    for (int i = 0; i < count; i++) any |= tvi_nonzero_if_nonfinite(x[i] + dx[i]);
    return any == 0;
}

/* Adds the increments of a step to the state. Returns false, and adds nothing, in three cases: the energy has to be
 * checked first, because the tail or the number of passes exceeds run->limits_for_skipping_energy_check; the step does
 * not end before run->t_end; or the sums are not finite. */
JET_INLINE bool galerkin_try_adding_step_to_state(int n, const tvi_run_request *run, const tvi_run_state *state,
                                                  double tail, int pass_count)
{
    if (!(tail <= run->limits_for_skipping_energy_check.max_tail &&
          pass_count <= run->limits_for_skipping_energy_check.max_passes))
        return false;
    if (!tvi_step_ends_before_t_end(run, state->q)) return false;
    if (!galerkin_are_sums_finite(n + 1, state->q, run->last_step_increments_out.dq)) return false;
    if (!galerkin_are_sums_finite(n, state->p, run->last_step_increments_out.dp)) return false;
    (void)tvi_add_all_compensated_and_find_nonfinite(n + 1, state->q, state->q_low, run->last_step_increments_out.dq,
                                                     run->last_step_increments_out.dq_low);
    (void)tvi_add_all_compensated_and_find_nonfinite(n, state->p, state->p_low, run->last_step_increments_out.dp,
                                                     run->last_step_increments_out.dp_low);
    return true;
}

/* Makes steps in a row from the origin, and adds them to `state`. If `state` is NULL, makes a single step
 * and adds nothing. If outcome->equal_step_count is 0, the caller has set the unknowns of the first step. */
JET_INLINE void galerkin_make_steps(const galerkin_step_inputs *step_inputs, galerkin_nodes *nodes,
                                    const galerkin_pass_functions *pass_functions, const tvi_run_request *run,
                                    const tvi_step_origin *origin, const tvi_run_state *state,
                                    galerkin_steps_outcome *outcome)
{
    const int n = step_inputs->tail_inputs->n;
    while (outcome->step_count < run->max_steps) {
        const double t = state ? state->q[n] : origin->t;
        galerkin_iteration iteration = {.convergence = outcome->convergence};
        double movement, tail = 0;
        nodes->impulses = galerkin_find_impulses_in_ring(step_inputs, outcome->last_ring_index + 1);
        galerkin_set_drift_values(step_inputs, nodes, origin);
        if (outcome->equal_step_count > 0) {
            const galerkin_extrapolation extrapolation =
                galerkin_select_extrapolation(step_inputs, outcome->last_ring_index, outcome->equal_step_count,
                                              outcome->convergence.first_movement_square);
            pass_functions->predict(pass_functions->work, nodes, &extrapolation);
        }
        GALERKIN_KERNEL(step_inputs->kernels, set_sizes, nodes, n);
        galerkin_make_passes(step_inputs, nodes, pass_functions, &iteration, &movement);
        outcome->status = iteration.status;
        if (iteration.status == TVI_OK)
            tail = galerkin_compute_increments(step_inputs, nodes, origin, &run->last_step_increments_out);
        if (iteration.status != TVI_OK ||
            (state && !galerkin_try_adding_step_to_state(n, run, state, tail, iteration.pass_count))) {
            outcome->pass_count_of_failed_step = iteration.pass_count;
            return;
        }
        outcome->step_count++;
        if (pass_functions->after_step) pass_functions->after_step(pass_functions->work);
        outcome->pass_count += iteration.pass_count;
        outcome->last_ring_index = (outcome->last_ring_index + 1) % GALERKIN_RING_LENGTH;
        outcome->equal_step_count += outcome->equal_step_count < 2;
        outcome->convergence = iteration.convergence;
        outcome->start_time_of_last_step = t;
        outcome->last_pass_movement_square = movement;
        outcome->last_tail = tail;
        outcome->largest_tail = tvi_larger(tail, outcome->largest_tail);
    }
}

/* The entry point of generated code: `steps` makes steps, as galerkin_make_steps does. */
typedef struct galerkin_generated_code {
    void (*steps)(const galerkin_step_inputs *step_inputs, const tvi_run_request *run, const tvi_step_origin *origin,
                  const tvi_run_state *state, galerkin_steps_outcome *outcome);
} galerkin_generated_code;

#endif
