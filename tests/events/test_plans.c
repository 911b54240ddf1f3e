/* test_plans.c - Tests runs by a plan: every way goes with events, times, tangent vectors and observers, none of which
 * changes the steps; where runs end, and what is refused. */
#include "events.h"
#include "plans.h"
#include "problems/refusals.h"
#include "integrator/integrator.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Every way, with everything ---------------------------------------------------------------------------------- */

typedef enum { STEPS, TO, AT, AT_AND_TO, TOLERANCE, WAYS } way_to_go;
enum { STEP_COUNT = 23, RESULTS = 7 };

/* The plan of a way, from t = 0; of 23 steps, the last of them shorter where it goes to a time. */
static tvi_run_plan plan_of_way(way_to_go way, double h, double times[])
{
    static const double parts[RESULTS] = {0, 0.3, 0.35, 4, 4, 11.7, 22.6};
    tvi_run_plan plan = {.h = h, .size = sizeof(tvi_run_plan)};
    for (int i = 0; i < RESULTS; i++) times[i] = parts[i] * h + 0.0; /* no -0 */
    if (way == STEPS) plan.steps = STEP_COUNT;
    if (way == TO || way == AT_AND_TO || way == TOLERANCE) plan.has_t_end = true, plan.t_end = (STEP_COUNT - 0.25) * h;
    if (way == AT || way == AT_AND_TO) plan.times = times, plan.time_count = RESULTS, plan.at_time = see_time;
    if (way == TOLERANCE) plan.h = 0, plan.tolerance = 1e-10, plan.largest_step = 1.5 * fabs(h);
    return plan;
}

/* After each step D is, bit for bit, that of tvi_step_tangent with the size of that step, from the state before it. A
 * rescaled system goes on, since its energy belongs to the state. */
static void expect_columns_of_steps(const run *r, point x, const plan_diary *d)
{
    tvi_integrator *other;
    static plan_diary first;
    ck_assert_int_eq(tvi_integrator_create(&other, r->system, tvi_integrator_options(r->integrator)), TVI_OK);
    start_diary(&first, r, COLUMNS);
    for (const told *s = next_told(d, STEP, -1); s; s = next_told(d, STEP, (int)(s - d->told))) {
        ck_assert_int_eq(tvi_step_tangent(other, s->h, &x.t, x.q, x.p, first.D, COLUMNS), TVI_OK);
        ck_assert(memcmp(first.D, s->D, (size_t)d->numbers * sizeof *s->D) == 0);
        if (!tvi_is_rescaled(other)) x = s->x;
    }
    tvi_integrator_free(other);
}

/* Levels that the orbit crosses. */
static void find_levels(run *r, double h, double level[2])
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    point x = r->x;
    for (int k = 0; k < STEP_COUNT - 1; k++) {
        ck_assert_int_eq(tvi_step(r->integrator, h, &x.t, x.q, x.p), TVI_OK);
        low[0] = fmin(low[0], x.q[0]), high[0] = fmax(high[0], x.q[0]);
        low[1] = fmin(low[1], x.p[0]), high[1] = fmax(high[1], x.p[0]);
    }
    tvi_integrator_reset(r->integrator);
    for (int i = 0; i < 2; i++) level[i] = low[i] + 0.512 * (high[i] - low[i]);
}

