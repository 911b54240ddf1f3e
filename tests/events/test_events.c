/* test_events.c - Tests what is told of events: all, once, in order, at their time, in a state as good as that of a
 * step. */
#include "diary.h"
#include "events.h"

#include <float.h>
#include <math.h>

/* ---- States as good as those of steps ---------------------------------------------------------------------------- */

/* q.p, which rises through 0 at the pericentre. */
static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(q, p, 2);
}

static int see_steps(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)step, (void)t;
    add_drift(ctx, q, p);
    return 0;
}

typedef struct {
    drift steps, events; /* see_steps takes it for the first */
    double g, period_error, t_before;
    long count;
} passages;

static int see_passage(int which, double t, const double q[], const double p[], void *ctx)
{
    passages *d = ctx;
    (void)which;
    add_drift(&d->events, q, p);
    d->g = fmax(d->g, fabs(q[0] * p[0] + q[1] * p[1]));
    if (d->count++ > 0) d->period_error = fmax(d->period_error, fabs(t - d->t_before - 3.96160805282904));
    d->t_before = t;
    return 0;
}

static const struct {
    const char *method;
    int order, orbits;
    double h, period_error;
} kepler_rows[] = {
    {NULL, 0, 1000, 0.25, 2e-11},     {"midpoint", 20, 1000, 0.25, 2e-11},    {"poincare", 20, 1000, 0.25, 1e-9},
    {"midpoint", 8, 1000, 0.1, 1e-5}, {"both-ends", 8, 100, 0.1, 1e-5},       {"right", 6, 100, 0.1, 1e-3},
    {"taylor", 16, 1000, 0.1, 1e-9},  {"stormer-verlet", 2, 1000, 0.02, 0.1}, {"svhd", 2, 1000, 0.02, 0.1}};
enum { KEPLER_ROWS = sizeof kepler_rows / sizeof *kepler_rows };

/* Energy and angular momentum at the perihelia are within 10 times what they are at steps, g is roundoff, and a period
 * lies between two of them. */
START_TEST(perihelia_are_as_good_as_steps)
{
    run r = run_open(&scene_kepler, kepler_rows[_i].method, kepler_rows[_i].order);
    tvi_event *event = event_of(2, TVI_RISING, false, radial, NULL);
    const double h = kepler_rows[_i].h;
    passages d = {0};
    const long steps = lround(ceil(kepler_rows[_i].orbits * 3.96160805282904 / h));
    const tvi_event *const events[] = {event};
    ck_assert_int_eq(
        tvi_integrate_events(r.integrator, h, steps, events, 1, &r.x.t, r.x.q, r.x.p, see_steps, see_passage, &d),
        TVI_OK);
    ck_assert_int_eq(d.count, kepler_rows[_i].orbits);
    ck_assert_double_le(d.events.energy, 10 * d.steps.energy);
    ck_assert_double_le(d.events.momentum, 10 * d.steps.momentum);
    ck_assert_double_le(d.g, 4e-15);
    ck_assert_double_le(d.period_error, kepler_rows[_i].period_error);
    tvi_event_free(event);
    run_close(&r);
}
END_TEST

/* The control: at the same perihelia the curve of the step is not good enough for that. */
START_TEST(the_curve_is_not_as_good)
{
    run r = run_open(&scene_kepler, NULL, 0);
    drift at_steps = {0}, on_curve = {0};
    int passed = 0;
    double before = 0, after = 0;
    for (int step = 0; step < 1600; step++, before = after) {
        ck_assert_int_eq(run_steps(&r, 0.25, 1), TVI_OK);
        add_drift(&at_steps, r.x.q, r.x.p);
        after = r.x.q[0] * r.x.p[0] + r.x.q[1] * r.x.p[1];
        if (before >= 0 || after < 0) continue;
        double q[2], p[2], low = 0, high = 1;
        while (high - low > 1e-15) {
            const double middle = (low + high) / 2;
            ck_assert_int_eq(tvi_dense(r.integrator, middle, q, p), TVI_OK);
            *(q[0] * p[0] + q[1] * p[1] < 0 ? &low : &high) = middle;
        }
        add_drift(&on_curve, q, p);
        passed++;
    }
    ck_assert_int_eq(passed, 101);
    ck_assert_double_gt(on_curve.energy, 1000 * at_steps.energy);
    ck_assert_double_gt(on_curve.momentum, 1000 * at_steps.momentum);
    run_close(&r);
}
END_TEST

