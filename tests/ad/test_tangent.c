/* test_tangent.c - Tests tangents along a series to degree 40: against differences in quadruple precision, against the
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
    run_tangents(&r, DEGREE_MAX, 1, 1, x, dx, dz);
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
    run_tangents(&r, degree, 1, 1, cut, dx, dz);
    for (int i = 0; i < f->outputs; i++)
        check_series(f->name, degree, dz + i * DEGREE_MAX, want + i * DEGREE_MAX, 20 * f->bound);
    recording_free(&r);
}
END_TEST

/* ---- Lanes ------------------------------------------------------------------------------------------------------- */

enum { LANES_MAX = 40, DEGREE = 8, SHORT = DEGREE + 1 };

/* Series of a lane: one for all of them, or each a series of its own, x(c s) with another c, inside of the domain as x
 * is. */
static void series_of_lane(const function *f, int lane, bool is_own)
{
    double power = 1;
    dense_series(f, DEGREE, x);
    for (int k = 0; is_own && k <= DEGREE; k++, power *= 1 + lane / 64.0)
        for (int i = 0; i < f->inputs; i++) x[i * SHORT + k] *= power;
}

/* Every direction on its own: single[lane][..]. */
static void run_one_by_one(const function *f, const recording *r, bool are_own, double *single)
{
    for (int lane = 0; lane < LANES_MAX; lane++) {
        series_of_lane(f, lane, are_own);
        dense_direction(f, lane, DEGREE, dx);
        run_tangents(r, DEGREE, 1, 1, x, dx, single + lane * f->outputs * SHORT);
    }
}

/* The first `lanes` directions together give the same, to roundoff (see check_lanes in test_series.c). */
static void check_lanes(const function *f, const recording *r, int lanes, bool are_own, const double *single)
{
    const int lanes_of_x = are_own ? lanes : 1;
    double *all_x = numbers((size_t)(f->inputs * SHORT * lanes)),
           *all_dx = numbers((size_t)(f->inputs * SHORT * lanes));
    double *all_dz = numbers((size_t)(f->outputs * SHORT * lanes));
    for (int lane = 0; lane < lanes; lane++) {
        series_of_lane(f, lane, are_own);
        if (lane < lanes_of_x) set_lane(f->inputs, DEGREE, lanes_of_x, lane, x, all_x);
        dense_direction(f, lane, DEGREE, dx);
        set_lane(f->inputs, DEGREE, lanes, lane, dx, all_dx);
    }
    run_tangents(r, DEGREE, lanes_of_x, lanes, all_x, all_dx, all_dz);
    for (int lane = 0; lane < lanes; lane++) {
        get_lane(f->outputs, DEGREE, lanes, lane, all_dz, dz);
        for (int i = 0; i < f->outputs; i++)
            check_series(f->name, DEGREE, dz + i * SHORT, single + (lane * f->outputs + i) * SHORT, f->bound);
    }
    free(all_x);
    free(all_dx);
    free(all_dz);
}

/* Along one series, and each along its own. */
START_TEST(lanes_equal_single_directions)
{
    const function *f = any_function(_i / 2);
    const bool are_own = _i % 2 == 1;
    recording r = record_outputs(f, JET_TAPE_SERIES);
    double *single = numbers((size_t)(LANES_MAX * f->outputs * SHORT));
    run_one_by_one(f, &r, are_own, single);
    for (int lanes = 1; lanes <= LANES_MAX; lanes++) check_lanes(f, &r, lanes, are_own, single);
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
    tcase_add_loop_test(tangents, lanes_equal_single_directions, 0, 2 * functions);
#ifndef TESTS_WITHOUT_QUAD
    tcase_add_loop_test(add_case(suite, "quad"), tangent_agrees_with_differences, 0, functions);
#endif
    return suite;
}
