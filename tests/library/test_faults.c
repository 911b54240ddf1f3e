/* test_faults.c - Tests that an allocation that fails ends in TVI_ENOMEM, with nothing made and nothing leaked. That a
 * step makes none is in faults_steps.c. */
#include "allocation.h"
#include "everything.h"
#include "problems/thorough.h"
#include "suites.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Systems: the k-th allocation fails, for every k ------------------------------------------------------------- */

/* Makes something with allocations of its own, says whether *out is NULL on failure, and frees what it made. */
typedef tvi_status maker(const void *argument, bool *cleared);

static tvi_status make_system(const void *argument, bool *cleared)
{
    tvi_system *system = (tvi_system *)&(char){0};
    const tvi_status status = state_everything(*(const statement *)argument, &system, NULL);
    *cleared = system == NULL;
    tvi_system_free(system);
    return status;
}

typedef struct {
    const tvi_system *system;
    const tvi_options *options;
} integrator_arguments;

static tvi_status make_integrator(const void *argument, bool *cleared)
{
    const integrator_arguments *given = argument;
    tvi_integrator *integrator = (tvi_integrator *)&(char){0};
    const tvi_status status = tvi_integrator_create(&integrator, given->system, given->options);
    *cleared = integrator == NULL;
    tvi_integrator_free(integrator);
    return status;
}

static const double some_q[N] = {0.1, 0.2, 0.3}, some_p[N] = {1, 2, 3};

static tvi_status ask_energy(const void *argument, bool *cleared)
{
    double H = 42;
    const tvi_status status = tvi_energy(argument, 0, some_q, some_p, &H);
    *cleared = H == 42;
    return status;
}

static tvi_status ask_momentum(const void *argument, bool *cleared)
{
    double p[N] = {42, 42, 42};
    const tvi_status status = tvi_momentum(argument, 0, some_q, some_p, p);
    *cleared = p[0] == 42 && p[1] == 42 && p[2] == 42;
    return status;
}

static tvi_status ask_velocity(const void *argument, bool *cleared)
{
    double v[N] = {42, 42, 42};
    const tvi_status status = tvi_velocity(argument, 0, some_q, some_p, v);
    *cleared = v[0] == 42 && v[1] == 42 && v[2] == 42;
    return status;
}

static tvi_status ask_projection(const void *argument, bool *cleared)
{
    double q[N] = {0.5, 0.2, 0.3}, p[N] = {1, 3, 3};
    const tvi_status status = tvi_project(argument, 0, q, p);
    *cleared = q[0] == 0.5 && q[1] == 0.2 && p[0] == 1 && p[1] == 3;
    return status;
}

static tvi_status ask_constraints(const void *argument, bool *cleared)
{
    double value = 42, rate = 42;
    const tvi_status status = tvi_constraint_values(argument, 0, some_q, some_p, &value, &rate);
    *cleared = value == 42 && rate == 42;
    return status;
}

static tvi_status ask_multipliers(const void *argument, bool *cleared)
{
    double lambda = 42, force[N] = {42};
    const tvi_status status = tvi_multipliers(argument, 0, some_q, some_p, &lambda, force);
    *cleared = lambda == 42 && force[0] == 42;
    return status;
}

static tvi_status ask_step(const void *argument, bool *cleared)
{
    double h = 42;
    const tvi_status status = tvi_suggest_step(argument, NULL, 0, some_q, some_p, 0.01, 0.5, &h);
    *cleared = h == 42;
    return status;
}

/* A long run that begins where little is felt: the first step is too large, and its energy says so. */
static jet hole(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_add(1e-4, jet_dot(q, q, 2)), -0.5));
}

static tvi_status ask_long_step(const void *argument, bool *cleared)
{
    const double q[] = {1, 0}, p[] = {0, 0.05};
    const tvi_run_plan plan = {.t_end = 20};
    double h = 42, measured = 42;
    const tvi_status status = tvi_measure_step(argument, NULL, &plan, 0, q, p, 1e-6, &h, &measured);
    *cleared = h == 42 && measured == 42;
    return status;
}

static jet radius(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_dot(q, q, N), jet_mul(0.5, jet_dot(p, p, N)));
}

static tvi_status make_event(const void *argument, bool *cleared)
{
    (void)argument;
    tvi_event *event = (tvi_event *)&(char){0};
    const tvi_status status = tvi_event_create(&event, N, TVI_EITHER, false, radius, NULL);
    *cleared = event == NULL;
    tvi_event_free(event);
    return status;
}

