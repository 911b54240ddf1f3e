/* test_members.c - Shows that members are integrators, to the bit, in random runs: of all forms and methods, with
 * steps, ends and lists of times that are cut into calls, events, tangent vectors, observers that stop them, failures,
 * new states and parameters, and states that are saved and loaded on the way. */
#include "ensemble.h"
#include "problems/texts.h"
#include "problems/random.h"
#include "problems/thorough.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MEMBERS = 12, ROUNDS = 6, TIMES = 4, PROBLEMS = 50, SHARES = 170 };

/* What a member was told in a round, as a hash, and the call that stops it; 0: none. */
typedef struct {
    uint64_t hash;
    int calls, stop_at;
    const double *D; /* an element of it, or NULL */
} told;

static told diary_of_member[MEMBERS], diary_of_integrator[MEMBERS];

static void add(told *d, double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    d->hash = (d->hash ^ bits) * 0x9e3779b97f4a7c15U;
}

static int note(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    told *d = (told *)ctx + member;
    add(d, which);
    add(d, t);
    for (int i = 0; i < N; i++) add(d, q[i]), add(d, p[i]);
    if (d->D) add(d, *d->D);
    return ++d->calls == d->stop_at;
}

static int note_step(int member, int step, double t, const double q[], const double p[], void *ctx)
{
    return note(member, -step, t, q, p, ctx);
}

