/* type1.c - the type I generating function Ld(q0, q1) (docs/method.md section 4): q- = q0, q1 = q+, and the momenta
 * p0 = p- + d0, p1 = p+ + d1 with
 *     G+^T d1 - G-^T d0 = D_z.                                                                          (I-defect) */
#include "generating/closure.h"

/* p0 = p- + d0 and p1 - p0 = (p+ - p-) + rise; the curve joins q0 to q1. */
static void set_momenta(tvi_closure *c, const double d0[], const double rise[])
{
    for (int i = 0; i < c->n; i++) {
        c->from_q[i] = c->rise_q[i] = 0;
        c->from_p[i] = d0[i];
        c->rise_p[i] = rise[i];
    }
}

/* z = (q0, v), G- = (I, 0), G+ = (A, B):  B^T d1 = D_v,  d1 - d0 = D_q - (A - I)^T d1. */
tvi_status tvi_close_type1_start(tvi_closure *c)
{
    const int n = c->n;
    double *rise = c->D, *d1 = c->D + n;
    const tvi_status status = tvi_close_half(c, &c->q_rise, TVI_SECOND);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) d1[i] -= rise[i]; /* d0 */
    set_momenta(c, d1, rise);
    return TVI_OK;
}

/* z = (q1, v), G- = (A, B), G+ = (I, 0):  -B^T d0 = D_v,  d1 - d0 = D_q + (A - I)^T d0. */
tvi_status tvi_close_type1_end(tvi_closure *c)
{
    double *rise = c->D, *d0 = c->D + c->n;
    const tvi_status status = tvi_close_half(c, &c->q_rise, TVI_SECOND); /* q_rise has -B */
    if (status != TVI_OK) return status;
    set_momenta(c, d0, rise);
    return TVI_OK;
}

/* In the mean and half the difference of the ends the matrix is I + O(h):
 *     ((G+ + G-)/2)^T (d1 - d0) + (G+ - G-)^T (d1 + d0)/2 = D_z. */
tvi_status tvi_close_type1_midpoint(tvi_closure *c)
{
    const tvi_status status = tvi_close_full(c, &c->q_mean, &c->q_rise);
    if (status != TVI_OK) return status;
    double *rise = c->D, *mean = c->D + c->n;
    for (int i = 0; i < c->n; i++) mean[i] -= rise[i] / 2; /* d0 */
    set_momenta(c, mean, rise);
    return TVI_OK;
}
