/* type2.c - the type II generating function Hd+(q0, p1), the right discrete Hamiltonian (docs/method.md section 4). */
#include "generating/closure.h"

/* z = (q0, w), p1 = p+:  (p+_w)^T l = -D_w,  q1 = q+ + l,  p0 = p- - D_q - (p+_q)^T l. With u = kappa p: l / kappa. */
tvi_status tvi_close_type2_start(tvi_closure *c)
{
    const int n = c->n;
    double *from_p = c->D, *minus_l = c->D + n;
    const tvi_status status = tvi_close_half(c, &c->u_to, TVI_SECOND);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        c->from_q[i] = 0;
        c->from_p[i] = -from_p[i];
        c->rise_q[i] = -c->curve.kappa[i] * minus_l[i];
        c->rise_p[i] = from_p[i];
    }
    return TVI_OK;
}

/* z = (w, p1), q- = q0, p1 = p+:  (q-_w)^T d0 = -D_w,  p0 = p- + d0,  q1 = w - D_p - (q-_p)^T d0. */
tvi_status tvi_close_type2_end(tvi_closure *c)
{
    const int n = c->n;
    double *minus_d0 = c->D, *rise_u = c->D + n;
    const tvi_status status = tvi_close_half(c, &c->q_from, TVI_FIRST);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        c->from_q[i] = 0;
        c->from_p[i] = -minus_d0[i];
        c->rise_q[i] = -c->curve.kappa[i] * rise_u[i];
        c->rise_p[i] = minus_d0[i];
    }
    return TVI_OK;
}
