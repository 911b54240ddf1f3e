/* tape.c - graph -> tape: drops what no output needs, orders the rest by levels, lays equal operations side by side. */
#include "tape.h"
#include "rule.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the lowering knows of a node. */
typedef struct {
    const struct jet_node *node; /* NULL: a copy of the first operand */
    jet_op op;                   /* of its run */
    int level;                   /* inputs and constants 0; else one more than the highest operand */
    int turn;                    /* see find_turns */
    int slot;
    int pairs;         /* LINEAR, inputs and constants 0; PRODUCTS and SQUARES as many as terms; else 1 */
    int (*operand)[2]; /* [pairs] slots of the operands that are read at the order being computed */
} place;

typedef struct {
    const jet_graph *graph;
    jet_tape_kind kind;
    int count;      /* of nodes in the graph */
    bool *needed;   /* [count] */
    int *uses;      /* [count] scratch, zeros */
    place *places;  /* [count] by node index, then the copies */
    place **levels; /* [needed_count] the needed nodes by level */
    place **sorted; /* [slots] nodes and copies in the order of their slots */
    int (*operands)[2];
    int needed_count, copies, slots, pairs;
} lowering;

static int max(int a, int b) { return a > b ? a : b; }

/* Whether the order being computed of z reads the same order of z->b. */
static bool reads_b(const lowering *low, const struct jet_node *z)
{
    const jet_b_role role = jet_role_of_b(z->op);
    return role == B_OPERAND || (role == B_PARTNER_SERIES && low->kind == JET_TAPE_SERIES);
}

static bool keeps_b(const lowering *low, const struct jet_node *z)
{
    return jet_role_of_b(z->op) == B_OPERAND || (z->b && low->kind == JET_TAPE_SERIES);
}

/* ---- What is needed ---------------------------------------------------------------------------------------------- */

/* Marks all that the outputs depend on; partners may have been recorded after the nodes that need them, so repeat until
 * nothing new is found. */
static void mark_needed(lowering *low, int inputs, int outputs, const jet output[])
{
    for (int i = 0; i < inputs; i++) low->needed[i] = true;
    for (int i = 0; i < outputs; i++) low->needed[output[i].node->index] = true;
    for (bool again = true; again;) {
        again = false;
        for (int i = low->count - 1; i >= 0; i--) {
            if (!low->needed[i]) continue;
            const struct jet_node *z = jet_graph_node(low->graph, i);
            if (z->a) low->needed[z->a->index] = true;
            for (int term = 0; term < z->count; term++) low->needed[z->terms[term].node->index] = true;
            if (!keeps_b(low, z) || low->needed[z->b->index]) continue;
            low->needed[z->b->index] = true;
            again = again || z->b->index > i;
        }
    }
}

static void count_uses(lowering *low, int outputs, const jet output[])
{
    for (int i = 0; i < outputs; i++) low->uses[output[i].node->index]++;
    for (int i = 0; i < low->count; i++) {
        if (!low->needed[i]) continue;
        const struct jet_node *z = jet_graph_node(low->graph, i);
        if (z->a) low->uses[z->a->index]++;
        if (keeps_b(low, z)) low->uses[z->b->index]++;
        for (int term = 0; term < z->count; term++) low->uses[z->terms[term].node->index]++;
    }
}

static bool is_product(const struct jet_node *z) { return z->op == OP_MUL || z->op == OP_SQR; }

static bool is_sum_of_products(jet_op op) { return op == OP_PRODUCTS || op == OP_SQUARES; }

/* The operation of a node's run. A sum of products that nothing else needs is one operation. */
static jet_op operation(const lowering *low, const struct jet_node *z)
{
    if (is_product(z)) return z->op == OP_SQR ? OP_SQUARES : OP_PRODUCTS;
    if (z->op != OP_LINEAR || z->number != 0 || z->count > JET_TERMS_MAX) return z->op;
    jet_op op = OP_SQUARES;
    for (int term = 0; term < z->count; term++) {
        const struct jet_node *product = z->terms[term].node;
        if (!is_product(product) || low->uses[product->index] != 1) return z->op;
        if (product->op == OP_MUL) op = OP_PRODUCTS;
    }
    return op;
}

