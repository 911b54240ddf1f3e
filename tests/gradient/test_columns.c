/* test_columns.c - Tests that columns of D that are moved at once (tvi_run_plan.columns_at_once) are those that are
 * moved alone, at steps, times and events, however the run is cut and whatever changes between its steps. */
#include "columns.h"
#include "problems/refusals.h"
#include "system/system.h"

#include <math.h>
#include <string.h>

/* Ends the test where the run fails. */
static void go(columns_run *run, const tvi_run_plan *plan)
{
    const tvi_status status = tvi_run(run->it, plan, &run->t, run->q, run->p);
    ck_assert_msg(status == TVI_OK, "%s: %s", run->problem->name, tvi_last_error());
}

static void steps(columns_run *run, bool at_once, long count)
{
    const tvi_run_plan plan = columns_plan(run, at_once, count);
    go(run, &plan);
}

/* Ends the test where the orbits are not the same, or matrices differ by more than `most` of their largest element. */
static void expect_as_alone(const columns_run pair[2], double most)
{
    const double apart = columns_distance(pair[0].rows * pair[0].rows, 1, pair[0].D, pair[1].D);
    columns_same_state(pair);
    ck_assert_msg(apart <= most, "%s: %g", pair[0].problem->name, apart);
}

static void expect_same_bits(const columns_run pair[2])
{
    columns_same_state(pair);
    ck_assert_msg(memcmp(pair[0].D, pair[1].D, sizeof pair[0].D) == 0, "%s", pair[0].problem->name);
}

/* Opens two runs of the problem _i by the default method. */
static void open_pair(columns_run pair[2], int i) { columns_open_pair(pair, &columns_problems[i], NULL, 0); }

/* ---- A run ------------------------------------------------------------------------------------------------------- */

static const struct {
    const char *method;
    int order, problem;
} others[] = {{"stormer-verlet", 2, COLUMNS_KEPLER}, {"stormer-verlet", 2, COLUMNS_CHAIN},
              {"taylor", 16, COLUMNS_BODIES},        {"taylor", 20, COLUMNS_CHAIN},
              {"galerkin", 8, COLUMNS_BODIES},       {"galerkin", 20, COLUMNS_DRIVEN}};
enum { OTHERS = sizeof others / sizeof *others };

/* What is alone is rounded at each step without its low-order parts, and so are the steps of its orbit; both orbits are
 * that of the integrator, bit for bit, or the chaotic one would be another. */
START_TEST(as_alone)
{
    const bool is_other = _i >= COLUMNS_PROBLEMS;
    const columns_problem *problem = &columns_problems[is_other ? others[_i - COLUMNS_PROBLEMS].problem : _i];
    const char *method = is_other ? others[_i - COLUMNS_PROBLEMS].method : NULL;
    const int order = is_other ? others[_i - COLUMNS_PROBLEMS].order : 0;
    columns_run pair[2];
    columns_open_pair(pair, problem, method, order);
    for (int k = 0; k < 2; k++) steps(&pair[k], k == 0, is_other ? 300 : 1000);
    expect_as_alone(pair, 1e-12);
    columns_close_pair(pair);
}
END_TEST

/* To a time, either way, with a last step of another size; and back. */
START_TEST(to_a_time)
{
    columns_run pair[2];
    open_pair(pair, _i);
    for (int k = 0; k < 2; k++) {
        tvi_run_plan plan = columns_plan(&pair[k], k == 0, 0);
        plan.has_t_end = true;
        plan.t_end = 7.3;
        go(&pair[k], &plan);
        plan.h = -plan.h, plan.t_end = 2.2;
        go(&pair[k], &plan);
    }
    expect_as_alone(pair, 1e-13);
    columns_close_pair(pair);
}
END_TEST

/* Each column is measured by itself: beside others of other scales it has the same bits. */
START_TEST(scales)
{
    columns_run pair[2];
    open_pair(pair, _i);
    const int rows = pair[0].rows;
    for (int i = 0; i < rows * rows; i++) pair[0].D[i] += 0.1 * sin(i), pair[1].D[i] = pair[0].D[i];
    for (int i = 0; i < rows * rows; i++) pair[1].D[i] = ldexp(pair[1].D[i], 100 * (i % rows % 3 - 1));
    steps(&pair[0], true, 100);
    steps(&pair[1], true, 100);
    for (int i = 0; i < rows * rows; i++) pair[1].D[i] = ldexp(pair[1].D[i], -100 * (i % rows % 3 - 1));
    expect_same_bits(pair);
    columns_close_pair(pair);
}
END_TEST

/* ---- Times and events -------------------------------------------------------------------------------------------- */

enum { MOST_TOLD = 64, TOLD_TIMES = 23 };

