/* test_values.c - Tests that a run with values that were set is that of a system with these numbers. */
#include "parameters.h"
#include "problems/texts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 40 };
static const double ROUNDOFF = 4e-14;

/* One form by one method: with the values set, and the same numbers recorded. */
static void check_values(const form *as, const method *by)
{
    tvi_system *open = system_of(as, NULL), *closed = system_of(as, other);
    tvi_integrator *it = integrator_of(open, by), *by_numbers = integrator_of(closed, by);
    if (it) {
        const state before = run(it, STEPS), expected = run(by_numbers, STEPS);
        const long passes = tvi_integrator_stats(it)->passes;
        ck_assert_int_eq(tvi_integrator_set_parameters(it, other), TVI_OK);
        const state x = run(it, STEPS);
        ck_assert_double_le(distance(&x, &expected), ROUNDOFF);
        ck_assert_double_ge(distance(&x, &before), 1e-2);
        ck_assert_int_eq(tvi_integrator_set_parameters(it, recorded), TVI_OK);
        const long so_far = tvi_integrator_stats(it)->passes;
        const state again = run(it, STEPS);
        ck_assert(memcmp(&again, &before, sizeof again) == 0);
        ck_assert_int_eq(tvi_integrator_stats(it)->passes - so_far, passes);
    }
    tvi_integrator_free(it);
    tvi_integrator_free(by_numbers);
    tvi_system_free(open);
    tvi_system_free(closed);
}

START_TEST(values_are_numbers) { check_values(&forms[_i / METHODS], &methods[_i % METHODS]); }
END_TEST

/* Integrators of one system have values of their own; so have their energies. */
START_TEST(integrators_do_not_share)
{
    tvi_system *open = system_of(&forms[_i], NULL), *closed = system_of(&forms[_i], other);
    tvi_integrator *first = integrator_of(open, &methods[0]), *second = integrator_of(open, &methods[0]);
    const state alone = run(second, STEPS);
    tvi_integrator_reset(second);
    ck_assert_int_eq(tvi_integrator_set_parameters(first, other), TVI_OK);
    const state beside = run(second, STEPS);
    ck_assert(memcmp(&alone, &beside, sizeof alone) == 0);
    double of_first, of_second, expected, as_recorded;
    const state *x = &start;
    ck_assert_int_eq(tvi_integrator_energy(first, x->t, x->q, x->p, &of_first), TVI_OK);
    ck_assert_int_eq(tvi_integrator_energy(second, x->t, x->q, x->p, &of_second), TVI_OK);
    ck_assert_int_eq(tvi_energy(closed, x->t, x->q, x->p, &expected), TVI_OK);
    ck_assert_int_eq(tvi_energy(open, x->t, x->q, x->p, &as_recorded), TVI_OK);
    ck_assert_double_eq_tol(of_first, expected, 1e-15);
    ck_assert_double_eq(of_second, as_recorded);
    ck_assert_double_ge(fabs(of_first - of_second), 0.1);
    tvi_integrator_free(first);
    tvi_integrator_free(second);
    tvi_system_free(open);
    tvi_system_free(closed);
}
END_TEST

/* A saved state has them: another integrator of the system goes on bit for bit, whatever its own were. */
START_TEST(saved_states_have_them)
{
    tvi_system *open = system_of(&forms[_i], NULL);
    tvi_integrator *one = integrator_of(open, &methods[0]), *two = integrator_of(open, &methods[0]);
    ck_assert_int_eq(tvi_integrator_set_parameters(one, other), TVI_OK);
    state x = run(one, STEPS), y = {0};
    char *text = text_of_state(one, x.t, x.q, x.p);
    ck_assert_int_eq(tvi_state_from_text(two, text, strlen(text), &y.t, y.q, y.p), TVI_OK);
    ck_assert_int_eq(tvi_integrate(one, H, STEPS, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrate(two, H, STEPS, &y.t, y.q, y.p, NULL, NULL), TVI_OK);
    ck_assert(memcmp(&x, &y, sizeof x) == 0);
    free(text);
    tvi_integrator_free(one);
    tvi_integrator_free(two);
    tvi_system_free(open);
}
END_TEST

/* ---- Events, and results at given times -------------------------------------------------------------------------- */

/* The event is where x becomes an eighth of parameter 1. */
static jet crossing(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], jet_mul(0.125, jet_parameter(q[0], 1, recorded[1])));
}