/* The terms of sums of products: of a product itself, one. */
static jet_term term_of(const place *z, int term)
{
    return z->node->op == OP_LINEAR ? z->node->terms[term] : (jet_term){1, (struct jet_node *)z->node};
}

/* The operand of a pair that is read at the order being computed; NULL: none. */
static const struct jet_node *operand_of(const lowering *low, const place *z, int pair, int which)
{
    const struct jet_node *read = term_of(z, pair).node;
    if (which == 0 || (read->op == OP_SQR && z->op == OP_PRODUCTS)) return read->a;
    return reads_b(low, read) ? read->b : NULL;
}

/* The operations of the needed nodes; the products that become part of a sum are no longer needed. */
static void choose_operations(lowering *low, int outputs, const jet output[])
{
    count_uses(low, outputs, output);
    for (int i = 0; i < low->count; i++) {
        if (!low->needed[i]) continue;
        place *z = &low->places[i];
        z->node = jet_graph_node(low->graph, i);
        z->op = operation(low, z->node);
        z->turn = z->slot = -1;
        z->operand = low->operands + low->pairs;
        if (is_sum_of_products(z->op)) z->pairs = z->node->op == OP_LINEAR ? z->node->count : 1;
        else z->pairs = jet_rules[z->op] ? 1 : 0;
        low->pairs += z->pairs;
        if (z->op == z->node->op || z->node->op != OP_LINEAR) continue;
        for (int term = 0; term < z->node->count; term++) low->needed[z->node->terms[term].node->index] = false;
    }
    memset(low->uses, 0, (size_t)low->count * sizeof *low->uses);
}

/* ---- The order --------------------------------------------------------------------------------------------------- */

static int level_of(const lowering *low, const struct jet_node *node)
{
    return node ? low->places[node->index].level : 0;
}

static void find_levels(lowering *low)
{
    for (int i = 0; i < low->count; i++) {
        if (!low->needed[i]) continue;
        place *z = &low->places[i];
        for (int pair = 0; pair < z->pairs; pair++)
            for (int which = 0; which < 2; which++)
                z->level = max(z->level, level_of(low, operand_of(low, z, pair, which)) + 1);
        for (int term = 0; z->pairs == 0 && term < z->node->count; term++)
            z->level = max(z->level, level_of(low, z->node->terms[term].node) + 1);
        low->levels[low->needed_count++] = z;
    }
}

static int by_level(const void *first, const void *second)
{
    const place *x = *(place *const *)first, *y = *(place *const *)second;
    return x->level != y->level ? x->level - y->level : x->node->index - y->node->index;
}

static void claim(const lowering *low, const struct jet_node *node, int turn)
{
    if (node && low->places[node->index].turn < 0) low->places[node->index].turn = turn;
}

/* Of operations on two operands: how often one of these was read before at the level. Of others: that of the first such
 * reader, or the place among the terms of the first sum that reads it. As where x, y and z of the distances of many
 * pairs are squared and summed, and each is multiplied by one function of the pair: the x come first, then the y, and
 * each turn reads adjacent slots. */
static void find_turns(lowering *low, place *level[], int count)
{
    for (int i = 0; i < count; i++) {
        place *z = level[i];
        for (int pair = 0; pair < z->pairs; pair++) {
            const struct jet_node *a = operand_of(low, z, pair, 0), *b = operand_of(low, z, pair, 1);
            if (b) z->turn = max(z->turn, max(low->uses[a->index]++, low->uses[b->index]++));
            if (!b && z->pairs == 1) continue;
            claim(low, a, z->pairs > 1 ? pair : z->turn);
            claim(low, b, z->pairs > 1 ? pair : z->turn);
        }
    }
    for (int i = 0; i < count; i++)
        for (int pair = 0; pair < level[i]->pairs; pair++)
            for (int which = 0; which < 2; which++) {
                const struct jet_node *read = operand_of(low, level[i], pair, which);
                if (read) low->uses[read->index] = 0;
            }
}

