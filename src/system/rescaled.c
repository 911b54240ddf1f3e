/* rescaled.c - Creates a system in a rescaled time s, dt = g ds, whose steps adapt and stay symplectic
 * (docs/adaptive.md). It has the n + 1 coordinates (q, t) with the momenta (p, e), and the Hamiltonian K(q, t, p, e) =
 * g(q, p, t) (H(q, p, t) + e). With e = -H at the start, K is 0 on the orbit, and
 *     dq/ds = g H_p + (H+e) g_p,  dt/ds = g,  dp/ds = -g H_q - (H+e) g_q,  de/ds = -g H_t - (H+e) g_t.
 * Equal steps in s are symplectic in (q, t, p, e). K and H are recorded by a walk through the recording of the user's
 * system.
 *
 * The reversible form has no K, and needs no H: dq/ds = g dq/dt, dp/ds = g dp/dt, dt/ds = g. Steps of a symmetric
 * method in it keep what is reversible, of any system and any masses.
 *
 * The file also records the user's V, L or H once more in another graph, for rescaled and for driven systems. */
#include "system/system.h"
#include "system/refuse.h"
#include "tvi_bodies.h"

#include <math.h>
#include <stdlib.h>

/* ---- The user's function ----------------------------------------------------------------------------------------- */

/* Records the V, L or H of the user's system. */
static jet record_user_function(const tvi_system *base, const jet q[], const jet velocities_or_momenta[], jet t)
{
    jet value;
    return tvi_system_record_again(base, q, velocities_or_momenta, t, 1, &base->record.user_function, &value)
               ? value
               : jet_make_poison(JET_NO_MEMORY);
}

/* Records H. For a separable system H is sum p_i^2 / (2 m_i) + V, and V is the user's function at p = 0 or v = 0, up to
 * its sign (energy.sign). */
jet tvi_record_user_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    const tvi_system *base = ctx;
    if (base->form == TVI_HAMILTONIAN) return record_user_function(base, q, p, t);
    jet *terms = malloc(((size_t)base->n + 1) * sizeof *terms);
    if (!terms) return jet_make_poison(JET_NO_MEMORY);
    terms[0] = jet_mul(base->energy.sign, record_user_function(base, q, NULL, t));
    for (int i = 0; i < base->n; i++) terms[1 + i] = jet_div(jet_sqr(p[i]), 2 * base->mass[i]);
    const jet H = jet_sum(terms, base->n + 1);
    free(terms);
    return H;
}

jet tvi_record_user_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return record_user_function(ctx, q, v, t);
}

/* What to take where there is no K, by its names in C and Python. */
#define THE_REVERSIBLE_FORM "the reversible form, tvi_system_rescaled_reversible (rescaled(g, reversible=True))"

#define THE_CONSTRAINED "a constrained system is not rescaled: take fixed steps"

