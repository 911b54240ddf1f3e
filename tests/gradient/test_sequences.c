/* test_sequences.c - Tests gradients of runs that make no step, that fail, and that tell several things at one place;
 * beside closed forms, or beside the same orbit in one run. */
#include "gradient.h"

#include "tvi_gradient.h"

#include <math.h>
#include <string.h>

static jet nothing(const jet q[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return jet_const(0);
}

/* V = t q. */
static jet rising(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return jet_mul(t, q[0]);
}

static jet at_one(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], 1);
}

static jet downwards(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(0.5, q[0]);
}

typedef struct {
    tvi_system *system;
    tvi_integrator *it;
    tvi_record *record;
} recorded;

static recorded open_recorded(int n, tvi_potential_fn *V)
{
    recorded r;
    ck_assert_int_eq(tvi_system_potential(&r.system, n, NULL, V, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&r.it, r.system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_record_create(&r.record, r.it, 0), TVI_OK);
    return r;
}

static void close_recorded(const recorded *r)
{
    tvi_record_free(r->record);
    tvi_integrator_free(r->it);
    tvi_system_free(r->system);
}

/* ---- Runs without a step ----------------------------------------------------------------------------------------- */

enum { REFUSED_STEP, TIME_AT_START, NO_STEPS, ONES };

/* Makes what makes no step, between two runs. */
static void make_no_step(int which, columns_run *run)
{
    const double t = run->t;
    tvi_run_plan plan = {.h = run->problem->h, .record = run->record};
    if (which == REFUSED_STEP) plan.h = 1e4, plan.steps = 1;
    if (which == TIME_AT_START) plan.times = &t, plan.time_count = 1;
    const tvi_status status = tvi_run(run->it, &plan, &run->t, run->q, run->p);
    if (which == REFUSED_STEP) ck_assert_int_ne(status, TVI_OK);
    else ck_assert_int_eq(status, TVI_OK);
    ck_assert(run->t == t);
}

START_TEST(runs_without_a_step)
{
    const bool at_event = _i / ONES % 2 == 1, has_t_end = _i / ONES % 2 == 0;
    const int problem = _i / ONES / 2 == 0 ? COLUMNS_KEPLER : GRADIENT_K;
    double by[2][5], by_parameter[2][1];
    for (int with = 0; with < 2; with++) {
        columns_run run;
        tvi_event *event;
        gradient_open(&run, problem, NULL, 0);
        ck_assert_int_eq(tvi_event_create(&event, 2, TVI_EITHER, true, downwards, NULL), TVI_OK);
        const tvi_event *const events[] = {event};
        tvi_run_plan plan = {.h = 0.25, .record = run.record, .has_t_end = has_t_end, .t_end = has_t_end ? 1.1 : 0};
        if (at_event) plan.events = events, plan.event_count = 1, plan.steps = 1000;
        ck_assert_int_eq(tvi_run(run.it, &plan, &run.t, run.q, run.p), at_event ? TVI_ESTOPPED : TVI_OK);
        if (with) make_no_step(_i % ONES, &run);
        plan = (tvi_run_plan){.h = 0.25, .steps = 3, .record = run.record};
        ck_assert_int_eq(tvi_run(run.it, &plan, &run.t, run.q, run.p), TVI_OK);
        const double end[] = {1, 0.5, -0.3, 0.7, 0.2};
        ck_assert_int_eq(tvi_gradient(run.record, &(tvi_loss){.end = end}, by[with], by_parameter[with]), TVI_OK);
        tvi_event_free(event);
        columns_close(&run);
    }
    for (int i = 0; i < 5; i++) ck_assert_double_eq_tol(by[0][i], by[1][i], 1e-13 * fabs(by[0][0]));
    ck_assert_double_eq_tol(by_parameter[0][0], by_parameter[1][0], 1e-13 * fabs(by[0][0]));
}
END_TEST

/* ---- At one place ------------------------------------------------------------------------------------------------ */

/* The event that ends the run lies at the end of a step, and a time, too. q = q0 + p0 t. */
START_TEST(a_time_at_the_event)
{
    recorded r = open_recorded(1, nothing);
    tvi_event *event;
    ck_assert_int_eq(tvi_event_create(&event, 1, TVI_EITHER, true, at_one, NULL), TVI_OK);
    const tvi_event *const events[] = {event};
    const double time = 1, at_time[] = {1, 0};
    double t = 0, q = 0, p = 1, by[3];
    const tvi_run_plan plan = {
        .h = 0.25, .times = &time, .time_count = 1, .events = events, .event_count = 1, .record = r.record};
    ck_assert_int_eq(tvi_run(r.it, &plan, &t, &q, &p), TVI_ESTOPPED);
    ck_assert_int_eq(tvi_gradient(r.record, &(tvi_loss){.at_times = at_time}, by, NULL), TVI_OK);
    ck_assert_double_eq_tol(by[0], 1, 1e-14);
    ck_assert_double_eq_tol(by[1], 1, 1e-14);
    ck_assert_double_eq_tol(by[2], -1, 1e-14);
    tvi_event_free(event);
    close_recorded(&r);
}
END_TEST

static jet at_level(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], jet_parameter(q[0], 0, 1));
}

