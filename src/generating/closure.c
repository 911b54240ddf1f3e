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

void tvi_close_measure(tvi_closure *closure)
{
    double weight[TVI_MAX_DEGREE + 2];
    for (int k = 0; k <= closure->curve.top; k++) weight[k] = k <= closure->p_degree;
    tvi_curve_sum_sizes(&closure->curve, true, weight, closure->p_size);
    for (int i = 0; i < closure->n; i++) closure->p_size[i] /= fabs(closure->curve.kappa[i]);
}
