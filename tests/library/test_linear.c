/* test_linear.c - Tests dense factors: small systems, which are solved without LAPACK, against LAPACK, and the
 * residuals of all, also of those that are the lanes of one. */
#include "algebra/linear_small.h"
#include "galerkin/galerkin.h"
#include "loops.h"
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
    tvi_lu_factor factor;
} open_factor;

static open_factor open_of_size(int n)
{
    open_factor x = {0};
    tvi_arena arena = {0};
    tvi_factor_allocate(&x.factor, &arena, n);
    arena.memory = x.memory = aligned_alloc(ARENA_ALIGNMENT, arena.bytes_outside_history);
    ck_assert_ptr_nonnull(x.memory);
    arena.bytes_outside_history = 0;
    tvi_factor_allocate(&x.factor, &arena, n);
    return x;
}

/* Rows and columns of very different sizes, and a small entry where the first pivot would stand. */
static void fill(int n, int number, double A[])
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            A[i * n + j] =
                cos(1 + i * 3.7 + j * 1.3 + number * 0.9 + i * j) * ldexp(1, 9 * i - 7 * j) * (i + j ? 1 : 1e-9);
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

/* A column whose one entry is tiny, whichever row it stands in, is scaled and not taken for zero: the solution is
 * (1/tiny, 1, 1, ...). */
START_TEST(lone_entries_are_scaled)
{
    const int n = _i;
    const double tiny = 0x1p-80;
    open_factor x = open_of_size(n);
    for (int lone = 0; lone < n; lone++) {
        double solution[MOST];
        for (int i = 0; i < n; i++) {
            const int strong = i == lone ? 0 : i < lone ? i + 1 : i; /* the column of the row's largest entry */
            for (int j = 1; j < n; j++) x.factor.lu[i * n + j] = j == strong ? n : 1;
            x.factor.lu[i * n] = i == lone ? tiny : 0;
            solution[i] = i == lone ? n : 2 * n - 2; /* the sum of the row times the solution */
        }
        ck_assert_int_eq(tvi_factor_compute(&x.factor), TVI_OK);
        tvi_factor_solve(&x.factor, solution);
        for (int i = 0; i < n; i++) ck_assert_double_eq_tol(solution[i] * (i == 0 ? tiny : 1), 1, 40 * n * DBL_EPSILON);
    }
    free(x.memory);
}
END_TEST

/* x with A x = b, or A^T x = b, where the second half of the unknowns, or of the equations, has a unit of its own. The
 * matrix is near the identity, with some entries in which a unit may hide. */
static void solve_in_unit(open_factor *f, double unit, bool transposed, double x[])
{
    const int n = f->factor.n;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            f->factor.lu[i * n + j] =
                (i == j ? 1 : ldexp(sin(1 + i + 2 * j), -12 * (1 + (i < j)))) * (2 * j < n ? 1 : unit);
    ck_assert_int_eq(tvi_factor_compute(&f->factor), TVI_OK);
    for (int i = 0; i < n; i++) x[i] = cos(1 + i) * (transposed && 2 * i >= n ? unit : 1);
    (transposed ? tvi_factor_solve_transposed : tvi_factor_solve)(&f->factor, x);
    for (int i = 0; i < n && !transposed; i++) x[i] *= 2 * i < n ? 1 : unit;
}

/* Bit for bit: its pivots are the same ones. */
START_TEST(units_of_columns_show_nowhere)
{
    static const double units[] = {0x1p-50, 0x1p-20, 0x1p20, 0x1p50};
    const int n = _i;
    open_factor f = open_of_size(n);
    for (int transposed = 0; transposed < 2; transposed++)
        for (size_t u = 0; u < sizeof units / sizeof *units; u++) {
            double x[MOST], y[MOST];
            solve_in_unit(&f, 1, transposed, x);
            solve_in_unit(&f, units[u], transposed, y);
            ck_assert_mem_eq(x, y, (size_t)n * sizeof *x);
        }
    free(f.memory);
}
END_TEST

