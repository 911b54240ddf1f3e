/* tape_pad.c - Lengthens the runs of a tape, which are loops over equal operations, to whole vectors
 * (jet_pad_runs_to_whole_vectors). tape.c calls it. */
#include "lowering.h"
#include "split.h"

#include <stdlib.h>

/* The number of operations of a whole vector. */
enum { VECTOR = 8 };

typedef struct {
    jet_tape *tape;
    /* [slot_count] The run that computes the slot; NULL: an input or a constant. */
    const jet_run_of_operations **producing_run;
    int *padding_copy_count_of_slot; /* [slot_count] Number of copies of the slot, which follow it on the new tape. */
    bool *must_slot_begin_vector;    /* [slot_count] Tells whether a vector begins at the slot. */
    int *new_slot;                   /* [slot_count] New number of the slot. */
} run_padding;

static int count_padding_operations(int operation_count)
{
    const int rest = operation_count % VECTOR;
    return operation_count > VECTOR && rest > TAPE_PAD_MAX_UNPADDED_REST ? VECTOR - rest : 0;
}

/* Returns the last slot of the results, or of an operand, of a run; their slots begin at first_slot. */
static int find_last_slot_of_run_results_or_operand(const jet_run_of_operations *run, int first_slot)
{
    return first_slot + run->operation_count - 1;
}

/* Tells whether the last operation of the run can be repeated: each of its operands must have as many copies as the run
 * lacks operations, or be a sum, which can always be copied. */
static bool can_pad_run(const run_padding *padding, const jet_run_of_operations *run)
{
    if (run->op == OP_LINEAR || run->w != 0 || count_padding_operations(run->operation_count) == 0) return false;
    for (int k = 0, first; (first = jet_operation_operand_slot(padding->tape, run, 0, k)) >= 0; k++) {
        const int slot = find_last_slot_of_run_results_or_operand(run, first);
        if (!padding->producing_run[slot]) return false;
        if (padding->producing_run[slot]->op != OP_LINEAR &&
            padding->padding_copy_count_of_slot[slot] < count_padding_operations(run->operation_count))
            return false;
    }
    return true;
}

/* Requests copies of the last slot of the results, or of an operand, of a run. These slots begin at first_slot. */
static void request_copies_of_last_slot(const run_padding *padding, const jet_run_of_operations *run, int first_slot)
{
    const int slot = find_last_slot_of_run_results_or_operand(run, first_slot),
              count = count_padding_operations(run->operation_count);
    if (padding->padding_copy_count_of_slot[slot] < count) padding->padding_copy_count_of_slot[slot] = count;
    padding->must_slot_begin_vector[first_slot] = true;
}

/* Requests copies for all runs that can be padded, and for their operands. Operands precede their readers on the
 * tape. */
static void request_padding_copies_for_all_runs(const run_padding *padding)
{
    for (const jet_run_of_operations *run = padding->tape->runs, *const end = run + padding->tape->run_count; run < end;
         run++) {
        for (int i = 0; i < run->operation_count; i++) padding->producing_run[run->z + i] = run;
        const bool is_even = run->op != OP_LINEAR && run->operation_count % VECTOR == 0;
        if (!is_even && !can_pad_run(padding, run)) continue;
        request_copies_of_last_slot(padding, run, run->z);
        for (int k = 0, first; (first = jet_operation_operand_slot(padding->tape, run, 0, k)) >= 0; k++)
            request_copies_of_last_slot(padding, run, first);
    }
}

static int round_slot_up_to_vector(int slot) { return (slot + VECTOR - 1) / VECTOR * VECTOR; }

/* Assigns the new slots. Returns their number. Inputs and constants keep their slots. */
static int assign_new_slots(const run_padding *padding)
{
    int slot_after = 0;
    for (int slot = 0; slot < padding->tape->slot_count; slot++) {
        if (padding->must_slot_begin_vector[slot] && padding->producing_run[slot])
            slot_after = round_slot_up_to_vector(slot_after);
        padding->new_slot[slot] = slot_after;
        slot_after += 1 + padding->padding_copy_count_of_slot[slot];
    }
    return round_slot_up_to_vector(slot_after);
}

static bool are_operand_slots_still_adjacent(const run_padding *padding, const jet_run_of_operations *run,
                                             int first_slot)
{
    return padding->new_slot[find_last_slot_of_run_results_or_operand(run, first_slot)] ==
           find_last_slot_of_run_results_or_operand(run, padding->new_slot[first_slot]);
}

/* Tells whether the results and the operands of every run still have adjacent slots. */
static bool are_slots_of_all_runs_still_adjacent(const run_padding *padding)
{
    for (const jet_run_of_operations *run = padding->tape->runs, *const end = run + padding->tape->run_count; run < end;
         run++) {
        if (run->op == OP_LINEAR) continue;
        if (!are_operand_slots_still_adjacent(padding, run, run->z) ||
            (run->w != 0 && !are_operand_slots_still_adjacent(padding, run, run->w)))
            return false;
        for (int k = 0, first; (first = jet_operation_operand_slot(padding->tape, run, 0, k)) >= 0; k++)
            if (!are_operand_slots_still_adjacent(padding, run, first)) return false;
    }
    return true;
}

static void append_renumbered_terms(const run_padding *padding, jet_tape *padded, int first, int count)
{
    const jet_tape *tape = padding->tape;
    for (int term = first; term < first + count; term++, padded->term_count++) {
        padded->term_slot[padded->term_count] = padding->new_slot[tape->term_slot[term]];
        padded->term_slot_b[padded->term_count] = padding->new_slot[tape->term_slot_b[term]];
        padded->term_coefficient[padded->term_count] = tape->term_coefficient[term];
    }
}

