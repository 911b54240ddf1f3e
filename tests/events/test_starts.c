/* test_starts.c - Tests what an event is where a run begins: what was told is not told again, and nothing is lost,
 * however a run is cut into calls (tvi_runs.h). */
#include "diary.h"
#include "events.h"
#include "problems/texts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static jet falling(const jet q[], jet t, void *ctx)
{
    (void)t;
    jet V = jet_const(0);
    for (int i = 0; i < *(const int *)ctx; i++) V = jet_add(V, jet_mul(9.8, q[i]));
    return V;
}

static jet swinging(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_cos(q[0]));
}

static jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t;
    return jet_mul(-*(const double *)ctx, jet_pow(jet_dot(q, q, 2), -0.5));
}

static run open_method(int n, tvi_potential_fn *V, void *ctx, const char *name, int order)
{
    run r = {0};
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(name, order, &options), TVI_OK);
    ck_assert_int_eq(tvi_system_potential(&r.system, n, NULL, V, ctx), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&r.integrator, r.system, &options), TVI_OK);
    return r;
}

static run open_potential(int n, tvi_potential_fn *V, void *ctx) { return open_method(n, V, ctx, "galerkin", 16); }

static tvi_status go(run *r, double h, long steps, const tvi_event *const events[], int count, diary *d)
{
    d->n = tvi_system_dimension(r->system);
    return tvi_integrate_events(r->integrator, h, steps, events, count, &r->x.t, r->x.q, r->x.p, NULL, note_event, d);
}

/* ---- Runs in pieces ---------------------------------------------------------------------------------------------- */

static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(q, p, 2);
}

/* All pericentres of a hundred revolutions from an apocentre, which is no event of the run, in calls of 1 to 4000
 * steps. */
START_TEST(pericentres_in_pieces)
{
    const int pieces[] = {4000, 1000, 100, 20, 10, 1};
    static diary d;
    double mu = 1;
    run r = open_potential(2, kepler, &mu);
    tvi_event *event = event_of(2, TVI_RISING, false, radial, NULL);
    d = (diary){0};
    r.x = (point){0, {1.3}, {0, sqrt(0.7 / 1.3)}};
    for (int i = 0; i < 4000 / pieces[_i]; i++)
        ck_assert_int_eq(go(&r, 2 * PI / 40, pieces[_i], (const tvi_event *[]){event}, 1, &d), TVI_OK);
    ck_assert_int_eq(d.count, 100);
    tvi_event_free(event);
    run_close(&r);
}
END_TEST

static jet since(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p;
    return jet_sub(t, *(const double *)ctx);
}

/* Soon after the end of a step, or at it. */
START_TEST(soon_after_a_call)
{
    const double after[] = {0, 1e-16, 1e-15, 1e-13, 1e-11, 2.9e-11, 3.2e-11, 1e-10};
    for (int steps = 1; steps <= 4; steps *= 2) {
        static diary d;
        double T = 0.25 + after[_i];
        run r = open_potential(1, swinging, NULL);
        tvi_event *event = event_of(1, TVI_RISING, false, since, &T);
        d = (diary){0};
        r.x = (point){0, {1}, {0}};
        for (int k = 0; k < 4; k += steps)
            ck_assert_int_eq(go(&r, 0.25, steps, (const tvi_event *[]){event}, 1, &d), TVI_OK);
        ck_assert_int_eq(d.count, 1);
        ck_assert_double_eq_tol(d.at[0].t, T, DBL_EPSILON);
        tvi_event_free(event);
        run_close(&r);
    }
}
END_TEST

/* ---- After a stop ------------------------------------------------------------------------------------------------ */

