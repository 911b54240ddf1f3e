/* test_times.c - Tests results at given times. */
#include "events.h"
#include "problems/refusals.h"
#include "runs.h"

#include <math.h>
#include <string.h>

enum { MOST_TIMES = 256 };

typedef struct {
    int count, n, stop_at;
    point at[MOST_TIMES];
} results;

static int note(long which, double t, const double q[], const double p[], void *ctx)
{
    results *d = ctx;
    ck_assert_int_eq(which, d->count + 1);
    point *x = &d->at[d->count++];
    *x = (point){.t = t};
    memcpy(x->q, q, (size_t)d->n * sizeof *q);
    memcpy(x->p, p, (size_t)d->n * sizeof *p);
    return d->count == d->stop_at;
}

static tvi_status ask(run *r, double h, const double times[], int count, results *d)
{
    d->n = tvi_system_dimension(r->system);
    return tvi_integrate_at(r->integrator, h, times, count, &r->x.t, r->x.q, r->x.p, note, d);
}

/* Forward and back, with times at the start, at ends of steps, twice the same, and several in a step: the steps are bit
 * for bit those without, and a state is that of a run whose last step is the part. */
START_TEST(states_at_times)
{
    static const double in_steps[] = {0, 0, 0.3, 0.30001, 1, 1, 1.5, 4.25, 4.75, 8, 11.9375};
    enum { COUNT = sizeof in_steps / sizeof *in_steps };
    const pairing *x = &pairings[_i / 2];
    const double h = (_i % 2 ? -1 : 1) * ldexp(1, (int)floor(log2(x->h))); /* ends of steps without rounding */
    static results d;
    double times[COUNT];
    d = (results){0};
    for (int i = 0; i < COUNT; i++) times[i] = in_steps[i] * h + 0.0; /* no -0 */
    run r = run_open(x->scene, x->method, x->order), plain = run_open(x->scene, x->method, x->order);
    ck_assert_int_eq(ask(&r, h, times, COUNT, &d), TVI_OK);
    ck_assert_int_eq(d.count, COUNT);
    for (int i = 0, step = 0; i < COUNT; i++) {
        run part = run_open(x->scene, x->method, x->order);
        for (; step < (int)in_steps[i]; step++) ck_assert_int_eq(run_steps(&plain, h, 1), TVI_OK);
        ck_assert_int_eq(run_steps(&part, h, step), TVI_OK);
        const double rest = times[i] - part.x.t;
        if (rest != 0) ck_assert_int_eq(run_steps(&part, rest, 1), TVI_OK);
        part.x.t = times[i];
        ck_assert(same_point(&d.at[i], &part.x));
        run_close(&part);
    }
    ck_assert_int_eq(run_steps(&plain, h, 1), TVI_OK);
    ck_assert(same_point(&r.x, &plain.x));
    ck_assert_int_eq(tvi_integrator_stats(r.integrator)->passes, tvi_integrator_stats(plain.integrator)->passes);
    run_close(&r);
    run_close(&plain);
}
END_TEST

/* The times of steps of 1/10, which are rounded: the states are those of the steps, and the last step is the last. */
START_TEST(states_at_ends_of_steps)
{
    static results d;
    run r = run_open(&scene_kepler, NULL, 0), plain = run_open(&scene_kepler, NULL, 0);
    double times[100];
    point ends[100];
    d = (results){0};
    for (int i = 0; i < 100; i++) {
        ck_assert_int_eq(run_steps(&plain, 0.1, 1), TVI_OK);
        ends[i] = plain.x;
        times[i] = plain.x.t;
    }
    ck_assert_int_eq(ask(&r, 0.1, times, 100, &d), TVI_OK);
    for (int i = 0; i < 100; i++) ck_assert(same_point(&d.at[i], &ends[i]));
    ck_assert(same_point(&r.x, &plain.x));
    run_close(&r);
    run_close(&plain);
}
END_TEST

