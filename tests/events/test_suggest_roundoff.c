/* test_suggest_roundoff.c - Tests suggested steps where the energy is 0, and where the roundoff of a large t is felt.
 */
#include "events.h"
#include "tvi.h"

#include <math.h>
#include <string.h>

/* A fall from rest, wherever V is 0: a parabola, which one step is exact for. */
static jet fall(const jet q[], jet t, void *ctx)
{
    (void)t;
    return jet_mul(9.8, jet_add(q[0], *(const double *)ctx));
}

START_TEST(zero_of_the_potential_is_free)
{
    const double up[] = {0, 1e-12, -1e-12, 1, 100, 1e6}, none = 0;
    for (size_t i = 0; i < sizeof up / sizeof *up; i++) {
        tvi_system *system;
        double h = 0, at = up[i];
        ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, fall, &at), TVI_OK);
        ck_assert_int_eq(tvi_suggest_step(system, NULL, 0, &none, &none, 0.9, 1e-9, &h), TVI_OK);
        ck_assert_msg(h == 0.9, "V + %g: h = %g", up[i], h);
        tvi_system_free(system);
    }
}
END_TEST

/* q'' = -q + cos(w t + phase). */
static jet spring(const jet q[], jet t, void *ctx)
{
    const double *drive = ctx;
    const jet phase = jet_add(jet_mul(drive[0], t), drive[1]);
    return jet_sub(jet_div(jet_sqr(q[0]), 2), jet_mul(q[0], jet_cos(phase)));
}

/* From t0, with the phase that makes the motion that from 0. */
static tvi_system *driven_spring(double w, double t0)
{
    const long double turn = 6.283185307179586476925286766559L;
    double drive[] = {w, -(double)remainderl((long double)w * t0, turn)};
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, spring, drive), TVI_OK);
    return system;
}

static double end_of_spring(const tvi_system *system, const tvi_options *options, double t0, double h)
{
    enum { DURATION = 100 };
    tvi_integrator *it;
    double t = t0, q = 1, p = 0.3;
    ck_assert_int_eq(tvi_integrator_create(&it, system, options), TVI_OK);
    ck_assert_int_eq(tvi_integrate_to(it, h, t0 + DURATION, &t, &q, &p, NULL, NULL), TVI_OK);
    tvi_integrator_free(it);
    return q;
}

/* The ways in which the advice is wrong: an error that the run does not keep, a refusal of one far above what the
 * roundoff of t makes, an error far below it that is served. */
static void assert_knows_roundoff(const tvi_options *options, double w, double t0, double asked, double right)
{
    const double q = 1, p = 0.3, roundoff = 2e-16 * t0;
    double h = 0;
    tvi_system *system = driven_spring(w, t0);
    const tvi_status status = tvi_suggest_step(system, options, t0, &q, &p, 100, asked, &h);
    if (status == TVI_OK) {
        const double error = fabs(end_of_spring(system, options, t0, h) - right);
        ck_assert_msg(error <= 10 * asked, "t = %g, %g: h = %g, %g", t0, asked, h, error);
        ck_assert_msg(asked > roundoff / 1000, "t = %g, %g: h = %g", t0, asked, h);
    } else {
        ck_assert_msg(asked < 100 * roundoff, "t = %g, %g: %s", t0, asked, tvi_last_error());
        ck_assert(status == TVI_EROUNDOFF || status == TVI_EINVAL);
        ck_assert(strstr(tvi_last_error(), "roundoff"));
    }
    tvi_system_free(system);
}

START_TEST(roundoff_of_the_time_is_known)
{
    static const struct {
        const char *name;
        int order;
    } methods[] = {{"galerkin", 16}, {"taylor", 18}, {"midpoint", 12}};
    static const double frequencies[] = {2.0943951023931953, 0.69};
    const double w = frequencies[_i % 2];
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(methods[_i / 2].name, methods[_i / 2].order, &options), TVI_OK);
    tvi_system *plain = driven_spring(w, 0);
    const double right = end_of_spring(plain, NULL, 0, 0.1);
    for (double t0 = 0; t0 < 1e15; t0 = t0 == 0 ? 8e6 : 10 * t0)
        for (int k = 2; k <= 10; k += 2) assert_knows_roundoff(&options, w, t0, pow(10, -k), right);
    tvi_system_free(plain);
}
END_TEST

Suite *suite_suggest_roundoff(void)
{
    Suite *suite = suite_create("suggested steps and roundoff");
    TCase *roundoff = tcase_create("roundoff");
    tcase_add_test(roundoff, zero_of_the_potential_is_free);
    tcase_add_loop_test(roundoff, roundoff_of_the_time_is_known, 0, 6);
    suite_add_tcase(suite, roundoff);
    return suite;
}
