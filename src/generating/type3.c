/* type3.c - the type III generating function Hd-(q1, p0), the left discrete Hamiltonian (docs/method.md section 4). */
#include "generating/closure.h"

/* z = (w, p0), q1 = q+:  (q+_w)^T d = D_w,  p1 = p+ + d,  q0 = w + D_p - (q+_p)^T d. */
tvi_status tvi_close_type3_start(tvi_closure *c)
{
    const int n = c->n;
    double *d = c->D, *from_u = c->D + n;
    const tvi_status status = tvi_close_half(c, &c->q_to, TVI_FIRST);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        c->from_q[i] = c->curve.kappa[i] * from_u[i];
        c->from_p[i] = 0;
        c->rise_q[i] = -c->from_q[i];
        c->rise_p[i] = d[i];
    }
    return TVI_OK;
}

/* z = (q1, w), p- = p0:  (p-_w)^T l = D_w,  q0 = q- + l,  p1 = w + D_q - (p-_q)^T l. */
tvi_status tvi_close_type3_end(tvi_closure *c)
{
    const int n = c->n;
    double *rise_p = c->D, *l = c->D + n;
    const tvi_status status = tvi_close_half(c, &c->u_from, TVI_SECOND);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        c->from_q[i] = c->curve.kappa[i] * l[i];
        c->from_p[i] = 0;
        c->rise_q[i] = -c->from_q[i];
        c->rise_p[i] = rise_p[i];
    }
    return TVI_OK;
}
