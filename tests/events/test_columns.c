/* test_columns.c - Tests D while something is told of a run by a plan: it is that of a part of the step, and the
 * derivative of the state that is told. */
#include "events.h"
#include "plans.h"

#include <math.h>
#include <string.h>

/* ---- Parts of a step --------------------------------------------------------------------------------------------- */

enum { PLAIN_COLUMNS = 2 };

static double largest_of(int count, const double x[])
{
    double largest = 0;
    for (int k = 0; k < count; k++) largest = fmax(largest, fabs(x[k]));
    return largest;
}

/* With steps and times without rounding: D at a time is, bit for bit, what tvi_step_tangent makes of D at the start of
 * its step, with the part of the step; and at an event to the roundoff of its time. */
START_TEST(columns_of_parts)
{
    static plan_diary d;
    static const double parts[] = {0.25, 0.75, 1.5, 1.625, 3, 7.125};
    enum { COUNT = sizeof parts / sizeof *parts };
    const pairing *pair = &pairings[_i / 2];
    const double h = (_i % 2 ? -1 : 1) * ldexp(1, (int)floor(log2(pair->h)));
    run r = run_open(pair->scene, pair->method, pair->order), part = run_open(pair->scene, pair->method, pair->order);
    const double level = r.x.q[0];
    tvi_event *const event = event_at_momentum(pair->scene->n, false, &level);
    double times[COUNT], start_D[MOST_NUMBERS];
    point start = r.x;
    memset(&d, 0, sizeof d);
    d.it = r.integrator, d.n = pair->scene->n, d.numbers = 2 * d.n * PLAIN_COLUMNS;
    for (int k = 0; k < d.numbers; k++) start_D[k] = d.D[k] = 1 + k % 3 - 0.3 * (k % 4);
    for (int i = 0; i < COUNT; i++) times[i] = parts[i] * h;
    const tvi_run_plan plan = {.h = h,
                               .times = times,
                               .time_count = COUNT,
                               .events = (const tvi_event *const *)&event,
                               .event_count = 1,
                               .D = d.D,
                               .columns = PLAIN_COLUMNS,
                               .at_time = see_time,
                               .on_event = see_event,
                               .at_step = see_step,
                               .ctx = &d};
    ck_assert_int_eq(tvi_run(r.integrator, &plan, &r.x.t, r.x.q, r.x.p), TVI_OK);
    ck_assert_int_eq(d.of_kind[TIME], COUNT);
    for (int i = 0; i < d.count; i++) {
        const told *s = &d.told[i];
        double D[MOST_NUMBERS];
        point x = start;
        memcpy(D, start_D, sizeof D);
        tvi_integrator_reset(part.integrator);
        ck_assert_int_eq(tvi_step_tangent(part.integrator, s->x.t - start.t, &x.t, x.q, x.p, D, PLAIN_COLUMNS), TVI_OK);
        if (s->kind != EVENT) ck_assert(memcmp(D, s->D, (size_t)d.numbers * sizeof *D) == 0);
        for (int k = 0; k < d.numbers; k++) ck_assert_double_eq_tol(D[k], s->D[k], 1e-12 * largest_of(d.numbers, D));
        if (s->kind == STEP) start = s->x, memcpy(start_D, s->D, sizeof start_D);
    }
    tvi_event_free(event);
    run_close(&r);
    run_close(&part);
}
END_TEST

/* ---- Derivatives ------------------------------------------------------------------------------------------------- */

/* k is a parameter, masses are unequal, and the time is in it. */
static jet spring(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    const jet k = jet_parameter(q[0], 0, 1.5), push = jet_mul(0.3, jet_mul(q[1], jet_cos(t)));
    const jet force = jet_add(jet_mul(jet_mul(0.5, k), jet_sqr(q[0])), jet_div(jet_pow(q[1], 4), 4));
    return jet_add(force, jet_add(jet_mul(0.4, jet_mul(jet_sqr(q[0]), q[1])), push));
}

static jet mass(jet x) { return jet_add(1, jet_div(jet_sqr(x), 8)); }

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_div(jet_dot(p, p, 2), jet_mul(2, mass(q[0]))), spring(q, t, ctx));
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_mul(jet_mul(0.5, mass(q[0])), jet_dot(v, v, 2)), spring(q, t, ctx));
}

enum { POTENTIAL, HAMILTONIAN, LAGRANGIAN, RESCALED, FORMS };

