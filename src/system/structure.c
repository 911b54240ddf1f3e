/* structure.c - Tests whether a recorded system is separable, and finds its masses. statement.c calls it. */
#include "system/system.h"

#include <math.h>
#include <stdlib.h>

/* Tells whether x = sum_j coefficients_j v_j, with v_j the input first_input + j, and computes the coefficients by
 * one walk back through the graph. node_factors is scratch with one number for each node. */
static bool extract_linear_form(const jet_graph *graph, jet x, int first_input, int n, double node_factors[],
                                double coefficients[])
{
    for (int j = 0; j < n; j++) coefficients[j] = 0;
    if (!x.node) return x.number == 0;
    for (int i = 0; i <= x.node->index; i++) node_factors[i] = 0;
    node_factors[x.node->index] = 1;
    for (int i = x.node->index; i >= 0; i--) {
        const struct jet_node *z = jet_graph_node_at(graph, i);
        if (node_factors[i] == 0) continue;
        if (z->op == OP_INPUT && i >= first_input && i < first_input + n)
            coefficients[i - first_input] = node_factors[i];
        else if (z->op != OP_LINEAR || z->number != 0) return false;
        for (int term = 0; term < z->count; term++)
            node_factors[z->terms[term].node->index] += node_factors[i] * z->terms[term].coefficient;
    }
    return true;
}

/* Marks the nodes that depend on one of the n inputs that begin with first_input. */
static void mark_nodes_dependent_on_inputs(const jet_graph *graph, int first_input, int n)
{
    for (int i = 0; i < jet_graph_node_count(graph); i++) {
        struct jet_node *z = jet_graph_node_at(graph, i);
        bool depends = z->op == OP_INPUT && i >= first_input && i < first_input + n;
        depends = depends || (z->a && z->a->mark) || (z->b && z->b->mark);
        for (int term = 0; term < z->count; term++) depends = depends || z->terms[term].node->mark;
        z->mark = depends;
    }
}

/* Tells whether row i of a matrix is positive on the diagonal, and 0 elsewhere. */
static bool is_row_positive_diagonal(int n, const double coefficients[], int i)
{
    for (int j = 0; j < n; j++)
        if (j != i && coefficients[j] != 0) return false;
    return coefficients[i] > 0 && isfinite(1 / coefficients[i]);
}

tvi_status tvi_system_test_separable(tvi_system *system, const jet velocity_field[], const jet other_field[],
                                     bool *is_separable)
{
    const int n = system->n;
    double *coefficients = malloc(((size_t)n + (size_t)jet_graph_node_count(system->graph)) * sizeof *coefficients);
    if (!coefficients) return TVI_ENOMEM;
    *is_separable = true;
    mark_nodes_dependent_on_inputs(system->graph, n, n);
    for (int i = 0; i < n && *is_separable; i++) {
        *is_separable = extract_linear_form(system->graph, velocity_field[i], n, n, coefficients + n, coefficients) &&
                        is_row_positive_diagonal(n, coefficients, i) &&
                        !(other_field[i].node && other_field[i].node->mark);
        system->mass[i] = coefficients[i];
    }
    free(coefficients);
    return TVI_OK;
}

/* Adds factor times the coefficient of one velocity in x to *mass. Returns false if x depends on the velocities in
 * any other way. Nodes that depend on velocities are marked. */
static bool add_velocity_coefficient(const struct jet_node *x, int velocity_input, double factor, double *mass)
{
    if (!x->mark) return true;
    if (x->op == OP_INPUT) *mass += factor;
    if (x->op != OP_LINEAR) return x->op == OP_INPUT && x->index == velocity_input;
    for (int term = 0; term < x->count; term++)
        if (!add_velocity_coefficient(x->terms[term].node, velocity_input, factor * x->terms[term].coefficient, mass))
            return false;
    return true;
}

void tvi_system_find_masses(tvi_system *system, const jet velocity_field[])
{
    const int n = system->n;
    mark_nodes_dependent_on_inputs(system->graph, n, n);
    system->has_masses = true;
    for (int i = 0; i < n && system->has_masses; i++) {
        double mass = 0;
        system->has_masses = velocity_field[i].node &&
                             add_velocity_coefficient(velocity_field[i].node, n + i, 1, &mass) && mass > 0 &&
                             isfinite(1 / mass);
        system->mass[i] = mass;
    }
}
