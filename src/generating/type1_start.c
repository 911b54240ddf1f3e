/* type1_start.c - type I, Ld(q0, q1), expanded at the start (docs/method.md section 4): q- = q0, q1 = q+,
 * p0 = p- + d0, p1 = p+ + d1 with G+^T d1 - G-^T d0 = D_z. */
#include "generating/closure.h"
#include "method/list.h"

/* z = (q0, v), G- = (I, 0), G+ = (A, B):  B^T d1 = D_v,  d1 - d0 = D_q - (A - I)^T d1. */
static tvi_status close_type1_start(tvi_closure *c)
{
    const int n = c->n;
    double *rise = c->D, *d1 = c->D + n;
    const tvi_status status = tvi_close_half(c, &c->q_rise, TVI_SECOND);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) d1[i] -= rise[i]; /* d0 */
    tvi_close_momenta(c, d1, rise);
    return TVI_OK;
}

const tvi_descriptor tvi_type1_start = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_START,
    .title = "type I, start",
    .nodes = {[TVI_NODES_ON_CURVE] = {"start", 2, 0}, [TVI_NODES_TRUNCATED] = {"tvi", 1, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_DEGREE,
    .serves = &tvi_serves_type1,
    .adjoint = &tvi_type1_end,
    .quadrature = TVI_ANY_QUADRATURE,
    .pairs_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.span = {0, 1, 1}, .action = TVI_ACTION_LAGRANGE, .close = close_type1_start},
};
