/* tape.c - Lowers a graph to a tape: equal operations side by side become one run. */
#include "devices.h"
#include "pad.h"
#include "lowering.h"

#include <stdlib.h>

#ifdef TVI_DEVICES
int jet_without;
#endif

static void add_term(jet_tape *tape, double coefficient, int slot, int second)
{
    tape->term_coefficient[tape->terms] = coefficient;
    tape->term_slot[tape->terms] = slot;
    tape->term_operand_b[tape->terms++] = second;
}

/* Adds the number and the terms of a sum. A copy is a sum of one term. */
static jet_run linear_run(const lowering *low, jet_tape *tape, const placement *z)
{
    const int terms = z->node ? z->node->count : 1;
    const double number = z->node ? z->node->number : 0;
    const jet_run run = {
        OP_LINEAR, 1, z->slot, .has_numbers = number != 0, .first = tape->rows, .terms = terms, .term = tape->terms};
    tape->base[tape->rows++] = number;
    if (!z->node) {
        add_term(tape, 1, z->operand[0][0], 0);
        return run;
    }
    for (int term = 0; term < terms; term++)
        add_term(tape, z->node->terms[term].coefficient, slot_of(low, z->node->terms[term].node), 0);
    return run;
}

static bool continues_linear(jet_run *run, const jet_run *next)
{
    if (next->terms != run->terms) return false;
    run->has_numbers |= next->has_numbers;
    return true;
}

/* Adds the terms of a product at the end of the tape. They are removed again if the product continues a run. */
static jet_run product_run(jet_tape *tape, const placement *z)
{
    const jet_run run = {z->op, 1, z->slot, .terms = z->pairs, .term = tape->terms, .is_scattered = z->is_scattered};
    for (int pair = 0; pair < z->pairs; pair++)
        add_term(tape, term_of(z, pair).coefficient, z->operand[pair][0], z->operand[pair][z->op == OP_PRODUCTS]);
    return run;
}

static bool continues_products(jet_tape *tape, const jet_run *run, const jet_run *next)
{
    if (next->terms != run->terms || next->is_scattered != run->is_scattered) return false;
    if (run->is_scattered) return true;
    for (int here = run->term, there = next->term; there < next->term + next->terms; here++, there++)
        if (tape->term_coefficient[there] != tape->term_coefficient[here] ||
            tape->term_slot[there] != tape->term_slot[here] + run->count ||
            tape->term_operand_b[there] != tape->term_operand_b[here] + run->count)
            return false;
    tape->terms = next->term;
    return true;
}

/* The run of an operation with a rule. w is the partner's own slot if it is read at lower orders only, otherwise that
 * of the second operand read. */
static jet_run rule_run(const lowering *low, const placement *z)
{
    const int *operand = z->operand[0];
    jet_run run = {z->op, 1, z->slot, operand[0], operand[1], .c = z->node->number};
    if (keeps_partner(low, z->node)) run.w = slot_of(low, z->node->w);
    if (reads_partner(low, z->node)) {
        run.b = 0;
        run.w = operand[1];
    }
    return run;
}

static bool continues_rule(const jet_run *run, const jet_run *next)
{
    const int count = run->count, of_b = jet_rules[run->op]->operands == 2 ? count : 0;
    const bool same_w = (run->w == 0 && next->w == 0) || next->w == run->w + count;
    return next->c == run->c && next->a == run->a + count && next->b == run->b + of_b && same_w;
}

/* Tells whether `next`, on the same level as the last run, continues it. */
static bool continues(const lowering *low, jet_tape *tape, const jet_run *next)
{
    if (tape->runs == 0) return false;
    jet_run *run = &tape->run[tape->runs - 1];
    if (run->op != next->op || low->sorted[run->z]->level != low->sorted[next->z]->level) return false;
    if (next->op == OP_LINEAR) return continues_linear(run, next);
    return is_sum_of_products(next->op) ? continues_products(tape, run, next) : continues_rule(run, next);
}

/* Adds an operation to the last run, or as a new run. */
static void add_operation(const lowering *low, jet_tape *tape, const placement *z)
{
    const jet_run next = z->op == OP_LINEAR          ? linear_run(low, tape, z)
                         : is_sum_of_products(z->op) ? product_run(tape, z)
                                                     : rule_run(low, z);
    if (continues(low, tape, &next)) tape->run[tape->runs - 1].count++;
    else tape->run[tape->runs++] = next;
}

static void add_constant(jet_tape *tape, const placement *z)
{
    tape->constant[tape->constants++] = z->node->number;
    if (z->op == OP_PARAMETER) tape->parameter[tape->parameters++] = (jet_tape_parameter){z->node->which, z->slot};
}