/* ---- Every method and form --------------------------------------------------------------------------------------- */

/* q_0 less its start, q_0 p_0 less a number, and the time. */
static jet about_the_start(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_sub(q[0], *(const double *)ctx);
}

static jet product(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(q[0], p[0]), 0.01);
}

static jet beats(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p;
    return jet_sin(jet_mul(*(const double *)ctx, t));
}

/* The steps are bit for bit those without events; events come in order; rising and falling ones are all of them. */
START_TEST(steps_are_not_disturbed)
{
    const pairing *x = &pairings[_i];
    static diary all, half[2];
    double level = x->scene->q[0] * 0.9 + 0.01, speed = 3;
    const int n = x->scene->n;
    run plain = run_open(x->scene, x->method, x->order);
    ck_assert_int_eq(run_steps(&plain, x->h, 100), TVI_OK);
    for (int part = -1; part < 2; part++) {
        const tvi_direction direction = part < 0 ? TVI_EITHER : part ? TVI_RISING : TVI_FALLING;
        diary *d = part < 0 ? &all : &half[part];
        run r = run_open(x->scene, x->method, x->order);
        tvi_event *events[] = {event_of(n, direction, false, about_the_start, &level),
                               event_of(n, direction, false, product, NULL),
                               event_of(n, direction, false, beats, &speed)};
        *d = (diary){0};
        ck_assert_int_eq(watch(&r, x->h, 100, events, 3, d), TVI_OK);
        ck_assert(same_point(&r.x, &plain.x));
        ck_assert_int_eq(tvi_integrator_stats(r.integrator)->passes, tvi_integrator_stats(plain.integrator)->passes);
        ck_assert_int_eq(d->steps, 100);
        run_close(&r);
    }
    ck_assert_int_eq(all.count, half[0].count + half[1].count);
    ck_assert_int_gt(all.count, 1);
    for (int i = 0; i < all.count; i++) {
        const point *at = &all.at[i];
        const double scale = 1 + fabs(at->q[0]) + fabs(at->p[0]) * (1 + fabs(at->q[0])) + speed * at->t;
        const double g[] = {at->q[0] - level, at->q[0] * at->p[0] - 0.01, sin(speed * at->t)};
        ck_assert_double_le(fabs(g[all.which[i]]), 8 * DBL_EPSILON * scale);
        ck_assert(i == 0 || at->t >= all.at[i - 1].t);
        ck_assert_int_eq(all.last_step[i], (long)floor(at->t / x->h * (1 - 1e-12)));
    }
    run_close(&plain);
}
END_TEST

/* ---- All, once, in order ----------------------------------------------------------------------------------------- */

/* A pendulum serves the time. */
static run clock_run(void) { return run_open(&scene_pendulum, "midpoint", 4); }

/* sin 47 t has three to four zeros in a step of 1/4, and so has sin 31 t. */
START_TEST(many_in_one_step)
{
    static diary d;
    double fast = 47, slow = 31;
    run r = clock_run();
    d = (diary){0};
    tvi_event *events[] = {event_of(1, TVI_EITHER, false, beats, &fast), event_of(1, TVI_EITHER, false, beats, &slow)};
    ck_assert_int_eq(watch(&r, 0.25, 40, events, 2, &d), TVI_OK);
    ck_assert_int_eq(d.count, (int)(470 / 3.14159265358979323846) + (int)(310 / 3.14159265358979323846));
    int seen[2] = {0};
    for (int i = 0; i < d.count; i++) {
        const double speed = d.which[i] ? slow : fast;
        ck_assert_double_eq_tol(d.at[i].t, ++seen[d.which[i]] * 3.14159265358979323846 / speed, 1e-14);
        const bool together = seen[0] % 47 == 0 && seen[1] % 31 == 0; /* at multiples of pi */
        ck_assert(i == 0 || d.at[i].t > d.at[i - 1].t || (together && d.at[i].t == d.at[i - 1].t));
    }
    run_close(&r);
}
END_TEST

