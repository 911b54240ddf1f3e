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
    const int n = closure->n;
    memset(closure->p_size, 0, (size_t)n * sizeof *closure->p_size);
    for (int k = closure->p_degree; k >= 0; k--) {
        tvi_curve_momentum(&closure->curve, k, closure->P);
        for (int i = 0; i < n; i++) closure->p_size[i] += fabs(closure->P[i]);
    }
}