typedef struct {
    tvi_integrator *integrator;
    const tvi_event *event;
} run_arguments;

static tvi_status run_with_events(const void *argument, bool *cleared)
{
    const run_arguments *given = argument;
    const tvi_event *const events[] = {given->event, given->event};
    double t = 0, q[N], p[N];
    memcpy(q, some_q, sizeof q);
    memcpy(p, some_p, sizeof p);
    const tvi_status status = tvi_integrate_events(given->integrator, 0.01, 1, events, 2, &t, q, p, NULL, NULL, NULL);
    *cleared = t == 0 && memcmp(q, some_q, sizeof q) == 0 && memcmp(p, some_p, sizeof p) == 0;
    return status;
}

static tvi_status run_to_time(const void *argument, bool *cleared)
{
    const run_arguments *given = argument;
    const double time = 0.005;
    double t = 0, q[N], p[N];
    memcpy(q, some_q, sizeof q);
    memcpy(p, some_p, sizeof p);
    const tvi_status status = tvi_integrate_at(given->integrator, 0.01, &time, 1, &t, q, p, NULL, NULL);
    *cleared = t == 0 && memcmp(q, some_q, sizeof q) == 0 && memcmp(p, some_p, sizeof p) == 0;
    return status;
}

/* The step that passes the end is taken back, and its part to there is looked for. */
static tvi_status run_to_end(const void *argument, bool *cleared)
{
    const run_arguments *given = argument;
    double t = 0, q[N], p[N];
    memcpy(q, some_q, sizeof q);
    memcpy(p, some_p, sizeof p);
    const tvi_status status = tvi_integrate_to(given->integrator, 0.01, 1e-4, &t, q, p, NULL, NULL);
    *cleared = t == 0 && memcmp(q, some_q, sizeof q) == 0 && memcmp(p, some_p, sizeof p) == 0;
    return status;
}

static tvi_status move_as_text(const void *argument, bool *cleared)
{
    const run_arguments *given = argument;
    static char text[1 << 16];
    size_t size = sizeof text;
    const double kept[N] = {42, 42, 42};
    double t = 42, q[N], p[N];
    memcpy(q, kept, sizeof q);
    memcpy(p, kept, sizeof p);
    tvi_status status = tvi_state_to_text(given->integrator, 0, some_q, some_p, text, &size);
    if (status == TVI_OK) status = tvi_state_from_text(given->integrator, text, size, &t, q, p);
    *cleared = t == 42 && memcmp(q, kept, sizeof q) == 0 && memcmp(p, kept, sizeof p) == 0;
    return status;
}

/* The number of allocations that were made to fail before all went well, or a little more: without TVI_TESTS=all one of
 * LATER is, after the first FIRST of them. */
static long fail_each(maker *make, const void *argument, allocation_failure how)
{
    enum { FIRST = 100, LATER = 17 };
    for (long k = 1;; k += k < FIRST || is_thorough() ? 1 : LATER) {
        bool cleared;
        ck_assert_int_eq(tvi_dense(NULL, 0, NULL, NULL), TVI_EINVAL); /* leaves another text */
        allocation_fail(how, k);
        const tvi_status status = make(argument, &cleared);
        const allocation_counts counts = allocation_stop();
        ck_assert_msg(counts.live == 0, "%ld blocks left when allocation %ld fails", counts.live, k);
        if (counts.fails == 0) {
            ck_assert_int_eq(status, TVI_OK);
            ck_assert(!cleared);
            return k - 1;
        }
        ck_assert_msg(status == TVI_ENOMEM, "%s when allocation %ld fails", tvi_status_string(status), k);
        ck_assert_msg(cleared, "the output when allocation %ld fails", k);
        ck_assert_ptr_nonnull(strstr(tvi_last_error(), "out of memory"));
    }
}

