/* test_roots.c - Tests a^(-k/2), in the tape and in generated code, with each instruction set that the machine has. */
#include "emit.h"
#include "library.h"
#include "problems/statistics.h"
#include "record.h"
#include "suites.h"
#include "problems/thorough.h"

#include <dlfcn.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POWERS = 4, MOST_LANES = 11, SIZES = 9 };

static const int lanes[] = {MOST_LANES, SIZES, 4}; /* of generated code */

static bool has(const char *set)
{
#if defined(__x86_64__)
    if (strcmp(set, "avx2") == 0) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (strcmp(set, "avx512") == 0)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl");
#endif
    return strcmp(set, "base") == 0;
}

static const struct {
    const char *set, *flags; /* NULL: the tape */
} codes[] = {
    {"base", NULL},
    {"avx2", NULL},
    {"avx512", NULL},
    {"base", "-O2"},
    {"avx2", "-O2 -mavx2 -mfma"},
    {"avx512", "-O2 -mavx2 -mfma -mavx512f -mavx512dq -mavx512vl"},
};
enum { CODES = sizeof codes / sizeof *codes };

/* a^(-1/2), a^(-3/2), a^(-5/2), a^(-7/2). */
static recording powers[POWERS];
/* sqrt a + b^(-3/2): two operations with domains in one tape. */
static recording both;
static jet_sweeps own[POWERS + 1];
static library code;

static recording record_both(void)
{
    jet_graph *graph = jet_graph_create(2);
    jet z = jet_add(jet_sqrt(jet_graph_input(graph, 0)), jet_pow(jet_graph_input(graph, 1), -1.5));
    return record_close(graph, 1, &z, JET_TAPE_VALUES);
}

static void emit(jet_text *text)
{
    jet_emit_rule_source(text);
    for (int i = 0; i < POWERS; i++) {
        char name[16];
        snprintf(name, sizeof name, "V%d", i);
        const jet_emission_request wanted = {.name_prefix = name, .value_lane_counts = {lanes[0], lanes[1], lanes[2]}};
        jet_emit_tape(text, powers[i].tape, &wanted);
    }
    jet_emit_tape(text, both.tape, &(jet_emission_request){.name_prefix = "W", .value_lane_counts = {4, 8}});
    jet_text_append(
        text, "extern const jet_sweeps *const sweeps[];\n"
              "const jet_sweeps *const sweeps[] = {&V0_sweeps, &V1_sweeps, &V2_sweeps, &V3_sweeps, &W_sweeps};\n");
}

static bool begin(int i)
{
    jet_text text = {0};
    if (!has(codes[i].set)) return false;
    ck_assert_int_eq(setenv("TVI_ISA", codes[i].set, 1), 0);
    for (int k = 0; k < POWERS; k++)
        powers[k] = record_outputs(&(function){"pow", operation_named("pow"), 1, 1, -k - 0.5, {1}, 0}, JET_TAPE_VALUES);
    both = record_both();
    if (!codes[i].flags) return true;
    emit(&text);
    code = library_make(&text, codes[i].flags);
    const jet_sweeps *const *sweeps = dlsym(code.handle, "sweeps");
    for (int k = 0; k < POWERS; k++)
        powers[k].tape->sweeps = jet_merge_sweeps(&own[k], powers[k].tape->interpreter_sweeps, sweeps[k]);
    both.tape->sweeps = jet_merge_sweeps(&own[POWERS], both.tape->interpreter_sweeps, sweeps[POWERS]);
    return true;
}

static void end(int i)
{
    for (int k = 0; k < POWERS; k++) recording_free(&powers[k]);
    recording_free(&both);
    if (codes[i].flags) library_remove(&code);
    unsetenv("TVI_ISA");
}

/* The force of gravity is as exact as it should be in any width, and without a bias that would show in a sum of many.
 * The control is the exact force rounded to 0. Its errors have one sign, and their ratio is above 90. */