/* Runs of one way with everything that there is, and without. */
static void run_with_all(run *r, const tvi_run_plan *plan, tvi_event *const events[2])
{
    static plan_diary all[ALL];
    const point start = r->x;
    point end = start;
    for (int with = 0; with < ALL; with++) {
        plan_diary *d = &all[with];
        start_diary(d, r, with & WITH_D ? COLUMNS : 0);
        d->scrawls = with == ALL - 1; /* what is written to D at times and events is gone after them */
        r->x = start;
        tvi_integrator_reset(r->integrator);
        ck_assert_msg(run_with(r, *plan, with, events, d) == TVI_OK, "%s", tvi_last_error());
        if (with == 0) end = r->x;
        ck_assert(same_point(&r->x, &end));
        expect_same_told(&all[0], d, TIME, false);
        if (with & WITH_EVENTS)
            expect_same_told(&all[with & WITH_D ? WITH_EVENTS + WITH_D : WITH_EVENTS], d, EVENT, with & WITH_D);
        if (with & WITH_STEPS) expect_same_told(&all[WITH_STEPS], d, STEP, false);
        if (with & WITH_D) expect_same_told(&all[WITH_D], d, TIME, true);
        if (with & WITH_D) ck_assert(memcmp(d->D, all[WITH_D].D, sizeof d->D) == 0);
    }
    ck_assert_int_ge(all[ALL - 1].of_kind[STEP], STEP_COUNT / 3);
    ck_assert_int_ge(all[ALL - 1].of_kind[EVENT], 1);
    r->x = start;
    expect_columns_of_steps(r, start, &all[ALL - 1]);
}

START_TEST(nothing_changes_the_steps)
{
    const pairing *pair = &pairings[_i / 4];
    const bool is_rescaled = _i % 2;
    const double h = _i / 2 % 2 ? -pair->h : pair->h;
    double times[RESULTS], level[2];
    run r;
    tvi_system *base;
    if (open_pairing(&r, pair, is_rescaled, &base)) {
        find_levels(&r, h, level);
        tvi_event *const events[] = {event_at_place(pair->scene->n, false, &level[0]),
                                     event_at_momentum(pair->scene->n, false, &level[1])};
        for (int way = 0; way < WAYS; way++) {
            const bool has_way = way != TOLERANCE || (!is_rescaled && strcmp(pair->method, "taylor") == 0);
            const tvi_run_plan plan = plan_of_way((way_to_go)way, h, times);
            if (has_way) run_with_all(&r, &plan, events);
        }
        for (int i = 0; i < 2; i++) tvi_event_free(events[i]);
    }
    close_pairing(&r, base);
}
END_TEST

/* ---- Where runs end ---------------------------------------------------------------------------------------------- */

/* At a terminal event, or one whose observer stops the run: there, with the state and D that were told. The run that
 * goes on from there has left it. */
START_TEST(runs_end_at_events)
{
    static plan_diary d;
    const way_to_go way = (way_to_go)(_i / 2);
    const bool is_terminal = _i % 2;
    run r = run_open(&scene_kepler, way == TOLERANCE ? "taylor" : "galerkin", 12);
    const double level = 0;
    double times[RESULTS];
    tvi_event *event = event_at_place(2, is_terminal, &level);
    tvi_run_plan plan = plan_of_way(way, 0.25, times);
    start_diary(&d, &r, COLUMNS);
    d.stops = EVENT, d.stop_at = is_terminal ? 0 : 1;
    plan.events = (const tvi_event *const *)&event, plan.event_count = 1, plan.on_event = see_event;
    plan.D = d.D, plan.columns = COLUMNS, plan.ctx = &d;
    ck_assert_int_eq(tvi_run(r.integrator, &plan, &r.x.t, r.x.q, r.x.p), TVI_ESTOPPED);
    const told *last = &d.told[d.count - 1];
    ck_assert_int_eq(last->kind, EVENT);
    ck_assert(same_point(&r.x, &last->x));
    ck_assert(memcmp(d.D, last->D, sizeof d.D) == 0);
    ck_assert_double_le(fabs(r.x.q[0]), 1e-15);
    const int told_then = d.of_kind[EVENT], times_then = d.of_kind[TIME];
    d.stop_at = 0;
    if (way == AT || way == AT_AND_TO) plan.times += times_then, plan.time_count -= times_then;
    d.times_before = times_then;
    const tvi_status status = tvi_run(r.integrator, &plan, &r.x.t, r.x.q, r.x.p);
    ck_assert_int_eq(status, is_terminal && d.of_kind[EVENT] > told_then ? TVI_ESTOPPED : TVI_OK);
    if (plan.times && status == TVI_OK) ck_assert_int_eq(d.of_kind[TIME], RESULTS);
    for (int i = 0; i < d.count; i++)
        ck_assert(&d.told[i] == last || d.told[i].kind != EVENT || fabs(d.told[i].x.t - last->x.t) > 0.1);
    tvi_event_free(event);
    run_close(&r);
}
END_TEST

