/* poincare.c - the Poincare generating function of the mean of the ends (docs/method.md section 4):
 *     (dzbar/dz)^T (a, b) = D_z,   z0 = (q- + b/2, p- - a/2),   z1 = (q+ - b/2, p+ + a/2),   zbar the mean of the
 * curve's ends. */
#include "generating/closure.h"
#include "method/list.h"

static tvi_status close_poincare(tvi_closure *c)
{
    const tvi_status status = tvi_close_full(c, &c->q_mean, &c->u_mean);
    if (status != TVI_OK) return status;
    const double *a = c->D, *b = c->D + c->n; /* b / kappa */
    for (int i = 0; i < c->n; i++) {
        c->rise_q[i] = -c->curve.kappa[i] * b[i];
        c->from_q[i] = -c->rise_q[i] / 2;
        c->rise_p[i] = a[i];
        c->from_p[i] = -a[i] / 2;
    }
    return TVI_OK;
}

const tvi_descriptor tvi_poincare = {
    .method = TVI_POINCARE,
    .expansion = TVI_AT_MIDPOINT,
    .title = "Poincare, midpoint",
    .nodes = {[TVI_NODES_ON_CURVE] = {"poincare", 2, 2}},
    .least_degree = 0,
    .most_degree = TVI_MAX_DEGREE,
    .serves = &tvi_serves_hamilton,
    .adjoint = &tvi_poincare,
    .quadrature = TVI_ANY_QUADRATURE,
    .pairs_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.span = {-1, 1, 0.5}, .action = TVI_ACTION_HAMILTON, .has_top_momentum = true, .close = close_poincare},
};
