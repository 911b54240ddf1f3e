/* generating.c - the linear algebra that generating functions share. */
#include "generating.h"

#include <string.h>

static tvi_status factor_half(tvi_closure *closure, const tvi_combination *combination, tvi_half half)
{
    const size_t n = (size_t)closure->n;
    if (!closure->is_fresh) return TVI_OK;
    tvi_curve_sum_jacobian(&closure->curve, combination, closure->G);
    for (size_t i = 0; i < n; i++)
        memcpy(closure->half.lu + i * n, closure->G + i * 2 * n + (half == TVI_FIRST ? 0 : n), n * sizeof(double));
    return tvi_factor_compute(&closure->half);
}

tvi_status tvi_close_solve(tvi_closure *closure, const tvi_combination *combination, tvi_half half, double b[])
{
    const tvi_status status = factor_half(closure, combination, half);
    if (status == TVI_OK) tvi_factor_solve_transposed(&closure->half, b);
    return status;
}

void tvi_close_add(tvi_closure *closure, const tvi_combination *combination, tvi_half half, double factor,
                   const double x[], double out[])
{
    const size_t n = (size_t)closure->n;
    tvi_curve_sum_jacobian(&closure->curve, combination, closure->G);
    for (size_t i = 0; i < n; i++) {
        const double *row = closure->G + i * 2 * n + (half == TVI_FIRST ? 0 : n);
        for (size_t j = 0; j < n; j++) out[j] += factor * x[i] * row[j];
    }
}

static tvi_status factor_full(tvi_closure *closure, const tvi_combination *first, const tvi_combination *second)
{
    const size_t n = (size_t)closure->n;
    if (!closure->is_fresh) return TVI_OK;
    tvi_curve_sum_jacobian(&closure->curve, first, closure->full.lu);
    tvi_curve_sum_jacobian(&closure->curve, second, closure->full.lu + 2 * n * n);
    return tvi_factor_compute(&closure->full);
}

tvi_status tvi_close_solve_full(tvi_closure *closure, const tvi_combination *first, const tvi_combination *second)
{
    const tvi_status status = factor_full(closure, first, second);
    if (status == TVI_OK) tvi_factor_solve_transposed(&closure->full, closure->D);
    return status;
}