static void append_padded_run(const run_padding *padding, jet_tape *padded, const jet_run_of_operations *run)
{
    jet_run_of_operations next = *run;
    next.z = padding->new_slot[run->z];
    next.a = padding->new_slot[run->a];
    next.b = padding->new_slot[run->b];
    next.w = padding->new_slot[run->w];
    next.first_term_index = padded->term_count;
    if (run->op != OP_LINEAR) {
        next.operation_count +=
            padding->padding_copy_count_of_slot[find_last_slot_of_run_results_or_operand(run, run->z)];
        append_renumbered_terms(padding, padded, run->first_term_index, run->term_count);
        padded->runs[padded->run_count++] = next;
        return;
    }
    next.operation_count = 0;
    next.first_constant_term_index = padded->linear_operation_count;
    for (int i = 0; i < run->operation_count; i++)
        for (int copy = 0; copy <= padding->padding_copy_count_of_slot[run->z + i]; copy++, next.operation_count++) {
            if (padding->new_slot[run->z + i] + copy != next.z + next.operation_count) {
                /* The next result begins a new vector, and is not adjacent to the one before; the run ends here. */
                padded->runs[padded->run_count++] = next;
                next.z = padding->new_slot[run->z + i];
                next.operation_count = 0;
                next.first_constant_term_index = padded->linear_operation_count;
                next.first_term_index = padded->term_count;
            }
            padded->constant_terms[padded->linear_operation_count++] =
                padding->tape->constant_terms[run->first_constant_term_index + i];
            append_renumbered_terms(padding, padded, run->first_term_index + i * run->term_count, run->term_count);
        }
    padded->runs[padded->run_count++] = next;
}

static void fill_padded_tape(const run_padding *padding, jet_tape *padded)
{
    const jet_tape *tape = padding->tape;
    for (int slot = 0; slot < tape->slot_count; slot++)
        for (int copy = 0; copy <= padding->padding_copy_count_of_slot[slot]; copy++)
            padded->recorded_operation_number_of_slot[padding->new_slot[slot] + copy] =
                copy == 0 ? tape->recorded_operation_number_of_slot[slot] : 0;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        append_padded_run(padding, padded, run);
    for (int i = 0; i < tape->output_count; i++) padded->output_slot[i] = padding->new_slot[tape->output_slot[i]];
}

/* Builds the new tape, and replaces the old one by it. */
static bool build_padded_tape(const run_padding *padding, int new_slot_count)
{
    jet_tape *tape = padding->tape, padded = *tape;
    size_t terms = 1;
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        terms += (size_t)run->operation_count * (size_t)run->term_count * (VECTOR - TAPE_PAD_MAX_UNPADDED_REST);
    const size_t slots = (size_t)new_slot_count + 1;
    padded.slot_count = new_slot_count;
    padded.linear_operation_count = padded.term_count = padded.run_count = 0;
    padded.runs = calloc(slots, sizeof *padded.runs);
    padded.constant_terms = calloc(slots, sizeof *padded.constant_terms);
    padded.recorded_operation_number_of_slot = calloc(slots, sizeof *padded.recorded_operation_number_of_slot);
    padded.term_slot = calloc(terms, sizeof *padded.term_slot);
    padded.term_slot_b = calloc(terms, sizeof *padded.term_slot_b);
    padded.term_coefficient = calloc(terms, sizeof *padded.term_coefficient);
    const bool has_memory = padded.runs && padded.constant_terms && padded.recorded_operation_number_of_slot &&
                            padded.term_slot && padded.term_slot_b && padded.term_coefficient;
    if (has_memory) fill_padded_tape(padding, &padded);
    const jet_tape *left = has_memory ? tape : &padded;
    free(left->runs);
    free(left->constant_terms);
    free(left->recorded_operation_number_of_slot);
    free(left->term_slot);
    free(left->term_slot_b);
    free(left->term_coefficient);
    if (has_memory) *tape = padded;
    return has_memory;
}

static bool has_run_of_whole_vector(const jet_tape *tape)
{
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        if (run->op != OP_LINEAR && run->operation_count >= VECTOR) return true;
    return false;
}

bool jet_pad_runs_to_whole_vectors(jet_tape *tape)
{
    const size_t slots = (size_t)tape->slot_count + 1;
    const run_padding padding = {.tape = tape,
                                 .producing_run = calloc(slots, sizeof(jet_run_of_operations *)),
                                 .padding_copy_count_of_slot = calloc(slots, sizeof(int)),
                                 .must_slot_begin_vector = calloc(slots, sizeof(bool)),
                                 .new_slot = calloc(slots, sizeof(int))};
    bool has_memory = padding.producing_run && padding.padding_copy_count_of_slot && padding.must_slot_begin_vector &&
                      padding.new_slot;
    if (has_memory) {
        request_padding_copies_for_all_runs(&padding);
        const int new_slot_count = assign_new_slots(&padding);
        if (has_run_of_whole_vector(tape) && are_slots_of_all_runs_still_adjacent(&padding))
            has_memory = build_padded_tape(&padding, new_slot_count);
    }
    free(padding.producing_run);
    free(padding.padding_copy_count_of_slot);
    free(padding.must_slot_begin_vector);
    free(padding.new_slot);
    return has_memory;
}
