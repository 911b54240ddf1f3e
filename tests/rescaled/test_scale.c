/* test_scale.c - Tests the automatic time scale, against closed forms, other coordinates and other units. */
#include "rescaled.h"

#include <float.h>
#include <math.h>

static jet kepler_in_space(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 3), -0.5));
}

/* All along an orbit: V_qq has the eigenvalues -2 / r^3, 1 / r^3 and, in space, 1 / r^3. */
START_TEST(automatic_of_kepler)
{
    tvi_system *in_plane = rescaled_system(2, NULL, kepler, NULL);
    tvi_system *in_space = rescaled_system(3, NULL, kepler_in_space, NULL);
    for (int k = 0; k < 64; k++) {
        const state x = kepler_at(0.99, 0.1 * k);
        const double r = hypot(x.q[0], x.q[1]), tilt = 0.7;
        const state tilted = {
            x.t, {x.q[0], cos(tilt) * x.q[1], sin(tilt) * x.q[1]}, {x.p[0], cos(tilt) * x.p[1], sin(tilt) * x.p[1]}};
        ck_assert_double_eq_tol(scale_at(in_plane, &x) / (pow(r, 1.5) * pow(5, -0.25)), 1, 1e-14);
        ck_assert_double_eq_tol(scale_at(in_space, &tilted) / (pow(r, 1.5) * pow(6, -0.25)), 1, 1e-14);
    }
    tvi_system_free(in_plane);
    tvi_system_free(in_space);
}
END_TEST

/* The frequencies of two springs, 2 and 3, whatever the masses: (2^4 + 3^4)^(-1/4). */
static jet springs(const jet q[], jet t, void *ctx)
{
    const double *mass = ctx;
    (void)t;
    return jet_add(jet_mul(2 * mass[0], jet_sqr(q[0])), jet_mul(4.5 * mass[1], jet_sqr(q[1])));
}

START_TEST(automatic_of_springs)
{
    double mass[] = {3, 0.125};
    tvi_system *base, *rescaled;
    const state x = {0.5, {1, 2}, {3, 4}};
    ck_assert_int_eq(tvi_system_potential(&base, 2, mass, springs, mass), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, base, NULL, NULL), TVI_OK);
    ck_assert_double_eq_tol(scale_at(rescaled, &x), pow(97, -0.25), 1e-15);
    tvi_system_free(rescaled);
    tvi_system_free(base);
}
END_TEST

/* The driven problem in units of length, mass and time, stated as the user of those units would. */
typedef struct {
    double length, mass, time;
} units;

static jet driven_in(const jet q[], jet t, void *ctx)
{
    const units *u = ctx;
    jet x[2];
    for (int i = 0; i < 2; i++) x[i] = jet_mul(q[i], u->length);
    return jet_mul(driven(x, jet_mul(t, u->time), NULL), u->mass * u->time * u->time / (u->length * u->length));
}

static state run_in(const units *u, double h, long steps)
{
    tvi_system *base, *rescaled;
    const double mass[] = {u->mass * driven_mass[0], u->mass * driven_mass[1]};
    state x = driven_start();
    for (int i = 0; i < 2; i++) {
        x.q[i] /= u->length;
        x.p[i] *= u->mass * u->time / u->length;
    }
    x.t /= u->time;
    ck_assert_int_eq(tvi_system_potential(&base, 2, mass, driven_in, (void *)u), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, base, NULL, NULL), TVI_OK);
    run r = open_run(rescaled, NULL, 0, &x);
    ck_assert_int_eq(run_steps(&r, h, steps), TVI_OK);
    x = r.x;
    for (int i = 0; i < 2; i++) {
        x.q[i] *= u->length;
        x.p[i] /= u->mass * u->time / u->length;
    }
    x.t *= u->time;
    close_run(&r);
    tvi_system_free(base);
    return x;
}

/* The same trajectory to roundoff, of steps of the same size: h is a phase. */
START_TEST(units_do_not_matter)
{
    static const units others[] = {{7, 1, 1}, {1, 0.3, 1}, {1, 1, 86400}, {1e-11, 1e30, 3e7}};
    const units first = {1, 1, 1};
    const state expected = run_in(&first, 0.5, 40);
    ck_assert(expected.t > 2);
    const state x = run_in(&others[_i], 0.5, 40);
    ck_assert_double_le(state_distance(2, &x, &expected), 1e-12);
}
END_TEST

/* ---- Why there is no floor (docs/adaptive.md) -------------------------------------------------------------------- */

/* The automatic scale of the pendulum and of Kepler's problem with a floor, w0^4 added. */
static double floor_4;

static jet pendulum(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_cos(q[0]));
}

static jet pendulum_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_pow(jet_add(floor_4, jet_sqr(jet_cos(q[0]))), -0.25);
}

static jet floored_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_pow(jet_add(floor_4, jet_mul(5, jet_pow(jet_dot(q, q, 2), -3))), -0.25);
}

/* The steps to t_end with w0 a part of the frequency at the start; 0: they end before. */
static long steps_with(double part, run r, double frequency, tvi_potential_fn *potential, tvi_rescale_fn *g, double h)
{
    floor_4 = pow(part * frequency, 4);
    r = open_run(rescaled_system(r.x.p[1] != 0 ? 2 : 1, NULL, potential, g), NULL, 0, &r.x);
    const tvi_status status = tvi_integrate_to(r.integrator, h, 100, &r.x.t, r.x.q, r.x.p, NULL, NULL);
    const long steps = status == TVI_OK ? tvi_integrator_stats(r.integrator)->steps : 0;
    close_run(&r);
    return steps;
}

/* One that carries the pendulum across 90 degrees takes the long steps from an orbit that starts at its pericentre. */
START_TEST(a_floor_helps_one_and_harms_the_other)
{
    const run turning = {.x = {0, {0.5}, {1.8}}}, eccentric = {.x = kepler_start(0.9)};
    static const double parts[] = {0, 1e-4, 0.5};
    long over[3], around[3];
    for (int i = 0; i < 3; i++) {
        over[i] = steps_with(parts[i], turning, sqrt(cos(0.5)), pendulum, pendulum_scale, 0.3);
        around[i] = steps_with(parts[i], eccentric, pow(5, 0.25) * pow(0.1, -1.5), kepler, floored_scale, 1.25);
    }
    ck_assert(over[0] == 0 && over[1] == 0 && over[2] > 200);
    ck_assert(around[0] > 100 && around[1] == around[0] && around[2] > 10 * around[0]);
}
END_TEST

Suite *suite_scale(void)
{
    Suite *suite = suite_create("scale");
    TCase *tests = tcase_create("automatic");
    tcase_add_test(tests, automatic_of_kepler);
    tcase_add_test(tests, automatic_of_springs);
    tcase_add_loop_test(tests, units_do_not_matter, 0, 4);
    tcase_add_test(tests, a_floor_helps_one_and_harms_the_other);
    suite_add_tcase(suite, tests);
    return suite;
}