typedef struct {
    const columns_run *run;
    int count;
    double t[MOST_TOLD], D[MOST_TOLD][COLUMNS_MOST];
} diary;

static int tell(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    diary *d = ctx;
    (void)member, (void)which, (void)q, (void)p;
    ck_assert_int_lt(d->count, MOST_TOLD);
    d->t[d->count] = t;
    memcpy(d->D[d->count++], d->run->D, sizeof d->run->D);
    return 0;
}

/* A coordinate that moves falls below a part of its value at the start. */
static jet below(const jet q[], const jet p[], jet t, void *ctx)
{
    const columns_problem *problem = ctx;
    const int i = problem == &columns_problems[COLUMNS_BODIES] ? 3 : 0;
    double start_q[COLUMNS_MOST_N], start_p[COLUMNS_MOST_N];
    (void)p, (void)t;
    problem->start(start_q, start_p);
    return jet_sub(q[i], 0.6 * start_q[i]);
}

static tvi_event *event_below(const columns_problem *problem, bool is_terminal)
{
    tvi_event *event;
    ck_assert_int_eq(tvi_event_create(&event, problem->n, TVI_EITHER, is_terminal, below, (void *)problem), TVI_OK);
    return event;
}

static void tell_run(columns_run *run, bool at_once, const double times[], const tvi_event *event, diary *d)
{
    tvi_run_plan plan = columns_plan(run, at_once, 0);
    plan.times = times, plan.time_count = TOLD_TIMES;
    plan.events = &event, plan.event_count = 1;
    plan.at_time = plan.on_event = tell;
    plan.ctx = d;
    d->run = run;
    d->count = 0;
    go(run, &plan);
}

/* The times begin with the start, come several in a step and at its end, and leave steps out. */
START_TEST(times_and_events)
{
    static diary one, other;
    columns_run pair[2];
    double times[TOLD_TIMES];
    const columns_problem *problem = &columns_problems[_i];
    tvi_event *event = event_below(problem, false);
    open_pair(pair, _i);
    for (int i = 0; i < TOLD_TIMES; i++) times[i] = problem->h * (i < 6 ? 0.25 * i : 0.7 * i);
    tell_run(&pair[0], true, times, event, &one);
    tell_run(&pair[1], false, times, event, &other);
    ck_assert_int_eq(one.count, other.count);
    ck_assert_int_gt(one.count, TOLD_TIMES);
    for (int i = 0; i < one.count; i++) {
        ck_assert(one.t[i] == other.t[i]);
        ck_assert_double_le(columns_distance(pair[0].rows * pair[0].rows, 1, one.D[i], other.D[i]), 1e-13);
    }
    expect_as_alone(pair, 1e-13);
    tvi_event_free(event);
    columns_close_pair(pair);
}
END_TEST

/* A terminal event ends the run with D there, from which it goes on. */
START_TEST(on_from_an_event)
{
    columns_run pair[2];
    tvi_event *event = event_below(&columns_problems[_i], true);
    const tvi_event *const *events = (const tvi_event *const *)&event;
    open_pair(pair, _i);
    for (int k = 0; k < 2; k++) {
        tvi_run_plan plan = columns_plan(&pair[k], k == 0, 10000);
        plan.events = events, plan.event_count = 1;
        for (int i = 0; i < 3; i++)
            ck_assert_int_eq(tvi_run(pair[k].it, &plan, &pair[k].t, pair[k].q, pair[k].p), TVI_ESTOPPED);
        steps(&pair[k], k == 0, 10);
    }
    expect_as_alone(pair, 2e-13);
    tvi_event_free(event);
    columns_close_pair(pair);
}
END_TEST

/* ---- Runs in pieces ---------------------------------------------------------------------------------------------- */

START_TEST(cut_runs)
{
    columns_run pair[2];
    open_pair(pair, _i);
    steps(&pair[0], true, 40);
    for (int k = 0; k < 3; k++) steps(&pair[1], true, (const int[]){1, 12, 27}[k]);
    expect_same_bits(pair);
    columns_close_pair(pair);
}
END_TEST

/* A list of times in two calls, of which the second begins in the last step of the first; and there, too, where that
 * step had moved the columns alone. */
