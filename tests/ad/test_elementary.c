/* test_elementary.c - Tests elementary functions in lanes, with each instruction set: within an ulp of the exact
 * values, what they have been at the ends of their ranges, and each number as if it were alone. */
#include "record.h"
#include "suites.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POW(name, c)                                                                                                   \
    static long double name(long double x) { return powl(x, c); }
POW(pow_third, 1.0 / 3)
POW(pow_small, -0.1)
POW(pow_large, -17)
POW(pow_3_4, 0.75)
POW(pow_1_4, 0.25)
POW(pow_7_4, -1.75)
POW(pow_root_4, -0.25)
POW(pow_root_3_4, -0.75)
POW(pow_5_4, -1.25)
POW(pow_1_2, -0.5)
POW(pow_3_2, -1.5)
POW(pow_5_2, -2.5)
POW(pow_7_2, -3.5)

/* A function and what it should be; where it is tried at random, and how many ulps it may be off. */
typedef struct {
    const char *name;
    long double (*exact)(long double);
    double c, least, most, ulps;
} elementary;

static const elementary functions[] = {
    {"sin", sinl, 0, -14, 14, 1},
    {"sin", sinl, 0, -1e3, 1e3, 1},
    {"cos", cosl, 0, -14, 14, 1},
    {"cos", cosl, 0, -1e3, 1e3, 1},
    {"tan", tanl, 0, -14, 14, 1},
    {"tan", tanl, 0, -1e3, 1e3, 1},
    {"exp", expl, 0, -690, 690, 1},
    {"exp", expl, 0, -1, 1, 1},
    {"log", logl, 0, 1e-6, 3, 1},
    {"log", logl, 0, 1e-300, 1e300, 1},
    {"asin", asinl, 0, -1, 1, 1},
    {"acos", acosl, 0, -1, 1, 1},
    {"atan", atanl, 0, -3, 3, 1},
    {"atan", atanl, 0, -1e6, 1e6, 1},
    {"sinh", sinhl, 0, -3, 3, 1},
    {"sinh", sinhl, 0, -690, 690, 1},
    {"cosh", coshl, 0, -3, 3, 1},
    {"cosh", coshl, 0, -690, 690, 1},
    {"tanh", tanhl, 0, -3, 3, 1},
    {"pow", pow_third, 1.0 / 3, 1e-3, 1e3, 1},
    {"pow", pow_small, -0.1, 1e-300, 1e300, 1},
    {"pow", pow_large, -17, 1e-9, 1e9, 1},
    {"pow", pow_1_4, 0.25, 1e-3, 1e3, 1.5},
    {"pow", pow_3_4, 0.75, 1e-3, 1e3, 2.5},
    {"pow", pow_7_4, -1.75, 1e-3, 1e3, 5},
    {"pow", pow_root_4, -0.25, 1e-320, 1e308, 2},
    {"pow", pow_root_3_4, -0.75, 1e-300, 1e300, 3.5},
    {"pow", pow_5_4, -1.25, 1e-200, 1e200, 3.5},
    {"pow", pow_1_2, -0.5, 1e-320, 1e308, 1.5},
    {"pow", pow_3_2, -1.5, 1e-60, 1e60, 2.5},
    {"pow", pow_5_2, -2.5, 1e-60, 1e60, 3},
    {"pow", pow_7_2, -3.5, 1e-60, 1e60, 3.5},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions, SETS = 3, WIDTH = 11, ROUNDS = 3000 };
static const char *const sets[SETS] = {"base", "avx2", "avx512"};

static recording record(const elementary *f, int set)
{
    record_fn *fn = operation_named(f->name);
    ck_assert_int_eq(setenv("TVI_ISA", sets[set], 1), 0);
    const recording r = record_outputs(&(function){f->name, fn, 1, 1, f->c, {0.5}, 0}, JET_TAPE_VALUES);
    unsetenv("TVI_ISA");
    return r;
}