/* A run with times and t_end ends as the run to t_end, and its results before the last step are those of the run to the
 * times; the time t_end itself has the state of the end. Times beyond t_end are refused. */
START_TEST(times_and_t_end)
{
    static plan_diary both, to, at;
    const bool is_rescaled = _i % 2;
    const pairing *pair = &pairings[_i / 4];
    const double h = _i / 2 % 2 ? -pair->h : pair->h;
    double times[RESULTS];
    run r;
    tvi_system *base;
    if (open_pairing(&r, pair, is_rescaled, &base)) {
        const point start = r.x;
        for (way_to_go way = TO; way <= AT_AND_TO; way++) {
            plan_diary *d = way == TO ? &to : way == AT ? &at : &both;
            tvi_run_plan plan = plan_of_way(way, h, times);
            if (plan.times) times[RESULTS - 1] = (STEP_COUNT - 0.25) * h;
            start_diary(d, &r, 0);
            r.x = start;
            tvi_integrator_reset(r.integrator);
            ck_assert_int_eq(run_with(&r, plan, WITH_STEPS, NULL, d), TVI_OK);
        }
        ck_assert(r.x.t == (STEP_COUNT - 0.25) * h && same_point(&r.x, &last_told(&to, STEP)->x));
        ck_assert(same_point(&r.x, &last_told(&both, TIME)->x));
        expect_same_told(&to, &both, STEP, false);
        ck_assert_int_eq(both.of_kind[TIME], RESULTS);
        const told *a = NULL, *b = NULL;
        for (int i = 0; i < RESULTS - 1; i++) {
            a = next_told(&at, TIME, a ? (int)(a - at.told) : -1);
            b = next_told(&both, TIME, b ? (int)(b - both.told) : -1);
            ck_assert(same_point(&a->x, &b->x) && a->which == b->which);
        }
        tvi_run_plan plan = plan_of_way(AT_AND_TO, h, times);
        times[RESULTS - 1] = plan.t_end * (1 + DBL_EPSILON);
        r.x = start;
        refused("is beyond t_end", tvi_run(r.integrator, &plan, &r.x.t, r.x.q, r.x.p), TVI_EINVAL);
    }
    close_pairing(&r, base);
}
END_TEST

/* A run to a time makes no step that is longer than h, wherever it is: not 1 unit of t, and not half of one. */
START_TEST(last_step_is_not_longer)
{
    static plan_diary d;
    const double start[] = {0, 0.7, 2451545, 1e12, 1e15}, h = _i % 2 ? -0.1 : 0.1;
    for (int i = 0; i < 5; i++)
        for (int k = 1; k <= 16; k++) {
            run r = run_open(&scene_kepler, "galerkin", 8);
            r.x.t = start[i];
            const double t_end = r.x.t + 0.0625 * k * (h > 0 ? 1 : -1), duration = t_end - r.x.t;
            const tvi_run_plan plan = {.h = h, .t_end = t_end, .has_t_end = true};
            start_diary(&d, &r, 0);
            ck_assert_int_eq(run_with(&r, plan, WITH_STEPS, NULL, &d), TVI_OK);
            ck_assert_double_eq(r.x.t, t_end);
            for (int j = 0; j < d.count; j++) ck_assert_double_le(fabs(d.told[j].h), fabs(h));
            ck_assert_int_eq(d.count, (int)ceil(fabs(duration / h) * (1 - 1e-3 / 16)));
            run_close(&r);
        }
}
END_TEST

