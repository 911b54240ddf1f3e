/* type1_end.c - type I, Ld(q0, q1), expanded at the end (docs/method.md section 4): q- = q0, q1 = q+,
 * p0 = p- + d0, p1 = p+ + d1 with G+^T d1 - G-^T d0 = D_z. */
#include "generating/closure.h"
#include "method/list.h"

/* z = (q1, v), G- = (A, B), G+ = (I, 0):  -B^T d0 = D_v,  d1 - d0 = D_q + (A - I)^T d0. */
static tvi_status close_type1_end(tvi_closure *c)
{
    double *rise = c->D, *d0 = c->D + c->n;
    const tvi_status status = tvi_close_half(c, &c->q_rise, TVI_SECOND); /* q_rise has -B */
    if (status != TVI_OK) return status;
    tvi_close_momenta(c, d0, rise);
    return TVI_OK;
}

const tvi_descriptor tvi_type1_end = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_END,
    .title = "type I, end",
    .nodes = {[TVI_NODES_ON_CURVE] = {"end", 2, 0}, [TVI_NODES_TRUNCATED] = {NULL, 1, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_DEGREE,
    .serves = &tvi_serves_type1,
    .adjoint = &tvi_type1_start,
    .quadrature = TVI_ANY_QUADRATURE,
    .pairs_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.span = {-1, 0, 1}, .action = TVI_ACTION_LAGRANGE, .close = close_type1_end, .is_rough = true},
};
