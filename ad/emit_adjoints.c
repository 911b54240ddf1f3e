/* emit_adjoints.c - Writes the adjoint functions of generated code (emit_adjoints.h). emit.c calls it. */
#include "devices.h"
#include "emit_adjoints.h"
#include "split.h"

#include <stdlib.h>

/* The state while adjoint functions are written. For each slot, is_set says that the code so far adds to or sets its
 * adjoint, and is_assigned that the first access is an assignment. */
typedef struct {
    jet_text *text;
    const jet_tape *tape;
    bool *is_set, *is_assigned;
} adjoint_emitter;

/* ---- First access to an adjoint ---------------------------------------------------------------------------------- */

static bool are_adjoints_unset(const adjoint_emitter *emitter, int slot, int count)
{
    for (int i = slot; i < slot + count; i++)
        if (emitter->is_set[i]) return false;
    return true;
}

static void mark_adjoints_set(const adjoint_emitter *emitter, int slot, int count, bool is_assignment)
{
    for (int i = slot; i < slot + count; i++) {
        emitter->is_set[i] = true;
        emitter->is_assigned[i] = emitter->is_assigned[i] || is_assignment;
    }
}

/* Tells whether the run's adjoint rule (jet_adjoint_rule) adds only to adjoints of the order that is being swept, and
 * all operands have adjacent slots. */
static bool adds_to_current_order_only(const jet_run *run)
{
    return run->op == OP_PRODUCTS || run->op == OP_SQUARES || run->op == OP_POW || run->op == OP_SQRT;
}

/* Marks the adjoints of all operands and partners of the run as set. */
static void mark_operand_adjoints_set(const adjoint_emitter *emitter, const jet_run *run)
{
    for (int i = 0; i < run->operation_count; i++)
        for (int k = 0, slot; (slot = jet_operation_operand_slot(emitter->tape, run, i, k)) >= 0; k++)
            mark_adjoints_set(emitter, slot, 1, false);
    if (run->terms == 0) mark_adjoints_set(emitter, run->w, run->operation_count, false);
}

/* Marks the adjoints that are already nonzero when the sweep reaches an order: those of inputs and outputs, and
 * those to which the sweeps of higher orders add. */
static void mark_initially_set_adjoints(const adjoint_emitter *emitter)
{
    mark_adjoints_set(emitter, 0, emitter->tape->inputs, false);
    for (int i = 0; i < emitter->tape->outputs; i++)
        mark_adjoints_set(emitter, emitter->tape->output_slot[i], 1, false);
    for (const jet_run *run = emitter->tape->run; run < emitter->tape->run + emitter->tape->runs; run++) {
        if (adds_to_current_order_only(run) || run->op == OP_LINEAR) continue;
        mark_adjoints_set(emitter, run->z, run->operation_count, false);
        mark_operand_adjoints_set(emitter, run);
    }
}

/* Returns the first slot of an operand of the run. Operand 2 t is the first factor of term t, and operand 2 t + 1
 * the second one. The result is -1 if there is no such operand. */
static int operand_first_slot(const jet_tape *tape, const jet_run *run, int operand)
{
    const int term = run->term + operand / 2;
    if (run->terms == 0) return operand == 0 ? run->a : -1;
    if (operand % 2 == 0) return tape->term_slot[term];
    return run->op == OP_PRODUCTS ? tape->term_operand_b[term] : -1;
}

/* Marks those operands of the run whose adjoints the run may assign, instead of adding to them: no code before has
 * set them, and their slots overlap with no other operand of the run. */