/* Back by one unit of t to where the low-order part of the time already is: no step is made. */
START_TEST(back_by_roundoff)
{
    run r = run_open(&scene_kepler, "galerkin", 8);
    const double t_end = nextafter(1, 2);
    ck_assert_int_eq(tvi_integrate_to(r.integrator, 0.5, t_end, &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_OK);
    ck_assert(r.x.t == t_end);
    const long steps = tvi_integrator_stats(r.integrator)->steps;
    point there = r.x;
    ck_assert_msg(tvi_integrate_to(r.integrator, -0.5, 1, &r.x.t, r.x.q, r.x.p, NULL, NULL) == TVI_OK, "%s",
                  tvi_last_error());
    there.t = 1;
    ck_assert(same_point(&r.x, &there) && tvi_integrator_stats(r.integrator)->steps == steps);
    run_close(&r);
}
END_TEST

/* A plan of no steps makes none, whatever t is, and leaves the integrator's last step as it is. */
START_TEST(no_steps)
{
    run r = run_open(&scene_kepler, "galerkin", 8);
    double q[2], p[2];
    const tvi_run_plan none = {.h = -0.1};
    r.x.t = 2;
    const point start = r.x;
    ck_assert_int_eq(tvi_run(r.integrator, &none, &r.x.t, r.x.q, r.x.p), TVI_OK);
    ck_assert(same_point(&r.x, &start) && tvi_integrator_stats(r.integrator)->steps == 0);
    ck_assert_int_eq(tvi_step(r.integrator, 0.1, &r.x.t, r.x.q, r.x.p), TVI_OK);
    point other = start;
    ck_assert_int_eq(tvi_run(r.integrator, &none, &other.t, other.q, other.p), TVI_OK);
    ck_assert_int_eq(tvi_dense(r.integrator, 0.5, q, p), TVI_OK);
    ck_assert(same_point(&other, &start) && tvi_integrator_stats(r.integrator)->steps == 1);
    run_close(&r);
}
END_TEST

/* The observer of times stops a run with events, at each time in turn: the events and times of its step are told, too,
 * the state and D are those after the step, and the rest of the run tells the rest, bit for bit. */
START_TEST(runs_end_after_times)
{
    static plan_diary whole, pieces;
    const double times[] = {0.55, 0.6, 1.1, 1.63, 1.7, 2.9}, level[2] = {0.3, -0.7};
    enum { COUNT = sizeof times / sizeof *times };
    tvi_event *const events[] = {event_at_place(2, false, &level[0]), event_at_momentum(2, false, &level[1])};
    for (int stop = 0; stop <= COUNT; stop++) {
        run r = run_open(&scene_kepler, "galerkin", 12);
        plan_diary *d = stop > 0 ? &pieces : &whole;
        start_diary(d, &r, COLUMNS);
        d->stops = TIME, d->stop_at = stop;
        tvi_run_plan plan = {.h = 0.5, .times = times, .time_count = COUNT, .at_time = see_time};
        const tvi_status status = run_with(&r, plan, WITH_EVENTS + WITH_D + WITH_STEPS, events, d);
        ck_assert_int_eq(status, stop > 0 ? TVI_ESTOPPED : TVI_OK);
        ck_assert_int_eq(d->told[d->count - 1].kind, STEP);
        ck_assert(same_point(&r.x, &d->told[d->count - 1].x));
        ck_assert(memcmp(d->D, d->told[d->count - 1].D, sizeof d->D) == 0);
        plan.times += d->of_kind[TIME], plan.time_count -= d->of_kind[TIME];
        for (int i = 0; i < plan.time_count; i++) ck_assert_double_gt(plan.times[i], r.x.t);
        d->times_before = d->of_kind[TIME];
        d->stop_at = 0;
        if (stop > 0 && plan.time_count > 0)
            ck_assert_int_eq(run_with(&r, plan, WITH_EVENTS + WITH_D + WITH_STEPS, events, d), TVI_OK);
        ck_assert_int_eq(d->count, whole.count);
        for (int kind = 0; kind < KINDS; kind++)
            if (kind != STEP) expect_same_told(d, &whole, (told_kind)kind, true);
        for (int i = 0; i < d->count; i++) ck_assert_int_eq(d->told[i].kind, whole.told[i].kind);
        run_close(&r);
    }
    ck_assert_int_ge(whole.of_kind[EVENT], 2);
    for (int i = 0; i < 2; i++) tvi_event_free(events[i]);
}
END_TEST

/* Within a step times and events are told in order of time, a time before an event that is at it, then the step. */
START_TEST(times_and_events_in_order)
{
    static plan_diary d;
    const double level[] = {0.9, -0.3};
    double times[] = {0.1, 0.2, 0.9, 1.3, 2};
    enum { COUNT = sizeof times / sizeof *times };
    tvi_event *const events[] = {event_at_place(2, false, &level[0]), event_at_momentum(2, false, &level[1])};
    for (int k = 0; k < 2; k++) { /* then with a time at the first event */
        run r = run_open(&scene_kepler, "galerkin", 12);
        start_diary(&d, &r, 0);
        const tvi_run_plan plan = {.h = 1, .times = times, .time_count = COUNT, .at_time = see_time};
        ck_assert_int_eq(run_with(&r, plan, WITH_EVENTS + WITH_STEPS, events, &d), TVI_OK);
        const told *first = next_told(&d, EVENT, -1);
        ck_assert_ptr_nonnull(first);
        ck_assert(first->x.t > 0.1 && first->x.t < 0.9 && first > d.told);
        for (int i = 1; i < d.count; i++) {
            const told *s = &d.told[i];
            ck_assert_double_ge(s->x.t, s[-1].x.t);
            ck_assert(s->x.t > s[-1].x.t || s->kind > s[-1].kind || s->kind == STEP);
        }
        if (k == 1) ck_assert(first[-1].kind == TIME && first[-1].x.t == first->x.t);
        times[1] = first->x.t;
        run_close(&r);
    }
    for (int i = 0; i < 2; i++) tvi_event_free(events[i]);
}
END_TEST

/* Times in the last step are told with their D in a further call where D is what the run left, else refused. */
START_TEST(columns_in_two_calls)
{
    static plan_diary whole, pieces;
    const pairing *pair = &pairings[_i / 2];
    const double h = _i % 2 ? -pair->h : pair->h, times[] = {0.3 * h, 0.31 * h, 1.4 * h, 1.45 * h, 2 * h, 7.1 * h};
    enum { COUNT = sizeof times / sizeof *times };
    for (int first = 0; first < COUNT; first++) {
        run r = run_open(pair->scene, pair->method, pair->order);
        plan_diary *d = first > 0 ? &pieces : &whole;
        start_diary(d, &r, COLUMNS);
        tvi_run_plan plan = {.h = h, .times = times, .time_count = first > 0 ? first : COUNT, .at_time = see_time};
        ck_assert_int_eq(run_with(&r, plan, WITH_D, NULL, d), TVI_OK);
        plan.times += first, plan.time_count = COUNT - first;
        const double was = d->D[1];
        d->D[1] = 2 * was + 1;
        if (first > 0 && fabs(times[first]) < fabs(r.x.t))
            refused("times[0]", run_with(&r, plan, WITH_D, NULL, d), TVI_EINVAL);
        d->D[1] = was;
        d->times_before = first;
        if (first > 0) ck_assert_int_eq(run_with(&r, plan, WITH_D, NULL, d), TVI_OK);
        expect_same_told(&whole, d, TIME, true);
        ck_assert(memcmp(d->D, whole.D, sizeof d->D) == 0);
        run_close(&r);
    }
}
END_TEST

static jet hill(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

/* A vector of length 1.84e308 turns until its first part is too large: the step that would make it so is taken back,
 * and the run goes on, with another vector, as if nothing had been. */
START_TEST(columns_that_overflow)
{
    static const double first = 1.3e308;
    double t = 0, q = 1, p = 0, D[] = {first, first}, same_t = 0, same_q = 1, same_p = 0;
    tvi_system *system;
    tvi_integrator *it, *same;
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, hill, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&it, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&same, system, NULL), TVI_OK);
    const tvi_run_plan plan = {.h = 0.1, .t_end = 1, .has_t_end = true, .D = D, .columns = 1};
    refused("column 0 of D", tvi_run(it, &plan, &t, &q, &p), TVI_ETOOLARGE);
    ck_assert_int_eq(tvi_integrator_stats(it)->steps, 5);
    ck_assert_int_eq(tvi_integrate(same, 0.1, 5, &same_t, &same_q, &same_p, NULL, NULL), TVI_OK);
    ck_assert(t == same_t && q == same_q && p == same_p);
    ck_assert_double_eq_tol(D[0] / first, cos(0.5) + sin(0.5), 1e-14);
    ck_assert_double_eq_tol(D[1] / first, cos(0.5) - sin(0.5), 1e-14);
    D[0] = D[1] = 1;
    ck_assert_int_eq(tvi_run(it, &plan, &t, &q, &p), TVI_OK);
    ck_assert_int_eq(tvi_integrate_to(same, 0.1, 1, &same_t, &same_q, &same_p, NULL, NULL), TVI_OK);
    ck_assert(t == same_t && q == same_q && p == same_p);
    D[1] = NAN;
    const tvi_run_plan further = {.h = 0.1, .steps = 1, .D = D, .columns = 1};
    refused("row 1 of D is not finite", tvi_run(it, &further, &t, &q, &p), TVI_ENONFINITE);
    ck_assert(t == same_t && q == same_q && p == same_p && D[0] == D[0]);
    tvi_integrator_free(it);
    tvi_integrator_free(same);
    tvi_system_free(system);
}
END_TEST

