/* test_sensitivities.c - Tests derivatives of a run with respect to parameters: rows of tvi_step_tangent beyond 2n. */
#include "flow_quad.h"
#include "parameters.h"

#include <math.h>
#include <string.h>

enum { ROWS = 2 * N + PARAMETERS, STEPS = 40 };

/* Methods whose error over the run is below that of the comparison; of both forms that quadruple precision has. */
static const method accurate[] = {{"galerkin", 16}, {"midpoint", 20}, {"right", 20}, {"poincare", 20}, {"taylor", 24}};
enum { ACCURATE = sizeof accurate / sizeof *accurate };

START_TEST(columns_are_derivatives)
{
    static const int of_form[] = {0, 2, 3};
    const int in = of_form[_i / ACCURATE], steps = in == 3 ? 3 * STEPS : STEPS;
    tvi_system *system = system_of(&forms[in], NULL);
    tvi_integrator *it = integrator_of(system, &accurate[_i % ACCURATE]);
    if (!it) { /* type I, rescaled */
        tvi_system_free(system);
        return;
    }
    ck_assert_int_eq(tvi_integrator_set_parameters(it, other), TVI_OK);
    double D[ROWS][PARAMETERS] = {[2 * N] = {1, 0}, [2 * N + 1] = {0, 1}}, exact[2 * N];
    state x = start;
    for (int step = 0; step < steps; step++)
        ck_assert_int_eq(tvi_step_tangent(it, H, &x.t, x.q, x.p, &D[0][0], PARAMETERS), TVI_OK);
    for (int which = 0; which < PARAMETERS; which++) {
        const double from[] = {start.q[0], start.q[1], start.p[0], start.p[1]};
        exact_sensitivity(in == 2, other, which, from, x.t, exact);
        for (int row = 0; row < 2 * N; row++) ck_assert_double_eq_tol(D[row][which], exact[row], 1e-11);
        for (int row = 0; row < PARAMETERS; row++) ck_assert_double_eq(D[2 * N + row][which], row == which);
        ck_assert_double_ge(fabs(exact[0]), 0.1);
    }
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* The columns of any method's step: a difference of two runs of it, in double precision. */
START_TEST(columns_are_those_of_the_method)
{
    static const double EPSILON = 1e-5;
    tvi_system *system = system_of(&forms[_i / METHODS], NULL);
    tvi_integrator *it = integrator_of(system, &methods[_i % METHODS]);
    double D[ROWS] = {[2 * N + 1] = 1}, value[] = {recorded[0], recorded[1]};
    state x = start, side[2];
    for (int step = 0; it && step < STEPS; step++)
        ck_assert_int_eq(tvi_step_tangent(it, H, &x.t, x.q, x.p, D, 1), TVI_OK);
    for (int k = 0; it && k < 2; k++) {
        value[1] = recorded[1] + (k ? EPSILON : -EPSILON);
        ck_assert_int_eq(tvi_integrator_set_parameters(it, value), TVI_OK);
        side[k] = run(it, STEPS);
    }
    for (int i = 0; it && i < N; i++) {
        ck_assert_double_eq_tol(D[i], (side[1].q[i] - side[0].q[i]) / (2 * EPSILON), 1e-7);
        ck_assert_double_eq_tol(D[N + i], (side[1].p[i] - side[0].p[i]) / (2 * EPSILON), 1e-7);
    }
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* D is linear in all its rows, and columns beside it do not disturb one: two integrators, of three columns and of the
 * first alone. */
START_TEST(columns_add)
{
    tvi_system *system = system_of(&forms[_i], NULL);
    tvi_integrator *three = integrator_of(system, &methods[0]), *one = integrator_of(system, &methods[0]);
    double D[ROWS][3] = {{1, 0, 1}, {-0.5, 0, -0.5}, {0.25, 0, 0.25}, {2, 0, 2}, {0, 1, 1}, {0, -3, -3}};
    double alone[2 * N + PARAMETERS] = {1, -0.5, 0.25, 2};
    state x = start, y = start;
    for (int step = 0; step < STEPS; step++) {
        ck_assert_int_eq(tvi_step_tangent(three, H, &x.t, x.q, x.p, &D[0][0], 3), TVI_OK);
        ck_assert_int_eq(tvi_step_tangent(one, H, &y.t, y.q, y.p, alone, 1), TVI_OK);
    }
    ck_assert_mem_eq(&x, &y, sizeof x);
    for (int row = 0; row < 2 * N; row++) {
        ck_assert_double_eq_tol(D[row][2], D[row][0] + D[row][1], 1e-12);
        ck_assert_double_eq(D[row][0], alone[row]);
    }
    tvi_integrator_free(three);
    tvi_integrator_free(one);
    tvi_system_free(system);
}
END_TEST

Suite *suite_sensitivities(void)
{
    Suite *suite = suite_create("sensitivities");
    TCase *tests = tcase_create("sensitivities");
    tcase_add_loop_test(tests, columns_are_derivatives, 0, 3 * ACCURATE);
    tcase_add_loop_test(tests, columns_are_those_of_the_method, 0, 3 * METHODS);
    tcase_add_loop_test(tests, columns_add, 0, FORMS);
    suite_add_tcase(suite, tests);
    return suite;
}
