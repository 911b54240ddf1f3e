/* test_stepping.c - Tests the corrector's passes and options (docs/method.md section 5), and large steps. Steps that
 * follow one another are in stepping_sequences.c. */
#include "stepping.h"
#include "suites.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const test_problem *const step_problems[STEP_PROBLEMS] = {&problem_pendulum, &problem_kepler, &problem_henon_heiles,
                                                          &problem_chain};

bool same_bits(const test_state *a, const test_state *b) { return memcmp(a, b, sizeof *a) == 0; }

tvi_options on_curve(tvi_expansion expansion, int degree)
{
    return options_type1(expansion, TVI_NODES_ON_CURVE, degree);
}

test_state run_from_start(const test_problem *problem, const tvi_options *options, double h, long steps,
                          tvi_stats *stats)
{
    runner run = runner_open(problem, options);
    test_state x = problem_start(problem);
    runner_steps(&run, h, steps, &x);
    if (stats) *stats = *tvi_integrator_stats(run.integrator);
    runner_close(&run);
    return x;
}

/* ---- Passes ------------------------------------------------------------------------------------------------------ */

static const struct {
    const test_problem *problem;
    double h, t_end, most; /* passes a step: half as many again as they take */
} pass_rows[] = {{&problem_kepler, 0.125, 250, 3.4}, {&problem_fpu, 0.03, 30, 6.3}, {&problem_pendulum, 0.5, 20, 10.6}};

START_TEST(few_passes_converge)
{
    const tvi_options options = on_curve(TVI_AT_MIDPOINT, 6);
    const long steps = lround(pass_rows[_i].t_end / pass_rows[_i].h);
    tvi_stats stats;
    (void)run_from_start(pass_rows[_i].problem, &options, pass_rows[_i].h, steps, &stats);
    const double passes = (double)stats.passes / (double)steps;
    printf("%s, midpoint, N = 6, h = %g: %.2f passes a step\n", pass_rows[_i].problem->scene->name, pass_rows[_i].h,
           passes);
    ck_assert_double_le(passes, pass_rows[_i].most);
    ck_assert_double_ge(passes, 1);
}
END_TEST

/* Start: a pass has one expansion; midpoint: the predictor has one more. A pass has one force value at each node.
 * Factors are made once a step at least and once a pass at most: of the equations for the corrections, and at the
 * midpoint of the corrector's own. */
START_TEST(work_is_counted)
{
    const bool midpoint = _i % 2;
    const tvi_options options = on_curve(midpoint ? TVI_AT_MIDPOINT : TVI_AT_START, 4);
    runner run = runner_open(&problem_chain, &options);
    const tvi_stats *stats = tvi_integrator_stats(run.integrator);
    ck_assert_int_eq(
        stats->steps + stats->passes + stats->expansions + stats->force_evaluations + stats->factorisations, 0);
    ck_assert_uint_gt(stats->bytes, 3 * 5 * 6 * sizeof(double)); /* dC/dz at least */
    test_state x = problem_start(&problem_chain);
    runner_steps(&run, 0.05, 20, &x);
    ck_assert_int_eq(stats->steps, 20);
    ck_assert_int_eq(stats->expansions, stats->passes + (midpoint ? 20 : 0));
    ck_assert_int_eq(stats->force_evaluations,
                     stats->passes * tvi_integrator_options(run.integrator)->quadrature_points);
    ck_assert_int_le(stats->factorisations, stats->passes * (midpoint ? 2 : 1));
    ck_assert_int_ge(stats->factorisations, stats->steps * (midpoint ? 2 : 1));
    ck_assert_double_lt(stats->residual, 1e-7);
    runner_close(&run);
}
END_TEST

/* passes = k makes exactly k, and each brings the step nearer to the converged one. */
START_TEST(number_of_passes_is_kept)
{
    const test_problem *problem = step_problems[_i / 2];
    tvi_options options = on_curve(_i % 2 ? TVI_AT_MIDPOINT : TVI_AT_START, 3);
    const test_state converged = run_from_start(problem, &options, 0.05, 10, NULL);
    double before = HUGE_VAL;
    for (int k = 1; k <= 4; k++) {
        tvi_stats stats;
        options.passes = k;
        const test_state x = run_from_start(problem, &options, 0.05, 10, &stats);
        ck_assert_int_eq(stats.passes, 10 * k);
        const double distance = larger(state_difference(problem->scene->n, &x, &converged));
        ck_assert_double_lt(distance, fmax(before / 2, 1e-14));
        before = distance;
    }
    ck_assert_double_lt(before, 1e-12);
}
END_TEST

