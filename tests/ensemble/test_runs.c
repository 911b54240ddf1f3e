/* test_runs.c - Tests that a member's run is that of an integrator of its own, to the bit: events, results at times,
 * ends, sizes by a tolerance, tangents, and all of these together; and its observers are told the same. */
#include "ensemble.h"

#include <math.h>
#include <string.h>

enum { MEMBERS = 11, STEPS = 40, TOLD = 128 };
static const double TIMES[] = {0, 0.7, 0.7, 2.01, 4};
enum { TIME_COUNT = sizeof TIMES / sizeof *TIMES };

/* All that a member was told. */
typedef struct {
    int count, which[TOLD];
    double t[TOLD], x[TOLD][2 * N], D[TOLD];
    int stop_at;          /* the call, from 1; 0: none */
    const double *number; /* one of the member's D */
} diary;

static int note(diary *d, int which, double t, const double q[], const double p[])
{
    ck_assert_int_lt(d->count, TOLD);
    d->which[d->count] = which;
    d->t[d->count] = t;
    d->D[d->count] = d->number ? *d->number : 0;
    memcpy(d->x[d->count], q, N * sizeof *q);
    memcpy(d->x[d->count] + N, p, N * sizeof *p);
    return ++d->count == d->stop_at;
}

static int note_member(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    return note((diary *)ctx + member, which, t, q, p);
}

static int note_event(int which, double t, const double q[], const double p[], void *ctx)
{
    return note(ctx, which, t, q, p);
}

static int note_time(long which, double t, const double q[], const double p[], void *ctx)
{
    return note(ctx, (int)which, t, q, p);
}

