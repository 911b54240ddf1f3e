/* lowering.c - Chooses for each node of a graph the operation that computes it on a tape, and its slot, which is its
 * place in the numbers on which the tape works (lowering.h). Nodes that no output needs are dropped. The needed nodes
 * are sorted into levels, so that each operation reads lower levels only. In a level, equal operations with adjacent
 * operands get adjacent slots. */
#include "devices.h"
#include "lowering.h"

#include <stdlib.h>
#include <string.h>

static int larger_int(int a, int b) { return a > b ? a : b; }

/* ---- What is needed ---------------------------------------------------------------------------------------------- */

/* Marks all nodes that the outputs depend on, and counts them. An auxiliary node may have been recorded after the node
 * that needs it; the walk is therefore repeated until it finds nothing new. */
static void mark_needed_nodes(graph_lowering *lowering, int input_count, int output_count, const jet output[])
{
    for (int i = 0; i < input_count; i++) lowering->is_node_needed[i] = true;
    for (int i = 0; i < output_count; i++) lowering->is_node_needed[output[i].node->index] = true;
    bool again;
    do {
        again = false;
        for (int i = lowering->node_count - 1; i >= 0; i--) {
            if (!lowering->is_node_needed[i]) continue;
            const struct jet_node *z = jet_graph_node_at(lowering->graph, i);
            if (z->a) lowering->is_node_needed[z->a->index] = true;
            if (z->b) lowering->is_node_needed[z->b->index] = true;
            for (int term = 0; term < z->count; term++) lowering->is_node_needed[z->terms[term].node->index] = true;
            if (!must_compute_auxiliary_series(lowering, z) || lowering->is_node_needed[z->w->index]) continue;
            lowering->is_node_needed[z->w->index] = true;
            again = again || z->w->index > i;
        }
    } while (again);
    for (int i = 0; i < lowering->node_count; i++) lowering->used_node_count += lowering->is_node_needed[i];
}

static void count_node_uses(graph_lowering *lowering, int output_count, const jet output[])
{
    for (int i = 0; i < output_count; i++) lowering->use_counts[output[i].node->index]++;
    for (int i = 0; i < lowering->node_count; i++) {
        if (!lowering->is_node_needed[i]) continue;
        const struct jet_node *z = jet_graph_node_at(lowering->graph, i);
        if (z->a) lowering->use_counts[z->a->index]++;
        if (z->b) lowering->use_counts[z->b->index]++;
        if (must_compute_auxiliary_series(lowering, z)) lowering->use_counts[z->w->index]++;
        for (int term = 0; term < z->count; term++) lowering->use_counts[z->terms[term].node->index]++;
    }
}

static bool is_product_node(const struct jet_node *z) { return z->op == OP_MUL || z->op == OP_SQR; }

/* Returns the operation that computes the node on the tape. A sum of products becomes one operation, PRODUCTS or
 * SQUARES, if nothing else reads its products. */
static jet_op choose_tape_operation(const graph_lowering *lowering, const struct jet_node *z)
{
    if (is_product_node(z)) return z->op == OP_SQR ? OP_SQUARES : OP_PRODUCTS;
    if (!JET_HAS(TERMS) || z->op != OP_LINEAR || z->number != 0 || z->count > JET_TERMS_MAX) return z->op;
    jet_op op = OP_SQUARES;
    for (int term = 0; term < z->count; term++) {
        const struct jet_node *product = z->terms[term].node;
        if (!is_product_node(product) || lowering->use_counts[product->index] != 1) return z->op;
        if (product->op == OP_MUL) op = OP_PRODUCTS;
    }
    return op;
}

/* Returns an operand of the node: the first (factor_index = 0) or second factor (factor_index = 1) of a pair. The
 * auxiliary series, which the recurrence needs, counts as the second operand if the order that is being computed
 * is read of it. NULL: there is no such operand. */
static const struct jet_node *find_operand_node(const graph_lowering *lowering, const tape_placement *z, int pair_index,
                                                int factor_index)
{
    const struct jet_node *read = sum_term(z, pair_index).node;
    if (factor_index == 0 || (read->op == OP_SQR && z->op == OP_PRODUCTS)) return read->a;
    return node_reads_own_w_at_same_order(lowering, read) ? read->w : read->b;
}

/* Chooses the operations of all needed nodes. Products that become terms of a sum of products are no longer needed
 * themselves. */
