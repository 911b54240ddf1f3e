/* test_times.c - Tests results, ends and events at given times of a run whose steps are in s; and what a run goes on
 * from. */
#include "rescaled.h"
#include "tvi_bodies.h"
#include "problems/texts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double ECCENTRICITY = 0.9;

static run open_orbit(void) { return open_kepler(ECCENTRICITY, kepler_scale, NULL, 0); }

/* How far from the closed form, in the time that the motion there takes to cover it. */
static double error_in_time(double t, const double q[], const double p[])
{
    state x = {t, {q[0], q[1]}, {p[0], p[1]}};
    const state exact = kepler_at(ECCENTRICITY, t);
    x.p[0] = exact.p[0], x.p[1] = exact.p[1];
    return state_distance(2, &x, &exact) / hypot(exact.p[0], exact.p[1]);
}

/* The effect of the steps on the orbit in some revolutions; times are found to roundoff. */
static const double ACCURACY = 4e-14;

typedef struct {
    int count;
    const double *times;
    double error;
} results;

static int note(long which, double t, const double q[], const double p[], void *ctx)
{
    results *r = ctx;
    ck_assert_int_eq(which, r->count + 1);
    ck_assert(t == r->times[r->count]);
    r->count++;
    r->error = fmax(r->error, error_in_time(t, q, p));
    return 0;
}

/* Forward and back: at times close to the pericentre, several in a step, and far apart. */
START_TEST(states_at_times)
{
    static const double forward[] = {0, 1e-4, 0.001, 0.01, 0.011, 0.3, 1, 3, 3.1, 6.28, 6.2831853, 6.2832, 12, 20};
    enum { COUNT = sizeof forward / sizeof *forward };
    const double way = _i ? -1 : 1;
    double times[COUNT];
    for (int i = 0; i < COUNT; i++) times[i] = way * forward[i] + 0.0;
    run r = open_orbit(), plain = open_orbit();
    results seen = {.times = times};
    ck_assert_int_eq(tvi_integrate_at(r.integrator, way * 0.5, times, COUNT, &r.x.t, r.x.q, r.x.p, note, &seen),
                     TVI_OK);
    ck_assert_int_eq(seen.count, COUNT);
    ck_assert_double_le(seen.error, ACCURACY);
    ck_assert(way * r.x.t >= 20);
    ck_assert_int_eq(run_steps(&plain, way * 0.5, tvi_integrator_stats(r.integrator)->steps), TVI_OK);
    ck_assert(memcmp(&plain.x, &r.x, sizeof r.x) == 0); /* the steps are bit for bit those without */
    close_run(&r);
    close_run(&plain);
}
END_TEST

static int count_steps_to_failure(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p;
    *(long *)ctx = step;
    return 0;
}