static void no_force(const jet q[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    force[0] = jet_const(0);
}

/* Far from t = 0 the steps' times are rounded, and something free shows it: q = t - 2^30. */
START_TEST(times_of_steps_are_not_rounded)
{
    static results d;
    const double start = 0x1p30;
    run r = {.x = {.t = start, .p = {1}}};
    double times[100];
    d = (results){0};
    ck_assert_int_eq(tvi_system_force(&r.system, 1, NULL, no_force, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&r.integrator, r.system, NULL), TVI_OK);
    for (int i = 0; i < 100; i++) times[i] = start + 0.1 * i + 0.03; /* not at ends */
    ck_assert_int_eq(ask(&r, 0.25 + 0x1p-26, times, 100, &d), TVI_OK);
    for (int i = 0; i < 100; i++) ck_assert_double_eq_tol(d.at[i].q[0], times[i] - start, 1e-13);
    run_close(&r);
}
END_TEST

/* Over long times the results keep what the steps keep; those of the curve do not (test_events.c). */
START_TEST(results_keep_invariants)
{
    static results d;
    run r = run_open(&scene_kepler, NULL, 0);
    drift at_steps = {0}, between = {0};
    d = (results){.n = 2};
    for (int call = 0; call < 20; call++) {
        double times[MOST_TIMES];
        for (int i = 0; i < MOST_TIMES; i++) times[i] = r.x.t + 0.377 * (i + 1);
        d.count = 0;
        ck_assert_int_eq(ask(&r, 0.25, times, MOST_TIMES, &d), TVI_OK);
        for (int i = 0; i < MOST_TIMES; i++) add_drift(&between, d.at[i].q, d.at[i].p);
        add_drift(&at_steps, r.x.q, r.x.p);
        for (int i = 0; i < 16; i++) {
            ck_assert_int_eq(run_steps(&r, 0.25, 1), TVI_OK);
            add_drift(&at_steps, r.x.q, r.x.p);
        }
    }
    ck_assert_double_le(between.energy, 10 * at_steps.energy);
    ck_assert_double_le(between.momentum, 10 * at_steps.momentum);
    run_close(&r);
}
END_TEST

/* ---- In two calls ------------------------------------------------------------------------------------------------ */

/* Times within the last step are served by the next call, bit for bit as by one; forward and back, of every method. */
START_TEST(times_in_two_calls)
{
    const pairing *x = &pairings[_i / 2];
    const double h = _i % 2 ? -x->h : x->h;
    const double times[] = {0.3 * h, 0.31 * h, 1.4 * h, 1.45 * h, 1.45 * h, 2 * h, 7.1 * h};
    for (int first = 1; first < 7; first++) {
        static results whole, pieces, rest;
        run a = run_open(x->scene, x->method, x->order), b = run_open(x->scene, x->method, x->order);
        whole = pieces = rest = (results){0};
        ck_assert_int_eq(ask(&a, h, times, 7, &whole), TVI_OK);
        ck_assert_int_eq(ask(&b, h, times, first, &pieces), TVI_OK);
        ck_assert_int_eq(ask(&b, h, times + first, 7 - first, &rest), TVI_OK);
        ck_assert_int_eq(rest.count, 7 - first);
        ck_assert(memcmp(pieces.at, whole.at, (size_t)first * sizeof *whole.at) == 0);
        ck_assert(memcmp(rest.at, whole.at + first, (size_t)(7 - first) * sizeof *whole.at) == 0);
        ck_assert(same_point(&a.x, &b.x));
        run_close(&a);
        run_close(&b);
    }
}
END_TEST

/* Times that are not within the last step, or in it no more: after another state, parameters, a saved state. */
START_TEST(times_of_no_step_are_refused)
{
    static results d;
    const double late[] = {0.4}, early[] = {0.2}, later[] = {0.6};
    run r = run_open(&scene_kepler, NULL, 0);
    d = (results){0};
    ck_assert_int_eq(ask(&r, 0.25, late, 1, &d), TVI_OK);
    refused("times[0] = 0.2 is", ask(&r, 0.25, early, 1, &d), TVI_EINVAL); /* in the step before */
    refused("times[0] = 0.6 is", ask(&r, -0.25, later, 1, &d), TVI_EINVAL);
    ck_assert_int_eq(tvi_integrator_set_parameters(r.integrator, later), TVI_OK); /* it has none: nothing changes */
    d = (results){0};
    ck_assert_int_eq(ask(&r, 0.25, late, 1, &d), TVI_OK);
    ck_assert_int_eq(d.count, 1);
    r.x.p[0] += 1e-3;
    refused("times[0] = 0.4 is", ask(&r, 0.25, late, 1, &d), TVI_EINVAL);
    run_close(&r);
}
END_TEST

/* ---- Pericentres of a rescaled orbit ----------------------------------------------------------------------------- */

static const double MU = 39.47841760435743; /* 4 pi^2: the period of a = 1 is 1 */

static jet attraction(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(-MU, jet_pow(jet_dot(q, q, 2), -0.5));
}

static jet mean_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_mul(1 / sqrt(MU), jet_pow(jet_dot(q, q, 2), 0.75));
}

/* e = 0.9999999: a step at the pericentre covers some 1e4 units of t. Results there are within eight units of it by
 * q.p / v^2, and a run ends there. */