static jet with_parameter(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(jet_sub(jet_parameter(q[0], 0, 1), 1), q[0]);
}

/* Of two events at one place the terminal one ends the run: its function decides when. */
START_TEST(two_events)
{
    recorded r = open_recorded(1, with_parameter);
    tvi_event *event[2];
    ck_assert_int_eq(tvi_event_create(&event[0], 1, TVI_EITHER, _i == 0, at_one, NULL), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&event[1], 1, TVI_EITHER, _i == 1, at_level, NULL), TVI_OK);
    const tvi_event *const events[] = {event[0], event[1]};
    double t = 0, q = 0, p = 1, by[3], by_level;
    const tvi_run_plan plan = {.h = 0.3, .steps = 10, .events = events, .event_count = 2, .record = r.record};
    const double end[] = {0, 0, 1};
    ck_assert_int_eq(tvi_run(r.it, &plan, &t, &q, &p), TVI_ESTOPPED);
    ck_assert_int_eq(tvi_gradient(r.record, &(tvi_loss){.end = end}, by, &by_level), TVI_OK);
    /* q'' = 1 - c at c = 1: dt/dc is 1/2 by the force, and 1 by the level */
    ck_assert_double_eq_tol(by_level, _i == 0 ? 0.5 : 1.5, 1e-13);
    ck_assert_double_eq_tol(by[1], -1, 1e-13);
    for (int k = 0; k < 2; k++) tvi_event_free(event[k]);
    close_recorded(&r);
}
END_TEST

/* ---- The time, and parameters ------------------------------------------------------------------------------------ */

/* V = t q, without parameters: q(t1) = q0 + p0 s - (t0 s^2 / 2 + s^3 / 6), s = 1.5 whatever t0 is. */
START_TEST(a_force_that_is_the_time)
{
    recorded r = open_recorded(1, rising);
    double t = 0, q = 1, p = 0.3, by[3];
    const tvi_run_plan plan = {.h = 0.25, .steps = 6, .record = r.record};
    const double end[] = {1, 0, 0};
    ck_assert_int_eq(tvi_run(r.it, &plan, &t, &q, &p), TVI_OK);
    ck_assert_int_eq(tvi_gradient(r.record, &(tvi_loss){.end = end}, by, NULL), TVI_OK);
    ck_assert_double_eq_tol(by[0], 1, 1e-14);
    ck_assert_double_eq_tol(by[1], 1.5, 1e-14);
    ck_assert_double_eq_tol(by[2], -1.125, 1e-14);
    close_recorded(&r);
}
END_TEST

/* A time that a run without a step tells, as the last thing of the record: it stays where it is when t0 moves, and
 * q(t1) = q0 + p0 (t1 - t0) - t1^3 / 6 + O(t0^2). */
