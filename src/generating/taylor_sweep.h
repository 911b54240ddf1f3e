/* taylor_sweep.h - the coefficients of a Taylor curve in another unit of time, and their sums: part of the text of
 * generated code (emit.c), where every size is a constant. All others call tvi_taylor_loops.sweep. */
#ifndef TVI_SRC_GENERATING_TAYLOR_SWEEP_H
#define TVI_SRC_GENERATING_TAYLOR_SWEEP_H

#include "fused.h"

#include <math.h>

/* Rows x_k, k = least .. degree, [components], `stride` apart: of one curve, or of several, whose components are lanes
 * that know nothing of each other. */
typedef struct {
    int components, least, degree;
    size_t stride;
    bool has_slope;
} tvi_taylor_rows;

/* Their sums, [components]: of x_k and k |x_k|. Rows with a slope begin with k = 2, but x_1 is in these sums, too; they
 * also have that of k x_k, and |x_1| and that of (k - 1) k |x_k|. */
typedef struct {
    double *rise, *size, *slope, *bend;
} tvi_taylor_sums;

/* Row k, into the sums of one of two chains, which do not wait for each other. */
#define SIZE_OF_jet_v1(x) fabs(x)
#define SIZE_OF_jet_v2(x) JET_ABS(jet_v2, x)
#define SIZE_OF_jet_v4(x) JET_ABS(jet_v4, x)
#define SIZE_OF_jet_v8(x) JET_ABS(jet_v8, x)
#define SWEEP_ROW(V, k, c)                                                                                             \
    {                                                                                                                  \
        V *const row = (V *)(x + (size_t)(k)*rows->stride + here);                                                     \
        const V now = *row * power[k], size_of = SIZE_OF_##V(now), term = weight * size_of;                            \
        *row = now;                                                                                                    \
        rise[c] += now;                                                                                                \
        size[c] = JET_FUSED(V, weight + none, size_of, size[c]);                                                       \
        if (has_slope) slope[c] = JET_FUSED(V, weight + none, now, slope[c]);                                          \
        weight -= 1;                                                                                                   \
        if (has_slope) bend[c] = JET_FUSED(V, weight + none, term, bend[c]);                                           \
    }
#define SWEEP(V, WITH_SLOPE)                                                                                           \
    {                                                                                                                  \
        const bool has_slope = WITH_SLOPE;                                                                             \
        const V none = {0};                                                                                            \
        V rise[2] = {none, none}, size[2] = {none, none}, slope[2] = {none, none}, bend[2] = {none, none};             \
        double weight = rows->degree;                                                                                  \
        int k = rows->degree;                                                                                          \
        for (; k > rows->least; k -= 2) {                                                                              \
            SWEEP_ROW(V, k, 0)                                                                                         \
            SWEEP_ROW(V, k - 1, 1)                                                                                     \
        }                                                                                                              \
        if (k == rows->least) SWEEP_ROW(V, k, 0)                                                                       \
        if (has_slope) {                                                                                               \
            V *const row = (V *)(x + rows->stride + here);                                                             \
            const V now = *row * power[1], size_of = SIZE_OF_##V(now);                                                 \
            *row = now;                                                                                                \
            *(V *)(sums->rise + here) = rise[0] + rise[1] + now;                                                       \
            *(V *)(sums->size + here) = size[0] + size[1] + size_of;                                                   \
            *(V *)(sums->slope + here) = slope[0] + slope[1];                                                          \
            *(V *)(sums->bend + here) = bend[0] + bend[1] + size_of;                                                   \
        } else {                                                                                                       \
            *(V *)(sums->rise + here) = rise[0] + rise[1];                                                             \
            *(V *)(sums->size + here) = size[0] + size[1];                                                             \
        }                                                                                                              \
    }

/* x_k *= power[k], and their sums, the small terms first. */
JET_INLINE void taylor_sweep(const tvi_taylor_rows *rows, const double *power, double *x, const tvi_taylor_sums *sums)
{
    if (rows->has_slope) JET_BLOCKS(rows->components, SWEEP, true);
    else JET_BLOCKS(rows->components, SWEEP, false);
}

#endif
