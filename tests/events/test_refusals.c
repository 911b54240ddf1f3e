/* test_refusals.c - Tests events and calls that are refused, and events without a value. Cases of the suite "events".
 */
#include "diary.h"
#include "events.h"
#include "problems/refusals.h"

#include <math.h>
#include <stdio.h>
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

/* ---- Texts of steps that are too large --------------------------------------------------------------------------- */

/* A body with the moments 3, 5, 9 in Euler angles z-x-z, which are singular at theta = 0. */
static jet euler(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet s = jet_sin(q[1]), c = jet_cos(q[1]), sp = jet_sin(q[2]), cp = jet_cos(q[2]);
    const jet w1 = jet_add(jet_mul(v[0], jet_mul(s, sp)), jet_mul(v[1], cp));
    const jet w2 = jet_sub(jet_mul(v[0], jet_mul(s, cp)), jet_mul(v[1], sp)), w3 = jet_add(jet_mul(v[0], c), v[2]);
    return jet_mul(0.5, jet_add(jet_add(jet_mul(3, jet_sqr(w1)), jet_mul(5, jet_sqr(w2))), jet_mul(9, jet_sqr(w3))));
}

/* The state of that body at a small theta. */
static run open_top(const char *method, int order, double theta)
{
    run r = {0};
    tvi_options options;
    const double w1 = 1 / 300., w2 = 0.4, w3 = 1 / 900., f = (w1 * sin(.2) + w2 * cos(.2)) / sin(1e-3);
    const double at[] = {0, 1e-3, 0.2}, v[] = {f, w1 * cos(.2) - w2 * sin(.2), w3 - f * cos(1e-3)};
    ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    ck_assert_int_eq(tvi_system_lagrangian(&r.system, 3, euler, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&r.integrator, r.system, &options), TVI_OK);
    ck_assert_int_eq(tvi_momentum(r.system, 0, at, v, r.x.p), TVI_OK);
    memcpy(r.x.q, at, sizeof at);
    r.x.q[1] = theta;
    return r;
}

/* Passes that overflow from a finite state with finite forces: the step is too large, and a shorter one is accepted;
 * the same of a member of an ensemble, one or many. */
START_TEST(passes_that_overflow)
{
    for (double h = 0.2; h > 0.004; h /= 2) {
        run r = open_top("galerkin", 16, 1e-3);
        const point start = r.x;
        const tvi_status status = tvi_step(r.integrator, h, &r.x.t, r.x.q, r.x.p);
        ck_assert(status == TVI_ETOOLARGE || status == TVI_ENOCONV);
        ck_assert_ptr_nonnull(strstr(tvi_last_error(), "the step is too large"));
        ck_assert(same_point(&r.x, &start));
        ck_assert_int_eq(tvi_step(r.integrator, 0.001, &r.x.t, r.x.q, r.x.p), TVI_OK);
        for (int members = 1; members <= 9; members += 4) {
            tvi_ensemble *e;
            double t[9] = {0}, q[27], p[27];
            tvi_status each[9];
            for (int k = 0; k < 3 * members; k++) q[k] = start.q[k / members], p[k] = start.p[k / members];
            ck_assert_int_eq(tvi_ensemble_create(&e, r.system, NULL, members, 1), TVI_OK);
            ck_assert_int_eq(tvi_ensemble_integrate(e, h, 1, t, q, p, each, NULL, NULL), TVI_OK);
            for (int m = 0; m < members; m++) ck_assert_int_eq(each[m], status);
            tvi_ensemble_free(e);
        }
        run_close(&r);
    }
}
END_TEST

/* A step of a tolerance names the size that failed, not the way to the end of the run. */
START_TEST(size_of_a_failed_step)
{
    run r = open_top("taylor", 18, 1e-6);
    const tvi_status status = tvi_integrate_tolerance(r.integrator, 1e-14, 20, &r.x.t, r.x.q, r.x.p, NULL, NULL);
    double size = 0, from = 0;
    ck_assert_int_ne(status, TVI_OK);
    ck_assert_int_eq(sscanf(tvi_last_error(), "step of %lf from t = %lf", &size, &from), 2);
    ck_assert_double_gt(size, 0);
    ck_assert_double_lt(size, 1e-6);
    ck_assert_double_eq_tol(from, r.x.t, 1e-5 * r.x.t);
    run_close(&r);
}
END_TEST

static jet log_of(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_log(q[0]);
}

static jet cubic(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_pow(q[0], 3);
}

/* The automatic g of q^3 has no value at 0, where V'' is 0, and the refusal says so; where V itself has none, it does
 * not. */
START_TEST(automatic_scale_is_named)
{
    tvi_system *bases[2], *rescaled[2];
    tvi_potential_fn *const all[] = {cubic, log_of};
    for (int i = 0; i < 2; i++) {
        tvi_integrator *it;
        double t = 0, q[] = {i ? -1 : 0}, p[] = {1};
        ck_assert_int_eq(tvi_system_potential(&bases[i], 1, NULL, all[i], NULL), TVI_OK);
        ck_assert_int_eq(tvi_system_rescaled(&rescaled[i], bases[i], NULL, NULL), TVI_OK);
        ck_assert_int_eq(tvi_integrator_create(&it, rescaled[i], NULL), TVI_OK);
        refused(i ? "jet_log"
                  : "the automatic g, which has no value there (take a smaller step, or give a g of your own): jet_pow",
                tvi_step(it, 0.1, &t, q, p), TVI_EDOMAIN);
        ck_assert(!i || !strstr(tvi_last_error(), "automatic"));
        tvi_integrator_free(it);
        tvi_system_free(rescaled[i]);
        tvi_system_free(bases[i]);
    }
}
END_TEST

void add_refusals(TCase *tcase)
{
    tcase_add_test(tcase, passes_that_overflow);
    tcase_add_test(tcase, size_of_a_failed_step);
    tcase_add_test(tcase, automatic_scale_is_named);
    tcase_add_test(tcase, bad_events_are_refused);
    tcase_add_test(tcase, bad_calls_are_refused);
    tcase_add_test(tcase, events_without_value);
}
