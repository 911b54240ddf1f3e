/* recurrences_quad.h - Declares coefficient k of a power series by comparing coefficients, and linear equations, in
 * quadruple precision: what the references and the definitions of tests/fuzz_steps share. */
#ifndef TVI_BENCH_RECURRENCES_QUAD_H
#define TVI_BENCH_RECURRENCES_QUAD_H

#include <stdbool.h>

typedef __float128 quad;

/* z = a b: z_k = sum_{j=0}^k a_j b_{k-j}. */
quad quad_product(const quad *a, const quad *b, int k);
/* z b = a: sum_{j=0}^k z_j b_{k-j} = a_k. */
quad quad_quotient(const quad *a, const quad *b, const quad *z, int k);
/* z z = a: 2 z_0 z_k + sum_{j=1}^{k-1} z_j z_{k-j} = a_k. */
quad quad_root(const quad *a, const quad *z, int k);
/* z' = w a': k z_k = sum_{j=1}^k j a_j w_{k-j}, k >= 1. */
quad quad_chain(const quad *a, const quad *w, int k);
/* w z' = a': sum_{j=1}^k j z_j w_{k-j} = k a_k, k >= 1. */
quad quad_inverse_chain(const quad *a, const quad *w, const quad *z, int k);

/* x <- A^-1 x by elimination with row pivots; A [n][n], of rows, is overwritten. false: it is singular. */
bool quad_solve(int n, quad *A, quad x[]);

#endif
