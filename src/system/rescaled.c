/* rescaled.c - Creates a system in a rescaled time s, dt = g ds, whose steps adapt and stay symplectic
 * (docs/adaptive.md). It has the n + 1 coordinates (q, t) with the momenta (p, e), and the Hamiltonian K(q, t, p, e) =
 * g(q, p, t) (H(q, p, t) + e). With e = -H at the start, K is 0 on the orbit, and
 *     dq/ds = g H_p + (H+e) g_p,  dt/ds = g,  dp/ds = -g H_q - (H+e) g_q,  de/ds = -g H_t - (H+e) g_t.
 * Equal steps in s are symplectic in (q, t, p, e). K and H are recorded by a walk through the recording of the user's
 * system.
 *
 * The file also records the user's V, L or H once more in another graph, for rescaled and for driven systems. */
#include "system/system.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>

/* ---- The user's function ----------------------------------------------------------------------------------------- */

/* Records the V, L or H of the user's system `base` in the graph of q, at the coordinates q, the time t, and the
 * velocities of L or momenta of H. NULL stands for velocities or momenta that are 0, since calloc makes each input the
 * number 0. */
static jet record_user_function(const tvi_system *base, const jet q[], const jet velocities_or_momenta[], jet t)
{
    const int n = base->n, inputs = jet_graph_input_count(base->graph), time_index = base->energy_input_count;
    jet_graph *graph;
    const jet refused = jet_find_common_graph_or_poison(1, q, &graph);
    if (refused.node) return refused;
    jet *input = calloc(2 * (size_t)inputs, sizeof *input), value, rate;
    if (!input) return jet_make_poison(JET_NO_MEMORY);
    for (int i = 0; i < n; i++) input[i] = q[i];
    for (int i = n; i < time_index && velocities_or_momenta; i++) input[i] = velocities_or_momenta[i - n];
    input[time_index] = t;
    const bool lifted = jet_record_forward_derivatives(base->graph, graph, input, input + inputs, NULL, 1,
                                                       &base->user_function, &value, &rate);
    free(input);
    return lifted ? value : jet_make_poison(JET_NO_MEMORY);
}

/* Records H. For a separable system H is sum p_i^2 / (2 m_i) + V, and V is the user's function at p = 0 or v = 0, up to
 * its sign (energy_sign). */
jet tvi_record_user_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    const tvi_system *base = ctx;
    if (base->form == TVI_HAMILTONIAN) return record_user_function(base, q, p, t);
    jet *terms = malloc(((size_t)base->n + 1) * sizeof *terms);
    if (!terms) return jet_make_poison(JET_NO_MEMORY);
    terms[0] = jet_mul(base->energy_sign, record_user_function(base, q, NULL, t));
    for (int i = 0; i < base->n; i++) terms[1 + i] = jet_div(jet_sqr(p[i]), 2 * base->mass[i]);
    const jet H = jet_sum(terms, base->n + 1);
    free(terms);
    return H;
}

jet tvi_record_user_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return record_user_function(ctx, q, v, t);
}

/* The request to rescale a system by the time scale g = dt/ds. */
typedef struct {
    const tvi_system *base;
    tvi_rescale_fn *time_scale; /* The user's time scale g; NULL: it is automatic. */
    void *ctx;
} rescaling_request;

/* ---- The time scale ---------------------------------------------------------------------------------------------- */

/* Tells whether a node of a graph is positive wherever it has a value. Only the operations that compute it are
 * examined. A parameter counts as not positive, since it may become negative. */
static bool is_always_positive(const struct jet_node *node)
{
    switch (node->op) {
    case OP_EXP:
    case OP_COSH:
    case OP_SQRT:
    case OP_HYPOT: return true;
    case OP_POW: return node->number != rint(node->number) || is_always_positive(node->a);
    case OP_SQR: return is_always_positive(node->a);
    case OP_MUL:
    case OP_DIV: return is_always_positive(node->a) && is_always_positive(node->b);
    case OP_CONST: return node->number > 0;
    case OP_LINEAR: {
        bool positive = node->number >= 0 && node->count > 0;
        for (int i = 0; i < node->count; i++)
            positive &= node->terms[i].coefficient > 0 && is_always_positive(node->terms[i].node);
        return positive;
    }
    default: return false;
    }
}

/* Returns g as a jet whose evaluation fails with TVI_EDOMAIN at states where g is not positive. */
static jet require_positive_scale(jet g)
{
    if (!g.node) return g.number > 0 ? g : jet_make_poison(isnan(g.number) ? JET_NOT_FINITE : JET_NOT_POSITIVE);
    return jet_is_poison(g) || is_always_positive(g.node) ? g : jet_sqr(jet_sqrt(g));
}

/* ---- The systems ------------------------------------------------------------------------------------------------- */

/* Records the user's g. Its q and p are those of the user's system, without t and e. */
static jet record_user_time_scale(const rescaling_request *request, const jet q[], const jet p[])
{
    const int n = request->base->n;
    jet *user_q = tvi_copy_with_poison_beyond_end(n, q, JET_BEYOND_Q);
    jet *user_p = tvi_copy_with_poison_beyond_end(n, p, JET_BEYOND_P);
    const jet g =
        user_q && user_p ? request->time_scale(user_q, user_p, q[n], request->ctx) : jet_make_poison(JET_NO_MEMORY);
    free(user_q);
    free(user_p);
    return g;
}

/* Records the two factors of K: factor = {g, H + e}. */
static void record_factors_of_K(const jet q[], const jet p[], jet s, void *ctx, jet factor[2])
{
    const rescaling_request *request = ctx;
    const int n = request->base->n;
    (void)s;
    const jet H = tvi_record_user_hamiltonian(q, p, q[n], (void *)request->base);
    const jet g =
        request->time_scale ? record_user_time_scale(request, q, p) : tvi_record_automatic_time_scale(request->base, H);
    factor[0] = require_positive_scale(g);
    factor[1] = jet_add(H, p[n]);
}

tvi_status tvi_system_rescaled(tvi_system **out, const tvi_system *system, tvi_rescale_fn *g, void *ctx)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    const char *const unsupported = !system->energy ? "a force has no Hamiltonian: state the potential"
                                    : system->is_driven
                                        ? "a driven system has no Hamiltonian flow: take fixed steps, or a tolerance"
                                    : system->form == TVI_LAGRANGIAN ? "state the Hamiltonian instead of the Lagrangian"
                                    : system->stepped_system != system ? "the system is rescaled already"
                                                                       : NULL;
    if (unsupported) return jet_refuse(TVI_EUNSUPPORTED, "%s", unsupported);
    rescaling_request request = {system, g, ctx};
    tvi_system *stepped, *rescaled;
    tvi_status status = tvi_system_create_from_factors(&stepped, system->n + 1, record_factors_of_K, &request);
    if (status == TVI_EDOMAIN && !g)
        return jet_refuse(status, "K = g (H + e): the automatic g has no value (give a g of your own): %s",
                          jet_last_refusal_text());
    if (status != TVI_OK) return jet_refuse(status, "K = g (H + e): %s", jet_last_refusal_text());
    stepped->is_regular = false; /* K_ee = 0 */
    stepped->has_automatic_scale = !g;
    stepped->has_tail_shares_without_momenta = system->has_masses;
    status = tvi_system_hamiltonian(&rescaled, system->n, tvi_record_user_hamiltonian, (void *)system);
    if (status != TVI_OK) {
        tvi_system_free(stepped);
        return status;
    }
    rescaled->stepped_system = stepped;
    *out = rescaled;
    return TVI_OK;
}
