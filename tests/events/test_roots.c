/* test_roots.c - Tests that no root that the places that are looked at can show is lost or told twice, and the state of
 * an event is that of its time whatever g is. */
#include "diary.h"
#include "events.h"
#include "problems/random.h"
#include "events/events.h"

#include <float.h>
#include <math.h>

static jet free_of_force(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0, q[0]);
}

static jet swinging(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_cos(q[0]));
}

static run open_potential(int n, tvi_potential_fn *V, const char *method, int order)
{
    run r = {0};
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    ck_assert_int_eq(tvi_system_potential(&r.system, n, NULL, V, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&r.integrator, r.system, &options), TVI_OK);
    return r;
}

/* ---- Two roots --------------------------------------------------------------------------------------------------- */

typedef struct {
    double a, b;
} pair;

static jet between(const jet q[], const jet p[], jet t, void *ctx)
{
    const pair *roots = ctx;
    (void)q, (void)p;
    return jet_mul(jet_sub(t, roots->a), jet_sub(t, roots->b));
}

/* At the places that are looked at, next to them, and anywhere else; the first of them in a step and the last, in one
 * step or two. */
START_TEST(both_are_told_once)
{
    const double places[] = {0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1, 0x1p-20, 1 - 0x1p-20, 0.03, 0.41, 0.97};
    const double apart[] = {1e-6, 0x1p-13, 1e-3, 0x1p-5, 0.1};
    const int count = (int)(sizeof places / sizeof *places);
    for (int k = 0; k < 2 * count; k++) {
        static diary d;
        const double first = 1 + places[k / 2], second = first + (k % 2 ? -apart[_i] : apart[_i]);
        pair roots = {fmin(first, second), fmax(first, second)};
        run r = open_potential(1, free_of_force, "galerkin", 16);
        tvi_event *events[] = {event_of(1, TVI_EITHER, false, between, &roots),
                               event_of(1, TVI_RISING, false, between, &roots),
                               event_of(1, TVI_FALLING, false, between, &roots)};
        d = (diary){0};
        ck_assert_int_eq(watch(&r, 1, 4, events, 3, &d), TVI_OK);
        ck_assert_msg(d.count == 4, "%.17g and %.17g: %d", roots.a, roots.b, d.count);
        for (int i = 0; i < 4; i++) {
            const double expected = i < 2 ? roots.a : roots.b;
            ck_assert_msg(fabs(d.at[i].t - expected) < 1e-9, "%.17g instead of %.17g", d.at[i].t, expected);
            ck_assert_int_ne(d.which[i], i < 2 ? 1 : 2);
        }
        run_close(&r);
    }
}
END_TEST

/* Nearly no force. */
static jet sliding(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(1e-9, q[0]);
}

static jet above(const jet q[], const jet p[], jet t, void *floor)
{
    (void)p, (void)t;
    return jet_sub(q[0], *(const double *)floor);
}

/* The middle of a part, where both ends of it have the same value. */
START_TEST(ties)
{
    static diary d;
    const double middle = 0.25 * (2 * _i + 1) / 16;
    pair roots = {middle - 0x1p-10, middle + 0x1p-10};
    run r = open_potential(1, swinging, "galerkin", 16);
    r.x.q[0] = 1;
    tvi_event *event = event_of(1, TVI_EITHER, false, between, &roots);
    d = (diary){0};
    ck_assert_int_eq(watch(&r, 0.25, 4, &event, 1, &d), TVI_OK);
    ck_assert_int_eq(d.count, 2);
    ck_assert_double_eq_tol(d.at[0].t, roots.a, 1e-15);
    ck_assert_double_eq_tol(d.at[1].t, roots.b, 1e-15);
    run_close(&r);
}
END_TEST

/* Two floors are two units of q apart, which a slow ball passes at times that differ by 1e6 units. The run stops at the
 * first, where the other is within its roundoff, and goes on faster than it came. */
START_TEST(a_floor_just_below_a_stop)
{
    static diary d;
    double floors[] = {1000, 1000 - 0x1p-42};
    run r = open_potential(1, sliding, "galerkin", 8);
    tvi_event *events[] = {event_of(1, TVI_FALLING, true, above, &floors[0]),
                           event_of(1, TVI_FALLING, false, above, &floors[1])};
    const tvi_event *const all[] = {events[0], events[1]};
    r.x.q[0] = 1000 + 1e-3, r.x.p[0] = -1e-3;
    d = (diary){.n = 1};
    for (int call = 0; call < 2; call++) {
        const tvi_status status =
            tvi_integrate_events(r.integrator, 0.25, 8, all, 2, &r.x.t, r.x.q, r.x.p, NULL, note_event, &d);
        ck_assert_int_eq(status, call == 0 ? TVI_ESTOPPED : TVI_OK);
        ck_assert_int_eq(d.count, call + 1);
        ck_assert_int_eq(d.which[call], call);
        if (_i) r.x.p[0] *= 2;
    }
    for (int i = 0; i < 2; i++) tvi_event_free(events[i]);
    run_close(&r);
}
END_TEST

