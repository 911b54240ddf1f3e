/* tape_split.c - Splits the runs of a tape, which are loops over equal operations, into single operations (split.h).
 * emit.c calls it. */
#include "rule.h"
#include "split.h"

#include <stdlib.h>

typedef struct {
    const jet_tape *tape;
    jet_tape *split_tape;
    /* [slot_count] The run that computes the slot; NULL: the operation is already on the new tape, or the slot is no
     * result. */
    const jet_run_of_operations **producing_run;
} run_splitting;

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

static void append_split_terms(jet_tape *split, const jet_tape *tape, int first, int count, int slot_shift)
{
    for (int term = first; term < first + count; term++, split->terms.count++) {
        split->terms.slot[split->terms.count] = tape->terms.slot[term] + slot_shift;
        split->terms.slot_b[split->terms.count] = tape->terms.slot_b[term] + slot_shift;
        split->terms.coefficient[split->terms.count] = tape->terms.coefficient[term];
    }
}

/* Appends `count` operations of the run to the new tape, as one run. The first has the number first_operation in the
 * old run, counted from 0. */
static void append_split_run(const run_splitting *splitting, const jet_run_of_operations *run, int first_operation,
                             int count)
{
    const jet_tape *tape = splitting->tape;
    jet_run_of_operations part = *run;
    part.operation_count = count;
    part.z += first_operation;
    part.first_term_index = splitting->split_tape->terms.count;
    if (run->op == OP_LINEAR)
        append_split_terms(splitting->split_tape, tape, run->first_term_index + first_operation * run->term_count,
                           count * run->term_count, 0);
    else append_split_terms(splitting->split_tape, tape, run->first_term_index, run->term_count, first_operation);
    if (run->term_count == 0) {
        part.a += first_operation;
        part.b += jet_rules[run->op]->operand_count == 2 ? first_operation : 0;
    }
    if (run->op == OP_LINEAR) part.first_constant_term_index += first_operation;
    splitting->split_tape->runs[splitting->split_tape->run_count++] = part;
}

static void split_runs_in_tape_order(const run_splitting *splitting, jet_runs_to_split runs_to_split)
{
    for (const jet_run_of_operations *run = splitting->tape->runs;
         run < splitting->tape->runs + splitting->tape->run_count; run++) {
        const bool is_apart = runs_to_split == JET_SPLIT_SUMS && run->op == OP_LINEAR;
        for (int i = 0; i < (is_apart ? run->operation_count : 1); i++)
            append_split_run(splitting, run, i, is_apart ? 1 : run->operation_count);
    }
}

/* ---- One by one, as they are wanted ------------------------------------------------------------------------------ */

int jet_operation_operand_slot(const jet_tape *tape, const jet_run_of_operations *run, int i, int k)
{
    const int reads = run->term_count > 0 ? run->term_count : 1, which = k % reads;
    if (k >= (run->op == OP_LINEAR ? reads : 2 * reads)) return -1;
    if (run->term_count == 0) return k == 0 ? run->a + i : jet_rules[run->op]->operand_count == 2 ? run->b + i : -1;
    const int term = run->first_term_index + which + (run->op == OP_LINEAR ? i * run->term_count : 0),
              slot_shift = run->op == OP_LINEAR ? 0 : i;
    return slot_shift + (k < reads ? tape->terms.slot[term] : tape->terms.slot_b[term]);
}

void jet_tape_mark_dependents(const jet_tape *tape, bool is_dependent[])
{
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        for (int i = 0; i < run->operation_count; i++) {
            bool *z = &is_dependent[run->z + i];
            *z = false;
            for (int k = 0, a; (a = jet_operation_operand_slot(tape, run, i, k)) >= 0; k++) *z = *z || is_dependent[a];
        }
}

/* Tells whether the operation of reading_slot reads newest_slot, whose operation was appended last, and all its
 * operands are on the new tape. */
static bool is_slot_ready_after(const run_splitting *splitting, int reading_slot, int newest_slot)
{
    const jet_run_of_operations *run = splitting->producing_run[reading_slot];
    bool reads = false;
    for (int k = 0, a; (a = jet_operation_operand_slot(splitting->tape, run, reading_slot - run->z, k)) >= 0; k++) {
        if (splitting->producing_run[a]) return false;
        reads |= a == newest_slot;
    }
    return reads;
}

/* Appends the operations that the slot reads, then the operation of the slot, and then those operations that waited
 * for this one alone. */
static void append_operation_with_dependents(const run_splitting *splitting, int slot)
{
    const jet_run_of_operations *run = splitting->producing_run[slot];
    if (!run) return;
    for (int k = 0, a; (a = jet_operation_operand_slot(splitting->tape, run, slot - run->z, k)) >= 0; k++)
        append_operation_with_dependents(splitting, a);
    if (!splitting->producing_run[slot]) return;
    append_split_run(splitting, run, slot - run->z, 1);
    splitting->producing_run[slot] = NULL;
    for (int next = 0; next < splitting->tape->slot_count; next++)
        if (splitting->producing_run[next] && is_slot_ready_after(splitting, next, slot))
            append_operation_with_dependents(splitting, next);
}

static void split_runs_in_dependence_order(const run_splitting *splitting)
{
    const jet_tape *tape = splitting->tape;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        for (int i = 0; i < run->operation_count; i++) splitting->producing_run[run->z + i] = run;
    for (int i = 0; i < tape->output_count; i++) append_operation_with_dependents(splitting, tape->output_slot[i]);
    for (int slot = 0; slot < tape->slot_count; slot++) append_operation_with_dependents(splitting, slot);
}

/* ------------------------------------------------------------------------------------------------------------------ */

void jet_free_split_tape(jet_tape *split)
{
    free(split->runs);
    free(split->terms.slot);
    free(split->terms.slot_b);
    free(split->terms.coefficient);
}

bool jet_tape_split_runs(jet_tape *split, const jet_tape *tape, jet_runs_to_split runs_to_split)
{
    size_t terms = 1;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        terms += (size_t)run->operation_count * (size_t)run->term_count;
    const size_t slots = (size_t)tape->slot_count + 1;
    *split = *tape;
    split->run_count = split->terms.count = 0;
    split->runs = calloc(slots, sizeof *split->runs);
    split->terms.slot = calloc(terms, sizeof *split->terms.slot);
    split->terms.slot_b = calloc(terms, sizeof *split->terms.slot_b);
    split->terms.coefficient = calloc(terms, sizeof *split->terms.coefficient);
    const run_splitting splitting = {tape, split, calloc(slots, sizeof(jet_run_of_operations *))};
    const bool has_memory =
        splitting.producing_run && split->runs && split->terms.slot && split->terms.slot_b && split->terms.coefficient;
    if (!has_memory) jet_free_split_tape(split);
    else if (runs_to_split == JET_SPLIT_ALL) split_runs_in_dependence_order(&splitting);
    else split_runs_in_tape_order(&splitting, runs_to_split);
    free(splitting.producing_run);
    return has_memory;
}
