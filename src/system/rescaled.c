/* rescaled.c - Creates a system in another time, dt = g ds, as the Hamiltonian K(q, t, p, e) = g(q, p, t) (H(q, p, t) +
 * e) in n + 1 coordinates. With e = -H at the start, K is 0 on the orbit, and
 *     dq/ds = g H_p + (H+e) g_p,  dt/ds = g,  dp/ds = -g H_q - (H+e) g_q,  de/ds = -g H_t - (H+e) g_t.
 * Equal steps in s are symplectic in (q, t, p, e). K and H are recorded from the recording of the system. */
#include "system/system.h"
#include "system/automatic.h"
#include "system/refuse.h"

#include <math.h>

typedef struct {
    const tvi_system *base;
    tvi_rescale_fn *g; /* NULL: automatic */
    void *ctx;
} rescaling;

/* ---- The time scale ---------------------------------------------------------------------------------------------- */

/* Tells whether the value is positive wherever it exists, by its last operations. */
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

/* Returns g, with TVI_EDOMAIN at states where g is not positive. */
static jet positive(jet g)
{
    if (!g.node) return g.number > 0 ? g : jet_poison(isnan(g.number) ? JET_NOT_FINITE : JET_NOT_POSITIVE);
    return jet_is_poison(g) || is_positive(g.node) ? g : jet_sqr(jet_sqrt(g));
}

/* ---- The systems ------------------------------------------------------------------------------------------------- */

/* Records factor = {g, H + e}. */
static void transform(const jet q[], const jet p[], jet s, void *ctx, jet factor[2])
{
    const rescaling *r = ctx;
    const int n = r->base->n;
    (void)s;
    const jet H = tvi_stated_hamiltonian(q, p, q[n], (void *)r->base);
    const jet g = r->g ? r->g(q, p, q[n], r->ctx) : tvi_automatic_scale(r->base, H);
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
    tvi_status status = tvi_system_create_rescaled(&stepped, system->n + 1, transform, &r);
    if (status == TVI_EDOMAIN && !g)
        return jet_refuse(status, "K = g (H + e): the automatic g has no value (give a g of your own): %s",
                          jet_refusal());
    if (status != TVI_OK) return jet_refuse(status, "K = g (H + e): %s", jet_refusal());
    stepped->regular = false; /* K_ee = 0 */
    stepped->is_automatic = !g;
    stepped->compares_movements = system->has_masses;
    tvi_system_split_time(stepped);
    status = tvi_system_hamiltonian(&rescaled, system->n, tvi_stated_hamiltonian, (void *)system);
    if (status != TVI_OK) {
        tvi_system_free(stepped);
        return status;
    }
    rescaled->stepped = stepped;
    *out = rescaled;
    return TVI_OK;
}
