/* closure.c - what generating functions share: see closure.h. */
#include "generating/closure.h"

#include <math.h>
#include <string.h>

tvi_status tvi_close_half(tvi_closure *closure, const tvi_combination *combination, tvi_half half)
{
    return closure->solver->solve(closure, &(tvi_transposed){combination, NULL, half});
}

tvi_status tvi_close_full(tvi_closure *closure, const tvi_combination *first, const tvi_combination *second)
{
    return closure->solver->solve(closure, &(tvi_transposed){first, second, TVI_FIRST});
}

tvi_status tvi_close_mean(tvi_closure *c)
{
    const tvi_mean_closing *of = c->mean;
    const tvi_status status = tvi_close_full(c, &c->q_mean, of->has_momenta ? &c->u_mean : &c->q_rise);
    if (status != TVI_OK) return status;
    for (int i = 0; i < c->n; i++) {
        const double x = c->D[i], y = c->D[c->n + i], of_q = c->curve.kappa[i] * y;
        c->from_q[i] = of->from_q * of_q;
        c->rise_q[i] = of->rise_q * of_q;
        c->from_p[i] = of->from_p[0] * x + of->from_p[1] * y;
        c->rise_p[i] = of->rise_p[0] * x + of->rise_p[1] * y;
    }
    return TVI_OK;
}

void tvi_close_measure(tvi_closure *closure)
{
    double weight[TVI_MAX_DEGREE + 2];
    for (int k = 0; k <= closure->curve.top; k++) weight[k] = k <= closure->p_degree;
    tvi_curve_sum_sizes(&closure->curve, true, weight, closure->p_size);
    for (int i = 0; i < closure->n; i++) closure->p_size[i] /= fabs(closure->curve.kappa[i]);
}
