/* tape_split.c - Splits the runs of a tape into single operations (split.h). */
#include "rule.h"
#include "split.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
    const jet_tape *tape;
    jet_tape *split;
    const jet_run **maker; /* [slots] the run that makes the slot; NULL: none, or it is made */
} splitting;

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

/* Tells whether each operation of the run has terms of its own. */
static bool has_own_terms(const jet_run *run) { return run->op == OP_LINEAR || run->is_scattered; }

static void add_terms(jet_tape *split, const jet_tape *tape, int first, int count, int shift)
{
    for (int term = first; term < first + count; term++, split->terms++) {
        split->term_slot[split->terms] = tape->term_slot[term] + shift;
        split->term_operand_b[split->terms] = tape->term_operand_b[term] + shift;
        split->term_coefficient[split->terms] = tape->term_coefficient[term];
    }
}

/* Adds `count` operations of the run, from this one on. */
static void add_run(const splitting *s, const jet_run *run, int from, int count)
{
    const jet_tape *tape = s->tape;
    jet_run part = *run;
    part.count = count;
    part.z += from;
    part.term = s->split->terms;
    if (has_own_terms(run)) add_terms(s->split, tape, run->term + from * run->terms, count * run->terms, 0);
    else add_terms(s->split, tape, run->term, run->terms, from);
    if (run->terms == 0) {
        part.a += from;
        part.b += jet_rules[run->op]->operands == 2 ? from : 0;
    }
    if (run->op == OP_LINEAR) part.first += from;
    s->split->run[s->split->runs++] = part;
}

static void split_in_place(const splitting *s, jet_split which)
{
    for (const jet_run *run = s->tape->run; run < s->tape->run + s->tape->runs; run++) {
        const bool is_apart = which == JET_SPLIT_SUMS && has_own_terms(run);
        for (int i = 0; i < (is_apart ? run->count : 1); i++) add_run(s, run, i, is_apart ? 1 : run->count);
    }
}

/* ---- One by one, as they are wanted ------------------------------------------------------------------------------ */

int jet_operand_slot(const jet_tape *tape, const jet_run *run, int i, int k)
{
    const int reads = run->terms > 0 ? run->terms : 1, which = k % reads;
    if (k >= (run->op == OP_LINEAR ? reads : 2 * reads)) return -1;
    if (run->terms == 0) return k == 0 ? run->a + i : jet_rules[run->op]->operands == 2 ? run->b + i : -1;
    const int term = run->term + which + (has_own_terms(run) ? i * run->terms : 0), shift = has_own_terms(run) ? 0 : i;
    return shift + (k < reads ? tape->term_slot[term] : tape->term_operand_b[term]);
}

void jet_tape_mark_dependents(const jet_tape *tape, bool follows[])
{
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        for (int i = 0; i < run->count; i++) {
            bool *z = &follows[run->z + i];
            *z = false;
            for (int k = 0, a; (a = jet_operand_slot(tape, run, i, k)) >= 0; k++) *z = *z || follows[a];
        }
}

/* Tells whether the slot reads the one that was just made, and waits for nothing else. */
static bool waits_for(const splitting *s, int slot, int made)
{
    const jet_run *run = s->maker[slot];
    bool reads = false;
    for (int k = 0, a; (a = jet_operand_slot(s->tape, run, slot - run->z, k)) >= 0; k++) {
        if (s->maker[a]) return false;
        reads |= a == made;
    }
    return reads;
}

/* Makes what the slot reads, then the slot, and then the slots that waited for nothing else. Sines stand before cosines
 * of their angles. */
static void make(const splitting *s, int slot)
{
    const jet_run *run = s->maker[slot];
    if (!run) return;
    const int i = slot - run->z;
    if (run->op == OP_COS && run > s->tape->run && run[-1].together == 2 && s->maker[run[-1].z + i]) {
        make(s, run[-1].z + i);
        return;
    }
    for (int k = 0, a; (a = jet_operand_slot(s->tape, run, i, k)) >= 0; k++) make(s, a);
    if (!s->maker[slot]) return;
    const bool has_cosine = run->op == OP_SIN && run->together == 2;
    for (const jet_run *made = run; made <= run + has_cosine; made++) {
        add_run(s, made, i, 1);
        s->split->run[s->split->runs - 1].together = made == run && has_cosine ? 2 : 1;
        s->maker[made->z + i] = NULL;
    }
    for (int next = 0; next < s->tape->slots; next++)
        for (const jet_run *made = run; made <= run + has_cosine; made++)
            if (s->maker[next] && waits_for(s, next, made->z + i)) make(s, next);
}

