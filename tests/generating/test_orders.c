/* test_orders.c - Tests the orders of convergence, in q and in p, and the size of the errors (docs/method.md sections 3
 * and 4). */
#include "generating.h"
#include "models.h"

#include <math.h>

static model_path paths[MODELS_OF_ORDERS]; /* made once, before the tests */

static void find_paths(void)
{
    for (int i = 0; i < MODELS_OF_ORDERS; i++) paths[i] = model_solution(models[i]);
}

/* ---- The slope of the error -------------------------------------------------------------------------------------- */

/* Runs of ever more steps, until the slopes of q and of p have both settled (changed by less than `settled`, twice), or
 * an error is near roundoff: vector functions are right to a unit, and the slope of an error of 50 units is not. */
enum { STEPS_FIRST = 1, STEPS_MOST = 1500, TIMES_SETTLED = 2 };
static const double STEP_RATIO = 1.35, LARGEST = 3e-2, ROUNDOFFS = 100;

typedef struct {
    long steps; /* of the last run that counts; 0: there is none */
    two_errors error, slope;
} order_fit;

/* The largest error at the ends of the parts, `steps` steps each; false: the step is too large for the corrector. */
static bool error_after(int which, tvi_integrator *integrator, long steps, two_errors *error)
{
    const model *m = models[which];
    test_state x = model_start(m);
    tvi_integrator_reset(integrator);
    const double h = (m->t_end - m->t0) / PARTS / (double)steps;
    *error = (two_errors){0, 0};
    for (int part = 0; part < PARTS; part++) {
        if (tvi_integrate(integrator, h, steps, &x.t, x.q, x.p, NULL, NULL) != TVI_OK) return false;
        const two_errors now = state_difference(m->n, &x, &paths[which].at[part]);
        *error = (two_errors){fmax(error->q, now.q), fmax(error->p, now.p)};
    }
    return true;
}

static double change(two_errors a, two_errors b) { return fmax(fabs(a.q - b.q), fabs(a.p - b.p)); }

