/* linear.c - the only file that calls LAPACK; the smallest systems do without (linear_small.h). */
#include "algebra/linear.h"
#include "algebra/linear_small.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* LAPACK's own interface: Fortran, column-major; a character argument has a hidden length at the end. */
void dgetrf_(const int *m, const int *n, double *a, const int *lda, int *ipiv, int *info);
void dgetf2_(const int *m, const int *n, double *a, const int *lda, int *ipiv, int *info);
void dgetrs_(const char *trans, const int *n, const int *nrhs, const double *a, const int *lda, const int *ipiv,
             double *b, const int *ldb, int *info, size_t trans_length);

static void small_solve(int n, const double lu[], const int pivot[], double x[])
{
#define CALL(n) linear_small_solve(n, lu, pivot, x)
    LINEAR_BY_SIZE(n, CALL)
#undef CALL
}

static void small_solve_transposed(int n, const double lu[], const int pivot[], double x[])
{
#define CALL(n) linear_small_solve_transposed(n, lu, pivot, x)
    LINEAR_BY_SIZE(n, CALL)
#undef CALL
}

/* Below this size OpenBLAS factors with one thread, so that dgetrf gives the same bits for any number of threads; above
 * it dgetf2 does. */
enum { DGETRF_BELOW = 100 };

void tvi_factor_take(tvi_factor *factor, tvi_arena *arena, int n)
{
    factor->n = n;
    factor->lu = tvi_arena_doubles(arena, (size_t)n * (size_t)n);
    factor->row_scale = tvi_arena_doubles(arena, (size_t)n);
    factor->column_scale = tvi_arena_doubles(arena, (size_t)n);
    factor->pivot = tvi_arena_take(arena, (size_t)n * sizeof(int));
    factor->matrix = tvi_arena_doubles(arena, (size_t)n * (size_t)n);
    factor->given = tvi_arena_doubles(arena, (size_t)n);
    factor->lack = tvi_arena_doubles(arena, (size_t)n);
}