/* In units of the last place of the exact value; 0 where both are the same infinity, or none is a number. */
static double ulps(double got, long double exact)
{
    const double want = (double)exact;
    if (isnan(got) && isnan(want)) return 0;
    if (got == want && (want == 0 || !isfinite(want))) return 0;
    if (!isfinite(want) || !isfinite(got)) return INFINITY;
    const int exponent = want == 0 ? -1073 : ilogb(want);
    return (double)fabsl((got - exact) / ldexpl(1, (exponent < -1022 ? -1022 : exponent) - 52));
}

static double random_number(unsigned *random, const elementary *f)
{
    *random = *random * 1664525u + 1013904223u;
    const double part = (*random >> 8) * 0x1p-24;
    if (f->least > 0) return exp(log(f->least) + (log(f->most) - log(f->least)) * part);
    return f->least + (f->most - f->least) * part;
}

/* The error bound of libm in units of an ulp, for glibc. */
#ifdef JET_SLEEF
static const double MOST_ULPS = 1;
#else
static const double MOST_ULPS = 2.5;
#endif

START_TEST(is_within_an_ulp)
{
    const elementary *f = &functions[_i / SETS];
    recording r = record(f, _i % SETS);
    double a[WIDTH], z[WIDTH], worst = 0;
    unsigned random = 1;
    for (int round = 0; round < ROUNDS; round++) {
        const int width = 1 + round % WIDTH;
        for (int i = 0; i < width; i++) a[i] = random_number(&random, f);
        ck_assert(run_values(&r, width, a, z));
        for (int i = 0; i < width; i++) worst = fmax(worst, ulps(z[i], f->exact(a[i])));
    }
    ck_assert_msg(worst <= fmax(f->ulps, MOST_ULPS), "%s, %s: %g ulps", f->name, sets[_i % SETS], worst);
    ck_assert_double_ge(worst, 0.45);
    recording_free(&r);
}
END_TEST

/* Around and beyond where one way to compute ends and another one begins. */
static const double edges[] = {0.25,  -0.75,  0,       -0.0,     DBL_TRUE_MIN, -1e-310,   1e-200, -1e-17,
                               1e-9,  0.9999, 14.9999, -15,      15.0001,      100,       -1e4,   9e13,
                               -1e14, 3e22,   1e300,   -699,     700.5,        709.5,     -709.9, 710.3,
                               -745,  1e5,    DBL_MAX, -DBL_MAX, INFINITY,     -INFINITY, NAN};
enum { EDGES = sizeof edges / sizeof *edges };

/* Whatever its neighbours are. The mathematical library is at most two ulps off. */
START_TEST(edges_are_as_they_were)
{
    const elementary *f = &functions[_i / SETS];
    recording r = record(f, _i % SETS);
    int inside = 0;
    for (int e = 0; e < EDGES; e++) {
        double alone, many[WIDTH], a[WIDTH];
        if (!run_values(&r, 1, &edges[e], &alone)) continue;
        inside++;
        ck_assert_msg(ulps(alone, f->exact(edges[e])) <= fmax(f->ulps, 2), "%s(%g): %g, not %Lg", f->name, edges[e],
                      alone, f->exact(edges[e]));
        for (int shift = 0; shift < EDGES; shift++) {
            for (int i = 0; i < WIDTH; i++) a[i] = edges[(e + i * (shift + 1)) % EDGES];
            const int at = shift % WIDTH;
            a[at] = edges[e];
            (void)run_values(&r, WIDTH, a, many); /* those outside may be among the others */
            ck_assert_msg(memcmp(&many[at], &alone, sizeof alone) == 0 || isnan(alone),
                          "%s(%g) in lane %d: %a, alone %a", f->name, edges[e], at, many[at], alone);
        }
    }
    ck_assert_int_ge(inside, 8);
    recording_free(&r);
}
END_TEST

Suite *elementary_suite(void)
{
    Suite *suite = suite_create("elementary");
    TCase *tests = add_case(suite, "lanes");
    tcase_add_loop_test(tests, is_within_an_ulp, 0, FUNCTIONS * SETS);
    tcase_add_loop_test(tests, edges_are_as_they_were, 0, FUNCTIONS * SETS);
    return suite;
}
