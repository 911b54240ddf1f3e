/* tape_pad.c - Lengthens the runs of a tape to whole vectors (jet_pad_runs_to_whole_vectors). tape.c calls it. */
#include "lowering.h"
#include "split.h"

#include <stdlib.h>

/* The number of operations of a whole vector. */
enum { VECTOR = 8 };

typedef struct {
    jet_tape *tape;
    const jet_run **producing_run; /* [slot_count] The run that computes the slot; NULL: an input or a constant. */
    int *copy_counts;              /* [slot_count] Number of copies of the slot, which follow it on the new tape. */
    bool *begins_vector;           /* [slot_count] Tells whether a vector begins at the slot. */
    int *new_slot;                 /* [slot_count] New number of the slot. */
} run_padding;

static int padding_count(int operation_count)
{
    const int rest = operation_count % VECTOR;
    return operation_count > VECTOR && rest > TAPE_PAD_MAX_UNPADDED_REST ? VECTOR - rest : 0;
}

static int last_slot_of_range(const jet_run *run, int first) { return first + run->operation_count - 1; }

/* Tells whether the last operation of the run can be repeated: each of its operands must have as many copies as the run
 * lacks operations, or be a sum, which can always be copied. */
static bool can_pad_run(const run_padding *p, const jet_run *run)
{
    if (run->op == OP_LINEAR || run->is_scattered || run->w != 0 || padding_count(run->operation_count) == 0)
        return false;
    for (int k = 0, first; (first = jet_operation_operand_slot(p->tape, run, 0, k)) >= 0; k++) {
        const int slot = last_slot_of_range(run, first);
        if (!p->producing_run[slot]) return false;
        if (p->producing_run[slot]->op != OP_LINEAR && p->copy_counts[slot] < padding_count(run->operation_count))
            return false;
    }
    return true;
}

/* Requests copies of the last slot of the range of slots that begins at `first` and has the length of the run. */
static void request_copies_of_last_slot(const run_padding *p, const jet_run *run, int first)
{
    const int slot = last_slot_of_range(run, first), count = padding_count(run->operation_count);
    if (p->copy_counts[slot] < count) p->copy_counts[slot] = count;
    p->begins_vector[first] = true;
}

/* Requests copies for all runs that can be padded, and for their operands. Operands precede their readers on the
 * tape. */
static void request_copies_for_all_runs(const run_padding *p)
{
    for (const jet_run *run = p->tape->run, *const end = run + p->tape->run_count; run < end; run++) {
        for (int i = 0; i < run->operation_count; i++) p->producing_run[run->z + i] = run;
        const bool is_even = run->op != OP_LINEAR && run->operation_count % VECTOR == 0;
        if (!is_even && !can_pad_run(p, run)) continue;
        request_copies_of_last_slot(p, run, run->z);
        for (int k = 0, first; (first = jet_operation_operand_slot(p->tape, run, 0, k)) >= 0; k++)
            request_copies_of_last_slot(p, run, first);
    }
}

static int round_up_to_vector(int slot) { return (slot + VECTOR - 1) / VECTOR * VECTOR; }

/* Assigns the new slots. Returns their number. Inputs and constants keep their slots. */
static int assign_new_slots(const run_padding *p)
{
    int slot_after = 0;
    for (int slot = 0; slot < p->tape->slot_count; slot++) {
        if (p->begins_vector[slot] && p->producing_run[slot]) slot_after = round_up_to_vector(slot_after);
        p->new_slot[slot] = slot_after;
        slot_after += 1 + p->copy_counts[slot];
    }
    return round_up_to_vector(slot_after);
}

static bool are_operand_slots_still_adjacent(const run_padding *p, const jet_run *run, int first)
{
    return p->new_slot[last_slot_of_range(run, first)] == last_slot_of_range(run, p->new_slot[first]);
}

/* Tells whether the results and the operands of every run still have adjacent slots. */
static bool are_slots_of_all_runs_still_adjacent(const run_padding *p)
{
    for (const jet_run *run = p->tape->run, *const end = run + p->tape->run_count; run < end; run++) {
        if (run->op == OP_LINEAR) continue;
        if (!are_operand_slots_still_adjacent(p, run, run->z) ||
            (run->w != 0 && !are_operand_slots_still_adjacent(p, run, run->w)))
            return false;
        for (int k = 0, first; (first = jet_operation_operand_slot(p->tape, run, 0, k)) >= 0; k++)
            if (!are_operand_slots_still_adjacent(p, run, first)) return false;
    }
    return true;
}

static void append_renumbered_terms(const run_padding *p, jet_tape *to, int first, int count)
{
    const jet_tape *tape = p->tape;
    for (int term = first; term < first + count; term++, to->term_count++) {
        to->term_slot[to->term_count] = p->new_slot[tape->term_slot[term]];
        to->term_operand_b[to->term_count] = p->new_slot[tape->term_operand_b[term]];
        to->term_coefficient[to->term_count] = tape->term_coefficient[term];
    }
}

