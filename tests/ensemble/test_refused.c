/* test_refused.c - Tests what is no ensemble and no run of one: nothing is touched, and the text names it. */
#include "ensemble.h"
#include "problems/refusals.h"

#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MEMBERS = 5 };

static tvi_system *system_one;
static tvi_ensemble *ensemble;
static group is, was;

static void open_one(void)
{
    tvi_options options;
    system_one = system_of(&forms[0]);
    ck_assert(has_options(system_one, &methods[0], &options));
    OK(tvi_ensemble_create(&ensemble, system_one, &options, MEMBERS, 1));
    start_group(&is, MEMBERS, 0);
    was = is;
}

static void close_one(void)
{
    tvi_ensemble_free(ensemble);
    tvi_system_free(system_one);
}

static void expect_members_unchanged(const char *text)
{
    for (int m = 0; m < MEMBERS; m++) expect_same(text, &is, m, &was, m);
}
#define expect_call_refused(call, wanted, text) (refused(text, call, wanted), expect_members_unchanged(text))

static int never(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)which, (void)t, (void)q, (void)p, (void)ctx;
    ck_abort_msg("called");
}

static int never_all(long step, int members, const double t[], const double q[], const double p[],
                     const tvi_status status[], void *ctx)
{
    (void)step, (void)members, (void)t, (void)q, (void)p, (void)status, (void)ctx;
    ck_abort_msg("called");
}

static const double times[] = {1};
static double D[ROWS];
static const tvi_event *const nothing[] = {NULL};

static const struct {
    tvi_ensemble_plan plan;
    const char *text;
} plans[] = {
    {{.h = H, .steps = -1}, "steps is negative"},
    {{.h = 0, .steps = 1}, "h is 0"},
    {{.h = NAN, .steps = 1}, "not finite"},
    {{.h = INFINITY, .t_end = 1, .has_t_end = true}, "not finite"},
    {{.h = H, .time_count = -1}, "a count is negative"},
    {{.h = H, .time_count = 1}, "times is NULL"},
    {{.h = H, .steps = 1, .times = times, .time_count = 1}, "steps and time_count are both given"},
    {{.h = H, .tolerance = 1e-9, .t_end = 1}, "h and tolerance"},
    {{.tolerance = 1e-9, .steps = 1}, "steps and tolerance are both given"},
    {{.tolerance = 1e-9, .times = times, .time_count = 1}, "times and tolerance are both given"},
    {{.h = H, .steps = 1, .t_end = 5, .has_t_end = true}, "steps and has_t_end are both given"},
    {{.h = H, .times = times, .time_count = 1, .t_end = 5}, "t_end is given without has_t_end"},
    {{.h = H, .steps = 1, .times = times}, "times is given, and time_count is 0"},
    {{.h = H, .steps = 1, .at_time = never}, "at_time is given, and time_count is 0"},
    {{.h = H, .steps = 1, .on_event = never}, "on_event is given, and event_count is 0"},
    {{.h = H, .steps = 1, .D = D}, "D is given, and columns is 0"},
    {{.tolerance = 1e-20, .t_end = 1}, "DBL_EPSILON"},
    {{.h = H, .t_end = NAN, .has_t_end = true}, "t_end is not finite"},
    {{.h = H, .steps = 1, .event_count = -1}, "count = -1 is negative"},
    {{.h = H, .steps = 1, .event_count = 1}, "event_count is given, and events is NULL"},
    {{.h = H, .steps = 1, .events = nothing, .event_count = 1}, "events[0] is NULL"},
    {{.h = H, .steps = 1, .columns = -1}, "a count is negative"},
    {{.h = H, .steps = 1, .columns = 1}, "columns is given, and D is NULL"},
    {{.h = H, .t_end = 1, .has_t_end = true, .observer = never_all}, "observer is given with times or t_end"},
    {{.h = H, .steps = 1, .largest_step = 0.1}, "largest_step is given without tolerance"},
    {{.tolerance = 1e-9, .t_end = 1, .largest_step = -0.1}, "largest_step is negative"},
    {{.tolerance = 1e-9, .t_end = 1, .largest_step = INFINITY}, "largest_step is negative or not finite"},
    {{.h = H, .steps = 1, .size = sizeof(tvi_run_plan) - 1}, "size is not that of"},
    {{.h = H, .steps = 1, .size = sizeof(tvi_run_plan) + 8}, "size is not that of"},
};
enum { PLANS = sizeof plans / sizeof *plans };