static void mark_assigned_operands(const adjoint_emitter *emitter, jet_run *run)
{
    const int operands = run->terms > 0 ? 2 * run->terms : 1;
    for (int operand = 0; operand < operands; operand++) {
        const int row = operand_first_slot(emitter->tape, run, operand);
        bool is_fresh = JET_HAS(FRESH) && row >= 0 && are_adjoints_unset(emitter, row, run->operation_count);
        for (int other = 0; other < operands; other++)
            is_fresh = is_fresh && (other == operand || operand_first_slot(emitter->tape, run, other) < 0 ||
                                    abs(operand_first_slot(emitter->tape, run, other) - row) >= run->operation_count);
        if (is_fresh) run->assigned_operands |= 1 << operand;
    }
    for (int operand = 0; operand < operands; operand++)
        if (operand_first_slot(emitter->tape, run, operand) >= 0)
            mark_adjoints_set(emitter, operand_first_slot(emitter->tape, run, operand), run->operation_count,
                              run->assigned_operands >> operand & 1);
}

static void emit_clear_adjoints_function(const adjoint_emitter *emitter, const char *name)
{
    const int slots = emitter->tape->slots;
    jet_text_append(emitter->text, "JET_INLINE void %s_clear(double *bar)\n{\n", name);
    for (int slot = emitter->tape->inputs; slot < slots; slot++) {
        int count = 0;
        while (slot + count < slots && !emitter->is_assigned[slot + count]) count++;
        if (count == 0) continue;
        jet_text_append(emitter->text, "    jet_set_to_zero(bar + %d, %d);\n", slot, count);
        slot += count - 1;
    }
    jet_text_append(emitter->text, "}\n");
}

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

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
static void emit_adjoint_contributions(const adjoint_emitter *emitter, const jet_run *first, const jet_run *end,
                                       int slot)
{
    const bool is_fresh = JET_HAS(FRESH) && are_adjoints_unset(emitter, slot, 1);
    const jet_tape *tape = emitter->tape;
    bool has_any = false;
    for (const jet_run *run = first; run < end; run++)
        for (int term = run->term; term < run->term + run->terms; term++) {
            if (tape->term_slot[term] != slot) continue;
            if (!has_any) jet_text_append(emitter->text, "    bar[%d] = ", slot);
            if (!has_any && !is_fresh) jet_text_append(emitter->text, "bar[%d]", slot);
            jet_text_append(emitter->text, has_any || !is_fresh ? " + %a * bar[%d]" : "%a * bar[%d]",
                            tape->term_coefficient[term], run->z);
            has_any = true;
        }
    if (has_any) jet_text_append(emitter->text, ";\n");
    if (has_any) mark_adjoints_set(emitter, slot, 1, is_fresh);
}

static void emit_sum_adjoints_function(const adjoint_emitter *emitter, const jet_run *first, const jet_run *end,
                                       const char *name)
{
    jet_text_append(emitter->text, "JET_INLINE void %s_sums_back_%d(double *bar)\n{\n", name,
                    (int)(first - emitter->tape->run));
    for (int slot = 0; slot < first->z; slot++) emit_adjoint_contributions(emitter, first, end, slot);
    jet_text_append(emitter->text, "}\n");
}

/* ------------------------------------------------------------------------------------------------------------------ */

/* Writes the adjoint functions, and marks the operands that are assigned, in the order in which the sweep runs. */
static void emit_all_adjoints(const adjoint_emitter *emitter, const char *name)
{
    mark_initially_set_adjoints(emitter);
    for (jet_run *run = emitter->tape->run + emitter->tape->runs; run-- > emitter->tape->run;) {
        const jet_run *first = jet_is_single_sum(run) ? jet_first_adjacent_sum(emitter->tape, run) : NULL;
        if (first && jet_end_of_adjacent_sums(emitter->tape, first) == run + 1)
            emit_sum_adjoints_function(emitter, first, run + 1, name);
        else if (adds_to_current_order_only(run)) mark_assigned_operands(emitter, run);
        else if (!first) mark_operand_adjoints_set(emitter, run);
    }
    emit_clear_adjoints_function(emitter, name);
}

void jet_emit_adjoints(jet_text *text, const jet_tape *tape, const char *name)
{
    bool *all = calloc(2 * (size_t)tape->slots, sizeof *all);
    if (all) emit_all_adjoints(&(adjoint_emitter){text, tape, all, all + tape->slots}, name);
    else text->is_incomplete = true;
    free(all);
}
