/* derive.c - Records the gradient of a scalar into the same graph, by reverse accumulation. */
#include "graph.h"
#include "rule.h"

#include <stdlib.h>

/* The contributions to the adjoints of all nodes, a list for each. */
typedef struct {
    jet value;
    int next; /* index of the node's next contribution; -1: none */
} contribution;

typedef struct {
    contribution *all;
    int count, capacity;
    int *last;    /* [nodes] the newest contribution of each; -1: none */
    jet *summing; /* scratch for one node's list */
    int summing_capacity;
    bool failed;
} adjoints;

static void contribute(adjoints *bar, const struct jet_node *node, jet value)
{
    if (bar->count == bar->capacity) {
        const int capacity = bar->capacity ? 2 * bar->capacity : 256;
        contribution *all = realloc(bar->all, (size_t)capacity * sizeof *all);
        if (!all) {
            bar->failed = true;
            return;
        }
        bar->all = all;
        bar->capacity = capacity;
    }
    bar->all[bar->count] = (contribution){value, bar->last[node->index]};
    bar->last[node->index] = bar->count++;
}

/* Sums the contributions to the adjoint z-bar of a node. */
static jet adjoint_of(adjoints *bar, int index)
{
    int count = 0;
    for (int i = bar->last[index]; i >= 0; i = bar->all[i].next) count++;
    if (count > bar->summing_capacity) {
        jet *summing = realloc(bar->summing, (size_t)count * sizeof *summing);
        if (!summing) {
            bar->failed = true;
            return jet_const(0);
        }
        bar->summing = summing;
        bar->summing_capacity = count;
    }
    int free_place = count;
    /* room was made when the value was added. NOLINTNEXTLINE(clang-analyzer-core.NullDereference) */
    for (int i = bar->last[index]; i >= 0; i = bar->all[i].next) bar->summing[--free_place] = bar->all[i].value;
    const jet sum = jet_sum(bar->summing, count);
    bar->failed |= sum.node && !sum.node->graph && sum.node->index == TVI_ENOMEM; /* also if no input needs it */
    return sum;
}

/* Takes a constant factor out of the jet, so that factors meet in sums instead of being multiplied in one by one. */
static double take_factor(jet *x)
{
    double factor = 1;
    if (!x->node) {
        factor = x->number;
        *x = jet_const(1);
    } else if (x->node->op == OP_LINEAR && x->node->count == 1 && x->node->number == 0) {
        factor = x->node->terms[0].coefficient;
        *x = jet_of_node(x->node->terms[0].node);
    }
    return factor;
}

static void pull_to_operands(adjoints *bar, struct jet_node *z, jet zbar)
{
    for (int i = 0; i < z->count; i++) contribute(bar, z->terms[i].node, jet_mul(z->terms[i].coefficient, zbar));
    const jet_rule *rule = jet_rules[z->op];
    if (!rule) return;
    const double factor = take_factor(&zbar); /* the rules are linear in z-bar */
    contribute(bar, z->a, jet_mul(factor, rule->pull(z, zbar, 0)));
    if (z->b) contribute(bar, z->b, jet_mul(factor, rule->pull(z, zbar, 1)));
}

bool jet_gradient(jet_graph *graph, jet output, int inputs, jet gradient[])
{
    for (int i = 0; i < inputs; i++) gradient[i] = jet_const(0);
    if (!output.node) return true;
    if (output.node->graph != graph) { /* the output is poison, or of another recording: so is its gradient */
        for (int i = 0; i < inputs; i++) gradient[i] = output.node->graph ? jet_unset() : output;
        return true;
    }
    adjoints bar = {0};
    const int count = output.node->index + 1;
    bar.last = malloc((size_t)count * sizeof *bar.last);
    if (!bar.last) return false;
    for (int i = 0; i < count; i++) bar.last[i] = -1;
    contribute(&bar, output.node, jet_const(1));
    for (int i = count - 1; i >= 0 && !bar.failed; i--) {
        if (bar.last[i] < 0) continue;
        const jet zbar = adjoint_of(&bar, i);
        if (i < inputs) gradient[i] = zbar;
        if (!bar.failed) pull_to_operands(&bar, jet_graph_node(graph, i), zbar);
    }
    free(bar.all);
    free(bar.last);
    free(bar.summing);
    return !bar.failed;
}
