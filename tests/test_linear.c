/* test_linear.c - dense factors: small systems, which are solved without LAPACK, against LAPACK, and the residuals of all. */
#include "linear.h"
#include "suites.h"

#include <check.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void dgetrf_(const int *m, const int *n, double *a, const int *lda, int *ipiv, int *info);
void dgetrs_(const char *trans, const int *n, const int *nrhs, const double *a, const int *lda, const int *ipiv,
             double *b, const int *ldb, int *info, size_t trans_length);

enum { MOST = 12 };

typedef struct {
    void *memory;
    tvi_factor factor;
} open_factor;

static open_factor open_of_size(int n)
{
    open_factor x = {0};
    tvi_arena arena = {0};
    tvi_factor_take(&x.factor, &arena, n);
    arena.base = x.memory = aligned_alloc(ARENA_ALIGNMENT, arena.used);
    ck_assert_ptr_nonnull(x.memory);
    arena.used = 0;
    tvi_factor_take(&x.factor, &arena, n);
    return x;
}

/* Rows and columns of very different sizes, and a small entry where the first pivot would stand. */
static void fill(int n, int number, double A[])
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            A[i * n + j] = cos(1 + i * 3.7 + j * 1.3 + number * 0.9 + i * j) * ldexp(1, 9 * i - 7 * j) * (i + j ? 1 : 1e-9);
}

/* LAPACK's own solution of A x = b or A^T x = b; its matrices are column-major. */
static void solve_by_lapack(int n, const double A[], bool transposed, double x[])
{
    double a[MOST * MOST];
    int pivot[MOST], info, one = 1;
    memcpy(a, A, (size_t)(n * n) * sizeof *a);
    dgetrf_(&n, &n, a, &n, pivot, &info);
    ck_assert_int_eq(info, 0);
    dgetrs_(transposed ? "N" : "T", &n, &one, a, &n, pivot, x, &n, &info, 1);
}

/* Both solutions satisfy the equations as well as the sizes of their terms allow. */
static void check_residual(int n, const double A[], bool transposed, const double x[], const double b[])
{
    for (int i = 0; i < n; i++) {
        double sum = -b[i], size = fabs(b[i]);
        for (int j = 0; j < n; j++) {
            const double term = (transposed ? A[j * n + i] : A[i * n + j]) * x[j];
            sum += term;
            size += fabs(term);
        }
        ck_assert_double_le(fabs(sum), 40 * n * DBL_EPSILON * size);
    }
}

START_TEST(solutions_are_those_of_lapack)
{
    const int n = _i;
    open_factor x = open_of_size(n);
    double A[MOST * MOST], b[MOST], got[MOST], want[MOST];
    for (int number = 0; number < 20; number++)
        for (int transposed = 0; transposed < 2; transposed++) {
            fill(n, number, A);
            memcpy(x.factor.lu, A, (size_t)(n * n) * sizeof *A);
            ck_assert_int_eq(tvi_factor_compute(&x.factor), TVI_OK);
            for (int i = 0; i < n; i++) b[i] = got[i] = want[i] = sin(1 + i) * ldexp(1, transposed ? -7 * i : 9 * i);
            solve_by_lapack(n, A, transposed, want);
            (transposed ? tvi_factor_solve_transposed : tvi_factor_solve)(&x.factor, got);
            check_residual(n, A, transposed, got, b);
            for (int i = 0; i < n; i++) ck_assert_double_eq_tol(got[i], want[i], 1e-9 * fabs(want[i]));
        }
    free(x.memory);
}
END_TEST

START_TEST(singular_matrices_are_refused)
{
    const int n = _i;
    open_factor x = open_of_size(n);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) x.factor.lu[i * n + j] = (1 + i) * (2.0 + j); /* rank 1 */
    if (n == 1) x.factor.lu[0] = 0;
    ck_assert_int_eq(tvi_factor_compute(&x.factor), TVI_ESINGULAR);
    for (int i = 0; i < n * n; i++) x.factor.lu[i] = i % (n + 1) ? 0 : 1;
    x.factor.lu[n * n - 1] = NAN;
    ck_assert_int_eq(tvi_factor_compute(&x.factor), TVI_ENONFINITE);
    free(x.memory);
}
END_TEST

Suite *suite_linear(void)
{
    Suite *suite = suite_create("linear");
    TCase *linear = tcase_create("linear");
    tcase_set_timeout(linear, 120);
    tcase_add_loop_test(linear, solutions_are_those_of_lapack, 1, MOST + 1);
    tcase_add_loop_test(linear, singular_matrices_are_refused, 1, MOST + 1);
    suite_add_tcase(suite, linear);
    return suite;
}
