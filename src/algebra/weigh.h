/* weigh.h - Adds rows of a matrix, or the magnitudes of their entries, times weights to a vector. The sums of Taylor
 * series (generating/curve.h) call it. */
#ifndef TVI_SRC_ALGEBRA_WEIGH_H
#define TVI_SRC_ALGEBRA_WEIGH_H

#include "vector.h"

#include <math.h>

/* The magnitude of each lane of a vector. */
#define TVI_SIZE_OF_jet_v8(x) JET_ABS(jet_v8, x)
#define TVI_SIZE_OF_jet_v4(x) JET_ABS(jet_v4, x)
#define TVI_SIZE_OF_jet_v2(x) JET_ABS(jet_v2, x)
#define TVI_SIZE_OF_jet_v1(x) fabs(x)

/* Sums the weighted rows of a block of components as two sums, which the processor adds at the same time. The sum of
 * a component does not depend on how many components there are. */
#define TVI_WEIGH(V, OF)                                                                                               \
    {                                                                                                                  \
        V sum = {0}, odd = {0};                                                                                        \
        size_t r = count;                                                                                              \
        for (; r > 1; r -= 2) {                                                                                        \
            sum += weight[r - 1] * OF(V, JET_OF(V, row, r - 1));                                                       \
            odd += weight[r - 2] * OF(V, JET_OF(V, row, r - 2));                                                       \
        }                                                                                                              \
        if (r > 0) sum += weight[0] * OF(V, JET_OF(V, row, 0));                                                        \
        JET_AT(V, out, 0) += sum + odd;                                                                                \
    }
#define TVI_ITSELF(V, x)   (x)
#define TVI_ITS_SIZE(V, x) TVI_SIZE_OF_##V(x)

/* Adds sum_r weight[r] row[r * stride + i] to out[i], i < components, from the last row to the first, so that the
 * small terms of a series come first. */
static inline void tvi_add_weighted_rows(size_t count, const double weight[], size_t stride, size_t components,
                                         const double row[], double out[])
{
    JET_BLOCKS((int)components, TVI_WEIGH, TVI_ITSELF);
}

/* Adds sum_r weight[r] |row[r * stride + i]| to out[i], i < components, in the same order. */
static inline void tvi_add_weighted_magnitudes(size_t count, const double weight[], size_t stride, size_t components,
                                               const double row[], double out[])
{
    JET_BLOCKS((int)components, TVI_WEIGH, TVI_ITS_SIZE);
}

#endif
