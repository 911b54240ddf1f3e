/* linear.h - Factors and solves dense linear systems. Matrices are square and row-major. The corrections of all
 * curves, and the Legendre transforms, call it. */
#ifndef TVI_SRC_ALGEBRA_LINEAR_H
#define TVI_SRC_ALGEBRA_LINEAR_H

#include "algebra/arena.h"
#include "tvi.h"

#include <stdbool.h>

/* A factored matrix A: R A C = P L U, where the diagonal matrices R and C scale the rows and columns, P is a
 * permutation, L is lower triangular with the diagonal 1, and U is upper triangular. */
typedef struct {
    int n;
    /* [n][n] The matrix, then its factors L and U. */
    double *lu;
    /* Scratch for iterative refinement: the matrix R A C [n][n], the right-hand side [n] and the residual [n]. */
    double *scaled_matrix, *right_side, *residual;
    bool uses_refinement;             /* Each solution gets one step of iterative refinement. */
    double *row_scale, *column_scale; /* [n] The diagonals of R and C, powers of two. */
    int *pivot;                       /* [n] The exchanges P: row i with row pivot[i] - 1, one after the other. */
} tvi_lu_factor;

void tvi_factor_allocate(tvi_lu_factor *factor, tvi_arena *arena, int n);

/* Factors the matrix in place. Returns TVI_ESINGULAR if a pivot is at the level of roundoff, and TVI_ENONFINITE if
 * the matrix is not finite. */
TVI_NODISCARD tvi_status tvi_factor_compute(tvi_lu_factor *factor);

/* Returns the smallest magnitude of a pivot of the scaled matrix R A C, in which the largest entry of each row and
 * column is about 1. */
double tvi_factor_least_pivot(const tvi_lu_factor *factor);

/* Inverts the matrices of `lanes` lanes, of which each element is a row: `matrix` and `inverse` are [n][n][lanes] and
 * may be the same array, column [n] is scratch. Returns the status of tvi_factor_compute for the first matrix that it
 * refuses. */
TVI_NODISCARD tvi_status tvi_factor_invert_lanes(tvi_lu_factor *factor, int lanes, const double matrix[],
                                                 double inverse[], double column[]);

/* Compute x <- A^-1 x, and x <- A^-T x. As long as the pivots are on the diagonal, the result does not depend on the
 * units of the unknowns, and roundoff of a large unknown does not enter a small one. If rows with different units
 * were exchanged, the solution is refined, which removes that roundoff. */
void tvi_factor_solve(const tvi_lu_factor *factor, double x[]);
void tvi_factor_solve_transposed(const tvi_lu_factor *factor, double x[]);

#endif