static void lay_out(lowering *low, jet_tape *tape)
{
    for (int i = 0; i < low->slots; i++) {
        const placement *z = low->sorted[i];
        tape->recorded[i] = z->node ? z->node->index + 1 - jet_graph_inputs(low->graph) : 0;
        if (z->op == OP_INPUT) tape->inputs++;
        else if (z->op == OP_CONST || z->op == OP_PARAMETER) add_constant(tape, z);
        else add_operation(low, tape, z);
    }
}

static bool allocate(lowering *low, jet_tape *tape, int outputs)
{
    size_t pairs = 1, nodes = (size_t)low->count + 1;
    for (int i = 0; i < low->count; i++) pairs += 1 + (size_t)jet_graph_node(low->graph, i)->count;
    const size_t copies = 2 * pairs; /* each operand may have one */
    low->needed = calloc(nodes, sizeof *low->needed);
    low->uses = calloc(nodes, sizeof *low->uses);
    low->placements = calloc(nodes + copies, sizeof *low->placements);
    low->levels = calloc(nodes, sizeof(placement *));
    low->sorted = calloc(nodes + copies, sizeof(placement *));
    low->operands = calloc(pairs + copies, sizeof *low->operands);
    tape->run = calloc(nodes + copies, sizeof *tape->run);
    tape->constant = calloc(nodes, sizeof *tape->constant);
    tape->parameter = calloc(nodes, sizeof *tape->parameter);
    tape->base = calloc(nodes + copies, sizeof *tape->base);
    tape->term_slot = calloc(pairs + copies, sizeof *tape->term_slot);
    tape->term_operand_b = calloc(pairs + copies, sizeof *tape->term_operand_b);
    tape->term_coefficient = calloc(pairs + copies, sizeof *tape->term_coefficient);
    tape->output = calloc((size_t)outputs + 1, sizeof *tape->output);
    tape->recorded = calloc(nodes + copies, sizeof *tape->recorded);
    return low->needed && low->uses && low->placements && low->levels && low->sorted && low->operands && tape->run &&
           tape->constant && tape->parameter && tape->base && tape->term_slot && tape->term_operand_b &&
           tape->term_coefficient && tape->output && tape->recorded;
}

/* Counts runs that are computed together: sines and the cosines of the same operands; or the powers -7/2, -5/2, -3/2,
 * -1/2 of the same operands, or the last few of them, whose numbers are adjacent, run by run. */
static int count_together(const jet_run *run, const jet_run *end)
{
    int count = 1;
    const jet_run *next = run + 1;
    if (!JET_HAS(TOGETHER)) return 1;
    if (next < end && run->op == OP_SIN && next->op == OP_COS && next->a == run->a && next->count == run->count)
        return 2;
    if (run->op != OP_POW || run->c < -3.5) return 1;
    for (; next < end && next->op == OP_POW && next->c == next[-1].c + 1 && next->c <= -0.5; next++) {
        if (next->a != run->a || next->count != run->count || next->z != next[-1].z + run->count) return 1;
        count++;
    }
    return next[-1].c == -0.5 ? count : 1;
}

/* Lowers the graph. Returns false without memory. */
static bool lower(lowering *low, jet_tape *tape, int inputs, int outputs, const jet output[])
{
    jet_assign_slots(low, inputs, outputs, output);
    lay_out(low, tape);
    tape->part = jet_graph_part_name(low->graph, &tape->part_of);
    tape->part_of += 1 - jet_graph_inputs(low->graph);
    tape->slots = low->slots;
    tape->outputs = outputs;
    for (int i = 0; i < outputs; i++) tape->output[i] = slot_of(low, output[i].node);
    if (JET_HAS(PAD) && low->kind == JET_TAPE_SERIES && !jet_tape_pad(tape)) return false;
    const jet_run *const end = tape->run + tape->runs;
    for (jet_run *run = tape->run; run < end; run++) run->together = count_together(run, end);
    return true;
}

jet_tape *jet_tape_create(const jet_graph *graph, int inputs, int outputs, const jet output[], jet_tape_kind kind)
{
    jet_tape *tape = calloc(1, sizeof *tape);
    if (!tape) return NULL;
    tape->sweeps = tape->interpreted = jet_sweeps_choose();
    lowering low = {.graph = graph, .kind = kind, .count = jet_graph_count(graph)};
    const bool is_made = allocate(&low, tape, outputs) && lower(&low, tape, inputs, outputs, output);
    free(low.needed);
    free(low.uses);
    free(low.placements);
    free(low.levels);
    free(low.sorted);
    free(low.operands);
    if (is_made) return tape;
    jet_tape_free(tape);
    return NULL;
}