static int keep(int which, double t, const double q[], const double p[], void *ctx)
{
    (void)which, (void)p;
    double *at = ctx;
    at[0] = t, at[1] = q[0];
    return 1;
}

START_TEST(events_have_the_values_of_the_integrator)
{
    tvi_system *open = system_of(&forms[_i], NULL);
    tvi_integrator *it = integrator_of(open, &methods[0]);
    tvi_event *event;
    ck_assert_int_eq(tvi_event_create(&event, N, TVI_EITHER, true, crossing, NULL), TVI_OK);
    const double *const values[] = {recorded, other};
    for (int k = 0; k < 2; k++) {
        double at[2] = {0};
        state x = start;
        ck_assert_int_eq(tvi_integrator_set_parameters(it, values[k]), TVI_OK);
        ck_assert_int_eq(
            tvi_integrate_events(it, H, 400, (const tvi_event *const[]){event}, 1, &x.t, x.q, x.p, NULL, keep, at),
            TVI_ESTOPPED);
        ck_assert_double_eq_tol(at[1], values[k][1] / 8, 1e-13);
    }
    tvi_event_free(event);
    tvi_integrator_free(it);
    tvi_system_free(open);
}
END_TEST

/* New values, set or from text, move the event a little ahead of the state at which it has stopped the run, or behind
 * it: from there it is met where an integrator meets it that has made no step. */
START_TEST(new_values_forget_the_stop)
{
    enum { ROOM = 10000 };
    tvi_system *open = system_of(&forms[_i], NULL);
    tvi_event *event;
    ck_assert_int_eq(tvi_event_create(&event, N, TVI_EITHER, true, crossing, NULL), TVI_OK);
    const tvi_event *const events[] = {event};
    for (int k = 0; k < 4; k++) {
        tvi_integrator *it = integrator_of(open, &methods[0]), *fresh = integrator_of(open, &methods[0]);
        double at[2], values[PARAMETERS];
        char text[ROOM];
        size_t size = ROOM;
        state x = start;
        ck_assert_int_eq(tvi_integrate_events(it, H, 400, events, 1, &x.t, x.q, x.p, NULL, keep, at), TVI_ESTOPPED);
        memcpy(values, recorded, sizeof values);
        values[1] = 8 * (x.q[0] + (k % 2 ? 1e-3 : -1e-3));
        ck_assert_int_eq(tvi_integrator_set_parameters(fresh, values), TVI_OK);
        ck_assert_int_eq(tvi_state_to_text(fresh, x.t, x.q, x.p, text, &size), TVI_OK);
        ck_assert_int_eq(k < 2 ? tvi_integrator_set_parameters(it, values)
                               : tvi_state_from_text(it, text, size, &x.t, x.q, x.p),
                         TVI_OK);
        state y = x;
        ck_assert_int_eq(tvi_integrate_events(it, H, 400, events, 1, &x.t, x.q, x.p, NULL, keep, at), TVI_ESTOPPED);
        ck_assert_int_eq(tvi_integrate_events(fresh, H, 400, events, 1, &y.t, y.q, y.p, NULL, keep, at), TVI_ESTOPPED);
        ck_assert(memcmp(&x, &y, sizeof x) == 0);
        tvi_integrator_free(it);
        tvi_integrator_free(fresh);
    }
    tvi_event_free(event);
    tvi_system_free(open);
}
END_TEST

static int keep_state(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)step;
    state *x = ctx;
    x->t = t;
    memcpy(x->q, q, sizeof x->q);
    memcpy(x->p, p, sizeof x->p);
    return 0;
}

