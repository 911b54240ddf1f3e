/* test_tolerance_runs.c - Tests runs of "taylor" to a tolerance: where they end, what is seen on the way, and what is
 * refused. */
#include "events.h"
#include "problems/refusals.h"
#include "tolerance.h"
#include "problems/texts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Where a run ends -------------------------------------------------------------------------------------------- */

static jet no_force(const jet q[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return jet_const(0);
}

/* The curve is exact: one step, whose size is rounded, to an end that is not. */
START_TEST(free_motion)
{
    orbit o = open_potential(no_force, 12, 1, 2);
    ck_assert_int_eq(go(&o, 1e-12, 20, NULL, NULL), TVI_OK);
    ck_assert(o.t == 20 && o.q[0] == 41);
    ck_assert_int_eq(go(&o, 1e-12, 1e-9, NULL, NULL), TVI_OK);
    ck_assert(o.t == 1e-9);
    ck_assert_double_eq_tol(o.q[0], 1 + 2e-9, 1e-14);
    ck_assert_int_eq(steps_of(&o), 2);
    close_orbit(&o);
}
END_TEST

START_TEST(ends_at_a_time)
{
    static const double ends[] = {1e-9, 0.7, 3, 3 + 4 * DBL_EPSILON, 20, -5, 0};
    const scene *s = &scene_kepler;
    orbit o = open_scene(s, 15);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        ck_assert_int_eq(go(&o, 1e-12, ends[i], NULL, NULL), TVI_OK);
        ck_assert(o.t == ends[i]);
    }
    ck_assert_double_le(error_of(&o, s->q, s->p), 1e-10); /* back at the start */
    const long steps = steps_of(&o);
    ck_assert_int_eq(go(&o, 1e-12, 0, NULL, NULL), TVI_OK);
    ck_assert_int_eq(steps_of(&o), steps); /* it is there */
    close_orbit(&o);
}
END_TEST

typedef struct {
    orbit *free, *fixed;
    double before, error;
} dense_check;

/* tvi_dense in the middle of a step is the state of a run that ends there. */
static int look_inside(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)step, (void)q, (void)p;
    dense_check *d = ctx;
    orbit inside = *d->free;
    ck_assert_int_eq(tvi_dense(d->free->integrator, 0.5, inside.q, inside.p), TVI_OK);
    ck_assert_int_eq(go(d->fixed, 1e-14, (d->before + t) / 2, NULL, NULL), TVI_OK);
    d->error = fmax(d->error, error_of(&inside, d->fixed->q, d->fixed->p));
    d->before = t;
    return 0;
}

START_TEST(dense_output)
{
    orbit o = open_scene(&scene_kepler, 13), fixed = open_scene(&scene_kepler, 18);
    dense_check d = {.free = &o, .fixed = &fixed};
    ck_assert_int_eq(go(&o, 1e-10, 6, look_inside, &d), TVI_OK);
    ck_assert_double_le(d.error, 1e-9);
    ck_assert_double_ge(d.error, 1e-14);
    close_orbit(&o);
    close_orbit(&fixed);
}
END_TEST

static int stop_at_seven(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p, (void)ctx;
    return step == 7;
}

/* Stopped, saved, and gone on with elsewhere, bit for bit the run without. */
START_TEST(goes_on)
{
    orbit o = open_scene(&scene_kepler, 13), other = open_scene(&scene_kepler, 13),
          plain = open_scene(&scene_kepler, 13);
    ck_assert_int_eq(go(&o, 1e-10, 20, stop_at_seven, NULL), TVI_ESTOPPED);
    ck_assert_int_eq(steps_of(&o), 7);
    char *text = text_of_state(o.integrator, o.t, o.q, o.p);
    ck_assert_int_eq(tvi_state_from_text(other.integrator, text, strlen(text), &other.t, other.q, other.p), TVI_OK);
    free(text);
    orbit *const all[] = {&o, &other, &plain};
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(go(all[i], 1e-10, 20, NULL, NULL), TVI_OK);
        ck_assert_int_eq(steps_of(all[i]), steps_of(&o));
        ck_assert(memcmp(all[i]->q, o.q, sizeof o.q) == 0 && memcmp(all[i]->p, o.p, sizeof o.p) == 0);
    }
    for (int i = 0; i < 3; i++) close_orbit(all[i]);
}
END_TEST

/* ---- Events ------------------------------------------------------------------------------------------------------ */