START_TEST(tolerance_ends_the_passes)
{
    tvi_options options = on_curve(_i % 2 ? TVI_AT_MIDPOINT : TVI_AT_START, 2);
    const test_problem *problem = step_problems[_i / 2];
    tvi_stats stats;
    const test_state converged = run_from_start(problem, &options, 0.1, 1, &stats);
    const long passes = stats.passes;
    double before = HUGE_VAL;
    for (double tolerance = 1e-2; tolerance > 1e-9; tolerance /= 100) {
        options.tolerance = tolerance;
        const test_state x = run_from_start(problem, &options, 0.1, 1, &stats);
        const double distance = larger(state_difference(problem->scene->n, &x, &converged));
        ck_assert_double_le(stats.residual, tolerance);
        ck_assert_int_le(stats.passes, passes);
        ck_assert_double_le(distance, fmin(before, tolerance));
        before = distance;
    }
    options.tolerance = 1e-2;
    (void)run_from_start(problem, &options, 0.1, 1, &stats);
    ck_assert_int_lt(stats.passes, passes);
    ck_assert_double_gt(stats.residual, 1e-9);
}
END_TEST

/* Without a pass the start-expanded method is the Taylor method. */
START_TEST(no_pass_is_taylor)
{
    const test_problem *problem = step_problems[_i];
    for (int N = 2; N <= 9; N++) {
        tvi_options options = on_curve(TVI_AT_START, N), midpoint = on_curve(TVI_AT_MIDPOINT, N),
                    taylor = options_taylor(N);
        options.passes = midpoint.passes = TVI_PREDICT_ONLY;
        tvi_stats stats;
        const test_state x = run_from_start(problem, &options, 0.05, 20, &stats);
        ck_assert_int_eq(stats.passes, 0);
        ck_assert_double_eq(stats.residual, 0);
        const test_state y = run_from_start(problem, &taylor, 0.05, 20, &stats);
        ck_assert(same_bits(&x, &y));
        ck_assert_int_eq(stats.expansions, 20);
        const test_state z = run_from_start(problem, &midpoint, 0.05, 20, &stats);
        ck_assert_int_eq(stats.expansions, 40);
        ck_assert(!same_bits(&x, &z));
    }
}
END_TEST

/* One pass cannot do, and a bound that suffices changes nothing. */
START_TEST(bound_on_passes_is_honoured)
{
    tvi_options options = on_curve(_i % 2 ? TVI_AT_MIDPOINT : TVI_AT_START, 2);
    tvi_stats stats;
    const test_state converged = run_from_start(&problem_chain, &options, 0.05, 1, &stats);
    for (int most = 1; most < stats.passes; most++) {
        options.max_passes = most;
        runner run = runner_open(&problem_chain, &options);
        const test_state start = problem_start(&problem_chain);
        test_state x = start;
        ck_assert_int_eq(tvi_step(run.integrator, 0.05, &x.t, x.q, x.p), TVI_ENOCONV);
        ck_assert(same_bits(&x, &start));
        ck_assert_int_eq(tvi_integrator_stats(run.integrator)->passes, most);
        ck_assert_int_eq(tvi_integrator_stats(run.integrator)->steps, 0);
        runner_close(&run);
    }
    options.max_passes = (int)stats.passes;
    const test_state bounded = run_from_start(&problem_chain, &options, 0.05, 1, NULL);
    ck_assert(same_bits(&bounded, &converged));
}
END_TEST

/* ---- Large steps ------------------------------------------------------------------------------------------------- */

typedef struct {
    const test_problem *problem;
    tvi_expansion expansion;
    int degree;
    double h;
} large_step;

/* Steps whose passes do not contract with the approximate Jacobian: a fresh one by differences solves them. */
static const large_step refreshed[] = {
    {&problem_henon_heiles, TVI_AT_START, 1, 1.6},    {&problem_henon_heiles, TVI_AT_START, 2, 1.3},
    {&problem_henon_heiles, TVI_AT_MIDPOINT, 1, 1.6}, {&problem_henon_heiles, TVI_AT_MIDPOINT, 2, 2.3},
    {&problem_chain, TVI_AT_START, 1, 0.37},          {&problem_chain, TVI_AT_MIDPOINT, 1, 0.37},
    {&problem_pendulum, TVI_AT_MIDPOINT, 3, 0.64},    {&problem_kepler, TVI_AT_MIDPOINT, 3, 1.33},
};
enum { REFRESHED = sizeof refreshed / sizeof *refreshed };

