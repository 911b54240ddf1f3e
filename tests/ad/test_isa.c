/* test_isa.c - instruction sets: TVI_ISA asks for one, and all give the same to roundoff. A machine that lacks one runs
 * the widest that it has in its place. */
#include "record.h"
#include "suites.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEGREE = 12, SHORT = DEGREE + 1, LANES = 11, EIGHT = 8 };

static const char *const sets[] = {"base", "avx2", "avx512"};
enum { SETS = sizeof sets / sizeof *sets };

/* What f gives in each kind of sweep. */
typedef struct {
    double values[OUTPUTS_MAX * LANES], eight[OUTPUTS_MAX * EIGHT], series[OUTPUTS_MAX * SHORT],
        tangents[OUTPUTS_MAX * SHORT], adjoints[INPUTS_MAX * SHORT];
} results;

static const jet_sweeps *run_with(const char *set, const function *f, results *r)
{
    static double x[INPUTS_MAX * SHORT], dx[INPUTS_MAX * SHORT], zbar[OUTPUTS_MAX * SHORT], lanes[INPUTS_MAX * LANES];
    ck_assert_int_eq(setenv("TVI_ISA", set, 1), 0);
    recording series = record_outputs(f, JET_TAPE_SERIES), values = record_outputs(f, JET_TAPE_VALUES);
    const jet_sweeps *used = series.tape->sweeps;
    dense_series(f, DEGREE, x);
    dense_direction(f, 0, DEGREE, dx);
    dense_direction(f, 1, DEGREE, zbar);
    for (int i = 0; i < f->inputs * LANES; i++) lanes[i] = f->centre[i / LANES] + 0.01 * (i % LANES);
    ck_assert(run_values(&values, LANES, lanes, r->values));
    for (int i = 0; i < f->inputs * EIGHT; i++) lanes[i] = f->centre[i / EIGHT] + 0.01 * (i % EIGHT);
    ck_assert(run_values(&values, EIGHT, lanes, r->eight));
    ck_assert(run_series(&series, DEGREE, 1, x, r->series));
    run_tangents(&series, DEGREE, 1, 1, x, dx, r->tangents);
    for (int i = 0; i < f->outputs * SHORT; i++) zbar[i] = 1.0 / (1 + i % 7);
    run_adjoints(&series, DEGREE, x, zbar, r->adjoints);
    recording_free(&series);
    recording_free(&values);
    unsetenv("TVI_ISA");
    return used;
}

static void check_values(int count, const double got[], const double want[])
{
    for (int i = 0; i < count; i++) ck_assert_double_eq_tol(got[i], want[i], 1e-14 * (1 + fabs(want[i])));
}

START_TEST(instruction_sets_agree)
{
    const function *f = any_function(_i);
    static results base, other;
    run_with("base", f, &base);
    for (int set = 1; set < SETS; set++) {
        run_with(sets[set], f, &other);
        for (int i = 0; i < f->outputs; i++) {
            check_values(LANES, other.values + i * LANES, base.values + i * LANES);
            check_values(EIGHT, other.eight + i * EIGHT, base.eight + i * EIGHT);
            check_values(EIGHT, base.eight + i * EIGHT, base.values + i * LANES);
            check_series(f->name, DEGREE, other.series + i * SHORT, base.series + i * SHORT, f->bound);
            check_series(f->name, DEGREE, other.tangents + i * SHORT, base.tangents + i * SHORT, 4 * f->bound);
        }
        for (int i = 0; i < f->inputs; i++)
            check_series(f->name, DEGREE, other.adjoints + i * SHORT, base.adjoints + i * SHORT, 20 * f->bound);
    }
}
END_TEST

static bool has_avx512(void)
{
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
#else
    return false;
#endif
}

/* a^(-3/2), the force of gravity, is rounded once where there is AVX-512, else three times: in any width, and without a
 * bias that would show in a sum of many. */
