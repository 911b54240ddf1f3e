/* generated_hessian.h - Defines the blocks of the tapes of generated passes that know second derivatives (blocks.h).
 * KEPT rows of a block are not set by the tape's operations. */
#ifndef TVI_SRC_GALERKIN_GENERATED_HESSIAN_H
#define TVI_SRC_GALERKIN_GENERATED_HESSIAN_H

#include "galerkin/generated.h"

JET_INLINE bool galerkin_generated_sweep(const galerkin_blocks *blocks, bool with_hessian)
{
    return with_hessian ? GALERKIN_HESSIAN_VALUES(blocks->hessian) : GALERKIN_VALUES(blocks->values);
}

/* Small blocks are local to the step. */
enum {
    GALERKIN_IS_OWN = (tvi_values_slots + tvi_hessian_slots) * GALERKIN_LANES <= GALERKIN_MOST_OWN,
    GALERKIN_OF_VALUES = GALERKIN_IS_OWN ? tvi_values_slots * GALERKIN_LANES : 1,
    GALERKIN_OF_HESSIAN = GALERKIN_IS_OWN ? (tvi_hessian_slots + 1) * GALERKIN_LANES : 1,
    GALERKIN_OF_ROWS = GALERKIN_IS_OWN ? 5 * GALERKIN_N * GALERKIN_LANES : 1
};
typedef struct {
    _Alignas(64) double values[GALERKIN_OF_VALUES];
    _Alignas(64) double hessian[GALERKIN_OF_HESSIAN];
    _Alignas(64) double x[GALERKIN_OF_ROWS];
} galerkin_local_blocks;

JET_INLINE galerkin_blocks galerkin_own_blocks(const galerkin_blocks *given, galerkin_nodes *nodes,
                                               galerkin_local_blocks *own)
{
    galerkin_blocks blocks = *given;
    blocks.n = GALERKIN_N;
    blocks.lanes = GALERKIN_LANES;
    blocks.inputs = GALERKIN_INPUTS;
    if (!GALERKIN_IS_OWN) return blocks;
    galerkin_keep_rows(own->values, given->values, 2 * GALERKIN_N, GALERKIN_KEPT);
    galerkin_keep_rows(own->hessian, given->hessian, GALERKIN_INPUTS, GALERKIN_HESSIAN_KEPT);
    galerkin_keep_rows(own->hessian, given->hessian, tvi_hessian_slots, tvi_hessian_slots + 1);
    blocks.values = own->values;
    blocks.hessian = own->hessian;
    nodes->x = own->x;
    return blocks;
}

#endif
