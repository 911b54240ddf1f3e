/* test_series.c - Tests Taylor series of every operation to degree 40: against Cauchy's integral in quadruple
 * precision, against exact integers and closed forms, in several lanes, and far from 1. */
#include "quad_series.h"
#include "record.h"
#include "suites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double x[INPUTS_MAX * ORDERS], z[OUTPUTS_MAX * ORDERS], want[OUTPUTS_MAX * ORDERS];

/* ---- Quadruple precision ----------------------------------------------------------------------------------------- */

#ifndef TESTS_WITHOUT_QUAD

/* All coefficients of f along a dense series, by two routes. */
static void check_against_cauchy(const function *f)
{
    recording r = record_outputs(f, JET_TAPE_SERIES);
    dense_series(f, DEGREE_MAX, x);
    ck_assert(run_series(&r, DEGREE_MAX, 1, x, z));
    quad_series(f, DEGREE_MAX, 1, x, want);
    for (int i = 0; i < f->outputs; i++) check_series(f->name, DEGREE_MAX, z + i * ORDERS, want + i * ORDERS, f->bound);
    recording_free(&r);
}

START_TEST(operation_agrees_with_cauchy) { check_against_cauchy(&operations[_i]); }
END_TEST

START_TEST(composition_agrees_with_cauchy) { check_against_cauchy(&compositions[_i]); }
END_TEST

/* In long double a value is the one in quadruple precision, but for its last rounding; in double some are not. */
static int values_that_differ(const function *f)
{
    recording r = record_outputs(f, JET_TAPE_VALUES);
    const size_t slots = (size_t)r.tape->slot_count;
    double *block = numbers(slots);
    long double *precise = malloc(slots * sizeof *precise);
    int differ = 0;
    dense_series(f, 0, x);
    ck_assert(precise && run_values(&r, 1, x, z));
    quad_series(f, 0, 1, x, want);
    jet_tape_write_constants(r.tape, block, 1, 1);
    for (int i = 0; i < f->inputs; i++) precise[i] = x[i];
    jet_sweep_long_double_values(r.tape, block, precise);
    for (int i = 0; i < f->outputs; i++) {
        const long double value = precise[r.tape->output_slot[i]],
                          unit = nextafter(fabs(want[i]), INFINITY) - fabs(want[i]);
        ck_assert_msg(fabsl(value - want[i]) <= 0.51L * unit, "%s", f->name);
        differ += z[i] != want[i];
    }
    free(precise);
    free(block);
    recording_free(&r);
    return differ;
}

START_TEST(values_in_long_double)
{
    int differ = 0;
    for (int i = 0; i < operation_count + composition_count; i++) differ += values_that_differ(any_function(i));
    ck_assert_int_ge(differ, 5);
}
END_TEST

/* Arguments far from 1 or close to a singularity at the distance `size`. */
static const struct {
    const char *name;
    double c, centre, size;
} far_out[] = {
    {"asin", 0, 1 - 1e-9, 1e-9},  {"asin", 0, -1 + 1e-9, 1e-9},  {"acos", 0, 1 - 1e-9, 1e-9},
    {"acos", 0, -1 + 1e-9, 1e-9}, {"atan", 0, 1e4, 1e4},         {"log", 0, 1e-200, 1e-200},
    {"log", 0, 1e200, 1e200},     {"sqrt", 0, 1e-200, 1e-200},   {"pow", 1.5, 1e-100, 1e-100},
    {"pow", -2.5, 1e100, 1e100},  {"pow", -0.7, 1e100, 1e100},   {"exp", 0, -300, 1},
    {"exp", 0, 300, 1},           {"sinh", 0, 300, 1},           {"cosh", 0, -300, 1},
    {"sin", 0, 1e6, 1},           {"tan", 0, 1.5707963, 2.6e-8},
};

/* Orders from 1 on keep their relative accuracy: bound 1e-13, relative to the coefficients. */
START_TEST(derivatives_keep_accuracy_far_out)
{
    function f = {"", NULL, 1, 1, far_out[_i].c, {0}, 1e-13};
    f.name = far_out[_i].name;
    f.record = operation_named(f.name);
    dense_series(&f, DEGREE_MAX, x);
    for (int k = 0; k <= DEGREE_MAX; k++) x[k] *= far_out[_i].size;
    x[0] = far_out[_i].centre;
    recording r = record_outputs(&f, JET_TAPE_SERIES);
    ck_assert(run_series(&r, DEGREE_MAX, 1, x, z));
    quad_series(&f, DEGREE_MAX, 1, x, want);
    ck_assert_double_le(fabs(z[0] - want[0]), 1e-15 * fabs(want[0]));
    check_series(f.name, DEGREE_MAX - 1, z + 1, want + 1, f.bound);
    recording_free(&r);
}
END_TEST

