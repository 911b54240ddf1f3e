/* test_tolerance.c - Tests runs of "taylor" to a tolerance: their error, and the sizes of their steps. */
#include "events.h"
#include "problems/statistics.h"
#include "tolerance.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- The error --------------------------------------------------------------------------------------------------- */

static const scene *const smooth[] = {
    &scene_pendulum,     &scene_kepler,   &scene_henon_heiles_12, &scene_henon_heiles_8,
    &scene_fpu,          &scene_solar,    &scene_double_pendulum, &scene_magnetic,
    &scene_nonseparable, &scene_vortices, &scene_degenerate,
};
enum { SMOOTH = sizeof smooth / sizeof *smooth };

static const double tolerances[] = {1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15};
enum { TOLERANCES = sizeof tolerances / sizeof *tolerances };

/* The error that roundoff makes in the scene: how far starts that are wrong by two units of it, to either side, end
 * from its own. It is the larger part of the errors of chaotic motion at the least tolerances. */
static double roundoff_of(const scene *s)
{
    double largest = 0;
    orbit o = open_scene(s, tvi_taylor_order(1e-14));
    ck_assert_int_eq(go(&o, 1e-14, s->t_end, NULL, NULL), TVI_OK);
    for (int units = -2; units <= 2; units += 4) {
        orbit moved = open_scene(s, tvi_taylor_order(1e-14));
        for (int i = 0; i < s->n; i++) moved.q[i] *= 1 + units * DBL_EPSILON, moved.p[i] *= 1 - units * DBL_EPSILON;
        ck_assert_int_eq(go(&moved, 1e-14, s->t_end, NULL, NULL), TVI_OK);
        largest = fmax(largest, error_of(&moved, o.q, o.p));
        close_orbit(&moved);
    }
    close_orbit(&o);
    return largest;
}

/* Within a factor 100 of the tolerance, or three times what roundoff makes, where that is more: at the least tolerance;
 * and not by steps that are too small. One expansion a step, but for the first. */
START_TEST(error_within_tolerance)
{
    const scene *s = smooth[_i];
    const double roundoff = roundoff_of(s);
    for (int i = 0; i < TOLERANCES; i++) {
        const double tolerance = tolerances[i];
        orbit o = open_scene(s, tvi_taylor_order(tolerance));
        ck_assert_int_eq(go(&o, tolerance, s->t_end, NULL, NULL), TVI_OK);
        ck_assert(o.t == s->t_end);
        const double error = error_of(&o, s->reference, s->reference + s->n);
        ck_assert_msg(error <= fmax(100 * tolerance, 3 * roundoff), "%s, %g: %g, where %g is roundoff", s->name,
                      tolerance, error, roundoff);
        ck_assert_msg(error >= tolerance / 1e5 || tolerance < 1e-11, "%s, %g: %g", s->name, tolerance, error);
        ck_assert_int_le(tvi_integrator_stats(o.integrator)->expansions, steps_of(&o) + 8);
        close_orbit(&o);
    }
}
END_TEST

/* Another order than the one that suits serves the tolerance too. */
START_TEST(error_with_other_orders)
{
    static const int orders[] = {10, 16, 30, 60, 99};
    const scene *s = &scene_henon_heiles_12;
    for (size_t i = 0; i < sizeof orders / sizeof *orders; i++) {
        orbit o = open_scene(s, orders[i]);
        ck_assert_int_eq(go(&o, 1e-10, s->t_end, NULL, NULL), TVI_OK);
        const double error = error_of(&o, s->reference, s->reference + s->n);
        ck_assert_msg(error <= 1e-8 && error >= 1e-15, "order %d: %g", orders[i], error);
        close_orbit(&o);
    }
}
END_TEST

/* Kepler's problem, the energy in long double: relative errors of orbits with other velocities. */
static sample errors_after(tvi_status (*run)(orbit *), int order)
{
    sample errors = {0};
    for (int k = 0; k < ORBITS; k++) {
        orbit o = open_scene(&scene_kepler, order);
        const long double v = o.p[1] += start_shift(k), H0 = v * v / 2 - 1;
        ck_assert_int_eq(run(&o), TVI_OK);
        const long double H =
            ((long double)o.p[0] * o.p[0] + (long double)o.p[1] * o.p[1]) / 2 - 1 / hypotl(o.q[0], o.q[1]);
        sample_add(&errors, (double)((H - H0) / H0));
        close_orbit(&o);
    }
    return errors;
}

