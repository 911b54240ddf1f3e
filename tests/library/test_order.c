/* test_order.c - the orders of convergence, in q and in p, and the size of the errors (docs/method.md sections 3 and
 * 4). */
#include "problems/problems.h"
#include "suites.h"

#include <math.h>
#include <stdio.h>

static const test_problem *const order_problems[] = {&problem_pendulum, &problem_kepler, &problem_henon_heiles,
                                                     &problem_chain};
enum { ORDER_PROBLEMS = sizeof order_problems / sizeof *order_problems };

/* ---- The slope of the error -------------------------------------------------------------------------------------- */

/* Runs of ever more steps until the error of q or p would be less than 50 times roundoff: the slopes between the last
 * and the last but two, where the method is furthest into its asymptotic range. An error is the larger of two times, so
 * that none is small by chance. */
enum { TIMES = 2, STEPS_FIRST = 8, STEPS_MOST = 2000 };
static const double STEP_RATIO = 1.2, ROUNDOFFS = 50;

typedef struct {
    const test_problem *problem;
    exact_state at[TIMES];
    two_errors roundoff;
} reference;

static reference reference_of(const test_problem *problem)
{
    reference exact = {.problem = problem, .roundoff = problem_roundoff(problem)};
    for (int k = 0; k < TIMES; k++)
        exact.at[k] = problem_exact(problem, NULL, problem->t0 + (problem->t_end - problem->t0) * (k + 1) / TIMES);
    return exact;
}

/* The errors of a run of TIMES * steps steps. false: the step is too large for the corrector. */
static bool run_if_possible(const reference *exact, const tvi_options *options, long steps, two_errors *errors)
{
    const test_problem *problem = exact->problem;
    const double h = (problem->t_end - problem->t0) / (double)(TIMES * steps);
    runner run = runner_open(problem, options);
    test_state x = problem_start(problem);
    tvi_status status = TVI_OK;
    *errors = (two_errors){0, 0};
    for (int k = 0; k < TIMES && status == TVI_OK; k++) {
        status = tvi_integrate(run.integrator, h, steps, &x.t, x.q, x.p, NULL, NULL);
        const two_errors now = state_error(problem->scene->n, &x, &exact->at[k]);
        *errors = (two_errors){fmax(errors->q, now.q), fmax(errors->p, now.p)};
    }
    runner_close(&run);
    return status == TVI_OK;
}

typedef struct {
    double coarse, fine; /* errors of the two runs */
    double slope;
} slope;

typedef struct {
    long steps; /* of the finer run */
    slope q, p;
} order_fit;

static slope slope_between(double coarse, double fine, long steps_coarse, long steps_fine)
{
    return (slope){coarse, fine, log(coarse / fine) / log((double)steps_fine / (double)steps_coarse)};
}

static order_fit fit_order(const test_problem *problem, const tvi_options *options)
{
    const reference exact = reference_of(problem);
    two_errors before[2] = {{0, 0}, {0, 0}}; /* of the last run and the one before it */
    long steps_before[2] = {0, 0};
    order_fit fit = {0};
    for (double count = STEPS_FIRST; count < STEPS_MOST; count *= STEP_RATIO) {
        const long steps = lround(count / TIMES);
        two_errors error;
        if (!run_if_possible(&exact, options, steps, &error)) continue;
        if (error.q < ROUNDOFFS * exact.roundoff.q || error.p < ROUNDOFFS * exact.roundoff.p) break;
        if (steps_before[1] > 0 && steps_before[1] < steps)
            fit = (order_fit){TIMES * steps, slope_between(before[1].q, error.q, steps_before[1], steps),
                              slope_between(before[1].p, error.p, steps_before[1], steps)};
        before[1] = before[0], before[0] = error;
        steps_before[1] = steps_before[0], steps_before[0] = steps;
    }
    return fit;
}

static void check_slope(const char *what, const char *of, long steps, slope s, double least, double most)
{
    ck_assert_msg(steps > 0 && s.coarse < 3e-2 && s.slope > least && s.slope < most,
                  "%s, %s: order %.2f (errors %.1e, %.1e at %ld steps), not %.1f to %.1f", what, of, s.slope, s.coarse,
                  s.fine, steps, least, most);
}

/* q and p both have an order from `least` to `most`, with 0.3 either way. */
static void check_order(const test_problem *problem, const tvi_options *options, int least, int most)
{
    char what[160];
    snprintf(what, sizeof what, "%s, method %d, expansion %d, nodes %d, N = %d, quadrature %d with %d",
             problem->scene->name, (int)options->method, (int)options->expansion, (int)options->nodes, options->degree,
             (int)options->quadrature, options->quadrature_points);
    const order_fit fit = fit_order(problem, options);
    check_slope(what, "q", fit.steps, fit.q, least - 0.3, most + 0.3);
    check_slope(what, "p", fit.steps, fit.p, least - 0.3, most + 0.3);
}

