/* linear_small.h - Factors and solves systems so small that a call of LAPACK costs more than their arithmetic. The
 * functions linear_small_* do what dgetf2 and dgetrs do with the same data: matrices are column-major, and pivots
 * count from 1. linear.c and the curves call it. */
#ifndef TVI_SRC_ALGEBRA_LINEAR_SMALL_H
#define TVI_SRC_ALGEBRA_LINEAR_SMALL_H

#include "algebra/linear.h"
#include "algebra/sizes.h"
#include "vector.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* [1] Rows have different units if their scales differ by this factor; solutions are refined then. */
#define LINEAR_UNIT_RATIO 8 /* found: make check-library, suite linear */

JET_INLINE void linear_swap(double *x, double *y)
{
    const double kept = *x;
    *x = *y;
    *y = kept;
}

/* Eliminates column j below the diagonal. The pivot stays on the diagonal unless another candidate is more than
 * twice as large. Otherwise rows of different units that were scaled alike by chance would be exchanged, and the
 * small unknown would get the roundoff of the large one. */
JET_INLINE void linear_small_eliminate_column(int n, int j, double a[], int pivot[])
{
    int largest = j;
    double most = 2 * fabs(a[j + j * n]);
    for (int i = j + 1; i < n; i++)
        if (fabs(a[i + j * n]) > most) {
            most = fabs(a[i + j * n]);
            largest = i;
        }
    pivot[j] = largest + 1;
    if (a[largest + j * n] == 0) return;
    for (int k = 0; largest != j && k < n; k++) linear_swap(&a[j + k * n], &a[largest + k * n]);
    const double inverse = 1 / a[j + j * n];
    for (int i = j + 1; i < n; i++) a[i + j * n] *= inverse;
    for (int k = j + 1; k < n; k++)
        for (int i = j + 1; i < n; i++) a[i + k * n] -= a[i + j * n] * a[j + k * n];
}

/* Factors the column-major matrix a = P L U in place, with partial pivoting. A pivot that is 0 stays 0. The first
 * columns stand outside of the loop, so that all indices are constants for a small n. */
JET_INLINE void linear_small_factor(int n, double a[], int pivot[])
{
    if (n > 0) linear_small_eliminate_column(n, 0, a, pivot);
    if (n > 1) linear_small_eliminate_column(n, 1, a, pivot);
    if (n > 2) linear_small_eliminate_column(n, 2, a, pivot);
    if (n > 3) linear_small_eliminate_column(n, 3, a, pivot);
    for (int j = 4; j < n; j++) linear_small_eliminate_column(n, j, a, pivot);
}

/* Computes x <- A^-1 x with the factors lu and pivot of linear_small_factor. */
JET_INLINE void linear_small_solve(int n, const double lu[], const int pivot[], double x[])
{
    for (int i = 0; i < n; i++) linear_swap(&x[i], &x[pivot[i] - 1]);
    for (int j = 0; j < n; j++)
        for (int i = j + 1; i < n; i++) x[i] -= lu[i + j * n] * x[j];
    for (int j = n - 1; j >= 0; j--) {
        x[j] /= lu[j + j * n];
        for (int i = 0; i < j; i++) x[i] -= lu[i + j * n] * x[j];
    }
}

/* Computes x <- A^-T x with the factors lu and pivot of linear_small_factor. */
JET_INLINE void linear_small_solve_transposed(int n, const double lu[], const int pivot[], double x[])
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < i; j++) x[i] -= lu[j + i * n] * x[j];
        x[i] /= lu[i + i * n];
    }
    for (int i = n - 1; i >= 0; i--)
        for (int j = i + 1; j < n; j++) x[i] -= lu[j + i * n] * x[j];
    for (int i = n - 1; i >= 0; i--) linear_swap(&x[i], &x[pivot[i] - 1]);
}

/* ---- Factors of all sizes ---------------------------------------------------------------------------------------- */

/* Returns a power of two close to 1/magnitude, which scales without roundoff. Returns 1 if magnitude is 0 or not
 * finite. */
