/* test_quad.c - Tests the library's type I and Taylor steps against the same methods from their definition in quadruple
 * precision (bench/references/quad.h). gcc only. */
#include "problems/problems.h"
#include "references/quad.h"
#include "suites.h"

#include <float.h>
#include <math.h>
#include <quadmath.h>

typedef struct {
    quad t, q[N_MAX], p[N_MAX];
} quad_state;

static const test_problem *const problems[] = {&problem_pendulum, &problem_kepler, &problem_henon_heiles,
                                               &problem_chain};
enum { PROBLEMS = sizeof problems / sizeof *problems };

static quad_system *quad_problem(const test_problem *problem)
{
    const scene *s = problem->scene;
    quad_system *system = problem->force ? quad_system_force(s->n, s->mass, problem->force, NULL)
                                         : quad_system_potential(s->n, s->mass, s->potential, NULL);
    ck_assert_ptr_nonnull(system);
    return system;
}

static quad_state quad_start(const test_problem *problem)
{
    const test_state start = problem_start(problem);
    quad_state x = {.t = start.t};
    for (int i = 0; i < problem->scene->n; i++) {
        x.q[i] = start.q[i];
        x.p[i] = start.p[i];
    }
    return x;
}

static two_errors quad_error(int n, const test_state *a, const quad_state *b)
{
    two_errors error = {0, 0};
    for (int i = 0; i < n; i++) {
        error.q = fmax(error.q, (double)fabsq(a->q[i] - b->q[i]));
        error.p = fmax(error.p, (double)fabsq(a->p[i] - b->p[i]));
    }
    return error;
}

static quad_state quad_run(const test_problem *problem, const quad_method *method, double h, int steps)
{
    quad_system *system = quad_problem(problem);
    quad_state x = quad_start(problem);
    for (int step = 0; step < steps; step++) ck_assert(quad_tvi_step(system, method, h, &x.t, x.q, x.p));
    quad_system_free(system);
    return x;
}

static test_state library_run(const test_problem *problem, const tvi_options *options, double h, int steps)
{
    runner run = runner_open(problem, options);
    test_state x = problem_start(problem);
    runner_steps(&run, h, steps, &x);
    runner_close(&run);
    return x;
}

/* ---- The references themselves: two that share nothing ----------------------------------------------------------- */

START_TEST(references_agree)
{
    const test_problem *problem = problems[_i];
    const int n = problem->scene->n;
    const exact_state exact = problem_exact(problem, NULL, problem->t_end);
    quad_system *system = quad_problem(problem);
    quad_state x = quad_start(problem);
    const quad h = ((quad)problem->t_end - x.t) / 120;
    quad_taylor(system, 34, h, 120, &x.t, x.q, x.p);
    for (int i = 0; i < n; i++) {
        ck_assert_double_lt((double)fabsq(x.q[i] - exact.q[i]), 1e-16);
        ck_assert_double_lt((double)fabsq(x.p[i] - exact.p[i]), 1e-16);
    }
    quad_system_free(system);
}
END_TEST

/* ---- Two steps of every quadrature, node rule, expansion and low degree ------------------------------------------ */

static const struct {
    tvi_quadrature quadrature;
    int points;
    double b[4], c[4]; /* see quad_rule */
} rules[] = {
    {TVI_GAUSS, 1, {0}, {0}},
    {TVI_GAUSS, 3, {0}, {0}},
    {TVI_GAUSS, 6, {0}, {0}},
    {TVI_TRAPEZOID, 2, {1, 1}, {0, 1}},
    {TVI_RECTANGLE_START, 1, {1}, {0}},
    {TVI_RECTANGLE_END, 1, {1}, {1}},
    {TVI_LOBATTO, 3, {1, 4, 1}, {0, 0.5, 1}},
    {TVI_LOBATTO, 4, {1, 5, 5, 1}, {0, -1, 1, 1}},
};
enum { RULES = sizeof rules / sizeof *rules };