/* ---- Kinks and peaks --------------------------------------------------------------------------------------------- */

/* All of them are 0 where the distance from the origin is R. */
static jet distance(const jet q[], const jet p[], jet t, void *R)
{
    (void)p, (void)t;
    return jet_sub(jet_hypot(q[0], q[1]), *(const double *)R);
}

static jet tiny(const jet q[], const jet p[], jet t, void *R) { return jet_mul(1e-200, distance(q, p, t, R)); }

static jet square(const jet q[], const jet p[], jet t, void *R)
{
    (void)p, (void)t;
    return jet_sub(jet_dot(q, q, 2), *(const double *)R * *(const double *)R);
}

static jet inverse(const jet q[], const jet p[], jet t, void *R)
{
    (void)p, (void)t;
    return jet_sub(jet_pow(jet_dot(q, q, 2), -0.5), 1 / *(const double *)R);
}

static jet angle(const jet q[], const jet p[], jet t, void *R)
{
    (void)p, (void)t, (void)R; /* 150 degrees and 30 degrees */
    const jet of_q = jet_atan2(q[1], q[0]);
    return jet_mul(jet_sub(of_q, 5 * asin(0.5)), jet_sub(of_q, asin(0.5)));
}

/* A body passes the origin at half the distance R along a line, anywhere in a step. */
START_TEST(passages_are_seen)
{
    const double Rs[] = {1e-4, 1e-3, 0.01, 0.02, 0.04, 0.08};
    tvi_event_fn *const all[] = {distance, tiny, square, inverse, angle};
    double R = Rs[_i];
    for (int i = 0; i < 1000; i++) {
        static diary d;
        const double at = 2 + (i + 0.5) / 1000, half = sqrt(0.75) * R;
        run r = open_potential(2, free_of_force, "galerkin", 16);
        r.x = (point){0, {-at, R / 2}, {1, 0}};
        tvi_event *events[5];
        int told[5] = {0};
        for (int k = 0; k < 5; k++) events[k] = event_of(2, TVI_EITHER, false, all[k], &R);
        d = (diary){0};
        ck_assert_int_eq(watch(&r, 1, 5, events, 5, &d), TVI_OK);
        for (int k = 0; k < d.count; k++) {
            const double expected = at + (told[d.which[k]]++ == 0 ? -half : half);
            ck_assert_double_eq_tol(d.at[k].t, expected, 1e-12);
        }
        for (int k = 0; k < 5; k++) ck_assert_msg(told[k] == 2, "R = %g, %g: function %d tells %d", R, at, k, told[k]);
        run_close(&r);
    }
}
END_TEST

/* Convex ones, with and without a kink, and a peak, over the distance from where they are least, 0 there. */
static double shape(int which, double x)
{
    const double r = fabs(x);
    return which == 0 ? x * x : which == 1 ? r : which == 2 ? hypot(r, 0.01) - 0.01 : which == 3 ? r + x * x : sqrt(r);
}

/* The dip itself, at random places: a function that is below 0 by a little somewhere is found to be, whatever its size;
 * one that is above 0 is hardly looked at where that is more than it changes by, and else few times. */
START_TEST(dips_are_decided)
{
    enum { SHAPES = 5, PEAK = 4 };
    uint64_t bits = (uint64_t)_i + 1;
    for (int k = 0; k < 4000; k++) {
        const int which = k % SHAPES;
        const double at = 2 + (number_of(&bits) - 0.5) * 0.98, unit = pow(10, 250 * (number_of(&bits) - 0.5));
        /* a peak is below 0 over its depth to the square, which is to be more than the 1e-8 that are looked at */
        const double above = (k / SHAPES % 3 - 1) * pow(10, (which == PEAK ? -1 : -4) * number_of(&bits) - 2.5);
        const double base = k / SHAPES % 3 == 1 ? 10 : above; /* the lowest value: below 0, far above or near */
        tvi_event_sample x[TVI_DIP_SAMPLES];
        for (int i = 0; i < TVI_DIP_SAMPLES; i++) x[i] = (tvi_event_sample){i, unit * (base + shape(which, i - at))};
        if (!(x[2].g <= x[1].g && x[2].g <= x[3].g && x[2].g > 0)) continue;
        tvi_event_sample next;
        bool is_below = false;
        int looks = 0;
        for (; !is_below && tvi_dip_needs_another_sample(x, looks, &next.theta); looks++) {
            next.g = unit * (base + shape(which, next.theta - at));
            is_below = next.g <= 0;
            if (!is_below) tvi_dip_insert_sample(x, next);
        }
        ck_assert_msg(is_below == (base < 0), "shape %d, %g above 0 at %g", which, base, at);
        const bool is_rounded = which == 1; /* flat flanks are convex but for roundoff */
        ck_assert_msg(looks < 60 && (base < 10 || looks <= 2 || which == PEAK || is_rounded), "shape %d, %g: %d looks",
                      which, base, looks);
    }
}
END_TEST

