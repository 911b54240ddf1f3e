/* block.h - Takes blocks for sweeps of tapes in the arena, and fills them with the constants and parameters that a
 * system has recorded. */
#ifndef TVI_SRC_ALGEBRA_BLOCK_H
#define TVI_SRC_ALGEBRA_BLOCK_H

#include "algebra/arena.h"
#include "tape.h"

struct tvi_block {
    const jet_tape *tape;
    double *x; /* [orders][slots][lanes] */
    int orders, lanes;
    const tvi_block *next;
};

/* Takes a block of the tape, with room for `more` numbers after it. The arena keeps a list of the blocks. */
double *tvi_arena_block(tvi_arena *arena, const jet_tape *tape, int orders, int lanes, size_t more);

/* Fills all blocks of the list with the constants of their tapes. The memory has to be there, all zeros. */
void tvi_blocks_prepare(const tvi_block *first);
/* Sets parameter i to value[i][width], i < count, in all prepared blocks. The values repeat after `width` lanes. */
void tvi_blocks_set_parameters(const tvi_block *first, int count, int width, const double value[]);

#endif
