/* structure.c - Tests whether a recorded system is separable, finds its masses, and finds the inputs that jets depend
 * on. */
#include "system/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Marks the nodes that depend on one of the n inputs that begin with first_input. */
static void mark_nodes_dependent_on_inputs(const jet_graph *graph, int first_input, int n)
{
    for (int i = 0; i < jet_graph_node_count(graph); i++) {
        struct jet_node *z = jet_graph_node_at(graph, i);
        bool depends = z->op == OP_INPUT && i >= first_input && i < first_input + n;
        depends = depends || (z->a && z->a->scratch) || (z->b && z->b->scratch);
        for (int term = 0; term < z->count; term++) depends = depends || z->terms[term].node->scratch;
        z->scratch = depends;
    }
}

/* Tells whether x = coefficient v + other terms, where v is the input velocity_input, coefficient > 0, and the other
 * terms do not depend on velocities. The caller has marked the nodes that depend on velocities. *has_other_terms is set
 * if there are other terms. The coefficient is computed by one walk back through the graph. node_factors is scratch
 * with one number for each node. */
static bool is_velocity_multiple_plus_rest(const jet_graph *graph, jet x, int velocity_input, double node_factors[],
                                           double *coefficient, bool *has_other_terms)
{
    *coefficient = 0;
    if (!x.node) return false;
    for (int i = 0; i <= x.node->index; i++) node_factors[i] = 0;
    node_factors[x.node->index] = 1;
    for (int i = x.node->index; i >= 0; i--) {
        const struct jet_node *z = jet_graph_node_at(graph, i);
        if (node_factors[i] == 0) continue;
        if (i == velocity_input) *coefficient = node_factors[i];
        else if (z->scratch && z->op != OP_LINEAR) return false;
        else if (!z->scratch || z->number != 0) *has_other_terms = true;
        for (int term = 0; term < z->count && z->scratch; term++)
            node_factors[z->terms[term].node->index] += node_factors[i] * z->terms[term].coefficient;
    }
    return *coefficient > 0 && isfinite(1 / *coefficient);
}

tvi_status tvi_system_find_masses(tvi_system *system, const jet velocity_gradient[], const jet coordinate_gradient[],
                                  bool *is_separable)
{
    const int n = system->n;
    double *node_factors = malloc((size_t)jet_graph_node_count(system->record.graph) * sizeof *node_factors);
    if (!node_factors) return TVI_ENOMEM;
    mark_nodes_dependent_on_inputs(system->record.graph, n, n);
    bool is_coupled = false;
    system->has_masses = true;
    for (int i = 0; i < n && system->has_masses; i++) {
        system->has_masses = is_velocity_multiple_plus_rest(system->record.graph, velocity_gradient[i], n + i,
                                                            node_factors, &system->mass[i], &is_coupled);
        is_coupled |= coordinate_gradient[i].node && coordinate_gradient[i].node->scratch;
    }
    *is_separable = system->has_masses && !is_coupled;
    free(node_factors);
    return TVI_OK;
}

tvi_status tvi_system_find_used_inputs(const jet_graph *graph, int input_count, int value_count, const jet value[],
                                       bool used[])
{
    const int nodes = jet_graph_node_count(graph);
    bool *needed = calloc((size_t)nodes, sizeof *needed);
    if (!needed) return TVI_ENOMEM;
    for (int i = 0; i < value_count; i++) needed[value[i].node->index] = true;
    for (int i = nodes - 1; i >= 0; i--) {
        const struct jet_node *z = jet_graph_node_at(graph, i);
        if (z->a) needed[z->a->index] |= needed[i];
        if (z->b) needed[z->b->index] |= needed[i];
        for (int term = 0; term < z->count; term++) needed[z->terms[term].node->index] |= needed[i];
    }
    memcpy(used, needed, (size_t)input_count * sizeof *used);
    free(needed);
    return TVI_OK;
}
