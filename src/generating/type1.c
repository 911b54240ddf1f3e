/* type1.c - what the expansions of the type I generating function share (docs/method.md section 4): the curve joins q0
 * to q1, and the momenta at its ends get d0 and d1 with
 *     G+^T d1 - G-^T d0 = D_z.                                                                          (I-defect) */
#include "generating/closure.h"

void tvi_close_momenta(tvi_closure *c, const double d0[], const double rise[])
{
    for (int i = 0; i < c->n; i++) {
        c->from_q[i] = c->rise_q[i] = 0;
        c->from_p[i] = d0[i];
        c->rise_p[i] = rise[i];
    }
}

/* With the mean M of G- and G+ that has no Q_1 in it, and R = G+ - G-, the matrix is I + O(h):
 *     M^T (d1 - d0) + R^T (to d1 - from d0)/(to - from) = D_z. */
tvi_status tvi_close_type1(tvi_closure *c)
{
    const tvi_status status = tvi_close_full(c, &c->q_mean, &c->q_rise);
    if (status != TVI_OK) return status;
    const double part = c->span.to / (c->span.to - c->span.from);
    double *rise = c->D, *mean = c->D + c->n;
    for (int i = 0; i < c->n; i++) mean[i] -= part * rise[i]; /* d0 */
    tvi_close_momenta(c, mean, rise);
    return TVI_OK;
}