/* The solution does not depend on how it was found: passes to a tolerance, or the passes of half the way. */
START_TEST(fresh_jacobian_solves_large_steps)
{
    const large_step *row = &refreshed[_i];
    tvi_options options = on_curve(row->expansion, row->degree);
    tvi_stats stats;
    const test_state x = run_from_start(row->problem, &options, row->h, 1, &stats);
    const int n = row->problem->scene->n;
    ck_assert_int_ge(stats.expansions, stats.passes + n); /* differences were taken */
    ck_assert_int_le(stats.passes, 32);
    ck_assert_double_lt(stats.residual, 1e-13);
    /* symmetric methods lead back */
    if (row->expansion != TVI_AT_MIDPOINT) return;
    const test_state start = problem_start(row->problem);
    test_state back = x;
    runner run = runner_open(row->problem, &options);
    runner_steps(&run, -row->h, 1, &back);
    runner_close(&run);
    ck_assert_double_lt(larger(state_difference(n, &back, &start)), 1e-12);
}
END_TEST

/* Steps that diverge are refused, and never returned as a state that has flown off. */
static const large_step hopeless[] = {
    {&problem_pendulum, TVI_AT_START, 6, 1.33117},
    {&problem_pendulum, TVI_AT_START, 4, 1.5974},
    {&problem_pendulum, TVI_AT_START, 4, 1.91688},
    {&problem_chain, TVI_AT_START, 2, 2.76031},
    {&problem_chain, TVI_AT_START, 3, 3.3},
    {&problem_chain, TVI_AT_MIDPOINT, 3, 0.924421},
    {&problem_kepler, TVI_AT_START, 7, 1.91688},
    {&problem_henon_heiles, TVI_AT_START, 4, 3.97484},
    {&problem_henon_heiles, TVI_AT_START, 6, 3.31237},
};
enum { HOPELESS = sizeof hopeless / sizeof *hopeless };

START_TEST(hopeless_step_is_refused)
{
    const large_step *row = &hopeless[_i];
    const tvi_options options = on_curve(row->expansion, row->degree);
    runner run = runner_open(row->problem, &options);
    const test_state start = problem_start(row->problem);
    test_state x = start;
    const tvi_status status = tvi_step(run.integrator, row->h, &x.t, x.q, x.p);
    ck_assert_msg(status != TVI_OK, "row %d: q[0] = %g, p[0] = %g", _i, x.q[0], x.p[0]);
    ck_assert(same_bits(&x, &start));
    runner_steps(&run, row->h / 64, 1, &x); /* and the integrator goes on */
    runner_close(&run);
}
END_TEST

/* A momentum of 0 has no size to compare corrections with: the passes must converge all the same. */
START_TEST(start_at_rest_converges)
{
    const test_problem *problem = step_problems[_i / 2];
    tvi_options options = on_curve(_i % 2 ? TVI_AT_MIDPOINT : TVI_AT_START, 1), exactly = options;
    exactly.passes = 30;
    runner run = runner_open(problem, &options), other = runner_open(problem, &exactly);
    test_state x = problem_start(problem), y;
    x.p[problem->scene->n - 1] = 0;
    y = x;
    runner_steps(&run, 0.1, 1, &x);
    runner_steps(&other, 0.1, 1, &y);
    ck_assert_double_lt(larger(state_difference(problem->scene->n, &x, &y)), 1e-14);
    runner_close(&run);
    runner_close(&other);
}
END_TEST

static TCase *tcase_passes(void)
{
    TCase *tcase = tcase_create("passes");
    tcase_add_loop_test(tcase, few_passes_converge, 0, 3);
    tcase_add_loop_test(tcase, work_is_counted, 0, 2);
    tcase_add_loop_test(tcase, number_of_passes_is_kept, 0, 2 * STEP_PROBLEMS);
    tcase_add_loop_test(tcase, tolerance_ends_the_passes, 0, 2 * STEP_PROBLEMS);
    tcase_add_loop_test(tcase, no_pass_is_taylor, 0, STEP_PROBLEMS);
    tcase_add_loop_test(tcase, bound_on_passes_is_honoured, 0, 2);
    tcase_add_loop_test(tcase, fresh_jacobian_solves_large_steps, 0, REFRESHED);
    tcase_add_loop_test(tcase, hopeless_step_is_refused, 0, HOPELESS);
    tcase_add_loop_test(tcase, start_at_rest_converges, 0, 2 * STEP_PROBLEMS);
    return tcase;
}

Suite *suite_stepping(void)
{
    Suite *suite = suite_create("stepping");
    suite_add_tcase(suite, tcase_passes());
    suite_add_tcase(suite, tcase_sequences());
    return suite;
}
