/* test_tolerance_zeros.c - Tests runs to a tolerance of series that have zeros before their last terms: powers of the
 * time, and a force that is constant to roundoff. */
#include "events.h"
#include "tolerance.h"

#include <math.h>

static const double tolerances[] = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14};
enum { TOLERANCES = sizeof tolerances / sizeof *tolerances, POWERS = 24 };

/* q'' = t^k + t^(k+1) */
static jet two_powers(const jet q[], jet t, void *ctx)
{
    const int k = *(const int *)ctx;
    return jet_neg(jet_mul(q[0], jet_add(jet_pow(t, k), jet_pow(t, k + 1))));
}

/* From rest, q(1) = 1 / ((k + 1) (k + 2)) + 1 / ((k + 2) (k + 3)). The error may be 100 tolerances, as elsewhere. */
START_TEST(powers_of_time)
{
    int k = _i;
    const double right = 1.0 / ((k + 1) * (k + 2)) + 1.0 / ((k + 2) * (k + 3));
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, two_powers, &k), TVI_OK);
    for (int i = 0; i < TOLERANCES; i++) {
        orbit o = {.system = system, .n = 1};
        open_integrator(&o, "taylor", tvi_taylor_order(tolerances[i]));
        ck_assert_msg(go(&o, tolerances[i], 1, NULL, NULL) == TVI_OK, "t^%d, %g: %s", k, tolerances[i],
                      tvi_last_error());
        ck_assert_msg(fabs(o.q[0] / right - 1) <= 100 * tolerances[i], "t^%d, %g: %g for %g", k, tolerances[i], o.q[0],
                      right);
        tvi_integrator_free(o.integrator);
    }
    tvi_system_free(system);
}
END_TEST

/* A smooth |q|, 0.01 log cosh (100 q), whose force is 1 to 87 digits at q = 1. */
static jet smooth_distance(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.01, jet_log(jet_cosh(jet_mul(100, q[0]))));
}

/* To t = 0.1, q = q0 + v t - t^2 / 2 where q stays above 0.1. */
START_TEST(flat_to_roundoff)
{
    enum { POINTS = 29, SPEEDS = 11 };
    for (int i = 0; i < POINTS * SPEEDS; i++) {
        const double q = 0.3 + 0.1 * (i % POINTS), v = 0.2 * (i / POINTS) - 1, right = q + 0.1 * v - 0.005;
        orbit o = open_potential(smooth_distance, tvi_taylor_order(1e-8), q, v);
        ck_assert_msg(go(&o, 1e-8, 0.1, NULL, NULL) == TVI_OK, "from %g, %g: %s", q, v, tvi_last_error());
        ck_assert_double_le(fabs(o.q[0] - right), 1e-6 * right);
        close_orbit(&o);
    }
}
END_TEST

Suite *suite_tolerance_zeros(void)
{
    Suite *suite = suite_create("tolerance zeros");
    TCase *tcase = tcase_create("tolerance zeros");
    tcase_add_loop_test(tcase, powers_of_time, 0, POWERS);
    tcase_add_test(tcase, flat_to_roundoff);
    suite_add_tcase(suite, tcase);
    return suite;
}