#endif

/* ---- Exact integers ---------------------------------------------------------------------------------------------- */

static double ones(int k) { return k >= 0; }
static double counting(int k) { return k + 1; }
static double triangle(int k) { return (k + 1) * (k + 2) / 2; }
static double tetrahedron(int k) { return (k + 1) * (k + 2) * (k + 3) / 6; }
static double only_one(int k) { return k == 0; }
static double one_minus_s(int k) { return (k == 0) - (k == 1); }
static double one_minus_4s(int k) { return (k == 0) - 4 * (k == 1); }
static double golden(int k) { return (k == 0) - (k == 1 || k == 2); } /* 1 - s - s^2 */
static double mixed(int k) { return 3 * ones(k) - counting(k) / 4 + 0.5 * only_one(k); }

static double fibonacci(int k)
{
    double last = 0, now = 1;
    for (; k > 0; k--) {
        const double next = last + now;
        last = now;
        now = next;
    }
    return now;
}

/* sqrt(1 - 4 s) = 1 - 2 s sum_k C_k s^k with the numbers of Catalan, C_{k+1} = 2 (2k+1) C_k / (k+2). */
static double catalan_root(int k)
{
    if (k == 0) return 1;
    double catalan = 1;
    for (int i = 0; i < k - 1; i++) catalan = catalan * (2 * (2 * i + 1)) / (i + 2);
    return -2 * catalan;
}

/* Series of integers; every intermediate number of the recurrences is one below 2^53 to degree 30. */
static const struct {
    const char *name;
    double c;
    double (*a)(int k), (*b)(int k), (*want)(int k);
} integers[] = {
    {"add", 0, ones, ones, NULL},
    {"linear", 0, ones, counting, mixed},
    {"mul", 0, ones, ones, counting},
    {"mul", 0, ones, counting, triangle},
    {"mul", 0, counting, one_minus_s, ones},
    {"sqr", 0, ones, NULL, counting},
    {"sqr", 0, counting, NULL, tetrahedron},
    {"div", 0, only_one, golden, fibonacci},
    {"div", 0, ones, one_minus_s, counting},
    {"div", 0, tetrahedron, counting, counting},
    {"sqrt", 0, one_minus_4s, NULL, catalan_root},
    {"sqrt", 0, counting, NULL, ones},
    {"pow", -1, golden, NULL, fibonacci},
    {"pow", 3, ones, NULL, triangle},
    {"pow", 4, ones, NULL, tetrahedron},
    {"pow", -2, one_minus_s, NULL, counting},
    {"pow", -3, one_minus_s, NULL, triangle},
    {"pow", 1.5, counting, NULL, triangle},
};

START_TEST(integers_are_exact)
{
    enum { DEGREE = 30 };
    function f = {integers[_i].name, operation_named(integers[_i].name), 2, 1, integers[_i].c, {0}, 0};
    for (int k = 0; k <= DEGREE; k++) {
        x[k] = integers[_i].a(k);
        x[DEGREE + 1 + k] = integers[_i].b ? integers[_i].b(k) : NAN;
        want[k] = integers[_i].want ? integers[_i].want(k) : 2;
    }
    recording r = record_outputs(&f, JET_TAPE_SERIES);
    ck_assert(run_series(&r, DEGREE, 1, x, z));
    for (int k = 0; k <= DEGREE; k++) ck_assert_double_eq(z[k], want[k]);
    recording_free(&r);
}
END_TEST

/* ---- Closed forms at a = a_0 + s --------------------------------------------------------------------------------- */

static double factorial(int k) { return tgamma(k + 1.0); }

static double exp_form(double c, double a, int k) { return (void)c, exp(a) / factorial(k); }
static double log_form(double c, double a, int k) { return (void)c, k == 0 ? log(a) : -pow(-a, -k) / k; }
static double sinh_form(double c, double a, int k) { return (void)c, (k % 2 ? cosh(a) : sinh(a)) / factorial(k); }
static double cosh_form(double c, double a, int k) { return (void)c, (k % 2 ? sinh(a) : cosh(a)) / factorial(k); }

static double sin_form(double c, double a, int k)
{
    const double turned[] = {sin(a), cos(a), -sin(a), -cos(a)};
    return (void)c, turned[k % 4] / factorial(k);
}

static double cos_form(double c, double a, int k)
{
    const double turned[] = {cos(a), -sin(a), -cos(a), sin(a)};
    return (void)c, turned[k % 4] / factorial(k);
}

