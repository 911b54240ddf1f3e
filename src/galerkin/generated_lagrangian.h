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
    lagrangian_passes *passes = work;
    (void)nodes;
    if (roundoff || lagrangian_make_pass(passes, galerkin_sweep_generated_tape) != LAGRANGIAN_PASSED)
        return TVI_ENOCONV;
    *movement = passes->last_pass_movement_square;
    return TVI_OK;
}

static void galerkin_make_generated_steps(const galerkin_step_data *step_data, const tvi_run_request *run,
                                          const tvi_step_origin *origin, const tvi_run_state *state,
                                          galerkin_steps_outcome *outcome)
{
    enum { N = GALERKIN_N, ALL = GALERKIN_HAS_LOCAL_BLOCKS ? N * GALERKIN_LANES : 1 };
    galerkin_block_copies own;
    _Alignas(64) double displacements[ALL], rise[2 * ALL], gradient[2 * ALL], movement[2 * ALL];
    _Alignas(64) double lu[N * ALL], inverse[N * ALL], x[ALL];
    const galerkin_rate_tail_data inputs = galerkin_copy_tail_inputs_with_constant_sizes(step_data->tail_inputs);
    galerkin_step_data local_data = *step_data;
    galerkin_nodes nodes = galerkin_copy_nodes_with_constant_sizes(step_data->nodes);
    lagrangian_passes passes = *(const lagrangian_passes *)step_data->form_work;
    local_data.tail_inputs = &inputs;
    passes.inversion_count = 0;
    passes.nodes = &nodes;
    passes.tape_blocks = galerkin_make_local_blocks(&passes.tape_blocks, &nodes, &own);
    if (GALERKIN_HAS_LOCAL_BLOCKS)
        galerkin_copy_rows(own.node_values, step_data->nodes->values, 0, outcome->equal_step_count > 0 ? 0 : 3 * N);
    passes.rate_nodes = galerkin_copy_nodes_with_constant_sizes(&passes.rate_nodes);
    passes.rate_nodes.values = nodes.values + 2 * N * GALERKIN_LANES;
    passes.rate_row_of_unknown = galerkin_rate_row_of_unknown;
    passes.gradient_slot[false] = galerkin_value_slot;
    passes.gradient_slot[true] = galerkin_hessian_slot;
    passes.gradient_expansion.n = passes.velocity_hessian_inverse.n = N;
    passes.gradient_expansion.lane_count = GALERKIN_LANES;
    passes.gradient_expansion.hessian_block = passes.tape_blocks.hessian_block;
    passes.gradient_expansion.hessian_element = galerkin_hessian_element;
    passes.gradient_expansion.row_end = galerkin_row_end;
    if (GALERKIN_HAS_LOCAL_BLOCKS) {
        galerkin_copy_rows(displacements, passes.coordinate_minus_drift, 0, outcome->equal_step_count > 0 ? 0 : N);
        passes.coordinate_minus_drift = displacements;
        passes.drift_minus_centre[0] = rise;
        passes.drift_minus_centre[1] = rise + ALL;
        passes.gradient_expansion.gradient_at_centre = passes.gradient_at_centre = gradient;
        passes.gradient_expansion.displacement = movement;
        passes.velocity_hessian_inverse.matrix = lu;
        passes.velocity_hessian_inverse.inverse = inverse;
        passes.velocity_hessian_inverse.scratch_column = x;
    }
    const galerkin_pass_functions pass_functions = {galerkin_make_lagrangian_pass, lagrangian_predict_unknowns, NULL,
                                                    &passes};
    galerkin_make_steps(&local_data, &nodes, &pass_functions, run, origin, state, outcome);
    outcome->inversion_pass_count = passes.inversion_count;
}

#endif
