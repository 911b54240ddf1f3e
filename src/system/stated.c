/* stated.c - Records the user's H or L once more for another system: a driven or a rescaled one. */
#include "system/system.h"

#include <stdlib.h>

/* Records V, L or H, as the user stated it, at (q, t) and the velocities v or momenta p. NULL stands for velocities
 * or momenta that are 0: calloc makes each input the number 0. */
static jet record_stated_function(const tvi_system *base, const jet q[], const jet velocities[], jet t)
{
    const int n = base->n, inputs = jet_graph_input_count(base->graph), time_index = base->energy_inputs;
    jet_graph *graph;
    const jet refused = jet_find_graph_or_poison(1, q, &graph);
    if (refused.node) return refused;
    jet *input = calloc(2 * (size_t)inputs, sizeof *input), value, rate;
    if (!input) return jet_make_poison(JET_NO_MEMORY);
    for (int i = 0; i < n; i++) input[i] = q[i];
    for (int i = n; i < time_index && velocities; i++) input[i] = velocities[i - n];
    input[time_index] = t;
    const bool lifted = jet_record_forward_derivatives(base->graph, graph, input, input + inputs, NULL, 1,
                                                       &base->stated, &value, &rate);
    free(input);
    return lifted ? value : jet_make_poison(JET_NO_MEMORY);
}

/* Records H. For a separable system H is sum p_i^2 / (2 m_i) + V, and V is the stated function at p = 0 or v = 0, up
 * to the sign. */
jet tvi_record_stated_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    const tvi_system *base = ctx;
    if (base->form == TVI_HAMILTONIAN) return record_stated_function(base, q, p, t);
    jet *terms = malloc(((size_t)base->n + 1) * sizeof *terms);
    if (!terms) return jet_make_poison(JET_NO_MEMORY);
    terms[0] = jet_mul(base->energy_sign, record_stated_function(base, q, NULL, t));
    for (int i = 0; i < base->n; i++) terms[1 + i] = jet_div(jet_sqr(p[i]), 2 * base->mass[i]);
    const jet H = jet_sum(terms, base->n + 1);
    free(terms);
    return H;
}

jet tvi_record_stated_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return record_stated_function(ctx, q, v, t);
}
