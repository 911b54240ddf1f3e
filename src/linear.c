/* linear.c - the only file that calls LAPACK. */
#include "linear.h"

#include <math.h>

/* LAPACK's own interface: Fortran, column-major; a character argument has a hidden length at the end. */
void dgetrf_(const int *m, const int *n, double *a, const int *lda, int *ipiv, int *info);
void dgetf2_(const int *m, const int *n, double *a, const int *lda, int *ipiv, int *info);
void dgetrs_(const char *trans, const int *n, const int *nrhs, const double *a, const int *lda, const int *ipiv, double *b,
             const int *ldb, int *info, size_t trans_length);

/* Below this size OpenBLAS factors with one thread, so that dgetrf gives the same bits for any number of threads; above
 * it dgetf2 does. */
enum { DGETRF_BELOW = 100 };

void tvi_factor_take(tvi_factor *factor, tvi_arena *arena, int n)
{
    factor->n = n;
    factor->lu = tvi_arena_doubles(arena, (size_t)n * (size_t)n);
    factor->pivot = tvi_arena_take(arena, (size_t)n * sizeof(int));
}

tvi_status tvi_factor_compute(tvi_factor *factor)
{
    const int n = factor->n;
    for (int i = 0; i < n * n; i++)
        if (!isfinite(factor->lu[i])) return TVI_ENONFINITE;
    int info = 0;
    (n < DGETRF_BELOW ? dgetrf_ : dgetf2_)(&n, &n, factor->lu, &n, factor->pivot, &info);
    return info == 0 ? TVI_OK : TVI_ESINGULAR;
}

/* A row-major matrix is the transpose of a column-major one. */
static void solve(const tvi_factor *factor, const char *trans, double x[])
{
    const int one = 1;
    int info = 0;
    dgetrs_(trans, &factor->n, &one, factor->lu, &factor->n, factor->pivot, x, &factor->n, &info, 1);
}

void tvi_factor_solve(const tvi_factor *factor, double x[]) { solve(factor, "T", x); }
void tvi_factor_solve_transposed(const tvi_factor *factor, double x[]) { solve(factor, "N", x); }