/* A large entry beside the diagonal is that of another unit: an unknown that no other enters is its right-hand side,
 * without the roundoff of those that are larger. The last one, or of a transposed matrix the first. */
START_TEST(small_unknowns_have_their_own_roundoff)
{
    const int n = _i;
    open_factor f = open_of_size(n);
    for (int transposed = 0; transposed < 2; transposed++)
        for (int coupling = 32; coupling < 1 << 20; coupling *= 7) {
            double x[MOST];
            const int alone = transposed ? 0 : n - 1;
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++)
                    f.factor.lu[i * n + j] = i == j ? 1 : i == 0 && j == n - 1 ? coupling / 1.5 : 0;
            ck_assert_int_eq(tvi_factor_compute(&f.factor), TVI_OK);
            for (int i = 0; i < n; i++) x[i] = cos(1 + i) * (i == alone ? 0x1p-30 : 1);
            const double small = x[alone];
            (transposed ? tvi_factor_solve_transposed : tvi_factor_solve)(&f.factor, x);
            ck_assert_double_eq_tol(x[alone], small, 4 * DBL_EPSILON * fabs(small));
        }
    free(f.memory);
}
END_TEST

/* Two of other units whose rows and columns happen to be scaled alike: the Jacobian of a step of a light oscillator. */
START_TEST(small_unknown_of_an_even_scale_has_its_own_roundoff)
{
    static const double A[] = {0.989, -0.997, -2.99e-40, 0.989};
    open_factor f = open_of_size(2);
    double x[] = {-1.06e-35, -6.7e-16};
    memcpy(f.factor.lu, A, sizeof A);
    ck_assert_int_eq(tvi_factor_compute(&f.factor), TVI_OK);
    tvi_factor_solve_transposed(&f.factor, x);
    const double whole = A[0] * A[3] - A[1] * A[2], right = (A[3] * -1.06e-35 - A[2] * -6.7e-16) / whole;
    ck_assert_double_eq_tol(x[0], right, 8 * DBL_EPSILON * fabs(right));
    free(f.memory);
}
END_TEST

/* ---- One matrix in each lane ------------------------------------------------------------------------------------- */

enum { LANES = GALERKIN_MAX_LANES };

typedef struct {
    double lu[MOST * MOST * LANES], inverse[MOST * MOST * LANES], x[MOST * LANES];
} lanes_room;

static node_matrix lanes_inverse_in(lanes_room *room, int n)
{
    return (node_matrix){.n = n, .matrix = room->lu, .inverse = room->inverse, .scratch_column = room->x};
}

static void put_lane(const node_matrix *f, int lanes, int lane, const double A[])
{
    for (int i = 0; i < f->n * f->n; i++) f->matrix[i * lanes + lane] = A[i];
}

/* As a pass of a Lagrangian inverts. */
static bool invert_each(const galerkin_loops *with, const node_matrix *f, int lanes)
{
    open_factor x = open_of_size(f->n);
    const bool is_regular = with->invert(f, lanes) || tvi_galerkin_invert_by_exchanges(f, lanes, &x.factor);
    free(x.memory);
    return is_regular;
}

/* V = from + A^-1 ((P - p) - change), a matrix of its own in each lane: all with no need to exchange rows, or the last
 * of 16. */