/* The request to rescale a system by the time scale g = dt/ds. */
typedef struct {
    const tvi_system *base;
    tvi_rescale_fn *time_scale; /* The user's time scale g; NULL: it is automatic. */
    void *ctx;
    int light_coordinate; /* A coordinate that is too light for K (find_light_coordinate), or -1. */
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

/* Records the user's or the automatic g; the user's may be not positive. */
static jet record_time_scale(const rescaling_request *request, const jet q[], const jet p[])
{
    if (request->time_scale) return record_user_time_scale(request, q, p);
    const int n = request->base->n;
    const jet H = tvi_record_user_hamiltonian(q, p, q[n], (void *)request->base);
    return tvi_record_automatic_time_scale(request->base, H);
}

/* Finds a coordinate whose mass is at most LIGHTEST_MASS of the largest, and on which or on whose momentum g depends. K
 * pushes it by (H + e) g_q / m and (H + e) g_p, where H + e is the truncation error of the heavy ones at the nodes: no
 * step is right that is not as accurate as the light one is light. *light stays as it is if there is none. The inputs
 * of the graph are the coordinates and the time, and then their momenta. Returns whether there was memory. */
static bool find_light_coordinate(const tvi_system *base, jet g, int *light)
{
    static const double LIGHTEST_MASS = 1e-8;
    const int n = base->n, inputs = 2 * (n + 1);
    jet_graph *graph;
    double largest = 0;
    if (!base->has_masses || !g.node || jet_find_common_graph_or_poison(1, &g, &graph).node) return true;
    bool *used = calloc((size_t)inputs, sizeof *used);
    const bool found = used && tvi_system_find_used_inputs(graph, inputs, 1, &g, used) == TVI_OK;
    for (int i = 0; i < n; i++) largest = fmax(largest, base->mass[i]);
    for (int i = 0; i < n && found; i++)
        if ((used[i] || used[n + 1 + i]) && base->mass[i] <= LIGHTEST_MASS * largest) *light = i;
    free(used);
    return found;
}

/* Records the two factors of K: factor = {g, H + e}. */
static void record_factors_of_K(const jet q[], const jet p[], jet s, void *ctx, jet factor[2])
{
    rescaling_request *request = ctx;
    const int n = request->base->n;
    (void)s;
    const jet H = tvi_record_user_hamiltonian(q, p, q[n], (void *)request->base), g = record_time_scale(request, q, p);
    const bool found = find_light_coordinate(request->base, g, &request->light_coordinate);
    factor[0] = found ? require_positive_scale(g) : jet_make_poison(JET_NO_MEMORY);
    factor[1] = jet_add(H, p[n]);
}

/* Records the velocities of a system whose momenta are p = M v + f(q, t): v = M^-1 (p - f), where f is L_v at v = 0.
 * The scratch array `field` has 2n jets. */
static bool record_velocities_of_masses(const tvi_system *base, const jet q[], const jet p[], jet t, jet field[],
                                        jet v[])
{
    const int n = base->n;
    const bool recorded =
        base->form == TVI_SEPARABLE || tvi_system_record_again(base, q, NULL, t, 2 * n, base->record.field, field);
    for (int i = 0; i < n && recorded; i++) {
        const jet f = base->form == TVI_SEPARABLE ? jet_const(0) : field[n + i];
        v[i] = jet_div(jet_sub(p[i], f), base->mass[i]);
    }
    return recorded;
}

/* Tells whether the momenta of a Lagrangian are not M v + f(q, t) with a diagonal constant M. */
static bool has_coupled_velocities(const tvi_system *system)
{
    return system->form == TVI_LAGRANGIAN && !system->has_masses;
}

/* [degrees of freedom] The largest L_vv that is recorded: its factors have n^3 / 6 products. */
enum { MOST_COUPLED_VELOCITIES = 8 };

/* Tells whether each momentum L_v of a Lagrangian is a polynomial of degree 1 in the velocities, as far as the
 * operations that compute it show: sums, and products and quotients with what does not depend on them. Nodes of the
 * degree 2 have this degree or another dependence. */
static bool are_momenta_linear(const tvi_system *base)
{
    const jet_graph *graph = base->record.graph;
    const int n = base->n;
    bool are_linear = true;
    for (int i = 0; i < jet_graph_node_count(graph); i++) {
        struct jet_node *z = jet_graph_node_at(graph, i);
        const int a = z->a ? z->a->scratch : 0, b = z->b ? z->b->scratch : 0;
        int degree = z->op == OP_INPUT ? i >= n && i < 2 * n
                     : z->op == OP_MUL ? a + b
                     : z->op == OP_DIV ? a + 2 * b
                                       : 2 * (a + b);
        for (int k = 0; k < z->count; k++) {
            const int of_term = z->terms[k].node->scratch;
            degree = degree > of_term ? degree : of_term;
        }
        if (z->op != OP_LINEAR && z->count > 0) degree *= 2;
        z->scratch = degree < 2 ? degree : 2;
    }
    for (int i = n; i < 2 * n; i++)
        are_linear &= !base->record.field[i].node || base->record.field[i].node->scratch < 2;
    return are_linear;
}

/* Solves A x = b with a symmetric A [n][n], by A = L D L^T, where row i of A becomes (L_i0, ..., D_i). x is in the
 * place of b. */
static void record_symmetric_solution(int n, jet *A, jet *x)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < i; j++) { /* L_ij D_j, and then L_ij */
            for (int k = 0; k < j; k++)
                A[i * n + j] = jet_sub(A[i * n + j], jet_mul(A[i * n + k], jet_mul(A[j * n + k], A[k * n + k])));
            A[i * n + j] = jet_div(A[i * n + j], A[j * n + j]);
        }
        for (int k = 0; k < i; k++) {
            A[i * n + i] = jet_sub(A[i * n + i], jet_mul(jet_sqr(A[i * n + k]), A[k * n + k]));
            x[i] = jet_sub(x[i], jet_mul(A[i * n + k], x[k]));
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        x[i] = jet_div(x[i], A[i * n + i]);
        for (int k = i + 1; k < n; k++) x[i] = jet_sub(x[i], jet_mul(A[k * n + i], x[k]));
    }
}