/* (t - T)^2 - w^2. */
static jet dip(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *T_w = ctx;
    (void)q, (void)p;
    return jet_sub(jet_sqr(jet_sub(t, T_w[0])), T_w[1] * fabs(T_w[1]));
}

/* Two zeros a short way apart, inside a step, next to its ends and across them; and none. */
START_TEST(dips_are_followed)
{
    static const double places[] = {0.40, 0.26, 0.2501, 0.25, 0.2499, 0.03125, 0.499999, 1.5e-3};
    static const double widths[] = {1e-2, 1e-3, 1e-4, 1e-5};
    double T_w[] = {places[_i / 4], widths[_i % 4]};
    for (int sign = -1; sign <= 1; sign += 2) {
        static diary d;
        run r = clock_run();
        d = (diary){0};
        T_w[1] = sign * widths[_i % 4];
        tvi_event *events[] = {event_of(1, TVI_EITHER, false, dip, T_w)};
        ck_assert_int_eq(watch(&r, 0.25, 3, events, 1, &d), TVI_OK);
        const bool begins_inside = T_w[0] < widths[_i % 4];
        ck_assert_int_eq(d.count, sign < 0 ? 0 : 2 - begins_inside);
        for (int i = 0; i < d.count; i++) {
            const double t = T_w[0] + (i == 1 || begins_inside ? 1 : -1) * T_w[1];
            ck_assert_double_eq_tol(d.at[i].t, t, DBL_EPSILON / T_w[1]);
        }
        run_close(&r);
    }
}
END_TEST

static jet since(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p;
    return jet_sub(t, *(const double *)ctx);
}

/* A zero at the end of a step is told once, with that step, and its state is that of the step; one at the start of the
 * run is none; also where each step is a call. */
START_TEST(at_the_ends_of_steps)
{
    static diary whole, pieces;
    double T[] = {0, 0.25, 0.5, 0.75};
    run a = clock_run(), b = clock_run(), plain = clock_run();
    tvi_event *events[4], *again[4][4];
    whole = pieces = (diary){0};
    for (int i = 0; i < 4; i++) events[i] = event_of(1, TVI_EITHER, false, since, &T[i]);
    ck_assert_int_eq(watch(&a, 0.25, 4, events, 4, &whole), TVI_OK);
    for (int step = 0; step < 4; step++) {
        for (int i = 0; i < 4; i++) again[step][i] = event_of(1, TVI_EITHER, false, since, &T[i]);
        ck_assert_int_eq(watch(&b, 0.25, 1, again[step], 4, &pieces), TVI_OK);
    }
    ck_assert(same_point(&a.x, &b.x));
    ck_assert_int_eq(whole.count, 3);
    ck_assert_int_eq(pieces.count, 3);
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(run_steps(&plain, 0.25, 1), TVI_OK);
        ck_assert_int_eq(whole.which[i], i + 1);
        ck_assert(same_point(&whole.at[i], &plain.x));
        ck_assert(same_point(&pieces.at[i], &plain.x));
        ck_assert_int_eq(whole.last_step[i], i);
    }
    run_close(&a);
    run_close(&b);
    run_close(&plain);
}
END_TEST

/* ---- The end of a run -------------------------------------------------------------------------------------------- */

/* A terminal event, or an observer, leaves its state, tells no later one, and the run goes on as from a new state: the
 * event it stands on is not met again. Forward and back. */
