/* linear.h - dense factor and solve, by LAPACK. Matrices are square and row-major. */
#ifndef TVI_SRC_ALGEBRA_LINEAR_H
#define TVI_SRC_ALGEBRA_LINEAR_H

#include "algebra/arena.h"
#include "tvi.h"

#include <stdbool.h>

typedef struct {
    int n;
    double *lu;                    /* [n][n]: fill it, then factor; the factor replaces it */
    double *matrix, *given, *lack; /* of solutions that are refined (linear.c): [n][n] and [n] */
    bool is_refined;
    double *row_scale, *column_scale; /* [n] powers of two */
    int *pivot;
} tvi_factor;

void tvi_factor_take(tvi_factor *factor, tvi_arena *arena, int n);

/* P L U of factor->lu. TVI_ESINGULAR; TVI_ENONFINITE where the matrix is not finite. */
TVI_NODISCARD tvi_status tvi_factor_compute(tvi_factor *factor);

/* The smallest pivot of the factor, relative to rows and columns of size 1. */
double tvi_factor_least_pivot(const tvi_factor *factor);

/* x <- A^-1 x or, transposed, x <- A^-T x. Pivots on the diagonal are the same ones in all units, and no unknown has
 * the roundoff of another; where others were taken, and rows have different units, the solution is refined. */
void tvi_factor_solve(const tvi_factor *factor, double x[]);
void tvi_factor_solve_transposed(const tvi_factor *factor, double x[]);

#endif