/* Gauss from the reference; the others with weights in proportion to b, and c = (1 -+ 1/sqrt 5)/2 inside Lobatto 4. */
static quad_method quad_rule(int rule, tvi_expansion expansion, tvi_nodes nodes, int degree)
{
    if (rules[rule].quadrature == TVI_GAUSS) return quad_method_gauss(expansion, nodes, degree, rules[rule].points);
    quad_method method = {.expansion = expansion, .nodes = nodes, .degree = degree, .points = rules[rule].points};
    quad sum = 0;
    for (int i = 0; i < method.points; i++) sum += rules[rule].b[i];
    for (int i = 0; i < method.points; i++) {
        method.b[i] = rules[rule].b[i] / sum;
        method.c[i] = rules[rule].c[i];
        if (method.points == 4 && (i == 1 || i == 2)) method.c[i] = (1 + rules[rule].c[i] / sqrtq(5)) / 2;
    }
    return method;
}

static const double small_step[] = {0.1, 0.1, 0.25, 0.05};
enum { LOW_DEGREES = 5 };

START_TEST(step_is_that_of_the_definition)
{
    static const tvi_expansion expansions[] = {TVI_AT_START, TVI_AT_MIDPOINT, TVI_AT_END};
    const int which = _i % PROBLEMS, rule = _i / PROBLEMS % RULES;
    const tvi_expansion expansion = expansions[_i / PROBLEMS / RULES % 3];
    const tvi_nodes nodes = _i / PROBLEMS / RULES / 3 ? TVI_NODES_TRUNCATED : TVI_NODES_ON_CURVE;
    for (int N = 1; N <= LOW_DEGREES; N++) {
        tvi_options options = options_type1(expansion, nodes, N);
        options.quadrature = rules[rule].quadrature;
        options.quadrature_points = rules[rule].points;
        const quad_method method = quad_rule(rule, expansion, nodes, N);
        const quad_state exact = quad_run(problems[which], &method, small_step[which], 2);
        const test_state x = library_run(problems[which], &options, small_step[which], 2);
        const double error = larger(quad_error(problems[which]->scene->n, &x, &exact));
        ck_assert_msg(error < 2e-14, "%s, quadrature %d with %d, expansion %d, nodes %d, N = %d: %.1e",
                      problems[which]->scene->name, (int)options.quadrature, options.quadrature_points, (int)expansion,
                      (int)nodes, N, error);
    }
}
END_TEST

/* ---- High degrees: the error at two steps is the method's own ---------------------------------------------------- */

/* Numbers of steps over a time t: both have errors well above roundoff. */
static const struct {
    const test_problem *problem;
    int degree;
    double t;
    int start[2], midpoint[2];
} high[] = {
    {&problem_pendulum, 8, 1.5, {5, 7}, {4, 6}},   {&problem_pendulum, 10, 1.5, {5, 7}, {3, 5}},
    {&problem_pendulum, 15, 1.5, {4, 6}, {2, 3}},  {&problem_kepler, 8, 2.5, {8, 12}, {5, 8}},
    {&problem_kepler, 10, 2.5, {8, 11}, {5, 8}},   {&problem_kepler, 15, 2.5, {8, 10}, {4, 6}},
    {&problem_henon_heiles, 8, 6, {5, 8}, {3, 5}}, {&problem_henon_heiles, 10, 6, {4, 7}, {3, 4}},
    {&problem_chain, 8, 1.25, {6, 9}, {4, 6}},     {&problem_chain, 15, 1.25, {5, 6}, {2, 3}},
};
enum { HIGH = sizeof high / sizeof *high };

static void check_error(const char *of, double error, double expected)
{
    ck_assert_msg(expected > 1e-14 && error < 1.5 * expected && error > expected / 1.5, "%s: error %.2e, not %.2e", of,
                  error, expected);
}