static int compare(double a, double b) { return (a > b) - (a < b); }

static int compare_coefficients(const place *x, const place *y)
{
    int order = 0;
    for (int pair = 0; pair < x->pairs && order == 0; pair++)
        order = compare(term_of(x, pair).coefficient, term_of(y, pair).coefficient);
    return order;
}

/* Whether two nodes of a level can be members of one run. */
static int by_group(const place *x, const place *y)
{
    if (x->op != y->op) return (int)x->op - (int)y->op;
    if (x->pairs == 0) return x->node->count - y->node->count; /* sums of equally many terms stand together */
    if (x->pairs != y->pairs) return x->pairs - y->pairs;
    return jet_rules[x->node->op] ? compare(x->node->number, y->node->number) : compare_coefficients(x, y);
}

/* Within a level by group and turn, and within that by the slots of the operands, so that adjacent results have
 * adjacent operands: by a first, or by b first. */
static int by_first_operand(const void *first, const void *second)
{
    const place *x = *(place *const *)first, *y = *(place *const *)second;
    const int group = by_group(x, y);
    if (group) return group;
    if (x->level > 0 && x->turn != y->turn) return x->turn - y->turn;
    for (int which = 0; which < 2 && x->pairs > 0; which++)
        if (x->operand[0][which] != y->operand[0][which]) return x->operand[0][which] - y->operand[0][which];
    return x->node->index - y->node->index;
}

static int by_second_operand(const void *first, const void *second)
{
    const place *x = *(place *const *)first, *y = *(place *const *)second;
    const int difference = x->operand[0][1] - y->operand[0][1];
    return difference ? difference : by_first_operand(first, second);
}

static int slot_of(const lowering *low, const struct jet_node *node)
{
    return node ? low->places[node->index].slot : 0;
}

static void emit(lowering *low, place *z)
{
    z->slot = low->slots;
    low->sorted[low->slots++] = z;
}

static bool is_contiguous(const lowering *low, place *const group[], int count, int pair, int which)
{
    if (!operand_of(low, group[0], pair, which)) return true;
    for (int i = 1; i < count; i++)
        if (group[i]->operand[pair][which] != group[0]->operand[pair][which] + i) return false;
    return true;
}

static bool is_contiguous_in_turns(const lowering *low, place *const group[], int count)
{
    for (int begin = 0, end = 0; begin < count; begin = end) {
        while (end < count && group[end]->turn == group[begin]->turn) end++;
        for (int pair = 0; pair < group[0]->pairs; pair++)
            for (int which = 0; which < 2; which++)
                if (!is_contiguous(low, group + begin, end - begin, pair, which)) return false;
    }
    return true;
}

/* Copies an operand that the members read at scattered slots to adjacent ones, so that they run as one. */
static void gather(lowering *low, place *group[], int count, int pair, int which)
{
    if (is_contiguous(low, group, count, pair, which)) return;
    for (int i = 0; i < count; i++) {
        place *copy = &low->places[low->count + low->copies++];
        *copy = (place){.op = OP_LINEAR, .level = group[i]->level, .operand = low->operands + low->pairs++};
        copy->operand[0][0] = group[i]->operand[pair][which];
        emit(low, copy);
        group[i]->operand[pair][which] = copy->slot;
    }
}

/* The operands of a group: turn by turn where that will do, else sorted by the one that is then contiguous, the others
 * gathered. */
static void gather_operands(lowering *low, place *group[], int count)
{
    if (is_contiguous_in_turns(low, group, count)) return;
    if (!is_contiguous(low, group, count, 0, 0) && !is_contiguous(low, group, count, 0, 1))
        qsort(group, (size_t)count, sizeof *group, by_second_operand);
    for (int pair = 0; pair < group[0]->pairs; pair++)
        for (int which = 0; which < 2; which++) gather(low, group, count, pair, which);
}

