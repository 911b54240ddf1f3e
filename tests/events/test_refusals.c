/* test_refusals.c - events and calls that are refused, and events without a value. Cases of the suite "events". */
#include "diary.h"
#include "events.h"
#include "problems/refusals.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Refusals ---------------------------------------------------------------------------------------------------- */

static jet kept;
static jet constant(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    kept = q[0];
    return jet_const(*(const double *)ctx);
}

static jet of_another(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p, (void)t, (void)ctx;
    return kept;
}

static jet root_of(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_sqrt(jet_add(q[0], *(const double *)ctx));
}

static jet overflow(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)q, (void)ctx;
    return jet_exp(jet_mul(5000, t));
}

static jet log_of_minus_one(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)q, (void)t, (void)ctx;
    return jet_log(-1);
}

START_TEST(bad_events_are_refused)
{
    double nan_value = NAN, one = 1;
    tvi_event *event = (tvi_event *)&nan_value, *good = event_of(1, TVI_EITHER, false, constant, &one);
    const struct {
        int n, direction;
        tvi_event_fn *g;
        double *ctx;
        tvi_status status;
        const char *culprit;
    } rows[] = {{0, 0, constant, &one, TVI_EINVAL, "n = 0 is not 1"},
                {-1, 0, constant, &one, TVI_EINVAL, "n = -1 is not 1"},
                {TVI_MAX_DIMENSION + 1, 0, constant, &one, TVI_EINVAL, "n = 10001"},
                {1, 2, constant, &one, TVI_EINVAL, "direction = 2"},
                {1, -2, constant, &one, TVI_EINVAL, "direction = -2"},
                {1, 0, NULL, &one, TVI_EINVAL, "the function is NULL"},
                {1, 0, of_another, NULL, TVI_EINVAL, "another recording"},
                {1, 0, constant, &nan_value, TVI_ENONFINITE, "not finite"},
                {1, 0, log_of_minus_one, NULL, TVI_EDOMAIN, "jet_log"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        event = (tvi_event *)&nan_value;
        refused(rows[i].culprit,
                tvi_event_create(&event, rows[i].n, (tvi_direction)rows[i].direction, false, rows[i].g, rows[i].ctx),
                rows[i].status);
        ck_assert_ptr_null(event);
    }
    refused("out is NULL", tvi_event_create(NULL, 1, TVI_EITHER, false, constant, &one), TVI_EINVAL);
    tvi_event_free(good);
    tvi_event_free(NULL);
}
END_TEST

START_TEST(bad_calls_are_refused)
{
    double one = 1;
    run r = run_open(&scene_kepler, NULL, 0);
    tvi_event *good = event_of(2, TVI_EITHER, false, constant, &one),
              *other = event_of(1, TVI_EITHER, false, constant, &one);
    const tvi_event *const events[] = {good, good}, *const mixed[] = {good, other}, *const missing[] = {good, NULL};
    const point start = r.x;
    double *const t = &r.x.t, *const q = r.x.q, *const p = r.x.p;
    tvi_integrator *const it = r.integrator;
    const struct {
        const char *culprit;
        tvi_integrator *it;
        double h;
        long steps;
        const tvi_event *const *events;
        int count;
        double *t, *q, *p;
    } rows[] = {
        {"integrator is NULL", NULL, 0.1, 1, events, 2, t, q, p},
        {"h is 0", it, 0, 1, events, 2, t, q, p},
        {"h = nan is not finite", it, NAN, 1, events, 2, t, q, p},
        {"steps is negative", it, 0.1, -1, events, 2, t, q, p},
        {"events is NULL", it, 0.1, 1, NULL, 2, t, q, p},
        {"count = -1 is negative", it, 0.1, 1, events, -1, t, q, p},
        {"t is NULL", it, 0.1, 1, events, 2, NULL, q, p},
        {"q is NULL", it, 0.1, 1, events, 2, t, NULL, p},
        {"p is NULL", it, 0.1, 1, events, 2, t, q, NULL},
        {"events[1] is of another dimension", it, 0.1, 1, mixed, 2, t, q, p},
        {"events[1] is NULL", it, 0.1, 1, missing, 2, t, q, p},
        {"steps is negative", it, 0.1, -1, NULL, 0, t, q, p},
        {"h is 0", it, 0, 0, events, 2, t, q, p},
        {"h = inf is not finite", it, INFINITY, 0, events, 2, t, q, p},
        {"t is NULL", it, 0.1, 0, events, 2, NULL, q, p},
        {"q is NULL", it, 0.1, 0, events, 2, t, NULL, p},
        {"p is NULL", it, 0.1, 0, events, 2, t, q, NULL},
        {"events[1] is NULL", it, 0.1, 0, missing, 2, t, q, p},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        refused(rows[i].culprit,
                tvi_integrate_events(rows[i].it, rows[i].h, rows[i].steps, rows[i].events, rows[i].count, rows[i].t,
                                     rows[i].q, rows[i].p, NULL, NULL, NULL),
                TVI_EINVAL);
    ck_assert(same_point(&r.x, &start));
    ck_assert_int_eq(tvi_integrate_events(it, 0.1, 0, events, 2, t, q, p, NULL, NULL, NULL), TVI_OK);
    ck_assert(same_point(&r.x, &start));
    ck_assert_int_eq(tvi_integrate_events(it, 0.1, 3, events, 2, t, q, p, NULL, NULL, NULL), TVI_OK);
    run same = run_open(&scene_kepler, NULL, 0);
    ck_assert_int_eq(
        tvi_integrate_events(same.integrator, 0.1, 3, NULL, 0, &same.x.t, same.x.q, same.x.p, NULL, NULL, NULL),
        TVI_OK);
    ck_assert(same_point(&r.x, &same.x));
    tvi_event_free(good);
    tvi_event_free(other);
    run_close(&r);
    run_close(&same);
}
END_TEST

/* An event without a value ends the run after the step. */
START_TEST(events_without_value)
{
    static diary d;
    double shift = -0.5;
    d = (diary){0};
    for (int which = 0; which < 2; which++) {
        run r = run_open(&scene_kepler, NULL, 0), plain = run_open(&scene_kepler, NULL, 0);
        tvi_event *event = event_of(2, TVI_EITHER, false, which ? overflow : root_of, &shift);
        ck_assert_int_eq(watch(&r, 0.25, 100, &event, 1, &d), which ? TVI_ENONFINITE : TVI_EDOMAIN);
        ck_assert_int_eq(d.count, 0);
        ck_assert_int_eq(run_steps(&plain, 0.25, tvi_integrator_stats(r.integrator)->steps), TVI_OK);
        ck_assert(same_point(&r.x, &plain.x));
        run_close(&r);
        run_close(&plain);
    }
}
END_TEST

void add_refusals(TCase *tcase)
{
    tcase_add_test(tcase, bad_events_are_refused);
    tcase_add_test(tcase, bad_calls_are_refused);
    tcase_add_test(tcase, events_without_value);
}
