/* test_observers.c - Tests what observers may do with the integrator that calls them: set its parameters, which hold
 * from the next step on; and what is refused by name. */
#include "events.h"
#include "problems/refusals.h"
#include "runs.h"

#include <stdlib.h>
#include <string.h>

/* k q^2 / 2 with k = parameter 0. */
static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(jet_mul(0.5, jet_parameter(q[0], 0, 1)), jet_sqr(q[0]));
}

static jet above_parameter(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], jet_parameter(q[0], 0, 1));
}

/* g = 1 + q^2, so that s is another time. */
static jet wider(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_add(1, jet_sqr(q[0]));
}

typedef struct {
    tvi_integrator *it;
    long after; /* the call that sets the parameter, from 1 */
    double k;
    int calls;
    point at[64];
} setter;

static int set(setter *s, double t, const double q[], const double p[])
{
    s->at[s->calls] = (point){t, {q[0]}, {p[0]}};
    return ++s->calls == s->after && tvi_integrator_set_parameters(s->it, &s->k) != TVI_OK;
}

static int on_step(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)step;
    return set(ctx, t, q, p);
}

static int on_event(int which, double t, const double q[], const double p[], void *ctx)
{
    (void)which;
    return set(ctx, t, q, p);
}

static run open_spring(bool is_rescaled, tvi_system **base)
{
    run r = {0};
    ck_assert_int_eq(tvi_system_potential(base, 1, NULL, spring, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&r.system, *base, wider, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&r.integrator, is_rescaled ? r.system : *base, NULL), TVI_OK);
    r.x = (point){0, {0.9}, {0}};
    return r;
}

static void close_spring(run *r, tvi_system *base)
{
    run_close(r);
    tvi_system_free(base);
}

/* Set at the end of a step or at a time inside one: results at later times are those of runs with the new value from
 * the end of that step on, those of the same step of the old one. */
START_TEST(parameters_hold_in_results)
{
    const bool is_rescaled = _i % 2, is_inside = _i / 2;
    const double times[] = {is_inside ? 0.45 : 0.5, 0.47 + 0.03 * !is_inside, 1.05, 1.55};
    tvi_system *bases[2];
    run r = open_spring(is_rescaled, &bases[0]), same = open_spring(is_rescaled, &bases[1]);
    setter s = {.it = r.integrator, .after = 1, .k = 4}, plain = {.it = same.integrator};
    ck_assert_int_eq(tvi_integrate_at(r.integrator, 0.1, times, 4, &r.x.t, r.x.q, r.x.p, on_step, &s), TVI_OK);
    ck_assert_int_eq(tvi_integrate_at(same.integrator, 0.1, times, 2, &same.x.t, same.x.q, same.x.p, on_step, &plain),
                     TVI_OK);
    ck_assert_int_eq(tvi_integrator_set_parameters(same.integrator, &s.k), TVI_OK);
    ck_assert_int_eq(
        tvi_integrate_at(same.integrator, 0.1, times + 2, 2, &same.x.t, same.x.q, same.x.p, on_step, &plain), TVI_OK);
    ck_assert_int_eq(s.calls, 4);
    ck_assert(memcmp(s.at, plain.at, 4 * sizeof *s.at) == 0);
    ck_assert(same_point(&r.x, &same.x));
    close_spring(&r, bases[0]);
    close_spring(&same, bases[1]);
}
END_TEST

/* The same of events that have the parameter: those of a run of their own after the step, set by the observer of steps
 * or by that of events. */
START_TEST(parameters_hold_in_events)
{
    const bool is_rescaled = _i % 2;
    double k = 0.25;
    tvi_event *event;
    tvi_system *bases[2];
    run r = open_spring(is_rescaled, &bases[0]), same = open_spring(is_rescaled, &bases[1]);
    const tvi_event *const *events = (const tvi_event *const *)&event;
    ck_assert_int_eq(tvi_event_create(&event, 1, TVI_EITHER, false, above_parameter, NULL), TVI_OK);
    setter s = {.it = r.integrator, .after = 5, .k = k}, plain = {.it = same.integrator};
    ck_assert_int_eq(
        tvi_integrate_events(r.integrator, 0.1, 60, events, 1, &r.x.t, r.x.q, r.x.p, on_step, on_event, &s), TVI_OK);
    ck_assert_int_eq(tvi_integrate_events(same.integrator, 0.1, 5, events, 1, &same.x.t, same.x.q, same.x.p, on_step,
                                          on_event, &plain),
                     TVI_OK);
    ck_assert_int_eq(tvi_integrator_set_parameters(same.integrator, &k), TVI_OK);
    ck_assert_int_eq(tvi_integrate_events(same.integrator, 0.1, 55, events, 1, &same.x.t, same.x.q, same.x.p, on_step,
                                          on_event, &plain),
                     TVI_OK);
    ck_assert_int_eq(s.calls, plain.calls);
    ck_assert_int_gt(s.calls, 60);
    ck_assert(memcmp(s.at, plain.at, (size_t)s.calls * sizeof *s.at) == 0);
    tvi_event_free(event);
    close_spring(&r, bases[0]);
    close_spring(&same, bases[1]);
}
END_TEST