static tvi_status make_form(int form, tvi_system **base, tvi_system **out)
{
    static const double masses[] = {1, 2.5};
    tvi_status status;
    if (form == HAMILTONIAN) status = tvi_system_hamiltonian(base, 2, hamiltonian, NULL);
    else if (form == LAGRANGIAN) status = tvi_system_lagrangian(base, 2, lagrangian, NULL);
    else status = tvi_system_potential(base, 2, masses, spring, NULL);
    *out = *base;
    return status == TVI_OK && form == RESCALED ? tvi_system_rescaled(out, *base, wider_scale, NULL) : status;
}

static const struct {
    const char *method;
    int order;
} methods[] = {{"galerkin", 12}, {"midpoint", 12}, {"poincare", 12}, {"taylor", 14}, {"both-ends", 12}, {"right", 10}};
enum { METHODS = sizeof methods / sizeof *methods, ROWS = 5, PARAMETER = 4, GIVEN = 5 };
static const double start_of[ROWS] = {0.7, -0.4, 0.3, 0.5, 1.5}; /* q, p, k */

typedef struct {
    tvi_system *base, *system;
    tvi_options options;
    double h;
} problem;

static bool make_problem(problem *s, int form, int method, double h)
{
    tvi_integrator *it = NULL;
    ck_assert_int_eq(make_form(form, &s->base, &s->system), TVI_OK);
    s->h = h;
    const bool serves = tvi_options_named(methods[method].method, methods[method].order, &s->options) == TVI_OK &&
                        tvi_integrator_create(&it, s->system, &s->options) == TVI_OK;
    tvi_integrator_free(it);
    return serves;
}

static void free_problem(problem *s)
{
    if (s->system != s->base) tvi_system_free(s->system);
    tvi_system_free(s->base);
}