static jet crossing(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

static jet turning(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return jet_sub(p[1], 0.01);
}

/* Members of an ensemble, and the integrators that they are compared with. */
static struct {
    uint64_t random;
    tvi_system *system;
    tvi_options options;
    bool is_taylor, is_rescaled;
    tvi_ensemble *ensemble;
    group members;
    alone by_itself[MEMBERS];
    tvi_status status[MEMBERS]; /* of the integrators */
    const tvi_event *event[2];  /* the second one ends a run */
} o;

static double uniform(double a, double b) { return a + (b - a) * number_of(&o.random); }
static int below(int n) { return whole(&o.random, n); }

static bool is_failed(tvi_status status) { return status != TVI_OK && status != TVI_ESTOPPED && status != TVI_EINVAL; }

static void compare(const char *what)
{
    static group one;
    for (int m = 0; m < MEMBERS; m++) {
        (void)group_of(&o.by_itself[m], &one);
        one.status[0] = o.status[m];
        expect_same(what, &o.members, m, &one, 0);
        ck_assert_msg(diary_of_member[m].hash == diary_of_integrator[m].hash &&
                          diary_of_member[m].calls == diary_of_integrator[m].calls,
                      "%s: member %d was told something else", what, m);
    }
}

static void compare_counts(void)
{
    tvi_stats all, sum = {0};
    OK(tvi_ensemble_stats(o.ensemble, &all));
    for (int m = 0; m < MEMBERS; m++) {
        const tvi_stats *s = tvi_integrator_stats(o.by_itself[m].integrator);
        sum.steps += s->steps, sum.passes += s->passes, sum.force_evaluations += s->force_evaluations;
        sum.expansions += s->expansions, sum.factorisations += s->factorisations;
    }
    ck_assert(all.steps == sum.steps && all.passes == sum.passes && all.expansions == sum.expansions &&
              all.force_evaluations == sum.force_evaluations && all.factorisations == sum.factorisations);
}

/* ---- A run ------------------------------------------------------------------------------------------------------- */

static int look(long step, int members, const double t[], const double q[], const double p[], const tvi_status status[],
                void *ctx)
{
    (void)step, (void)members, (void)t, (void)q, (void)p, (void)status, (void)ctx;
    return 0;
}

/* Times from the last step of member 0 on: for others they may be out of order, which is refused. */
static void choose_times(double times[TIMES], double h)
{
    double t = o.members.t[0] - below(2) * uniform(0, 1) * h;
    for (int k = 0; k < TIMES; k++) times[k] = t, t += uniform(0, 1.5) * h * (below(4) > 0);
}

static tvi_run_plan choose_plan(double times[TIMES])
{
    tvi_run_plan plan = {.h = below(8) == 0 ? 4 * H : H};
    const int mode = below(o.is_taylor && !o.is_rescaled ? 4 : 3);
    if (mode == 0) plan.steps = 1 + below(12);
    if (mode == 1) plan.has_t_end = true, plan.t_end = o.members.t[0] + uniform(0, 12) * plan.h;
    if (mode == 2) {
        choose_times(times, plan.h);
        plan.times = times, plan.time_count = TIMES, plan.at_time = note;
    }
    if (mode == 3)
        plan.h = 0, plan.tolerance = 1e-9, plan.has_t_end = true, plan.t_end = o.members.t[0] + uniform(0, 3);
    if (below(3) == 0) plan.events = o.event, plan.event_count = 1 + below(2), plan.on_event = note;
    if (below(3) == 0) plan.at_step = note_step;
    if (below(3) == 0) plan.columns = COLUMNS;
    return plan;
}

/* The runs of the integrators. One that has failed at a state is left as it is until its state is another one. */
static void run_integrators(tvi_run_plan plan)
{
    for (int m = 0; m < MEMBERS; m++) {
        alone *a = &o.by_itself[m];
        told *d = &diary_of_integrator[m];
        plan.D = plan.columns ? a->D : NULL;
        d->D = plan.D;
        plan.ctx = d;
        if (!is_failed(o.status[m]) || !isfinite(a->q[0]))
            o.status[m] = tvi_run(a->integrator, &plan, &a->t, a->q, a->p);
    }
}

static void run_both(void)
{
    double times[TIMES];
    tvi_run_plan plan = choose_plan(times);
    for (int m = 0; m < MEMBERS; m++)
        diary_of_member[m] = diary_of_integrator[m] = (told){.stop_at = below(6) == 0 ? 1 + below(4) : 0};
    run_integrators(plan);
    for (int m = 0; m < MEMBERS; m++) diary_of_member[m].D = plan.columns ? &o.members.D[m] : NULL;
    plan.D = plan.columns ? o.members.D : NULL;
    plan.ctx = diary_of_member;
    if (plan.steps > 0 && below(3) == 0) plan.observer = look;
    OK(tvi_ensemble_run(o.ensemble, &plan, o.members.t, o.members.q, o.members.p, o.members.status));
    compare(plan.tolerance > 0 ? "tolerance" : plan.time_count ? "times" : plan.steps ? "steps" : "to");
}

/* ---- Between runs ------------------------------------------------------------------------------------------------ */

static void set_state(int m)
{
    alone *a = &o.by_itself[m];
    for (int i = 0; i < N; i++) {
        a->q[i] = o.members.q[i * MEMBERS + m] = uniform(-0.2, 0.2);
        a->p[i] = o.members.p[i * MEMBERS + m] = below(5) == 0 ? uniform(-3, 3) : uniform(-0.2, 0.2);
    }
    if (below(20) == 0) a->q[0] = o.members.q[m] = NAN;
    o.status[m] = o.members.status[m] = TVI_OK;
}

static void set_parameters(void)
{
    double value[MEMBERS];
    for (int m = 0; m < MEMBERS; m++) {
        value[m] = uniform(0.75, 1.25);
        OK(tvi_integrator_set_parameters(o.by_itself[m].integrator, &value[m]));
        o.status[m] = TVI_OK;
    }
    OK(tvi_ensemble_set_parameters(o.ensemble, value));
}

/* Into an ensemble with another number of threads, and into other integrators. Members that have failed are tried
 * again. */
static void save_and_load(void)
{
    tvi_ensemble *other;
    OK(tvi_ensemble_create(&other, o.system, &o.options, MEMBERS, 1 + below(3)));
    for (int m = 0; m < MEMBERS; m++) {
        alone *a = &o.by_itself[m];
        while (!isfinite(a->q[0])) set_state(m);
        char *of_member = text_of_member(o.ensemble, m, o.members.t, o.members.q, o.members.p),
             *text = text_of_state(a->integrator, a->t, a->q, a->p);
        tvi_integrator_free(a->integrator);
        OK(tvi_integrator_create(&a->integrator, o.system, &o.options));
        OK(tvi_state_from_text(a->integrator, text, strlen(text), &a->t, a->q, a->p));
        OK(tvi_ensemble_member_from_text(other, m, of_member, strlen(of_member), o.members.t, o.members.q,
                                         o.members.p));
        o.status[m] = TVI_OK;
        free(of_member);
        free(text);
    }
    tvi_ensemble_free(o.ensemble);
    o.ensemble = other;
}

static void load_text(int m)
{
    alone *a = &o.by_itself[m];
    if (!isfinite(a->q[0])) return;
    char *text = text_of_state(a->integrator, a->t, a->q, a->p);
    OK(tvi_state_from_text(a->integrator, text, strlen(text), &a->t, a->q, a->p));
    OK(tvi_ensemble_member_from_text(o.ensemble, m, text, strlen(text), o.members.t, o.members.q, o.members.p));
    o.status[m] = TVI_OK;
    free(text);
}

static void change_both(void)
{
    const int change = below(8);
    if (change == 0) set_parameters();
    if (change == 1) save_and_load();
    if (change == 2) load_text(below(MEMBERS));
    if (change == 3)
        for (int k = 0; k < 4; k++) set_state(below(MEMBERS));
    if (change == 4) {
        tvi_ensemble_reset(o.ensemble);
        for (int m = 0; m < MEMBERS; m++) tvi_integrator_reset(o.by_itself[m].integrator), o.status[m] = TVI_OK;
    }
}

/* ---- Problems ---------------------------------------------------------------------------------------------------- */

/* A form, and a method that serves it. */
static void choose_system(void)
{
    for (;;) {
        const form *as = &forms[below(form_count)];
        const method *by = &methods[below(method_count)];
        o.system = system_of(as);
        o.is_taylor = strcmp(by->name, "taylor") == 0, o.is_rescaled = strcmp(as->name, "rescaled") == 0;
        if (has_options(o.system, by, &o.options)) return;
        tvi_system_free(o.system);
    }
}

static void run_problem(int number)
{
    o.random = (uint64_t)number;
    (void)below(2);
    choose_system();
    const int first = below(1000);
    OK(tvi_ensemble_create(&o.ensemble, o.system, &o.options, MEMBERS, 1 + below(3)));
    set_values(o.ensemble, MEMBERS, first);
    start_group(&o.members, MEMBERS, first);
    for (int m = 0; m < MEMBERS; m++) {
        o.by_itself[m] = start_alone(o.system, &o.options, first + m);
        o.status[m] = TVI_OK;
    }
    for (int round = 0; round < ROUNDS; round++) {
        run_both();
        change_both();
    }
    compare_counts();
    for (int m = 0; m < MEMBERS; m++) end_alone(&o.by_itself[m]);
    tvi_ensemble_free(o.ensemble);
    tvi_system_free(o.system);
}

START_TEST(members_are_integrators_in_random_runs)
{
    OK(tvi_event_create((tvi_event **)&o.event[0], N, TVI_EITHER, false, crossing, NULL));
    OK(tvi_event_create((tvi_event **)&o.event[1], N, TVI_RISING, true, turning, NULL));
    for (int k = 0; k < PROBLEMS; k++) run_problem(_i * PROBLEMS + k);
    for (int k = 0; k < 2; k++) tvi_event_free((tvi_event *)o.event[k]);
}
END_TEST

Suite *suite_members(void)
{
    Suite *suite = suite_create("members");
    TCase *tests = tcase_create("members");
    tcase_add_loop_test(tests, members_are_integrators_in_random_runs, 0,
                        getenv("TVI_MEMBERS") ? SHARES
                        : is_thorough()       ? SHARES / 16
                                              : 1);
    suite_add_tcase(suite, tests);
    return suite;
}