START_TEST(events_without_memory)
{
    const allocation_failure how = (allocation_failure)_i;
    tvi_system *system = create_everything(POTENTIAL, true);
    run_arguments given = {0};
    tvi_event *event;
    ck_assert_int_eq(tvi_integrator_create(&given.integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&event, N, TVI_EITHER, false, radius, NULL), TVI_OK);
    given.event = event;
    ck_assert_int_gt(fail_each(make_event, NULL, how), 5);
    ck_assert_int_eq(fail_each(run_with_events, &given, how), 52);
    ck_assert_int_eq(fail_each(run_to_time, &given, how), 2);
    tvi_event_free(event);
    tvi_integrator_free(given.integrator);
    tvi_system_free(system);
    system = create_everything(RESCALED, true);
    ck_assert_int_eq(tvi_integrator_create(&given.integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(fail_each(run_to_end, &given, how), 2);
    ck_assert_int_eq(fail_each(move_as_text, &given, how), 4);
    tvi_integrator_free(given.integrator);
    tvi_system_free(system);
}
END_TEST

START_TEST(systems_without_memory)
{
    const statement by = (statement)(_i / 2);
    ck_assert_int_gt(fail_each(make_system, &by, (allocation_failure)(_i % 2)), by == FORCE ? 100 : 500);
}
END_TEST

/* Questions asked of a system: they may allocate. */
START_TEST(questions_without_memory)
{
    const statement by = (statement)(_i / 2);
    const allocation_failure how = (allocation_failure)(_i % 2);
    tvi_system *system = create_everything(by, false);
    if (by != FORCE) ck_assert_int_gt(fail_each(ask_energy, system, how), 0);
    const long of_momentum = fail_each(ask_momentum, system, how), of_velocity = fail_each(ask_velocity, system, how);
    ck_assert_int_ge(of_momentum + of_velocity, by == LAGRANGIAN || by == HAMILTONIAN);
    ck_assert_int_ge(fail_each(ask_step, system, how), by == CONSTRAINED ? 2 : 3); /* "taylor" does not witness it */
    if (by == CONSTRAINED) {
        ck_assert_int_eq(fail_each(ask_projection, system, how), 1);
        ck_assert_int_eq(fail_each(ask_constraints, system, how), 1);
        ck_assert_int_eq(fail_each(ask_multipliers, system, how), 1);
    }
    tvi_system_free(system);
}
END_TEST

START_TEST(looks_without_memory)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, NULL, hole, NULL), TVI_OK);
    for (int how = FAIL_ONCE; how <= FAIL_ONWARD; how++)
        ck_assert_int_ge(fail_each(ask_long_step, system, (allocation_failure)how), 3);
    tvi_system_free(system);
}
END_TEST

/* ---- Integrators ------------------------------------------------------------------------------------------------- */

START_TEST(integrators_without_memory)
{
    tvi_system *system = create_everything(ways[_i].by, true);
    const tvi_options options = options_of_way(_i);
    const integrator_arguments chosen = {system, &options}, by_default = {system, NULL};
    for (int how = FAIL_ONCE; how <= FAIL_ONWARD; how++) {
        ck_assert_int_gt(fail_each(make_integrator, &chosen, (allocation_failure)how), 0);
        ck_assert_int_gt(fail_each(make_integrator, &by_default, (allocation_failure)how), 0);
    }
    tvi_system_free(system);
}
END_TEST

/* A first step with one tangent vector, then one with more of them. */
static tvi_status make_tangents(const void *argument, bool *cleared)
{
    const integrator_arguments *given = argument;
    tvi_integrator *integrator;
    double t = 0, q[N] = {0.1, -0.2, 0.3}, p[N] = {0.1, 0.1, -0.1}, D[4 * N * N] = {42};
    tvi_status status = tvi_integrator_create(&integrator, given->system, given->options);
    if (status == TVI_OK) status = tvi_step_tangent(integrator, 0.01, &t, q, p, D, 1);
    *cleared = t == 0 && q[0] == 0.1 && D[0] == 42;
    if (status == TVI_OK) {
        const double before = D[0], then = t;
        status = tvi_step_tangent(integrator, 0.01, &t, q, p, D, 2 * N);
        *cleared = t == then && D[0] == before;
    }
    tvi_integrator_free(integrator);
    return status;
}