/* ---- Observers of steps ------------------------------------------------------------------------------------------ */

typedef struct {
    long steps;
    int of_all, stop_at;
    double *D;
} counter;

static int count_own(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    counter *c = ctx;
    (void)t, (void)q, (void)p;
    ck_assert_int_eq(member, 0);
    ck_assert_int_eq(which, ++c->steps);
    ck_assert_int_eq(c->of_all, c->steps - 1);
    return 0;
}

static int count_all(long step, int members, const double t[], const double q[], const double p[],
                     const tvi_status status[], void *ctx)
{
    counter *c = ctx;
    ck_assert_int_eq(members, 1);
    ck_assert_int_eq(status[0], TVI_OK);
    ck_assert(isfinite(*t) && isfinite(*q) && isfinite(*p));
    ck_assert_int_eq(step, ++c->of_all);
    for (int k = 0; k < 4; k++) c->D[k] /= 2;
    return step == c->stop_at;
}

/* An integrator is an ensemble of one: at_step, and after it the observer of all, which may change D. */
START_TEST(observers_of_steps)
{
    double D[4] = {1, 0, 0, 0}, E[4] = {1, 0, 0, 0};
    counter c = {.stop_at = 7, .D = D};
    run r = run_open(&scene_kepler, "galerkin", 8), same = run_open(&scene_kepler, "galerkin", 8);
    const tvi_run_plan plan = {
        .h = 0.1, .steps = 10, .D = D, .columns = 1, .observer = count_all, .at_step = count_own, .ctx = &c};
    ck_assert_int_eq(tvi_run(r.integrator, &plan, &r.x.t, r.x.q, r.x.p), TVI_ESTOPPED);
    for (int k = 0; k < 7; k++)
        ck_assert_int_eq(tvi_step_tangent(same.integrator, 0.1, &same.x.t, same.x.q, same.x.p, E, 1), TVI_OK);
    ck_assert(same_point(&r.x, &same.x) && c.steps == 7 && c.of_all == 7);
    for (int k = 0; k < 4; k++) ck_assert_double_eq(D[k], ldexp(E[k], -7));
    run_close(&r);
    run_close(&same);
}
END_TEST