START_TEST(a_time_at_the_end)
{
    recorded r = open_recorded(1, rising);
    const double ends[] = {1.5, 1.4, 0}, end = ends[_i]; /* with a full last step, a part of one, and none at all */
    double t = 0, q = 1, p = 0.3, by[3];
    tvi_run_plan plan = {.h = 0.25, .has_t_end = true, .t_end = end, .record = r.record};
    const double at_time[] = {1, 0};
    ck_assert_int_eq(tvi_run(r.it, &plan, &t, &q, &p), TVI_OK);
    plan = (tvi_run_plan){.h = 0.25, .times = &end, .time_count = 1, .record = r.record};
    ck_assert_int_eq(tvi_run(r.it, &plan, &t, &q, &p), TVI_OK);
    ck_assert_int_eq(tvi_record_counts(r.record, NULL, NULL), end > 0 ? 6 : 0);
    ck_assert_int_eq(tvi_gradient(r.record, &(tvi_loss){.at_times = at_time}, by, NULL), TVI_OK);
    ck_assert_double_eq_tol(by[0], 1, 1e-14);
    ck_assert_double_eq_tol(by[1], end, 1e-14);
    ck_assert_double_eq_tol(by[2], -0.3, 1e-14);
    close_recorded(&r);
}
END_TEST

static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet k = jet_parameter(q[0], 0, 1), level = jet_parameter(q[0], 1, 3);
    return jet_add(jet_mul(k, jet_div(jet_sqr(q[0]), 2)), level);
}

static jet slow(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_add(1, jet_sqr(q[0]));
}

static jet square(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sqr(q[0]);
}

/* The last parameter moves nothing, and the steps of the reversible form do not know it. int cos^2 = t/2 + sin 2t / 4.
 */
START_TEST(a_parameter_that_moves_nothing)
{
    tvi_system *base, *system;
    tvi_integrator *it;
    tvi_record *record;
    double t = 0, q = 1, p = 0, by[3], by_parameters[2], value;
    ck_assert_int_eq(tvi_system_potential(&base, 1, NULL, spring, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled_reversible(&system, base, slow, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&it, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_record_create(&record, it, 0), TVI_OK);
    ck_assert_int_eq(tvi_record_integral(record, square, NULL), TVI_OK);
    const tvi_run_plan plan = {.h = 0.05, .has_t_end = true, .t_end = 2, .record = record};
    ck_assert_int_eq(tvi_run(it, &plan, &t, &q, &p), TVI_OK);
    tvi_record_integrals(record, &value);
    ck_assert_double_eq_tol(value, 1 + sin(4) / 4, 1e-12);
    const double one = 1;
    ck_assert_int_eq(tvi_gradient(record, &(tvi_loss){.integrals = &one}, by, by_parameters), TVI_OK);
    ck_assert_double_eq_tol(by[0], 2 * (1 + sin(4) / 4), 1e-11);
    /* d/dw of t/2 + sin(2 w t) / (4 w), w = sqrt k */
    ck_assert_double_eq_tol(by_parameters[0], (4 * cos(4) - sin(4)) / 8, 1e-11);
    ck_assert_double_eq_tol(by_parameters[1], 0, 1e-11);
    tvi_record_free(record);
    tvi_integrator_free(it);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* The multipliers converge by passes of their own, however few those of the run are: 4 bring its steps to roundoff, and
 * would leave 6e-11 of the multipliers. */
START_TEST(few_passes)
{
    columns_run run;
    tvi_record *record;
    double by[2][5];
    for (int few = 0; few < 2; few++) {
        tvi_options options = tvi_options_default();
        tvi_integrator *it;
        columns_open(&run, gradient_problem(COLUMNS_KEPLER), NULL, 0);
        if (few) options.passes = 4;
        ck_assert_int_eq(tvi_integrator_create(&it, run.system, &options), TVI_OK);
        ck_assert_int_eq(tvi_record_create(&record, it, 0), TVI_OK);
        const tvi_run_plan plan = {.h = 0.1, .steps = 100, .record = record};
        ck_assert_int_eq(tvi_run(it, &plan, &run.t, run.q, run.p), TVI_OK);
        const double end[] = {1, 2, 3, 4, 0};
        ck_assert_int_eq(tvi_gradient(record, &(tvi_loss){.end = end}, by[few], NULL), TVI_OK);
        tvi_record_free(record);
        tvi_integrator_free(it);
        columns_close(&run);
    }
    for (int i = 0; i < 4; i++) ck_assert_double_eq_tol(by[0][i], by[1][i], 1e-13 * fabs(by[0][0]));
}
END_TEST

static jet falling(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return q[0];
}

/* A step that is undone, as that of a ball at rest, leaves nothing in the record, which begins anew with it. */
START_TEST(an_undone_step)
{
    recorded r = open_recorded(1, falling);
    tvi_event *event;
    double t = 0, q = 2, p = 0, value;
    ck_assert_int_eq(tvi_record_integral(r.record, square, NULL), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&event, 1, TVI_FALLING, true, at_one, NULL), TVI_OK);
    const tvi_event *const events[] = {event};
    const tvi_run_plan plan = {.h = 0.25, .steps = 100, .events = events, .event_count = 1, .record = r.record};
    ck_assert_int_eq(tvi_run(r.it, &plan, &t, &q, &p), TVI_ESTOPPED);
    ck_assert_int_eq(tvi_record_counts(r.record, NULL, NULL), 6); /* to t = sqrt 2 */
    tvi_record_integrals(r.record, &value);
    ck_assert_double_eq_tol(value, 43 * sqrt(2) / 15, 1e-14); /* of (2 - t^2 / 2)^2 */
    p = 1e-20;                                                /* it is back before the time moves */
    ck_assert_int_eq(tvi_run(r.it, &plan, &t, &q, &p), TVI_ENOCONV);
    ck_assert_int_eq(tvi_record_counts(r.record, NULL, NULL), 0);
    tvi_record_integrals(r.record, &value);
    ck_assert(value == 0);
    tvi_event_free(event);
    close_recorded(&r);
}
END_TEST

/* ---- A record that another run writes ---------------------------------------------------------------------------- */

typedef struct {
    tvi_integrator *other;
    tvi_record *record;
    int calls;
} nested;

static int run_inside(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    nested *to = ctx;
    double t_own = t, q_own = q[0], p_own = p[0];
    (void)member, (void)which;
    const tvi_run_plan plan = {.h = 0.1, .steps = 2, .record = to->record};
    ck_assert_int_eq(tvi_run(to->other, &plan, &t_own, &q_own, &p_own), TVI_EINVAL);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "another run writes the record"));
    ck_assert_int_eq(tvi_record_integral(to->record, square, NULL), TVI_EINVAL);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "a run writes the record"));
    to->calls++;
    return 0;
}