static tvi_status equal_steps(orbit *o)
{
    return tvi_integrate(o->integrator, 0x1p-4, 4000, &o->t, o->q, o->p, NULL, NULL);
}

/* Roundoff has either sign. The control has order 12, which drifts with a ratio of 11.3. Coefficients (tau / k)
 * x'_{k-1}, with the same roundoff of 1/k in all steps, drift by 1.9e-15 and have an rms of 1.4e-15 about that: 15
 * standard errors. */
START_TEST(roundoff_does_not_drift)
{
    const sample errors = errors_after(equal_steps, 20), drifting = errors_after(equal_steps, 12);
    ck_assert_double_lt(sample_drift(&errors), NO_DRIFT);
    ck_assert_double_gt(sample_drift(&drifting), NO_DRIFT);
}
END_TEST

static tvi_status finest(orbit *o) { return go(o, DBL_EPSILON, 250, NULL, NULL); }

/* And refined increments are wrong by less than the rounding of the state that is returned. */
START_TEST(energy_beyond_roundoff)
{
    const sample errors = errors_after(finest, 20);
    const double rms = sample_rms(&errors);
    ck_assert_msg(rms <= 2e-16 && rms >= 2e-17, "%g", rms);
}
END_TEST

/* The low parts of refined increments are of their step alone: steps of one size that follow are those of a new
 * integrator. */
START_TEST(steps_that_follow_are_not_refined)
{
    orbit o = open_scene(&scene_kepler, tvi_taylor_order(DBL_EPSILON));
    ck_assert_int_eq(go(&o, DBL_EPSILON, 10, NULL, NULL), TVI_OK);
    orbit other = open_scene(&scene_kepler, tvi_taylor_order(DBL_EPSILON));
    other.t = o.t;
    memcpy(other.q, o.q, sizeof o.q);
    memcpy(other.p, o.p, sizeof o.p);
    tvi_integrator_reset(o.integrator);
    ck_assert_int_eq(equal_steps(&o), TVI_OK);
    ck_assert_int_eq(equal_steps(&other), TVI_OK);
    ck_assert_mem_eq(o.q, other.q, sizeof o.q);
    ck_assert_mem_eq(o.p, other.p, sizeof o.p);
    close_orbit(&o);
    close_orbit(&other);
}
END_TEST

/* q = 2 cos t - cos 2t, of mass 3. */
static jet forced(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    const jet drive = jet_mul(q[0], jet_cos(jet_mul(2, t)));
    return jet_mul(3, jet_sub(jet_mul(0.5, jet_sqr(q[0])), jet_mul(3, drive)));
}

/* (q, p) = (cos, -sin) of t + sin t / 2. */
static jet uneven_turn(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)ctx;
    const jet rate = jet_add(1, jet_mul(0.5, jet_cos(t)));
    return jet_mul(rate, jet_mul(0.5, jet_add(jet_sqr(q[0]), jet_sqr(p[0]))));
}

static void solution(bool is_turn, double t, double *q, double *p)
{
    const long double angle = t + sinl(t) / 2;
    *q = (double)(is_turn ? cosl(angle) : 2 * cosl(t) - cosl(2 * t));
    *p = (double)(is_turn ? -sinl(angle) : 6 * (sinl(2 * t) - sinl(t)));
}

/* With explicit time, another mass, a Hamiltonian, forth and back: plain sums end at 3.5e-13 and 1.4e-13. */
START_TEST(closed_forms_beyond_roundoff)
{
    const bool is_turn = _i % 2;
    const double t_end = _i < 2 ? 500 : -500;
    double q, p;
    orbit o = {.n = 1};
    ck_assert_int_eq(is_turn ? tvi_system_hamiltonian(&o.system, 1, uneven_turn, NULL)
                             : tvi_system_potential(&o.system, 1, (const double[]){3}, forced, NULL),
                     TVI_OK);
    open_integrator(&o, "taylor", 19);
    solution(is_turn, 0, o.q, o.p);
    ck_assert_int_eq(go(&o, 1e-15, t_end, NULL, NULL), TVI_OK);
    solution(is_turn, t_end, &q, &p);
    ck_assert_double_le(error_of(&o, &q, &p), 4e-14);
    close_orbit(&o);
}
END_TEST

