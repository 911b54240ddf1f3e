/* generated_hessian.h - Evaluates, in generated code, the gradient and the second derivatives of a Lagrangian or a
 * Hamiltonian at all nodes of a Galerkin step (blocks.h). The numbers of both computations are in two arrays,
 * gradient_block and hessian_block, which are local variables of the step if they are small. Their first
 * GALERKIN_READ_ONLY_ROWS and GALERKIN_HESSIAN_READ_ONLY_ROWS rows contain inputs and constants, which the computations
 * read and do not set. */
#ifndef TVI_SRC_GALERKIN_GENERATED_HESSIAN_H
#define TVI_SRC_GALERKIN_GENERATED_HESSIAN_H

#include "galerkin/generated.h"

JET_INLINE bool galerkin_sweep_generated_tape(const galerkin_derivative_tapes *tapes, bool with_hessian)
{
    return with_hessian ? GALERKIN_HESSIAN_VALUES(tapes->hessian_block) : GALERKIN_VALUES(tapes->gradient_block);
}

/* The lengths of the local copies of gradient_block, of hessian_block and of the rows of nodes->values. If the blocks
 * are longer than GALERKIN_MAX_LOCAL, there are no local copies, and the lengths are 1. */
enum {
    GALERKIN_HAS_LOCAL_BLOCKS = (tvi_values_slots + tvi_hessian_slots) * GALERKIN_LANES <= GALERKIN_MAX_LOCAL,
    GALERKIN_VALUES_LENGTH = GALERKIN_HAS_LOCAL_BLOCKS ? tvi_values_slots * GALERKIN_LANES : 1,
    GALERKIN_HESSIAN_LENGTH = GALERKIN_HAS_LOCAL_BLOCKS ? (tvi_hessian_slots + 1) * GALERKIN_LANES : 1,
    GALERKIN_ROWS_LENGTH = GALERKIN_HAS_LOCAL_BLOCKS ? 5 * GALERKIN_N * GALERKIN_LANES : 1
};
typedef struct {
    _Alignas(64) double gradient_block[GALERKIN_VALUES_LENGTH];
    _Alignas(64) double hessian_block[GALERKIN_HESSIAN_LENGTH];
    _Alignas(64) double node_values[GALERKIN_ROWS_LENGTH];
} galerkin_stack_copies_of_tape_blocks;

/* Returns the tapes with constant sizes. If copies on the stack are short enough, they replace the blocks and
 * nodes->values. The rows that a tape reads and does not set are then copied into them. */
JET_INLINE galerkin_derivative_tapes galerkin_copy_tapes_to_stack_if_small(
    const galerkin_derivative_tapes *tapes, galerkin_nodes *nodes, galerkin_stack_copies_of_tape_blocks *stack_copies)
{
    galerkin_derivative_tapes stack_tapes = *tapes;
    stack_tapes.coordinate_count = GALERKIN_N;
    stack_tapes.lane_count = GALERKIN_LANES;
    stack_tapes.input_count = GALERKIN_INPUTS;
    if (!GALERKIN_HAS_LOCAL_BLOCKS) return stack_tapes;
    galerkin_copy_rows(stack_copies->gradient_block, tapes->gradient_block, 2 * GALERKIN_N, GALERKIN_READ_ONLY_ROWS);
    galerkin_copy_rows(stack_copies->hessian_block, tapes->hessian_block, GALERKIN_INPUTS,
                       GALERKIN_HESSIAN_READ_ONLY_ROWS);
    galerkin_copy_rows(stack_copies->hessian_block, tapes->hessian_block, tvi_hessian_slots, tvi_hessian_slots + 1);
    stack_tapes.gradient_block = stack_copies->gradient_block;
    stack_tapes.hessian_block = stack_copies->hessian_block;
    nodes->values = stack_copies->node_values;
    return stack_tapes;
}

#endif
