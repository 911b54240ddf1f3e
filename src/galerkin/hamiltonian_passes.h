/* hamiltonian_passes.h - Makes passes, the iterations that solve the equations of a Galerkin step, for a Hamiltonian
 * whose second derivatives are used. A pass evaluates the gradient at the nodes of the step, and corrects the
 * coordinates and momenta there by an approximate Newton iteration (docs/method.md section 5). hamiltonian.c calls
 * this file; generated code contains its text. */
#ifndef TVI_SRC_GALERKIN_HAMILTONIAN_PASSES_H
#define TVI_SRC_GALERKIN_HAMILTONIAN_PASSES_H

#include "galerkin/blocks.h"
#include "galerkin/loops.h"

#include <math.h>

/* The context of passes: their kernels, nodes, tables and memory. The rows of nodes->values are the positions Q and the
 * momenta P, n each; during a prediction 2n rows of their rates follow. */
typedef struct {
    const galerkin_kernels *kernels;
    const galerkin_nodes *nodes;
    /* The nodes with other unknowns: the rates V and F, which are the velocities and the forces at the nodes. With them
     * the kernel `predict` extrapolates the rates from the impulses of earlier steps. An impulse is the step size h
     * times a quadrature weight times a rate. To turn sums of impulses into rates, unknown_change_per_impulse is 1/h,
     * and the drift values, to which `predict` adds these sums, are 0. */
    galerkin_nodes nodes_with_rates_as_unknowns;
    /* [j][i] the factor of the impulse of node j in an unknown at node i (coefficients.h) */
    const double *node_impulse_to_node_unknown_matrix;
    /* [unknowns] The row of nodes->values that contains each unknown's rate. */
    const int *rate_row_of_unknown;
    galerkin_derivative_tapes derivative_tapes;
    /* [unknowns] The slot of each unknown's rate: tape_slot_of_rate[false] is for gradient_block,
     * tape_slot_of_rate[true] for hessian_block. */
    const int *tape_slot_of_rate[2];
    lanes_inner_iterations newton_inner_iteration_data;
    /* [unknowns][lanes] The changes of the impulses that the inner iterations make. */
    double *change_of_step_impulses_by_inner_iterations;
    /* The movement of the last pass: the sum of the squares of the relative changes of the unknowns. It is infinity
     * before the first pass of a step. */
    double last_pass_movement_square;
} hamiltonian_pass_context;

/* In the first pass of a step the inner iterations end when the square of a relative movement is below this number,
 * since a second pass follows in any case. */
#define HAMILTONIAN_FIRST_PASS_GOAL_SQUARE 0x1p-108

/* Predicts the unknowns from the impulses of earlier steps. `work` is a pointer to hamiltonian_pass_context. */
static inline void hamiltonian_predict_unknowns(void *work, const galerkin_nodes *nodes,
                                                const galerkin_extrapolation *extrapolation)
{
    hamiltonian_pass_context *context = work;
    (void)nodes;
    const galerkin_nodes all = galerkin_copy_nodes_with_all_unknowns_moving(context->nodes);
    GALERKIN_KERNEL(context->kernels, predict, &context->nodes_with_rates_as_unknowns, extrapolation);
    (void)GALERKIN_KERNEL(context->kernels, move, &all, context->node_impulse_to_node_unknown_matrix,
                          context->nodes->values, context->rate_row_of_unknown);
    context->last_pass_movement_square = INFINITY;
}

static inline void hamiltonian_set_magnitudes_of_inner_unknowns(const hamiltonian_pass_context *context)
{
    const lanes_inner_iterations *inner = &context->newton_inner_iteration_data;
    for (int i = 0; i < inner->hessian_row_count; i++) {
        inner->inverse_unknown_size[i] = context->nodes->inverse_unknown_size[inner->unknown_of_row[i]];
        inner->unknown_size[i] = 1 / inner->inverse_unknown_size[i];
    }
}

/* Makes a pass. Returns false if an unknown is outside the field's domain. */
static inline bool hamiltonian_make_pass(hamiltonian_pass_context *context, galerkin_sweep *sweep)
{
    const galerkin_nodes *nodes = context->nodes;
    const int numbers = nodes->unknown_count * nodes->lane_count;
    const bool is_first = isinf(context->last_pass_movement_square),
               serves = context->last_pass_movement_square <= HAMILTONIAN_HESSIAN_MAX_MOVEMENT * numbers;
    const int *slot = context->tape_slot_of_rate[!serves];
    const double least =
        numbers * (is_first ? HAMILTONIAN_FIRST_PASS_GOAL_SQUARE : GALERKIN_HESSIAN_GOAL * GALERKIN_HESSIAN_GOAL);
    const double *rates = galerkin_evaluate_gradient_at_nodes(&context->derivative_tapes, sweep, !serves, nodes->values,
                                                              nodes->values + numbers / 2);
    if (!rates) return false;
    if (is_first) hamiltonian_set_magnitudes_of_inner_unknowns(context);
    GALERKIN_KERNEL(context->kernels, run_inner_iterations, nodes, &context->newton_inner_iteration_data, rates, slot,
                    !serves, context->last_pass_movement_square, least,
                    context->change_of_step_impulses_by_inner_iterations);
    context->last_pass_movement_square =
        GALERKIN_KERNEL(context->kernels, move_with_changes, nodes, context->node_impulse_to_node_unknown_matrix, rates,
                        context->change_of_step_impulses_by_inner_iterations, slot);
    return true;
}

#endif