static void append_padded_run(const run_padding *p, jet_tape *to, const jet_run *run)
{
    jet_run next = *run;
    next.z = p->new_slot[run->z];
    next.a = p->new_slot[run->a];
    next.b = p->new_slot[run->b];
    next.w = p->new_slot[run->w];
    next.first_term = to->term_count;
    if (run->op != OP_LINEAR) {
        next.operation_count += p->copy_counts[last_slot_of_range(run, run->z)];
        append_renumbered_terms(p, to, run->first_term, run->term_count);
        to->run[to->run_count++] = next;
        return;
    }
    next.operation_count = 0;
    next.first_constant_term = to->linear_operation_count;
    for (int i = 0; i < run->operation_count; i++)
        for (int copy = 0; copy <= p->copy_counts[run->z + i]; copy++, next.operation_count++) {
            if (p->new_slot[run->z + i] + copy != next.z + next.operation_count) {
                /* The next result begins a new vector, and is not adjacent to the one before; the run ends here. */
                to->run[to->run_count++] = next;
                next.z = p->new_slot[run->z + i];
                next.operation_count = 0;
                next.first_constant_term = to->linear_operation_count;
                next.first_term = to->term_count;
            }
            to->constant_terms[to->linear_operation_count++] = p->tape->constant_terms[run->first_constant_term + i];
            append_renumbered_terms(p, to, run->first_term + i * run->term_count, run->term_count);
        }
    to->run[to->run_count++] = next;
}

static void fill_padded_tape(const run_padding *p, jet_tape *to)
{
    const jet_tape *tape = p->tape;
    for (int slot = 0; slot < tape->slot_count; slot++)
        for (int copy = 0; copy <= p->copy_counts[slot]; copy++)
            to->recording_index[p->new_slot[slot] + copy] = copy == 0 ? tape->recording_index[slot] : 0;
    for (const jet_run *run = tape->run; run < tape->run + tape->run_count; run++) append_padded_run(p, to, run);
    for (int i = 0; i < tape->output_count; i++) to->output_slot[i] = p->new_slot[tape->output_slot[i]];
}

/* Builds the new tape, and replaces the old one by it. Tapes of series alone are padded; they have no scattered
 * operands. */
static bool build_padded_tape(const run_padding *p, int new_slot_count)
{
    jet_tape *tape = p->tape, to = *tape;
    size_t terms = 1;
    for (const jet_run *run = tape->run; run < tape->run + tape->run_count; run++)
        terms += (size_t)run->operation_count * (size_t)run->term_count * (VECTOR - TAPE_PAD_MAX_UNPADDED_REST);
    const size_t slots = (size_t)new_slot_count + 1;
    to.slot_count = new_slot_count;
    to.linear_operation_count = to.term_count = to.run_count = 0;
    to.run = calloc(slots, sizeof *to.run);
    to.constant_terms = calloc(slots, sizeof *to.constant_terms);
    to.recording_index = calloc(slots, sizeof *to.recording_index);
    to.term_slot = calloc(terms, sizeof *to.term_slot);
    to.term_operand_b = calloc(terms, sizeof *to.term_operand_b);
    to.term_coefficient = calloc(terms, sizeof *to.term_coefficient);
    const bool has_memory =
        to.run && to.constant_terms && to.recording_index && to.term_slot && to.term_operand_b && to.term_coefficient;
    if (has_memory) fill_padded_tape(p, &to);
    const jet_tape *left = has_memory ? tape : &to;
    free(left->run);
    free(left->constant_terms);
    free(left->recording_index);
    free(left->term_slot);
    free(left->term_operand_b);
    free(left->term_coefficient);
    if (has_memory) *tape = to;
    return has_memory;
}

static bool has_run_of_whole_vector(const jet_tape *tape)
{
    for (const jet_run *run = tape->run; run < tape->run + tape->run_count; run++)
        if (run->op != OP_LINEAR && run->operation_count >= VECTOR) return true;
    return false;
}

bool jet_pad_runs_to_whole_vectors(jet_tape *tape)
{
    const size_t slots = (size_t)tape->slot_count + 1;
    const run_padding p = {.tape = tape,
                           .producing_run = calloc(slots, sizeof(jet_run *)),
                           .copy_counts = calloc(slots, sizeof(int)),
                           .begins_vector = calloc(slots, sizeof(bool)),
                           .new_slot = calloc(slots, sizeof(int))};
    bool has_memory = p.producing_run && p.copy_counts && p.begins_vector && p.new_slot;
    if (has_memory) {
        request_copies_for_all_runs(&p);
        const int new_slot_count = assign_new_slots(&p);
        if (has_run_of_whole_vector(tape) && are_slots_of_all_runs_still_adjacent(&p))
            has_memory = build_padded_tape(&p, new_slot_count);
    }
    free(p.producing_run);
    free(p.copy_counts);
    free(p.begins_vector);
    free(p.new_slot);
    return has_memory;
}