/* To a time exactly, on from there, and back to the start. */
START_TEST(ends_at_a_time)
{
    static const double ends[] = {0.01, 0.02, 5, 6.3, 20, 6.3, 0};
    run r = open_orbit();
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        const double h = ends[i] > r.x.t ? 0.5 : -0.5;
        ck_assert_int_eq(tvi_integrate_to(r.integrator, h, ends[i], &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_OK);
        ck_assert(r.x.t == ends[i]);
        ck_assert_double_le(error_in_time(r.x.t, r.x.q, r.x.p), ACCURACY);
    }
    const long steps = tvi_integrator_stats(r.integrator)->steps;
    ck_assert_int_eq(tvi_integrate_to(r.integrator, 0.5, 0, &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_stats(r.integrator)->steps, steps); /* it is there */
    ck_assert_int_eq(tvi_integrate_to(r.integrator, 0.5, -1, &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_EINVAL);
    close_run(&r);
}
END_TEST

/* A hyperbola reaches t = infinity at a finite s, so that the step that would pass t_end has no solution: parts of it
 * are made, each of which is a step to the observer. */
START_TEST(escaping_orbits_reach_a_time)
{
    static const double ends[] = {30, 300, 1000, 1e4};
    const double h = _i % 2 ? -0.3 : 0.3, t_end = h > 0 ? ends[_i / 2 % 4] : -ends[_i / 2 % 4];
    const bool is_reversible = _i / 8;
    const tvi_orbit orbit = {.q = 1, .e = 2, .time = t_end};
    const state start = {0, {1, 0}, {0, sqrt(3)}};
    double x[3], v[3];
    tvi_system *base, *rescaled;
    ck_assert_int_eq(tvi_orbit_state(&orbit, 1, x, v), TVI_OK);
    ck_assert_int_eq(tvi_system_potential(&base, 2, NULL, kepler, NULL), TVI_OK);
    ck_assert_int_eq(
        (is_reversible ? tvi_system_rescaled_reversible : tvi_system_rescaled)(&rescaled, base, kepler_scale, NULL),
        TVI_OK);
    tvi_system_free(base);
    run r = open_run(rescaled, NULL, 0, &start);
    ck_assert_msg(tvi_integrate_to(r.integrator, h, t_end, &r.x.t, r.x.q, r.x.p, NULL, NULL) == TVI_OK, "%s",
                  tvi_last_error());
    ck_assert(r.x.t == t_end);
    ck_assert_double_le(hypot(r.x.q[0] - x[0], r.x.q[1] - x[1]), 1e-5 * fabs(t_end)); /* h is large there */
    close_run(&r);
}
END_TEST

/* A force that ends at q[0] = 2, where the motion goes. */
static jet edge(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sqrt(jet_sub(2, q[0]));
}

/* A step that fails for another reason still fails, with its own status, text and state, which are those of single
 * steps: a fall into the centre, where no part of a step can be made, and the end of a force, up to which parts can. */
START_TEST(parts_do_not_hide_a_failure)
{
    const state start = {0, {1, 0}, {0, 0}};
    tvi_potential_fn *const field = _i == 0 ? kepler : edge;
    run r = open_run(rescaled_system(2, NULL, field, kepler_scale), NULL, 0, &start);
    run single = open_run(rescaled_system(2, NULL, field, kepler_scale), NULL, 0, &start);
    char text[256];
    tvi_status failure;
    long steps = 0;
    do failure = tvi_step(single.integrator, 0.3, &single.x.t, single.x.q, single.x.p);
    while (failure == TVI_OK && single.x.t < 10);
    (void)snprintf(text, sizeof text, "%s", tvi_last_error());
    ck_assert_int_ne(failure, TVI_OK);
    ck_assert_int_eq(tvi_integrate_to(r.integrator, 0.3, 10, &r.x.t, r.x.q, r.x.p, count_steps_to_failure, &steps),
                     failure);
    ck_assert_str_eq(tvi_last_error(), text);
    ck_assert(memcmp(&r.x, &single.x, sizeof r.x) == 0);
    ck_assert_int_eq(steps, tvi_integrator_stats(r.integrator)->steps);
    ck_assert_int_eq(steps, tvi_integrator_stats(single.integrator)->steps);
    close_run(&r);
    close_run(&single);
}
END_TEST

/* Each argument alone; there is no step. */
START_TEST(arguments_of_a_run_to_a_time)
{
    run r = open_orbit();
    state x = r.x;
    const struct {
        tvi_integrator *integrator;
        double h, t_end, *t, *q, *p;
        tvi_status expected;
    } cases[] = {
        {NULL, 0.5, 1, &x.t, x.q, x.p, TVI_EINVAL},
        {r.integrator, 0.5, 1, NULL, x.q, x.p, TVI_EINVAL},
        {r.integrator, 0.5, 1, &x.t, NULL, x.p, TVI_EINVAL},
        {r.integrator, 0.5, 1, &x.t, x.q, NULL, TVI_EINVAL},
        {r.integrator, 0, 1, &x.t, x.q, x.p, TVI_EINVAL},
        {r.integrator, NAN, 1, &x.t, x.q, x.p, TVI_EINVAL},
        {r.integrator, 0.5, INFINITY, &x.t, x.q, x.p, TVI_EINVAL},
        {r.integrator, -0.5, 1, &x.t, x.q, x.p, TVI_EINVAL},
        {r.integrator, 0.5, -1, &x.t, x.q, x.p, TVI_EINVAL},
        {r.integrator, 0.5, 0, &x.t, x.q, x.p, TVI_OK},  /* it is there, */
        {r.integrator, -0.5, 0, &x.t, x.q, x.p, TVI_OK}, /* either way */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        ck_assert_int_eq(tvi_integrate_to(cases[i].integrator, cases[i].h, cases[i].t_end, cases[i].t, cases[i].q,
                                          cases[i].p, NULL, NULL),
                         cases[i].expected);
    ck_assert(memcmp(&x, &r.x, sizeof x) == 0);
    ck_assert_int_eq(tvi_integrator_stats(r.integrator)->steps, 0);
    close_run(&r);
}
END_TEST

static int count_steps(long step, double t, const double q[], const double p[], void *ctx)
{
    long *last = ctx;
    (void)t, (void)q, (void)p;
    ck_assert_int_eq(step, *last + 1);
    *last = step;
    return step == 8;
}

/* The same of a system that is not rescaled: the last step is the rest of the way, and is none where steps of size h
 * end there but for roundoff. */
START_TEST(ends_at_a_time_of_equal_steps)
{
    tvi_system *system;
    const state start = kepler_start(0.3);
    ck_assert_int_eq(tvi_system_potential(&system, 2, NULL, kepler, NULL), TVI_OK);
    run r = open_run(system, NULL, 0, &start), by_hand = open_run(system, NULL, 0, &start);
    long steps = 0;
    ck_assert_int_eq(tvi_integrate_to(r.integrator, 0.1, 0.73, &r.x.t, r.x.q, r.x.p, count_steps, &steps),
                     TVI_ESTOPPED);
    ck_assert_int_eq(steps, 8);
    ck_assert(r.x.t == 0.73);
    ck_assert_int_eq(run_steps(&by_hand, 0.1, 7), TVI_OK);
    ck_assert_int_eq(run_steps(&by_hand, 0.73 - by_hand.x.t, 1), TVI_OK);
    ck_assert_double_le(state_distance(2, &r.x, &by_hand.x), 1e-15);
    steps = 8;
    ck_assert_int_eq(tvi_integrate_to(r.integrator, 0.1, 10.73, &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_stats(r.integrator)->steps, 108);
    ck_assert(r.x.t == 10.73);
    tvi_integrator_free(by_hand.integrator);
    close_run(&r);
}
END_TEST

/* ---- Events ------------------------------------------------------------------------------------------------------ */

static jet at_time(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *when = ctx;
    (void)q, (void)p;
    return jet_sub(t, *when);
}

static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(q, p, 2);
}

typedef struct {
    int count[2];
    double t[2][8], error;
} met;

static int meet(int which, double t, const double q[], const double p[], void *ctx)
{
    met *m = ctx;
    m->t[which][m->count[which]++] = t;
    m->error = fmax(m->error, error_in_time(t, q, p));
    return 0;
}

/* Apocentres at odd multiples of pi, and a given time, forward or back: the largest error at them. */
static double error_at_events(bool is_back, double h)
{
    const double way = is_back ? -1 : 1, turn = acos(-1);
    double when = way * 9.75;
    tvi_event *radius, *moment;
    met m = {0};
    run r = open_orbit();
    ck_assert_int_eq(tvi_event_create(&radius, 2, TVI_FALLING, false, radial, NULL), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&moment, 2, TVI_EITHER, false, at_time, &when), TVI_OK);
    const tvi_event *const events[] = {is_back ? moment : radius, is_back ? radius : moment};
    const int apocentre = is_back;
    const tvi_status status =
        tvi_integrate_events(r.integrator, way * h, 60, events, 2, &r.x.t, r.x.q, r.x.p, NULL, meet, &m);
    ck_assert_int_eq(status, TVI_OK);
    ck_assert_int_eq(m.count[1 - apocentre], 1);
    ck_assert_double_eq_tol(m.t[1 - apocentre][0], when, 4 * DBL_EPSILON * fabs(when));
    ck_assert_int_ge(m.count[apocentre], 2);
    for (int i = 0; i < m.count[apocentre]; i++)
        if (way > 0) ck_assert_double_eq_tol(m.t[apocentre][i], way * (2 * i + 1) * turn, 2e-13);
    tvi_event_free(radius);
    tvi_event_free(moment);
    close_run(&r);
    return m.error;
}

/* The error of one run is where a random walk ends, so the root mean square of many is bounded. */
START_TEST(events_at_times)
{
    enum { RUNS = 128 };
    double squares = 0;
    for (int k = 0; k < RUNS; k++) squares += pow(error_at_events(_i, 0.5 + k / 8192.0), 2) / RUNS;
    ck_assert_double_le(sqrt(squares), ACCURACY);
    ck_assert_double_ge(sqrt(squares), 0.25 * ACCURACY);
}
END_TEST

/* The curve begins and ends with the step, and is near the orbit between. */
START_TEST(dense_output)
{
    run r = open_orbit();
    state before, at;
    for (int step = 0; step < 20; step++) {
        before = r.x;
        ck_assert_int_eq(run_steps(&r, 0.25, 1), TVI_OK);
        at = before;
        ck_assert_int_eq(tvi_dense(r.integrator, 0, at.q, at.p), TVI_OK);
        ck_assert(memcmp(&at, &before, sizeof at) == 0);
        at = r.x;
        ck_assert_int_eq(tvi_dense(r.integrator, 1, at.q, at.p), TVI_OK);
        ck_assert(memcmp(&at, &r.x, sizeof at) == 0);
        ck_assert_int_eq(tvi_dense(r.integrator, 0.3, at.q, at.p), TVI_OK);
        const double energy = (at.p[0] * at.p[0] + at.p[1] * at.p[1]) / 2 - 1 / hypot(at.q[0], at.q[1]);
        ck_assert_double_eq_tol(energy, -0.5, 1e-7);
    }
    close_run(&r);
}
END_TEST

/* ---- What is between steps --------------------------------------------------------------------------------------- */

/* A saved run goes on bit for bit, with its e; a state that is changed makes e anew. */
START_TEST(saved_states)
{
    run r = open_run(rescaled_system(2, driven_mass, driven, driven_scale), NULL, 0, &(state){0});
    tvi_integrator *other;
    state x;
    r.x = driven_start();
    ck_assert_int_eq(run_steps(&r, 0.5, 9), TVI_OK);
    char *saved = text_of_state(r.integrator, r.x.t, r.x.q, r.x.p);
    ck_assert_int_eq(tvi_integrator_create(&other, r.system, NULL), TVI_OK);
    x = (state){0};
    ck_assert_int_eq(tvi_state_from_text(other, saved, strlen(saved), &x.t, x.q, x.p), TVI_OK);
    ck_assert(memcmp(&x, &r.x, sizeof x) == 0);
    ck_assert_int_eq(run_steps(&r, 0.5, 9), TVI_OK);
    ck_assert_int_eq(tvi_integrate(other, 0.5, 9, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    ck_assert(memcmp(&x, &r.x, sizeof x) == 0);
    free(saved);
    tvi_integrator_free(other);
    close_run(&r);
}
END_TEST

/* A state of another energy has its own orbit: nothing of the one before is left. */
START_TEST(energy_is_made_anew)
{
    const state start = kepler_start(0.5);
    run r = open_orbit(), fresh = open_kepler(0.5, kepler_scale, NULL, 0);
    ck_assert_int_eq(run_steps(&r, 0.5, 3), TVI_OK);
    r.x = start;
    ck_assert_int_eq(run_steps(&r, 0.5, 40), TVI_OK);
    ck_assert_int_eq(run_steps(&fresh, 0.5, 40), TVI_OK);
    ck_assert(memcmp(&r.x, &fresh.x, sizeof r.x) == 0);
    const state exact = kepler_at(0.5, r.x.t);
    ck_assert_double_le(state_distance(2, &r.x, &exact), 1e-12);
    close_run(&r);
    close_run(&fresh);
}
END_TEST

Suite *suite_times(void)
{
    Suite *suite = suite_create("times");
    TCase *tests = tcase_create("times"), *between = tcase_create("between steps");
    tcase_add_loop_test(tests, states_at_times, 0, 2);
    tcase_add_test(tests, ends_at_a_time);
    tcase_add_loop_test(tests, escaping_orbits_reach_a_time, 0, 16);
    tcase_add_loop_test(tests, parts_do_not_hide_a_failure, 0, 2);
    tcase_add_test(tests, arguments_of_a_run_to_a_time);
    tcase_add_test(tests, ends_at_a_time_of_equal_steps);
    tcase_add_loop_test(tests, events_at_times, 0, 2);
    tcase_add_test(tests, dense_output);
    suite_add_tcase(suite, tests);
    tcase_add_test(between, saved_states);
    tcase_add_test(between, energy_is_made_anew);
    suite_add_tcase(suite, between);
    return suite;
}