static jet crossing(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

static jet turning(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return p[1];
}

static tvi_event *events[2];

/* ---- The runs, of an ensemble and of an integrator --------------------------------------------------------------- */

typedef struct {
    const char *name;
    tvi_ensemble_plan plan;
    tvi_status (*by_itself)(alone *a, diary *d);
    int least; /* calls of all together */
} kind;

static tvi_status events_alone(alone *a, diary *d)
{
    return tvi_integrate_events(a->integrator, H, STEPS, (const tvi_event *const *)events, 2, &a->t, a->q, a->p, NULL,
                                note_event, d);
}

static tvi_status times_alone(alone *a, diary *d)
{
    return tvi_integrate_at(a->integrator, H, TIMES, TIME_COUNT, &a->t, a->q, a->p, note_time, d);
}

static tvi_status end_at_time(alone *a, diary *d)
{
    (void)d;
    return tvi_integrate_to(a->integrator, H, 3.03, &a->t, a->q, a->p, NULL, NULL);
}

static tvi_status tolerance_alone(alone *a, diary *d)
{
    return tvi_integrate_tolerance_events(a->integrator, 1e-9, 5, (const tvi_event *const *)events, 2, &a->t, a->q,
                                          a->p, NULL, note_event, d);
}

static tvi_status tangent_alone(alone *a, diary *d)
{
    tvi_status status = TVI_OK;
    (void)d;
    for (int k = 0; k < STEPS && status == TVI_OK; k++)
        status = tvi_step_tangent(a->integrator, H, &a->t, a->q, a->p, a->D, COLUMNS);
    return status;
}

static tvi_status by_plan_alone(alone *a, diary *d);

#define TOLD_OF_EVENTS .event_count = 2, .on_event = note_member
static const kind kinds[] = {
    {"events", {.h = H, .steps = STEPS, TOLD_OF_EVENTS}, events_alone, 12},
    {"times", {.h = H, .times = TIMES, .time_count = TIME_COUNT, .at_time = note_member}, times_alone, 52},
    {"to", {.h = H, .t_end = 3.03, .has_t_end = true}, end_at_time, 0},
    {"tolerance", {.tolerance = 1e-9, .t_end = 5, .has_t_end = true, TOLD_OF_EVENTS}, tolerance_alone, 12},
    {"tangent", {.h = H, .steps = STEPS, .columns = COLUMNS}, tangent_alone, 0},
    {"steps, all",
     {.h = H, .steps = STEPS, .columns = COLUMNS, .at_step = note_member, TOLD_OF_EVENTS},
     by_plan_alone,
     400},
    {"to, all",
     {.h = H, .t_end = 3.03, .has_t_end = true, .columns = COLUMNS, .at_step = note_member, TOLD_OF_EVENTS},
     by_plan_alone,
     250},
    {"times, all",
     {.h = H, .times = TIMES, .time_count = TIME_COUNT, .at_time = note_member, .columns = COLUMNS, TOLD_OF_EVENTS},
     by_plan_alone,
     60},
    {"tolerance, all",
     {.tolerance = 1e-9,
      .t_end = 5,
      .has_t_end = true,
      .largest_step = 0.3,
      .columns = COLUMNS,
      .at_step = note_member,
      TOLD_OF_EVENTS},
     by_plan_alone,
     160},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static group all, one;
static diary told[MEMBERS];

static void expect_told(const char *name, int member, const diary *wanted)
{
    const diary *d = &told[member];
    bool is_same = d->count == wanted->count;
    for (int k = 0; k < d->count && is_same; k++)
        is_same = d->which[k] == wanted->which[k] && d->t[k] == wanted->t[k] && d->D[k] == wanted->D[k] &&
                  memcmp(d->x[k], wanted->x[k], sizeof d->x[k]) == 0;
    ck_assert_msg(is_same, "%s: member %d was told something else", name, member);
}

static tvi_run_plan plan_of(const kind *as, double *D, diary *told_to)
{
    tvi_run_plan plan = as->plan;
    if (plan.event_count > 0) plan.events = (const tvi_event *const *)events;
    if (plan.columns > 0) plan.D = D;
    plan.ctx = told_to;
    return plan;
}

/* The kind that is run. */
static const kind *kind_now;

static tvi_status by_plan_alone(alone *a, diary *d)
{
    const tvi_run_plan plan = plan_of(kind_now, a->D, d);
    return tvi_run(a->integrator, &plan, &a->t, a->q, a->p);
}

static void run_kind(const kind *as, const tvi_system *system, const tvi_options *options, int threads)
{
    tvi_ensemble *ensemble;
    int calls = 0;
    const tvi_run_plan plan = plan_of(as, all.D, told);
    kind_now = as;
    memset(told, 0, sizeof told);
    told[1].stop_at = 2;
    for (int m = 0; m < MEMBERS && plan.D; m++) told[m].number = &all.D[COLUMNS * MEMBERS + m]; /* row 1, column 0 */
    OK(tvi_ensemble_create(&ensemble, system, options, MEMBERS, threads));
    set_values(ensemble, MEMBERS, 0);
    start_group(&all, MEMBERS, 0);
    OK(tvi_ensemble_run(ensemble, &plan, all.t, all.q, all.p, all.status));
    for (int m = 0; m < MEMBERS; m++) {
        diary d = {.stop_at = told[m].stop_at};
        alone a = start_alone(system, options, m);
        if (plan.D) d.number = &a.D[COLUMNS];
        const tvi_status status = as->by_itself(&a, &d);
        (void)group_of(&a, &one);
        one.status[0] = status;
        expect_told(as->name, m, &d);
        calls += d.count;
        expect_same(as->name, &all, m, &one, 0);
        end_alone(&a);
    }
    ck_assert_int_ge(calls, as->least);
    tvi_ensemble_free(ensemble);
}

START_TEST(runs_are_those_of_integrators)
{
    tvi_system *system = system_of(&forms[_i / method_count / KINDS]);
    const kind *as = &kinds[_i / method_count % KINDS];
    tvi_options options;
    const bool serves = has_options(system, &methods[_i % method_count], &options);
    const bool by_tolerance = as->plan.tolerance > 0,
               is_rescaled = strcmp(forms[_i / method_count / KINDS].name, "rescaled") == 0;
    if (serves && (!by_tolerance || strcmp(methods[_i % method_count].name, "taylor") == 0) &&
        !(is_rescaled && by_tolerance))
        run_kind(as, system, &options, 1 + _i % 3);
    tvi_system_free(system);
}
END_TEST

/* A run with events goes on from one without, and the other way round. */
START_TEST(runs_follow_each_other)
{
    tvi_system *system = system_of(&forms[0]);
    tvi_options options;
    tvi_ensemble *ensemble;
    ck_assert(has_options(system, &methods[_i], &options));
    OK(tvi_ensemble_create(&ensemble, system, &options, MEMBERS, 1));
    set_values(ensemble, MEMBERS, 0);
    start_group(&all, MEMBERS, 0);
    memset(told, 0, sizeof told);
    const tvi_run_plan with_events = plan_of(&kinds[0], NULL, told);
    for (int k = 0; k < 3; k++) {
        OK(tvi_ensemble_integrate(ensemble, H, STEPS, all.t, all.q, all.p, all.status, NULL, NULL));
        OK(tvi_ensemble_run(ensemble, &with_events, all.t, all.q, all.p, all.status));
    }
    for (int m = 0; m < MEMBERS; m++) {
        alone a = start_alone(system, &options, m);
        OK(tvi_integrate(a.integrator, H, 6 * STEPS, &a.t, a.q, a.p, NULL, NULL));
        ck_assert_double_le(distance(&all, m, group_of(&a, &one), 0), 4e-14);
        ck_assert_int_ge(told[m].count, 4);
        end_alone(&a);
    }
    tvi_ensemble_free(ensemble);
    tvi_system_free(system);
}
END_TEST

/* Powers of two: D may be changed by the observer of all, after each step. */
static int halve(long step, int members, const double t[], const double q[], const double p[],
                 const tvi_status status[], void *ctx)
{
    double *D = ctx;
    (void)t, (void)q, (void)p, (void)status;
    for (int k = 0; k < ROWS * COLUMNS * members; k++) D[k] /= 2;
    return step == STEPS / 2;
}

START_TEST(an_observer_stops_and_changes_columns)
{
    tvi_system *system = system_of(&forms[0]);
    tvi_options options;
    tvi_ensemble *ensemble;
    static group plain;
    ck_assert(has_options(system, &methods[0], &options));
    for (int k = 0; k < 2; k++) {
        group *c = k ? &plain : &all;
        const tvi_ensemble_plan plan = {.h = H,
                                        .steps = k ? STEPS / 2 : STEPS,
                                        .D = c->D,
                                        .columns = COLUMNS,
                                        .observer = k ? NULL : halve,
                                        .ctx = c->D};
        OK(tvi_ensemble_create(&ensemble, system, &options, MEMBERS, 2));
        start_group(c, MEMBERS, 0);
        ck_assert_int_eq(tvi_ensemble_run(ensemble, &plan, c->t, c->q, c->p, c->status), k ? TVI_OK : TVI_ESTOPPED);
        tvi_ensemble_free(ensemble);
    }
    for (int k = 0; k < ROWS * COLUMNS * MEMBERS; k++)
        if (k / (COLUMNS * MEMBERS) < 2 * N) ck_assert_double_eq(ldexp(all.D[k], STEPS / 2), plain.D[k]);
    tvi_system_free(system);
}
END_TEST

/* The observer of all goes with events: a member that is stopped stays where it is while the others go on, and at_step
 * counts through the whole run. */
typedef struct {
    int stop_member, steps_of[MEMBERS];
    long steps;
} counts;

static int count_member(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    counts *c = ctx;
    (void)t, (void)q, (void)p;
    ck_assert_int_eq(which, ++c->steps_of[member]);
    return 0;
}

static int stop_member(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)which, (void)t, (void)q, (void)p;
    return member == ((const counts *)ctx)->stop_member;
}

static int count_all(long step, int members, const double t[], const double q[], const double p[],
                     const tvi_status status[], void *ctx)
{
    counts *c = ctx;
    (void)members, (void)t, (void)q, (void)p, (void)status;
    ck_assert_int_eq(step, ++c->steps);
    return 0;
}

START_TEST(an_observer_of_all_with_events)
{
    tvi_system *system = system_of(&forms[0]);
    tvi_options options;
    tvi_ensemble *ensemble;
    counts c = {.stop_member = 3};
    ck_assert(has_options(system, &methods[0], &options));
    tvi_run_plan plan = {.h = H, .steps = STEPS, .event_count = 2, .events = (const tvi_event *const *)events};
    plan.on_event = stop_member, plan.at_step = count_member, plan.observer = count_all, plan.ctx = &c;
    OK(tvi_ensemble_create(&ensemble, system, &options, MEMBERS, 1));
    start_group(&all, MEMBERS, 0);
    OK(tvi_ensemble_run(ensemble, &plan, all.t, all.q, all.p, all.status));
    ck_assert_int_eq(c.steps, STEPS);
    for (int m = 0; m < MEMBERS; m++) {
        const bool is_stopped = m == c.stop_member;
        ck_assert_int_eq(all.status[m], is_stopped ? TVI_ESTOPPED : TVI_OK);
        ck_assert_int_eq(c.steps_of[m], is_stopped ? (int)(all.t[m] / H) : STEPS);
        ck_assert(is_stopped ? all.t[m] < STEPS * H : all.t[m] == STEPS * H);
    }
    tvi_ensemble_free(ensemble);
    tvi_system_free(system);
}
END_TEST

static void make_events(void)
{
    OK(tvi_event_create(&events[0], N, TVI_RISING, false, crossing, NULL));
    OK(tvi_event_create(&events[1], N, TVI_EITHER, false, turning, NULL));
}

static void free_events(void)
{
    for (int k = 0; k < 2; k++) tvi_event_free(events[k]);
}

Suite *suite_runs(void)
{
    Suite *suite = suite_create("runs");
    TCase *tests = tcase_create("runs");
    tcase_add_checked_fixture(tests, make_events, free_events);
    tcase_add_loop_test(tests, runs_are_those_of_integrators, 0, form_count * method_count * KINDS);
    suite_add_tcase(suite, tests);
    TCase *following = tcase_create("following");
    tcase_add_checked_fixture(following, make_events, free_events);
    tcase_add_loop_test(following, runs_follow_each_other, 0, method_count);
    tcase_add_test(following, an_observer_stops_and_changes_columns);
    tcase_add_test(following, an_observer_of_all_with_events);
    suite_add_tcase(suite, following);
    return suite;
}