static void choose_all_operations(graph_lowering *lowering, int output_count, const jet output[])
{
    count_node_uses(lowering, output_count, output);
    for (int i = 0; i < lowering->node_count; i++) {
        if (!lowering->is_node_needed[i]) continue;
        tape_placement *z = &lowering->placements[i];
        z->node = jet_graph_node_at(lowering->graph, i);
        z->op = choose_tape_operation(lowering, z->node);
        z->adjacency_class = z->slot = -1;
        z->operand = lowering->operands + lowering->operand_pair_count;
        if (jet_is_sum_of_products(z->op)) z->operand_pair_count = z->node->op == OP_LINEAR ? z->node->count : 1;
        else z->operand_pair_count = jet_rules[z->op] ? 1 : 0;
        lowering->operand_pair_count += z->operand_pair_count;
        if (z->op == z->node->op || z->node->op != OP_LINEAR) continue;
        for (int term = 0; term < z->node->count; term++)
            lowering->is_node_needed[z->node->terms[term].node->index] = false;
    }
    memset(lowering->use_counts, 0, (size_t)lowering->node_count * sizeof *lowering->use_counts);
    for (int i = output_count; i-- > 0;) lowering->placements[output[i].node->index].one_based_output_index = i + 1;
}

/* ---- The order --------------------------------------------------------------------------------------------------- */

static int node_level(const graph_lowering *lowering, const struct jet_node *node)
{
    return node ? lowering->placements[node->index].level : 0;
}

static void assign_levels(graph_lowering *lowering)
{
    for (int i = 0; i < lowering->node_count; i++) {
        if (!lowering->is_node_needed[i]) continue;
        tape_placement *z = &lowering->placements[i];
        for (int pair_index = 0; pair_index < z->operand_pair_count; pair_index++)
            for (int factor_index = 0; factor_index < 2; factor_index++)
                z->level = larger_int(
                    z->level, node_level(lowering, find_operand_node(lowering, z, pair_index, factor_index)) + 1);
        if (z->operand_pair_count == 0)
            for (int term = 0; term < z->node->count; term++)
                z->level = larger_int(z->level, node_level(lowering, z->node->terms[term].node) + 1);
        lowering->nodes_by_level[lowering->needed_node_count++] = z;
    }
}

static int compare_by_level(const void *first, const void *second)
{
    const tape_placement *x = *(tape_placement *const *)first, *y = *(tape_placement *const *)second;
    return x->level != y->level ? x->level - y->level : x->node->index - y->node->index;
}

static void set_adjacency_class_if_unset(const graph_lowering *lowering, const struct jet_node *node,
                                         int adjacency_class)
{
    if (node && lowering->placements[node->index].adjacency_class < 0)
        lowering->placements[node->index].adjacency_class = adjacency_class;
}

/* Divides the operations of a level into numbered adjacency classes. Operations of one class are placed one after the
 * other, so that they can read adjacent slots. For an operation with two operands, the function counts how many
 * operations before it read each operand; the larger count is the number of the class. An operation with one
 * operand, or with none, gets the number of the first two-operand operation that reads it. If a sum of products reads
 * it first, its number is its position among the terms of that sum. As an example, let x, y and z be the components of
 * the distances of many pairs of bodies; they are squared and summed, and each is multiplied by a function of its pair.
 * Then all x form one class, all y the next, and all z the third. */
static void assign_adjacency_classes(graph_lowering *lowering, tape_placement *level[], int count)
{
    for (int i = 0; i < count; i++) {
        tape_placement *z = level[i];
        for (int pair_index = 0; pair_index < z->operand_pair_count; pair_index++) {
            const struct jet_node *a = find_operand_node(lowering, z, pair_index, 0),
                                  *b = find_operand_node(lowering, z, pair_index, 1);
            if (b)
                z->adjacency_class = larger_int(
                    z->adjacency_class, larger_int(lowering->use_counts[a->index]++, lowering->use_counts[b->index]++));
            if (!b && z->operand_pair_count == 1) continue;
            set_adjacency_class_if_unset(lowering, a, z->operand_pair_count > 1 ? pair_index : z->adjacency_class);
            set_adjacency_class_if_unset(lowering, b, z->operand_pair_count > 1 ? pair_index : z->adjacency_class);
        }
    }
    for (int i = 0; i < count; i++)
        for (int pair_index = 0; pair_index < level[i]->operand_pair_count; pair_index++)
            for (int factor_index = 0; factor_index < 2; factor_index++) {
                const struct jet_node *read = find_operand_node(lowering, level[i], pair_index, factor_index);
                if (read) lowering->use_counts[read->index] = 0;
            }
}

