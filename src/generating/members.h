/* members.h - computes weighted sums of rows whose lanes are members of an ensemble, with the same bits as
 * jet_combine_strided_rows (sums.h) computes for one member. It handles four vectors at once, so that each weight is
 * loaded once. The fast-path steps of fast_path_members.c call it. */
#ifndef TVI_SRC_GENERATING_MEMBERS_H
#define TVI_SRC_GENERATING_MEMBERS_H

#include "vector.h"

enum { MEMBERS_PARTS = 4, MEMBERS_VECTOR = sizeof(jet_widest) / sizeof(double) };

/* Computes vector_count vectors of out as weighted sums of the vectors of the rows. */
JET_INLINE void members_combine_rows_in_simd_vectors(int vector_count, int row_count, const double *weight,
                                                     size_t weight_stride, size_t stride, const double *row,
                                                     double *out)
{
    jet_widest sum[MEMBERS_PARTS] = {{0}}, odd[MEMBERS_PARTS] = {{0}};
    int j = row_count - 1;
    for (; j > 0; j -= 2) {
        const double this_weight = weight[(size_t)j * weight_stride],
                     next_weight = weight[(size_t)(j - 1) * weight_stride];
        const jet_widest *x = (const jet_widest *)(row + (size_t)j * stride);
        const jet_widest *y = (const jet_widest *)(row + (size_t)(j - 1) * stride);
        for (int p = 0; p < vector_count; p++) sum[p] += this_weight * x[p];
        for (int p = 0; p < vector_count; p++) odd[p] += next_weight * y[p];
    }
    for (int p = 0; p < vector_count && j == 0; p++) sum[p] += weight[0] * ((const jet_widest *)row)[p];
    for (int p = 0; p < vector_count; p++) ((jet_widest *)out)[p] = sum[p] + odd[p];
}

/* Computes out[width] = sum_{j < row_count} weight_j row_j[width], the last terms first; the width is a multiple of 8.
 */
static inline void members_combine_rows(int row_count, const double *weight, size_t weight_stride, int width,
                                        size_t stride, const double *row, double *out)
{
    int here = 0;
    for (; here + MEMBERS_PARTS * MEMBERS_VECTOR <= width; here += MEMBERS_PARTS * MEMBERS_VECTOR)
        members_combine_rows_in_simd_vectors(MEMBERS_PARTS, row_count, weight, weight_stride, stride, row + here,
                                             out + here);
    for (; here < width; here += MEMBERS_VECTOR)
        members_combine_rows_in_simd_vectors(1, row_count, weight, weight_stride, stride, row + here, out + here);
}

#endif