/* The order that the library promises. */
static void check_promise(const test_problem *problem, const tvi_options *options, int order)
{
    runner run = runner_open(problem, options);
    ck_assert_int_eq(tvi_integrator_options(run.integrator)->order, order);
    runner_close(&run);
}

/* ---- Section 3: type I, every node rule and degree --------------------------------------------------------------- */

/* On-curve 2N; truncated at the start or the end N, to N + 1 for odd N; truncated at the midpoint N, N + 1 for odd
 * N. */
static const struct {
    tvi_expansion expansion;
    tvi_nodes nodes;
    int slope, odd_least, odd_most; /* order slope N, for odd N plus odd_least to odd_most */
} order_rule[] = {
    {TVI_AT_START, TVI_NODES_ON_CURVE, 2, 0, 0},  {TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 2, 0, 0},
    {TVI_AT_START, TVI_NODES_TRUNCATED, 1, 0, 1}, {TVI_AT_MIDPOINT, TVI_NODES_TRUNCATED, 1, 1, 1},
    {TVI_AT_END, TVI_NODES_ON_CURVE, 2, 0, 0},    {TVI_AT_END, TVI_NODES_TRUNCATED, 1, 0, 1},
};
enum {
    ORDER_RULES = sizeof order_rule / sizeof *order_rule,
    DEGREES = 6,
    TYPE1_ORDERS = ORDER_PROBLEMS * ORDER_RULES * DEGREES
};

START_TEST(type1_has_its_order)
{
    const int N = _i % DEGREES + 1, rule = _i / DEGREES % ORDER_RULES, odd = N % 2;
    const test_problem *problem = order_problems[_i / DEGREES / ORDER_RULES];
    const tvi_options options = options_type1(order_rule[rule].expansion, order_rule[rule].nodes, N);
    const int order = order_rule[rule].slope * N, least = order + odd * order_rule[rule].odd_least;
    check_promise(problem, &options, least);
    check_order(problem, &options, least, order + odd * order_rule[rule].odd_most);
}
END_TEST

/* ---- Explicit methods -------------------------------------------------------------------------------------------- */

enum { TAYLOR_LEAST = 3, TAYLOR_DEGREES = 5 };

START_TEST(taylor_has_order_of_its_degree_less_one)
{
    const int N = TAYLOR_LEAST + _i % TAYLOR_DEGREES;
    const test_problem *problem = order_problems[_i / TAYLOR_DEGREES];
    const tvi_options options = options_taylor(N);
    check_promise(problem, &options, N - 1);
    check_order(problem, &options, N - 1, N - 1);
}
END_TEST

START_TEST(stormer_verlet_has_order_2)
{
    const tvi_options options = options_verlet();
    check_promise(order_problems[_i], &options, 2);
    check_order(order_problems[_i], &options, 2, 2);
}
END_TEST

/* ---- Section 3: order min(2N, s) with a quadrature of order s ---------------------------------------------------- */

static const struct {
    tvi_expansion expansion;
    int degree;
    tvi_quadrature quadrature;
    int points, order;
} quadrature_rows[] = {
    {TVI_AT_START, 3, TVI_GAUSS, 1, 2},
    {TVI_AT_START, 3, TVI_GAUSS, 2, 4},
    {TVI_AT_START, 3, TVI_GAUSS, 3, 6},
    {TVI_AT_START, 4, TVI_LOBATTO, 3, 4},
    {TVI_AT_START, 4, TVI_LOBATTO, 4, 6},
    {TVI_AT_START, 4, TVI_LOBATTO, 6, 8},
    {TVI_AT_START, 3, TVI_TRAPEZOID, 2, 2},
    {TVI_AT_START, 2, TVI_RECTANGLE_START, 1, 1},
    {TVI_AT_START, 3, TVI_RECTANGLE_END, 1, 1},
    {TVI_AT_MIDPOINT, 4, TVI_GAUSS, 2, 4},
    {TVI_AT_MIDPOINT, 4, TVI_GAUSS, 3, 6},
    {TVI_AT_MIDPOINT, 3, TVI_LOBATTO, 3, 4},
    {TVI_AT_MIDPOINT, 4, TVI_LOBATTO, 5, 8},
    {TVI_AT_MIDPOINT, 4, TVI_TRAPEZOID, 2, 2},
    {TVI_AT_MIDPOINT, 3, TVI_RECTANGLE_END, 1, 1},
};
enum { QUADRATURE_ROWS = sizeof quadrature_rows / sizeof *quadrature_rows };

START_TEST(quadrature_limits_the_order)
{
    const int row = _i % QUADRATURE_ROWS;
    const test_problem *problem = _i / QUADRATURE_ROWS ? &problem_chain : &problem_henon_heiles;
    tvi_options options =
        options_type1(quadrature_rows[row].expansion, TVI_NODES_ON_CURVE, quadrature_rows[row].degree);
    options.quadrature = quadrature_rows[row].quadrature;
    options.quadrature_points = quadrature_rows[row].points;
    check_promise(problem, &options, quadrature_rows[row].order);
    check_order(problem, &options, quadrature_rows[row].order, quadrature_rows[row].order);
}
END_TEST