START_TEST(plans_that_are_none)
{
    tvi_ensemble_plan plan = plans[_i].plan;
    if (plan.event_count > 0) plan.on_event = never;
    if (plan.time_count > 0) plan.at_time = never;
    expect_call_refused(tvi_ensemble_run(ensemble, &plan, is.t, is.q, is.p, is.status), TVI_EINVAL, plans[_i].text);
    tvi_options options;
    alone a;
    static group x, y;
    ck_assert(has_options(system_one, &methods[0], &options));
    a = start_alone(system_one, &options, 0);
    (void)group_of(&a, &x);
    expect_call_refused(tvi_run(a.integrator, &plan, &a.t, a.q, a.p), TVI_EINVAL, plans[_i].text);
    (void)group_of(&a, &y);
    x.status[0] = y.status[0] = TVI_OK;
    expect_same(plans[_i].text, &x, 0, &y, 0);
    end_alone(&a);
}
END_TEST

/* No steps: nothing is done, and nobody is told. */
START_TEST(no_steps)
{
    ck_assert_int_eq(tvi_ensemble_integrate(ensemble, H, 0, is.t, is.q, is.p, is.status, never_all, NULL), TVI_OK);
    for (int m = 0; m < MEMBERS; m++) {
        ck_assert_int_eq(is.status[m], TVI_OK);
        was.status[m] = TVI_OK;
        expect_same("no steps", &is, m, &was, m);
    }
}
END_TEST

/* Threads of eight megabytes of stack in an address space of two gigabytes: the ensemble runs on those that start, or
 * is refused. */
START_TEST(too_many_threads)
{
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    enum { MANY = 1000 };
    static group many, few;
    tvi_ensemble *of_many, *of_one;
    const struct rlimit two = {(rlim_t)2 << 30, (rlim_t)2 << 30};
    ck_assert_int_eq(setrlimit(RLIMIT_AS, &two), 0);
    OK(tvi_ensemble_create(&of_many, system_one, NULL, MANY, MANY));
    OK(tvi_ensemble_create(&of_one, system_one, NULL, MANY, 1));
    start_group(&many, MANY, 0);
    start_group(&few, MANY, 0);
    OK(tvi_ensemble_integrate(of_many, H, 2, many.t, many.q, many.p, many.status, NULL, NULL));
    OK(tvi_ensemble_integrate(of_one, H, 2, few.t, few.q, few.p, few.status, NULL, NULL));
    for (int m = 0; m < MANY; m++) expect_same("threads", &many, m, &few, m);
    tvi_ensemble_free(of_many);
    tvi_ensemble_free(of_one);
#endif
}
END_TEST

/* The threads of a run end with it, so that a child process has what its parent has. */
START_TEST(a_forked_process_runs)
{
    tvi_ensemble *of_two;
    OK(tvi_ensemble_create(&of_two, system_one, NULL, MEMBERS, 2));
    OK(tvi_ensemble_integrate(of_two, H, 2, is.t, is.q, is.p, is.status, NULL, NULL));
    const pid_t child = fork();
    if (child == 0) {
        (void)alarm(20);
        _exit(tvi_ensemble_integrate(of_two, H, 2, is.t, is.q, is.p, is.status, NULL, NULL) != TVI_OK);
    }
    int status = -1;
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert_int_eq(status, 0);
    tvi_ensemble_free(of_two);
}
END_TEST

/* An observer that longjmp leaves: the integrator is free after a reset, and the ensemble can be freed alone. */
static jmp_buf out_of_the_run;

static int jump(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)which, (void)t, (void)q, (void)p;
    if (pthread_equal(pthread_self(), *(pthread_t *)ctx)) longjmp(out_of_the_run, 1);
    return 0;
}