static int group_end(place *const level[], int begin, int end)
{
    int last = begin + 1;
    while (last < end && by_group(level[begin], level[last]) == 0) last++;
    return last;
}

/* Slots of a level: sums and copies first, then the other operations group by group. */
static void emit_level(lowering *low, place *level[], int count)
{
    for (int i = 0; i < count; i++)
        for (int pair = 0; pair < level[i]->pairs; pair++)
            for (int which = 0; which < 2; which++)
                level[i]->operand[pair][which] = slot_of(low, operand_of(low, level[i], pair, which));
    qsort(level, (size_t)count, sizeof *level, by_first_operand);
    for (int i = 0; i < count; i++)
        if (level[i]->pairs == 0) emit(low, level[i]);
    for (int begin = 0, end = 0; begin < count; begin = end) {
        end = group_end(level, begin, count);
        if (level[begin]->pairs > 0) gather_operands(low, level + begin, end - begin);
    }
    for (int i = 0; i < count; i++)
        if (level[i]->pairs > 0) emit(low, level[i]);
}

static void for_levels(lowering *low, void (*function)(lowering *low, place *level[], int count))
{
    for (int begin = 0, end = 0; begin < low->needed_count; begin = end) {
        while (end < low->needed_count && low->levels[end]->level == low->levels[begin]->level) end++;
        function(low, low->levels + begin, end - begin);
    }
}

/* Level by level, since the order within one depends on the slots of those below. */
static void assign_slots(lowering *low)
{
    qsort(low->levels, (size_t)low->needed_count, sizeof *low->levels, by_level);
    for_levels(low, find_turns);
    for_levels(low, emit_level);
}

/* ---- The tape ---------------------------------------------------------------------------------------------------- */

static void add_term(jet_tape *tape, double coefficient, int slot, int second)
{
    tape->term_coefficient[tape->terms] = coefficient;
    tape->term_slot[tape->terms] = slot;
    tape->term_second[tape->terms++] = second;
}

/* The number and the terms of a sum; a copy is a sum of one term. */
static jet_run linear_run(const lowering *low, jet_tape *tape, const place *z)
{
    const int terms = z->node ? z->node->count : 1;
    const double number = z->node ? z->node->number : 0;
    const jet_run run = {
        OP_LINEAR, 1, z->slot, .has_numbers = number != 0, .first = tape->rows, .terms = terms, .term = tape->terms};
    tape->base[tape->rows++] = number;
    if (!z->node) add_term(tape, 1, z->operand[0][0], 0);
    for (int term = 0; z->node && term < terms; term++)
        add_term(tape, z->node->terms[term].coefficient, slot_of(low, z->node->terms[term].node), 0);
    return run;
}

static bool continues_linear(jet_run *run, const jet_run *next)
{
    if (next->terms != run->terms) return false;
    run->has_numbers |= next->has_numbers;
    return true;
}

/* The terms stand last on the tape; those of a run that the member continues are taken away again. */
static jet_run product_run(jet_tape *tape, const place *z)
{
    const jet_run run = {z->op, 1, z->slot, .terms = z->pairs, .term = tape->terms};
    for (int pair = 0; pair < z->pairs; pair++)
        add_term(tape, term_of(z, pair).coefficient, z->operand[pair][0], z->operand[pair][z->op == OP_PRODUCTS]);
    return run;
}

static bool continues_products(jet_tape *tape, const jet_run *run, const jet_run *next)
{
    if (next->terms != run->terms) return false;
    for (int here = run->term, there = next->term; there < next->term + next->terms; here++, there++)
        if (tape->term_coefficient[there] != tape->term_coefficient[here] ||
            tape->term_slot[there] != tape->term_slot[here] + run->count ||
            tape->term_second[there] != tape->term_second[here] + run->count)
            return false;
    tape->terms = next->term;
    return true;
}

