/* halves.h - the coefficients of Gauss collocation by what is even and odd in time. With s_j = L_j + L_{m-1-j} and
 * d_j = L_j - L_{m-1-j}, j < m/2, and K = nu - (c_i - c_j)/2, which is symmetric about both diagonals, the sums
 * sum_j nu_ij L_j of a separable system are
 *
 *     node i:            even_i + odd_i,      even_i = sum_j (K_ij + K_i,m-1-j)/2 s_j - sum_j (c_j - 1/2)/2 d_j,
 *     node m - 1 - i:    even_i - odd_i,      odd_i  = sum_j (K_ij - K_i,m-1-j)/2 d_j + (c_i - 1/2)/2 sum_j s_j:
 *
 * half as many products. Those of other systems have mu - 1/2, which changes its sign about the diagonals, for K, so
 * that s and d change places, and even_i ends in 1/2 sum_j s_j. All of this is exact: what the matrices keep,
 * so do these. In the middle of an odd number of nodes s_j = d_j = L_j, of which d_j counts for nothing. */
#ifndef TVI_SRC_GALERKIN_HALVES_H
#define TVI_SRC_GALERKIN_HALVES_H

#include "galerkin/coefficients.h"

enum { MOST_PAIRS = (TVI_GALERKIN_MAX_LANES + 1) / 2 };
typedef struct {
    bool is_crossed;                                         /* first is d, and second s */
    double even[MOST_PAIRS * MOST_PAIRS], shift[MOST_PAIRS]; /* [j][i] by first_j, [j] by second_j */
    double odd[MOST_PAIRS * MOST_PAIRS], slope[MOST_PAIRS];  /* [j][i] by second_j, [i] by the sum of first */
} galerkin_halves;

void tvi_galerkin_halves_prepare(galerkin_halves *halves, const galerkin_coefficients *of, bool is_second_order);

#endif
