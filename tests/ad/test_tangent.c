/* test_tangent.c - tangents along a series to degree 40: against differences in quadruple precision, against the
 * derivative of the series itself, and in any number of lanes. */
#include "quad_series.h"
#include "record.h"
#include "suites.h"

#include <stdlib.h>
#include <string.h>

static double x[INPUTS_MAX * ORDERS], dx[INPUTS_MAX * ORDERS], dz[OUTPUTS_MAX * ORDERS], want[OUTPUTS_MAX * ORDERS];

/* ---- Quadruple precision ----------------------------------------------------------------------------------------- */

#ifndef TESTS_WITHOUT_QUAD

START_TEST(tangent_agrees_with_differences)
{
    const function *f = any_function(_i);
    recording r = record_outputs(f, JET_TAPE_SERIES);
    dense_series(f, DEGREE_MAX, x);
    dense_direction(f, 0, DEGREE_MAX, dx);
    run_tangents(&r, DEGREE_MAX, 1, x, dx, dz);
    quad_tangent(f, DEGREE_MAX, 1, x, dx, want);
    for (int i = 0; i < f->outputs; i++)
        check_series(f->name, DEGREE_MAX, dz + i * ORDERS, want + i * ORDERS, f->bound);
    recording_free(&r);
}
END_TEST

#endif

/* ---- The derivative of the series -------------------------------------------------------------------------------- */

/* y_k = (k+1) x_{k+1}, k < degree, of `count` series. */
static void differentiate(int count, int degree, const double from[], double to[])
{
    for (int i = 0; i < count; i++)
        for (int k = 0; k < degree; k++) to[i * degree + k] = (k + 1) * from[i * (degree + 1) + k + 1];
}

/* d/ds f(x(s)) is the tangent along x'(s). */
START_TEST(tangent_along_the_series_is_its_derivative)
{
    const function *f = any_function(_i);
    const int degree = DEGREE_MAX - 1;
    static double z[OUTPUTS_MAX * ORDERS], cut[INPUTS_MAX * ORDERS];
    recording r = record_outputs(f, JET_TAPE_SERIES);
    dense_series(f, DEGREE_MAX, x);
    ck_assert(run_series(&r, DEGREE_MAX, 1, x, z));
    differentiate(f->inputs, DEGREE_MAX, x, dx);
    differentiate(f->outputs, DEGREE_MAX, z, want);
    for (int i = 0; i < f->inputs; i++) memcpy(cut + i * DEGREE_MAX, x + i * ORDERS, DEGREE_MAX * sizeof *x);
    run_tangents(&r, degree, 1, cut, dx, dz);
    for (int i = 0; i < f->outputs; i++)
        check_series(f->name, degree, dz + i * DEGREE_MAX, want + i * DEGREE_MAX, 20 * f->bound);
    recording_free(&r);
}
END_TEST

/* ---- Lanes ------------------------------------------------------------------------------------------------------- */

enum { LANES_MAX = 40, DEGREE = 8, SHORT = DEGREE + 1 };

/* Every direction on its own: single[lane][..]. */
static void run_one_by_one(const function *f, const recording *r, double *single)
{
    for (int lane = 0; lane < LANES_MAX; lane++) {
        dense_direction(f, lane, DEGREE, dx);
        run_tangents(r, DEGREE, 1, x, dx, single + lane * f->outputs * SHORT);
    }
}

/* The first `lanes` directions together give the same, to roundoff (see check_lanes in test_series.c). */
static void check_lanes(const function *f, const recording *r, int lanes, const double *single)
{
    double *all_dx = numbers((size_t)(f->inputs * SHORT * lanes));
    double *all_dz = numbers((size_t)(f->outputs * SHORT * lanes));
    for (int lane = 0; lane < lanes; lane++) {
        dense_direction(f, lane, DEGREE, dx);
        set_lane(f->inputs, DEGREE, lanes, lane, dx, all_dx);
    }
    run_tangents(r, DEGREE, lanes, x, all_dx, all_dz);
    for (int lane = 0; lane < lanes; lane++) {
        get_lane(f->outputs, DEGREE, lanes, lane, all_dz, dz);
        for (int i = 0; i < f->outputs; i++)
            check_series(f->name, DEGREE, dz + i * SHORT, single + (lane * f->outputs + i) * SHORT, f->bound);
    }
    free(all_dx);
    free(all_dz);
}

START_TEST(lanes_equal_single_directions)
{
    const function *f = any_function(_i);
    recording r = record_outputs(f, JET_TAPE_SERIES);
    double *single = numbers((size_t)(LANES_MAX * f->outputs * SHORT));
    dense_series(f, DEGREE, x);
    run_one_by_one(f, &r, single);
    for (int lanes = 1; lanes <= LANES_MAX; lanes++) check_lanes(f, &r, lanes, single);
    free(single);
    recording_free(&r);
}
END_TEST

Suite *tangent_suite(void)
{
    Suite *suite = suite_create("tangent");
    const int functions = operation_count + composition_count;
    TCase *tangents = add_case(suite, "tangents");
    tcase_add_loop_test(tangents, tangent_along_the_series_is_its_derivative, 0, functions);
    tcase_add_loop_test(tangents, lanes_equal_single_directions, 0, functions);
#ifndef TESTS_WITHOUT_QUAD
    tcase_add_loop_test(add_case(suite, "quad"), tangent_agrees_with_differences, 0, functions);
#endif
    return suite;
}
