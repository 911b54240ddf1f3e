/* rescaled.c - Creates a system in a rescaled time s, dt = g ds, whose steps adapt and stay symplectic
 * (docs/adaptive.md). It has n + 1 coordinates and the Hamiltonian K(q, t, p, e) = g(q, p, t) (H(q, p, t) + e). With
 * e = -H at the start, K is 0 on the orbit, and
 *     dq/ds = g H_p + (H+e) g_p,  dt/ds = g,  dp/ds = -g H_q - (H+e) g_q,  de/ds = -g H_t - (H+e) g_t.
 * Equal steps in s are symplectic in (q, t, p, e). K and H are recorded from the recording of the system.
 *
 * The file also records the function that the user stated once more, for rescaled and for driven systems. */
#include "system/system.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>

/* ---- The stated function ----------------------------------------------------------------------------------------- */

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

/* A system, and the time scale with which it is rescaled. */
typedef struct {
    const tvi_system *base;
    tvi_rescale_fn *time_scale; /* The user's time scale g; NULL: it is automatic. */
    void *ctx;
} rescaled_statement;

/* ---- The time scale ---------------------------------------------------------------------------------------------- */

/* Returns g as a jet whose sweep fails with TVI_EDOMAIN at states where g is not positive. The automatic g, a power, is
 * positive wherever it has a value. */
static jet require_positive_scale(jet g, bool is_automatic)
{
    if (!g.node) return g.number > 0 ? g : jet_make_poison(isnan(g.number) ? JET_NOT_FINITE : JET_NOT_POSITIVE);
    return is_automatic || jet_is_poison(g) ? g : jet_sqr(jet_sqrt(g));
}

/* ---- The systems ------------------------------------------------------------------------------------------------- */

/* Records the two factors of K: factor = {g, H + e}. */
static void record_factors_of_K(const jet q[], const jet p[], jet s, void *ctx, jet factor[2])
{
    const rescaled_statement *statement = ctx;
    const int n = statement->base->n;
    (void)s;
    const jet H = tvi_record_stated_hamiltonian(q, p, q[n], (void *)statement->base);
    const jet g = statement->time_scale ? statement->time_scale(q, p, q[n], statement->ctx)
                                        : tvi_record_automatic_scale(statement->base, H);
    factor[0] = require_positive_scale(g, !statement->time_scale);
    factor[1] = jet_add(H, p[n]);
}

tvi_status tvi_system_rescaled(tvi_system **out, const tvi_system *system, tvi_rescale_fn *g, void *ctx)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    const char *const unsupported = !system->energy                  ? "a force has no Hamiltonian: state the potential"
                                    : system->is_driven              ? "a driven system has no Hamiltonian flow"
                                    : system->form == TVI_LAGRANGIAN ? "state the Hamiltonian instead of the Lagrangian"
                                    : system->stepped != system      ? "the system is rescaled already"
                                                                     : NULL;
    if (unsupported) return jet_refuse(TVI_EUNSUPPORTED, "%s", unsupported);
    rescaled_statement statement = {system, g, ctx};
    tvi_system *stepped, *rescaled;
    tvi_status status = tvi_system_create_rescaled(&stepped, system->n + 1, record_factors_of_K, &statement);
    if (status == TVI_EDOMAIN && !g)
        return jet_refuse(status, "K = g (H + e): the automatic g has no value (give a g of your own): %s",
                          jet_last_refusal_text());
    if (status != TVI_OK) return jet_refuse(status, "K = g (H + e): %s", jet_last_refusal_text());
    stepped->regular = false; /* K_ee = 0 */
    stepped->is_automatic = !g;
    stepped->compares_movements = system->has_masses;
    status = tvi_system_hamiltonian(&rescaled, system->n, tvi_record_stated_hamiltonian, (void *)system);
    if (status != TVI_OK) {
        tvi_system_free(stepped);
        return status;
    }
    rescaled->stepped = stepped;
    *out = rescaled;
    return TVI_OK;
}