START_TEST(results_at_pericentres)
{
    const double e = 0.9999999;
    const point start = {0, {1 + e}, {0, sqrt(MU * (1 - e) / (1 + e))}};
    double times[80];
    tvi_system *base;
    run r = {0};
    static results d;
    d = (results){0};
    ck_assert_int_eq(tvi_system_potential(&base, 2, NULL, attraction, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&r.system, base, mean_scale, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&r.integrator, r.system, NULL), TVI_OK);
    for (int i = 0; i < 80; i++) times[i] = i + 0.5;
    r.x = start;
    ck_assert_int_eq(ask(&r, 1, times, 80, &d), TVI_OK);
    for (int i = 0; i < 80; i++) { /* the period is that of the steps: they are right to roundoff */
        const double *q = d.at[i].q, *p = d.at[i].p;
        const double late = (q[0] * p[0] + q[1] * p[1]) / (p[0] * p[0] + p[1] * p[1]);
        ck_assert_double_le(fabs(late), 8 * (nextafter(times[i], INFINITY) - times[i]));
        ck_assert_double_eq_tol(hypot(q[0], q[1]), 1e-7, 1e-9);
    }
    r.x = start;
    for (int k = 1; k <= 200; k++) {
        ck_assert_int_eq(tvi_integrate_to(r.integrator, 1, k * 0.5, &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_OK);
        ck_assert_double_eq(r.x.t, k * 0.5);
    }
    run_close(&r);
    tvi_system_free(base);
}
END_TEST

START_TEST(observers_stop)
{
    static results d;
    const double times[] = {0, 0.1, 0.35, 0.4};
    for (int stop = 1; stop <= 4; stop++) {
        run r = run_open(&scene_kepler, NULL, 0);
        d = (results){.stop_at = stop};
        ck_assert_int_eq(ask(&r, 0.25, times, 4, &d), TVI_ESTOPPED);
        ck_assert_int_eq(d.count, stop);
        ck_assert_double_eq(r.x.t, stop == 1 ? 0 : stop == 2 ? 0.25 : 0.5);
        run_close(&r);
    }
}
END_TEST

START_TEST(bad_times_are_refused)
{
    static const double rows[][3] = {{0.1, 0.3, 0.2}, {-0.1, 0.1, 0.2}, {0.1, NAN, 0.2}, {0.1, 0.2, INFINITY}};
    static const double good[] = {0.1, 0.2, 0.3};
    run r = run_open(&scene_kepler, NULL, 0);
    const point start = r.x;
    static results d;
    d = (results){0};
    static const char *const culprits[] = {"times[2] = 0.2 is", "times[0] = -0.1 is", "times[1] = nan is",
                                           "times[2] = inf is"};
    for (int i = 0; i < 4; i++) refused(culprits[i], ask(&r, 0.25, rows[i], 3, &d), TVI_EINVAL);
    refused("times[0] = 0.1 is", ask(&r, -0.25, good, 3, &d), TVI_EINVAL);
    refused("h is 0", ask(&r, 0, good, 3, &d), TVI_EINVAL);
    refused("h = inf is not finite", ask(&r, INFINITY, good, 3, &d), TVI_EINVAL);
    refused("count is negative", ask(&r, 0.25, good, -1, &d), TVI_EINVAL);
    refused("times is NULL", ask(&r, 0.25, NULL, 3, &d), TVI_EINVAL);
    double *t = &r.x.t, *q = r.x.q, *p = r.x.p;
    refused("integrator is NULL", tvi_integrate_at(NULL, 0.25, good, 3, t, q, p, note, &d), TVI_EINVAL);
    refused("t is NULL", tvi_integrate_at(r.integrator, 0.25, good, 3, NULL, q, p, note, &d), TVI_EINVAL);
    refused("q is NULL", tvi_integrate_at(r.integrator, 0.25, good, 3, t, NULL, p, note, &d), TVI_EINVAL);
    refused("p is NULL", tvi_integrate_at(r.integrator, 0.25, good, 3, t, q, NULL, note, &d), TVI_EINVAL);
    ck_assert(same_point(&r.x, &start));
    ck_assert_int_eq(d.count, 0);
    ck_assert_int_eq(ask(&r, 0.25, NULL, 0, &d), TVI_OK);
    ck_assert_int_eq(tvi_integrate_at(r.integrator, 0.25, good, 3, t, q, p, NULL, NULL), TVI_OK);
    ck_assert_double_eq(r.x.t, 0.5);
    r.x.q[0] = NAN;
    const double now_and_later[] = {0.5, 1};
    for (int i = 0; i < 2; i++) ck_assert_int_eq(ask(&r, 0.25, &now_and_later[i], 1, &d), TVI_ENONFINITE);
    ck_assert_int_eq(d.count, 0);
    run_close(&r);
}
END_TEST

Suite *suite_times(void)
{
    Suite *suite = suite_create("times");
    TCase *tcase = tcase_create("times");
    tcase_add_loop_test(tcase, states_at_times, 0, 2 * PAIRINGS);
    tcase_add_test(tcase, states_at_ends_of_steps);
    tcase_add_test(tcase, times_of_steps_are_not_rounded);
    tcase_add_test(tcase, results_keep_invariants);
    tcase_add_loop_test(tcase, times_in_two_calls, 0, 2 * PAIRINGS);
    tcase_add_test(tcase, times_of_no_step_are_refused);
    tcase_add_test(tcase, results_at_pericentres);
    tcase_add_test(tcase, observers_stop);
    tcase_add_test(tcase, bad_times_are_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