START_TEST(times_in_two_calls)
{
    static diary one, parts;
    columns_run pair[2];
    const double h = columns_problems[_i].h, times[] = {0.4 * h, 2.1 * h, 2.3 * h, 2.6 * h, 4.5 * h};
    for (int mixed = 0; mixed < 2; mixed++) {
        open_pair(pair, _i);
        for (int k = 0; k < 2; k++) {
            diary *d = k ? &parts : &one;
            tvi_run_plan plan = columns_plan(&pair[k], k == 0 || !mixed, 0);
            plan.times = times, plan.time_count = k ? 3 : 5;
            plan.at_time = tell, plan.ctx = d;
            d->run = &pair[k], d->count = 0;
            go(&pair[k], &plan);
            plan.times = times + 3, plan.time_count = 2, plan.columns_at_once = true;
            if (k) go(&pair[k], &plan);
        }
        ck_assert_int_eq(parts.count, 5);
        for (int i = 0; i < 5; i++)
            if (mixed)
                ck_assert_double_le(columns_distance(pair[0].rows * pair[0].rows, 1, parts.D[i], one.D[i]), 1e-14);
            else ck_assert(memcmp(parts.D[i], one.D[i], sizeof one.D[i]) == 0);
        if (!mixed) expect_same_bits(pair);
        columns_close_pair(pair);
    }
}
END_TEST

/* From a state with the D of the last step's end: nothing is left of the steps before. */
START_TEST(begins_anew)
{
    columns_run pair[2];
    open_pair(pair, _i);
    steps(&pair[0], true, 20);
    pair[0].t = 0;
    pair[0].problem->start(pair[0].q, pair[0].p);
    memcpy(pair[1].D, pair[0].D, sizeof pair[1].D);
    steps(&pair[0], true, 20);
    steps(&pair[1], true, 20);
    expect_same_bits(pair);
    columns_close_pair(pair);
}
END_TEST

/* A state that is read as text, of as many steps and with the same D, but with other parameters. */
START_TEST(from_a_text)
{
    static char text[1 << 16];
    columns_run pair[2];
    open_pair(pair, _i);
    for (int k = 0; k < 2; k++) {
        columns_run other;
        double value[COLUMNS_MOST_PARAMETERS];
        size_t size = sizeof text;
        columns_open(&other, &columns_problems[_i], NULL, 0);
        tvi_system_recorded_parameters(other.system, value);
        for (int i = 0; i < other.rows - 2 * other.n; i++) value[i] *= 1.1;
        ck_assert_int_eq(tvi_integrator_set_parameters(other.it, value), TVI_OK);
        steps(&other, false, 8);
        steps(&pair[k], k == 0, 8);
        ck_assert_int_eq(tvi_state_to_text(other.it, other.t, other.q, other.p, text, &size), TVI_OK);
        ck_assert_int_eq(tvi_state_from_text(pair[k].it, text, size, &pair[k].t, pair[k].q, pair[k].p), TVI_OK);
        steps(&pair[k], k == 0, 8);
        columns_close(&other);
    }
    expect_as_alone(pair, 1e-13);
    columns_close_pair(pair);
}
END_TEST

/* Changes D after some steps: other numbers, and other parameters that a column moves. */
static int change(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    columns_run *run = ctx;
    (void)member, (void)t, (void)q, (void)p;
    if (which % 7 == 3)
        for (int i = 0; i < run->rows * run->rows; i++) run->D[i] *= 1.1;
    if (which == 11) run->D[(run->rows - 1) * run->rows] = 0.7;
    return 0;
}

START_TEST(changed_between)
{
    columns_run pair[2];
    open_pair(pair, _i);
    for (int k = 0; k < 2; k++) {
        double value[COLUMNS_MOST_PARAMETERS];
        tvi_run_plan plan = columns_plan(&pair[k], k == 0, 30);
        plan.at_step = change;
        plan.ctx = &pair[k];
        go(&pair[k], &plan);
        tvi_system_recorded_parameters(pair[k].system, value);
        for (int i = 0; i < pair[k].rows - 2 * pair[k].n; i++) value[i] *= 1.01;
        ck_assert_int_eq(tvi_integrator_set_parameters(pair[k].it, value), TVI_OK);
        steps(&pair[k], k == 0, 20);
        tvi_integrator_reset(pair[k].it);
        plan.steps = 5, plan.at_step = NULL, plan.columns = 1; /* of the same memory: another matrix */
        go(&pair[k], &plan);
    }
    expect_as_alone(pair, 1e-13);
    columns_close_pair(pair);
}
END_TEST

/* ---- Failures ---------------------------------------------------------------------------------------------------- */

/* A step of which a column overflows is undone, and D is as it was: all of it, also where columns are moved in groups
 * and the last one fails. */
START_TEST(overflows)
{
    columns_run pair[2], *failed = &pair[0];
    open_pair(pair, _i);
    for (int k = 0; k < 2; k++) {
        steps(&pair[k], true, 5);
        double *column = pair[k].D + 2 * pair[k].n - 1;
        column[0] = column[pair[k].rows * pair[k].n] = 1.7e308;
    }
    const tvi_run_plan plan = columns_plan(failed, true, 5000);
    expect_refusal("columns that overflow", tvi_run(failed->it, &plan, &failed->t, failed->q, failed->p),
                   TVI_ENONFINITE, "D at once");
    const long made = tvi_integrator_stats(failed->it)->steps - 5;
    if (made > 0) steps(&pair[1], true, made);
    expect_same_bits(pair);
    columns_close_pair(pair);
}
END_TEST