/* ---- The size of a step ------------------------------------------------------------------------------------------ */

/* q = 1 / (1 - t): all q_k are 1, p_k = k + 1. */
static jet pole(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(-0.5, jet_pow(q[0], 4));
}

static double pole_step(double tolerance, int order)
{
    const double part = tolerance * exp(-5);
    double h = pow(part, 1.0 / (order + 1)); /* q, whose movement does not exceed its size */
    for (int k = order; k > order - 3 && k > 1; k--) {
        const double of_p = pow(part, (double)k / order) / (k + 1);
        h = fmin(h, fmax(pow(of_p, 1.0 / k), pow(2 * of_p, 1.0 / (k - 1))));
    }
    return h;
}

static int stop_at_once(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p, (void)ctx;
    return step == 1;
}

START_TEST(sizes_of_steps)
{
    static const int orders[] = {3, 4, 7, 17, 27, 37};
    for (int i = 0; i < TOLERANCES; i++) {
        const double tolerance = tolerances[i];
        for (size_t k = 0; k < sizeof orders / sizeof *orders; k++) {
            orbit o = open_potential(pole, orders[k], 1, 1);
            ck_assert_int_eq(go(&o, tolerance, 0.9, stop_at_once, NULL), TVI_ESTOPPED);
            ck_assert_double_eq_tol(o.t, pole_step(tolerance, orders[k]), 1e-13);
            close_orbit(&o);
        }
    }
}
END_TEST

/* Such a step is the one of that size, with its tail and its states between. */
START_TEST(steps_of_the_same_size)
{
    static const scene *const forms[] = {&scene_kepler, &scene_solar, &scene_vortices, &scene_double_pendulum};
    for (int order = 2; order < 9; order++) {
        orbit chosen = open_scene(forms[_i], order), given = open_scene(forms[_i], order);
        const int n = chosen.n;
        double q[2][LARGEST_N], p[2][LARGEST_N];
        ck_assert_int_eq(go(&chosen, 1e-3, forms[_i]->t_end, stop_at_once, NULL), TVI_ESTOPPED);
        ck_assert_int_eq(tvi_step(given.integrator, chosen.t, &given.t, given.q, given.p), TVI_OK);
        ck_assert_double_le(error_of(&chosen, given.q, given.p), 1e-15);
        const double tail = tvi_integrator_stats(given.integrator)->tail;
        ck_assert_msg(tail > 1e-6, "%g", tail);
        ck_assert_double_eq_tol(tvi_integrator_stats(chosen.integrator)->tail, tail, 1e-12 * tail);
        ck_assert_int_eq(tvi_dense(chosen.integrator, 0.5, q[0], p[0]), TVI_OK);
        ck_assert_int_eq(tvi_dense(given.integrator, 0.5, q[1], p[1]), TVI_OK);
        memcpy(chosen.q, q[0], (size_t)n * sizeof **q);
        memcpy(chosen.p, p[0], (size_t)n * sizeof **p);
        ck_assert_double_le(error_of(&chosen, q[1], p[1]), 1e-15);
        close_orbit(&chosen);
        close_orbit(&given);
    }
}
END_TEST

/* The pole with a light mass, after or before a heavy body whose momentum is much larger and does not change. */
static const double LIGHT = 1e-12;

static jet light_pole(const jet q[], jet t, void *ctx) { return jet_mul(LIGHT, pole(q + *(const int *)ctx, t, NULL)); }

START_TEST(masses_do_not_show)
{
    const double mass[] = {_i ? 1 : LIGHT, _i ? LIGHT : 1};
    orbit o = {.n = 2, .q = {!_i, _i}, .p = {mass[0], mass[1]}};
    ck_assert_int_eq(tvi_system_potential(&o.system, 2, mass, light_pole, &_i), TVI_OK);
    open_integrator(&o, "taylor", 13);
    ck_assert_int_eq(go(&o, 1e-10, 0.9, stop_at_once, NULL), TVI_ESTOPPED);
    ck_assert_double_eq_tol(o.t, pole_step(1e-10, 13), 1e-13);
    close_orbit(&o);
}
END_TEST

