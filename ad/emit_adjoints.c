/* emit_adjoints.c - Writes the adjoints of generated code (emit_adjoints.h). */
#include "devices.h"
#include "emit_adjoints.h"
#include "split.h"

#include <stdlib.h>

/* State of each slot while adjoints are written. touched: something was added to its adjoint; written: the first
 * addition is an assignment. */
typedef struct {
    jet_text *text;
    const jet_tape *tape;
    bool *touched, *written;
} adjoints;

/* ---- What is written first --------------------------------------------------------------------------------------- */

static bool is_untouched(const adjoints *a, int slot, int count)
{
    for (int i = slot; i < slot + count; i++)
        if (a->touched[i]) return false;
    return true;
}

static void touch(const adjoints *a, int slot, int count, bool is_written)
{
    for (int i = slot; i < slot + count; i++) {
        a->touched[i] = true;
        a->written[i] = a->written[i] || is_written;
    }
}

/* Tells whether the run's adjoint adds to its own order alone (rule.h), and to operands in rows. */
static bool is_gathered(const jet_run *run)
{
    return run->op == OP_PRODUCTS || run->op == OP_SQUARES || run->op == OP_POW || run->op == OP_SQRT;
}

/* Marks all slots that the run reads, also as a partner, as touched. */
static void touch_all(const adjoints *a, const jet_run *run)
{
    for (int i = 0; i < run->count; i++)
        for (int k = 0, slot; (slot = jet_operand_slot(a->tape, run, i, k)) >= 0; k++) touch(a, slot, 1, false);
    if (run->terms == 0) touch(a, run->w, run->count, false);
}

/* Marks the slots that hold something before a sweep comes to the order, or that sweeps of higher orders add to. */
static void touch_before(const adjoints *a)
{
    touch(a, 0, a->tape->inputs, false);
    for (int i = 0; i < a->tape->outputs; i++) touch(a, a->tape->output[i], 1, false);
    for (const jet_run *run = a->tape->run; run < a->tape->run + a->tape->runs; run++) {
        if (is_gathered(run) || run->op == OP_LINEAR) continue;
        touch(a, run->z, run->count, false);
        touch_all(a, run);
    }
}

/* The first slot of an operand: 2 t is the first factor of term t, 2 t + 1 the second one; -1: there is none. */
static int first_slot(const jet_tape *tape, const jet_run *run, int operand)
{
    const int term = run->term + operand / 2;
    if (run->terms == 0) return operand == 0 ? run->a : -1;
    if (operand % 2 == 0) return tape->term_slot[term];
    return run->op == OP_PRODUCTS ? tape->term_operand_b[term] : -1;
}

/* Marks the operands of a run that nothing was added to, and that overlap with no other operand of the run. */
static void mark_fresh(const adjoints *a, jet_run *run)
{
    const int operands = run->terms > 0 ? 2 * run->terms : 1;
    for (int operand = 0; operand < operands; operand++) {
        const int row = first_slot(a->tape, run, operand);
        bool is_fresh = JET_HAS(FRESH) && row >= 0 && is_untouched(a, row, run->count);
        for (int other = 0; other < operands; other++)
            is_fresh = is_fresh && (other == operand || first_slot(a->tape, run, other) < 0 ||
                                    abs(first_slot(a->tape, run, other) - row) >= run->count);
        if (is_fresh) run->fresh |= 1 << operand;
    }
    for (int operand = 0; operand < operands; operand++)
        if (first_slot(a->tape, run, operand) >= 0)
            touch(a, first_slot(a->tape, run, operand), run->count, run->fresh >> operand & 1);
}

static void emit_clear(const adjoints *a, const char *name)
{
    const int slots = a->tape->slots;
    jet_text_add(a->text, "JET_INLINE void %s_clear(double *bar)\n{\n", name);
    for (int slot = a->tape->inputs; slot < slots; slot++) {
        int count = 0;
        while (slot + count < slots && !a->written[slot + count]) count++;
        if (count == 0) continue;
        jet_text_add(a->text, "    jet_clear(bar + %d, %d);\n", slot, count);
        slot += count - 1;
    }
    jet_text_add(a->text, "}\n");
}

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

/* Whether the sum reads this slot or a later one. */
static bool reads_from(const jet_tape *tape, const jet_run *run, int slot)
{
    for (int term = run->term; term < run->term + run->terms; term++)
        if (tape->term_slot[term] >= slot) return true;
    return false;
}

const jet_run *jet_first_sum(const jet_tape *tape, const jet_run *run)
{
    const jet_run *first = run;
    while (first > tape->run && jet_is_sum(first - 1)) first--;
    for (const jet_run *next = first; next <= run; next++)
        if (reads_from(tape, next, first->z)) first = next;
    return first;
}

const jet_run *jet_end_of_sums(const jet_tape *tape, const jet_run *first)
{
    const jet_run *const end = tape->run + tape->runs, *next = first;
    while (next < end && jet_is_sum(next) && jet_first_sum(tape, next) == first) next++;
    return next;
}

/* Writes the contributions of the sums to the adjoint of a slot. */
static void emit_contributions(const adjoints *a, const jet_run *first, const jet_run *end, int slot)
{
    const bool is_fresh = JET_HAS(FRESH) && is_untouched(a, slot, 1);
    const jet_tape *tape = a->tape;
    bool has_any = false;
    for (const jet_run *run = first; run < end; run++)
        for (int term = run->term; term < run->term + run->terms; term++) {
            if (tape->term_slot[term] != slot) continue;
            if (!has_any) jet_text_add(a->text, "    bar[%d] = ", slot);
            if (!has_any && !is_fresh) jet_text_add(a->text, "bar[%d]", slot);
            jet_text_add(a->text, has_any || !is_fresh ? " + %a * bar[%d]" : "%a * bar[%d]",
                         tape->term_coefficient[term], run->z);
            has_any = true;
        }
    if (has_any) jet_text_add(a->text, ";\n");
    if (has_any) touch(a, slot, 1, is_fresh);
}

static void emit_sums_back(const adjoints *a, const jet_run *first, const jet_run *end, const char *name)
{
    jet_text_add(a->text, "JET_INLINE void %s_sums_back_%d(double *bar)\n{\n", name, (int)(first - a->tape->run));
    for (int slot = 0; slot < first->z; slot++) emit_contributions(a, first, end, slot);
    jet_text_add(a->text, "}\n");
}

/* ------------------------------------------------------------------------------------------------------------------ */

/* Writes the adjoints in the order of a sweep. */
static void emit(const adjoints *a, const char *name)
{
    touch_before(a);
    for (jet_run *run = a->tape->run + a->tape->runs; run-- > a->tape->run;) {
        const jet_run *first = jet_is_sum(run) ? jet_first_sum(a->tape, run) : NULL;
        if (first && jet_end_of_sums(a->tape, first) == run + 1) emit_sums_back(a, first, run + 1, name);
        else if (is_gathered(run)) mark_fresh(a, run);
        else if (!first) touch_all(a, run);
    }
    emit_clear(a, name);
}

void jet_emit_adjoints(jet_text *text, const jet_tape *tape, const char *name)
{
    bool *all = calloc(2 * (size_t)tape->slots, sizeof *all);
    if (all) emit(&(adjoints){text, tape, all, all + tape->slots}, name);
    else text->failed = true;
    free(all);
}
