/* test_starts.c - Tests the start of a run: a state near the constraints is put onto them, and others are refused. */
#include "constraints.h"
#include "problems/refusals.h"

#include <float.h>
#include <math.h>
#include <string.h>

static tvi_integrator *integrator_of(const tvi_system *system, double max_tail)
{
    tvi_integrator *it;
    tvi_options options = tvi_options_default();
    options.max_tail = max_tail;
    ck_assert_msg(tvi_integrator_create(&it, system, &options) == TVI_OK, "%s", tvi_last_error());
    return it;
}

/* What of q or of p is wrong by a part of 1e-12, as of sines and cosines in less than full precision, is put right. */
START_TEST(near_starts_are_put_right)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    tvi_integrator *it = integrator_of(system, 0);
    state x = start_of(of, system), start;
    double value[MOST_M], rate[MOST_M], far = 0;
    for (int i = 0; i < of->n; i++) {
        x.q[i] *= 1 + 1e-10 * (i + 1);
        x.p[i] *= 1 - 1e-10 * (i + 1);
    }
    ck_assert_int_eq(tvi_constraint_values(system, x.t, x.q, x.p, value, rate), TVI_OK);
    for (int k = 0; k < of->m; k++) far = fmax(far, fmax(fabs(value[k]), fabs(rate[k])));
    ck_assert_double_gt(far, 1e-11);
    const state given = x;
    ck_assert_msg(tvi_step(it, 1e-3, &x.t, x.q, x.p) == TVI_OK, "%s: %s", of->name, tvi_last_error());
    ck_assert_int_eq(tvi_dense(it, 0, start.q, start.p), TVI_OK);
    ck_assert_int_eq(tvi_constraint_values(system, given.t, start.q, start.p, value, rate), TVI_OK);
    for (int k = 0; k < of->m; k++) {
        ck_assert_double_le(fabs(value[k]), 16 * DBL_EPSILON);
        ck_assert_double_le(fabs(rate[k]), 32 * DBL_EPSILON);
    }
    for (int i = 0; i < of->n; i++) ck_assert_double_le(fabs(start.q[i] - given.q[i]), 1e-8);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* What is wrong by a thousandth is refused, in q and in p, and the state stays. A run that goes on is not asked. */
START_TEST(far_starts_are_refused)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    tvi_integrator *it = integrator_of(system, 0);
    const state on = start_of(of, system);
    for (int in_p = 0; in_p <= 1; in_p++) {
        state x = on;
        for (int i = 0; i < of->n; i++) (in_p ? x.p : x.q)[i] *= 1 + 1e-3 * (i + 1);
        const state given = x;
        expect_refusal(of->name, tvi_step(it, 1e-3, &x.t, x.q, x.p), TVI_EINVAL, in_p ? "]/dt = " : "phi[");
        ck_assert_ptr_nonnull(strstr(tvi_last_error(), "tvi_project"));
        ck_assert(memcmp(&x, &given, sizeof x) == 0);
    }
    state x = on;
    ck_assert_int_eq(tvi_step(it, 1e-3, &x.t, x.q, x.p), TVI_OK);
    ck_assert_int_eq(tvi_step(it, 1e-3, &x.t, x.q, x.p), TVI_OK);
    const state last = x;
    for (int i = 0; i < of->n; i++) x.q[i] *= 1 + 1e-3 * (i + 1);
    expect_refusal(of->name, tvi_step(it, 1e-3, &x.t, x.q, x.p), TVI_EINVAL, "phi[");
    x = last; /* the run goes on, as a refused start leaves the integrator as it was */
    state other = last;
    double t = x.t, q[MOST_N], p[MOST_N];
    ck_assert_int_eq(tvi_state_last(it, &t, q, p), TVI_OK);
    ck_assert(t == other.t && memcmp(q, other.q, (size_t)of->n * sizeof *q) == 0);
    ck_assert_int_eq(tvi_step(it, 1e-3, &x.t, x.q, x.p), TVI_OK);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* The text names the constraint that is farthest away, as measured by the masses, whatever its unit: here both rods are
 * too long by a thousandth, phi[1] = 0.00225 is the larger number, and phi[0] has the heavier body. */
