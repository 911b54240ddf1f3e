/* tape_pad.c - Lengthens the runs of a tape to whole vectors (pad.h). */
#include "pad.h"
#include "rule.h"

#include <stdlib.h>
#include <string.h>

enum { VECTOR = 8, FEW = VECTOR / 2 };

typedef struct {
    jet_tape *tape;
    const jet_run **maker; /* [slots] the run that makes the slot; NULL: it is given */
    int *copies;           /* [slots] number of copies that follow the slot */
    bool *begins;          /* [slots] a vector begins here */
    int *moved;            /* [slots] the new slot */
} padding;

static int missing(int count)
{
    const int rest = count % VECTOR;
    return count > VECTOR && rest > FEW ? VECTOR - rest : 0;
}

/* The first slot of the k-th operand of a run that is no sum of multiples; -1: there are no more. */
static int operand(const jet_tape *tape, const jet_run *run, int k)
{
    if (run->terms == 0) return k == 0 ? run->a : k == 1 && jet_rules[run->op]->operands == 2 ? run->b : -1;
    if (k >= 2 * run->terms) return -1;
    const int term = run->term + k / 2;
    return k % 2 == 0 || run->op == OP_SQUARES ? tape->term_slot[term] : tape->term_operand_b[term];
}

static int last_of(const jet_run *run, int first) { return first + run->count - 1; }

/* Tells whether the last operation of the run can have copies: what it reads has as many, or may have. */
static bool can_be_padded(const padding *p, const jet_run *run)
{
    if (run->op == OP_LINEAR || run->is_scattered || run->w != 0 || missing(run->count) == 0) return false;
    for (int k = 0, first; (first = operand(p->tape, run, k)) >= 0; k++) {
        const int slot = last_of(run, first);
        if (!p->maker[slot]) return false;
        if (p->maker[slot]->op != OP_LINEAR && p->copies[slot] < missing(run->count)) return false;
    }
    return true;
}

/* Requests copies for the range of the run that begins at this slot. */
static void request(const padding *p, const jet_run *run, int first)
{
    const int slot = last_of(run, first), count = missing(run->count);
    if (p->copies[slot] < count) p->copies[slot] = count;
    p->begins[first] = true;
}

/* Requests copies for all runs. Operands stand before their readers. */
static void request_copies(const padding *p)
{
    for (const jet_run *run = p->tape->run, *const end = run + p->tape->runs; run < end; run++) {
        for (int i = 0; i < run->count; i++) p->maker[run->z + i] = run;
        const bool is_even = run->op != OP_LINEAR && run->count % VECTOR == 0;
        if (!is_even && !can_be_padded(p, run)) continue;
        request(p, run, run->z);
        for (int k = 0, first; (first = operand(p->tape, run, k)) >= 0; k++) request(p, run, first);
    }
}

static int rounded(int slot) { return (slot + VECTOR - 1) / VECTOR * VECTOR; }

/* Finds the new slots. Returns how many there are. Inputs and constants stay where they are. */
static int find_new_slots(const padding *p)
{
    int slot_after = 0;
    for (int slot = 0; slot < p->tape->slots; slot++) {
        if (p->begins[slot] && p->maker[slot]) slot_after = rounded(slot_after);
        p->moved[slot] = slot_after;
        slot_after += 1 + p->copies[slot];
    }
    return rounded(slot_after);
}

static bool is_whole(const padding *p, const jet_run *run, int first)
{
    return p->moved[last_of(run, first)] == last_of(run, p->moved[first]);
}

/* Tells whether the operations and the operands of a run are still adjacent. */
static bool all_are_whole(const padding *p)
{
    for (const jet_run *run = p->tape->run, *const end = run + p->tape->runs; run < end; run++) {
        if (run->op == OP_LINEAR) continue;
        if (!is_whole(p, run, run->z) || (run->w != 0 && !is_whole(p, run, run->w))) return false;
        for (int k = 0, first; (first = operand(p->tape, run, k)) >= 0; k++)
            if (!is_whole(p, run, first)) return false;
    }
    return true;
}

