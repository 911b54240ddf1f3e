/* test_forces.c - Tests the forces by hand against plain ones in long double, the scenes' references, and the Gauss
 * tableaus. */
#include "baselines.h"
#include "baselines/forces.h"
#include "baselines/gauss_tableau.h"
#include "baselines/jacobians.h"
#include "baselines/solar_rows.h"

#include <float.h>

#define LANES 8
#include "baselines/force_kernels.h"
#undef LANES

typedef void kernel(const double *q, double *a);
typedef void jacobian(const double *q, double *J);

#define WRAP(name, n)                                                                                                  \
    static void name##_lanes(const double *q, double *a) { name##_8(q, a); }                                           \
    static void name##_derivative(const double *q, double *J) { name##_jacobian(q, J); }
FORCES_BY_HAND(WRAP)
#define LANES_ROW(name, n) name##_lanes,
static kernel *const lanes[FORCES] = {FORCES_BY_HAND(LANES_ROW)};
#define JACOBIAN_ROW(name, n) name##_derivative,
static jacobian *const jacobians[FORCES] = {FORCES_BY_HAND(JACOBIAN_ROW)};

/* Eight points near the start of problem _i, none of whose coordinates is 0. */
static void points(const test_problem *problem, double q[8][BASELINE_N_MAX])
{
    for (int point = 0; point < 8; point++)
        for (int k = 0; k < problem->scene->n; k++)
            q[point][k] = problem->scene->q[k] * (1 + 0.01 * point) + 0.02 * sin(1 + k + 3 * point);
}

static void plain_acceleration(const test_problem *problem, const double *q, long double *a)
{
    long double x[BASELINE_N_MAX];
    for (int k = 0; k < problem->scene->n; k++) x[k] = q[k];
    problem->plain(0, x, a);
    for (int k = 0; k < problem->scene->n; k++) a[k] /= problem_mass(problem, k);
}

/* The largest |a_k - exact_k| in units of the largest |exact_k|. */
static double relative(int n, const double *a, const long double *exact)
{
    long double error = 0, size = 0;
    for (int k = 0; k < n; k++) {
        error = fmaxl(error, fabsl(a[k] - exact[k]));
        size = fmaxl(size, fabsl(exact[k]));
    }
    return (double)(error / size);
}

START_TEST(accelerations_are_right)
{
    const test_problem *problem = baseline_problems[_i];
    const int n = problem->scene->n;
    double q[8][BASELINE_N_MAX] = {{0}}, rows[BASELINE_N_MAX * 8], a_rows[BASELINE_N_MAX * 8], a[BASELINE_N_MAX];
    long double exact[BASELINE_N_MAX];
    ck_assert_int_eq(force_of(problem->scene), _i);
    points(problem, q);
    for (int i = 0; i < 8 * n; i++) rows[i] = q[i % 8][i / 8];
    lanes[_i](rows, a_rows);
    for (int point = 0; point < 8; point++) {
        plain_acceleration(problem, q[point], exact);
        accelerations[_i](q[point], a);
        ck_assert_double_lt(relative(n, a, exact), 20 * DBL_EPSILON);
        for (int k = 0; k < n; k++) a[k] = a_rows[8 * k + point];
        ck_assert_double_lt(relative(n, a, exact), 20 * DBL_EPSILON);
    }
}
END_TEST

START_TEST(solar_rows_are_right)
{
    const test_problem *problem = baseline_problems[FORCE_SOLAR];
    double q[8][BASELINE_N_MAX] = {{0}}, rows[ROWS], a_rows[ROWS], a[BASELINE_N_MAX];
    long double exact[BASELINE_N_MAX];
    points(problem, q);
    for (int point = 0; point < 8; point++) {
        plain_acceleration(problem, q[point], exact);
        for (int i = 0; i < ROWS; i++) rows[i] = q[point][3 * (i % ROW % 6) + i / ROW];
        solar_rows(rows, a_rows);
        for (int i = 0; i < ROWS; i++) a[3 * (i % ROW % 6) + i / ROW] = a_rows[i];
        ck_assert_double_lt(relative(18, a, exact), 20 * DBL_EPSILON);
    }
}
END_TEST

