/* test_gradient.c - Compares gradients of runs with the tangent map of the same runs: what is told, a.M dx of each
 * direction dx, is the same number on both ways. */
#include "gradient.h"

#include "tvi_gradient.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Adds a.D for all columns of D. */
static void add_product(const columns_run *run, const double a[], const double D[], double sum[])
{
    for (int j = 0; j < run->rows; j++)
        for (int i = 0; i < 2 * run->n; i++) sum[j] += a[i] * D[i * run->rows + j];
}

static void make_loss(int count, double scale, double a[])
{
    for (int i = 0; i < count; i++) a[i] = scale * (1 + 0.3 * i - 0.05 * i * i);
}

/* The gradient by q, p and the parameters, in the order of the columns of D. */
static tvi_status gradient(const columns_run *run, const tvi_loss *loss, double out[])
{
    double by_start[2 * COLUMNS_MOST_N + 1], by_parameters[COLUMNS_MOST_PARAMETERS];
    const tvi_status status = tvi_gradient(run->record, loss, by_start, by_parameters);
    memcpy(out, by_start, (size_t)(2 * run->n) * sizeof *out);
    memcpy(out + 2 * run->n, by_parameters, (size_t)(run->rows - 2 * run->n) * sizeof *out);
    return status;
}

static bool is_rescaled(int i) { return i == COLUMNS_REVERSIBLE || i == GRADIENT_K; }

/* Ends the test where the gradient is not a.D. Columns of rescaled systems are projected at each step, and differ by
 * the error of the steps. */
static void expect_product(const columns_run *run, const tvi_loss *loss, const double product[], bool rescaled)
{
    double by[COLUMNS_MOST_ROWS];
    ck_assert_msg(gradient(run, loss, by) == TVI_OK, "%s", tvi_last_error());
    const double apart = columns_distance(run->rows, 1, by, product);
    ck_assert_msg(apart < (rescaled ? 1e-10 : 1e-12), "%s: %.3g", run->problem->name, apart);
}

/* Makes that run with the record, compares at its end, and closes it. */
static void expect_at_end(columns_run *run, tvi_run_plan plan, bool rescaled)
{
    double a[2 * COLUMNS_MOST_N + 1] = {0}, product[COLUMNS_MOST_ROWS] = {0};
    plan.record = run->record;
    ck_assert_msg(tvi_run(run->it, &plan, &run->t, run->q, run->p) == TVI_OK, "%s", tvi_last_error());
    make_loss(2 * run->n, 1, a);
    add_product(run, a, run->D, product);
    expect_product(run, &(tvi_loss){.end = a}, product, rescaled);
    columns_close(run);
}

/* The end of 1000 steps, in all forms. */
START_TEST(ends)
{
    columns_run run;
    gradient_open(&run, _i, NULL, 0);
    tvi_run_plan plan = columns_plan(&run, false, is_rescaled(_i) ? 0 : 1000);
    if (is_rescaled(_i)) plan.has_t_end = true, plan.t_end = 100;
    expect_at_end(&run, plan, is_rescaled(_i));
}
END_TEST

/* Stormer-Verlet, whose quadrature is that of its kicks. */
START_TEST(stormer_verlet)
{
    static const int of[] = {COLUMNS_KEPLER, COLUMNS_BODIES, COLUMNS_CHAIN, GRADIENT_TIME};
    columns_run run;
    gradient_open(&run, of[_i], "stormer-verlet", 2);
    tvi_run_plan plan = columns_plan(&run, false, 1000);
    plan.h /= 10;
    expect_at_end(&run, plan, false);
}
END_TEST

/* ---- What is told ------------------------------------------------------------------------------------------------ */

enum { TIMES = 40 };

/* Sums the products of the loss with D at each time or event. */
typedef struct {
    const columns_run *run;
    const double *at_times, *at_events;
    double product[COLUMNS_MOST_ROWS];
    int times, events;
    const double *event_time; /* [rows] the derivative of the time of the event by each column */
} sums;

static int add_time(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    sums *to = ctx;
    (void)member, (void)t, (void)q, (void)p;
    add_product(to->run, to->at_times + (size_t)(which - 1) * 2 * (size_t)to->run->n, to->run->D, to->product);
    to->times++;
    return 0;
}

