/* derive.c - Records the gradient of a scalar into the scalar's own graph, by reverse accumulation (docs/jets.md,
 * section 1). The systems call it, as in F = -V_q. */
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
    int count, capacity;
    int *newest;    /* [nodes] Index of the newest contribution to each node; -1: the node has none. */
    jet *sum_terms; /* Scratch for the contributions to one node. */
    int sum_capacity;
    bool is_out_of_memory;
} adjoint_lists;

static void add_adjoint_contribution(adjoint_lists *bar, const struct jet_node *node, jet value)
{
    if (bar->count == bar->capacity) {
        const int capacity = bar->capacity ? 2 * bar->capacity : 256;
        adjoint_contribution *contributions = realloc(bar->contributions, (size_t)capacity * sizeof *contributions);
        if (!contributions) {
            bar->is_out_of_memory = true;
            return;
        }
        bar->contributions = contributions;
        bar->capacity = capacity;
    }
    bar->contributions[bar->count] = (adjoint_contribution){value, bar->newest[node->index]};
    bar->newest[node->index] = bar->count++;
}

/* Records the sum of a node's contributions, which is the node's adjoint. */
static jet sum_adjoint_contributions(adjoint_lists *bar, int node_index)
{
    int count = 0;
    for (int i = bar->newest[node_index]; i >= 0; i = bar->contributions[i].next_index) count++;
    if (count > bar->sum_capacity) {
        jet *sum_terms = realloc(bar->sum_terms, (size_t)count * sizeof *sum_terms);
        if (!sum_terms) {
            bar->is_out_of_memory = true;
            return jet_const(0);
        }
        bar->sum_terms = sum_terms;
        bar->sum_capacity = count;
    }
    int free_index = count;
    /* The buffer has room, since its size was set above. NOLINTNEXTLINE(clang-analyzer-core.NullDereference) */
    for (int i = bar->newest[node_index]; i >= 0; i = bar->contributions[i].next_index)
        bar->sum_terms[--free_index] = bar->contributions[i].value;
    const jet sum = jet_sum(bar->sum_terms, count);
    bar->is_out_of_memory |=
        sum.node && !sum.node->graph &&
        sum.node->index == TVI_ENOMEM; /* The failure counts even if no input depends on this node. */
    return sum;
}

/* Splits a jet into a constant factor, which it returns, and the rest. In sums, constant factors are then added, and
 * not multiplied one by one. */
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

static void propagate_adjoint_to_operands(adjoint_lists *bar, struct jet_node *z, jet zbar)
{
    for (int i = 0; i < z->count; i++)
        add_adjoint_contribution(bar, z->terms[i].node, jet_mul(z->terms[i].coefficient, zbar));
    const jet_rule *rule = jet_rules[z->op];
    if (!rule) return;
    const double factor = extract_constant_factor(&zbar); /* The rules are linear in z-bar. */
    add_adjoint_contribution(bar, z->a, jet_mul(factor, rule->record_pullback(z, zbar, 0)));
    if (z->b) add_adjoint_contribution(bar, z->b, jet_mul(factor, rule->record_pullback(z, zbar, 1)));
}

bool jet_record_gradient(jet_graph *graph, jet output, int inputs, jet gradient[])
{
    for (int i = 0; i < inputs; i++) gradient[i] = jet_const(0);
    if (!output.node) return true;
    if (output.node->graph !=
        graph) { /* If the output is poison or belongs to another recording, the gradient is poison. */
        for (int i = 0; i < inputs; i++) gradient[i] = output.node->graph ? jet_make_unset() : output;
        return true;
    }
    adjoint_lists bar = {0};
    const int count = output.node->index + 1;
    bar.newest = malloc((size_t)count * sizeof *bar.newest);
    if (!bar.newest) return false;
    for (int i = 0; i < count; i++) bar.newest[i] = -1;
    add_adjoint_contribution(&bar, output.node, jet_const(1));
    for (int i = count - 1; i >= 0 && !bar.is_out_of_memory; i--) {
        if (bar.newest[i] < 0) continue;
        const jet zbar = sum_adjoint_contributions(&bar, i);
        if (i < inputs) gradient[i] = zbar;
        if (!bar.is_out_of_memory) propagate_adjoint_to_operands(&bar, jet_graph_node_at(graph, i), zbar);
    }
    free(bar.contributions);
    free(bar.newest);
    free(bar.sum_terms);
    return !bar.is_out_of_memory;
}