START_TEST(gravity_is_rounded_well)
{
    enum { WIDTH = 11, ROUNDS = 2000 };
    const double most = strcmp(sets[_i], "avx512") == 0 && has_avx512() ? 0.502 : 2.4;
    double a[WIDTH], z[WIDTH], bias = 0, worst = 0;
    ck_assert_int_eq(setenv("TVI_ISA", sets[_i], 1), 0);
    recording r = record_outputs(&(function){"pow", operation_named("pow"), 1, 1, -1.5, {1}, 0}, JET_TAPE_VALUES);
    unsetenv("TVI_ISA");
    unsigned random = 1;
    for (int round = 0; round < ROUNDS; round++) {
        const int width = 1 + round % WIDTH;
        for (int i = 0; i < width; i++) {
            random = random * 1664525u + 1013904223u;
            a[i] = ldexp(1 + (random >> 8) * 0x1p-24, (int)(random % 600) - 300);
        }
        ck_assert(run_values(&r, width, a, z));
        for (int i = 0; i < width; i++) {
            const long double exact = 1 / (a[i] * sqrtl(a[i]));
            const double error = (double)(z[i] / exact - 1) / DBL_EPSILON;
            worst = fmax(worst, fabs(error));
            bias += error / (ROUNDS * (WIDTH + 1) / 2);
        }
    }
    ck_assert_double_le(worst, most);
    ck_assert_double_ge(worst, 0.45 * most); /* so far it goes */
    ck_assert_double_le(fabs(bias), 0.02);
    const double outside[] = {1, 0, -1, -INFINITY}, inside[] = {INFINITY, 1e300, NAN};
    for (int i = 1; i < 4; i++) ck_assert(!run_values(&r, 1, outside + i, z));
    ck_assert(!run_values(&r, 4, outside, z));
    ck_assert(run_values(&r, 3, inside, z));
    ck_assert(z[0] == 0 && z[1] == 0 && isnan(z[2]));
    recording_free(&r);
}
END_TEST

/* Over all numbers: subnormal ones, and those whose powers overflow or vanish. */
START_TEST(inverse_roots_have_all_sizes)
{
    static const double a[] = {4.9e-324, 1e-310, DBL_MIN, 1e-200, 1e-80, 1e80, 1e200, DBL_MAX, INFINITY};
    enum { WIDTH = sizeof a / sizeof *a };
    ck_assert_int_eq(setenv("TVI_ISA", sets[_i], 1), 0);
    for (int k = 1; k <= 7; k += 2) {
        double z[WIDTH];
        recording r =
            record_outputs(&(function){"pow", operation_named("pow"), 1, 1, -k / 2.0, {1}, 0}, JET_TAPE_VALUES);
        ck_assert(run_values(&r, WIDTH, a, z));
        for (int i = 0; i < WIDTH; i++) {
            const double want = (double)powl(a[i], -k / 2.0L);
            if (isinf(want) || want == 0) ck_assert_double_eq(z[i], want);
            else ck_assert_double_eq_tol(z[i], want, 8 * DBL_EPSILON * want);
        }
        recording_free(&r);
    }
    unsetenv("TVI_ISA");
}
END_TEST

/* Base is another set than what a machine with wider vectors takes by itself; less than asked for is taken, never
 * more. */
START_TEST(environment_chooses)
{
    static results r;
    const function *f = any_function(0);
    const jet_sweeps *base = run_with("base", f, &r), *avx2 = run_with("avx2", f, &r), *widest = run_with("", f, &r);
    const jet_sweeps *by_itself = jet_sweeps_choose();
    ck_assert_ptr_eq(by_itself, widest);
#if defined(__x86_64__)
    ck_assert((base != avx2) == (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")));
    ck_assert((avx2 != widest) == (base != avx2 && has_avx512()));
#else
    ck_assert(base == avx2 && avx2 == widest);
#endif
}
END_TEST

Suite *isa_suite(void)
{
    Suite *suite = suite_create("isa");
    TCase *tests = add_case(suite, "instruction sets");
    tcase_add_loop_test(tests, instruction_sets_agree, 0, operation_count + composition_count);
    tcase_add_loop_test(tests, gravity_is_rounded_well, 0, SETS);
    tcase_add_loop_test(tests, inverse_roots_have_all_sizes, 0, SETS);
    tcase_add_test(tests, environment_chooses);
    return suite;
}
