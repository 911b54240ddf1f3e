/* test_integrals.c - Tests running integrals: their values, and their derivatives beside differences, in all forms,
 * where a run ends after a step, at a time or at an event. */
#include "gradient.h"

#include <math.h>
#include <string.h>

/* q^2 + p q times a parameter, and something of the time. */
static jet work(const jet q[], const jet p[], jet t, void *ctx)
{
    const int last = *(const int *)ctx - 1;
    const jet c = jet_parameter(q[0], 0, 1);
    return jet_add(jet_sqr(q[last]), jet_add(jet_mul(c, jet_mul(p[0], q[0])), jet_mul(0.1, jet_cos(t))));
}

static jet momentum(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return jet_sqr(p[0]);
}

static jet crossing(const jet q[], const jet p[], jet t, void *ctx)
{
    const int n = *(const int *)ctx, last = n > 2 ? n - 2 : n - 1;
    (void)p, (void)t;
    return jet_sub(q[last], 0.01);
}

typedef enum { AFTER_STEPS, AT_TIME, AT_EVENT, ENDS } end;

/* Runs with the integrals, on to an end. */
typedef struct {
    const columns_run *run;
    const tvi_event *event;
    end at;
    const double *by_integrals, *by_end;
} integrated;

/* Runs, and returns the loss of the integrals and the end; with a short run behind an event, as one record. */
static double run_from(const gradient_start *x, void *ctx)
{
    const integrated *to = ctx;
    const columns_run *run = to->run;
    gradient_start now = gradient_begin(run, x);
    double value[2], loss = 0;
    tvi_run_plan plan = {.h = run->problem->h, .record = run->record};
    if (to->at == AT_TIME) plan.has_t_end = true, plan.t_end = 6.3;
    else plan.steps = to->at == AT_EVENT ? 10000 : 20;
    if (to->at == AT_EVENT) plan.events = &to->event, plan.event_count = 1;
    ck_assert_int_eq(tvi_run(run->it, &plan, &now.t, now.q, now.p), to->at == AT_EVENT ? TVI_ESTOPPED : TVI_OK);
    if (to->at == AT_EVENT) {
        plan = (tvi_run_plan){.h = plan.h, .steps = 3, .record = run->record};
        ck_assert_int_eq(tvi_run(run->it, &plan, &now.t, now.q, now.p), TVI_OK);
    }
    tvi_record_integrals(run->record, value);
    for (int k = 0; k < 2; k++) loss += to->by_integrals[k] * value[k];
    for (int i = 0; i < run->n; i++) loss += to->by_end[i] * now.q[i] + to->by_end[run->n + i] * now.p[i];
    return loss;
}

START_TEST(beside_differences)
{
    const int orders[] = {2, 4, 6}, more = _i - ENDS * GRADIENT_PROBLEMS;
    const int problem = more < 0 ? _i / ENDS : GRADIENT_TIME, order = more < 0 ? 0 : orders[more];
    columns_run run;
    tvi_event *event;
    const double by_integrals[] = {0.7, -1.3}, by_end[2 * COLUMNS_MOST_N + 1] = {0.3};
    gradient_open(&run, problem, order > 0 ? "galerkin" : NULL, order);
    ck_assert_msg(tvi_record_integral(run.record, work, &run.n) == TVI_OK, "%s", tvi_last_error());
    ck_assert_int_eq(tvi_record_integral(run.record, momentum, NULL), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&event, run.n, TVI_RISING, true, crossing, &run.n), TVI_OK);
    integrated to = {&run, event, more < 0 ? (end)(_i % ENDS) : AFTER_STEPS, by_integrals, by_end};
    const gradient_start x = gradient_start_of(&run);
    (void)run_from(&x, &to);
    gradient_expect(&run, &(tvi_loss){.end = by_end, .integrals = by_integrals}, run_from, &to);
    tvi_event_free(event);
    columns_close(&run);
}
END_TEST

/* The action of a run of Kepler's problem, int p^2 dt, by plain and rescaled steps; a run that is cut, and one that
 * begins anew. */
START_TEST(values)
{
    static const int of[] = {COLUMNS_KEPLER, COLUMNS_REVERSIBLE, GRADIENT_K};
    double value[3][2];
    for (int k = 0; k < 3; k++) {
        columns_run run;
        gradient_open(&run, of[k], NULL, 0);
        double q[] = {1, 0}, p[] = {0, 0.8};
        ck_assert_int_eq(tvi_record_integral(run.record, momentum, NULL), TVI_OK);
        for (int again = 0; again < 2; again++) {
            double t = 0, x[2], y[2];
            memcpy(x, q, sizeof x);
            memcpy(y, p, sizeof y);
            for (int part = 1; part <= 3; part++)
                ck_assert_int_eq(
                    tvi_run(run.it,
                            &(tvi_run_plan){.h = 0.05, .has_t_end = true, .t_end = 3 * part, .record = run.record}, &t,
                            x, y),
                    TVI_OK);
            tvi_record_integrals(run.record, &value[k][again]);
        }
        ck_assert(value[k][0] == value[k][1]);
        ck_assert_double_eq_tol(value[k][0], value[0][0], 1e-12 * value[0][0]);
        columns_close(&run);
    }
}
END_TEST

static jet outside(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_log(jet_sub(q[0], 0.5));
}

static jet with_another(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_parameter(q[0], 1, 3);
}

/* What is refused, and a step whose integrand has no value. */
START_TEST(refusals)
{
    columns_run run;
    gradient_open(&run, COLUMNS_KEPLER, "stormer-verlet", 2);
    ck_assert_int_eq(tvi_record_integral(run.record, momentum, NULL), TVI_EUNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "running integrals are for galerkin"));
    ck_assert_int_eq(tvi_record_integral(NULL, momentum, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_record_integral(run.record, NULL, NULL), TVI_EUNSUPPORTED);
    columns_close(&run);
    gradient_open(&run, COLUMNS_KEPLER, NULL, 0);
    ck_assert_int_eq(tvi_record_integral(run.record, NULL, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_record_integral(run.record, with_another, NULL), TVI_EINVAL);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "a parameter that the system has not"));
    ck_assert_int_eq(tvi_record_integral(run.record, outside, NULL), TVI_OK);
    ck_assert_int_eq(
        tvi_run(run.it, &(tvi_run_plan){.h = 0.1, .steps = 100, .record = run.record}, &run.t, run.q, run.p),
        TVI_EDOMAIN);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "a running integral has no value"));
    ck_assert_double_gt(run.q[0], 0.5);
    ck_assert_int_eq(tvi_record_counts(run.record, NULL, NULL), lround(run.t / 0.1));
    columns_close(&run);
}
END_TEST

Suite *suite_integrals(void)
{
    Suite *suite = suite_create("integrals");
    TCase *c = tcase_create("integrals");
    tcase_add_loop_test(c, beside_differences, 0, ENDS * GRADIENT_PROBLEMS + 3);
    tcase_add_test(c, values);
    tcase_add_test(c, refusals);
    suite_add_tcase(suite, c);
    return suite;
}