/* A step that is refused leaves D, too. */
START_TEST(refused_step)
{
    columns_run pair[2];
    open_pair(pair, COLUMNS_KEPLER);
    for (int k = 0; k < 2; k++) steps(&pair[k], true, 5);
    tvi_run_plan plan = columns_plan(&pair[0], true, 5);
    plan.h = 100;
    ck_assert_int_ne(tvi_run(pair[0].it, &plan, &pair[0].t, pair[0].q, pair[0].p), TVI_OK);
    expect_same_bits(pair);
    columns_close_pair(pair);
}
END_TEST

static void refuse(const char *what, const tvi_system *system, const char *method, int order, const char *culprit)
{
    enum { MOST = 8 };
    tvi_options options = tvi_options_default();
    tvi_integrator *it;
    double t = 0, q[MOST] = {1, 0.2}, p[MOST] = {0, 0.7}, D[2 * MOST + 1] = {1};
    if (method) ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&it, system, &options), TVI_OK);
    const tvi_run_plan plan = {.h = 0.01, .steps = 1, .D = D, .columns = 1, .columns_at_once = true};
    expect_refusal(what, tvi_run(it, &plan, &t, q, p), TVI_EUNSUPPORTED, culprit);
    ck_assert(t == 0 && D[0] == 1);
    tvi_integrator_free(it);
}

static jet half_square(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_dot(q, q, 2));
}

static void on_circle(const jet q[], jet t, jet phi[], void *ctx)
{
    (void)t, (void)ctx;
    phi[0] = jet_sub(jet_dot(q, q, 2), 1.04);
}

START_TEST(refusals)
{
    tvi_system *plain, *other;
    ck_assert_int_eq(tvi_system_potential(&plain, 2, NULL, half_square, NULL), TVI_OK);
    refuse("a generating function", plain, "midpoint", 8, "this method: it serves \"galerkin\"");
    refuse("a composition", plain, "svhd", 2, "this method");
    ck_assert_int_eq(tvi_system_rescaled(&other, plain, NULL, NULL), TVI_OK);
    refuse("K", other, NULL, 0, "take the reversible form");
    tvi_system_free(other);
    other = columns_problems[COLUMNS_MAGNETIC].make(&(tvi_system *){NULL});
    refuse("a Hamiltonian", other, "taylor", 8, "not separable: it serves \"galerkin\"");
    tvi_system_free(other);
    ck_assert_int_eq(tvi_system_lagrangian(&other, 1, columns_lagrangian, NULL), TVI_OK);
    refuse("a Lagrangian", other, NULL, 0, "state the Hamiltonian");
    tvi_system_free(other);
    ck_assert_int_eq(tvi_system_constrained(&other, plain, 1, on_circle, NULL), TVI_OK);
    refuse("constraints", other, NULL, 0, "a constrained system: leave it out");
    tvi_system_free(other);
    tvi_system_free(plain);
}
END_TEST

/* In plans and in ensembles. */
START_TEST(refused_plans)
{
    columns_run run;
    columns_open(&run, &columns_problems[COLUMNS_KEPLER], NULL, 0);
    tvi_run_plan plan = columns_plan(&run, true, 1);
    plan.D = NULL, plan.columns = 0;
    refused("columns_at_once is given without D", tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_EINVAL);
    tvi_ensemble *ensemble;
    tvi_status status;
    ck_assert_int_eq(tvi_ensemble_create(&ensemble, run.system, NULL, 1, 1), TVI_OK);
    plan = columns_plan(&run, true, 1);
    refused("columns_at_once is for tvi_run", tvi_ensemble_run(ensemble, &plan, &run.t, run.q, run.p, &status),
            TVI_EUNSUPPORTED);
    tvi_ensemble_free(ensemble);
    columns_close(&run);
}
END_TEST

Suite *suite_columns(void)
{
    Suite *suite = suite_create("columns");
    TCase *tests = tcase_create("columns");
    tcase_add_loop_test(tests, as_alone, 0, COLUMNS_PROBLEMS + OTHERS);
    tcase_add_loop_test(tests, to_a_time, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, scales, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, times_and_events, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, on_from_an_event, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, cut_runs, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, times_in_two_calls, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, begins_anew, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, from_a_text, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, changed_between, 0, COLUMNS_PROBLEMS);
    tcase_add_loop_test(tests, overflows, 0, COLUMNS_PROBLEMS);
    tcase_add_test(tests, refused_step);
    tcase_add_test(tests, refusals);
    tcase_add_test(tests, refused_plans);
    suite_add_tcase(suite, tests);
    return suite;
}