START_TEST(terminal_events_end_the_run)
{
    const pairing *x = &pairings[_i / 2];
    const double h = _i % 2 ? -x->h : x->h;
    double level = x->scene->q[0] * 0.9 + 0.01, never = 1e9;
    const int n = x->scene->n;
    run r = run_open(x->scene, x->method, x->order), other = run_open(x->scene, x->method, x->order), fresh = other;
    for (int turn = 0; turn < 3; turn++) {
        static diary d, e;
        const point before = r.x;
        d = (diary){0};
        e = (diary){.stop_at = 1};
        tvi_event *events[] = {event_of(n, TVI_EITHER, false, since, &never),
                               event_of(n, TVI_EITHER, true, about_the_start, &level)};
        tvi_event *same = event_of(n, TVI_EITHER, false, about_the_start, &level);
        const tvi_status status = watch(&r, h, 1000, events, 2, &d);
        if (status == TVI_OK) { /* it went for good */
            tvi_event_free(same);
            break;
        }
        ck_assert_int_eq(status, TVI_ESTOPPED);
        ck_assert_int_eq(d.count, 1);
        ck_assert_int_eq(d.which[0], 1);
        ck_assert(same_point(&r.x, &d.at[0]));
        ck_assert_double_gt(fabs(r.x.t - before.t), 1e-3 * x->h);
        ck_assert_double_le(fabs(r.x.q[0] - level), 4 * DBL_EPSILON * (1 + fabs(level)));
        ck_assert_int_eq(watch(&other, h, 1000, &same, 1, &e), TVI_ESTOPPED);
        ck_assert(same_point(&r.x, &other.x));
    }
    ck_assert(r.x.t != 0);
    fresh = run_open(x->scene, x->method, x->order);
    fresh.x = r.x;
    tvi_integrator_reset(r.integrator);
    ck_assert_int_eq(run_steps(&r, h, 3), run_steps(&fresh, h, 3));
    ck_assert(same_point(&r.x, &fresh.x));
    run_close(&r);
    run_close(&other);
    run_close(&fresh);
}
END_TEST

/* After a terminal event, inside a step or at its end, the low-order parts are forgotten without a reset. */
START_TEST(an_event_is_a_new_state)
{
    static diary d;
    double T = _i ? 3.25 : 3.1;
    run r = run_open(&scene_kepler, NULL, 0), fresh = run_open(&scene_kepler, NULL, 0);
    d = (diary){0};
    tvi_event *event = event_of(2, TVI_RISING, true, since, &T);
    ck_assert_int_eq(watch(&r, 0.25, 100, &event, 1, &d), TVI_ESTOPPED);
    ck_assert_double_eq_tol(r.x.t, T, DBL_EPSILON * 2);
    fresh.x = r.x;
    ck_assert_int_eq(run_steps(&r, 0.25, 20), TVI_OK);
    ck_assert_int_eq(run_steps(&fresh, 0.25, 20), TVI_OK);
    ck_assert(same_point(&r.x, &fresh.x));
    run_close(&r);
    run_close(&fresh);
}
END_TEST

Suite *suite_events(void)
{
    Suite *suite = suite_create("events");
    TCase *tcase = tcase_create("events");
    tcase_add_loop_test(tcase, perihelia_are_as_good_as_steps, 0, KEPLER_ROWS);
    tcase_add_test(tcase, the_curve_is_not_as_good);
    tcase_add_loop_test(tcase, steps_are_not_disturbed, 0, PAIRINGS);
    tcase_add_test(tcase, many_in_one_step);
    tcase_add_loop_test(tcase, dips_are_followed, 0, 32);
    tcase_add_test(tcase, at_the_ends_of_steps);
    tcase_add_loop_test(tcase, terminal_events_end_the_run, 0, 2 * PAIRINGS);
    tcase_add_loop_test(tcase, an_event_is_a_new_state, 0, 2);
    add_refusals(tcase);
    suite_add_tcase(suite, tcase);
    return suite;
}
