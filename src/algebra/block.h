/* block.h - Allocates blocks, the arrays of numbers on which tapes work (ad/tape.h), in an arena, and sets the
 * constants and parameters in them. The arena keeps a list of its blocks. */
#ifndef TVI_SRC_ALGEBRA_BLOCK_H
#define TVI_SRC_ALGEBRA_BLOCK_H

#include "algebra/arena.h"
#include "tape.h"

/* A block that is allocated in an arena. */
struct tvi_tape_block {
    const jet_tape *tape;
    double *x; /* [orders][slots][lanes] The Taylor coefficients of all slots of the tape (ad/tape.h). */
    int orders, lanes;
    const tvi_tape_block *next;
};

/* Allocates a block of the tape, followed by room for `extra_numbers` numbers, and adds it to the arena's list. */
double *tvi_arena_allocate_block(tvi_arena *arena, const jet_tape *tape, int orders, int lanes, size_t extra_numbers);

/* Sets the constants of all blocks of the list. The memory of the arena must have been obtained. */
void tvi_blocks_set_constants(const tvi_tape_block *first);
/* Sets parameter i, i < count, to value[i] in all blocks of the list, after their constants are set. */
void tvi_blocks_set_parameters(const tvi_tape_block *first, int count, const double value[]);

#endif
