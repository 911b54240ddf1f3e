/* test_isa.c - Tests the choice of instruction sets by TVI_ISA. All sets give the same results to roundoff. A machine
 * that lacks one runs the widest that it has in its place. */
#include "record.h"
#include "suites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEGREE = 12, SHORT = DEGREE + 1, LANES = 11, EIGHT = 8 };

static const char *const sets[] = {"base", "avx2", "avx512"};
enum { SETS = sizeof sets / sizeof *sets };

/* The results of f in each kind of sweep. */
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

#if defined(__x86_64__)
static bool has_avx512(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}
#endif

/* Base is another set than what a machine with wider vectors takes by itself; less than asked for is taken, never
 * more. */
START_TEST(environment_chooses)
{
    static results r;
    const function *f = any_function(0);
    const jet_sweeps *base = run_with("base", f, &r), *avx2 = run_with("avx2", f, &r), *widest = run_with("", f, &r);
    const jet_sweeps *by_itself = jet_choose_sweeps_for_processor();
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
    tcase_add_test(tests, environment_chooses);
    return suite;
}