JET_INLINE double linear_power_of_two_scale(double magnitude)
{
    uint64_t bits;
    if (magnitude == 0 || !isfinite(magnitude)) return 1;
    memcpy(&bits, &magnitude, sizeof bits);
    /* Here magnitude = f 2^(exponent - 1023) with 1 <= f < 2, or exponent = 0 if magnitude is subnormal. */
    const uint64_t exponent = bits >> 52;
    if (exponent < 23 || exponent > 2040) return exponent < 23 ? 0x1p1000 : 0x1p-1018;
    bits = (2045 - exponent) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* Scales A <- R A C, with R and C in row_scale and column_scale, so that the largest entry of each column, and then of
 * each row, is about 1. The columns are scaled first, which removes the units, so that the pivots do not depend on
 * them. */
JET_INLINE void linear_equilibrate_matrix(int n, tvi_lu_factor *factor)
{
    double least = INFINITY, largest = 0;
    for (int j = 0; j < n; j++) {
        double size = 0;
        for (int i = 0; i < n; i++) {
            const double entry = fabs(factor->lu[(size_t)i * (size_t)n + (size_t)j]);
            if (entry > size) size = entry;
        }
        factor->column_scale[j] = linear_power_of_two_scale(size);
        for (int i = 0; i < n; i++) factor->lu[(size_t)i * (size_t)n + (size_t)j] *= factor->column_scale[j];
    }
    for (int i = 0; i < n; i++) {
        double *row = factor->lu + (size_t)i * (size_t)n, size = 0;
        for (int j = 0; j < n; j++)
            if (fabs(row[j]) > size) size = fabs(row[j]);
        factor->row_scale[i] = linear_power_of_two_scale(size);
        for (int j = 0; j < n; j++) row[j] *= factor->row_scale[i];
        least = tvi_smaller(factor->row_scale[i], least);
        largest = tvi_larger(factor->row_scale[i], largest);
    }
    factor->uses_refinement = largest >= LINEAR_UNIT_RATIO * least;
    if (factor->uses_refinement) memcpy(factor->scaled_matrix, factor->lu, (size_t)n * (size_t)n * sizeof *factor->lu);
}

/* Tells whether the factorisation exchanged rows. */
JET_INLINE bool linear_has_row_exchanges(int n, const tvi_lu_factor *factor)
{
    for (int i = 0; i < n; i++)
        if (factor->pivot[i] != i + 1) return true;
    return false;
}

JET_INLINE double linear_least_pivot(int n, const tvi_lu_factor *factor)
{
    double least = INFINITY;
    for (int i = 0; i < n; i++) {
        const double pivot = fabs(factor->lu[i * n + i]);
        least = pivot < least ? pivot : least;
    }
    return least;
}

/* Checks the pivots after the factorisation of a scaled matrix. Solutions will be refined only if rows were exchanged.
 * Returns TVI_ESINGULAR if the factorisation failed or a pivot is at the level of roundoff. */
JET_INLINE tvi_status linear_check_pivots(int n, bool is_factored, tvi_lu_factor *factor)
{
    factor->uses_refinement = factor->uses_refinement && linear_has_row_exchanges(n, factor);
    return is_factored && linear_least_pivot(n, factor) > n * DBL_EPSILON ? TVI_OK : TVI_ESINGULAR;
}

/* Multiplies each component x_i by scale_i. */
JET_INLINE void linear_scale_components(int n, const double scale[], double x[])
{
    for (int i = 0; i < n; i++) x[i] *= scale[i];
}

/* Computes factor->residual, the residual of the solution for factor->right_side, for one step of iterative refinement.
 * If rows of different units were exchanged, the step removes the roundoff of large unknowns from small ones (Skeel,
 * Math. Comp. 35, 1980). */
JET_INLINE void linear_compute_residual(int n, const tvi_lu_factor *factor, bool transposed, const double solution[])
{
    const int row_stride = transposed ? 1 : n, column_stride = transposed ? n : 1;
    for (int i = 0; i < n; i++) {
        double residual = factor->right_side[i];
        for (int j = 0; j < n; j++) residual -= factor->scaled_matrix[i * row_stride + j * column_stride] * solution[j];
        factor->residual[i] = residual;
    }
}

/* The type of a function that computes x <- (R A C)^-1 x, or (R A C)^-T x if `transposed`. */
typedef void linear_factored_solver(int n, const tvi_lu_factor *factor, bool transposed, double x[]);

/* Computes x <- A^-1 x, or x <- A^-T x if `transposed`, with A^-1 = C (R A C)^-1 R. `solve_factored` multiplies by (R A
 * C)^-1 or its transpose. */
JET_INLINE void linear_solve_scaled(int n, const tvi_lu_factor *factor, bool transposed,
                                    linear_factored_solver *solve_factored, double x[])
{
    linear_scale_components(n, transposed ? factor->column_scale : factor->row_scale, x);
    if (factor->uses_refinement) memcpy(factor->right_side, x, (size_t)n * sizeof *x);
    solve_factored(n, factor, transposed, x);
    if (factor->uses_refinement) {
        linear_compute_residual(n, factor, transposed, x);
        solve_factored(n, factor, transposed, factor->residual);
        for (int i = 0; i < n; i++) x[i] += factor->residual[i];
    }
    linear_scale_components(n, transposed ? factor->row_scale : factor->column_scale, x);
}

/* ---- Factors of small sizes -------------------------------------------------------------------------------------- */

JET_INLINE tvi_status linear_small_compute(int n, tvi_lu_factor *factor)
{
    if (!tvi_all_finite(n * n, factor->lu)) return TVI_ENONFINITE;
    linear_equilibrate_matrix(n, factor);
    linear_small_factor(n, factor->lu, factor->pivot);
    return linear_check_pivots(n, true, factor);
}

/* Computes x <- (R A C)^-1 x, or x <- (R A C)^-T x if `transposed`. linear_small_factor reads the row-major matrix R A
 * C by columns, and has therefore factored its transpose. */
JET_INLINE void linear_small_solve_factored(int n, const tvi_lu_factor *factor, bool transposed, double x[])
{
    if (transposed) linear_small_solve(n, factor->lu, factor->pivot, x);
    else linear_small_solve_transposed(n, factor->lu, factor->pivot, x);
}

#endif
