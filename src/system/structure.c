/* structure.c - Finds out whether a recording is separable, and its masses. */
#include "system/system.h"

#include <math.h>
#include <stdlib.h>

/* Tells whether x = sum_j row_j v_j, with v_j the input first + j, and computes the coefficients by one walk back
 * through the graph. share is scratch for each node. */
static bool is_linear_form(const jet_graph *graph, jet x, int first, int n, double share[], double row[])
{
    for (int j = 0; j < n; j++) row[j] = 0;
    if (!x.node) return x.number == 0;
    for (int i = 0; i <= x.node->index; i++) share[i] = 0;
    share[x.node->index] = 1;
    for (int i = x.node->index; i >= 0; i--) {
        const struct jet_node *z = jet_graph_node(graph, i);
        if (share[i] == 0) continue;
        if (z->op == OP_INPUT && i >= first && i < first + n) row[i - first] = share[i];
        else if (z->op != OP_LINEAR || z->number != 0) return false;
        for (int term = 0; term < z->count; term++)
            share[z->terms[term].node->index] += share[i] * z->terms[term].coefficient;
    }
    return true;
}

/* Marks the nodes that depend on one of the inputs first .. first + n - 1. */
static void mark_dependents(const jet_graph *graph, int first, int n)
{
    for (int i = 0; i < jet_graph_count(graph); i++) {
        struct jet_node *z = jet_graph_node(graph, i);
        bool depends = z->op == OP_INPUT && i >= first && i < first + n;
        depends = depends || (z->a && z->a->mark) || (z->b && z->b->mark);
        for (int term = 0; term < z->count; term++) depends = depends || z->terms[term].node->mark;
        z->mark = depends;
    }
}

/* Tells whether row i is d_i > 0 at i, and 0 elsewhere. */
static bool is_diagonal(int n, const double row[], int i)
{
    for (int j = 0; j < n; j++)
        if (j != i && row[j] != 0) return false;
    return row[i] > 0 && isfinite(1 / row[i]);
}

tvi_status tvi_system_find_separable(tvi_system *system, const jet linear[], const jet other[], bool *separable)
{
    const int n = system->n;
    double *row = malloc(((size_t)n + (size_t)jet_graph_count(system->graph)) * sizeof *row);
    if (!row) return TVI_ENOMEM;
    *separable = true;
    mark_dependents(system->graph, n, n);
    for (int i = 0; i < n && *separable; i++) {
        *separable = is_linear_form(system->graph, linear[i], n, n, row + n, row) && is_diagonal(n, row, i) &&
                     !(other[i].node && other[i].node->mark);
        system->mass[i] = row[i];
    }
    free(row);
    return TVI_OK;
}

/* Adds the coefficient of the input v_i to *inertia. Returns false if x depends on the velocities in any other way;
 * nodes that depend on velocities are marked. */
static bool add_inertia(const struct jet_node *x, int v_i, double factor, double *inertia)
{
    if (!x->mark) return true;
    if (x->op == OP_INPUT) *inertia += factor;
    if (x->op != OP_LINEAR) return x->op == OP_INPUT && x->index == v_i;
    for (int term = 0; term < x->count; term++)
        if (!add_inertia(x->terms[term].node, v_i, factor * x->terms[term].coefficient, inertia)) return false;
    return true;
}

void tvi_system_find_inertia(tvi_system *system, const jet linear[])
{
    const int n = system->n;
    mark_dependents(system->graph, n, n);
    system->has_masses = true;
    for (int i = 0; i < n && system->has_masses; i++) {
        double inertia = 0;
        system->has_masses =
            linear[i].node && add_inertia(linear[i].node, n + i, 1, &inertia) && inertia > 0 && isfinite(1 / inertia);
        system->mass[i] = inertia;
    }
}
