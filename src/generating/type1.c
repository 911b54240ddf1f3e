/* type1.c - what the expansions of the type I generating function share (docs/method.md section 4): the curve joins q0
 * to q1, and the momenta at its ends get d0 and d1 with
 *     G+^T d1 - G-^T d0 = D_z.                                                                          (I-defect) */
#include "generating/closure.h"

/* D = (d1 - d0, (to d1 - from d0)/(to - from)): d0 and their difference. */
static void set_momenta(tvi_closure *c)
{
    const double part = c->span.to / (c->span.to - c->span.from);
    const double *rise = c->D, *mean = c->D + c->n;
    for (int i = 0; i < c->n; i++) {
        c->from_q[i] = c->rise_q[i] = 0;
        c->from_p[i] = mean[i] - part * rise[i];
        c->rise_p[i] = rise[i];
    }
}

/* At an end, z = (q0, v) or (q1, v), the Jacobians there and at the other one are (I, 0) and (A, B), and R = G+ - G- is
 * (A - I, B) or (I - A, -B): with the other end's d,  R_v^T d = D_v,  d1 - d0 = D_q - R_q^T d. */
tvi_status tvi_close_type1_end(tvi_closure *c)
{
    const tvi_status status = tvi_close_half(c, &c->q_rise, TVI_SECOND);
    if (status == TVI_OK) set_momenta(c);
    return status;
}

/* With the mean M of G- and G+ that has no Q_1 in it, and R = G+ - G-, the matrix is I + O(h):
 *     M^T (d1 - d0) + R^T (to d1 - from d0)/(to - from) = D_z. */
tvi_status tvi_close_type1(tvi_closure *c)
{
    const tvi_status status = tvi_close_full(c, &c->q_mean, &c->q_rise);
    if (status == TVI_OK) set_momenta(c);
    return status;
}
