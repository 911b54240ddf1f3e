/* rescaled.c - a system in another time, dt = g ds, as the Hamiltonian K(q, t, p, e) = g(q, p, t) (H(q, p, t) + e) in
 * n + 1 coordinates: with e = -H at the start, K is 0 on the orbit, and
 *     dq/ds = g H_p + (H+e) g_p,  dt/ds = g,  dp/ds = -g H_q - (H+e) g_q,  de/ds = -g H_t - (H+e) g_t.
 * Equal steps in s are symplectic in (q, t, p, e). K is recorded from the recording of the system, and so is H. */
#include "system/system.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
    const tvi_system *base;
    tvi_rescale_fn *g; /* NULL: automatic */
    void *ctx;
} rescaling;

/* ---- The time scale ---------------------------------------------------------------------------------------------- */

/* sum_ij a_ij a_ji, a [n][n]; terms [n][n] is scratch. */
static jet trace_of_square(int n, const jet a[], jet terms[])
{
    int count = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) terms[count++] = jet_mul(i == j ? 1 : 2, jet_mul(a[i * n + j], a[j * n + i]));
    return jet_sum(terms, count);
}

/* row[i] = d x / d z_i of K's recording, whose inputs are q, t, p, e: z = q, and p where all 2 n are asked for. */
static bool gradient(jet_graph *graph, jet x, int n, int count, jet all[], jet row[])
{
    const bool derived = jet_gradient(graph, x, 2 * n + 1, all);
    for (int i = 0; i < count; i++) row[i] = all[i < n ? i : i + 1];
    return derived;
}

/* a = H'', [count][count], with count = n: V_qq. */
static bool second_derivatives(jet H, int n, int count, jet first[], jet all[], jet a[])
{
    jet_graph *graph;
    if (jet_graph_of(1, &H, &graph).node || !graph) return false;
    bool derived = gradient(graph, H, n, count, all, first);
    for (int i = 0; i < count && derived; i++) derived = gradient(graph, first[i], n, count, all, a + i * count);
    return derived;
}

/* tr (M^-1 V_qq)^2 = sum_ij V_ij^2 / (m_i m_j), V_qq = a. */
static jet trace_of_forces(int n, const double mass[], const jet a[], jet terms[])
{
    int count = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++)
            terms[count++] = jet_mul((i == j ? 1 : 2) / (mass[i] * mass[j]), jet_sqr(a[i * n + j]));
    return jet_sum(terms, count);
}

/* square = (J a)^2, J a = (a_pq, a_pp; -a_qq, -a_qp), [2n][2n]. */
static void square_of_field(int n, const jet a[], jet Ja[], jet square[])
{
    const int m = 2 * n;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) Ja[i * m + j] = i < n ? a[(n + i) * m + j] : jet_neg(a[(i - n) * m + j]);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) {
            jet sum = jet_const(0);
            for (int k = 0; k < m; k++) sum = jet_add(sum, jet_mul(Ja[i * m + k], Ja[k * m + j]));
            square[i * m + j] = sum;
        }
}

/* The sum of the fourth powers of the local frequencies to the -1/4. */
static jet automatic(const tvi_system *base, jet H)
{
    const bool separable = base->form == TVI_SEPARABLE;
    const int n = base->n, count = separable ? n : 2 * n;
    jet_graph *graph = NULL;
    (void)jet_graph_of(1, &H, &graph);
    const size_t elements = (size_t)count * (size_t)count;
    jet *a = malloc((3 * elements + (size_t)count + 2 * (size_t)n + 1) * sizeof *a), sum = jet_poison(JET_NO_MEMORY);
    if (!a) return sum;
    jet *Ja = a + elements, *square = Ja + elements, *first = square + elements, *all = first + count;
    if (!H.node || jet_is_poison(H)) sum = H.node ? H : jet_const(0);
    else if (second_derivatives(H, n, count, first, all, a)) {
        if (!separable) square_of_field(n, a, Ja, square);
        sum = separable ? trace_of_forces(n, base->mass, a, Ja) : jet_div(trace_of_square(count, square, Ja), 2);
    }
    free(a);
    if (graph) jet_graph_name_part(graph, sum, "the automatic g");
    return jet_pow(sum, -0.25);
}

/* Whether it is positive wherever it has a value: by its last operations. */
static bool is_positive(const struct jet_node *z)
{
    switch (z->op) {
    case OP_EXP:
    case OP_COSH:
    case OP_SQRT:
    case OP_HYPOT: return true;
    case OP_POW: return z->number != rint(z->number) || is_positive(z->a);
    case OP_SQR: return is_positive(z->a);
    case OP_MUL:
    case OP_DIV: return is_positive(z->a) && is_positive(z->b);
    case OP_CONST: return z->number > 0; /* a parameter may become negative */
    case OP_LINEAR: {
        bool positive = z->number >= 0 && z->count > 0;
        for (int i = 0; i < z->count; i++) positive &= z->terms[i].coefficient > 0 && is_positive(z->terms[i].node);
        return positive;
    }
    default: return false;
    }
}

/* g, with TVI_EDOMAIN where it is not positive. */
static jet positive(jet g)
{
    if (!g.node) return g.number > 0 ? g : jet_poison(isnan(g.number) ? JET_NOT_FINITE : JET_NOT_POSITIVE);
    return jet_is_poison(g) || is_positive(g.node) ? g : jet_sqr(jet_sqrt(g));
}

/* ---- The systems ------------------------------------------------------------------------------------------------- */

/* factor = {g, H + e}. */
static void transform(const jet q[], const jet p[], jet s, void *ctx, jet factor[2])
{
    const rescaling *r = ctx;
    const int n = r->base->n;
    (void)s;
    const jet H = tvi_stated_hamiltonian(q, p, q[n], (void *)r->base);
    const jet g = r->g ? r->g(q, p, q[n], r->ctx) : automatic(r->base, H);
    factor[0] = positive(g);
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
    rescaling r = {system, g, ctx};
    tvi_system *stepped, *rescaled;
    tvi_status status = tvi_system_product(&stepped, system->n + 1, transform, &r);
    if (status != TVI_OK) return jet_refuse(status, "K = g (H + e): %s", jet_refusal());
    stepped->regular = false; /* K_ee = 0 */
    status = tvi_system_hamiltonian(&rescaled, system->n, tvi_stated_hamiltonian, (void *)system);
    if (status != TVI_OK) {
        tvi_system_free(stepped);
        return status;
    }
    rescaled->stepped = stepped;
    *out = rescaled;
    return TVI_OK;
}