START_TEST(gravity_is_rounded_well)
{
    enum { ROUNDS = 2000 };
    const double most = 2.4; /* units in the last place, after a root, a product and a quotient */
    double a[MOST_LANES], z[MOST_LANES], worst = 0;
    sample errors = {0}, biased = {0};
    if (!begin(_i)) return;
    unsigned random = 1;
    for (int round = 0; round < ROUNDS; round++) {
        const int width = codes[_i].flags ? lanes[round % 3] : 1 + round % MOST_LANES;
        for (int i = 0; i < width; i++) {
            random = random * 1664525u + 1013904223u;
            a[i] = ldexp(1 + (random >> 8) * 0x1p-24, (int)(random % 600) - 300);
        }
        ck_assert(run_values(&powers[1], width, a, z));
        for (int i = 0; i < width; i++) {
            const long double exact = 1 / (a[i] * sqrtl(a[i]));
            const double error = (double)(z[i] / exact - 1) / DBL_EPSILON;
            worst = fmax(worst, fabs(error));
            sample_add(&errors, error);
            const double nearest = (double)exact;
            const double to_zero = nearest > exact ? nextafter(nearest, 0) : nearest;
            sample_add(&biased, (double)(to_zero / exact - 1) / DBL_EPSILON);
        }
    }
    ck_assert_double_le(worst, most);
    ck_assert_double_ge(worst, 0.29 * most); /* other samples have 0.44 or more */
    ck_assert_double_lt(sample_drift(&errors), NO_DRIFT);
    ck_assert_double_gt(sample_drift(&biased), NO_DRIFT);
    end(_i);
}
END_TEST

START_TEST(outside_is_refused)
{
    static const double outside[] = {0, -1, -INFINITY}, inside[] = {INFINITY, 1e300, NAN, 1};
    double z[4];
    if (!begin(_i)) return;
    for (int k = 0; k < POWERS; k++) {
        for (int i = 0; i < 3; i++)
            for (int at = 0; at < 4; at++) {
                double a[] = {1, 2, 3, 4};
                a[at] = outside[i];
                for (int width = 1; width <= 4; width++)
                    ck_assert(run_values(&powers[k], width, a, z) == (at >= width));
            }
        ck_assert(run_values(&powers[k], 4, inside, z));
        ck_assert(z[0] == 0 && isnan(z[2]) && (z[1] == 0) == (k > 0) && z[3] == 1);
    }
    end(_i);
}
END_TEST

/* Two operations in one tape: arguments outside of the domain of the one or the other, in any lane. */
START_TEST(outside_of_one_of_two_is_refused)
{
    enum { MOST = 8 };
    static const double outside[] = {0, -1, -INFINITY, NAN};
    double a[2 * MOST], z[MOST];
    if (!begin(_i)) return;
    for (int width = MOST / 2; width <= MOST; width += MOST / 2)
        for (int at = 0; at < 2 * width; at++)
            for (int i = 0; i < 4; i++) {
                for (int w = 0; w < 2 * width; w++) a[w] = 4;
                ck_assert(run_values(&both, width, a, z) && z[0] == 2.125);
                a[at] = outside[i];
                ck_assert(run_values(&both, width, a, z) == isnan(outside[i])); /* no offence */
            }
    end(_i);
}
END_TEST

/* Over all numbers: subnormal ones, and those whose powers overflow or vanish. */
START_TEST(inverse_roots_have_all_sizes)
{
    static const double a[SIZES] = {4.9e-324, 1e-310, DBL_MIN, 1e-200, 1e-80, 1e80, 1e200, DBL_MAX, INFINITY};
    double z[SIZES];
    if (!begin(_i)) return;
    for (int k = 0; k < POWERS; k++) {
        ck_assert(run_values(&powers[k], SIZES, a, z));
        for (int i = 0; i < SIZES; i++) {
            const double want = (double)powl(a[i], -k - 0.5L);
            if (isinf(want) || want == 0) ck_assert_double_eq(z[i], want);
            else ck_assert_double_eq_tol(z[i], want, 8 * DBL_EPSILON * want);
        }
    }
    end(_i);
}
END_TEST

Suite *roots_suite(void)
{
    Suite *suite = suite_create("roots");
    TCase *tests = add_case(suite, "inverse roots");
    tcase_add_loop_test(tests, gravity_is_rounded_well, 0, CODES);
    tcase_add_loop_test(tests, outside_is_refused, 0, CODES);
    tcase_add_loop_test(tests, outside_of_one_of_two_is_refused, 0, CODES);
    tcase_add_loop_test(tests, inverse_roots_have_all_sizes, 0, CODES);
    return suite;
}
