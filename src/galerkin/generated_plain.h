/* generated_plain.h - Makes Galerkin steps in generated code, for a system whose step equations are solved by a
 * fixed-point iteration: each iteration, called a pass, evaluates the force alone, without second derivatives
 * (field.c). */
#ifndef TVI_SRC_GALERKIN_GENERATED_PLAIN_H
#define TVI_SRC_GALERKIN_GENERATED_PLAIN_H

#include "galerkin/generated.h"

/* The number of nodes that one vector register holds. It is used if the tape's operations are emitted as separate
 * functions (tvi_values_is_split). The tape is then evaluated for the nodes of one register at a time, and the impulses
 * are the only results that are stored. Otherwise the tape is evaluated for all nodes at once. */
enum { GALERKIN_NODES_PER_REGISTER = GALERKIN_LANES % WIDEST == 0 ? WIDEST : 4 };

#define COPY_VECTOR(V, blocks) BLOCK_AT(V, destination, 0) = BLOCK_OF(V, source, 0);
JET_INLINE void galerkin_copy_tape_inputs_and_constants(double *destination, const double *source)
{
    JET_UNROLL(256)
    for (int i = 0; i < GALERKIN_READ_ONLY_ROWS;
         i++, destination += GALERKIN_NODES_PER_REGISTER, source += GALERKIN_LANES)
        ALL_LANES(GALERKIN_NODES_PER_REGISTER, COPY_VECTOR)
}

#define STORE_IMPULSES(V, blocks)                                                                                      \
    BLOCK_AT(V, impulse, 0) = BLOCK_OF(V, weight, 0) *                                                                 \
                              BLOCK_OF(V, block + galerkin_rate_row_of_unknown[u] * GALERKIN_NODES_PER_REGISTER, 0);
JET_INLINE void galerkin_store_impulses(double *impulse, const double *weight, const double *block)
{
    JET_UNROLL(256)
    for (int u = 0; u < GALERKIN_UNKNOWNS; u++, impulse += GALERKIN_LANES)
        ALL_LANES(GALERKIN_NODES_PER_REGISTER, STORE_IMPULSES)
}

/* Evaluates the force at all nodes, and sets the impulses. Returns false if an operand is outside its domain. */
JET_INLINE bool galerkin_sweep_force_tape(const galerkin_nodes *nodes)
{
    bool is_inside = true;
    if (!tvi_values_is_split) {
        is_inside = GALERKIN_VALUES(nodes->values);
        NAME(set_impulses)(nodes, nodes->values, galerkin_rate_row_of_unknown);
    }
    for (int first = 0; tvi_values_is_split && first < GALERKIN_LANES; first += GALERKIN_NODES_PER_REGISTER) {
        _Alignas(64) double block[tvi_values_slots * GALERKIN_NODES_PER_REGISTER];
        galerkin_copy_tape_inputs_and_constants(block, nodes->values + first);
        is_inside &= VALUES_OF(tvi_values, block, GALERKIN_NODES_PER_REGISTER);
        galerkin_store_impulses(nodes->impulses + first, nodes->impulse_weight + first, block);
    }
    return is_inside;
}

/* Makes a pass. Returns TVI_ENOCONV if `roundoff` is not NULL: the library then makes the step again, and can measure
 * the roundoff of a pass. Returns TVI_EDOMAIN if an operand is outside its domain. */
JET_INLINE tvi_status galerkin_make_fixed_point_pass(void *work, const galerkin_nodes *nodes, double *movement,
                                                     double *roundoff)
{
    const galerkin_step_inputs *step_inputs = work;
    if (roundoff) return TVI_ENOCONV;
    if (!galerkin_sweep_force_tape(nodes)) return TVI_EDOMAIN;
    *movement = NAME(move_unknowns)(nodes, step_inputs->node_impulse_to_node_unknown_matrix, NULL);
    return TVI_OK;
}

JET_INLINE void galerkin_predict_fixed_point_unknowns(void *work, const galerkin_nodes *nodes,
                                                      const galerkin_extrapolation *extrapolation)
{
    (void)work;
    NAME(predict)(nodes, extrapolation);
}

static void galerkin_make_generated_steps(const galerkin_step_inputs *step_inputs, const tvi_run_request *run,
                                          const tvi_step_origin *origin, const tvi_run_state *state,
                                          galerkin_steps_outcome *outcome)
{
    const galerkin_tail_inputs inputs = galerkin_copy_tail_inputs_with_constant_sizes(step_inputs->tail_inputs);
    galerkin_step_inputs local_inputs = *step_inputs;
    galerkin_nodes nodes = galerkin_copy_nodes_with_constant_sizes(step_inputs->nodes);
    local_inputs.tail_inputs = &inputs;
    local_inputs.passes_rule = &galerkin_rule;
    const galerkin_pass_functions pass_functions = {galerkin_make_fixed_point_pass,
                                                    galerkin_predict_fixed_point_unknowns, NULL, &local_inputs};
    galerkin_make_steps(&local_inputs, &nodes, &pass_functions, run, origin, state, outcome);
}

#endif