/* ---- Section 3: the measured errors ------------------------------------------------------------------------------ */

enum { MEASURED_RUNS = 4 };
static const struct {
    const test_problem *problem;
    tvi_expansion expansion;
    tvi_nodes nodes;
    int degree;
    double error[MEASURED_RUNS]; /* at t_end with 8, 16, 32, 64 steps; 0 where it is below 1e-12 */
} measured_rows[] = {
    {&problem_pendulum, TVI_AT_START, TVI_NODES_TRUNCATED, 4, {3.8e-3, 1.1e-3, 8.9e-5, 5.9e-6}},
    {&problem_pendulum, TVI_AT_START, TVI_NODES_ON_CURVE, 4, {2.2e-3, 4.9e-6, 2.0e-8, 7.8e-11}},
    {&problem_pendulum, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 4, {2.1e-6, 2.0e-8, 7.8e-11, 0}},
    {&problem_kepler, TVI_AT_START, TVI_NODES_TRUNCATED, 4, {9.1e-2, 1.9e-2, 1.6e-3, 1.1e-4}},
    {&problem_kepler, TVI_AT_START, TVI_NODES_ON_CURVE, 4, {2.4e-1, 6.6e-4, 2.7e-6, 1.1e-8}},
    {&problem_kepler, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 4, {7.8e-4, 2.7e-6, 1.1e-8, 4.2e-11}},
    {&problem_kepler, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 6, {1.3e-5, 3.0e-9, 0, 0}},
};
enum { MEASURED_ROWS = sizeof measured_rows / sizeof *measured_rows };

START_TEST(errors_are_those_of_the_table)
{
    const test_problem *problem = measured_rows[_i].problem;
    tvi_options options = options_type1(measured_rows[_i].expansion, measured_rows[_i].nodes, measured_rows[_i].degree);
    options.quadrature = TVI_GAUSS;
    options.quadrature_points = options.degree + 1;
    const exact_state exact = problem_exact(problem, NULL, problem->t_end);
    for (int run = 0; run < MEASURED_RUNS; run++) {
        const double expected = measured_rows[_i].error[run];
        if (expected == 0) continue;
        const test_state end = problem_run(problem, &options, 8L << run);
        const double error = larger(state_error(problem->scene->n, &end, &exact));
        ck_assert_msg(error < 1.5 * expected && error > expected / 1.5, "row %d, %ld steps: error %.2e, not %.1e", _i,
                      8L << run, error, expected);
    }
}
END_TEST

/* ---- Section 4: the error constant of the midpoint --------------------------------------------------------------- */

/* The error at the start is larger than at the midpoint by 4^N for even N, 4^N (N/(N+1))^2 for odd N. */
START_TEST(midpoint_has_its_error_constant)
{
    static const long steps[] = {0, 0, 400, 100, 60};
    const int N = _i % 3 + 2, n = order_problems[_i / 3]->scene->n;
    const test_problem *problem = order_problems[_i / 3];
    const tvi_options start = options_type1(TVI_AT_START, TVI_NODES_ON_CURVE, N);
    const tvi_options midpoint = options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, N);
    const exact_state exact = problem_exact(problem, NULL, problem->t_end);
    const test_state a = problem_run(problem, &start, steps[N]), b = problem_run(problem, &midpoint, steps[N]);
    const two_errors at_start = state_error(n, &a, &exact), at_midpoint = state_error(n, &b, &exact);
    const double expected = pow(4, N) * (N % 2 ? pow(N / (N + 1.0), 2) : 1);
    ck_assert_double_eq_tol(at_start.q / at_midpoint.q, expected, 0.02 * expected);
    ck_assert_double_eq_tol(at_start.p / at_midpoint.p, expected, 0.02 * expected);
}
END_TEST

Suite *suite_order(void)
{
    Suite *suite = suite_create("order");
    TCase *tcase = tcase_create("order");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, type1_has_its_order, 0, TYPE1_ORDERS);
    tcase_add_loop_test(tcase, taylor_has_order_of_its_degree_less_one, 0, ORDER_PROBLEMS * TAYLOR_DEGREES);
    tcase_add_loop_test(tcase, stormer_verlet_has_order_2, 0, ORDER_PROBLEMS);
    tcase_add_loop_test(tcase, quadrature_limits_the_order, 0, 2 * QUADRATURE_ROWS);
    tcase_add_loop_test(tcase, errors_are_those_of_the_table, 0, MEASURED_ROWS);
    tcase_add_loop_test(tcase, midpoint_has_its_error_constant, 0, 3 * ORDER_PROBLEMS);
    suite_add_tcase(suite, tcase);
    return suite;
}