START_TEST(results_at_times_have_them)
{
    tvi_system *open = system_of(&forms[_i], NULL), *closed = system_of(&forms[_i], other);
    tvi_integrator *it = integrator_of(open, &methods[0]), *by_numbers = integrator_of(closed, &methods[0]);
    ck_assert_int_eq(tvi_integrator_set_parameters(it, other), TVI_OK);
    const double times[] = {0.33};
    state x = start, y = start, at_x, at_y;
    ck_assert_int_eq(tvi_integrate_at(it, H, times, 1, &x.t, x.q, x.p, keep_state, &at_x), TVI_OK);
    ck_assert_int_eq(tvi_integrate_at(by_numbers, H, times, 1, &y.t, y.q, y.p, keep_state, &at_y), TVI_OK);
    ck_assert_double_le(distance(&at_x, &at_y), ROUNDOFF);
    tvi_integrator_free(it);
    tvi_integrator_free(by_numbers);
    tvi_system_free(open);
    tvi_system_free(closed);
}
END_TEST

/* A spring, and a winch whose inertia it changes: H has its angle by what hangs from it alone. */
static jet winch(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *weight = ctx;
    const jet hangs = weight ? jet_const(*weight) : jet_parameter(q[0], 0, 0), inverse = jet_add(1, jet_div(q[0], 4));
    (void)t;
    const jet kinetic = jet_add(jet_sqr(p[0]), jet_mul(inverse, jet_sqr(p[1])));
    return jet_add(jet_div(jet_add(kinetic, jet_sqr(q[0])), 2), jet_mul(hangs, q[1]));
}

/* The angle is a quadrature where nothing hangs, and else is not. */
START_TEST(forces_that_are_recorded_as_0)
{
    static const double weights[] = {0, 0.25};
    state ends[2][2];
    tvi_system *open;
    ck_assert_int_eq(tvi_system_hamiltonian(&open, N, winch, NULL), TVI_OK);
    tvi_integrator *it = integrator_of(open, &methods[0]);
    for (int i = 0; i < 2; i++) {
        tvi_system *closed;
        ck_assert_int_eq(tvi_system_hamiltonian(&closed, N, winch, (void *)&weights[i]), TVI_OK);
        tvi_integrator *by_number = integrator_of(closed, &methods[0]), *by_taylor = integrator_of(closed, &methods[4]);
        ck_assert_int_eq(tvi_integrator_set_parameters(it, &weights[i]), TVI_OK);
        ends[i][0] = run(it, STEPS);
        ends[i][1] = run(by_number, STEPS);
        const state expected = run(by_taylor, STEPS);
        for (int k = 0; k < 2; k++) ck_assert_double_le(distance(&ends[i][k], &expected), ROUNDOFF);
        tvi_integrator_free(by_number);
        tvi_integrator_free(by_taylor);
        tvi_system_free(closed);
    }
    ck_assert_double_ge(distance(&ends[0][0], &ends[1][0]), 1e-2);
    tvi_integrator_free(it);
    tvi_system_free(open);
}
END_TEST

Suite *suite_values(void)
{
    Suite *suite = suite_create("parameters");
    TCase *tests = tcase_create("values");
    tcase_add_loop_test(tests, values_are_numbers, 0, FORMS * METHODS);
    tcase_add_loop_test(tests, integrators_do_not_share, 0, FORMS);
    tcase_add_loop_test(tests, saved_states_have_them, 0, FORMS);
    tcase_add_loop_test(tests, events_have_the_values_of_the_integrator, 0, FORMS);
    tcase_add_loop_test(tests, new_values_forget_the_stop, 0, FORMS);
    tcase_add_loop_test(tests, results_at_times_have_them, 0, FORMS);
    tcase_add_test(tests, forces_that_are_recorded_as_0);
    suite_add_tcase(suite, tests);
    return suite;
}