/* Times in a step, at its end, and several in one. The run ends in a short step at t_end, and goes on from there. */
START_TEST(times)
{
    columns_run run;
    double at[TIMES], losses[TIMES * 2 * COLUMNS_MOST_N], a[2 * COLUMNS_MOST_N + 1] = {0};
    gradient_open(&run, _i, NULL, 0);
    for (int i = 0; i < TIMES; i++) at[i] = run.problem->h * (i % 4 == 0 ? i : 1.1 * i);
    for (int i = 1; i < TIMES; i++) at[i] = fmax(at[i], at[i - 1]);
    make_loss(TIMES * 2 * run.n, 1e-3, losses);
    make_loss(2 * run.n, 1, a);
    sums to = {.run = &run, .at_times = losses};
    tvi_run_plan plan = columns_plan(&run, false, 0);
    plan.record = run.record;
    plan.times = at, plan.time_count = TIMES;
    plan.at_time = add_time, plan.ctx = &to;
    plan.has_t_end = true, plan.t_end = 44.4 * run.problem->h;
    ck_assert_msg(tvi_run(run.it, &plan, &run.t, run.q, run.p) == TVI_OK, "%s", tvi_last_error());
    plan.times = NULL, plan.time_count = 0, plan.at_time = NULL;
    plan.t_end += 3.3 * run.problem->h;
    ck_assert_int_eq(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_OK);
    add_product(&run, a, run.D, to.product);
    int told;
    (void)tvi_record_counts(run.record, &told, NULL);
    ck_assert_int_eq(told, TIMES);
    ck_assert_int_eq(to.times, TIMES);
    const tvi_loss loss = {.end = a, .at_times = losses};
    for (int k = 0; k < 2; k++) expect_product(&run, &loss, to.product, is_rescaled(_i)); /* it may be asked again */
    columns_close(&run);
}
END_TEST

/* The gradient by the start of what a run tells at events, and at its end, beside central differences of runs. */
static jet crossing(const jet q[], const jet p[], jet t, void *ctx)
{
    const int n = *(const int *)ctx, last = n > 2 ? n - 2 : n - 1;
    const jet level = jet_mul(0.01, jet_parameter(q[0], 0, 1));
    return jet_add(jet_sub(q[last], level), jet_add(jet_mul(0.05, p[last]), jet_mul(0.001, jet_sin(t))));
}

typedef struct {
    int n, count, most;
    double told[20][2 * COLUMNS_MOST_N + 1];
} told_events;

static int tell_event(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    told_events *to = ctx;
    (void)member, (void)which;
    double *at = to->told[to->count++];
    for (int i = 0; i < to->n; i++) at[i] = q[i], at[to->n + i] = p[i];
    at[2 * to->n] = t;
    return to->count == to->most;
}

typedef struct {
    const columns_run *run;
    tvi_record *record;
    const tvi_event *event;
    int events;
    const double *at_events, *end;
} through_events;

/* Runs from x through events until the last of them ends it, and on to a time, as one record; returns the loss. */
static double run_through_events(const gradient_start *x, void *ctx)
{
    const through_events *by = ctx;
    const columns_run *run = by->run;
    told_events to = {.n = run->n, .most = by->events};
    const int width = 2 * run->n + 1;
    gradient_start now = gradient_begin(run, x);
    double loss = 0;
    tvi_run_plan plan = {.h = run->problem->h, .steps = 10000, .record = by->record};
    plan.events = &by->event, plan.event_count = 1, plan.on_event = tell_event, plan.ctx = &to;
    ck_assert_int_eq(tvi_run(run->it, &plan, &now.t, now.q, now.p), TVI_ESTOPPED);
    const tvi_run_plan on = {.h = plan.h, .steps = 7, .record = by->record};
    ck_assert_msg(tvi_run(run->it, &on, &now.t, now.q, now.p) == TVI_OK, "%s", tvi_last_error());
    for (int k = 0; k < by->events; k++)
        for (int i = 0; i < width; i++) loss += by->at_events[k * width + i] * to.told[k][i];
    for (int i = 0; i < run->n; i++) loss += by->end[i] * now.q[i] + by->end[run->n + i] * now.p[i];
    return loss + by->end[2 * run->n] * now.t;
}

