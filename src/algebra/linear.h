/* linear.h - Factors and solves dense linear systems. Matrices are square and row-major. The corrections of all
 * curves, and the Legendre transforms, call it. */
#ifndef TVI_SRC_ALGEBRA_LINEAR_H
#define TVI_SRC_ALGEBRA_LINEAR_H

#include "algebra/arena.h"
#include "tvi.h"

#include <stdbool.h>

/* A factored matrix A. It is scaled by rows and columns: P L U = R A C. */
typedef struct {
    int n;
    /* [n][n] The matrix, then its factors L and U. */
    double *lu;
    /* Scratch for iterative refinement: the scaled matrix [n][n], the right-hand side and the residual [n]. */
    double *matrix, *given, *residual;
    bool is_refined;                  /* Solutions are refined. */
    double *row_scale, *column_scale; /* [n] The diagonals of R and C, powers of two. */
    int *pivot;
} tvi_lu_factor;

void tvi_factor_allocate(tvi_lu_factor *factor, tvi_arena *arena, int n);
/* Allocates the factors of several members (linear_small.h), which stand side by side. */
void tvi_factor_allocate_members(tvi_lu_factor *factor, tvi_arena *arena, int n, int width);

/* Factors the matrix in place. TVI_ESINGULAR; TVI_ENONFINITE if the matrix is not finite. */
TVI_NODISCARD tvi_status tvi_factor_compute(tvi_lu_factor *factor);

/* Returns the smallest pivot of the scaled matrix, whose rows and columns have size 1. */
double tvi_factor_least_pivot(const tvi_lu_factor *factor);

/* Computes x <- A^-1 x, or transposed, x <- A^-T x. Pivots on the diagonal do not depend on units, and no unknown
 * gets the roundoff of another one. If rows are exchanged between rows of different units, the solution is refined. */
void tvi_factor_solve(const tvi_lu_factor *factor, double x[]);
void tvi_factor_solve_transposed(const tvi_lu_factor *factor, double x[]);

#endif
