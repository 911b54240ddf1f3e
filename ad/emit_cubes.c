/* emit_cubes.c - see emit_cubes.h. */
#include "emit_cubes.h"
#include "split.h"

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
        if (run->op == OP_SQUARES && run->terms == 1 && !run->is_scattered && run->z <= slot &&
            slot + count <= run->z + run->count)
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
    if (run->op != OP_PRODUCTS || run->terms != 1 || run->is_scattered) return JET_NO_CUBES;
    const int first = tape->term_slot[run->term], second = tape->term_second[run->term];
    if (is_square_of(tape, first, second, run->count)) return JET_SQUARES_FIRST;
    return is_square_of(tape, second, first, run->count) ? JET_SQUARES_SECOND : JET_NO_CUBES;
}

/* As an operand or, as tangents do, as a partner. */
static bool reads(const jet_tape *tape, const jet_run *run, int slot)
{
    for (int i = 0; i < run->count; i++)
        for (int k = 0, a; (a = jet_read_by(tape, run, i, k)) >= 0; k++)
            if (a == slot) return true;
    return run->terms == 0 && run->w <= slot && slot < run->w + run->count;
}

/* An output, or read by anything but cubes. */
static bool is_read(const jet_tape *tape, int slot)
{
    for (int i = 0; i < tape->outputs; i++)
        if (tape->output[i] == slot) return true;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        if (reads(tape, run, slot) && jet_are_cubes(tape, run) == JET_NO_CUBES) return true;
    return false;
}

bool jet_are_bases(const jet_tape *tape, const jet_run *run)
{
    if (run->op != OP_SQUARES || run->terms != 1) return false;
    for (int i = 0; i < run->count; i++)
        if (is_read(tape, run->z + i)) return false;
    return true;
}