START_TEST(events)
{
    enum { EVENTS = 2 };
    columns_run run;
    tvi_event *event;
    double at_events[EVENTS * (2 * COLUMNS_MOST_N + 1)], end[2 * COLUMNS_MOST_N + 1];
    gradient_open(&run, _i, NULL, 0);
    ck_assert_int_eq(tvi_event_create(&event, run.n, TVI_RISING, false, crossing, &run.n), TVI_OK);
    make_loss(EVENTS * (2 * run.n + 1), 0.1, at_events);
    make_loss(2 * run.n + 1, 0.3, end);
    through_events by = {&run, run.record, event, EVENTS, at_events, end};
    const gradient_start x = gradient_start_of(&run);
    (void)run_through_events(&x, &by);
    by.record = NULL;
    gradient_expect(&run, &(tvi_loss){.end = end, .at_events = at_events}, run_through_events, &by);
    tvi_event_free(event);
    columns_close(&run);
}
END_TEST

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* Steps that find no room are made again, with the same bits: so is the gradient, whatever memory it had. The half of
 * the record that is for states has them of fewer than 700 of 1500 steps. */
START_TEST(few_bytes)
{
    double a[2 * COLUMNS_MOST_N + 1] = {0}, by[2][COLUMNS_MOST_ROWS], losses[TIMES * 2 * COLUMNS_MOST_N];
    size_t taken[2];
    for (int few = 0; few < 2; few++) {
        columns_run run;
        double at[TIMES];
        columns_open(&run, gradient_problem(_i), NULL, 0);
        for (int i = 0; i < TIMES; i++) at[i] = 2.03 * i * run.problem->h;
        const size_t state = (4 * (size_t)run.n + 6) * sizeof(double), bytes = 2 * 400 * state;
        ck_assert_int_eq(tvi_record_create(&run.record, run.it, few ? bytes : 0), TVI_OK);
        tvi_run_plan plan = {.h = run.problem->h, .times = at, .time_count = TIMES, .record = run.record};
        for (int part = 0; part < 2; part++, plan.times = NULL, plan.time_count = 0, plan.steps = 1400)
            ck_assert_msg(tvi_run(run.it, &plan, &run.t, run.q, run.p) == TVI_OK, "%s", tvi_last_error());
        make_loss(2 * run.n, 1, a);
        make_loss(TIMES * 2 * run.n, 1e-3, losses);
        for (int again = 0; again <= few; again++) {
            ck_assert_int_eq(gradient(&run, &(tvi_loss){.end = a, .at_times = losses}, by[few]), TVI_OK);
            if (few) ck_assert_mem_eq(by[0], by[1], (size_t)run.rows * sizeof **by);
        }
        ck_assert_int_gt(tvi_record_counts(run.record, NULL, NULL), 1400);
        taken[few] = tvi_record_bytes(run.record);
        columns_close(&run);
    }
    ck_assert_uint_lt(taken[1], taken[0]);
}
END_TEST

/* A record that is full fails the step, which is undone, and what it has is still right. */
START_TEST(full)
{
    columns_run run, other;
    double a[] = {1, 2, 3, 4, 0}, by[COLUMNS_MOST_ROWS], by_other[COLUMNS_MOST_ROWS];
    columns_open(&run, gradient_problem(COLUMNS_KEPLER), NULL, 0);
    ck_assert_int_eq(tvi_record_create(&run.record, run.it, 40000), TVI_OK);
    tvi_run_plan plan = {.h = 0.25, .steps = 1000000, .record = run.record};
    ck_assert_int_eq(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_ENOMEM);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "the record is full after "));
    const long steps = tvi_record_counts(run.record, NULL, NULL);
    ck_assert_int_gt(steps, 1000);
    ck_assert(run.t == 0.25 * (double)steps);
    ck_assert_int_eq(gradient(&run, &(tvi_loss){.end = a}, by), TVI_OK);
    gradient_open(&other, COLUMNS_KEPLER, NULL, 0);
    plan.steps = steps, plan.record = other.record;
    ck_assert_int_eq(tvi_run(other.it, &plan, &other.t, other.q, other.p), TVI_OK);
    ck_assert_int_eq(gradient(&other, &(tvi_loss){.end = a}, by_other), TVI_OK);
    ck_assert_mem_eq(by, by_other, 5 * sizeof *by);
    columns_close(&run);
    columns_close(&other);
}
END_TEST

/* ---- Sizes ------------------------------------------------------------------------------------------------------- */