static jet_run rule_run(const lowering *low, const place *z)
{
    const bool partner = keeps_b(low, z->node) && !reads_b(low, z->node);
    const int b = partner ? slot_of(low, z->node->b) : z->operand[0][1];
    return (jet_run){z->op, 1, z->slot, z->operand[0][0], b, .c = z->node->number};
}

static bool continues_rule(const jet_run *run, const jet_run *next)
{
    const bool same_b = run->b == 0 && next->b == 0 && jet_role_of_b(run->op) != B_OPERAND;
    return next->c == run->c && next->a == run->a + run->count && (same_b || next->b == run->b + run->count);
}

/* Whether `next`, one level with the last run, goes on from it. */
static bool continues(const lowering *low, jet_tape *tape, const jet_run *next)
{
    if (tape->runs == 0) return false;
    jet_run *run = &tape->run[tape->runs - 1];
    if (run->op != next->op || low->sorted[run->z]->level != low->sorted[next->z]->level) return false;
    if (next->op == OP_LINEAR) return continues_linear(run, next);
    return is_sum_of_products(next->op) ? continues_products(tape, run, next) : continues_rule(run, next);
}

/* Adds an operation to the last run, or a run. */
static void add_operation(const lowering *low, jet_tape *tape, const place *z)
{
    const jet_run next = z->op == OP_LINEAR          ? linear_run(low, tape, z)
                         : is_sum_of_products(z->op) ? product_run(tape, z)
                                                     : rule_run(low, z);
    if (continues(low, tape, &next)) tape->run[tape->runs - 1].count++;
    else tape->run[tape->runs++] = next;
}

static void lay_out(lowering *low, jet_tape *tape)
{
    for (int i = 0; i < low->slots; i++) {
        const place *z = low->sorted[i];
        if (z->op == OP_INPUT) tape->inputs++;
        else if (z->op == OP_CONST) tape->constant[tape->constants++] = z->node->number;
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
    low->places = calloc(nodes + copies, sizeof *low->places);
    low->levels = calloc(nodes, sizeof(place *));
    low->sorted = calloc(nodes + copies, sizeof(place *));
    low->operands = calloc(pairs + copies, sizeof *low->operands);
    tape->run = calloc(nodes + copies, sizeof *tape->run);
    tape->constant = calloc(nodes, sizeof *tape->constant);
    tape->base = calloc(nodes + copies, sizeof *tape->base);
    tape->term_slot = calloc(pairs + copies, sizeof *tape->term_slot);
    tape->term_second = calloc(pairs + copies, sizeof *tape->term_second);
    tape->term_coefficient = calloc(pairs + copies, sizeof *tape->term_coefficient);
    tape->output = calloc((size_t)outputs + 1, sizeof *tape->output);
    return low->needed && low->uses && low->places && low->levels && low->sorted && low->operands && tape->run &&
           tape->constant && tape->base && tape->term_slot && tape->term_second && tape->term_coefficient &&
           tape->output;
}

static void lower(lowering *low, jet_tape *tape, int inputs, int outputs, const jet output[])
{
    mark_needed(low, inputs, outputs, output);
    choose_operations(low, outputs, output);
    find_levels(low);
    assign_slots(low);
    lay_out(low, tape);
    tape->slots = low->slots;
    tape->outputs = outputs;
    for (int i = 0; i < outputs; i++) tape->output[i] = slot_of(low, output[i].node);
}

jet_tape *jet_tape_create(const jet_graph *graph, int inputs, int outputs, const jet output[], jet_tape_kind kind)
{
    jet_tape *tape = calloc(1, sizeof *tape);
    if (!tape) return NULL;
    tape->sweeps = jet_sweeps_choose();
    lowering low = {.graph = graph, .kind = kind, .count = jet_graph_count(graph)};
    const bool allocated = allocate(&low, tape, outputs);
    if (allocated) lower(&low, tape, inputs, outputs, output);
    free(low.needed);
    free(low.uses);
    free(low.places);
    free(low.levels);
    free(low.sorted);
    free(low.operands);
    if (allocated) return tape;
    jet_tape_free(tape);
    return NULL;
}