/* ---- Factors of sums --------------------------------------------------------------------------------------------- */

static bool is_product(const jet_run *run) { return run->op == OP_PRODUCTS && run->terms == 1 && run->count == 1; }

/* The size of the slot's coefficient in several sums, if it is the same in all; 0: it is not, or the slot is read
 * otherwise. */
static double size_in_sums(const jet_tape *split, int slot)
{
    double size = 0;
    int sums = 0;
    for (const jet_run *run = split->run; run < split->run + split->runs; run++) {
        for (int k = 0, a; (a = jet_operand_slot(split, run, 0, k)) >= 0; k++) {
            if (a != slot) continue;
            const double one = run->op == OP_LINEAR ? fabs(split->term_coefficient[run->term + k]) : 0;
            if (one == 0 || (size != 0 && one != size)) return 0;
            size = one;
            sums++;
        }
    }
    return sums > 1 ? size : 0;
}

/* Counts the products of this slot that sums have with a factor of this size, moved or not. */
static int products_of(const jet_tape *split, int slot, double size)
{
    int count = 0;
    for (const jet_run *run = split->run; run < split->run + split->runs; run++) {
        const int term = run->term;
        if (!is_product(run) || (split->term_slot[term] != slot && split->term_operand_b[term] != slot)) continue;
        count += split->term_coefficient[term] * size_in_sums(split, run->z) == size;
    }
    return count;
}

/* Moves factors. The interaction of two bodies is products d w of several d, which the sums of both bodies have with
 * the same factor. The factor then multiplies w, once, and the sums lose it. With a single product nothing is gained.
 * One more number is rounded, in the same way in all steps (docs/method.md section 6). Forces bear that; the gradient
 * of a Lagrangian does not, and its energy drifts. */
static void move_factors(jet_tape *split)
{
    for (const jet_run *made = split->run; made < split->run + split->runs; made++) {
        if (!is_product(made)) continue;
        bool is_output = false;
        for (int i = 0; i < split->outputs; i++) is_output |= split->output[i] == made->z;
        const double size = is_output ? 0 : size_in_sums(split, made->z);
        if (size == 0 || size == 1) continue;
        int *one = &split->term_slot[made->term], *other = &split->term_operand_b[made->term];
        const int of_one = products_of(split, *one, size), of_other = products_of(split, *other, size);
        if (of_one < 2 && of_other < 2) continue;
        if (of_other > of_one) {
            const int kept = *one;
            *one = *other;
            *other = kept;
        }
        split->term_coefficient[made->term] *= size;
        for (const jet_run *run = split->run; run < split->run + split->runs; run++)
            for (int k = 0; run->op == OP_LINEAR && k < run->terms; k++)
                if (split->term_slot[run->term + k] == made->z)
                    split->term_coefficient[run->term + k] = copysign(1, split->term_coefficient[run->term + k]);
    }
}

static void split_all(const splitting *s)
{
    const jet_tape *tape = s->tape;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        for (int i = 0; i < run->count; i++) s->maker[run->z + i] = run;
    for (int i = 0; i < tape->outputs; i++) make(s, tape->output[i]);
    for (int slot = 0; slot < tape->slots; slot++) make(s, slot);
}

/* ------------------------------------------------------------------------------------------------------------------ */

void jet_tape_free_split(jet_tape *split)
{
    free(split->run);
    free(split->term_slot);
    free(split->term_operand_b);
    free(split->term_coefficient);
}

bool jet_tape_split(jet_tape *split, const jet_tape *tape, jet_split which)
{
    size_t terms = 1;
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        terms += (size_t)run->count * (size_t)run->terms;
    const size_t slots = (size_t)tape->slots + 1;
    *split = *tape;
    split->runs = split->terms = 0;
    split->run = calloc(slots, sizeof *split->run);
    split->term_slot = calloc(terms, sizeof *split->term_slot);
    split->term_operand_b = calloc(terms, sizeof *split->term_operand_b);
    split->term_coefficient = calloc(terms, sizeof *split->term_coefficient);
    const splitting s = {tape, split, calloc(slots, sizeof(jet_run *))};
    const bool has_memory =
        s.maker && split->run && split->term_slot && split->term_operand_b && split->term_coefficient;
    if (!has_memory) jet_tape_free_split(split);
    else if (which == JET_SPLIT_ALL || which == JET_SPLIT_PAIRS) split_all(&s);
    else split_in_place(&s, which);
    if (has_memory && which == JET_SPLIT_PAIRS) move_factors(split);
    free(s.maker);
    return has_memory;
}