/* ---- Steps to a tolerance ---------------------------------------------------------------------------------------- */

/* No step is larger than the largest one; where that limits all of them, there are as few as it allows, and none of
 * roundoff at the end; one that never limits changes no bit. */
START_TEST(largest_steps)
{
    static plan_diary chosen, limited;
    const double t_end = _i % 2 ? -6 : 6, largest[] = {0, 0.03, 0.1, 0.11, 100};
    for (int k = 0; k < 5; k++) {
        run r = run_open(&scene_kepler, "taylor", 20);
        plan_diary *d = k == 0 ? &chosen : &limited;
        const tvi_run_plan plan = {.tolerance = 1e-12, .t_end = t_end, .largest_step = largest[k]};
        start_diary(d, &r, 0);
        ck_assert_int_eq(run_with(&r, plan, WITH_STEPS, NULL, d), TVI_OK);
        ck_assert_double_eq(r.x.t, t_end);
        const int least = k == 0 ? 0 : (int)ceil(6 / largest[k] * (1 - 1e-14));
        for (int i = 0; i < d->count; i++) {
            ck_assert_double_gt(fabs(d->told[i].h), 1e-3);
            ck_assert(k == 0 || fabs(d->told[i].h) <= largest[k] * (1 + 1e-13));
        }
        ck_assert_int_ge(d->count, least);
        if (k == 1) ck_assert_int_eq(d->count, least);
        for (int i = 0; i < 2; i++) ck_assert_double_eq_tol(r.x.q[i], chosen.told[chosen.count - 1].x.q[i], 1e-10);
        if (k == 4) expect_same_told(&chosen, d, STEP, false);
        run_close(&r);
    }
    ck_assert_int_lt(chosen.count, 50); /* 0.03 and 0.1 limit */
}
END_TEST