/* The states at times from a start that is moved by so much in one direction. */
static void run_beside(const problem *s, const double times[], int count, int direction, double by, plan_diary *d)
{
    double x[ROWS], t = 0;
    memcpy(x, start_of, sizeof x);
    x[direction] += by;
    memset(d, 0, sizeof *d);
    d->n = 2;
    ck_assert_int_eq(tvi_integrator_create(&d->it, s->system, &s->options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_set_parameters(d->it, &x[PARAMETER]), TVI_OK);
    const tvi_run_plan plan = {.h = s->h, .times = times, .time_count = count, .at_time = see_time, .ctx = d};
    ck_assert_int_eq(tvi_run(d->it, &plan, &t, x, x + 2), TVI_OK);
    ck_assert_int_eq(d->count, count);
    tvi_integrator_free(d->it);
}

/* The run, with D that begins as the identity, of times and events, or to a tolerance with events alone. */
static void run_with_columns(const problem *s, bool by_tolerance, plan_diary *d)
{
    static const double level[] = {0.55, 0.1};
    const double given[GIVEN] = {0.13 * s->h, 3.7 * s->h, 3.71 * s->h, 20 * s->h, 22.2 * s->h};
    tvi_event *const events[] = {event_at_place(2, false, &level[0]), event_at_momentum(2, false, &level[1])};
    double x[ROWS], t = 0;
    memcpy(x, start_of, sizeof x);
    memset(d, 0, sizeof *d);
    d->n = 2, d->numbers = ROWS * ROWS;
    for (int k = 0; k < ROWS; k++) d->D[k * ROWS + k] = 1;
    ck_assert_int_eq(tvi_integrator_create(&d->it, s->system, &s->options), TVI_OK);
    tvi_run_plan plan = {.h = s->h, .times = given, .time_count = GIVEN, .at_time = see_time, .on_event = see_event};
    if (by_tolerance) plan = (tvi_run_plan){.tolerance = 1e-13, .t_end = 22.2 * s->h, .on_event = see_event};
    plan.events = (const tvi_event *const *)events, plan.event_count = 2;
    plan.D = d->D, plan.columns = ROWS, plan.ctx = d;
    ck_assert_int_eq(tvi_run(d->it, &plan, &t, x, x + 2), TVI_OK);
    tvi_integrator_free(d->it);
    for (int i = 0; i < 2; i++) tvi_event_free(events[i]);
}

static double number_in(const point *x, int row) { return row < 2 ? x->q[row] : x->p[row - 2]; }

/* Differences of fourth order over e, of the states at the times at which something was told, also at events. */
static void expect_derivatives(const problem *s, const plan_diary *d)
{
    static const double e = 2e-3;
    static plan_diary beside[4];
    double at[MOST_SEEN];
    for (int i = 0; i < d->count; i++) at[i] = d->told[i].x.t;
    for (int column = 0; column < ROWS; column++) {
        for (int k = 0; k < 4; k++) run_beside(s, at, d->count, column, (k - 2 + (k > 1)) * e, &beside[k]);
        for (int i = 0; i < d->count; i++)
            for (int row = 0; row < 4; row++) {
                double y[4];
                for (int k = 0; k < 4; k++) y[k] = number_in(&beside[k].told[i].x, row);
                const double slope = (8 * (y[2] - y[1]) - (y[3] - y[0])) / (12 * e);
                ck_assert_double_eq_tol(slope, d->told[i].D[row * ROWS + column], 1e-8);
            }
    }
}

/* At times and events, by start and by parameter: D is the derivative of the states that are told, at fixed time. */
START_TEST(columns_are_derivatives)
{
    static plan_diary d;
    problem s;
    if (make_problem(&s, _i / METHODS / 2, _i / 2 % METHODS, _i % 2 ? -0.1 : 0.1)) {
        run_with_columns(&s, false, &d);
        ck_assert_int_eq(d.of_kind[TIME], GIVEN);
        ck_assert_int_ge(d.of_kind[EVENT], 1);
        expect_derivatives(&s, &d);
    }
    free_problem(&s);
}
END_TEST

/* The same where sizes are chosen: of the motion, which the steps are near to. */
START_TEST(columns_of_chosen_steps)
{
    static plan_diary d;
    problem s;
    if (make_problem(&s, _i / 2, 3, _i % 2 ? -0.1 : 0.1)) {
        run_with_columns(&s, true, &d);
        ck_assert_int_ge(d.of_kind[EVENT], 1);
        expect_derivatives(&s, &d);
    }
    free_problem(&s);
}
END_TEST

/* ---- Parameters that an observer sets ---------------------------------------------------------------------------- */

static int set_parameter(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    static const double k = 4;
    plan_diary *d = ctx;
    if (which == 1) ck_assert_int_eq(tvi_integrator_set_parameters(d->it, &k), TVI_OK);
    return see_time(member, which, t, q, p, ctx);
}

/* They hold from the next step on in D, too: at a later time of the same step it is that without them. */
START_TEST(parameters_hold_in_columns)
{
    static plan_diary d[2];
    problem s;
    ck_assert(make_problem(&s, _i, 0, 0.1));
    for (int sets = 0; sets < 2; sets++) {
        const double times[] = {0.02, 0.07, 0.15};
        double x[ROWS], t = 0;
        memcpy(x, start_of, sizeof x);
        memset(&d[sets], 0, sizeof d[sets]);
        d[sets].n = 2, d[sets].numbers = ROWS, d[sets].D[0] = 1;
        ck_assert_int_eq(tvi_integrator_create(&d[sets].it, s.system, &s.options), TVI_OK);
        const tvi_run_plan plan = {.h = s.h,
                                   .times = times,
                                   .time_count = 3,
                                   .D = d[sets].D,
                                   .columns = 1,
                                   .at_time = sets ? set_parameter : see_time,
                                   .ctx = &d[sets]};
        ck_assert_int_eq(tvi_run(d[sets].it, &plan, &t, x, x + 2), TVI_OK);
        tvi_integrator_free(d[sets].it);
    }
    ck_assert(memcmp(d[0].told[1].D, d[1].told[1].D, sizeof d[0].told[1].D) == 0);
    ck_assert_double_gt(fabs(d[0].told[2].D[2] - d[1].told[2].D[2]), 0.01);
    free_problem(&s);
}
END_TEST

Suite *suite_columns(void)
{
    Suite *suite = suite_create("columns");
    TCase *tcase = tcase_create("columns");
    tcase_add_loop_test(tcase, columns_of_parts, 0, 2 * PAIRINGS);
    tcase_add_loop_test(tcase, columns_are_derivatives, 0, 2 * METHODS * FORMS);
    tcase_add_loop_test(tcase, columns_of_chosen_steps, 0, 2 * RESCALED);
    tcase_add_loop_test(tcase, parameters_hold_in_columns, 0, FORMS);
    suite_add_tcase(suite, tcase);
    return suite;
}
