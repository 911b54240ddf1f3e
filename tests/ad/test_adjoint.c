/* test_adjoint.c - Tests adjoints along a series: the transpose of the tangents, coefficient by coefficient. */
#include "record.h"
#include "suites.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { DEGREE = 9, SHORT = DEGREE + 1 };

static double x[INPUTS_MAX * SHORT], zbar[OUTPUTS_MAX * SHORT], xbar[INPUTS_MAX * SHORT];

/* xbar of input i, order k, against sum zbar dz with dx = 1 there: all of them as lanes of one tangent. The bound is
 * relative to the sum of the terms' sizes. */
static void check_transpose(const function *f, const recording *r)
{
    const int lanes = f->inputs * SHORT;
    double *dx = numbers((size_t)(f->inputs * SHORT * lanes)), *dz = numbers((size_t)(f->outputs * SHORT * lanes));
    for (int lane = 0; lane < lanes; lane++) dx[lane * lanes + lane] = 1;
    run_tangents(r, DEGREE, 1, lanes, x, dx, dz);
    for (int lane = 0; lane < lanes; lane++) {
        double sum = 0, size = DBL_MIN;
        for (int row = 0; row < f->outputs * SHORT; row++) {
            const double term = zbar[row] * dz[row * lanes + lane];
            sum += term;
            size += fabs(term);
        }
        ck_assert_msg(fabs(xbar[lane] - sum) <= 50 * f->bound * size, "%s: input %d, order %d: %.17g, not %.17g",
                      f->name, lane / SHORT, lane % SHORT, xbar[lane], sum);
    }
    free(dx);
    free(dz);
}

START_TEST(adjoints_are_transposed_tangents)
{
    const function *f = any_function(_i);
    recording r = record_outputs(f, JET_TAPE_SERIES);
    dense_series(f, DEGREE, x);
    for (int row = 0; row < f->outputs * SHORT; row++) zbar[row] = cos(1.0 + 0.7 * row);
    run_adjoints(&r, DEGREE, x, zbar, xbar);
    check_transpose(f, &r);
    recording_free(&r);
}
END_TEST

/* One order of one output at a time, so that no order hides behind another. */
START_TEST(each_order_has_its_adjoint)
{
    const function *f = any_function(_i);
    recording r = record_outputs(f, JET_TAPE_SERIES);
    dense_series(f, DEGREE, x);
    for (int row = 0; row < f->outputs * SHORT; row++) zbar[row] = 0;
    for (int k = 0; k <= DEGREE; k++) {
        zbar[k] = 1;
        run_adjoints(&r, DEGREE, x, zbar, xbar);
        check_transpose(f, &r);
        zbar[k] = 0;
    }
    recording_free(&r);
}
END_TEST

Suite *adjoint_suite(void)
{
    Suite *suite = suite_create("adjoint");
    const int functions = operation_count + composition_count;
    TCase *adjoints = add_case(suite, "adjoints");
    tcase_add_loop_test(adjoints, adjoints_are_transposed_tangents, 0, functions);
    tcase_add_loop_test(adjoints, each_order_has_its_adjoint, 0, functions);
    return suite;
}