/* q.p: 0 at the ends of the long axis. */
static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(q, p, 2);
}

typedef struct {
    int count, stop_at;
    double way, error;
} passages;

/* Kepler from (1, 0), (0, 0.8), the far end, of energy -0.68: pericentres after 1/2, 3/2, ... of the period. */
static int at_pericentre(int which, double t, const double q[], const double p[], void *ctx)
{
    (void)which, (void)p;
    passages *seen = ctx;
    const double a = 1 / 1.36, period = 2 * acos(-1) * a * sqrt(a);
    seen->error = fmax(seen->error, fabs(t - seen->way * (seen->count + 0.5) * period));
    seen->error = fmax(seen->error, fabs(hypot(q[0], q[1]) - (2 * a - 1)));
    return ++seen->count == seen->stop_at;
}

/* Located to the run's own accuracy, either way; the steps are those without events. */
START_TEST(events_on_the_way)
{
    const double way = _i ? -1 : 1, tolerance = 1e-12, t_end = way * 20;
    tvi_event *event;
    ck_assert_int_eq(tvi_event_create(&event, 2, _i ? TVI_FALLING : TVI_RISING, false, radial, NULL), TVI_OK);
    const tvi_event *events[] = {event};
    orbit o = open_scene(&scene_kepler, 15), plain = open_scene(&scene_kepler, 15);
    passages seen = {.way = way};
    ck_assert_int_eq(tvi_integrate_tolerance_events(o.integrator, tolerance, t_end, events, 1, &o.t, o.q, o.p, NULL,
                                                    at_pericentre, &seen),
                     TVI_OK);
    ck_assert_int_eq(seen.count, 5);
    ck_assert_double_le(seen.error, 100 * tolerance);
    ck_assert_int_eq(go(&plain, tolerance, t_end, NULL, NULL), TVI_OK);
    ck_assert(memcmp(o.q, plain.q, sizeof o.q) == 0 && memcmp(o.p, plain.p, sizeof o.p) == 0);
    close_orbit(&o);
    close_orbit(&plain);
    tvi_event_free(event);
}
END_TEST

/* An observer ends the run at its event. */
START_TEST(events_end_the_run)
{
    tvi_event *event;
    ck_assert_int_eq(tvi_event_create(&event, 2, TVI_RISING, false, radial, NULL), TVI_OK);
    const tvi_event *events[] = {event};
    orbit o = open_scene(&scene_kepler, 15);
    passages seen = {.way = 1, .stop_at = 2};
    ck_assert_int_eq(
        tvi_integrate_tolerance_events(o.integrator, 1e-12, 20, events, 1, &o.t, o.q, o.p, NULL, at_pericentre, &seen),
        TVI_ESTOPPED);
    ck_assert_int_eq(seen.count, 2);
    ck_assert_double_le(fabs(o.q[0] * o.p[0] + o.q[1] * o.p[1]), 1e-14);
    const orbit was = o;
    events[0] = NULL;
    ck_assert_int_eq(
        tvi_integrate_tolerance_events(o.integrator, 1e-12, 20, events, 1, &o.t, o.q, o.p, NULL, at_pericentre, &seen),
        TVI_EINVAL);
    ck_assert(memcmp(&was, &o, sizeof o) == 0);
    close_orbit(&o);
    tvi_event_free(event);
}
END_TEST

/* ---- Refused ----------------------------------------------------------------------------------------------------- */

static jet attraction(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(q[0], -1));
}

/* From rest at 1 the collision is at pi / sqrt(8): the steps shrink on the way there, and end. */
START_TEST(collision)
{
    orbit o = open_potential(attraction, 13, 1, 0);
    ck_assert_int_eq(go(&o, 1e-10, 2, NULL, NULL), TVI_ENOCONV);
    ck_assert_double_eq_tol(o.t, acos(-1) / sqrt(8), 1e-8);
    ck_assert(o.q[0] > 0 && o.q[0] < 1e-8);
    ck_assert_int_le(steps_of(&o), 1000);
    close_orbit(&o);
}
END_TEST

static void expect_refused(orbit *o, double tolerance, double t_end, tvi_status expected, const char *culprit)
{
    const orbit was = *o;
    refused(culprit, go(o, tolerance, t_end, NULL, NULL), expected);
    ck_assert(memcmp(&was, o, sizeof was) == 0);
    ck_assert_int_eq(steps_of(o), 0);
}

