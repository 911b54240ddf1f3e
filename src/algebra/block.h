/* block.h - blocks of tapes in the arena: the numbers that a system recorded stand in them, and are changed there. */
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

/* A block of the tape, with room for `more` numbers behind it; the arena keeps a list of them. */
double *tvi_arena_block(tvi_arena *arena, const jet_tape *tape, int orders, int lanes, size_t more);

/* Fills all blocks of the list with the constants of their tapes, once the memory, all zeros, is there. */
void tvi_blocks_prepare(const tvi_block *first);
/* value[i][width] of parameter i, i < count, in all blocks that are prepared, every width lanes again. */
void tvi_blocks_set_parameters(const tvi_block *first, int count, int width, const double value[]);

#endif