/* If the rest of the way is the largest step up to roundoff, it is one step. */
START_TEST(no_steps_of_roundoff)
{
    static plan_diary d;
    const double after = 0.3 + 0x1p-53, t_end = _i % 2 ? -after : after; /* more than three times 0.1 */
    run r = run_open(&scene_kepler, "taylor", 20);
    const tvi_run_plan plan = {.tolerance = 1e-12, .t_end = t_end, .largest_step = 0.1};
    start_diary(&d, &r, 0);
    ck_assert_int_eq(run_with(&r, plan, WITH_STEPS, NULL, &d), TVI_OK);
    ck_assert_int_eq(d.count, 3);
    run_close(&r);
}
END_TEST

Suite *suite_plans(void)
{
    Suite *suite = suite_create("plans");
    TCase *tcase = tcase_create("plans");
    tcase_add_loop_test(tcase, nothing_changes_the_steps, 0, 4 * PAIRINGS);
    tcase_add_loop_test(tcase, runs_end_at_events, 0, 2 * WAYS);
    tcase_add_test(tcase, runs_end_after_times);
    tcase_add_loop_test(tcase, times_and_t_end, 0, 4 * PAIRINGS);
    tcase_add_loop_test(tcase, last_step_is_not_longer, 0, 2);
    tcase_add_test(tcase, no_steps);
    tcase_add_test(tcase, back_by_roundoff);
    tcase_add_loop_test(tcase, columns_in_two_calls, 0, 2 * PAIRINGS);
    tcase_add_test(tcase, columns_that_overflow);
    tcase_add_test(tcase, observers_of_steps);
    tcase_add_loop_test(tcase, largest_steps, 0, 2);
    tcase_add_loop_test(tcase, no_steps_of_roundoff, 0, 2);
    tcase_add_test(tcase, times_and_events_in_order);
    suite_add_tcase(suite, tcase);
    return suite;
}