/* binomial(c, k) a^(c-k). */
static double pow_form(double c, double a, int k)
{
    double binomial = 1;
    for (int i = 0; i < k; i++) binomial = binomial * (c - i) / (i + 1);
    return binomial == 0 ? 0 : binomial * pow(a, c - k);
}

static double sqrt_form(double c, double a, int k) { return (void)c, pow_form(0.5, a, k); }

/* (-1)^(k-1) sin(k t) sin(t)^k / k,  tan t = 1 / a. */
static double atan_form(double c, double a, int k)
{
    (void)c;
    if (k == 0) return atan(a);
    if (a == 0) return k % 2 ? (k % 4 == 1 ? 1.0 : -1.0) / k : 0;
    const double t = atan(1 / a);
    return (k % 2 ? 1 : -1) * sin(k * t) * pow(sin(t), k) / k;
}

/* At 0: (2m)! / (4^m m!^2 (2m+1)),  k = 2m + 1. */
static double asin_form(double c, double a, int k)
{
    (void)c, (void)a;
    if (k % 2 == 0) return 0;
    double ratio = 1;
    for (int i = 1; i <= k / 2; i++) ratio = ratio * (2 * i - 1) / (2 * i);
    return ratio / k;
}

static double acos_form(double c, double a, int k) { return k == 0 ? acos(-1) / 2 : -asin_form(c, a, k); }

/* At 0: the tangent numbers T_n / (2n-1)!, k = 2n - 1, by additions of positive numbers alone (Brent and Harvey, Fast
 * computation of Bernoulli, tangent and secant numbers, algorithm TangentNumbers). */
static double tan_form(double c, double a, int k)
{
    (void)c, (void)a;
    double tangent[ORDERS] = {0, 1};
    const int n = (k + 1) / 2;
    if (k % 2 == 0) return 0;
    for (int i = 2; i <= n; i++) tangent[i] = (i - 1) * tangent[i - 1];
    for (int i = 2; i <= n; i++)
        for (int j = i; j <= n; j++) tangent[j] = (j - i) * tangent[j - 1] + (j - i + 2) * tangent[j];
    return tangent[n] / factorial(k);
}

/* tanh x = 1 + 2 sum_n (-1)^n e^(-2nx), x > 0; the terms fall from n = 1 on at x = 15. At 0 see tan. */
static double tanh_form(double c, double a, int k)
{
    if (a == 0) return (k % 4 == 3 ? -1 : 1) * tan_form(c, a, k);
    if (a < 0) return (k % 2 ? 1 : -1) * tanh_form(c, -a, k);
    double sum = 0;
    for (int n = 1; n < 20; n++) sum += (n % 2 ? -2 : 2) * pow(-2 * n, k) * exp(-2 * n * a);
    return (sum + (k == 0)) / factorial(k);
}

typedef double closed_form(double c, double a, int k);

static const struct {
    const char *name;
    double c, centre;
    closed_form *form;
} closed_forms[] = {
    {"exp", 0, 0, exp_form},      {"exp", 0, 2.5, exp_form},     {"log", 0, 1, log_form},
    {"log", 0, 0.4, log_form},    {"sin", 0, 0, sin_form},       {"sin", 0, 2.2, sin_form},
    {"cos", 0, 0, cos_form},      {"cos", 0, 2.2, cos_form},     {"sinh", 0, 0, sinh_form},
    {"sinh", 0, -1.5, sinh_form}, {"cosh", 0, 0, cosh_form},     {"cosh", 0, -1.5, cosh_form},
    {"sqrt", 0, 1, sqrt_form},    {"sqrt", 0, 3, sqrt_form},     {"pow", -1, -2, pow_form},
    {"pow", 1.5, 1, pow_form},    {"pow", -2.5, 0.3, pow_form},  {"pow", 1.0 / 3, 2, pow_form},
    {"pow", -4, -1.5, pow_form},  {"pow", 7, 2, pow_form},       {"pow", 6, 0, pow_form},
    {"pow", 31.3, 5, pow_form},   {"pow", -2001, 0.9, pow_form}, {"atan", 0, 0, atan_form},
    {"atan", 0, 2, atan_form},    {"atan", 0, -0.7, atan_form},  {"asin", 0, 0, asin_form},
    {"acos", 0, 0, acos_form},    {"tan", 0, 0, tan_form},       {"tanh", 0, 0, tanh_form},
    {"tanh", 0, 15, tanh_form},   {"tanh", 0, -15, tanh_form},   {"tanh", 0, 300, tanh_form},
};