START_TEST(observers_that_are_left)
{
    pthread_t own = pthread_self();
    const tvi_run_plan plan = {.h = H, .steps = 20000, .at_step = jump, .ctx = &own}, plain = {.h = H, .steps = 1};
    tvi_options options;
    tvi_ensemble *volatile left;
    tvi_stats stats;
    ck_assert(has_options(system_one, &methods[0], &options));
    static alone a;
    a = start_alone(system_one, &options, 0);
    if (setjmp(out_of_the_run) == 0) ck_assert_int_eq(tvi_run(a.integrator, &plan, &a.t, a.q, a.p), -1);
    refused("may not step it", tvi_step(a.integrator, H, &a.t, a.q, a.p), TVI_EINVAL);
    tvi_integrator_reset(a.integrator);
    OK(tvi_step(a.integrator, H, &a.t, a.q, a.p));
    end_alone(&a);
    for (volatile int threads = 1; threads <= 3; threads++) {
        tvi_ensemble *e;
        OK(tvi_ensemble_create(&e, system_one, &options, MEMBERS, threads));
        left = e;
        start_group(&is, MEMBERS, 0);
        if (setjmp(out_of_the_run) == 0) {
            OK(tvi_ensemble_run(left, &plan, is.t, is.q, is.p, is.status));
            ck_assert_int_gt(threads, 1); /* Others have run all members before this thread had one. */
            tvi_ensemble_free(left);
            continue;
        }
        tvi_ensemble_reset(left);
        refused("free the ensemble", tvi_ensemble_stats(left, &stats), TVI_EINVAL);
        refused("free the ensemble", tvi_ensemble_run(left, &plain, is.t, is.q, is.p, is.status), TVI_EINVAL);
        tvi_ensemble_free(left);
    }
}
END_TEST

/* A look ahead: an observer may reset its integrator, but the run ends where it steps it. */
static int reset_and_step(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    alone ahead = *(const alone *)ctx;
    (void)member, (void)which;
    tvi_integrator_reset(ahead.integrator);
    ahead.t = t;
    memcpy(ahead.q, q, sizeof ahead.q);
    memcpy(ahead.p, p, sizeof ahead.p);
    OK(tvi_step(ahead.integrator, H, &ahead.t, ahead.q, ahead.p));
    return 0;
}

START_TEST(an_observer_that_resets_and_steps)
{
    static const double at[] = {0.3 * H, 5 * H};
    tvi_run_plan runs[] = {{.h = H, .steps = 3, .at_step = reset_and_step},
                           {.h = H, .t_end = 3, .has_t_end = true, .at_step = reset_and_step},
                           {.h = H, .times = at, .time_count = 2, .at_time = reset_and_step}};
    tvi_options options;
    ck_assert(has_options(system_one, &methods[0], &options));
    for (int k = 0; k < 3; k++) {
        alone a = start_alone(system_one, &options, 0);
        runs[k].ctx = &a;
        refused("has reset the integrator and stepped it", tvi_run(a.integrator, &runs[k], &a.t, a.q, a.p), TVI_EINVAL);
        end_alone(&a);
    }
}
END_TEST