/* An ensemble, and a run of it; at order 16 with tangent vectors. */
static tvi_status make_ensemble(const void *argument, bool *cleared)
{
    enum { MEMBERS = 3 };
    const integrator_arguments *given = argument;
    tvi_ensemble *ensemble = (tvi_ensemble *)&(char){0};
    double t[MEMBERS] = {0}, q[N * MEMBERS], p[N * MEMBERS], D[2 * N * MEMBERS] = {42};
    tvi_status status = tvi_ensemble_create(&ensemble, given->system, given->options, MEMBERS, 2), of_member[MEMBERS];
    for (int k = 0; k < N * MEMBERS; k++) q[k] = 0.1 + 0.01 * k, p[k] = 0.1;
    const bool has_D = given->options->order == 16;
    const tvi_ensemble_plan plan = {.h = 0.01, .steps = 1, .D = has_D ? D : NULL, .columns = has_D};
    *cleared = status == TVI_OK || ensemble == NULL;
    if (status == TVI_OK) status = tvi_ensemble_run(ensemble, &plan, t, q, p, of_member);
    *cleared = *cleared && t[0] == 0 && q[0] == 0.1;
    tvi_ensemble_free(ensemble);
    return status;
}

START_TEST(ensembles_without_memory)
{
    tvi_system *system = create_everything(ways[_i].by, true);
    const tvi_options options = options_of_way(_i);
    const integrator_arguments given = {system, &options};
    ck_assert_int_ge(fail_each(make_ensemble, &given, FAIL_ONCE), 9);
    tvi_system_free(system);
}
END_TEST

typedef struct {
    integrator_arguments made;
    const tvi_event *event;
} plan_arguments;

/* A run at times with events and tangent vectors. */
static tvi_status run_by_plan(const void *argument, bool *cleared)
{
    const plan_arguments *given = argument;
    const double times[] = {0.005, 0.015};
    tvi_integrator *integrator;
    double t = 0, q[N] = {0.1, -0.2, 0.3}, p[N] = {0.1, 0.1, -0.1}, D[2 * N] = {42};
    const tvi_run_plan plan = {
        .h = 0.01, .times = times, .time_count = 2, .events = &given->event, .event_count = 1, .D = D, .columns = 1};
    tvi_status status = tvi_integrator_create(&integrator, given->made.system, given->made.options);
    if (status == TVI_OK) status = tvi_run(integrator, &plan, &t, q, p);
    *cleared = t == 0 && q[0] == 0.1 && D[0] == 42;
    tvi_integrator_free(integrator);
    return status;
}

/* Columns at once, of chaos and of the user, of which an observer's then move another parameter. */
static int move_parameter(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)which, (void)t, (void)q, (void)p;
    ((double *)ctx)[2 * 2 * N + 1] = 1;
    return 0;
}

static tvi_status move_at_once(const void *argument, bool *cleared)
{
    const integrator_arguments *given = argument;
    tvi_integrator *integrator;
    double t = 0, q[N] = {0.1, -0.2, 0.3}, p[N] = {0.1, 0.1, -0.1}, D[2 * (2 * N + 1)] = {42};
    const tvi_run_plan plan = {
        .h = 0.01, .steps = 2, .D = D, .columns = 2, .columns_at_once = true, .at_step = move_parameter, .ctx = D};
    tvi_status status = tvi_integrator_create(&integrator, given->system, given->options);
    if (status == TVI_OK)
        status = tvi_run_chaos(integrator, &(tvi_run_plan){.h = 1e-3, .steps = 1}, &(tvi_chaos){0}, &t, q, p);
    if (status == TVI_OK) status = tvi_run(integrator, &plan, &t, q, p);
    *cleared = t < 0.02 && (t > 0.01 || ((t > 0 || q[0] == 0.1) && D[0] == 42));
    tvi_integrator_free(integrator);
    return status;
}

static jet stretched(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(jet_parameter(q[0], 0, 1.5), jet_dot(q, q, N));
}

START_TEST(columns_without_memory)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, N, NULL, stretched, NULL), TVI_OK);
    const integrator_arguments given = {system, NULL};
    for (int how = FAIL_ONCE; how <= FAIL_ONWARD; how++)
        ck_assert_int_gt(fail_each(move_at_once, &given, (allocation_failure)how), 60);
    tvi_system_free(system);
}
END_TEST

START_TEST(plans_without_memory)
{
    tvi_event *event;
    tvi_system *system = create_everything(ways[_i].by, true);
    const tvi_options options = options_of_way(_i);
    ck_assert_int_eq(tvi_event_create(&event, N, TVI_EITHER, false, radius, NULL), TVI_OK);
    const plan_arguments given = {{system, &options}, event};
    ck_assert_int_gt(fail_each(run_by_plan, &given, FAIL_ONCE), 60);
    tvi_event_free(event);
    tvi_system_free(system);
}
END_TEST

