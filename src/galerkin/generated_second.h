/* generated_second.h - the blocks of the tapes of generated passes that know second derivatives (blocks.h). Of a block
 * so many rows are KEPT: they are not set by the tape's operations. */
#ifndef TVI_SRC_GALERKIN_GENERATED_SECOND_H
#define TVI_SRC_GALERKIN_GENERATED_SECOND_H

#include "galerkin/generated.h"

JET_INLINE bool galerkin_generated_sweep(const galerkin_blocks *blocks, bool with_second)
{
    return with_second ? GALERKIN_SECOND_VALUES(blocks->second) : GALERKIN_VALUES(blocks->values);
}

/* Small blocks are the step's own. */
enum {
    GALERKIN_IS_OWN = (tvi_values_slots + tvi_second_slots) * GALERKIN_LANES <= GALERKIN_MOST_OWN,
    GALERKIN_OF_VALUES = GALERKIN_IS_OWN ? tvi_values_slots * GALERKIN_LANES : 1,
    GALERKIN_OF_SECOND = GALERKIN_IS_OWN ? (tvi_second_slots + 1) * GALERKIN_LANES : 1,
    GALERKIN_OF_ROWS = GALERKIN_IS_OWN ? 5 * GALERKIN_N * GALERKIN_LANES : 1
};
typedef struct {
    _Alignas(64) double values[GALERKIN_OF_VALUES];
    _Alignas(64) double second[GALERKIN_OF_SECOND];
    _Alignas(64) double x[GALERKIN_OF_ROWS];
} galerkin_room;

JET_INLINE galerkin_blocks galerkin_own_blocks(const galerkin_blocks *of, galerkin_nodes *nodes, galerkin_room *own)
{
    galerkin_blocks blocks = *of;
    blocks.n = GALERKIN_N;
    blocks.lanes = GALERKIN_LANES;
    blocks.inputs = GALERKIN_INPUTS;
    if (!GALERKIN_IS_OWN) return blocks;
    galerkin_keep_rows(own->values, of->values, 2 * GALERKIN_N, GALERKIN_KEPT);
    galerkin_keep_rows(own->second, of->second, GALERKIN_INPUTS, GALERKIN_SECOND_KEPT);
    galerkin_keep_rows(own->second, of->second, tvi_second_slots, tvi_second_slots + 1);
    blocks.values = own->values;
    blocks.second = own->second;
    nodes->x = own->x;
    return blocks;
}

#endif
