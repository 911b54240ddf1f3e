/* test_limits.c - Tests linear stability of the harmonic oscillator against closed forms. */
#include "stability.h"
#include "stability/linear.h"

#include <math.h>

typedef struct {
    const char *name;
    int order;
    tvi_options change; /* quadrature and points, where not those of the name */
    double limit;       /* of h w; INFINITY: none */
} limit_row;

#define SQRT_2 1.41421356237309505
#define SQRT_3 1.73205080756887729

/* N = 1 on-curve: Ld = (q1 - q0)^2/(2h) - h w^2 (q0^2 + q0 q1 + q1^2)/6 whatever the centre, so a = d =
 * (1 - z^2/3)/(1 + z^2/6) > -1 for z^2 < 12. Symplectic Euler, Stormer-Verlet and N = 2 with the trapezoid: 2
 * (docs/method.md section 7). Type III at the start, truncated, N = 1: trace 1 + 1/(1 + z^2). Poincare treats q and p
 * alike, so that its step of the oscillator is a rotation. */
static const limit_row limit_rows[] = {
    {"stormer-verlet", 2, {0}, 2},
    {"svhd", 2, {0}, 2 * SQRT_2},
    {"tvi", 1, {0}, 2},
    {"tvi", 1, {.quadrature = TVI_RECTANGLE_END}, 2},
    {"tvi", 1, {.quadrature = TVI_TRAPEZOID}, 2},
    {"tvi", 2, {.quadrature = TVI_TRAPEZOID}, 2},
    {"htvi-right", 1, {.quadrature = TVI_RECTANGLE_START}, 2},
    {"htvi-left", 1, {0}, INFINITY},
    {"start", 2, {0}, 2 * SQRT_3},
    {"end", 2, {0}, 2 * SQRT_3},
    {"midpoint", 2, {0}, 2 * SQRT_3},
    {"both-ends", 2, {0}, 2 * SQRT_3},
    {"both-ends", 2, {.quadrature = TVI_TRAPEZOID}, 2},
    {"midpoint", 2, {.quadrature_points = 1}, INFINITY},
    {"poincare", 2, {0}, INFINITY},
    {"poincare", 4, {0}, INFINITY},
    {"poincare", 8, {0}, INFINITY},
};
enum { LIMITS = sizeof limit_rows / sizeof *limit_rows };

static tvi_integrator *oscillator_integrator(const limit_row *row, tvi_system **system)
{
    tvi_options options;
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_options_named(row->name, row->order, &options), TVI_OK);
    options.quadrature = options.quadrature ? options.quadrature : row->change.quadrature;
    options.quadrature_points = row->change.quadrature_points;
    options.max_tail = -1; /* steps that are too large are looked for */
    ck_assert_int_eq(hard_system(&oscillator, system), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, *system, &options), TVI_OK);
    return integrator;
}

START_TEST(limits_are_known)
{
    const limit_row *row = &limit_rows[_i];
    tvi_system *system;
    tvi_integrator *integrator = oscillator_integrator(row, &system);
    const linear_limit limit = linear_search(integrator, 12);
    if (isinf(row->limit))
        ck_assert_msg(isinf(limit.onset), "%s %d: unstable at %g", row->name, row->order, limit.onset);
    else ck_assert_double_eq_tol(limit.onset, row->limit, 1e-6);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* The spectral radius is 1 below the limit and grows as in the closed form above it. */
START_TEST(growth_is_known)
{
    static const limit_row row = {"midpoint", 2, {0}, 0};
    tvi_system *system;
    tvi_integrator *integrator = oscillator_integrator(&row, &system);
    for (double z = 0.25; z < 8; z += 0.25) {
        step_matrix M;
        const double a = (1 - z * z / 3) / (1 + z * z / 6), growth = a < -1 ? -a + sqrt(a * a - 1) - 1 : 0;
        ck_assert_int_eq(linear_matrix(integrator, z, &M), TVI_OK);
        ck_assert_double_eq_tol(M.a, a, 1e-13);
        ck_assert_double_eq_tol(M.d, a, 1e-13);
        ck_assert_double_eq_tol(linear_growth(&M), growth, 1e-12);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Intervals at k pi that are much narrower than the cells of the search are found, between the zeros of b and c. The
 * paper's right method of order 12: a growth of 5e-4, from 3.14069 to 3.1416. */
START_TEST(narrow_intervals_are_found)
{
    static const limit_row row = {"htvi-right", 12, {0}, 0};
    tvi_system *system;
    tvi_integrator *integrator = oscillator_integrator(&row, &system);
    const linear_limit limit = linear_search(integrator, 4);
    step_matrix M;
    double most = 0;
    for (double z = 3.13; z < 3.15; z += 1e-5)
        if (linear_matrix(integrator, z, &M) == TVI_OK) most = fmax(most, linear_growth(&M));
    ck_assert_double_gt(most, 1e-4);
    ck_assert_double_eq_tol(limit.growth, most, 0.02 * most);
    ck_assert_int_eq(linear_matrix(integrator, limit.onset - 1e-5, &M), TVI_OK);
    ck_assert_double_lt(linear_growth(&M), LINEAR_VISIBLE);
    ck_assert_int_eq(linear_matrix(integrator, limit.onset + 1e-5, &M), TVI_OK);
    ck_assert_double_gt(linear_growth(&M), LINEAR_VISIBLE);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* The passes of a Galerkin curve with 8 nodes contract as long as h w < 11. They end at any phase, also where the last
 * bits go to and fro and the nodes are farther from the start than the start is from 0. The test goes to 7, where they
 * end by themselves; from about 9 on max_passes ends them. The energy is that of a stable map, and the largest
 * difference seen is 2e-13. */
START_TEST(galerkin_passes_end)
{
    static const limit_row row = {"galerkin", 16, {0}, 0};
    enum { PHASES = 20 };
    tvi_system *system;
    tvi_integrator *integrator = oscillator_integrator(&row, &system);
    for (double z = 3; z < 7; z += 0.02)
        for (int k = 0; k < PHASES; k++) {
            double t = 0, q = cos(0.3 * k), p = sin(0.3 * k);
            tvi_integrator_reset(integrator);
            ck_assert_msg(tvi_step(integrator, z, &t, &q, &p) == TVI_OK, "h w = %g, phase %g: %s", z, 0.3 * k,
                          tvi_last_error());
            ck_assert_msg(fabs(q * q + p * p - 1) <= 1e-12, "h w = %g, phase %g: the energy is off by %g", z, 0.3 * k,
                          q * q + p * p - 1);
        }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Below its limit SVHd's corrector contracts by 0.48 at h w = 1.96, which takes more than fifty passes. */
START_TEST(slow_contraction_arrives)
{
    static const limit_row row = {"svhd", 2, {0}, 0};
    tvi_system *system;
    tvi_integrator *integrator = oscillator_integrator(&row, &system);
    for (double z = 1.9; z < 2.05; z += 0.005) {
        step_matrix M;
        ck_assert_int_eq(linear_matrix(integrator, z, &M), TVI_OK);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

Suite *suite_limits(void)
{
    Suite *suite = suite_create("limits");
    TCase *tcase = tcase_create("limits");
    tcase_add_loop_test(tcase, limits_are_known, 0, LIMITS);
    tcase_add_test(tcase, growth_is_known);
    tcase_add_test(tcase, narrow_intervals_are_found);
    tcase_add_test(tcase, galerkin_passes_end);
    tcase_add_test(tcase, slow_contraction_arrives);
    suite_add_tcase(suite, tcase);
    return suite;
}
