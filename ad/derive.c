/* derive.c - Records the gradient of a scalar into the scalar's own graph, by reverse accumulation (docs/jets.md,
 * section 1). src/system/ calls it: for example, it records the force F = -V_q as the negative gradient of the
 * potential V. */
#include "graph.h"
#include "rule.h"

#include <stdlib.h>

/* One contribution to the adjoint of a node, as an element of a linked list. */
typedef struct {
    jet value;
    int next_index; /* Index of the next contribution to the same node; -1 ends the list. */
} adjoint_contribution;

/* The contributions to the adjoints of all nodes, with one linked list for each node. */
typedef struct {
    adjoint_contribution *contributions;
    int contribution_count, contribution_capacity;
    int *newest_contribution_index; /* [nodes] Index of the newest contribution to each node; -1: the node has none. */
    /* [scratch_contribution_capacity] Scratch for the contributions to one node. */
    jet *scratch_contributions;
    int scratch_contribution_capacity;
    bool is_out_of_memory;
} adjoint_lists;

static void add_adjoint_contribution(adjoint_lists *lists, const struct jet_node *node, jet value)
{
    if (lists->contribution_count == lists->contribution_capacity) {
        const int capacity = lists->contribution_capacity ? 2 * lists->contribution_capacity : 256;
        adjoint_contribution *contributions = realloc(lists->contributions, (size_t)capacity * sizeof *contributions);
        if (!contributions) {
            lists->is_out_of_memory = true;
            return;
        }
        lists->contributions = contributions;
        lists->contribution_capacity = capacity;
    }
    lists->contributions[lists->contribution_count] =
        (adjoint_contribution){value, lists->newest_contribution_index[node->index]};
    lists->newest_contribution_index[node->index] = lists->contribution_count++;
}

/* Records the sum of a node's contributions, which is the node's adjoint. */
static jet sum_adjoint_contributions(adjoint_lists *lists, int node_index)
{
    int count = 0;
    for (int i = lists->newest_contribution_index[node_index]; i >= 0; i = lists->contributions[i].next_index) count++;
    if (count > lists->scratch_contribution_capacity) {
        jet *scratch_contributions =
            realloc(lists->scratch_contributions, (size_t)count * sizeof *scratch_contributions);
        if (!scratch_contributions) {
            lists->is_out_of_memory = true;
            return jet_const(0);
        }
        lists->scratch_contributions = scratch_contributions;
        lists->scratch_contribution_capacity = count;
    }
    int free_index = count;
    /* The loop above has counted the contributions, and scratch_contributions has room for all of them.
     * NOLINTNEXTLINE(clang-analyzer-core.NullDereference) */
    for (int i = lists->newest_contribution_index[node_index]; i >= 0; i = lists->contributions[i].next_index)
        lists->scratch_contributions[--free_index] = lists->contributions[i].value;
    const jet sum = jet_sum(lists->scratch_contributions, count);
    /* If memory is lacking for the sum, it is a poison node whose index is TVI_ENOMEM. The whole gradient then fails,
     * even if this node depends on no input. */
    lists->is_out_of_memory |= sum.node && !sum.node->graph && sum.node->index == TVI_ENOMEM;
    return sum;
}

/* Splits a jet into a constant factor, which it returns, and the rest, which it stores in *product. The factor can
 * then become the coefficient of a term of a sum, and needs no multiplication of its own. */
static double extract_constant_factor(jet *product)
{
    double factor = 1;
    if (!product->node) {
        factor = product->number;
        *product = jet_const(1);
    } else if (product->node->op == OP_LINEAR && product->node->count == 1 && product->node->number == 0) {
        factor = product->node->terms[0].coefficient;
        *product = jet_from_node(product->node->terms[0].node);
    }
    return factor;
}

static void propagate_adjoint_to_operands(adjoint_lists *lists, struct jet_node *z, jet zbar)
{
    for (int i = 0; i < z->count; i++)
        add_adjoint_contribution(lists, z->terms[i].node, jet_mul(z->terms[i].coefficient, zbar));
    const jet_rule *rule = jet_rules[z->op];
    if (!rule) return;
    /* The contributions are linear in zbar, the adjoint of z. A constant factor of zbar can therefore be multiplied in
     * at the end. */
    const double factor = extract_constant_factor(&zbar);
    add_adjoint_contribution(lists, z->a, jet_mul(factor, rule->record_pullback(z, zbar, 0)));
    if (z->b) add_adjoint_contribution(lists, z->b, jet_mul(factor, rule->record_pullback(z, zbar, 1)));
}

bool jet_record_gradient_by(jet_graph *graph, jet output, int input_count, jet gradient[], int parameter_count,
                            jet by_parameter[])
{
    for (int i = 0; i < input_count; i++) gradient[i] = jet_const(0);
    for (int i = 0; i < parameter_count; i++) by_parameter[i] = jet_const(0);
    if (!output.node) return true;
    if (output.node->graph !=
        graph) { /* If the output is poison or belongs to another recording, the gradient is poison. */
        const jet poison = output.node->graph ? jet_make_unset_poison() : output;
        for (int i = 0; i < input_count; i++) gradient[i] = poison;
        for (int i = 0; i < parameter_count; i++) by_parameter[i] = poison;
        return true;
    }
    adjoint_lists lists = {0};
    const int count = output.node->index + 1;
    lists.newest_contribution_index = malloc((size_t)count * sizeof *lists.newest_contribution_index);
    if (!lists.newest_contribution_index) return false;
    for (int i = 0; i < count; i++) lists.newest_contribution_index[i] = -1;
    add_adjoint_contribution(&lists, output.node, jet_const(1));
    for (int i = count - 1; i >= 0 && !lists.is_out_of_memory; i--) {
        if (lists.newest_contribution_index[i] < 0) continue;
        const jet zbar = sum_adjoint_contributions(&lists, i);
        struct jet_node *node = jet_graph_node_at(graph, i);
        if (i < input_count) gradient[i] = zbar;
        if (node->op == OP_PARAMETER && node->parameter_index < parameter_count)
            by_parameter[node->parameter_index] = zbar;
        if (!lists.is_out_of_memory) propagate_adjoint_to_operands(&lists, node, zbar);
    }
    free(lists.contributions);
    free(lists.newest_contribution_index);
    free(lists.scratch_contributions);
    return !lists.is_out_of_memory;
}

bool jet_record_gradient(jet_graph *graph, jet output, int input_count, jet gradient[])
{
    return jet_record_gradient_by(graph, output, input_count, gradient, 0, NULL);
}