START_TEST(arguments_that_are_missing)
{
    const tvi_ensemble_plan plan = {.h = H, .steps = 1}, fine = {.tolerance = 1e-9, .t_end = 1};
    tvi_status *status = is.status;
    double *t = is.t, *q = is.q, *p = is.p;
    tvi_stats stats;
    tvi_ensemble *none = ensemble;
    expect_call_refused(tvi_ensemble_run(NULL, &plan, t, q, p, status), TVI_EINVAL, "ensemble is NULL");
    expect_call_refused(tvi_ensemble_run(ensemble, NULL, t, q, p, status), TVI_EINVAL, "plan is NULL");
    expect_call_refused(tvi_ensemble_run(ensemble, &plan, NULL, q, p, status), TVI_EINVAL, "t is NULL");
    expect_call_refused(tvi_ensemble_run(ensemble, &plan, t, NULL, p, status), TVI_EINVAL, "q is NULL");
    expect_call_refused(tvi_ensemble_run(ensemble, &plan, t, q, NULL, status), TVI_EINVAL, "p is NULL");
    expect_call_refused(tvi_ensemble_run(ensemble, &plan, t, q, p, NULL), TVI_EINVAL, "status is NULL");
    expect_call_refused(tvi_ensemble_run(ensemble, &fine, t, q, p, status), TVI_EUNSUPPORTED, "\"taylor\"");
    alone a = {.integrator = NULL};
    tvi_options options;
    ck_assert(has_options(system_one, &methods[0], &options));
    a = start_alone(system_one, &options, 0);
    expect_call_refused(tvi_run(NULL, &plan, &a.t, a.q, a.p), TVI_EINVAL, "integrator is NULL");
    expect_call_refused(tvi_run(a.integrator, NULL, &a.t, a.q, a.p), TVI_EINVAL, "plan is NULL");
    expect_call_refused(tvi_run(a.integrator, &plan, NULL, a.q, a.p), TVI_EINVAL, "t is NULL");
    expect_call_refused(tvi_run(a.integrator, &plan, &a.t, NULL, a.p), TVI_EINVAL, "q is NULL");
    expect_call_refused(tvi_run(a.integrator, &plan, &a.t, a.q, NULL), TVI_EINVAL, "p is NULL");
    expect_call_refused(tvi_run(a.integrator, &fine, &a.t, a.q, a.p), TVI_EUNSUPPORTED, "\"taylor\"");
    end_alone(&a);
    expect_call_refused(tvi_ensemble_integrate(NULL, H, 1, t, q, p, status, NULL, NULL), TVI_EINVAL,
                        "ensemble is NULL");
    expect_call_refused(tvi_ensemble_integrate(ensemble, H, 1, t, q, p, NULL, NULL, NULL), TVI_EINVAL,
                        "status is NULL");
    expect_call_refused(tvi_ensemble_integrate(ensemble, 0, 1, t, q, p, status, NULL, NULL), TVI_EINVAL, "h is 0");
    expect_call_refused(tvi_ensemble_integrate(ensemble, H, -1, t, q, p, status, NULL, NULL), TVI_EINVAL, "negative");
    expect_call_refused(tvi_ensemble_create(NULL, system_one, NULL, 1, 1), TVI_EINVAL, "out is NULL");
    expect_call_refused(tvi_ensemble_create(&none, NULL, NULL, 1, 1), TVI_EINVAL, "system is NULL");
    expect_call_refused(tvi_ensemble_create(&none, system_one, NULL, 0, 1), TVI_EINVAL, "members = 0");
    expect_call_refused(tvi_ensemble_create(&none, system_one, NULL, 1, -1), TVI_EINVAL, "threads = -1");
    expect_call_refused(tvi_ensemble_create(&none, system_one, &(tvi_options){.order = 77}, 1, 1), TVI_EINVAL, "order");
    ck_assert_ptr_null(none);
    expect_call_refused(tvi_ensemble_set_parameters(NULL, D), TVI_EINVAL, "ensemble is NULL");
    expect_call_refused(tvi_ensemble_set_parameters(ensemble, NULL), TVI_EINVAL, "value is NULL");
    const double bad[MEMBERS] = {1, 1, 1, NAN, 1};
    expect_call_refused(tvi_ensemble_set_parameters(ensemble, bad), TVI_ENONFINITE, "value[3]");
    expect_call_refused(tvi_ensemble_stats(NULL, &stats), TVI_EINVAL, "ensemble is NULL");
    expect_call_refused(tvi_ensemble_stats(ensemble, NULL), TVI_EINVAL, "stats is NULL");
    expect_call_refused(tvi_ensemble_last(ensemble, t, q, p, NULL), TVI_EINVAL, "status is NULL");
    expect_call_refused(tvi_ensemble_last(ensemble, t, q, p, status), TVI_EINVAL, "no run");
    tvi_ensemble_free(NULL);
    tvi_ensemble_reset(NULL);
}
END_TEST

static group seen, asking, idle;

/* The state of a member that was written before the run, so that it would be loaded. */
static struct {
    tvi_ensemble *ensemble;
    char text[1 << 16];
    size_t length;
} before_run;