static int compare_numbers(double a, double b) { return (a > b) - (a < b); }

static int compare_term_coefficients(const tape_placement *x, const tape_placement *y)
{
    for (int pair_index = 0; pair_index < x->operand_pair_count; pair_index++) {
        const int order = compare_numbers(sum_term(x, pair_index).coefficient, sum_term(y, pair_index).coefficient);
        if (order) return order;
    }
    return 0;
}

/* Compares two nodes of a level for sorting. A group consists of the nodes that can be operations of one run, if their
 * operands are adjacent; the result is 0 for two nodes of one group. */
static int compare_run_groups(const tape_placement *x, const tape_placement *y)
{
    if (x->op != y->op) return (int)x->op - (int)y->op;
    /* Sums of equally many terms are sorted together. */
    if (x->operand_pair_count == 0) return x->node->count - y->node->count;
    if (x->operand_pair_count != y->operand_pair_count) return x->operand_pair_count - y->operand_pair_count;
    return jet_rules[x->node->op] ? compare_numbers(x->node->number, y->node->number) : compare_term_coefficients(x, y);
}

/* Compares two nodes of a level for qsort: by group and adjacency class, then by the slots of their operands, so that
 * adjacent results have adjacent operands. This function compares the slots of operand a first, and
 * compare_by_second_operand those of operand b. Sums that are outputs come last, in the order of the outputs. */
static int compare_by_first_operand(const void *first, const void *second)
{
    const tape_placement *x = *(tape_placement *const *)first, *y = *(tape_placement *const *)second;
    const int group = compare_run_groups(x, y);
    if (group) return group;
    if (x->level > 0 && x->adjacency_class != y->adjacency_class) return x->adjacency_class - y->adjacency_class;
    if (x->operand_pair_count == 0)
        return x->level > 0 && x->one_based_output_index != y->one_based_output_index
                   ? x->one_based_output_index - y->one_based_output_index
                   : x->node->index - y->node->index;
    const int *of_x = x->operand[0], *of_y = y->operand[0];
    if (of_x[0] != of_y[0]) return of_x[0] - of_y[0];
    return of_x[1] != of_y[1] ? of_x[1] - of_y[1] : x->node->index - y->node->index;
}

static int compare_by_second_operand(const void *first, const void *second)
{
    const tape_placement *x = *(tape_placement *const *)first, *y = *(tape_placement *const *)second;
    const int difference = x->operand[0][1] - y->operand[0][1];
    return difference ? difference : compare_by_first_operand(first, second);
}

static void assign_next_slot(graph_lowering *lowering, tape_placement *z)
{
    z->slot = lowering->slot_count;
    lowering->nodes_by_slot[lowering->slot_count++] = z;
}

/* Tells whether successive operations of the group have this operand in successive slots, or have no such operand. */
static bool are_operands_adjacent(const graph_lowering *lowering, tape_placement *const group[], int count,
                                  int pair_index, int factor_index)
{
    if (!find_operand_node(lowering, group[0], pair_index, factor_index)) return true;
    for (int i = 1; i < count; i++)
        if (group[i]->operand[pair_index][factor_index] != group[0]->operand[pair_index][factor_index] + i)
            return false;
    return true;
}

/* Tells whether the operations of each adjacency class read adjacent slots. The classes are parts of the group: a group
 * can be one run, and the results of a class have to be adjacent. */
static bool each_class_reads_adjacent_slots(const graph_lowering *lowering, tape_placement *const group[], int count)
{
    for (int begin = 0, end = 0; begin < count; begin = end) {
        while (end < count && group[end]->adjacency_class == group[begin]->adjacency_class) end++;
        for (int pair_index = 0; pair_index < group[0]->operand_pair_count; pair_index++)
            for (int factor_index = 0; factor_index < 2; factor_index++)
                if (!are_operands_adjacent(lowering, group + begin, end - begin, pair_index, factor_index))
                    return false;
    }
    return true;
}

/* Copies an operand that the operations of a group read at scattered slots to adjacent slots, so that the group
 * becomes one run. */