static jet first(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

static jet second(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[1];
}

/* Two balls from one height, or nearly: both bounces are told, and both balls are where they were let go after the same
 * flight. */
START_TEST(two_balls)
{
    const double apart = (double[]){0, 1e-16, 1e-15, 1e-13, 1e-11, 1e-9}[_i];
    int two = 2, bounces = 0;
    run r = open_potential(2, falling, &two);
    tvi_event *a = event_of(2, TVI_FALLING, true, first, NULL), *b = event_of(2, TVI_FALLING, true, second, NULL);
    const double end = 2 * sqrt(2 / 9.8);
    r.x = (point){0, {1, 1 + apart}, {0, 0}};
    while (r.x.t < end - 0.1) {
        static diary d;
        d = (diary){0};
        const tvi_status status = go(&r, 0.1, 1, (const tvi_event *[]){a, b}, 2, &d);
        ck_assert(status == TVI_OK || status == TVI_ESTOPPED);
        ck_assert_int_eq(status == TVI_ESTOPPED, d.count > 0);
        for (int i = 0; i < d.count; i++) r.x.p[d.which[i]] = -r.x.p[d.which[i]];
        bounces += d.count;
    }
    ck_assert_int_eq(bounces, 2);
    for (int i = 0; i < 2; i++) {
        const double to_top = r.x.p[i] / 9.8, height = r.x.q[i] + 9.8 * to_top * to_top / 2;
        ck_assert_double_eq_tol(height, 1 + i * apart, 1e-14);
    }
    tvi_event_free(a);
    tvi_event_free(b);
    run_close(&r);
}
END_TEST

static jet above(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_sub(q[0], *(const double *)ctx);
}

/* Methods whose curves are as accurate as their steps, and methods whose curves are not. */
static const struct {
    const char *name;
    int order;
} bouncing[] = {{"galerkin", 16}, {"taylor", 8}, {"stormer-verlet", 2}, {"midpoint", 2}, {"poincare", 4}, {"right", 2}};
enum { BOUNCING = sizeof bouncing / sizeof *bouncing };

/* A ball that loses a fifth of its velocity at each bounce, or nearly all of it: flights are told down to the
 * resolution of the time; then comes a refusal, which leaves the state, and never a ball below the floor. */
START_TEST(bouncing_ball)
{
    const double h = (double[]){0.1, 0.01}[_i % 2], left = (double[]){0.8, 1e-5}[_i / 4 % 2];
    double floor = (double[]){0, 6.4e6}[_i / 2 % 2];
    int one = 1, bounces = 0;
    run r = open_method(1, falling, &one, bouncing[_i / 8].name, bouncing[_i / 8].order);
    tvi_event *event = event_of(1, TVI_FALLING, true, above, &floor);
    static diary d;
    r.x = (point){0, {floor + 10}, {0}};
    double flight = INFINITY;
    for (;;) {
        const point start = r.x;
        d = (diary){0};
        const tvi_status status = go(&r, h, (long)(20 / h), (const tvi_event *[]){event}, 1, &d);
        if (status == TVI_ENOCONV) {
            ck_assert(same_point(&r.x, &start));
            ck_assert_ptr_nonnull(strstr(tvi_last_error(), "events[0] is reached again before the time moves"));
            break;
        }
        ck_assert_int_eq(status, TVI_ESTOPPED);
        ck_assert_double_eq_tol(r.x.q[0], floor, 2 * DBL_EPSILON * (1 + floor));
        const double roundoff = DBL_EPSILON * (r.x.t + (flight > h / 8 ? floor / fabs(start.p[0]) : 0));
        if (bounces > 0) ck_assert_double_eq_tol(r.x.t - start.t, flight, 1e-14 * flight + 4 * roundoff);
        r.x.p[0] = -left * r.x.p[0];
        flight = 2 * r.x.p[0] / 9.8;
        ck_assert_int_lt(++bounces, 200);
    }
    ck_assert_double_le(flight, 4 * DBL_EPSILON * r.x.t);
    ck_assert_double_ge(flight / left, DBL_EPSILON / 4 * r.x.t);
    tvi_event_free(event);
    run_close(&r);
}
END_TEST

static jet of_ball(const jet q[], const jet p[], jet t, void *ctx)
{
    const int i = *(const int *)ctx;
    (void)p, (void)t;
    return jet_mul(1 + i, q[i % 6]);
}

/* Many balls let go together, of which nothing is made when they come: each is told once. */
START_TEST(many_balls)
{
    enum { BALLS = 6, FUNCTIONS = 40 };
    static diary d;
    int balls = BALLS, told[FUNCTIONS] = {0};
    static int which[FUNCTIONS];
    run r = open_potential(BALLS, falling, &balls);
    tvi_event *events[FUNCTIONS];
    for (int i = 0; i < FUNCTIONS; i++) {
        which[i] = i;
        events[i] = event_of(BALLS, i % 2 ? TVI_FALLING : TVI_EITHER, true, of_ball, &which[i]);
    }
    r.x = (point){0, {1, 1 + 1e-16, 1 + 3e-16, 1 + 1e-15, 1 + 5e-15, 1 + 1e-14}, {0}};
    while (r.x.t < 0.8) {
        d = (diary){0};
        const tvi_status status = go(&r, 0.1, 1, (const tvi_event *const *)events, FUNCTIONS, &d);
        ck_assert(status == TVI_OK || status == TVI_ESTOPPED);
        for (int i = 0; i < d.count; i++) {
            told[d.which[i]]++;
            ck_assert_double_le(fabs(d.at[i].q[d.which[i] % BALLS]), 1e-13);
        }
    }
    for (int i = 0; i < FUNCTIONS; i++) {
        ck_assert_int_eq(told[i], 1);
        tvi_event_free(events[i]);
    }
    run_close(&r);
}
END_TEST

/* A stop tells no more than its own time has, however many roots the step has. */
START_TEST(one_of_many_stops)
{
    enum { TIMES = 40 };
    static diary d;
    double T[TIMES];
    tvi_event *events[TIMES];
    run r = open_potential(1, swinging, NULL);
    for (int i = 0; i < TIMES; i++) {
        T[i] = 0.1 + 0.01 * i;
        events[i] = event_of(1, TVI_RISING, i == 3, since, &T[i]);
    }
    d = (diary){0};
    ck_assert_int_eq(go(&r, 1, 1, (const tvi_event *const *)events, TIMES, &d), TVI_ESTOPPED);
    ck_assert_int_eq(d.count, 4);
    ck_assert_int_eq(go(&r, 1, 1, (const tvi_event *const *)events, TIMES, &d), TVI_OK);
    ck_assert_int_eq(d.count, TIMES);
    for (int i = 0; i < TIMES; i++) {
        ck_assert_int_eq(d.which[i], i);
        ck_assert_double_eq_tol(d.at[i].t, T[i], 2 * DBL_EPSILON);
        tvi_event_free(events[i]);
    }
    run_close(&r);
}
END_TEST

static jet other_form(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_sub(jet_mul(q[0], 1 / *(const double *)ctx), 1);
}

/* Another function of the same floor, which waits for the direction that never comes. */
START_TEST(the_other_direction)
{
    static diary d;
    int one = 1;
    for (double floor = 0.3; floor < 3; floor *= 1.3) {
        run r = open_potential(1, falling, &one);
        tvi_event *falls = event_of(1, TVI_FALLING, true, above, &floor);
        tvi_event *rises = event_of(1, TVI_RISING, false, other_form, &floor);
        d = (diary){0};
        r.x = (point){0, {floor + 1}, {0}};
        for (int bounces = 0; bounces < 50; bounces++) {
            ck_assert_int_eq(go(&r, 0.1, 100, (const tvi_event *[]){falls, rises}, 2, &d), TVI_ESTOPPED);
            r.x.p[0] = -r.x.p[0];
        }
        ck_assert_int_eq(d.count, 50);
        tvi_event_free(falls);
        tvi_event_free(rises);
        run_close(&r);
    }
}
END_TEST

static jet at_noon(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p, (void)ctx;
    return jet_sin(jet_mul(2 * PI, t));
}

/* A terminal event of the time itself, whose resolution is 5e-10 there: each day once, also where the run goes on in an
 * integrator that has loaded the state. */
START_TEST(julian_days)
{
    static diary d;
    double mu = 2.9591220828559e-4;
    run r = open_potential(2, kepler, &mu);
    tvi_event *event = event_of(2, TVI_RISING, true, at_noon, NULL);
    d = (diary){0};
    r.x = (point){2451545.1, {1}, {0, 0.0172}};
    for (int k = 0; k < 8; k++) {
        if (_i) {
            tvi_integrator *other;
            char *text = text_of_state(r.integrator, r.x.t, r.x.q, r.x.p);
            if (_i == 2) memcpy(history_hash_in(text), "0123456789abcdef", 16), sign_text(text); /* another version */
            ck_assert_int_eq(tvi_integrator_create(&other, r.system, NULL), TVI_OK);
            ck_assert_int_eq(tvi_state_from_text(other, text, strlen(text), &r.x.t, r.x.q, r.x.p), TVI_OK);
            free(text);
            tvi_integrator_free(r.integrator);
            r.integrator = other;
        }
        ck_assert_int_eq(go(&r, 1, 1000, (const tvi_event *[]){event}, 1, &d), TVI_ESTOPPED);
        ck_assert_double_eq_tol(r.x.t, 2451546 + k, 1e-9);
    }
    tvi_event_free(event);
    run_close(&r);
}
END_TEST

/* ---- Any start --------------------------------------------------------------------------------------------------- */

static jet beyond(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_sub(jet_sqr(q[0]), *(const double *)ctx);
}

/* Let go at rest on the event, a pendulum comes back to it after half a period: the first coefficient of g is 0, the
 * second says that it falls. With h small or large; a little outside it passes at once. */
START_TEST(released_on_the_event)
{
    const double h = (double[]){0.3, 0.2, 0.1, 0.01, 1e-4}[_i];
    static diary d;
    double level = 0.1 * 0.1;
    run r = open_potential(1, swinging, NULL);
    tvi_event *falls = event_of(1, TVI_FALLING, true, beyond, &level);
    d = (diary){0};
    r.x = (point){0, {0.1}, {0}};
    ck_assert_int_eq(go(&r, h, (long)(2 / h), (const tvi_event *[]){falls}, 1, &d), TVI_OK);
    ck_assert_int_eq(d.count, 0);
    r.x = (point){0, {0.1 * (1 + 1e-8)}, {0}};
    ck_assert_int_eq(go(&r, h, (long)(2 / h), (const tvi_event *[]){falls}, 1, &d), TVI_ESTOPPED);
    ck_assert_double_eq_tol(r.x.t, sqrt(2e-9 / sin(0.1)), 1e-9); /* q'' = -sin q */
    tvi_event_free(falls);
    run_close(&r);
}
END_TEST

/* On a circular orbit q.p is nothing but roundoff: there are no events, in one call or many. A little off it has two a
 * revolution; the run ends far from one, where q.p is more than roundoff. */
START_TEST(roundoff_is_no_event)
{
    enum { STEPS = 196 };
    static diary d;
    double mu = 1;
    for (int pieces = 1; pieces <= STEPS; pieces *= STEPS) {
        run r = open_potential(2, kepler, &mu);
        tvi_event *event = event_of(2, TVI_EITHER, false, radial, NULL);
        d = (diary){0};
        r.x = (point){0, {1}, {0, _i ? 1 + 1e-9 : 1}};
        for (int k = 0; k < pieces; k++)
            ck_assert_int_eq(go(&r, PI / 10, STEPS / pieces, (const tvi_event *[]){event}, 1, &d), TVI_OK);
        ck_assert_int_eq(d.count, _i ? 19 : 0);
        tvi_event_free(event);
        run_close(&r);
    }
}
END_TEST

Suite *suite_starts(void)
{
    Suite *suite = suite_create("starts");
    TCase *tcase = tcase_create("starts");
    tcase_add_loop_test(tcase, pericentres_in_pieces, 0, 6);
    tcase_add_loop_test(tcase, soon_after_a_call, 0, 8);
    tcase_add_loop_test(tcase, two_balls, 0, 6);
    tcase_add_loop_test(tcase, bouncing_ball, 0, 8 * BOUNCING);
    tcase_add_test(tcase, many_balls);
    tcase_add_test(tcase, one_of_many_stops);
    tcase_add_test(tcase, the_other_direction);
    tcase_add_loop_test(tcase, julian_days, 0, 3);
    tcase_add_loop_test(tcase, released_on_the_event, 0, 5);
    tcase_add_loop_test(tcase, roundoff_is_no_event, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
