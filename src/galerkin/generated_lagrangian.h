/* generated_lagrangian.h - Makes steps of a Lagrangian's Galerkin curve in generated code (lagrangian.c). */
#ifndef TVI_SRC_GALERKIN_GENERATED_LAGRANGIAN_H
#define TVI_SRC_GALERKIN_GENERATED_LAGRANGIAN_H

#include "galerkin/generated_hessian.h"
#include "galerkin/lagrangian_passes.h"

/* Makes a pass. Returns TVI_ENOCONV if `roundoff` is not NULL or the pass fails: the library then makes the step again,
 * and can measure the roundoff of a pass. */
JET_INLINE tvi_status galerkin_make_lagrangian_pass(void *work, const galerkin_nodes *nodes, double *movement,
                                                    double *roundoff)
{
    lagrangian_pass_context *context = work;
    (void)nodes;
    if (roundoff || lagrangian_make_pass(context, galerkin_sweep_generated_tape) != LAGRANGIAN_PASSED)
        return TVI_ENOCONV;
    *movement = context->last_pass_movement_square;
    return TVI_OK;
}

static void galerkin_make_generated_steps(const galerkin_step_inputs *step_inputs, const tvi_run_request *run,
                                          const tvi_step_origin *origin, const tvi_run_state *state,
                                          galerkin_steps_outcome *outcome)
{
    enum { N = GALERKIN_N, ALL = GALERKIN_HAS_LOCAL_BLOCKS ? N * GALERKIN_LANES : 1 };
    galerkin_stack_copies_of_tape_blocks own;
    _Alignas(64) double displacements[ALL], rise[2 * ALL], gradient[2 * ALL], movement[2 * ALL];
    _Alignas(64) double lu[N * ALL], inverse[N * ALL], x[ALL];
    const galerkin_tail_inputs inputs = galerkin_copy_tail_inputs_with_constant_sizes(step_inputs->tail_inputs);
    galerkin_step_inputs local_inputs = *step_inputs;
    galerkin_nodes nodes = galerkin_copy_nodes_with_constant_sizes(step_inputs->nodes);
    lagrangian_pass_context context =
        *(const lagrangian_pass_context *)step_inputs->lagrangian_or_hamiltonian_pass_workspace;
    local_inputs.tail_inputs = &inputs;
    context.velocity_hessian_inversions_made = 0;
    context.nodes = &nodes;
    context.derivative_tapes = galerkin_copy_tapes_to_stack_if_small(&context.derivative_tapes, &nodes, &own);
    if (GALERKIN_HAS_LOCAL_BLOCKS)
        galerkin_copy_rows(own.node_values, step_inputs->nodes->values, 0, outcome->equal_step_count > 0 ? 0 : 3 * N);
    context.nodes_with_rates_as_unknowns =
        galerkin_copy_nodes_with_constant_sizes(&context.nodes_with_rates_as_unknowns);
    context.nodes_with_rates_as_unknowns.values = nodes.values + 2 * N * GALERKIN_LANES;
    context.rate_row_of_unknown = galerkin_rate_row_of_unknown;
    context.tape_slot_of_gradient_component[false] = galerkin_value_slot;
    context.tape_slot_of_gradient_component[true] = galerkin_hessian_slot;
    context.gradient_linearised_in_q_and_v.n = context.velocity_hessian_inverse.n = N;
    context.gradient_linearised_in_q_and_v.lane_count = GALERKIN_LANES;
    context.gradient_linearised_in_q_and_v.hessian_block = context.derivative_tapes.hessian_block;
    context.gradient_linearised_in_q_and_v.hessian_element = galerkin_hessian_element;
    context.gradient_linearised_in_q_and_v.row_end = galerkin_row_end;
    if (GALERKIN_HAS_LOCAL_BLOCKS) {
        galerkin_copy_rows(displacements, context.q_minus_start_q, 0, outcome->equal_step_count > 0 ? 0 : N);
        context.q_minus_start_q = displacements;
        context.start_q_minus_expansion_point[0] = rise;
        context.start_q_minus_expansion_point[1] = rise + ALL;
        context.gradient_linearised_in_q_and_v.gradient_at_centre = context.gradient_at_centre = gradient;
        context.gradient_linearised_in_q_and_v.displacement = movement;
        context.velocity_hessian_inverse.matrix = lu;
        context.velocity_hessian_inverse.inverse = inverse;
        context.velocity_hessian_inverse.scratch_column = x;
    }
    const galerkin_pass_functions pass_functions = {galerkin_make_lagrangian_pass, lagrangian_predict_unknowns, NULL,
                                                    &context};
    galerkin_make_steps(&local_inputs, &nodes, &pass_functions, run, origin, state, outcome);
    outcome->inversion_pass_count = context.velocity_hessian_inversions_made;
}

#endif