START_TEST(inside_an_observer)
{
    recorded r = open_recorded(1, rising);
    nested to = {.record = r.record};
    double t = 0, q = 1, p = 0.3, by[3];
    ck_assert_int_eq(tvi_integrator_create(&to.other, r.system, NULL), TVI_OK);
    const tvi_run_plan plan = {.h = 0.25, .steps = 6, .record = r.record, .at_step = run_inside, .ctx = &to};
    const double end[] = {1, 0, 0};
    ck_assert_int_eq(tvi_run(r.it, &plan, &t, &q, &p), TVI_OK);
    ck_assert_int_eq(to.calls, 6);
    ck_assert_int_eq(tvi_gradient(r.record, &(tvi_loss){.end = end}, by, NULL), TVI_OK);
    ck_assert_double_eq_tol(by[2], -1.125, 1e-14);
    tvi_integrator_free(to.other);
    close_recorded(&r);
}
END_TEST

TCase *tcase_sequences(void)
{
    TCase *c = tcase_create("sequences");
    tcase_add_loop_test(c, runs_without_a_step, 0, 4 * ONES);
    tcase_add_test(c, a_time_at_the_event);
    tcase_add_loop_test(c, two_events, 0, 2);
    tcase_add_test(c, a_force_that_is_the_time);
    tcase_add_loop_test(c, a_time_at_the_end, 0, 3);
    tcase_add_test(c, a_parameter_that_moves_nothing);
    tcase_add_test(c, an_undone_step);
    tcase_add_test(c, few_passes);
    tcase_add_test(c, inside_an_observer);
    return c;
}
