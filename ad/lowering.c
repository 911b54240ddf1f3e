/* lowering.c - Gives the nodes of a graph their slots on a tape. It drops nodes that no output needs, orders the others
 * by levels, and gives equal operations adjacent slots. */
#include "devices.h"
#include "lowering.h"

#include <stdlib.h>
#include <string.h>

static int max(int a, int b) { return a > b ? a : b; }

/* ---- What is needed ---------------------------------------------------------------------------------------------- */

/* Marks all nodes that the outputs depend on. Partners may have been recorded after the nodes that need them, so the
 * walk is repeated until it finds nothing new. */
static void mark_needed(lowering *low, int inputs, int outputs, const jet output[])
{
    for (int i = 0; i < inputs; i++) low->needed[i] = true;
    for (int i = 0; i < outputs; i++) low->needed[output[i].node->index] = true;
    bool again;
    do {
        again = false;
        for (int i = low->count - 1; i >= 0; i--) {
            if (!low->needed[i]) continue;
            const struct jet_node *z = jet_graph_node(low->graph, i);
            if (z->a) low->needed[z->a->index] = true;
            if (z->b) low->needed[z->b->index] = true;
            for (int term = 0; term < z->count; term++) low->needed[z->terms[term].node->index] = true;
            if (!keeps_partner(low, z) || low->needed[z->w->index]) continue;
            low->needed[z->w->index] = true;
            again = again || z->w->index > i;
        }
    } while (again);
}

static void count_uses(lowering *low, int outputs, const jet output[])
{
    for (int i = 0; i < outputs; i++) low->uses[output[i].node->index]++;
    for (int i = 0; i < low->count; i++) {
        if (!low->needed[i]) continue;
        const struct jet_node *z = jet_graph_node(low->graph, i);
        if (z->a) low->uses[z->a->index]++;
        if (z->b) low->uses[z->b->index]++;
        if (keeps_partner(low, z)) low->uses[z->w->index]++;
        for (int term = 0; term < z->count; term++) low->uses[z->terms[term].node->index]++;
    }
}

static bool is_product(const struct jet_node *z) { return z->op == OP_MUL || z->op == OP_SQR; }

/* The operation of a node's run. A sum of products that nothing else needs is one operation. */
static jet_op operation(const lowering *low, const struct jet_node *z)
{
    if (is_product(z)) return z->op == OP_SQR ? OP_SQUARES : OP_PRODUCTS;
    if (!JET_HAS(TERMS) || z->op != OP_LINEAR || z->number != 0 || z->count > JET_TERMS_MAX) return z->op;
    jet_op op = OP_SQUARES;
    for (int term = 0; term < z->count; term++) {
        const struct jet_node *product = z->terms[term].node;
        if (!is_product(product) || low->uses[product->index] != 1) return z->op;
        if (product->op == OP_MUL) op = OP_PRODUCTS;
    }
    return op;
}

/* The operand of a pair that is read at the order being computed; NULL: none. */
static const struct jet_node *operand_of(const lowering *low, const placement *z, int pair, int which)
{
    const struct jet_node *read = term_of(z, pair).node;
    if (which == 0 || (read->op == OP_SQR && z->op == OP_PRODUCTS)) return read->a;
    return reads_partner(low, read) ? read->w : read->b;
}

/* Chooses the operations of the needed nodes. Products that become part of a sum are no longer needed. */
static void choose_operations(lowering *low, int outputs, const jet output[])
{
    count_uses(low, outputs, output);
    for (int i = 0; i < low->count; i++) {
        if (!low->needed[i]) continue;
        placement *z = &low->placements[i];
        z->node = jet_graph_node(low->graph, i);
        z->op = operation(low, z->node);
        z->rank = z->slot = -1;
        z->operand = low->operands + low->pairs;
        if (is_sum_of_products(z->op)) z->pairs = z->node->op == OP_LINEAR ? z->node->count : 1;
        else z->pairs = jet_rules[z->op] ? 1 : 0;
        low->pairs += z->pairs;
        if (z->op == z->node->op || z->node->op != OP_LINEAR) continue;
        for (int term = 0; term < z->node->count; term++) low->needed[z->node->terms[term].node->index] = false;
    }
    memset(low->uses, 0, (size_t)low->count * sizeof *low->uses);
    for (int i = outputs; i-- > 0;) low->placements[output[i].node->index].output = i + 1;
}

