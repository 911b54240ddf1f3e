/* test_domain.c - Tests that an operation is refused exactly where its power series does not exist, at once for
 * numbers, by the sweep for jets. */
#include "record.h"
#include "suites.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define ABOVE_ONE (1 + DBL_EPSILON)
#define BELOW_ONE (1 - DBL_EPSILON / 2)

static const struct {
    const char *name;
    double c, a, b;
    bool exists;
} places[] = {
    {"add", 0, 0, 0, true},
    {"mul", 0, 0, 0, true},
    {"sqr", 0, 0, 0, true},
    {"div", 0, 1, 0, false},
    {"div", 0, 0, 0, false},
    {"div", 0, 1, -0.0, false},
    {"div", 0, 1, 1e-300, true},
    {"div", 0, 1, -2, true},
    {"div", 0, 0, 3, true},
    {"sqrt", 0, 0, 0, false},
    {"sqrt", 0, -0.0, 0, false},
    {"sqrt", 0, -1, 0, false},
    {"sqrt", 0, DBL_MIN, 0, true},
    {"sqrt", 0, -DBL_MIN, 0, false},
    {"sqrt", 0, 4, 0, true},
    {"log", 0, 0, 0, false},
    {"log", 0, -0.0, 0, false},
    {"log", 0, -1, 0, false},
    {"log", 0, DBL_MIN, 0, true},
    {"log", 0, -DBL_MIN, 0, false},
    {"log", 0, 2, 0, true},
    {"asin", 0, 1, 0, false},
    {"asin", 0, -1, 0, false},
    {"asin", 0, BELOW_ONE, 0, true},
    {"asin", 0, -BELOW_ONE, 0, true},
    {"asin", 0, ABOVE_ONE, 0, false},
    {"asin", 0, -ABOVE_ONE, 0, false},
    {"asin", 0, 7, 0, false},
    {"asin", 0, -7, 0, false},
    {"asin", 0, 0, 0, true},
    {"acos", 0, 1, 0, false},
    {"acos", 0, -1, 0, false},
    {"acos", 0, BELOW_ONE, 0, true},
    {"acos", 0, -BELOW_ONE, 0, true},
    {"acos", 0, ABOVE_ONE, 0, false},
    {"acos", 0, -ABOVE_ONE, 0, false},
    {"acos", 0, 7, 0, false},
    {"acos", 0, -7, 0, false},
    {"acos", 0, 0, 0, true},
    {"atan", 0, 0, 0, true},
    {"atan", 0, -1e9, 0, true},
    {"tan", 0, 1.5707963267948966, 0, true},
    {"exp", 0, -700, 0, true},
    {"exp", 0, 700, 0, true},
    {"tanh", 0, 1000, 0, true},
    {"sinh", 0, 0, 0, true},
    {"cosh", 0, 0, 0, true},
    {"sin", 0, 0, 0, true},
    {"cos", 0, 0, 0, true},
    {"pow", 0, 0, 0, true},
    {"pow", 1, 0, 0, true},
    {"pow", 2, 0, 0, true},
    {"pow", 9, 0, 0, true},
    {"pow", 3, -2, 0, true},
    {"pow", 2, -2, 0, true},
    {"pow", 0, -2, 0, true},
    {"pow", -1, 0, 0, false},
    {"pow", -2, 0, 0, false},
    {"pow", -9, 0, 0, false},
    {"pow", -1, -2, 0, true},
    {"pow", -2, -2, 0, true},
    {"pow", -3, -2, 0, true},
    {"pow", -9, -2, 0, true},
    {"pow", 0.5, 0, 0, false},
    {"pow", 0.5, -1, 0, false},
    {"pow", 0.5, 3, 0, true},
    {"pow", 1.5, 0, 0, false},
    {"pow", 1.5, -1, 0, false},
    {"pow", 1.5, DBL_MIN, 0, true},
    {"pow", -1.5, 0, 0, false},
    {"pow", -1.5, -1, 0, false},
    {"pow", -1.5, 2, 0, true},
    {"pow", 8.5, 0, 0, false},
    {"pow", 8.5, -1, 0, false},
    {"pow", 8.5, 1, 0, true},
    {"pow", 0.3, 0, 0, false},
    {"pow", 0.3, -1, 0, false},
    {"pow", 0.3, 2, 0, true},
    {"pow", -0.3, 0, 0, false},
    {"pow", -0.3, -1, 0, false},
    {"pow", -0.3, 2, 0, true},
    {"asinh", 0, 0, 0, true},
    {"asinh", 0, -1e9, 0, true},
    {"erf", 0, 0, 0, true},
    {"erf", 0, -30, 0, true},
    {"acosh", 0, 1, 0, false},
    {"acosh", 0, BELOW_ONE, 0, false},
    {"acosh", 0, ABOVE_ONE, 0, true},
    {"acosh", 0, 0, 0, false},
    {"acosh", 0, -2, 0, false},
    {"acosh", 0, 7, 0, true},
    {"atanh", 0, 1, 0, false},
    {"atanh", 0, -1, 0, false},
    {"atanh", 0, BELOW_ONE, 0, true},
    {"atanh", 0, -BELOW_ONE, 0, true},
    {"atanh", 0, ABOVE_ONE, 0, false},
    {"atanh", 0, -7, 0, false},
    {"atan2", 0, 0, 0, false},
    {"atan2", 0, -0.0, 0, false},
    {"atan2", 0, 0, -0.0, false},
    {"atan2", 0, 0, -1, true},
    {"atan2", 0, 0, 1, true},
    {"atan2", 0, -3, 0, true},
    {"atan2", 0, 1e-300, 0, true},
    {"hypot", 0, 0, 0, false},
    {"hypot", 0, 0, -0.0, false},
    {"hypot", 0, 0, -2, true},
    {"hypot", 0, 2, 0, true},
    {"hypot", 0, 1e300, 1e300, true},
};

