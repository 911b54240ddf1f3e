/* emit_eights.c - see emit_eights.h. */
#include "emit_eights.h"

enum { EIGHT = JET_EIGHT };

/* ---- Which they are ---------------------------------------------------------------------------------------------- */

/* Term t of sum i; the next ones may lack it, and, where no sum had so many before, those before it. */
static void add(jet_eight *sums, int i, int term, int slot, double coefficient)
{
    for (int other = term < sums->terms ? i : 0; other < EIGHT; other++) sums->slot[term][other] = slot;
    sums->coefficient[term][i] = coefficient;
}

/* Nothing is made at these slots, which the tape has. */
static bool are_free(const jet_tape *tape, int from, int to)
{
    if (to > tape->slots) return false;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        if (run->z < to && run->z + run->count > from) return false;
    return true;
}

int jet_find_eight(const jet_tape *tape, const jet_run *run, jet_eight *sums)
{
    const jet_run *const end = tape->run + tape->runs;
    int count = 0;
    if (run->z % EIGHT != 0 || run->terms > JET_EIGHT_TERMS) return 0;
    *sums = (jet_eight){.z = run->z, .terms = run->terms};
    for (const jet_run *next = run; next < end && count < EIGHT; next++, count++) {
        const bool fits = jet_is_sum(next) && next->terms == run->terms && next->z == run->z + count;
        if (!fits || next->has_numbers || jet_reads_from(tape, next, run->z)) break;
        for (int term = 0; term < run->terms; term++)
            add(sums, count, term, tape->term_slot[next->term + term], tape->term_coefficient[next->term + term]);
    }
    return count > 1 && are_free(tape, run->z + count, run->z + EIGHT) ? count : 0;
}

/* To the i-th of them; how many terms that is. */
static int find_handed_on(const jet_tape *tape, const jet_run *first, const jet_run *end, int i, jet_eight *sums)
{
    int terms = 0;
    for (const jet_run *run = first; run < end; run++)
        for (int term = run->term; term < run->term + run->terms; term++)
            if (tape->term_slot[term] == sums->z + i && terms++ < JET_EIGHT_TERMS)
                add(sums, i, terms - 1, run->z, tape->term_coefficient[term]);
    return terms;
}

bool jet_find_eight_back(const jet_tape *tape, const jet_run *first, const jet_run *end, int slot, jet_eight *sums)
{
    *sums = (jet_eight){.z = slot};
    if (slot % EIGHT != 0 || slot + EIGHT > first->z || end[-1].z / EIGHT * EIGHT + EIGHT > tape->slots) return false;
    for (int i = 0; i < EIGHT; i++) {
        const int terms = find_handed_on(tape, first, end, i, sums);
        if ((i == 0 && terms == 0) || terms > JET_EIGHT_TERMS) return false;
        if (terms > sums->terms) sums->terms = terms;
    }
    return true;
}

/* ---- How they are made ------------------------------------------------------------------------------------------- */

/* The blocks of eight slots that the term reads. */
static int find_blocks(const jet_eight *sums, int term, int block[])
{
    int count = 0;
    for (int i = 0; i < EIGHT; i++) {
        const int at = sums->slot[term][i] / EIGHT;
        int known = 0;
        while (known < count && block[known] != at) known++;
        if (known == count) block[count++] = at;
    }
    return count;
}

/* Two numbers where no other of the block is read: they may have been stored alone. */
static void emit_block(jet_text *text, const jet_eight *sums, int term, int block, const char *x)
{
    bool is_short = true;
    for (int i = 0; i < EIGHT; i++) {
        const int slot = sums->slot[term][i];
        is_short = is_short && (slot / EIGHT != block || slot % EIGHT < 2);
    }
    jet_text_add(text, "JET_%s_AT(%s, %d)", is_short ? "TWO" : "EIGHT", x, EIGHT * block);
}

/* The eight numbers that a term reads: those of the first two blocks, into which those of each other one go. */
static void emit_numbers(jet_text *text, const jet_eight *sums, int term, const char *x)
{
    int block[EIGHT];
    const int blocks = find_blocks(sums, term, block), pairs = blocks > 1 ? blocks - 1 : 1;
    for (int pair = 0; pair < pairs; pair++) jet_text_add(text, "JET_SHUFFLE_8(");
    emit_block(text, sums, term, block[0], x);
    for (int pair = 0; pair < pairs; pair++) {
        const int second = block[blocks > 1 ? pair + 1 : 0];
        jet_text_add(text, ", ");
        emit_block(text, sums, term, second, x);
        for (int i = 0; i < EIGHT; i++) {
            const int slot = sums->slot[term][i], at = slot % EIGHT, kept = pair == 0 ? at : i;
            jet_text_add(text, ", %d", slot / EIGHT == second && blocks > 1 ? EIGHT + at : kept);
        }
        jet_text_add(text, ")");
    }
}

void jet_emit_eight(jet_text *text, const jet_eight *sums, const char *x, bool adds)
{
    jet_text_add(text, "    JET_EIGHT_AT(%s, %d) = ", x, sums->z);
    if (adds) jet_text_add(text, "JET_EIGHT_AT(%s, %d) + ", x, sums->z);
    for (int term = 0; term < sums->terms; term++) {
        jet_text_add(text, term > 0 ? " +\n        (jet_v8){" : "(jet_v8){");
        for (int i = 0; i < EIGHT; i++) jet_text_add(text, i > 0 ? ", %a" : "%a", sums->coefficient[term][i]);
        jet_text_add(text, "} * ");
        emit_numbers(text, sums, term, x);
    }
    jet_text_add(text, ";\n");
}