/* The step knows no units: Kepler in lengths of 1000, times of 1e-3 and back. */
static jet kepler_in_units(const jet q[], jet t, void *ctx)
{
    (void)t;
    return jet_mul(-*(const double *)ctx, jet_pow(jet_add(jet_sqr(q[0]), jet_sqr(q[1])), -0.5));
}

START_TEST(units_do_not_show)
{
    static const double length[] = {1, 1000, 1e-5}, duration[] = {1, 1e-3, 1e7};
    double plain[4];
    for (int i = 0; i < 3; i++) {
        const double speed = length[i] / duration[i];
        double strength = speed * speed * length[i];
        orbit o = {.n = 2, .q = {length[i], 0}, .p = {0, 1.2 * speed}};
        ck_assert_int_eq(tvi_system_potential(&o.system, 2, NULL, kepler_in_units, &strength), TVI_OK);
        open_integrator(&o, "taylor", 13);
        ck_assert_int_eq(go(&o, 1e-10, 20 * duration[i], NULL, NULL), TVI_OK);
        const double x[] = {o.q[0] / length[i], o.q[1] / length[i], o.p[0] / speed, o.p[1] / speed};
        if (i == 0) memcpy(plain, x, sizeof x);
        for (int k = 0; k < 4; k++) ck_assert_double_eq_tol(x[k], plain[k], 1e-13);
        close_orbit(&o);
    }
}
END_TEST

static jet constant_force(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(q[0]);
}

static jet growing_force(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return jet_neg(jet_mul(q[0], t));
}

static jet airy(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return jet_neg(jet_mul(jet_mul(0.5, jet_sqr(q[0])), t));
}

/* Curves with few coefficients: at rest at 0, and those of which two in three are 0. */
START_TEST(coefficients_that_are_zero)
{
    orbit o = open_potential(constant_force, 12, 0, 0);
    ck_assert_int_eq(go(&o, 1e-12, 10, NULL, NULL), TVI_OK);
    ck_assert_double_eq_tol(o.q[0], 50, 1e-12);
    ck_assert_double_eq_tol(o.p[0], 10, 1e-12);
    close_orbit(&o);
    o = open_potential(growing_force, 12, 0, 0);
    ck_assert_int_eq(go(&o, 1e-12, 6, NULL, NULL), TVI_OK);
    ck_assert_double_eq_tol(o.q[0], 36, 1e-11);
    close_orbit(&o);
    for (int order = 12; order <= 14; order++) { /* Ai(-3) / Ai(0) by q'' = t q back from 0 */
        o = open_potential(airy, order, 0.3550280538878172, -0.2588194037928068);
        ck_assert_int_eq(go(&o, 1e-12, -3, NULL, NULL), TVI_OK);
        ck_assert_double_eq_tol(o.q[0], -0.3788142936776581, 1e-11);
        close_orbit(&o);
    }
}
END_TEST

Suite *suite_tolerance(void)
{
    Suite *suite = suite_create("tolerance");
    TCase *error = tcase_create("error"), *size = tcase_create("size");
    tcase_add_loop_test(error, error_within_tolerance, 0, SMOOTH);
    tcase_add_test(error, error_with_other_orders);
    tcase_add_test(error, roundoff_does_not_drift);
    tcase_add_test(error, energy_beyond_roundoff);
    tcase_add_test(error, steps_that_follow_are_not_refined);
    tcase_add_loop_test(error, closed_forms_beyond_roundoff, 0, 4);
    tcase_add_test(size, sizes_of_steps);
    tcase_add_loop_test(size, steps_of_the_same_size, 0, 4);
    tcase_add_loop_test(size, masses_do_not_show, 0, 2);
    tcase_add_test(size, units_do_not_show);
    tcase_add_test(size, coefficients_that_are_zero);
    suite_add_tcase(suite, error);
    suite_add_tcase(suite, size);
    return suite;
}