/* ---- What observers may not do ----------------------------------------------------------------------------------- */

typedef struct {
    tvi_integrator *it;
    int way; /* what it tries, or nothing */
    char *saved;
    size_t size;
    long calls;
} user;

enum { NOTHING, STEPS, LOADS, RUNS, STEPS_TANGENT, RUNS_TO_TIMES, RESETS, WAYS };

/* Tries it on copies of the state. */
static tvi_status try_it(user *u, double t, const double q[], const double p[])
{
    double a = t, b[] = {q[0], q[1]}, c[] = {p[0], p[1]}, D[4] = {1}, later = t + 1;
    switch (u->way) {
    case STEPS: return tvi_step(u->it, 0.01, &a, b, c);
    case LOADS: return tvi_state_from_text(u->it, u->saved, u->size, &a, b, c);
    case RUNS: return tvi_integrate_to(u->it, 0.01, later, &a, b, c, NULL, NULL);
    case STEPS_TANGENT: return tvi_step_tangent(u->it, 0.01, &a, b, c, D, 1);
    case RUNS_TO_TIMES: return tvi_integrate_at(u->it, 0.01, &later, 1, &a, b, c, NULL, NULL);
    case RESETS: tvi_integrator_reset(u->it); return TVI_OK;
    default: return TVI_OK;
    }
}

static void use(user *u, double t, const double q[], const double p[])
{
    if (u->calls++ == 0) ck_assert_int_eq(tvi_state_to_text(u->it, t, q, p, u->saved, &u->size), TVI_OK);
    const bool may = u->way == NOTHING || u->way == RESETS;
    expect_refusal("observer", try_it(u, t, q, p), may ? TVI_OK : TVI_EINVAL, may ? "" : "in a run");
}

static int use_step(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)step;
    use(ctx, t, q, p);
    return 0;
}

static int use_event(int which, double t, const double q[], const double p[], void *ctx)
{
    (void)which;
    use(ctx, t, q, p);
    return 0;
}

static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(q, p, 2);
}

static tvi_status run_kind(int kind, tvi_integrator *it, point *x, const tvi_event *event, user *u)
{
    const double times[] = {0.3, 0.31, 2.05};
    switch (kind) {
    case 0: return tvi_integrate(it, 0.1, 20, &x->t, x->q, x->p, use_step, u);
    case 1: return tvi_integrate_to(it, 0.1, 2.05, &x->t, x->q, x->p, use_step, u);
    case 2: return tvi_integrate_at(it, 0.1, times, 3, &x->t, x->q, x->p, use_step, u);
    case 3: return tvi_integrate_events(it, 0.1, 50, &event, 1, &x->t, x->q, x->p, NULL, use_event, u);
    default: return tvi_integrate_tolerance(it, 1e-10, 2.05, &x->t, x->q, x->p, use_step, u);
    }
}

/* An observer that steps, runs or loads the integrator that calls it is refused, and the run is that of one that does
 * nothing, bit for bit; one that resets it has what a run from that state has, which is the same to roundoff. */
START_TEST(runs_are_not_disturbed)
{
    const int kind = _i / WAYS, way = _i % WAYS;
    const char *method = kind == 4 ? "taylor" : "galerkin";
    run r = run_open(&scene_kepler, method, 8), plain = run_open(&scene_kepler, method, 8);
    tvi_event *event;
    user u = {.it = r.integrator, .way = way}, none = {.it = plain.integrator};
    ck_assert_int_eq(tvi_event_create(&event, 2, TVI_EITHER, false, radial, NULL), TVI_OK);
    ck_assert_int_eq(tvi_state_to_text(r.integrator, r.x.t, r.x.q, r.x.p, NULL, &u.size), TVI_OK);
    u.saved = malloc(u.size);
    none.size = u.size;
    none.saved = malloc(u.size);
    ck_assert_int_eq(run_kind(kind, r.integrator, &r.x, event, &u), TVI_OK);
    ck_assert_int_eq(run_kind(kind, plain.integrator, &plain.x, event, &none), TVI_OK);
    ck_assert_int_gt(u.calls, 0);
    ck_assert(u.calls == none.calls);
    ck_assert(way == RESETS || same_point(&r.x, &plain.x));
    for (int i = 0; i < 2; i++) ck_assert_double_eq_tol(r.x.q[i], plain.x.q[i], 1e-14);
    ck_assert_double_eq_tol(r.x.t, plain.x.t, 1e-14);
    free(u.saved);
    free(none.saved);
    tvi_event_free(event);
    run_close(&r);
    run_close(&plain);
}
END_TEST

Suite *suite_observers(void)
{
    Suite *suite = suite_create("observers");
    TCase *tcase = tcase_create("observers");
    tcase_add_loop_test(tcase, parameters_hold_in_results, 0, 4);
    tcase_add_loop_test(tcase, parameters_hold_in_events, 0, 2);
    tcase_add_loop_test(tcase, runs_are_not_disturbed, 0, 5 * WAYS);
    suite_add_tcase(suite, tcase);
    return suite;
}