static void compare_with_definition(const test_problem *problem, const tvi_options *options, const quad_method *method,
                                    double t, int steps)
{
    const int n = problem->scene->n;
    const exact_state exact = problem_exact(problem, NULL, problem->t0 + t);
    const quad_state definition = quad_run(problem, method, t / steps, steps);
    const test_state x = library_run(problem, options, t / steps, steps);
    test_state rounded = {0};
    for (int i = 0; i < n; i++) {
        rounded.q[i] = (double)definition.q[i];
        rounded.p[i] = (double)definition.p[i];
    }
    const two_errors error = state_error(n, &x, &exact), expected = state_error(n, &rounded, &exact);
    check_error("q", error.q, expected.q);
    check_error("p", error.p, expected.p);
    const two_errors difference = quad_error(n, &x, &definition);
    ck_assert_double_lt(larger(difference), 2e-14);
}

START_TEST(error_is_that_of_the_definition)
{
    const int row = _i % HIGH, N = high[row].degree;
    const bool midpoint = _i / HIGH % 2;
    const tvi_expansion expansion = midpoint ? TVI_AT_MIDPOINT : TVI_AT_START;
    const tvi_nodes nodes = _i / HIGH / 2 ? TVI_NODES_TRUNCATED : TVI_NODES_ON_CURVE;
    tvi_options options = options_type1(expansion, nodes, N);
    options.quadrature = TVI_GAUSS;
    options.quadrature_points = N + 1;
    const quad_method method = quad_method_gauss(expansion, nodes, N, N + 1);
    for (int k = 0; k < (nodes == TVI_NODES_TRUNCATED ? 1 : 2); k++)
        compare_with_definition(high[row].problem, &options, &method, high[row].t,
                                midpoint ? high[row].midpoint[k] : high[row].start[k]);
}
END_TEST

/* ---- Every function, in a Taylor step of degree 12 --------------------------------------------------------------- */

enum { FUNCTIONS = JET_FUNCTION_COUNT + JET_FUNCTION2_COUNT };

/* Function number *ctx of 0.5 + q / 5, for acosh of 1.5 + q / 5, and of 1 + t. */
static void one_function(const jet q[], jet t, jet F[], void *ctx)
{
    const int which = *(const int *)ctx;
    const jet x = jet_add(which == JET_ACOSH ? 1.5 : 0.5, jet_div(q[0], 5));
    F[0] = which < JET_FUNCTION_COUNT
               ? jet_record_function((jet_function)which, x)
               : jet_record_function2((jet_function2)(which - JET_FUNCTION_COUNT), x, jet_add(1, t));
}

START_TEST(functions_agree)
{
    int which = _i;
    const double h = 0.5;
    double t = 0.125, q = 0.25, p = 0.75;
    quad at = t, Q = q, P = p;
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_options options;
    ck_assert_int_eq(tvi_system_force(&system, 1, NULL, one_function, &which), TVI_OK);
    ck_assert_int_eq(tvi_options_named("taylor", 11, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_step(integrator, h, &t, &q, &p), TVI_OK);
    quad_system *exact = quad_system_force(1, NULL, one_function, &which);
    ck_assert_ptr_nonnull(exact);
    quad_taylor(exact, tvi_integrator_options(integrator)->degree, h, 1, &at, &Q, &P);
    ck_assert_double_lt((double)fabsq(q - Q), 1e-15);
    ck_assert_double_lt((double)fabsq(p - P), 1e-15);
    quad_system_free(exact);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

static void add_case(Suite *suite, const char *name, const TTest *test, int count)
{
    TCase *tcase = tcase_create(name);
    tcase_add_loop_test(tcase, test, 0, count);
    suite_add_tcase(suite, tcase);
}

Suite *suite_quad(void)
{
    Suite *suite = suite_create("quad");
    add_case(suite, "functions", functions_agree, FUNCTIONS);
    add_case(suite, "references", references_agree, PROBLEMS);
    add_case(suite, "definition", step_is_that_of_the_definition, 6 * PROBLEMS * RULES);
    add_case(suite, "high degrees", error_is_that_of_the_definition, 4 * HIGH);
    return suite;
}