START_TEST(tangents_without_memory)
{
    tvi_system *system = create_everything(ways[_i].by, true);
    const tvi_options options = options_of_way(_i);
    const integrator_arguments chosen = {system, &options};
    for (int how = FAIL_ONCE; how <= FAIL_ONWARD; how++)
        ck_assert_int_gt(fail_each(make_tangents, &chosen, (allocation_failure)how), 50);
    tvi_system_free(system);
}
END_TEST

/* A system, a run with a record, times and an event, and its gradient, twice. */
static tvi_status make_gradient(const void *argument, bool *cleared)
{
    const double times[] = {0.005, 0.015}, start_q[N] = {0.1, -0.2, 0.3}, start_p[N] = {0.1, 0.1, -0.1};
    const double at_times[4 * N] = {1, 2, 3}, end[2 * N + 1] = {1};
    tvi_system *system;
    tvi_integrator *integrator = NULL;
    tvi_record *record = NULL;
    double t = 0, q[N], p[N], by_start[2 * N + 1] = {42};
    memcpy(q, start_q, sizeof q);
    memcpy(p, start_p, sizeof p);
    tvi_status status = state_everything(*(const statement *)argument, &system, &(bool){true});
    if (status == TVI_OK) status = tvi_integrator_create(&integrator, system, NULL);
    if (status == TVI_OK) status = tvi_record_create(&record, integrator, 0);
    const tvi_run_plan plan = {.h = 0.01, .times = times, .time_count = 2, .record = record};
    *cleared = true;
    if (status == TVI_OK) {
        status = tvi_run(integrator, &plan, &t, q, p);
        *cleared = t == 0 ? memcmp(q, start_q, sizeof q) == 0 : tvi_record_counts(record, NULL, NULL) >= 1;
    }
    if (status == TVI_OK) {
        status = tvi_gradient(record, &(tvi_loss){.end = end, .at_times = at_times}, by_start, NULL);
        *cleared = by_start[0] == 42;
    }
    tvi_record_free(record);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return status;
}

START_TEST(gradients_without_memory)
{
    static const statement by[] = {FORCE, LAGRANGIAN, HAMILTONIAN, RESCALED, REVERSIBLE};
    for (int how = FAIL_ONCE; how <= FAIL_ONWARD; how++)
        ck_assert_int_gt(fail_each(make_gradient, &by[_i], (allocation_failure)how), 60);
}
END_TEST

/* tvi_stats.bytes is what the integrator asked for. */
START_TEST(bytes)
{
    tvi_system *system = create_everything(ways[_i].by, true);
    const tvi_options options = options_of_way(_i);
    tvi_integrator *integrator;
    allocation_count();
    const tvi_status status = tvi_integrator_create(&integrator, system, &options);
    const allocation_counts counts = allocation_stop();
    ck_assert_int_eq(status, TVI_OK);
    ck_assert_uint_eq(tvi_integrator_stats(integrator)->bytes, counts.bytes);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

static TCase *add_case(Suite *suite, const char *name)
{
    TCase *tcase = tcase_create(name);
    suite_add_tcase(suite, tcase);
    return tcase;
}

Suite *suite_faults(void)
{
    Suite *suite = suite_create("faults");
    suite_add_tcase(suite, tcase_hooks());
    TCase *systems = add_case(suite, "systems");
    tcase_add_loop_test(systems, events_without_memory, 0, 2);
    tcase_add_loop_test(systems, systems_without_memory, 0, 2 * STATEMENTS);
    tcase_add_loop_test(systems, questions_without_memory, 0, 2 * STATEMENTS);
    tcase_add_test(systems, looks_without_memory);
    TCase *integrators = add_case(suite, "integrators");
    tcase_add_loop_test(integrators, integrators_without_memory, 0, way_count);
    tcase_add_loop_test(integrators, bytes, 0, way_count);
    TCase *tangents = add_case(suite, "tangents");
    tcase_add_loop_test(tangents, tangents_without_memory, 0, way_count);
    tcase_add_loop_test(tangents, plans_without_memory, 0, way_count);
    tcase_add_test(tangents, columns_without_memory);
    tcase_add_loop_test(tangents, ensembles_without_memory, 0, way_count);
    tcase_add_loop_test(tangents, gradients_without_memory, 0, 5);
    suite_add_tcase(suite, tcase_allocations());
    suite_add_tcase(suite, tcase_generated());
    return suite;
}
