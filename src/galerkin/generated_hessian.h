/* generated_hessian.h - Evaluates the tapes of generated passes that use second derivatives (blocks.h), in blocks that
 * are local variables of the step. The first GALERKIN_READ_ONLY_ROWS rows of gradient_block and the first
 * GALERKIN_HESSIAN_READ_ONLY_ROWS rows of hessian_block contain inputs and constants, which a tape reads and does not
 * set. */
#ifndef TVI_SRC_GALERKIN_GENERATED_HESSIAN_H
#define TVI_SRC_GALERKIN_GENERATED_HESSIAN_H

#include "galerkin/generated.h"

JET_INLINE bool galerkin_sweep_generated_tape(const galerkin_tape_blocks *blocks, bool with_hessian)
{
    return with_hessian ? GALERKIN_HESSIAN_VALUES(blocks->hessian_block) : GALERKIN_VALUES(blocks->gradient_block);
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
} galerkin_block_copies;

/* Returns the blocks with constant sizes. If local copies are short enough, they replace the blocks and nodes->values.
 * The rows that a tape reads and does not set are then copied into them. */
JET_INLINE galerkin_tape_blocks galerkin_make_local_blocks(const galerkin_tape_blocks *blocks, galerkin_nodes *nodes,
                                                           galerkin_block_copies *copies)
{
    galerkin_tape_blocks local_blocks = *blocks;
    local_blocks.n = GALERKIN_N;
    local_blocks.lane_count = GALERKIN_LANES;
    local_blocks.input_count = GALERKIN_INPUTS;
    if (!GALERKIN_HAS_LOCAL_BLOCKS) return local_blocks;
    galerkin_copy_rows(copies->gradient_block, blocks->gradient_block, 2 * GALERKIN_N, GALERKIN_READ_ONLY_ROWS);
    galerkin_copy_rows(copies->hessian_block, blocks->hessian_block, GALERKIN_INPUTS, GALERKIN_HESSIAN_READ_ONLY_ROWS);
    galerkin_copy_rows(copies->hessian_block, blocks->hessian_block, tvi_hessian_slots, tvi_hessian_slots + 1);
    local_blocks.gradient_block = copies->gradient_block;
    local_blocks.hessian_block = copies->hessian_block;
    nodes->values = copies->node_values;
    return local_blocks;
}

#endif