static void check_lanes(const galerkin_loops *with, node_matrix *f, int lanes, bool are_plain)
{
    const int n = f->n;
    static const double none[MOST * LANES];
    double A[LANES][MOST * MOST], P[MOST * LANES], V[MOST * LANES], back[MOST * LANES];
    for (int lane = 0; lane < lanes; lane++) {
        fill(n, lane, A[lane]);
        for (int i = 0; (are_plain || lane == LANES - 1) && i < n * n; i++)
            A[lane][i] = i % (n + 1) ? cos(1 + i + lane) : 3 * n;
        put_lane(f, lanes, lane, A[lane]);
        for (int i = 0; i < n; i++) P[i * lanes + lane] = cos(1 + i + lane) * ldexp(1, 9 * i);
    }
    ck_assert(invert_each(with, f, lanes));
    with->correct_velocities(f, lanes, P, none, none, none, V);
    for (int lane = 0; lane < lanes; lane++) {
        double x[MOST], b[MOST];
        for (int i = 0; i < n; i++) x[i] = V[i * lanes + lane], b[i] = P[i * lanes + lane];
        check_residual(n, A[lane], false, x, b);
    }
    with->correct_velocities(f, lanes, none, P, none, V, back);
    for (int i = 0; i < n * lanes; i++) ck_assert_double_le(fabs(back[i]), DBL_EPSILON * fabs(V[i]));
    with->correct_velocities(f, lanes, P, none, P, V, back);
    for (int i = 0; i < n * lanes; i++) ck_assert(back[i] == V[i]);
}

START_TEST(lanes_are_solved_alone)
{
    const int n = 1 + _i / LANE_COUNTS, lanes = lane_counts[_i % LANE_COUNTS];
    static lanes_room room;
    node_matrix f = lanes_inverse_in(&room, n);
    const galerkin_loops *with;
    for (int isa = 0; isa < JET_ISA_COUNT; isa++)
        for (int are_plain = 0; are_plain < 2 && (with = loops_of(isa, _i % LANE_COUNTS)); are_plain++)
            check_lanes(with, &f, lanes, are_plain);
}
END_TEST

/* One lane is enough. */
START_TEST(singular_lanes_are_seen)
{
    const int n = 1 + _i / LANE_COUNTS, lanes = lane_counts[_i % LANE_COUNTS];
    static lanes_room room;
    node_matrix f = lanes_inverse_in(&room, n);
    double regular[MOST * MOST], rank_one[MOST * MOST], zero[MOST * MOST] = {0}, broken[MOST * MOST];
    double endless[MOST * MOST];
    for (int i = 0; i < n * n; i++) {
        regular[i] = broken[i] = endless[i] = i % (n + 1) ? 0.5 : n;
        rank_one[i] = n > 1 ? (1 + i / n) * (2.0 + i % n) : 0;
    }
    broken[n * n - 1] = NAN;
    endless[n * n - 1] = INFINITY;
    const double *const bad[] = {regular, rank_one, zero, broken, endless};
    const galerkin_loops *with;
    for (int isa = 0; isa < JET_ISA_COUNT; isa++)
        for (int kind = 0; kind < 5 && (with = loops_of(isa, _i % LANE_COUNTS)); kind++) {
            for (int lane = 0; lane < lanes; lane++) put_lane(&f, lanes, lane, lane == lanes / 2 ? bad[kind] : regular);
            ck_assert(invert_each(with, &f, lanes) == (kind == 0));
        }
}
END_TEST

Suite *suite_linear(void)
{
    Suite *suite = suite_create("linear");
    TCase *linear = tcase_create("linear");
    tcase_add_loop_test(linear, solutions_are_those_of_lapack, 1, MOST + 1);
    tcase_add_loop_test(linear, singular_matrices_are_refused, 1, MOST + 1);
    tcase_add_loop_test(linear, lone_entries_are_scaled, 1, MOST + 1);
    tcase_add_loop_test(linear, units_of_columns_show_nowhere, 2, MOST + 1);
    tcase_add_loop_test(linear, small_unknowns_have_their_own_roundoff, 2, MOST + 1);
    tcase_add_test(linear, small_unknown_of_an_even_scale_has_its_own_roundoff);
    tcase_add_loop_test(linear, lanes_are_solved_alone, 0, MOST * LANE_COUNTS);
    tcase_add_loop_test(linear, singular_lanes_are_seen, 0, MOST * LANE_COUNTS);
    suite_add_tcase(suite, linear);
    return suite;
}