static void copy_operands_to_adjacent_slots(graph_lowering *lowering, tape_placement *group[], int count,
                                            int pair_index, int factor_index)
{
    if (are_operands_adjacent(lowering, group, count, pair_index, factor_index)) return;
    for (int i = 0; i < count; i++) {
        tape_placement *copy = &lowering->placements[lowering->node_count + lowering->copy_count++];
        *copy = (tape_placement){
            .op = OP_LINEAR, .level = group[i]->level, .operand = lowering->operands + lowering->operand_pair_count++};
        copy->operand[0][0] = group[i]->operand[pair_index][factor_index];
        assign_next_slot(lowering, copy);
        group[i]->operand[pair_index][factor_index] = copy->slot;
    }
}

/* Sorts the operations of a group, or copies operands, so that successive operations read adjacent slots. The order by
 * adjacency classes is kept if the operations of each class read adjacent slots. Otherwise the group is sorted by one
 * operand, and the other operand is copied to adjacent slots. */
static void make_group_operands_adjacent(graph_lowering *lowering, tape_placement *group[], int count)
{
    if (each_class_reads_adjacent_slots(lowering, group, count)) return;
    if (!are_operands_adjacent(lowering, group, count, 0, 0) && !are_operands_adjacent(lowering, group, count, 0, 1))
        qsort(group, (size_t)count, sizeof *group, compare_by_second_operand);
    for (int pair_index = 0; pair_index < group[0]->operand_pair_count; pair_index++)
        for (int factor_index = 0; factor_index < 2; factor_index++)
            copy_operands_to_adjacent_slots(lowering, group, count, pair_index, factor_index);
}

/* Returns the end of the group that begins with level[group_begin]. A group consists of the nodes that can be
 * operations of one run (compare_run_groups). */
static int find_group_end(tape_placement *const level[], int group_begin, int level_count)
{
    int end = group_begin + 1;
    while (end < level_count && compare_run_groups(level[group_begin], level[end]) == 0) end++;
    return end;
}

/* Assigns the slots of a level: first those of sums and copies, then those of the other operations, group by group. */
static void assign_slots_of_level(graph_lowering *lowering, tape_placement *level[], int count)
{
    for (int i = 0; i < count; i++)
        for (int pair_index = 0; pair_index < level[i]->operand_pair_count; pair_index++)
            for (int factor_index = 0; factor_index < 2; factor_index++)
                level[i]->operand[pair_index][factor_index] =
                    node_slot(lowering, find_operand_node(lowering, level[i], pair_index, factor_index));
    qsort(level, (size_t)count, sizeof *level, compare_by_first_operand);
    for (int i = 0; i < count; i++)
        if (level[i]->operand_pair_count == 0) assign_next_slot(lowering, level[i]);
    for (int begin = 0, end = 0; begin < count; begin = end) {
        end = find_group_end(level, begin, count);
        if (level[begin]->operand_pair_count > 0) make_group_operands_adjacent(lowering, level + begin, end - begin);
    }
    for (int i = 0; i < count; i++)
        if (level[i]->operand_pair_count > 0) assign_next_slot(lowering, level[i]);
}

static void call_for_each_level(graph_lowering *lowering,
                                void (*function)(graph_lowering *lowering, tape_placement *level[], int count))
{
    for (int begin = 0, end = 0; begin < lowering->needed_node_count; begin = end) {
        while (end < lowering->needed_node_count &&
               lowering->nodes_by_level[end]->level == lowering->nodes_by_level[begin]->level)
            end++;
        function(lowering, lowering->nodes_by_level + begin, end - begin);
    }
}

/* Assigns slots level by level, since the order of operations in a level depends on the slots of their operands, in
 * lower levels. */
static void assign_slots_by_level(graph_lowering *lowering)
{
    qsort(lowering->nodes_by_level, (size_t)lowering->needed_node_count, sizeof *lowering->nodes_by_level,
          compare_by_level);
    call_for_each_level(lowering, assign_adjacency_classes);
    call_for_each_level(lowering, assign_slots_of_level);
}

void jet_assign_slots(graph_lowering *lowering, int input_count, int output_count, const jet output[])
{
    mark_needed_nodes(lowering, input_count, output_count, output);
    choose_all_operations(lowering, output_count, output);
    assign_levels(lowering);
    assign_slots_by_level(lowering);
}