static void save_before_run(tvi_ensemble *e)
{
    before_run.ensemble = e;
    before_run.length = sizeof before_run.text;
    OK(tvi_ensemble_member_to_text(e, 0, seen.t, seen.q, seen.p, before_run.text, &before_run.length));
}

/* Calls all that may not be called while the workers hold the members. */
static int ask_in_a_run(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    tvi_ensemble *e = before_run.ensemble;
    const tvi_run_plan plan = {.h = H, .steps = 1};
    static char text[sizeof before_run.text];
    size_t length = sizeof text;
    const group was_seen = seen;
    (void)member, (void)which, (void)t, (void)q, (void)p, (void)ctx;
    refused("in a run", tvi_ensemble_run(e, &plan, seen.t, seen.q, seen.p, seen.status), TVI_EINVAL);
    refused("in a run", tvi_ensemble_integrate(e, H, 1, seen.t, seen.q, seen.p, seen.status, NULL, NULL), TVI_EINVAL);
    refused("in a run", tvi_ensemble_last(e, seen.t, seen.q, seen.p, seen.status), TVI_EINVAL);
    refused("in a run", tvi_ensemble_member_to_text(e, 0, seen.t, seen.q, seen.p, text, &length), TVI_EINVAL);
    refused("in a run", tvi_ensemble_member_from_text(e, 0, before_run.text, before_run.length, seen.t, seen.q, seen.p),
            TVI_EINVAL);
    refused("in a run", tvi_ensemble_set_parameters(e, D), TVI_EINVAL);
    refused("in a run", tvi_ensemble_stats(e, &(tvi_stats){0}), TVI_EINVAL);
    tvi_ensemble_reset(e);
    for (int m = 0; m < MEMBERS; m++) expect_same("what is refused changes nothing", &was_seen, m, &seen, m);
    return 0;
}

static int ask_nothing(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)which, (void)t, (void)q, (void)p, (void)ctx;
    return 0;
}

/* A run whose observer asks has the bits of one whose observer does not. After the run the same calls are accepted. */
START_TEST(members_are_not_read_in_a_run)
{
    tvi_system *system = system_of(&forms[0]);
    tvi_options options;
    tvi_ensemble *e;
    ck_assert(has_options(system, &methods[_i], &options));
    for (int asks = 0; asks < 2; asks++) {
        OK(tvi_ensemble_create(&e, system, &options, MEMBERS, 1));
        const tvi_run_plan plan = {.h = H, .steps = 3, .at_step = asks ? ask_in_a_run : ask_nothing};
        group *g = asks ? &asking : &idle;
        start_group(g, MEMBERS, 0);
        start_group(&seen, MEMBERS, 0);
        save_before_run(e);
        OK(tvi_ensemble_run(e, &plan, g->t, g->q, g->p, g->status));
        OK(tvi_ensemble_last(e, seen.t, seen.q, seen.p, seen.status));
        OK(tvi_ensemble_member_from_text(e, 0, before_run.text, before_run.length, seen.t, seen.q, seen.p));
        tvi_ensemble_free(e);
    }
    for (int m = 0; m < MEMBERS; m++) {
        ck_assert_int_eq(asking.status[m], TVI_OK);
        expect_same("asking", &asking, m, &idle, m);
    }
    tvi_system_free(system);
}
END_TEST

Suite *suite_refused(void)
{
    Suite *suite = suite_create("refused");
    TCase *tests = tcase_create("refused");
    tcase_add_checked_fixture(tests, open_one, close_one);
    tcase_add_loop_test(tests, plans_that_are_none, 0, PLANS);
    tcase_add_test(tests, no_steps);
    if (getenv("CK_FORK") == NULL) tcase_add_test(tests, too_many_threads); /* whose limit stays */
    tcase_add_test(tests, arguments_that_are_missing);
    tcase_add_test(tests, a_forked_process_runs);
    tcase_add_test(tests, observers_that_are_left);
    tcase_add_test(tests, an_observer_that_resets_and_steps);
    suite_add_tcase(suite, tests);
    TCase *running = tcase_create("running");
    tcase_add_loop_test(running, members_are_not_read_in_a_run, 0, method_count);
    suite_add_tcase(suite, running);
    return suite;
}
