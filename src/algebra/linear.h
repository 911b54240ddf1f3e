/* linear.h - Factors and solves dense systems by LAPACK. Matrices are square and row-major. */
#ifndef TVI_SRC_ALGEBRA_LINEAR_H
#define TVI_SRC_ALGEBRA_LINEAR_H

#include "algebra/arena.h"
#include "tvi.h"

#include <stdbool.h>

typedef struct {
    int n;
    /* [n][n] the matrix, then its factor. */
    double *lu;
    /* Scratch of solutions that are refined (linear.c): [n][n] and [n]. */
    double *matrix, *given, *residual;
    bool is_refined;
    double *row_scale, *column_scale; /* [n] powers of two */
    int *pivot;
} tvi_factor;

void tvi_factor_take(tvi_factor *factor, tvi_arena *arena, int n);
/* Takes the factors of several members (linear_small.h), which stand side by side. */
void tvi_factor_take_several(tvi_factor *factor, tvi_arena *arena, int n, int width);

/* Factors P L U in place. TVI_ESINGULAR; TVI_ENONFINITE if the matrix is not finite. */
TVI_NODISCARD tvi_status tvi_factor_compute(tvi_factor *factor);

/* The smallest pivot of the factor, relative to rows and columns of size 1. */
double tvi_factor_least_pivot(const tvi_factor *factor);

/* x <- A^-1 x or, transposed, x <- A^-T x. Pivots on the diagonal are the same in all units, and no unknown gets the
 * roundoff of another. With other pivots, and rows of different units, the solution is refined. */
void tvi_factor_solve(const tvi_factor *factor, double x[]);
void tvi_factor_solve_transposed(const tvi_factor *factor, double x[]);

#endif