enum { PLACES = sizeof places / sizeof places[0], LANES = 5 };

static function place_function(int i)
{
    const char *name = places[i].name;
    return (function){name, operation_named(name), 2, 1, places[i].c, {places[i].a, places[i].b}, 0};
}

/* A number at which the operation exists, whatever the exponent. */
static double inside(const char *name) { return strcmp(name, "acosh") == 0 ? 1.5 : 0.5; }

START_TEST(sweeps_refuse)
{
    const function f = place_function(_i);
    for (int kind = JET_TAPE_VALUES; kind <= JET_TAPE_SERIES; kind++) {
        recording r = record_outputs(&f, (jet_tape_kind)kind);
        double z;
        ck_assert_int_eq(run_values(&r, 1, f.centre, &z), places[_i].exists);
        ck_assert_int_eq(run_series(&r, 0, 1, f.centre, &z), places[_i].exists);
        if (places[_i].exists) ck_assert_double_finite(z);
        recording_free(&r);
    }
}
END_TEST

/* One lane outside is enough, whichever it is; NaN in the others does not hide it. */
START_TEST(sweeps_refuse_any_lane)
{
    const function f = place_function(_i);
    recording r = record_outputs(&f, JET_TAPE_VALUES);
    for (int bad = 0; bad < LANES; bad++) {
        double x[2 * LANES], z[LANES];
        for (int lane = 0; lane < LANES; lane++) {
            x[lane] = lane == bad ? f.centre[0] : lane % 2 ? inside(f.name) : NAN;
            x[LANES + lane] = lane == bad ? f.centre[1] : 0.5;
        }
        ck_assert_int_eq(run_values(&r, LANES, x, z), places[_i].exists);
    }
    recording_free(&r);
}
END_TEST

/* The same operation on numbers gives a number, the one the sweep gives, or is refused at once. */
START_TEST(numbers_are_refused_at_once)
{
    const function f = place_function(_i);
    jet z;
    f.record(f.c, (const jet[]){jet_const(f.centre[0]), jet_const(f.centre[1])}, &z);
    jet_graph *graph = jet_graph_create(0);
    if (places[_i].exists) {
        recording r = record_outputs(&f, JET_TAPE_VALUES);
        double value;
        ck_assert(run_values(&r, 1, f.centre, &value));
        ck_assert_ptr_null(z.node);
        ck_assert_double_le(fabs(z.number - value), 4e-16 * fabs(value));
        recording_free(&r);
    } else {
        ck_assert_int_eq(jet_graph_check_outputs(graph, 1, &z), TVI_EDOMAIN);
    }
    jet_graph_free(graph);
}
END_TEST

/* One member of a run outside is enough. */
static void record_three_roots(double c, const jet x[], jet z[])
{
    (void)c;
    for (int i = 0; i < 3; i++) z[i] = jet_sqrt(x[i]);
}

START_TEST(any_member_is_refused)
{
    const function f = {"roots", record_three_roots, 3, 3, 0, {0}, 0};
    recording r = record_outputs(&f, JET_TAPE_VALUES);
    double x[3] = {1, 1, 1}, z[3];
    ck_assert(run_values(&r, 1, x, z));
    x[_i] = -1;
    ck_assert(!run_values(&r, 1, x, z));
    recording_free(&r);
}
END_TEST

/* An offence is remembered past the operations that follow it. */
static void record_root_then_more(double c, const jet x[], jet z[])
{
    (void)c;
    z[0] = jet_exp(jet_neg(jet_sqr(jet_sqrt(x[0]))));
}

START_TEST(an_offence_is_remembered)
{
    const function f = {"root", record_root_then_more, 1, 1, 0, {-1}, 0};
    recording r = record_outputs(&f, JET_TAPE_SERIES);
    double z;
    ck_assert(!run_values(&r, 1, f.centre, &z));
    ck_assert(!run_series(&r, 0, 1, f.centre, &z));
    recording_free(&r);
}
END_TEST

/* NaN is no offence: it goes on to the outputs, at every order. */
START_TEST(nan_goes_through)
{
    enum { DEGREE = 3 };
    const function *f = &operations[_i];
    double x[INPUTS_MAX * (DEGREE + 1)], z[DEGREE + 1];
    for (int i = 0; i < f->inputs * (DEGREE + 1); i++) x[i] = NAN;
    recording values = record_outputs(f, JET_TAPE_VALUES), series = record_outputs(f, JET_TAPE_SERIES);
    ck_assert(run_values(&values, 1, x, z));
    ck_assert(isnan(z[0]));
    ck_assert(run_series(&series, DEGREE, 1, x, z));
    for (int k = 0; k <= DEGREE; k++) ck_assert(isnan(z[k]));
    recording_free(&values);
    recording_free(&series);
}
END_TEST

Suite *domain_suite(void)
{
    Suite *suite = suite_create("domain");
    TCase *places_case = add_case(suite, "places");
    tcase_add_loop_test(places_case, sweeps_refuse, 0, PLACES);
    tcase_add_loop_test(places_case, sweeps_refuse_any_lane, 0, PLACES);
    tcase_add_loop_test(places_case, numbers_are_refused_at_once, 0, PLACES);
    TCase *sweeps = add_case(suite, "sweeps");
    tcase_add_loop_test(sweeps, any_member_is_refused, 0, 3);
    tcase_add_test(sweeps, an_offence_is_remembered);
    tcase_add_loop_test(sweeps, nan_goes_through, 0, operation_count);
    return suite;
}