/* Records the velocities of a Lagrangian whose momenta are p = L_vv(q, t) v + f(q, t). Column j of L_vv is L_v - f at
 * the unit vector j. The scratch array `field` has 2n jets. */
static bool record_coupled_velocities(const tvi_system *base, const jet q[], const jet p[], jet t, jet field[], jet v[])
{
    const int n = base->n;
    jet A[MOST_COUPLED_VELOCITIES * MOST_COUPLED_VELOCITIES], unit[MOST_COUPLED_VELOCITIES], f[MOST_COUPLED_VELOCITIES];
    bool recorded = tvi_system_record_again(base, q, NULL, t, 2 * n, base->record.field, field);
    for (int i = 0; i < n && recorded; i++) f[i] = field[n + i];
    for (int j = 0; j < n && recorded; j++) {
        for (int i = 0; i < n; i++) unit[i] = jet_const(i == j);
        recorded = tvi_system_record_again(base, q, unit, t, 2 * n, base->record.field, field);
        for (int i = 0; i < n && recorded; i++) A[i * n + j] = jet_sub(field[n + i], f[i]);
    }
    for (int i = 0; i < n && recorded; i++) v[i] = jet_sub(p[i], f[i]);
    if (recorded) record_symmetric_solution(n, A, v);
    return recorded;
}

/* Records q' and p' of the user's system: rate [2n]. Returns whether there was memory. */
static bool record_user_rates(const tvi_system *base, const jet q[], const jet p[], jet t, jet rate[])
{
    const int n = base->n, outputs = tvi_system_output_count(base);
    const bool is_hamiltonian = base->form == TVI_HAMILTONIAN;
    jet *field = malloc(3 * (size_t)n * sizeof *field), *v = field + 2 * n;
    if (!field) return false;
    bool recorded =
        is_hamiltonian || (has_coupled_velocities(base) ? record_coupled_velocities(base, q, p, t, field, v)
                                                        : record_velocities_of_masses(base, q, p, t, field, v));
    if (recorded)
        recorded = tvi_system_record_again(base, q, is_hamiltonian ? p : v, t, outputs, base->record.field, field);
    for (int i = 0; i < n && recorded; i++) {
        rate[i] = is_hamiltonian ? field[n + i] : v[i];
        rate[n + i] = is_hamiltonian ? jet_neg(field[i]) : field[i];
    }
    free(field);
    return recorded;
}

/* Records the rates by s of the reversible form: dq/ds = g q', dp/ds = g p', dt/ds = g. The momentum of t is 0. */
static void record_rates_by_s(const jet q[], const jet p[], jet s, void *ctx, jet rate[])
{
    const rescaling_request *request = ctx;
    const int n = request->base->n;
    const jet g = require_positive_scale(record_time_scale(request, q, p));
    (void)s;
    jet *user_rate = malloc(2 * (size_t)n * sizeof *user_rate);
    const bool recorded = user_rate && record_user_rates(request->base, q, p, q[n], user_rate);
    for (int i = 0; i < n; i++) {
        rate[i] = recorded ? jet_mul(g, user_rate[i]) : jet_make_poison(JET_NO_MEMORY);
        rate[n + 1 + i] = recorded ? jet_mul(g, user_rate[n + i]) : jet_make_poison(JET_NO_MEMORY);
    }
    rate[n] = g;
    rate[2 * n + 1] = jet_const(0);
    free(user_rate);
}

