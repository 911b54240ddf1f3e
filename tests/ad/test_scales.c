/* test_scales.c - Tests that the series of atan2 and hypot do not depend on the scale of their arguments. */
#include "record.h"
#include "suites.h"

#include <math.h>
#include <string.h>

/* atan2(s a, s b) and hypot(s a, s b) / s do not depend on s: series, tangents and adjoints have the same bits for
 * every power of 2 whose multiples of the inputs are normal numbers, though the squares overflow or underflow. */
static const int exponents[] = {-960, -600, -500, 500, 600, 1000};
enum { DEGREE = 6, LENGTH = DEGREE + 1, BOTH = 2 * LENGTH };

typedef struct {
    double z[LENGTH], dz[LENGTH], abar[BOTH];
} scaled_series;

static scaled_series series_at_scale(const function *f, int exponent)
{
    const double s = ldexp(1, exponent), unit = strcmp(f->name, "hypot") == 0 ? s : 1;
    double a[BOTH], da[BOTH], zbar[LENGTH];
    scaled_series out = {0};
    recording r = record_outputs(f, JET_TAPE_SERIES);
    dense_series(f, DEGREE, a);
    dense_direction(f, 1, DEGREE, da);
    for (int i = 0; i < BOTH; i++) a[i] *= s, da[i] *= s;
    for (int k = 0; k < LENGTH; k++) zbar[k] = 1.0 / (k + 1);
    ck_assert(run_series(&r, DEGREE, 1, a, out.z));
    run_tangents(&r, DEGREE, 1, 1, a, da, out.dz);
    run_adjoints(&r, DEGREE, a, zbar, out.abar);
    for (int k = 0; k < LENGTH; k++) out.z[k] /= unit, out.dz[k] /= unit;
    for (int i = 0; i < BOTH; i++) out.abar[i] *= s / unit;
    recording_free(&r);
    return out;
}

START_TEST(polar_functions_at_every_scale)
{
    const function *f = any_function(_i);
    if (strcmp(f->name, "atan2") != 0 && strcmp(f->name, "hypot") != 0) return;
    const scaled_series right = series_at_scale(f, 0);
    for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
        const scaled_series got = series_at_scale(f, exponents[i]);
        ck_assert_msg(memcmp(got.z, right.z, sizeof got.z) == 0, "%s, 2^%d: series", f->name, exponents[i]);
        ck_assert_msg(memcmp(got.dz, right.dz, sizeof got.dz) == 0, "%s, 2^%d: tangents", f->name, exponents[i]);
        ck_assert_msg(memcmp(got.abar, right.abar, sizeof got.abar) == 0, "%s, 2^%d: adjoints", f->name, exponents[i]);
    }
}
END_TEST

Suite *scales_suite(void)
{
    Suite *suite = suite_create("scales");
    TCase *scales = add_case(suite, "scales");
    tcase_add_loop_test(scales, polar_functions_at_every_scale, 0, operation_count);
    return suite;
}