/* ---- States ------------------------------------------------------------------------------------------------------ */

static jet plain(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

static jet cube(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_pow(q[0], 3);
}

static jet steep(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_atan(jet_mul(1e8, q[0]));
}

static jet flat_beside(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_mul(q[0], jet_sqr(jet_sub(q[0], 1e-5)));
}

/* Events with the same zero have the same state, to roundoff of the orbit: of methods of low and high order. */
START_TEST(states_do_not_know_g)
{
    const struct {
        const char *method;
        int order;
        double h;
    } rows[] = {{"galerkin", 16, 0.5}, {"galerkin", 4, 0.25}, {"midpoint", 4, 0.25},       {"midpoint", 20, 0.5},
                {"taylor", 12, 0.25},  {"poincare", 8, 0.25}, {"stormer-verlet", 2, 0.05}, {"start", 6, 0.25}};
    tvi_event_fn *const all[] = {plain, cube, steep, flat_beside};
    static diary d;
    run r = open_potential(1, swinging, rows[_i].method, rows[_i].order);
    double reference[2] = {0};
    int told[4] = {0};
    tvi_event *events[4];
    for (int k = 0; k < 4; k++) events[k] = event_of(1, TVI_EITHER, false, all[k], NULL);
    d = (diary){0};
    r.x.q[0] = 1;
    ck_assert_int_eq(watch(&r, rows[_i].h, (long)(6 / rows[_i].h), events, 4, &d), TVI_OK);
    for (int k = 0; k < d.count; k++)
        if (d.which[k] == 0) reference[told[0]++ % 2] = d.at[k].t;
    ck_assert_int_eq(told[0], 2);
    told[0] = 0;
    for (int k = 0; k < d.count; k++) {
        ck_assert_double_eq_tol(d.at[k].t, reference[told[d.which[k]]++ % 2], 4 * DBL_EPSILON * 6);
        ck_assert_double_le(fabs(d.at[k].q[0]), 4 * DBL_EPSILON);
    }
    for (int k = 1; k < 3; k++) ck_assert_int_eq(told[k], 2);
    run_close(&r);
}
END_TEST

static jet squared(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sqr(q[0]);
}

static jet nearly_at_rest(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], 1 - 1e-12);
}

/* A root that the curve touches or crosses, and the method's own solution perhaps does not, is told where it is, or not
 * at all. */
START_TEST(touches_are_where_they_are)
{
    const struct {
        const char *method;
        int order;
    } rows[] = {{"galerkin", 16}, {"galerkin", 8}, {"midpoint", 4}, {"taylor", 6}, {"poincare", 4}, {"right", 4}};
    for (double h = 0.02; h < 0.3; h *= 1.1) {
        static diary d;
        run r = open_potential(1, swinging, rows[_i].method, rows[_i].order);
        tvi_event *events[] = {event_of(1, TVI_EITHER, false, squared, NULL),
                               event_of(1, TVI_EITHER, false, nearly_at_rest, NULL)};
        d = (diary){0};
        r.x.q[0] = 1;
        ck_assert_int_eq(watch(&r, h, (long)(20 / h), events, 2, &d), TVI_OK);
        for (int i = 0; i < d.count; i++) {
            const double g = d.which[i] == 0 ? d.at[i].q[0] * d.at[i].q[0] : d.at[i].q[0] - (1 - 1e-12);
            ck_assert_double_le(fabs(g), 1e-15);
        }
        run_close(&r);
    }
}
END_TEST

Suite *suite_roots(void)
{
    Suite *suite = suite_create("roots");
    TCase *tcase = tcase_create("roots");
    tcase_add_loop_test(tcase, both_are_told_once, 0, 5);
    tcase_add_loop_test(tcase, ties, 0, 8);
    tcase_add_loop_test(tcase, a_floor_just_below_a_stop, 0, 2);
    tcase_add_loop_test(tcase, passages_are_seen, 0, 6);
    tcase_add_loop_test(tcase, dips_are_decided, 0, 4);
    tcase_add_loop_test(tcase, states_do_not_know_g, 0, 8);
    tcase_add_loop_test(tcase, touches_are_where_they_are, 0, 6);
    suite_add_tcase(suite, tcase);
    return suite;
}