/* The power of two next to 1/size, so that scaling rounds nothing; 1 for 0. */
static double inverse_power(double size)
{
    uint64_t bits;
    if (size == 0 || !isfinite(size)) return 1;
    memcpy(&bits, &size, sizeof bits);
    const uint64_t exponent = bits >> 52; /* size = 1.f 2^(exponent - 1023), or subnormal */
    if (exponent < 23 || exponent > 2040) return exponent < 23 ? 0x1p1000 : 0x1p-1018;
    bits = (2045 - exponent) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* A row that is scaled so many times as much as another has another unit. */
#define OTHER_UNIT 8

/* A <- R A C with columns, then rows, of size about 1. The rows of the ends' Jacobians (closure.h) are coordinates, so
 * that the columns, first, take the units out: the pivots do not depend on them. */
JET_INLINE void equilibrate(int n, tvi_factor *factor)
{
    double least = INFINITY, largest = 0;
    for (int j = 0; j < n; j++) {
        double size = 0;
        for (int i = 0; i < n; i++) {
            const double entry = fabs(factor->lu[(size_t)i * (size_t)n + (size_t)j]);
            if (entry > size) size = entry;
        }
        factor->column_scale[j] = inverse_power(size);
        for (int i = 0; i < n; i++) factor->lu[(size_t)i * (size_t)n + (size_t)j] *= factor->column_scale[j];
    }
    for (int i = 0; i < n; i++) {
        double *row = factor->lu + (size_t)i * (size_t)n, size = 0;
        for (int j = 0; j < n; j++)
            if (fabs(row[j]) > size) size = fabs(row[j]);
        factor->row_scale[i] = inverse_power(size);
        for (int j = 0; j < n; j++) row[j] *= factor->row_scale[i];
        least = tvi_smaller(factor->row_scale[i], least);
        largest = tvi_larger(factor->row_scale[i], largest);
    }
    factor->is_refined = largest >= OTHER_UNIT * least;
    if (factor->is_refined) memcpy(factor->matrix, factor->lu, (size_t)n * (size_t)n * sizeof *factor->lu);
}

JET_INLINE bool small_factor(int n, tvi_factor *factor)
{
    if (!tvi_all_finite(n * n, factor->lu)) return false;
    equilibrate(n, factor);
    linear_small_factor(n, factor->lu, factor->pivot);
    return true;
}

static bool is_exchanged(const tvi_factor *factor)
{
    for (int i = 0; i < factor->n; i++)
        if (factor->pivot[i] != i + 1) return true;
    return false;
}

tvi_status tvi_factor_compute(tvi_factor *factor)
{
    const int n = factor->n;
    int info = 0;
    bool is_finite;
    if (n > LINEAR_SMALL) {
        is_finite = tvi_all_finite(n * n, factor->lu);
        if (is_finite) equilibrate(n, factor);
        if (is_finite) (n < DGETRF_BELOW ? dgetrf_ : dgetf2_)(&n, &n, factor->lu, &n, factor->pivot, &info);
    } else {
#define CALL(n) is_finite = small_factor(n, factor)
        LINEAR_BY_SIZE(n, CALL)
#undef CALL
    }
    if (!is_finite) return TVI_ENONFINITE;
    factor->is_refined = factor->is_refined && is_exchanged(factor);
    return info == 0 && tvi_factor_least_pivot(factor) > n * DBL_EPSILON ? TVI_OK : TVI_ESINGULAR;
}

double tvi_factor_least_pivot(const tvi_factor *factor)
{
    double least = INFINITY;
    for (size_t i = 0; i < (size_t)factor->n; i++) {
        const double pivot = fabs(factor->lu[i * (size_t)factor->n + i]);
        if (pivot < least) least = pivot;
    }
    return least;
}

/* x <- scale x, component by component. */
static void rescale(int n, const double scale[], double x[])
{
    for (int i = 0; i < n; i++) x[i] *= scale[i];
}

/* A row-major matrix is the transpose of a column-major one. */
static void solve(const tvi_factor *factor, double x[])
{
    const int one = 1;
    int info = 0;
    if (factor->n <= LINEAR_SMALL) small_solve_transposed(factor->n, factor->lu, factor->pivot, x);
    else dgetrs_("T", &factor->n, &one, factor->lu, &factor->n, factor->pivot, x, &factor->n, &info, 1);
}

static void solve_transposed(const tvi_factor *factor, double x[])
{
    const int one = 1;
    int info = 0;
    if (factor->n <= LINEAR_SMALL) small_solve(factor->n, factor->lu, factor->pivot, x);
    else dgetrs_("N", &factor->n, &one, factor->lu, &factor->n, factor->pivot, x, &factor->n, &info, 1);
}

/* One step of iterative refinement of (R A C)^-1 given: where the pivots mix unknowns of different units, it takes from
 * the small ones the roundoff of the large (Skeel, Math. Comp. 35, 1980). */
static void refine(const tvi_factor *factor, bool transposed, double x[])
{
    const size_t n = (size_t)factor->n, of_row = transposed ? 1 : n, of_column = transposed ? n : 1;
    for (size_t i = 0; i < n; i++) {
        double lack = factor->given[i];
        for (size_t j = 0; j < n; j++) lack -= factor->matrix[i * of_row + j * of_column] * x[j];
        factor->lack[i] = lack;
    }
    (transposed ? solve_transposed : solve)(factor, factor->lack);
    for (size_t i = 0; i < n; i++) x[i] += factor->lack[i];
}

/* A^-1 = C (R A C)^-1 R. */
void tvi_factor_solve(const tvi_factor *factor, double x[])
{
    rescale(factor->n, factor->row_scale, x);
    if (factor->is_refined) memcpy(factor->given, x, (size_t)factor->n * sizeof *x);
    solve(factor, x);
    if (factor->is_refined) refine(factor, false, x);
    rescale(factor->n, factor->column_scale, x);
}

void tvi_factor_solve_transposed(const tvi_factor *factor, double x[])
{
    rescale(factor->n, factor->column_scale, x);
    if (factor->is_refined) memcpy(factor->given, x, (size_t)factor->n * sizeof *x);
    solve_transposed(factor, x);
    if (factor->is_refined) refine(factor, true, x);
    rescale(factor->n, factor->row_scale, x);
}