START_TEST(refused_values)
{
    static const double bad[] = {0, -1e-10, 1, INFINITY, NAN, 1e-16, 1e-300};
    orbit o = open_scene(&scene_kepler, 13);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        expect_refused(&o, bad[i], 1, TVI_EINVAL, "tolerance is below");
    expect_refused(&o, 1e-10, INFINITY, TVI_EINVAL, "t_end is not finite");
    expect_refused(&o, 1e-10, NAN, TVI_EINVAL, "t_end is not finite");
    refused("integrator is NULL", tvi_integrate_tolerance(NULL, 1e-10, 1, &o.t, o.q, o.p, NULL, NULL), TVI_EINVAL);
    refused("t is NULL", tvi_integrate_tolerance(o.integrator, 1e-10, 1, NULL, o.q, o.p, NULL, NULL), TVI_EINVAL);
    refused("q is NULL", tvi_integrate_tolerance(o.integrator, 1e-10, 1, &o.t, NULL, o.p, NULL, NULL), TVI_EINVAL);
    refused("p is NULL", tvi_integrate_tolerance(o.integrator, 1e-10, 1, &o.t, o.q, NULL, NULL, NULL), TVI_EINVAL);
    o.q[1] = INFINITY;
    expect_refused(&o, 1e-10, 1, TVI_ENONFINITE, "q[1] = inf");
    o.q[0] = o.q[1] = 0;
    expect_refused(&o, 1e-10, 1, TVI_EDOMAIN, "jet_pow");
    close_orbit(&o);
    o = open_scene(&scene_kepler, 19); /* the least and the largest that are none of these */
    ck_assert_int_eq(go(&o, DBL_EPSILON, 0.1, NULL, NULL), TVI_OK);
    ck_assert_int_eq(go(&o, 1 - DBL_EPSILON, 0.2, NULL, NULL), TVI_OK);
    close_orbit(&o);
}
END_TEST

static jet infinite_at_0(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return jet_mul(q[0], jet_log(jet_cosh(jet_mul(1000, jet_sub(1, t)))));
}

/* A force that is infinite where a run begins has the same status with a tolerance as with a step size. */
START_TEST(infinite_force)
{
    orbit o = open_potential(infinite_at_0, 13, 0, 0);
    expect_refused(&o, 1e-10, 2, TVI_ENONFINITE, "a value is not finite");
    const orbit was = o;
    refused("a value is not finite", tvi_step(o.integrator, 0.1, &o.t, o.q, o.p), TVI_ENONFINITE);
    ck_assert(memcmp(&was, &o, sizeof was) == 0);
    close_orbit(&o);
}
END_TEST

START_TEST(refused_methods)
{
    static const char *const names[] = {"galerkin", "start",    "midpoint", "both-ends",
                                        "right",    "poincare", "tvi",      "stormer-verlet"};
    orbit o = open_scene(&scene_kepler, 2);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        tvi_integrator_free(o.integrator);
        open_integrator(&o, names[i], 2);
        expect_refused(&o, 1e-10, 1, TVI_EUNSUPPORTED, "a tolerance is for");
    }
    tvi_system *const plain = o.system;
    tvi_integrator_free(o.integrator);
    ck_assert_int_eq(tvi_system_rescaled(&o.system, plain, NULL, NULL), TVI_OK);
    open_integrator(&o, "taylor", 13);
    expect_refused(&o, 1e-10, 1, TVI_EUNSUPPORTED, "a tolerance is for");
    tvi_system_free(plain);
    close_orbit(&o);
}
END_TEST

Suite *suite_tolerance_runs(void)
{
    Suite *suite = suite_create("tolerance runs");
    TCase *ends = tcase_create("ends"), *refused = tcase_create("refused");
    tcase_add_test(ends, free_motion);
    tcase_add_test(ends, ends_at_a_time);
    tcase_add_test(ends, dense_output);
    tcase_add_test(ends, goes_on);
    tcase_add_loop_test(ends, events_on_the_way, 0, 2);
    tcase_add_test(ends, events_end_the_run);
    tcase_add_test(refused, collision);
    tcase_add_test(refused, refused_values);
    tcase_add_test(refused, infinite_force);
    tcase_add_test(refused, refused_methods);
    suite_add_tcase(suite, ends);
    suite_add_tcase(suite, refused);
    return suite;
}