/* ---- The order --------------------------------------------------------------------------------------------------- */

static int level_of(const lowering *low, const struct jet_node *node)
{
    return node ? low->placements[node->index].level : 0;
}

static void find_levels(lowering *low)
{
    for (int i = 0; i < low->count; i++) {
        if (!low->needed[i]) continue;
        placement *z = &low->placements[i];
        for (int pair = 0; pair < z->pairs; pair++)
            for (int which = 0; which < 2; which++)
                z->level = max(z->level, level_of(low, operand_of(low, z, pair, which)) + 1);
        if (z->pairs == 0)
            for (int term = 0; term < z->node->count; term++)
                z->level = max(z->level, level_of(low, z->node->terms[term].node) + 1);
        low->levels[low->needed_count++] = z;
    }
}

static int by_level(const void *first, const void *second)
{
    const placement *x = *(placement *const *)first, *y = *(placement *const *)second;
    return x->level != y->level ? x->level - y->level : x->node->index - y->node->index;
}

static void claim(const lowering *low, const struct jet_node *node, int rank)
{
    if (node && low->placements[node->index].rank < 0) low->placements[node->index].rank = rank;
}

/* Ranks the operations of a level. The rank of an operation on two operands is how often one of these was read before
 * at the level. The rank of any other is that of the first such reader, or its place among the terms of the first sum
 * that reads it. As an example, x, y and z of the distances of many pairs are squared and summed, and each is
 * multiplied by one function of the pair: the x come first, then the y, and the operations of one rank read adjacent
 * slots. */
