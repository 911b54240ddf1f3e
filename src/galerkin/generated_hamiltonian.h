/* generated_hamiltonian.h - Makes steps in generated code, for a Hamiltonian whose passes use second derivatives
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
    hamiltonian_passes *passes = work;
    (void)nodes;
    if (roundoff || !hamiltonian_make_pass(passes, galerkin_sweep_generated_tape)) return TVI_ENOCONV;
    *movement = passes->last_pass_movement_square;
    return TVI_OK;
}

/* Makes steps in a row. The matrix of the inner iterations has GALERKIN_HESSIAN_ROWS rows and GALERKIN_HESSIAN_COLUMNS
 * columns. */
static void galerkin_make_generated_steps(const galerkin_step_data *step_data, const tvi_run_request *run,
                                          const tvi_step_origin *origin, const tvi_run_state *state,
                                          galerkin_steps_outcome *outcome)
{
    enum {
        PACKED = GALERKIN_HESSIAN_ROWS * GALERKIN_HESSIAN_COLUMNS * GALERKIN_LANES,
        IS_PACKED = PACKED <= 2 * GALERKIN_MAX_LOCAL
    };
    enum { ROWS = IS_PACKED ? GALERKIN_HESSIAN_ROWS : 1, ALL = IS_PACKED ? GALERKIN_HESSIAN_ROWS * GALERKIN_LANES : 1 };
    galerkin_block_copies own;
    _Alignas(64) float packed[IS_PACKED ? PACKED : 1], change[ALL], total[ALL], impulse[ALL], all[ALL];
    double size[ROWS], per_size[ROWS];
    const galerkin_rate_tail_data inputs = galerkin_copy_tail_inputs_with_constant_sizes(step_data->tail_inputs);
    galerkin_step_data local_data = *step_data;
    galerkin_nodes nodes = galerkin_copy_nodes_with_constant_sizes(step_data->nodes);
    hamiltonian_passes passes = *(const hamiltonian_passes *)step_data->form_work;
    local_data.tail_inputs = &inputs;
    passes.nodes = &nodes;
    passes.tape_blocks = galerkin_make_local_blocks(&passes.tape_blocks, &nodes, &own);
    if (GALERKIN_HAS_LOCAL_BLOCKS)
        galerkin_copy_rows(own.node_values, step_data->nodes->values, 0,
                           outcome->equal_step_count > 0 ? 0 : GALERKIN_UNKNOWNS);
    passes.rate_nodes = galerkin_copy_nodes_with_constant_sizes(&passes.rate_nodes);
    passes.rate_nodes.values = nodes.values + GALERKIN_UNKNOWNS * GALERKIN_LANES;
    passes.rate_row_of_unknown = galerkin_rate_row_of_unknown;
    passes.rate_slot[false] = galerkin_value_slot;
    passes.rate_slot[true] = galerkin_hessian_slot;
    passes.newton_inner_iteration_data.hessian_column_count = GALERKIN_HESSIAN_COLUMNS;
    passes.newton_inner_iteration_data.hessian_row_count = GALERKIN_HESSIAN_ROWS;
    passes.newton_inner_iteration_data.unknown_of_row = galerkin_unknown_of_row;
    passes.newton_inner_iteration_data.index_in_hessian_block = galerkin_index_in_hessian_block;
    passes.newton_inner_iteration_data.hessian_block = passes.tape_blocks.hessian_block;
    if (IS_PACKED) {
        passes.newton_inner_iteration_data.packed_hessian = packed;
        passes.newton_inner_iteration_data.unknown_size = size;
        passes.newton_inner_iteration_data.inverse_unknown_size = per_size;
        passes.newton_inner_iteration_data.last_unknown_change = change;
        passes.newton_inner_iteration_data.total_unknown_change = total;
        passes.newton_inner_iteration_data.last_impulse_change = impulse;
        passes.newton_inner_iteration_data.total_impulse_change = all;
    }
    const galerkin_pass_functions pass_functions = {galerkin_make_hamiltonian_pass, hamiltonian_predict_unknowns, NULL,
                                                    &passes};
    galerkin_make_steps(&local_data, &nodes, &pass_functions, run, origin, state, outcome);
}

#endif
