/* linear.c - Factors and solves dense linear systems by LAPACK (linear.h). No other file calls LAPACK. Small systems
 * are solved without it (linear_small.h). */
#include "algebra/linear.h"
#include "algebra/linear_small.h"
#include "algebra/sizes.h"

/* [rows] This is the number of rows of the largest matrix that the library's own elimination (algebra/linear_small.h)
 * factors. LAPACK factors larger ones: one call of it costs more than the arithmetic of a small matrix. */
#define LINEAR_OWN_MAX_ROWS 16 /* found: make check-library, suite linear */
/* [rows] OpenBLAS factors matrices of fewer rows with one thread. */
#define LAPACK_THREADED_MIN_ROWS 100 /* found: make blas-threads */

/* Declares the Fortran functions of LAPACK, whose matrices are column-major. A character argument has a hidden
 * length at the end. */
void dgetrf_(const int *m, const int *n, double *a, const int *lda, int *ipiv, int *info);
void dgetf2_(const int *m, const int *n, double *a, const int *lda, int *ipiv, int *info);
void dgetrs_(const char *trans, const int *n, const int *nrhs, const double *a, const int *lda, const int *ipiv,
             double *b, const int *ldb, int *info, size_t trans_length);

void tvi_factor_allocate(tvi_lu_factor *factor, tvi_arena *arena, int n)
{
    const size_t numbers = (size_t)n * (size_t)n;
    factor->n = n;
    factor->lu = tvi_arena_allocate_doubles(arena, numbers);
    factor->row_scale = tvi_arena_allocate_doubles(arena, (size_t)n);
    factor->column_scale = tvi_arena_allocate_doubles(arena, (size_t)n);
    factor->pivot = tvi_arena_allocate(arena, (size_t)n * sizeof(int));
    factor->scaled_matrix = tvi_arena_allocate_doubles(arena, numbers);
    factor->right_side = tvi_arena_allocate_doubles(arena, (size_t)n);
    factor->residual = tvi_arena_allocate_doubles(arena, (size_t)n);
}

tvi_status tvi_factor_compute(tvi_lu_factor *factor)
{
    const int n = factor->n;
    if (n <= LINEAR_OWN_MAX_ROWS) return linear_small_compute(n, factor);
    int info = 0;
    if (!tvi_all_finite(n * n, factor->lu)) return TVI_ENONFINITE;
    linear_equilibrate_matrix(n, factor);
    /* dgetf2 has one thread for any size, so that results do not depend on the number of threads. */
    (n < LAPACK_THREADED_MIN_ROWS ? dgetrf_ : dgetf2_)(&n, &n, factor->lu, &n, factor->pivot, &info);
    return linear_check_pivots(n, info == 0, factor);
}

double tvi_factor_least_pivot(const tvi_lu_factor *factor) { return linear_least_pivot(factor->n, factor); }

/* Computes x <- (R A C)^-1 x, or x <- (R A C)^-T x if `transposed`. LAPACK reads the row-major matrix R A C by columns,
 * and has therefore factored its transpose. */
static void solve_factored_by_lapack(int n, const tvi_lu_factor *factor, bool transposed, double x[])
{
    const int one = 1;
    int info = 0;
    dgetrs_(transposed ? "N" : "T", &n, &one, factor->lu, &n, factor->pivot, x, &n, &info, 1);
}

/* Solves A x = b, or A^T x = b if `transposed`, with A^-1 = C (R A C)^-1 R. x contains b before, and the solution
 * afterwards. */
static void solve_with_factor(const tvi_lu_factor *factor, bool transposed, double x[])
{
    const int n = factor->n;
    if (n <= LINEAR_OWN_MAX_ROWS) linear_solve_scaled(n, factor, transposed, linear_small_solve_factored, x);
    else linear_solve_scaled(n, factor, transposed, solve_factored_by_lapack, x);
}

void tvi_factor_solve(const tvi_lu_factor *factor, double x[]) { solve_with_factor(factor, false, x); }

void tvi_factor_solve_transposed(const tvi_lu_factor *factor, double x[]) { solve_with_factor(factor, true, x); }

tvi_status tvi_factor_invert_lanes(tvi_lu_factor *factor, int lanes, const double matrix[], double inverse[],
                                   double column[])
{
    const int n = factor->n;
    for (int lane = 0; lane < lanes; lane++) {
        for (int i = 0; i < n * n; i++) factor->lu[i] = matrix[i * lanes + lane];
        const tvi_status status = tvi_factor_compute(factor);
        if (status != TVI_OK) return status;
        for (int j = 0; j < n; j++) {
            for (int i = 0; i < n; i++) column[i] = i == j;
            tvi_factor_solve(factor, column);
            for (int i = 0; i < n; i++) inverse[(i * n + j) * lanes + lane] = column[i];
        }
    }
    return TVI_OK;
}