static void add_terms(const padding *p, jet_tape *to, int first, int count)
{
    const jet_tape *tape = p->tape;
    for (int term = first; term < first + count; term++, to->terms++) {
        to->term_slot[to->terms] = p->moved[tape->term_slot[term]];
        to->term_operand_b[to->terms] = p->moved[tape->term_operand_b[term]];
        to->term_coefficient[to->terms] = tape->term_coefficient[term];
    }
}

static void add_run(const padding *p, jet_tape *to, const jet_run *run)
{
    jet_run next = *run;
    next.z = p->moved[run->z];
    next.a = p->moved[run->a];
    next.b = p->moved[run->b];
    next.w = p->moved[run->w];
    next.term = to->terms;
    if (run->op != OP_LINEAR) {
        next.count += p->copies[last_of(run, run->z)];
        add_terms(p, to, run->term, run->terms);
        to->run[to->runs++] = next;
        return;
    }
    next.count = 0;
    next.first = to->rows;
    for (int i = 0; i < run->count; i++)
        for (int copy = 0; copy <= p->copies[run->z + i]; copy++, next.count++) {
            if (p->moved[run->z + i] + copy != next.z + next.count) { /* a vector begins */
                to->run[to->runs++] = next;
                next.z = p->moved[run->z + i];
                next.count = 0;
                next.first = to->rows;
                next.term = to->terms;
            }
            to->base[to->rows++] = p->tape->base[run->first + i];
            add_terms(p, to, run->term + i * run->terms, run->terms);
        }
    to->run[to->runs++] = next;
}

static void fill(const padding *p, jet_tape *to)
{
    const jet_tape *tape = p->tape;
    for (int slot = 0; slot < tape->slots; slot++)
        for (int copy = 0; copy <= p->copies[slot]; copy++)
            to->recorded[p->moved[slot] + copy] = copy == 0 ? tape->recorded[slot] : 0;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++) add_run(p, to, run);
    for (int i = 0; i < tape->outputs; i++) to->output[i] = p->moved[tape->output[i]];
}

/* Builds the new tape. Scattered products, which only values have, have terms of their own. */
static bool build(const padding *p, int new_slots)
{
    jet_tape *tape = p->tape, to = *tape;
    size_t terms = 1;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        terms += (size_t)run->count * (size_t)run->terms * (VECTOR - FEW);
    const size_t slots = (size_t)new_slots + 1;
    to.slots = new_slots;
    to.rows = to.terms = to.runs = 0;
    to.run = calloc(slots, sizeof *to.run);
    to.base = calloc(slots, sizeof *to.base);
    to.recorded = calloc(slots, sizeof *to.recorded);
    to.term_slot = calloc(terms, sizeof *to.term_slot);
    to.term_operand_b = calloc(terms, sizeof *to.term_operand_b);
    to.term_coefficient = calloc(terms, sizeof *to.term_coefficient);
    const bool has_memory =
        to.run && to.base && to.recorded && to.term_slot && to.term_operand_b && to.term_coefficient;
    if (has_memory) fill(p, &to);
    const jet_tape *left = has_memory ? tape : &to;
    free(left->run);
    free(left->base);
    free(left->recorded);
    free(left->term_slot);
    free(left->term_operand_b);
    free(left->term_coefficient);
    if (has_memory) *tape = to;
    return has_memory;
}

static bool is_long(const jet_tape *tape)
{
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        if (run->op != OP_LINEAR && run->count >= VECTOR) return true;
    return false;
}

bool jet_tape_pad(jet_tape *tape)
{
    const size_t slots = (size_t)tape->slots + 1;
    const padding p = {.tape = tape,
                       .maker = calloc(slots, sizeof(jet_run *)),
                       .copies = calloc(slots, sizeof(int)),
                       .begins = calloc(slots, sizeof(bool)),
                       .moved = calloc(slots, sizeof(int))};
    bool has_memory = p.maker && p.copies && p.begins && p.moved;
    if (has_memory) {
        request_copies(&p);
        const int new_slots = find_new_slots(&p);
        if (is_long(tape) && all_are_whole(&p)) has_memory = build(&p, new_slots);
    }
    free(p.maker);
    free(p.copies);
    free(p.begins);
    free(p.moved);
    return has_memory;
}