/* The gradient is linear in the loss, whatever its size is beside that of the state. */
START_TEST(scales)
{
    static const double scale[] = {1e-30, 1e-12, 1e12, 1e30};
    columns_run run;
    double a[2 * COLUMNS_MOST_N + 1] = {0}, by[COLUMNS_MOST_ROWS], one[COLUMNS_MOST_ROWS];
    gradient_open(&run, _i, NULL, 0);
    const tvi_run_plan plan = {.h = run.problem->h, .steps = 300, .record = run.record};
    ck_assert_int_eq(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_OK);
    make_loss(2 * run.n, 1, a);
    ck_assert_int_eq(gradient(&run, &(tvi_loss){.end = a}, one), TVI_OK);
    for (int k = 0; k < 4; k++) {
        make_loss(2 * run.n, scale[k], a);
        ck_assert_int_eq(gradient(&run, &(tvi_loss){.end = a}, by), TVI_OK);
        for (int i = 0; i < run.rows; i++) by[i] /= scale[k];
        const double apart = columns_distance(run.rows, 1, by, one);
        ck_assert_msg(apart < 1e-12, "%s, %g: %.3g", run.problem->name, scale[k], apart);
    }
    columns_close(&run);
}
END_TEST

static jet henon_heiles(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet x2 = jet_sqr(q[0]), y2 = jet_sqr(q[1]), cubic = jet_sub(jet_mul(x2, q[1]), jet_div(jet_mul(y2, q[1]), 3));
    return jet_add(jet_div(jet_add(x2, y2), 2), jet_mul(jet_parameter(q[0], 0, 1), cubic));
}

/* A chaotic orbit, along which derivatives grow by 1e40 and more: the gradient is exact, too. */
START_TEST(chaos)
{
    tvi_system *system;
    tvi_integrator *it;
    tvi_record *record;
    double t = 0, q[] = {0, -0.15}, p[] = {0, 0.1}, D[5 * 5] = {0}, a[] = {1, 2, 3, 4, 0}, product[5] = {0};
    double by_start[5], by_parameter[1], largest = 0;
    p[0] = sqrt(2 * (1 / 6.0 - 0.15 * 0.15 / 2 - 0.15 * 0.15 * 0.15 / 3) - 0.01); /* energy 1/6 */
    ck_assert_int_eq(tvi_system_potential(&system, 2, NULL, henon_heiles, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&it, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_record_create(&record, it, 0), TVI_OK);
    for (int i = 0; i < 5; i++) D[i * 6] = 1;
    const tvi_run_plan plan = {.h = 0.5, .steps = 6400, .D = D, .columns = 5, .record = record};
    ck_assert_int_eq(tvi_run(it, &plan, &t, q, p), TVI_OK);
    for (int j = 0; j < 5; j++) {
        for (int i = 0; i < 4; i++) product[j] += a[i] * D[i * 5 + j];
        largest = fmax(largest, fabs(product[j]));
    }
    ck_assert_int_eq(tvi_gradient(record, &(tvi_loss){.end = a}, by_start, by_parameter), TVI_OK);
    by_start[4] = by_parameter[0];
    ck_assert_double_gt(largest, 1e40);
    ck_assert_double_lt(columns_distance(5, 1, by_start, product), 1e-11);
    tvi_record_free(record);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* ---- Refusals ---------------------------------------------------------------------------------------------------- */

static int set_parameters(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)which, (void)t, (void)q, (void)p;
    return tvi_integrator_set_parameters(ctx, &(const double){1.5}) == TVI_OK ? 0 : 1;
}

static jet one_length(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], 1);
}

static void refused(tvi_status status, tvi_status wanted, const char *text)
{
    ck_assert_int_eq(status, wanted);
    ck_assert_msg(strstr(tvi_last_error(), text), "%s", tvi_last_error());
}