static void rank_operations(lowering *low, placement *level[], int count)
{
    for (int i = 0; i < count; i++) {
        placement *z = level[i];
        for (int pair = 0; pair < z->pairs; pair++) {
            const struct jet_node *a = operand_of(low, z, pair, 0), *b = operand_of(low, z, pair, 1);
            if (b) z->rank = max(z->rank, max(low->uses[a->index]++, low->uses[b->index]++));
            if (!b && z->pairs == 1) continue;
            claim(low, a, z->pairs > 1 ? pair : z->rank);
            claim(low, b, z->pairs > 1 ? pair : z->rank);
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

static int compare_coefficients(const placement *x, const placement *y)
{
    for (int pair = 0; pair < x->pairs; pair++) {
        const int order = compare(term_of(x, pair).coefficient, term_of(y, pair).coefficient);
        if (order) return order;
    }
    return 0;
}

/* Compares two nodes of a level: 0 if they can be members of one run. */
static int by_group(const placement *x, const placement *y)
{
    if (x->op != y->op) return (int)x->op - (int)y->op;
    if (x->pairs == 0) return x->node->count - y->node->count; /* sums of equally many terms stand together */
    if (x->pairs != y->pairs) return x->pairs - y->pairs;
    return jet_rules[x->node->op] ? compare(x->node->number, y->node->number) : compare_coefficients(x, y);
}

/* Orders nodes of a level by group and rank, and then by the slots of the operands, so that adjacent results have
 * adjacent operands: by a first, or by b first. Sums that are outputs stand in the order of the outputs, after
 * others. */
static int by_first_operand(const void *first, const void *second)
{
    const placement *x = *(placement *const *)first, *y = *(placement *const *)second;
    const int group = by_group(x, y);
    if (group) return group;
    if (x->level > 0 && x->rank != y->rank) return x->rank - y->rank;
    if (x->pairs == 0)
        return x->level > 0 && x->output != y->output ? x->output - y->output : x->node->index - y->node->index;
    const int *of_x = x->operand[0], *of_y = y->operand[0];
    if (of_x[0] != of_y[0]) return of_x[0] - of_y[0];
    return of_x[1] != of_y[1] ? of_x[1] - of_y[1] : x->node->index - y->node->index;
}

static int by_second_operand(const void *first, const void *second)
{
    const placement *x = *(placement *const *)first, *y = *(placement *const *)second;
    const int difference = x->operand[0][1] - y->operand[0][1];
    return difference ? difference : by_first_operand(first, second);
}

static void emit(lowering *low, placement *z)
{
    z->slot = low->slots;
    low->sorted[low->slots++] = z;
}

static bool is_contiguous(const lowering *low, placement *const group[], int count, int pair, int which)
{
    if (!operand_of(low, group[0], pair, which)) return true;
    for (int i = 1; i < count; i++)
        if (group[i]->operand[pair][which] != group[0]->operand[pair][which] + i) return false;
    return true;
}

static bool is_contiguous_by_rank(const lowering *low, placement *const group[], int count, int *ranks)
{
    for (int begin = 0, end = 0; begin < count; begin = end, ++*ranks) {
        while (end < count && group[end]->rank == group[begin]->rank) end++;
        for (int pair = 0; pair < group[0]->pairs; pair++)
            for (int which = 0; which < 2; which++)
                if (!is_contiguous(low, group + begin, end - begin, pair, which)) return false;
    }
    return true;
}

/* Copies an operand that the members read at scattered slots to adjacent ones, so that they run as one. */
static void gather(lowering *low, placement *group[], int count, int pair, int which)
{
    if (is_contiguous(low, group, count, pair, which)) return;
    for (int i = 0; i < count; i++) {
        placement *copy = &low->placements[low->count + low->copies++];
        *copy = (placement){.op = OP_LINEAR, .level = group[i]->level, .operand = low->operands + low->pairs++};
        copy->operand[0][0] = group[i]->operand[pair][which];
        emit(low, copy);
        group[i]->operand[pair][which] = copy->slot;
    }
}

/* Arranges the operands of a group: by rank if that makes them contiguous, otherwise sorted by one operand, with the
 * others copied. Tapes of values read the operands where they are, unless ranks have at least SHORT members. */
enum { SHORT = 4 };
static void gather_operands(lowering *low, placement *group[], int count)
{
    int ranks = 0;
    const bool by_rank = is_contiguous_by_rank(low, group, count, &ranks);
    const bool is_scattered = JET_HAS(SCATTERED) && low->kind == JET_TAPE_VALUES && is_sum_of_products(group[0]->op) &&
                              (!by_rank || count < SHORT * ranks);
    for (int i = 0; i < count; i++) group[i]->is_scattered = is_scattered;
    if (by_rank || is_scattered) return;
    if (!is_contiguous(low, group, count, 0, 0) && !is_contiguous(low, group, count, 0, 1))
        qsort(group, (size_t)count, sizeof *group, by_second_operand);
    for (int pair = 0; pair < group[0]->pairs; pair++)
        for (int which = 0; which < 2; which++) gather(low, group, count, pair, which);
}

static int group_end(placement *const level[], int begin, int end)
{
    int last = begin + 1;
    while (last < end && by_group(level[begin], level[last]) == 0) last++;
    return last;
}

/* Assigns the slots of a level: sums and copies first, then the other operations group by group. */
static void emit_level(lowering *low, placement *level[], int count)
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

static void for_levels(lowering *low, void (*function)(lowering *low, placement *level[], int count))
{
    for (int begin = 0, end = 0; begin < low->needed_count; begin = end) {
        while (end < low->needed_count && low->levels[end]->level == low->levels[begin]->level) end++;
        function(low, low->levels + begin, end - begin);
    }
}

/* Assigns slots level by level, since the order within a level depends on the slots of those below. */
static void assign_slots(lowering *low)
{
    qsort(low->levels, (size_t)low->needed_count, sizeof *low->levels, by_level);
    for_levels(low, rank_operations);
    for_levels(low, emit_level);
}

void jet_assign_slots(lowering *low, int inputs, int outputs, const jet output[])
{
    mark_needed(low, inputs, outputs, output);
    choose_operations(low, outputs, output);
    find_levels(low);
    assign_slots(low);
}
