/* emit_cubes.c - see emit_cubes.h. */
#include "emit_cubes.h"

/* What a slot is a multiple of. */
static int root_of(const jet_tape *tape, int slot)
{
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) {
        const int i = slot - run->z;
        if (i < 0 || i >= run->count) continue;
        const bool is_multiple = run->op == OP_LINEAR && run->terms == 1 && tape->base[run->first + i] == 0;
        return is_multiple ? root_of(tape, tape->term_slot[run->term + i]) : slot;
    }
    return slot;
}

/* The run of squares, of one term each, that has the slots from here on, so many; NULL: they are something else. */
static const jet_run *squares_at(const jet_tape *tape, int slot, int count)
{
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        if (run->op == OP_SQUARES && run->terms == 1 && run->z <= slot && slot + count <= run->z + run->count)
            return run;
    return NULL;
}

/* Whether the one factor is a square of a multiple of what the other one is a multiple of. */
static bool is_square_of(const jet_tape *tape, int square, int factor, int count)
{
    const jet_run *squares = squares_at(tape, square, count);
    if (!squares) return false;
    const int squared = tape->term_slot[squares->term] + square - squares->z;
    for (int i = 0; i < count; i++)
        if (root_of(tape, factor + i) != root_of(tape, squared + i)) return false;
    return true;
}

jet_cubes jet_are_cubes(const jet_tape *tape, const jet_run *run)
{
    if (run->op != OP_PRODUCTS || run->terms != 1) return JET_NO_CUBES;
    const int first = tape->term_slot[run->term], second = tape->term_second[run->term];
    if (is_square_of(tape, first, second, run->count)) return JET_SQUARES_FIRST;
    return is_square_of(tape, second, first, run->count) ? JET_SQUARES_SECOND : JET_NO_CUBES;
}

/* Whether one of the slots from `first` on, so many, lies in the run's slots of one operand. */
static bool meets(int first, int count, int operand, int members)
{
    return first < operand + members && operand < first + count;
}

static bool reads(const jet_tape *tape, const jet_run *run, int first, int count)
{
    if (run->op == OP_LINEAR) {
        for (int term = run->term; term < run->term + run->count * run->terms; term++)
            if (meets(first, count, tape->term_slot[term], 1)) return true;
        return false;
    }
    if (run->op != OP_PRODUCTS && run->op != OP_SQUARES)
        return meets(first, count, run->a, run->count) || meets(first, count, run->b, run->count) ||
               meets(first, count, run->w, run->count);
    for (int term = run->term; term < run->term + run->terms; term++) {
        if (meets(first, count, tape->term_slot[term], run->count)) return true;
        if (run->op == OP_PRODUCTS && meets(first, count, tape->term_second[term], run->count)) return true;
    }
    return false;
}

bool jet_are_bases(const jet_tape *tape, const jet_run *run)
{
    if (run->op != OP_SQUARES || run->terms != 1) return false;
    for (int i = 0; i < tape->outputs; i++)
        if (meets(run->z, run->count, tape->output[i], 1)) return false;
    bool is_base = false;
    for (const jet_run *next = tape->run; next < tape->run + tape->runs; next++) {
        if (!reads(tape, next, run->z, run->count)) continue;
        if (jet_are_cubes(tape, next) == JET_NO_CUBES) return false;
        is_base = true;
    }
    return is_base;
}