/* Completes a rescaled system: the user's system once more, with the system in which steps are made. */
static tvi_status finish_rescaled(tvi_system **out, const tvi_system *system, tvi_system *stepped, bool is_automatic)
{
    stepped->is_regular = false; /* K_ee = 0 */
    stepped->tail.has_automatic_scale = is_automatic;
    stepped->tail.has_shares_without_momenta = system->has_masses;
    stepped->axes = system->axes;
    const tvi_status status = tvi_system_copy(out, system);
    if (status == TVI_OK) (*out)->stepped_system = stepped;
    else tvi_system_free(stepped);
    return status;
}

/* Tells whether one of the bodies has no mass. */
static bool has_test_particle(const tvi_bodies *b)
{
    for (int i = 0; tvi_bodies_check(b) == TVI_OK && i < b->bodies; i++)
        if (b->mass[i] == 0) return true;
    return false;
}

tvi_status tvi_system_rescaled(tvi_system **out, const tvi_system *system, tvi_rescale_fn *g, void *ctx)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    const char *const unsupported =
        system->stepped_system != system ? "the system is rescaled already"
        : system->constraints            ? THE_CONSTRAINED
        : system->record.is_tangent      ? "a tangent system is not rescaled"
        : !system->energy.tape ? "a force has no Hamiltonian: state the potential, or take " THE_REVERSIBLE_FORM
        : system->is_driven
            ? "a driven system has no Hamiltonian flow: take fixed steps, or a tolerance, or " THE_REVERSIBLE_FORM
        : system->form == TVI_LAGRANGIAN
            ? "state the Hamiltonian instead of the Lagrangian, or take " THE_REVERSIBLE_FORM
            : NULL;
    if (unsupported) return jet_refuse(TVI_EUNSUPPORTED, "%s", unsupported);
    if (g == tvi_bodies_scale && has_test_particle(ctx)) return tvi_system_rescaled_reversible(out, system, g, ctx);
    rescaling_request request = {system, g, ctx, -1};
    tvi_system *stepped;
    tvi_status status = tvi_system_create_from_factors(&stepped, system->n + 1, record_factors_of_K, &request);
    if (status == TVI_EDOMAIN && !g)
        return jet_refuse(status, "K = g (H + e): the automatic g has no value (give a g of your own): %s",
                          jet_last_refusal_text());
    if (status != TVI_OK) return jet_refuse(status, "K = g (H + e): %s", jet_last_refusal_text());
    if (request.light_coordinate >= 0) {
        tvi_system_free(stepped);
        return jet_refuse(TVI_EUNSUPPORTED,
                          "q[%d] has a mass of %g, too light for K = g (H + e): take " THE_REVERSIBLE_FORM,
                          request.light_coordinate, system->mass[request.light_coordinate]);
    }
    return finish_rescaled(out, system, stepped, !g);
}

tvi_status tvi_system_rescaled_reversible(tvi_system **out, const tvi_system *system, tvi_rescale_fn *g, void *ctx)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    const char *const unsupported =
        system->stepped_system != system ? "the system is rescaled already"
        : system->constraints            ? THE_CONSTRAINED
        : system->record.is_tangent      ? "a tangent system is not rescaled"
        : has_coupled_velocities(system) && (system->n > MOST_COUPLED_VELOCITIES || !are_momenta_linear(system))
            ? "the momenta are not linear in the velocities, or there are more than eight: "
              "state the Hamiltonian instead of the Lagrangian"
        : !g && (!system->energy.tape || system->form == TVI_LAGRANGIAN || system->is_driven)
            ? "the automatic g is for potentials and Hamiltonians: give a g of your own"
            : NULL;
    if (unsupported) return jet_refuse(TVI_EUNSUPPORTED, "%s", unsupported);
    rescaling_request request = {system, g, ctx, -1};
    tvi_system *stepped;
    const tvi_status status = tvi_system_create_from_rates(&stepped, system->n + 1, record_rates_by_s, &request);
    if (status != TVI_OK)
        return jet_refuse(status, "the reversible form%s: %s",
                          has_coupled_velocities(system) ? ", with v by L D L^T of L_vv" : "", jet_last_refusal_text());
    return finish_rescaled(out, system, stepped, !g);
}
