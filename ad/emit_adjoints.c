/* emit_adjoints.c - Writes the adjoint functions of generated code (emit_adjoints.h). emit.c calls it. */
#include "emit_adjoints.h"

/* Tells whether a sum has a term in this slot or in a later one. */
static bool reads_slot_at_or_after(const jet_tape *tape, const jet_run *run, int slot)
{
    for (int term = run->term; term < run->term + run->terms; term++)
        if (tape->term_slot[term] >= slot) return true;
    return false;
}

const jet_run *jet_first_adjacent_sum(const jet_tape *tape, const jet_run *run)
{
    const jet_run *first = run;
    while (first > tape->run && jet_is_single_sum(first - 1)) first--;
    for (const jet_run *next = first; next <= run; next++)
        if (reads_slot_at_or_after(tape, next, first->z)) first = next;
    return first;
}

const jet_run *jet_end_of_adjacent_sums(const jet_tape *tape, const jet_run *first)
{
    const jet_run *const end = tape->run + tape->runs, *next = first;
    while (next < end && jet_is_single_sum(next) && jet_first_adjacent_sum(tape, next) == first) next++;
    return next;
}

/* Writes one statement that adds the contributions of these sums to the adjoint of a slot. */
static void emit_adjoint_contributions(jet_text *text, const jet_tape *tape, const jet_run *first, const jet_run *end,
                                       int slot)
{
    bool has_any = false;
    for (const jet_run *run = first; run < end; run++)
        for (int term = run->term; term < run->term + run->terms; term++) {
            if (tape->term_slot[term] != slot) continue;
            if (!has_any) jet_text_append(text, "    bar[%d] = bar[%d]", slot, slot);
            jet_text_append(text, " + %a * bar[%d]", tape->term_coefficient[term], run->z);
            has_any = true;
        }
    if (has_any) jet_text_append(text, ";\n");
}

void jet_emit_adjoints(jet_text *text, const jet_tape *tape, const char *name)
{
    for (const jet_run *first = tape->run; first < tape->run + tape->runs; first++) {
        if (!jet_is_single_sum(first) || jet_first_adjacent_sum(tape, first) != first) continue;
        jet_text_append(text, "JET_INLINE void %s_sums_back_%d(double *bar)\n{\n", name, (int)(first - tape->run));
        for (int slot = 0; slot < first->z; slot++)
            emit_adjoint_contributions(text, tape, first, jet_end_of_adjacent_sums(tape, first), slot);
        jet_text_append(text, "}\n");
    }
}
