/* stepping_sequences.c - Tests steps that follow one another: varying, backward, continued, reset, observed. */
#include "stepping.h"

#include <math.h>
#include <string.h>

/* Backward in time from the start of the problem, against the exact solution there. */
START_TEST(negative_steps_go_back)
{
    const test_problem *problem = step_problems[_i / 2];
    const tvi_options options = on_curve(_i % 2 ? TVI_AT_MIDPOINT : TVI_AT_START, 8);
    const exact_state exact = problem_exact(problem, NULL, problem->t0 - 1);
    const test_state x = run_from_start(problem, &options, -0.03125, 32, NULL);
    ck_assert_double_eq_tol(x.t, problem->t0 - 1, 1e-15);
    ck_assert_double_lt(larger(state_error(problem->scene->n, &x, &exact)), 3e-13);
}
END_TEST

/* Steps of many sizes that add up to t0 + 1. */
START_TEST(steps_may_vary)
{
    static const double step[] = {0.03125, 0.0625, 0.015625, 0.015625, -0.03125, 0.0625, 0.03125, 0.0625};
    enum { COUNT = sizeof step / sizeof *step };
    const test_problem *problem = step_problems[_i / 2];
    const tvi_options options = on_curve(_i % 2 ? TVI_AT_MIDPOINT : TVI_AT_START, 10);
    const exact_state exact = problem_exact(problem, NULL, problem->t0 + 1);
    runner run = runner_open(problem, &options);
    test_state x = problem_start(problem);
    for (int cycle = 0; cycle < 4; cycle++)
        for (int i = 0; i < COUNT; i++) runner_steps(&run, step[i], 1, &x);
    runner_close(&run);
    ck_assert_double_eq_tol(x.t, problem->t0 + 1, 1e-15);
    ck_assert_double_lt(larger(state_error(problem->scene->n, &x, &exact)), 3e-13);
}
END_TEST

static const struct {
    tvi_method method;
    tvi_expansion expansion;
    int degree;
} followers[] = {{TVI_TYPE1, TVI_AT_START, 5},
                 {TVI_TYPE1, TVI_AT_MIDPOINT, 5},
                 {TVI_TAYLOR, TVI_AT_START, 12},
                 {TVI_STORMER_VERLET, TVI_AT_START, 1}};
enum { FOLLOWERS = sizeof followers / sizeof *followers };

static runner open_follower(int i)
{
    const tvi_options options = {.method = followers[i % FOLLOWERS].method,
                                 .expansion = followers[i % FOLLOWERS].expansion,
                                 .degree = followers[i % FOLLOWERS].degree};
    return runner_open(step_problems[i / FOLLOWERS], &options);
}

/* Two halves are one run, bit for bit, whatever is between them: other memory, or a look at the energy. */
START_TEST(two_halves_are_one_run)
{
    runner one = open_follower(_i), two = open_follower(_i);
    test_state x = problem_start(one.problem), y = x, moved;
    runner_steps(&one, 0.05, 200, &x);
    runner_steps(&two, 0.05, 100, &y);
    memcpy(&moved, &y, sizeof y);
    runner_steps(&two, 0.05, 100, &moved);
    ck_assert(same_bits(&x, &moved));
    runner_close(&one);
    runner_close(&two);
}
END_TEST

/* After a reset an integrator is like a new one; without it the low-order parts carry on. */
START_TEST(reset_forgets)
{
    runner used = open_follower(_i), carried = open_follower(_i);
    test_state x = problem_start(used.problem), y, z = x;
    for (int step = 0; step < 200; step++) {
        runner fresh = open_follower(_i);
        y = x;
        runner_steps(&fresh, 0.05, 1, &y);
        runner_close(&fresh);
        tvi_integrator_reset(used.integrator);
        runner_steps(&used, 0.05, 1, &x);
        ck_assert(same_bits(&x, &y));
    }
    runner_steps(&carried, 0.05, 200, &z);
    ck_assert(!same_bits(&x, &z));
    runner_close(&used);
    runner_close(&carried);
}
END_TEST