/* Against central differences of the plain force in long double. */
START_TEST(jacobians_are_right)
{
    const test_problem *problem = baseline_problems[_i];
    const int n = problem->scene->n;
    const double step = 1e-5;
    double q[8][BASELINE_N_MAX] = {{0}}, J[BASELINE_N_MAX * BASELINE_N_MAX], column[BASELINE_N_MAX];
    points(problem, q);
    jacobians[_i](q[3], J);
    for (int k = 0; k < n; k++) {
        long double right[BASELINE_N_MAX], left[BASELINE_N_MAX];
        double moved[BASELINE_N_MAX];
        memcpy(moved, q[3], sizeof moved);
        moved[k] = q[3][k] + step;
        plain_acceleration(problem, moved, right);
        const double width = moved[k];
        moved[k] = q[3][k] - step;
        plain_acceleration(problem, moved, left);
        for (int i = 0; i < n; i++) {
            right[i] = (right[i] - left[i]) / (width - (long double)moved[k]);
            column[i] = J[i * n + k];
        }
        ck_assert_double_lt(relative(n, column, right), 1e-8);
    }
}
END_TEST

/* Every scene that has a force by hand, from its start to its end: the potential that the library records and that
 * force are the same. One force serves two scenes. */
START_TEST(runs_end_at_the_references)
{
    const scene *s = scenes[_i];
    const baseline *gauss = baseline_find("gauss", 16);
    int served = 0;
    for (int i = 0; scenes[i]; i++) served += baseline_serves(gauss, scenes[i]);
    ck_assert_int_gt(served, BASELINE_PROBLEMS);
    if (!baseline_serves(gauss, s)) return;
    double size = 0;
    for (int i = 0; i < 2 * s->n; i++) size = fmax(size, fabs(s->reference[i]));
    const test_problem problem = {.scene = s, .t_end = s->t_end};
    const long steps = 4000;
    test_state x;
    ck_assert_int_eq(baseline_run(gauss, &problem, s->t_end / (double)steps, steps, &x), TVI_OK);
    for (int i = 0; i < s->n; i++) {
        ck_assert_double_eq_tol(x.q[i], s->reference[i], 1e-11 * size);
        ck_assert_double_eq_tol(x.p[i], s->reference[s->n + i], 1e-11 * size);
    }
}
END_TEST

/* sum b_i c_i^k = 1/(k+1) for k < 2 s, sum_j (A^2)_ij c_j^k = c_i^(k+2)/((k+1)(k+2)) for k < s - 1, and the symmetry
 * that makes the method symplectic, b_i (b_j (1 - c_j) - (A^2)_ij) = b_j (b_i (1 - c_i) - (A^2)_ji). */
START_TEST(tableaus_are_right)
{
    const gauss_tableau *t = gauss_tableau_of(_i);
    for (int k = 0; k < 2 * _i; k++) {
        long double sum = 0;
        for (int j = 0; j < _i; j++) sum += t->weight[j] * powl(t->node[j], k);
        ck_assert_ldouble_eq_tol(sum, 1 / (long double)(k + 1), 4 * LDBL_EPSILON);
    }
    for (int i = 0; i < _i; i++)
        for (int k = 0; k < _i - 1; k++) {
            long double sum = 0;
            for (int j = 0; j < _i; j++) sum += t->matrix[i][j] * powl(t->node[j], k);
            ck_assert_ldouble_eq_tol(sum, powl(t->node[i], k + 2) / ((k + 1) * (k + 2)), 4 * LDBL_EPSILON);
        }
    for (int i = 0; i < _i; i++)
        for (int j = 0; j < i; j++)
            ck_assert_ldouble_eq_tol(t->weight[i] * (t->position_weight[j] - t->matrix[i][j]),
                                     t->weight[j] * (t->position_weight[i] - t->matrix[j][i]), 4 * LDBL_EPSILON);
}
END_TEST

Suite *suite_forces(void)
{
    Suite *suite = suite_create("forces");
    TCase *tcase = tcase_create("forces");
    int count = 0;
    while (scenes[count]) count++;
    tcase_add_loop_test(tcase, accelerations_are_right, 0, BASELINE_PROBLEMS);
    tcase_add_test(tcase, solar_rows_are_right);
    tcase_add_loop_test(tcase, jacobians_are_right, 0, BASELINE_PROBLEMS);
    tcase_add_loop_test(tcase, runs_end_at_the_references, 0, count);
    tcase_add_loop_test(tcase, tableaus_are_right, 2, GAUSS_STAGES_MAX + 1);
    suite_add_tcase(suite, tcase);
    return suite;
}