START_TEST(closed_form_is_met)
{
    function f = {closed_forms[_i].name, operation_named(closed_forms[_i].name), 1, 1, closed_forms[_i].c, {0}, 1e-13};
    memset(x, 0, sizeof x);
    x[0] = closed_forms[_i].centre;
    x[1] = 1;
    for (int k = 0; k <= DEGREE_MAX; k++) want[k] = closed_forms[_i].form(f.c, x[0], k);
    recording r = record_outputs(&f, JET_TAPE_SERIES);
    ck_assert(run_series(&r, DEGREE_MAX, 1, x, z));
    ck_assert_double_le(fabs(z[0] - want[0]), 4e-16 * fabs(want[0]));
    check_series(f.name, DEGREE_MAX - 1, z + 1, want + 1, f.bound);
    recording_free(&r);
}
END_TEST

/* ---- Values and lanes -------------------------------------------------------------------------------------------- */

/* The tape of values gives order 0 of the tape of series, to the last bit. */
START_TEST(values_are_order_zero)
{
    const function *f = any_function(_i);
    recording values = record_outputs(f, JET_TAPE_VALUES), series = record_outputs(f, JET_TAPE_SERIES);
    ck_assert(run_values(&values, 1, f->centre, want));
    ck_assert(run_series(&series, 0, 1, f->centre, z));
    ck_assert_mem_eq(z, want, (size_t)f->outputs * sizeof *z);
    recording_free(&values);
    recording_free(&series);
}
END_TEST

/* Another centre and another series for each lane. */
static void lane_series(const function *f, int degree, int lane)
{
    dense_direction(f, lane, degree, x);
    for (int i = 0; i < f->inputs * (degree + 1); i++) x[i] *= 0.2;
    for (int i = 0; i < f->inputs; i++) x[i * (degree + 1)] += f->centre[i];
}

/* Each of several lanes gives what it gives alone, to roundoff: multiply-adds may be contracted in one block of lanes
 * and not in another. */
static void check_lanes(const function *f, const recording *r, int degree, int lanes)
{
    double *all_x = numbers((size_t)(f->inputs * (degree + 1) * lanes));
    double *all_z = numbers((size_t)(f->outputs * (degree + 1) * lanes));
    for (int lane = 0; lane < lanes; lane++) {
        lane_series(f, degree, lane);
        set_lane(f->inputs, degree, lanes, lane, x, all_x);
    }
    ck_assert(run_series(r, degree, lanes, all_x, all_z));
    for (int lane = 0; lane < lanes; lane++) {
        lane_series(f, degree, lane);
        ck_assert(run_series(r, degree, 1, x, want));
        get_lane(f->outputs, degree, lanes, lane, all_z, z);
        for (int i = 0; i < f->outputs; i++)
            check_series(f->name, degree, z + i * (degree + 1), want + i * (degree + 1), f->bound);
    }
    free(all_x);
    free(all_z);
}

START_TEST(lanes_equal_single_runs)
{
    static const int lanes[] = {2, 3, 7, 8, 9, 11, 16, 21, 35};
    const function *f = any_function(_i);
    recording r = record_outputs(f, JET_TAPE_SERIES);
    for (size_t i = 0; i < sizeof lanes / sizeof lanes[0]; i++) check_lanes(f, &r, 9, lanes[i]);
    recording_free(&r);
}
END_TEST

/* ---- The suite --------------------------------------------------------------------------------------------------- */

#define COUNT(table) ((int)(sizeof table / sizeof table[0]))

Suite *series_suite(void)
{
    Suite *suite = suite_create("series");
    const int functions = operation_count + composition_count;
    TCase *exact = add_case(suite, "exact");
    tcase_add_loop_test(exact, integers_are_exact, 0, COUNT(integers));
    tcase_add_loop_test(exact, closed_form_is_met, 0, COUNT(closed_forms));
    TCase *lanes = add_case(suite, "lanes");
    tcase_add_loop_test(lanes, values_are_order_zero, 0, functions);
    tcase_add_loop_test(lanes, lanes_equal_single_runs, 0, functions);
#ifndef TESTS_WITHOUT_QUAD
    TCase *quad = add_case(suite, "quad");
    tcase_add_loop_test(quad, operation_agrees_with_cauchy, 0, operation_count);
    tcase_add_loop_test(quad, composition_agrees_with_cauchy, 0, composition_count);
    tcase_add_test(quad, values_in_long_double);
    tcase_add_loop_test(quad, derivatives_keep_accuracy_far_out, 0, COUNT(far_out));
#endif
    return suite;
}