START_TEST(texts_name_the_constraint)
{
    tvi_system *system = system_of(&problems[DOUBLE_PENDULUM]);
    tvi_integrator *it = integrator_of(system, 0);
    for (int k = 0; k < 2; k++) {
        state x = start_of(&problems[DOUBLE_PENDULUM], system);
        for (int i = 0; i < 2; i++) {
            const double first = k == 0 ? x.q[i] * 1e-3 / ROD[0] : 0, second = (x.q[i + 2] - x.q[i]) * 1e-3 / ROD[1];
            x.q[i] += first;
            x.q[i + 2] += first + second;
        }
        refused(k == 0 ? "phi[0] = 0.00125" : "phi[1] = 0.00225", tvi_step(it, 1e-3, &x.t, x.q, x.p), TVI_EINVAL);
    }
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* A first step that fails leaves the state as it was given, not as it was put right. */
START_TEST(failed_steps_leave_the_start)
{
    tvi_system *system = system_of(&problems[BENT]);
    tvi_integrator *it = integrator_of(system, 1e-300);
    state x = start_of(&problems[BENT], system);
    x.q[0] *= 1 + 1e-12;
    const state given = x;
    expect("a step that is too large", tvi_step(it, 0.1, &x.t, x.q, x.p), TVI_ETOOLARGE);
    ck_assert(memcmp(&x, &given, sizeof x) == 0);
    expect("a run of them", tvi_integrate(it, 0.1, 3, &x.t, x.q, x.p, NULL, NULL), TVI_ETOOLARGE);
    ck_assert(memcmp(&x, &given, sizeof x) == 0);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* Saved states: a start is read as it was written, and one that is off the constraints is refused. */
START_TEST(saved_starts)
{
    tvi_system *system = system_of(&problems[PENDULUM]), *base = base_of(&problems[PENDULUM]);
    tvi_integrator *it = integrator_of(system, 0), *plain = integrator_of(base, 0);
    static char text[1 << 15];
    size_t size = sizeof text;
    state x = start_of(&problems[PENDULUM], system), read = {0};
    x.q[0] *= 1 + 1e-12;
    ck_assert_int_eq(tvi_state_to_text(it, x.t, x.q, x.p, text, &size), TVI_OK);
    ck_assert_int_eq(tvi_state_from_text(it, text, size, &read.t, read.q, read.p), TVI_OK);
    ck_assert(read.t == x.t && memcmp(read.q, x.q, 2 * sizeof(double)) == 0 &&
              memcmp(read.p, x.p, 2 * sizeof(double)) == 0);
    /* Of the system without constraints, whose state leaves them. */
    for (int k = 0; k < 100; k++) ck_assert_int_eq(tvi_step(plain, 0.01, &x.t, x.q, x.p), TVI_OK);
    size = sizeof text;
    ck_assert_int_eq(tvi_state_to_text(plain, x.t, x.q, x.p, text, &size), TVI_OK);
    const state kept = read;
    refused("phi[0] = ", tvi_state_from_text(it, text, size, &read.t, read.q, read.p), TVI_EINVAL);
    ck_assert(memcmp(&read, &kept, sizeof read) == 0);
    tvi_integrator_free(plain);
    tvi_integrator_free(it);
    tvi_system_free(base);
    tvi_system_free(system);
}
END_TEST

/* A state at rest, on the constraints to the bit, is left as it is. */
START_TEST(rest)
{
    tvi_system *system = system_of(&problems[PENDULUM]);
    tvi_integrator *it = integrator_of(system, 0);
    state x = {.q = {ROD[0], 0}}, start;
    ck_assert_int_eq(tvi_step(it, 1e-3, &x.t, x.q, x.p), TVI_OK);
    ck_assert_int_eq(tvi_dense(it, 0, start.q, start.p), TVI_OK);
    ck_assert(start.q[0] == ROD[0] && start.q[1] == 0 && start.p[0] == 0 && start.p[1] == 0);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

Suite *suite_starts(void)
{
    Suite *suite = suite_create("starts");
    TCase *tests = tcase_create("starts");
    tcase_add_loop_test(tests, near_starts_are_put_right, 0, problem_count);
    tcase_add_loop_test(tests, far_starts_are_refused, 0, problem_count);
    tcase_add_test(tests, texts_name_the_constraint);
    tcase_add_test(tests, failed_steps_leave_the_start);
    tcase_add_test(tests, saved_starts);
    tcase_add_test(tests, rest);
    suite_add_tcase(suite, tests);
    return suite;
}
