/* poincare.c - the Poincare generating function of the mean of the ends (docs/method.md section 4):
 *     (dzbar/dz)^T (a, b) = D_z,   z0 = (q- + b/2, p- - a/2),   z1 = (q+ - b/2, p+ + a/2),   zbar the mean of the
 * curve's ends. */
#include "generating/closure.h"

tvi_status tvi_close_poincare(tvi_closure *c)
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