START_TEST(refusals)
{
    columns_run run;
    tvi_record *refused_record;
    tvi_integrator *other;
    tvi_options options;
    gradient_open(&run, COLUMNS_KEPLER, NULL, 0);
    ck_assert_int_eq(tvi_options_named("poincare", 8, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&other, run.system, &options), TVI_OK);
    refused(tvi_record_create(&refused_record, other, 0), TVI_EUNSUPPORTED,
            "for the methods galerkin and stormer-verlet");
    ck_assert_ptr_null(refused_record);
    refused(tvi_record_create(NULL, run.it, 0), TVI_EINVAL, "out is NULL");
    refused(tvi_record_create(&refused_record, NULL, 0), TVI_EINVAL, "integrator is NULL");
    refused(tvi_record_create(&refused_record, run.it, 100), TVI_EINVAL, "bytes = 100 is not enough");
    const double nan_at_end[] = {1, 0, 0, NAN, 0}, end[] = {1, 0, 0, 0, 0};
    tvi_run_plan plan = {.h = 0.25, .steps = 4, .record = run.record};
    refused(tvi_run(other, &plan, &run.t, run.q, run.p), TVI_EINVAL, "created for another system or other options");
    ck_assert_int_eq(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_OK);
    double by_start[5] = {7, 7, 7, 7, 7};
    refused(tvi_gradient(run.record, &(tvi_loss){.end = nan_at_end}, by_start, NULL), TVI_ENONFINITE, "not finite");
    refused(tvi_gradient(run.record, NULL, by_start, NULL), TVI_EINVAL, "loss is NULL");
    refused(tvi_gradient(NULL, &(tvi_loss){.end = end}, by_start, NULL), TVI_EINVAL, "record is NULL");
    refused(tvi_gradient(run.record, &(tvi_loss){.size = 1}, by_start, NULL), TVI_EINVAL, "size is not that");
    ck_assert(by_start[0] == 7 && by_start[4] == 7);
    plan.at_step = set_parameters, plan.ctx = run.it;
    const double t = run.t;
    refused(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_EUNSUPPORTED, "an observer has set parameters");
    ck_assert(run.t == t + plan.h); /* the step after is undone */
    plan.at_step = NULL;
    refused(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_EUNSUPPORTED, "goes on with other parameters");
    refused(tvi_run(run.it, &(tvi_run_plan){.tolerance = 1e-9, .t_end = 1, .record = run.record}, &run.t, run.q, run.p),
            TVI_EUNSUPPORTED, "in steps of size h");
    tvi_ensemble *ensemble;
    tvi_status status[1];
    ck_assert_int_eq(tvi_ensemble_create(&ensemble, run.system, NULL, 1, 1), TVI_OK);
    refused(tvi_ensemble_run(ensemble, &plan, &run.t, run.q, run.p, status), TVI_EUNSUPPORTED,
            "an ensemble has no record");
    tvi_ensemble_free(ensemble);
    tvi_integrator_free(other);
    columns_close(&run);
}
END_TEST

static int go_on(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)which, (void)t, (void)q, (void)p, (void)ctx;
    return 0;
}

/* Where g touches 0, its time has no derivative. */
START_TEST(touches)
{
    columns_run run;
    tvi_event *event;
    gradient_open(&run, COLUMNS_KEPLER, NULL, 0);
    ck_assert_int_eq(tvi_event_create(&event, 2, TVI_EITHER, false, one_length, NULL), TVI_OK);
    const tvi_event *const list[] = {event};
    run.t = -1.5; /* from before the apocentre, x = 1, where the orbit of p = (0, 0.8) begins */
    tvi_run_plan plan = {.h = -0.25, .steps = 6};
    ck_assert_int_eq(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_OK);
    plan = (tvi_run_plan){
        .h = 0.25, .steps = 12, .record = run.record, .events = list, .event_count = 1, .on_event = go_on};
    ck_assert_int_eq(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_OK);
    int told;
    (void)tvi_record_counts(run.record, NULL, &told);
    const double at[] = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    ck_assert_int_ge(told, 1);
    refused(tvi_gradient(run.record, &(tvi_loss){.at_events = at}, (double[5]){0}, NULL), TVI_ESINGULAR, "touches 0");
    ck_assert_int_eq(tvi_gradient(run.record, &(tvi_loss){.end = at}, (double[5]){0}, NULL), TVI_OK);
    tvi_event_free(event);
    columns_close(&run);
}
END_TEST

Suite *suite_gradient(void)
{
    Suite *suite = suite_create("gradient");
    TCase *c = tcase_create("columns");
    tcase_add_loop_test(c, ends, 0, GRADIENT_PROBLEMS);
    tcase_add_loop_test(c, stormer_verlet, 0, 4);
    suite_add_tcase(suite, c);
    suite_add_tcase(suite, tcase_exact());
    suite_add_tcase(suite, tcase_sequences());
    suite_add_tcase(suite, tcase_second());
    c = tcase_create("told");
    tcase_add_loop_test(c, times, 0, GRADIENT_PROBLEMS);
    tcase_add_loop_test(c, events, 0, GRADIENT_PROBLEMS);
    suite_add_tcase(suite, c);
    c = tcase_create("memory");
    tcase_add_loop_test(c, few_bytes, 0, GRADIENT_PROBLEMS);
    tcase_add_test(c, full);
    suite_add_tcase(suite, c);
    c = tcase_create("sizes");
    tcase_add_loop_test(c, scales, 0, GRADIENT_PROBLEMS);
    tcase_add_test(c, chaos);
    suite_add_tcase(suite, c);
    c = tcase_create("refusals");
    tcase_add_test(c, refusals);
    tcase_add_test(c, touches);
    suite_add_tcase(suite, c);
    return suite;
}
