/* generated_hamiltonian.h - Makes Galerkin steps in generated code, for a Hamiltonian system. The step's equations are
 * solved by an approximate Newton iteration with second derivatives of H, whose iterations are called passes
 * (hamiltonian.c). */
#ifndef TVI_SRC_GALERKIN_GENERATED_HAMILTONIAN_H
#define TVI_SRC_GALERKIN_GENERATED_HAMILTONIAN_H

#include "galerkin/generated_hessian.h"
#include "galerkin/hamiltonian_passes.h"

/* Makes a pass. Returns TVI_ENOCONV if `roundoff` is not NULL or the pass fails: the library then makes the step again,
 * and can measure the roundoff of a pass. */
JET_INLINE tvi_status galerkin_make_hamiltonian_pass(void *work, const galerkin_nodes *nodes, double *movement,
                                                     double *roundoff)
{
    hamiltonian_pass_context *context = work;
    (void)nodes;
    if (roundoff || !hamiltonian_make_pass(context, galerkin_sweep_generated_tape)) return TVI_ENOCONV;
    *movement = context->last_pass_movement_square;
    return TVI_OK;
}

/* Makes steps in a row. The matrix of the inner iterations has GALERKIN_HESSIAN_ROWS rows and GALERKIN_HESSIAN_COLUMNS
 * columns. */
static void galerkin_make_generated_steps(const galerkin_step_inputs *step_inputs, const tvi_run_request *run,
                                          const tvi_step_origin *origin, const tvi_run_state *state,
                                          galerkin_steps_outcome *outcome)
{
    enum {
        PACKED = GALERKIN_HESSIAN_ROWS * GALERKIN_HESSIAN_COLUMNS * GALERKIN_LANES,
        IS_PACKED = PACKED <= 2 * GALERKIN_MAX_LOCAL
    };
    enum { ROWS = IS_PACKED ? GALERKIN_HESSIAN_ROWS : 1, ALL = IS_PACKED ? GALERKIN_HESSIAN_ROWS * GALERKIN_LANES : 1 };
    galerkin_stack_copies_of_tape_blocks own;
    _Alignas(64) float packed[IS_PACKED ? PACKED : 1], change[ALL], total[ALL], impulse[ALL], all[ALL];
    double size[ROWS], per_size[ROWS];
    const galerkin_tail_inputs inputs = galerkin_copy_tail_inputs_with_constant_sizes(step_inputs->tail_inputs);
    galerkin_step_inputs local_inputs = *step_inputs;
    galerkin_nodes nodes = galerkin_copy_nodes_with_constant_sizes(step_inputs->nodes);
    hamiltonian_pass_context context =
        *(const hamiltonian_pass_context *)step_inputs->lagrangian_or_hamiltonian_pass_workspace;
    local_inputs.tail_inputs = &inputs;
    context.nodes = &nodes;
    context.derivative_tapes = galerkin_copy_tapes_to_stack_if_small(&context.derivative_tapes, &nodes, &own);
    if (GALERKIN_HAS_LOCAL_BLOCKS)
        galerkin_copy_rows(own.node_values, step_inputs->nodes->values, 0,
                           outcome->equal_step_count > 0 ? 0 : GALERKIN_UNKNOWNS);
    context.nodes_with_rates_as_unknowns =
        galerkin_copy_nodes_with_constant_sizes(&context.nodes_with_rates_as_unknowns);
    context.nodes_with_rates_as_unknowns.values = nodes.values + GALERKIN_UNKNOWNS * GALERKIN_LANES;
    context.rate_row_of_unknown = galerkin_rate_row_of_unknown;
    context.tape_slot_of_rate[false] = galerkin_value_slot;
    context.tape_slot_of_rate[true] = galerkin_hessian_slot;
    context.newton_inner_iteration_data.hessian_column_count = GALERKIN_HESSIAN_COLUMNS;
    context.newton_inner_iteration_data.hessian_row_count = GALERKIN_HESSIAN_ROWS;
    context.newton_inner_iteration_data.unknown_of_row = galerkin_unknown_of_row;
    context.newton_inner_iteration_data.index_in_hessian_block = galerkin_index_in_hessian_block;
    context.newton_inner_iteration_data.hessian_block = context.derivative_tapes.hessian_block;
    if (IS_PACKED) {
        context.newton_inner_iteration_data.packed_hessian = packed;
        context.newton_inner_iteration_data.unknown_size = size;
        context.newton_inner_iteration_data.inverse_unknown_size = per_size;
        context.newton_inner_iteration_data.last_unknown_change = change;
        context.newton_inner_iteration_data.total_unknown_change = total;
        context.newton_inner_iteration_data.last_impulse_change = impulse;
        context.newton_inner_iteration_data.total_impulse_change = all;
    }
    const galerkin_pass_functions pass_functions = {galerkin_make_hamiltonian_pass, hamiltonian_predict_unknowns, NULL,
                                                    &context};
    galerkin_make_steps(&local_inputs, &nodes, &pass_functions, run, origin, state, outcome);
}

#endif