static order_fit fit_order(int which, const tvi_options *options, double settled)
{
    tvi_system *system = model_system(models[which]);
    tvi_integrator *integrator = integrator_of(system, options);
    const two_errors roundoff = paths[which].roundoff;
    order_fit fit = {0}, before;
    int times = 0;
    two_errors error;
    for (double count = STEPS_FIRST; count < STEPS_MOST && times < TIMES_SETTLED;
         count = fmax(count + 1, count * STEP_RATIO)) {
        const long steps = lround(count);
        if (!error_after(which, integrator, steps, &error)) {
            ck_assert_msg(fit.steps == 0, "%s, %s: no convergence in %ld steps", models[which]->name, describe(options),
                          steps);
            continue;
        }
        if (larger(error) > LARGEST) continue;
        if (error.q < ROUNDOFFS * roundoff.q || error.p < ROUNDOFFS * roundoff.p) break;
        before = fit;
        fit = (order_fit){.steps = steps, .error = error};
        if (before.steps == 0) continue;
        const double ratio = log((double)steps / (double)before.steps);
        fit.slope = (two_errors){log(before.error.q / error.q) / ratio, log(before.error.p / error.p) / ratio};
        times = change(fit.slope, before.slope) < settled ? times + 1 : 0;
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return fit;
}

static void check_order(int which, const tvi_options *options, double least, double most)
{
    const order_fit fit = fit_order(which, options, most - least < 1 ? 0.03 : 0.1);
    ck_assert_msg(fit.slope.q > least && fit.slope.q < most && fit.slope.p > least && fit.slope.p < most,
                  "%s, %s: order %.2f in q and %.2f in p (errors %.1e, %.1e after %ld steps), not %.1f to %.1f",
                  models[which]->name, describe(options), fit.slope.q, fit.slope.p, fit.error.q, fit.error.p, fit.steps,
                  least, most);
}

/* The order that the library promises. */
static void check_promise(int which, const tvi_options *options, int order)
{
    tvi_system *system = model_system(models[which]);
    tvi_integrator *integrator = integrator_of(system, options);
    ck_assert_int_eq(tvi_integrator_options(integrator)->order, order);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}

/* ---- Every method and degree ------------------------------------------------------------------------------------- */

/* On-curve 2N, Poincare 2K + 2; truncated N at the ends, at the midpoint the even number from N on, and at both ends
 * the one from r on. */
static int order_of(const kind *k, int degree)
{
    if (k->nodes == TVI_NODES_ON_CURVE) return 2 * degree + (k->method == TVI_POINCARE ? 2 : 0);
    return k->symmetric ? degree + degree % 2 : degree;
}

enum { DEGREES = 6 };

/* Truncated nodes at the start and the end: slopes between N and N + 1 for odd N. */
START_TEST(method_has_its_order)
{
    const kind *k = &kinds[_i / DEGREES % all_kinds];
    const int which = _i / DEGREES / all_kinds;
    const model *m = models[which];
    const int degree = _i % DEGREES + kind_least_degree(k), order = order_of(k, degree);
    if (!kind_serves(k, m) || (m->most_order && order > m->most_order)) return;
    if (m == &model_sheared_hamiltonian && k->method == TVI_TYPE1) return; /* as the sheared Lagrangian */
    if (degree == DEGREES && !(m->problem && k->method == TVI_TYPE1 && k->expansion <= TVI_AT_END)) return;
    if (degree == DEGREES && m == &model_pendulum && k->symmetric) return; /* at roundoff after 7 steps */
    const bool wanders = k->nodes == TVI_NODES_TRUNCATED && !k->symmetric && degree % 2 == 1;
    const tvi_options options = kind_options(k, degree);
    check_promise(which, &options, order);
    check_order(which, &options, order - 0.3, order + (wanders ? 1.3 : 0.3));
}
END_TEST

/* ---- Order min(2N, s) with a quadrature of order s, and of compositions ------------------------------------------ */

static const struct {
    kind k;
    int degree;
    tvi_quadrature quadrature;
    int points;
    bool composed;
    int order;
} rows[] = {
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 3, TVI_GAUSS, 1, false, 2},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 3, TVI_GAUSS, 2, false, 4},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 3, TVI_GAUSS, 3, false, 6},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 4, TVI_LOBATTO, 3, false, 4},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 4, TVI_LOBATTO, 6, false, 8},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 3, TVI_TRAPEZOID, 2, false, 2},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 2, TVI_RECTANGLE_START, 1, false, 1},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 3, TVI_RECTANGLE_END, 1, false, 1},
    {{TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 4, TVI_GAUSS, 2, false, 4},
    {{TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 4, TVI_GAUSS, 3, false, 6},
    {{TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 3, TVI_LOBATTO, 3, false, 4},
    {{TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 4, TVI_LOBATTO, 5, false, 8},
    {{TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 4, TVI_TRAPEZOID, 2, false, 2},
    {{TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 3, TVI_RECTANGLE_END, 1, false, 1},
    {{TVI_TYPE1, TVI_AT_END, TVI_NODES_ON_CURVE, false}, 3, TVI_GAUSS, 2, false, 4},
    {{TVI_TYPE1, TVI_AT_END, TVI_NODES_ON_CURVE, false}, 2, TVI_RECTANGLE_START, 1, false, 1},
    {{TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_ON_CURVE, true}, 3, TVI_GAUSS, 2, false, 4},
    {{TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_ON_CURVE, true}, 2, TVI_LOBATTO, 3, false, 4},
    {{TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_ON_CURVE, true}, 3, TVI_TRAPEZOID, 2, false, 2},
    {{TVI_TYPE2, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 3, TVI_GAUSS, 2, false, 4},
    {{TVI_TYPE2, TVI_AT_END, TVI_NODES_ON_CURVE, false}, 3, TVI_LOBATTO, 3, false, 4},
    {{TVI_TYPE2, TVI_AT_END, TVI_NODES_ON_CURVE, false}, 3, TVI_RECTANGLE_END, 1, false, 1},
    {{TVI_TYPE3, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 3, TVI_GAUSS, 2, false, 4},
    {{TVI_TYPE3, TVI_AT_END, TVI_NODES_ON_CURVE, false}, 3, TVI_LOBATTO, 4, false, 6},
    {{TVI_TYPE3, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 2, TVI_TRAPEZOID, 2, false, 2},
    {{TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 3, TVI_GAUSS, 2, false, 4},
    {{TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 2, TVI_TRAPEZOID, 2, false, 2},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 2, TVI_QUADRATURE_AUTO, 0, true, 4},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_TRUNCATED, false}, 3, TVI_QUADRATURE_AUTO, 0, true, 4},
    {{TVI_TYPE2, TVI_AT_START, TVI_NODES_TRUNCATED, false}, 1, TVI_TRAPEZOID, 2, true, 2},
    {{TVI_TYPE2, TVI_AT_START, TVI_NODES_TRUNCATED, false}, 3, TVI_QUADRATURE_AUTO, 0, true, 4},
    {{TVI_TYPE3, TVI_AT_END, TVI_NODES_ON_CURVE, false}, 3, TVI_QUADRATURE_AUTO, 0, true, 6},
    {{TVI_TYPE3, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 2, TVI_RECTANGLE_END, 1, true, 2},
    {{TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 4, TVI_LOBATTO, 4, false, 6},
};
/* The last row is of forces alone: roundoff ends the slope of the others. */
enum { ROWS = sizeof rows / sizeof *rows, ROW_MODELS = 4 };

START_TEST(quadrature_and_composition_have_their_orders)
{
    static const int of[ROW_MODELS] = {MODEL_CHAIN, MODEL_DOUBLE_PENDULUM, MODEL_NONSEPARABLE, MODEL_HENON_HEILES};
    const int row = _i % ROWS, which = of[_i / ROWS];
    if (!kind_serves(&rows[row].k, models[which]) || (row == ROWS - 1 && !models[which]->problem)) return;
    tvi_options options = kind_options_with(&rows[row].k, rows[row].degree, rows[row].quadrature, rows[row].points);
    options.compose_adjoint = rows[row].composed;
    check_promise(which, &options, rows[row].order);
    check_order(which, &options, rows[row].order - 0.3, rows[row].order + 0.3);
}
END_TEST

/* Order N - 1. */
enum { TAYLOR_LEAST = 3, TAYLOR_DEGREES = 5 };

START_TEST(taylor_has_order_of_its_degree_less_one)
{
    const int degree = TAYLOR_LEAST + _i % TAYLOR_DEGREES, which = _i / TAYLOR_DEGREES;
    const tvi_options options = options_taylor(degree);
    const model *m = models[which];
    if (m == &model_degenerate) return; /* there q' has no p, and q has order N */
    if (m->most_order && degree > m->most_order) return;
    check_promise(which, &options, degree - 1);
    check_order(which, &options, degree - 1.3, degree - 0.7);
}
END_TEST

START_TEST(stormer_verlet_has_order_2)
{
    const tvi_options options = options_verlet();
    if (!models[_i]->problem) return;
    check_promise(_i, &options, 2);
    check_order(_i, &options, 1.7, 2.3);
}
END_TEST

/* ---- The measured errors of sections 3 and 4 --------------------------------------------------------------------- */

/* At t_end, after `steps` steps. */
static two_errors end_error(int which, const tvi_options *options, long steps)
{
    const model *m = models[which];
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, options);
    test_state x = model_start(m);
    go(integrator, (m->t_end - m->t0) / (double)steps, steps, &x);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return state_difference(m->n, &x, &paths[which].at[PARTS - 1]);
}

enum { MEASURED_RUNS = 4 };
static const struct {
    int which;
    kind k;
    int degree, points;
    double error[MEASURED_RUNS]; /* at t_end with 8, 16, 32, 64 steps; 0: not measured, or below 1e-12 */
} measured[] = {
    {MODEL_PENDULUM, {TVI_TYPE1, TVI_AT_START, TVI_NODES_TRUNCATED, false}, 4, 5, {3.8e-3, 1.1e-3, 8.9e-5, 5.9e-6}},
    {MODEL_PENDULUM, {TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 4, 5, {2.2e-3, 4.9e-6, 2.0e-8, 7.8e-11}},
    {MODEL_PENDULUM, {TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 4, 5, {2.1e-6, 2.0e-8, 7.8e-11, 0}},
    {MODEL_KEPLER, {TVI_TYPE1, TVI_AT_START, TVI_NODES_TRUNCATED, false}, 4, 5, {9.1e-2, 1.9e-2, 1.6e-3, 1.1e-4}},
    {MODEL_KEPLER, {TVI_TYPE1, TVI_AT_START, TVI_NODES_ON_CURVE, false}, 4, 5, {2.4e-1, 6.6e-4, 2.7e-6, 1.1e-8}},
    {MODEL_KEPLER, {TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 4, 5, {7.8e-4, 2.7e-6, 1.1e-8, 4.2e-11}},
    {MODEL_KEPLER, {TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 6, 7, {1.3e-5, 3.0e-9, 0, 0}},
    {MODEL_KEPLER, {TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_TRUNCATED, true}, 3, 4, {4.4e-1, 2.2e-2, 1.7e-3, 1.1e-4}},
    {MODEL_KEPLER, {TVI_TYPE1, TVI_AT_BOTH_ENDS, TVI_NODES_ON_CURVE, true}, 3, 4, {1.1e-1, 2.9e-3, 5.5e-5, 9.1e-7}},
    {MODEL_KEPLER, {TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 3, 5, {1.8e-3, 1.3e-5, 5.4e-8, 0}},
    {MODEL_KEPLER, {TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 5, 7, {8.7e-5, 3.0e-8, 7.9e-12, 0}},
    {MODEL_DEGENERATE, {TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 1, 3, {4.1e-6, 2.6e-7, 1.6e-8, 0}},
    {MODEL_DEGENERATE, {TVI_POINCARE, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true}, 2, 4, {4.8e-9, 7.6e-11, 1.2e-12, 0}},
};
enum { MEASURED = sizeof measured / sizeof *measured };

START_TEST(errors_are_those_of_the_tables)
{
    const tvi_options options = kind_options_with(&measured[_i].k, measured[_i].degree, TVI_GAUSS, measured[_i].points);
    for (int run = 0; run < MEASURED_RUNS; run++) {
        const double expected = measured[_i].error[run];
        if (expected == 0) continue;
        const double error = larger(end_error(measured[_i].which, &options, 8L << run));
        ck_assert_msg(error < 1.5 * expected && error > expected / 1.5, "%s, %s, %ld steps: error %.2e, not %.1e",
                      models[measured[_i].which]->name, describe(&options), 8L << run, error, expected);
    }
}
END_TEST

/* ---- Section 4: the error constant of the midpoint --------------------------------------------------------------- */

/* The error at the start is larger than at the midpoint by 4^N for even N, 4^N (N/(N+1))^2 for odd N. */
enum { LEAST_OF_MIDPOINT = 2, DEGREES_OF_MIDPOINT = 3 };

START_TEST(midpoint_has_its_error_constant)
{
    static const long steps[] = {400, 100, 60};
    const int k = _i % DEGREES_OF_MIDPOINT, N = LEAST_OF_MIDPOINT + k, which = _i / DEGREES_OF_MIDPOINT;
    if (!models[which]->problem) return;
    const tvi_options start = options_type1(TVI_AT_START, TVI_NODES_ON_CURVE, N);
    const tvi_options midpoint = options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, N);
    const two_errors at_start = end_error(which, &start, steps[k]), at_midpoint = end_error(which, &midpoint, steps[k]);
    const double expected = pow(4, N) * (N % 2 ? pow(N / (N + 1.0), 2) : 1);
    ck_assert_double_eq_tol(at_start.q / at_midpoint.q, expected, 0.02 * expected);
    ck_assert_double_eq_tol(at_start.p / at_midpoint.p, expected, 0.02 * expected);
}
END_TEST

Suite *suite_orders(void)
{
    Suite *suite = suite_create("orders");
    TCase *tcase = tcase_create("orders");
    tcase_add_unchecked_fixture(tcase, find_paths, NULL);
    tcase_add_loop_test(tcase, method_has_its_order, 0, MODELS_OF_ORDERS * all_kinds * DEGREES);
    tcase_add_loop_test(tcase, quadrature_and_composition_have_their_orders, 0, ROW_MODELS * ROWS);
    tcase_add_loop_test(tcase, taylor_has_order_of_its_degree_less_one, 0, MODELS_OF_ORDERS * TAYLOR_DEGREES);
    tcase_add_loop_test(tcase, stormer_verlet_has_order_2, 0, MODELS_OF_ORDERS);
    tcase_add_loop_test(tcase, errors_are_those_of_the_tables, 0, MEASURED);
    tcase_add_loop_test(tcase, midpoint_has_its_error_constant, 0, MODELS_OF_ORDERS * DEGREES_OF_MIDPOINT);
    suite_add_tcase(suite, tcase);
    return suite;
}
