/* taylor_sweep.h - rescales the coefficients of a Taylor curve to another unit of time and sums them, in one sweep over
 * the coefficients. step_size.h calls it for steps of adapted size. */
#ifndef TVI_SRC_GENERATING_TAYLOR_SWEEP_H
#define TVI_SRC_GENERATING_TAYLOR_SWEEP_H

#include "fused.h"

#include <math.h>

/* The layout of the rows x_k, k = least .. degree, of component_count numbers, which are order_stride apart. */
typedef struct {
    int component_count, least, degree;
    size_t order_stride;
} tvi_taylor_rows;

/* The sums over the rows, [component_count] each: value_sum = sum x_k and size_sum = sum k |x_k|. The rows of a
 * separable system, whose momentum is the slope of q, begin with k = 2, but x_1 enters these sums, too. Such rows also
 * have slope_sum = sum k x_k and slope_size_sum = |x_1| + sum (k - 1) k |x_k|; other rows have NULL there. */
typedef struct {
    double *value_sum, *size_sum, *slope_sum, *slope_size_sum;
} tvi_taylor_sums;

#ifdef JET_WIDE
#define V        jet_v8
#define SIZE(x)  JET_ABS(jet_v8, x)
#define SWEPT(f) taylor_eight_##f
#include "generating/taylor_rows.h"
#endif
#ifdef __AVX__
#define V        jet_v4
#define SIZE(x)  JET_ABS(jet_v4, x)
#define SWEPT(f) taylor_four_##f
#include "generating/taylor_rows.h"
#endif
#define V        jet_v2
#define SIZE(x)  JET_ABS(jet_v2, x)
#define SWEPT(f) taylor_two_##f
#include "generating/taylor_rows.h"
#define V        jet_v1
#define SIZE(x)  fabs(x)
#define SWEPT(f) taylor_one_##f
#include "generating/taylor_rows.h"

/* Multiplies the rows x_k by power[k], and sums them, small terms first. has_slope_sums, a constant, says whether there
 * are sums of the slope. */
JET_INLINE void taylor_rescale_and_sum(const tvi_taylor_rows *rows, const double *power, double *x,
                                       const tvi_taylor_sums *sums, bool has_slope_sums)
{
    const int components = rows->component_count;
    int here = 0;
#ifdef JET_WIDE
    for (; here + 8 <= components; here += 8)
        taylor_eight_rescale_and_sum_rows(rows, power, x, sums, has_slope_sums, here);
#endif
#ifdef __AVX__
    for (; here + 4 <= components; here += 4)
        taylor_four_rescale_and_sum_rows(rows, power, x, sums, has_slope_sums, here);
#endif
    for (; here + 2 <= components; here += 2)
        taylor_two_rescale_and_sum_rows(rows, power, x, sums, has_slope_sums, here);
    for (; here < components; here++) taylor_one_rescale_and_sum_rows(rows, power, x, sums, has_slope_sums, here);
}

#endif
