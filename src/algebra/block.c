/* block.c - Allocates blocks, the arrays of numbers on which tapes work, and sets the constants and parameters in them
 * (block.h). */
#include "algebra/block.h"

double *tvi_arena_allocate_block(tvi_arena *arena, const jet_tape *tape, int orders, int lanes, size_t extra_numbers)
{
    const size_t numbers = (size_t)tape->slot_count * (size_t)orders * (size_t)lanes;
    tvi_tape_block *block = tvi_arena_allocate(arena, sizeof *block);
    double *x = tvi_arena_allocate_doubles(arena, numbers + extra_numbers);
    if (!block) return NULL;
    *block = (tvi_tape_block){tape, x, orders, lanes, arena->first_tape_block};
    arena->first_tape_block = block;
    return x;
}

void tvi_blocks_set_constants(const tvi_tape_block *first)
{
    for (const tvi_tape_block *block = first; block; block = block->next)
        jet_tape_write_constants(block->tape, block->x, block->orders, block->lanes);
}

void tvi_blocks_set_parameters(const tvi_tape_block *first, int count, const double value[])
{
    for (const tvi_tape_block *block = first; block; block = block->next)
        jet_tape_set_parameters(block->tape, block->x, block->lanes, count, 1, value);
}
