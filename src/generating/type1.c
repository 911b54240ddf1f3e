/* type1.c - computes the corrections of the type I methods whose curve is expanded at the start or the end of the step
 * (docs/method.md section 4). The curve joins q0 to q1, and the momenta at its ends get d0 and d1 with
 *     G+^T d1 - G-^T d0 = D_z.                                                                          (I-defect) */
#include "generating/closure.h"

/* Computes the corrections with z = (q0, v) or (q1, v). The Jacobians of q are (I, 0) at this end, and (A, B) at the
 * other end; R = G+ - G- is (A - I, B) or (I - A, -B). With d the correction of the momentum at the other end,
 *     R_v^T d = D_v,   d1 - d0 = D_q - R_q^T d. */
tvi_status tvi_correct_type1_ends(tvi_closure *closure)
{
    const tvi_status status = tvi_solve_transposed_half(closure, &closure->q_rise, TVI_SECOND);
    const double part = closure->span.to / (closure->span.to - closure->span.from), *rise = closure->D,
                 *other = closure->D + closure->n;
    for (int i = 0; i < closure->n && status == TVI_OK; i++) {
        closure->from_q[i] = closure->rise_q[i] = 0;
        closure->from_p[i] = other[i] - part * rise[i];
        closure->rise_p[i] = rise[i];
    }
    return status;
}