/* Any one number of the state that is not what the last step returned. */
START_TEST(changed_state_is_forgotten)
{
    for (int which = 0; which < 3; which++) {
        runner used = open_follower(_i), fresh = open_follower(_i);
        test_state x = problem_start(used.problem), y;
        runner_steps(&used, 0.05, 50, &x);
        double *number = which == 0 ? &x.t : which == 1 ? &x.q[used.problem->scene->n - 1] : &x.p[0];
        *number = nextafter(*number, 10);
        y = x;
        runner_steps(&used, 0.05, 50, &x);
        runner_steps(&fresh, 0.05, 50, &y);
        ck_assert(same_bits(&x, &y));
        runner_close(&used);
        runner_close(&fresh);
    }
}
END_TEST

/* A step does not depend on the size of the last one, but for the low-order parts. */
START_TEST(last_step_leaves_no_trace)
{
    runner used = open_follower(_i), fresh = open_follower(_i);
    test_state x = problem_start(used.problem), y;
    runner_steps(&used, 0.075, 3, &x);
    tvi_integrator_reset(used.integrator);
    y = x;
    runner_steps(&used, 0.05, 1, &x);
    runner_steps(&fresh, 0.05, 1, &y);
    ck_assert(same_bits(&x, &y));
    runner_close(&used);
    runner_close(&fresh);
}
END_TEST

/* L = v^2/2 + 2 cos v - 2 q^2: several velocities have the same momentum. */
static jet folded(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet kinetic = jet_add(jet_mul(0.5, jet_sqr(v[0])), jet_mul(2, jet_cos(v[0])));
    return jet_sub(kinetic, jet_mul(2, jet_sqr(q[0])));
}

/* Nor does it depend on where a search for the velocity ended in another run: that of the guard's energy, too. */
START_TEST(another_run_leaves_no_trace)
{
    tvi_system *system;
    tvi_integrator *used, *fresh;
    int refused = 0;
    ck_assert_int_eq(tvi_system_lagrangian(&system, 1, folded, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&used, system, NULL), TVI_OK);
    for (int i = 0; i < 800; i++) {
        const double h = 0.4 + 0.3 * sin(2.3 * i);
        test_state x = {.q = {sin(i)}, .p = {5 * sin(1.7 * i)}}, y = x;
        ck_assert_int_eq(tvi_integrator_create(&fresh, system, NULL), TVI_OK);
        const tvi_status status = tvi_step(used, h, &x.t, x.q, x.p);
        ck_assert_int_eq(tvi_step(fresh, h, &y.t, y.q, y.p), status);
        ck_assert(same_bits(&x, &y));
        refused += status == TVI_ETOOLARGE;
        tvi_integrator_free(fresh);
    }
    ck_assert_int_gt(refused, 10);
    ck_assert_int_lt(refused, 200);
    tvi_integrator_free(used);
    tvi_system_free(system);
}
END_TEST

static int stop_at(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p;
    return step >= *(const long *)ctx;
}

START_TEST(observer_sees_every_step_and_stops)
{
    runner run = open_follower(_i), other = open_follower(_i);
    test_state x = problem_start(run.problem), y = x;
    long last = 7;
    ck_assert_int_eq(tvi_integrate(run.integrator, 0.05, 20, &x.t, x.q, x.p, stop_at, &last), TVI_ESTOPPED);
    ck_assert_int_eq(tvi_integrator_stats(run.integrator)->steps, 7);
    runner_steps(&other, 0.05, 7, &y);
    ck_assert(same_bits(&x, &y));
    runner_close(&run);
    runner_close(&other);
}
END_TEST

TCase *tcase_sequences(void)
{
    TCase *tcase = tcase_create("sequences");
    tcase_add_loop_test(tcase, negative_steps_go_back, 0, 2 * STEP_PROBLEMS);
    tcase_add_loop_test(tcase, steps_may_vary, 0, 2 * STEP_PROBLEMS);
    tcase_add_loop_test(tcase, two_halves_are_one_run, 0, FOLLOWERS * STEP_PROBLEMS);
    tcase_add_loop_test(tcase, reset_forgets, 0, FOLLOWERS * STEP_PROBLEMS);
    tcase_add_loop_test(tcase, changed_state_is_forgotten, 0, FOLLOWERS * STEP_PROBLEMS);
    tcase_add_loop_test(tcase, last_step_leaves_no_trace, 0, FOLLOWERS * STEP_PROBLEMS);
    tcase_add_test(tcase, another_run_leaves_no_trace);
    tcase_add_loop_test(tcase, observer_sees_every_step_and_stops, 0, FOLLOWERS * STEP_PROBLEMS);
    return tcase;
}
