/* test_structure.c - Tests what a variational integrator keeps: momentum, reversibility, energy (docs/method.md
 * sections 3 to 6). Every property has a control that must fail it. The symplectic form is in
 * generating/test_geometry.c. */
#include "problems/problems.h"
#include "problems/statistics.h"
#include "suites.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* ---- Problems ---------------------------------------------------------------------------------------------------- */

/* The start, and the step: away from any symmetry of the start. */
static const struct {
    const test_problem *problem;
    double h;
} places[] = {{&problem_pendulum, 0.1}, {&problem_kepler, 0.1}, {&problem_henon_heiles, 0.25}, {&problem_chain, 0.05}};
enum { PLACES = sizeof places / sizeof *places, MOST_DEGREE = 6 };

static test_state place(int i)
{
    test_state x = problem_start(places[i].problem);
    x.q[0] += 0.1;
    x.p[0] += 0.05;
    return x;
}

/* ---- Momentum ---------------------------------------------------------------------------------------------------- */

typedef struct {
    double x[3];
} vector;

/* sum_bodies q x p; in the plane only x[2]. */
static vector angular_momentum(const test_problem *problem, const test_state *x)
{
    const int plane = problem->scene->n == 2;
    vector L = {{0, 0, 0}};
    for (int body = 0; body < problem->scene->n; body += plane ? 2 : 3) {
        const double *q = x->q + body, *p = x->p + body;
        L.x[2] += q[0] * p[1] - q[1] * p[0];
        if (plane) continue;
        L.x[0] += q[1] * p[2] - q[2] * p[1];
        L.x[1] += q[2] * p[0] - q[0] * p[2];
    }
    return L;
}

static vector linear_momentum(const test_problem *problem, const test_state *x)
{
    vector P = {{0, 0, 0}};
    for (int i = 0; i < problem->scene->n; i++) P.x[i % 3] += x->p[i];
    return P;
}

typedef vector momentum_function(const test_problem *problem, const test_state *x);

/* The largest change of a momentum relative to its largest component, over steps of size h. */
static double momentum_change(const test_problem *problem, const tvi_options *options, double h, int steps,
                              momentum_function *momentum)
{
    runner run = runner_open(problem, options);
    test_state x = problem_start(problem);
    const vector start = momentum(problem, &x);
    double change = 0, size = 0;
    for (int step = 0; step < steps; step++) {
        runner_steps(&run, h, 1, &x);
        const vector now = momentum(problem, &x);
        for (int i = 0; i < 3; i++) {
            change = fmax(change, fabs(now.x[i] - start.x[i]));
            size = fmax(size, fabs(start.x[i]));
        }
    }
    runner_close(&run);
    return change / size;
}

static const struct {
    tvi_expansion expansion;
    tvi_nodes nodes;
    int degree;
    double h, most; /* of the change after 10^4 steps */
} kepler_rows[] = {
    {TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 6, 0.0625, 5e-15},  {TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 8, 0.1875, 1e-14},
    {TVI_AT_MIDPOINT, TVI_NODES_TRUNCATED, 5, 0.0625, 1e-14}, {TVI_AT_START, TVI_NODES_ON_CURVE, 8, 0.0625, 5e-15},
    {TVI_AT_START, TVI_NODES_ON_CURVE, 6, 0.125, 5e-14},      {TVI_AT_START, TVI_NODES_TRUNCATED, 6, 0.0625, 5e-14},
};
enum { KEPLER_ROWS = sizeof kepler_rows / sizeof *kepler_rows };

START_TEST(kepler_keeps_angular_momentum)
{
    const tvi_options options = options_type1(kepler_rows[_i].expansion, kepler_rows[_i].nodes, kepler_rows[_i].degree);
    const double change = momentum_change(&problem_kepler, &options, kepler_rows[_i].h, 10000, angular_momentum);
    ck_assert_msg(change < kepler_rows[_i].most, "row %d: %.1e", _i, change);
}
END_TEST

START_TEST(solar_system_keeps_momentum)
{
    const tvi_options options[] = {options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 6),
                                   options_type1(TVI_AT_START, TVI_NODES_ON_CURVE, 6),
                                   options_type1(TVI_AT_START, TVI_NODES_TRUNCATED, 4)};
    ck_assert_double_lt(momentum_change(&problem_solar, &options[_i], 400, 500, angular_momentum), 3e-14);
    ck_assert_double_lt(momentum_change(&problem_solar, &options[_i], 400, 500, linear_momentum), 1e-13);
}
END_TEST

START_TEST(taylor_does_not_keep_angular_momentum)
{
    const tvi_options taylor = options_taylor(9);
    ck_assert_double_gt(momentum_change(&problem_kepler, &taylor, 0.0625, 10000, angular_momentum), 1e-10);
    ck_assert_double_gt(momentum_change(&problem_solar, &taylor, 400, 500, angular_momentum), 1e-10);
}
END_TEST

/* ---- Reversibility ----------------------------------------------------------------------------------------------- */

/* Distance from the start after 500 steps of h and 500 of -h, relative to the size of q and p. */
static double return_error(int place, const tvi_options *options)
{
    static const double h[] = {0.1, 0.0625, 0.25, 0.05};
    const test_problem *problem = places[place].problem;
    const int n = problem->scene->n;
    runner run = runner_open(problem, options);
    const test_state start = problem_start(problem), zero = {0};
    test_state x = start;
    two_errors size = state_difference(n, &start, &zero);
    for (int step = 0; step < 500; step++) {
        runner_steps(&run, h[place], 1, &x);
        const two_errors now = state_difference(n, &x, &zero);
        size = (two_errors){fmax(size.q, now.q), fmax(size.p, now.p)};
    }
    runner_steps(&run, -h[place], 500, &x);
    runner_close(&run);
    ck_assert_double_eq_tol(x.t, start.t, 1e-13);
    const two_errors error = state_difference(n, &x, &start);
    return fmax(error.q / size.q, error.p / size.p);
}

static const struct {
    tvi_nodes nodes;
    int degree;
} reversible[] = {{TVI_NODES_ON_CURVE, 1},  {TVI_NODES_ON_CURVE, 2}, {TVI_NODES_ON_CURVE, 3},
                  {TVI_NODES_ON_CURVE, 4},  {TVI_NODES_ON_CURVE, 7}, {TVI_NODES_TRUNCATED, 2},
                  {TVI_NODES_TRUNCATED, 3}, {TVI_NODES_TRUNCATED, 4}};
enum { REVERSIBLE = sizeof reversible / sizeof *reversible };

START_TEST(midpoint_is_reversible)
{
    const int row = _i % REVERSIBLE;
    const tvi_options options = options_type1(TVI_AT_MIDPOINT, reversible[row].nodes, reversible[row].degree);
    const double error = return_error(_i / REVERSIBLE, &options);
    ck_assert_msg(error < 1e-13, "N = %d, nodes %d: %.1e", options.degree, (int)options.nodes, error);
}
END_TEST

START_TEST(start_is_not_reversible)
{
    const tvi_options on_curve = options_type1(TVI_AT_START, TVI_NODES_ON_CURVE, 2);
    const tvi_options truncated = options_type1(TVI_AT_START, TVI_NODES_TRUNCATED, 4);
    tvi_options rectangle = options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 2);
    rectangle.quadrature = TVI_RECTANGLE_START; /* not symmetric */
    ck_assert_double_gt(return_error(_i, &on_curve), 1e-10);
    ck_assert_double_gt(return_error(_i, &truncated), 1e-10);
    ck_assert_double_gt(return_error(_i, &rectangle), 1e-10);
}
END_TEST

/* The adjoint of the start is the end with the mirrored quadrature: the one with -h leads back from the other with
 * h. */
START_TEST(end_is_the_adjoint_of_start)
{
    static const struct {
        tvi_quadrature start, end;
    } mirrored[] = {{TVI_QUADRATURE_AUTO, TVI_QUADRATURE_AUTO},
                    {TVI_RECTANGLE_START, TVI_RECTANGLE_END},
                    {TVI_RECTANGLE_END, TVI_RECTANGLE_START},
                    {TVI_TRAPEZOID, TVI_TRAPEZOID}};
    const int i = _i % PLACES, n = places[i].problem->scene->n;
    const tvi_nodes nodes = _i / PLACES ? TVI_NODES_TRUNCATED : TVI_NODES_ON_CURVE;
    for (int N = 1; N <= MOST_DEGREE; N++)
        for (int row = 0; row < 4; row++) {
            tvi_options start = options_type1(TVI_AT_START, nodes, N), end = options_type1(TVI_AT_END, nodes, N);
            start.quadrature = mirrored[row].start;
            end.quadrature = mirrored[row].end;
            runner forward = runner_open(places[i].problem, &start), back = runner_open(places[i].problem, &end);
            const test_state from = place(i);
            test_state x = from;
            runner_steps(&forward, places[i].h, 1, &x);
            const double moved = larger(state_difference(n, &x, &from));
            runner_steps(&back, -places[i].h, 1, &x);
            const double error = larger(state_difference(n, &x, &from));
            ck_assert_msg(moved > 0.01 && error < 2e-15, "place %d, nodes %d, N = %d, row %d: %.1e", i, (int)nodes, N,
                          row, error);
            runner_close(&forward);
            runner_close(&back);
        }
}
END_TEST

/* ---- Energy ------------------------------------------------------------------------------------------------------ */

typedef struct {
    double first, last; /* largest |H - H0| over the first and the last tenth of the run */
} energy_error;

static energy_error energy_over(const test_problem *problem, const tvi_options *options, double h, int steps)
{
    runner run = runner_open(problem, options);
    test_state x = problem_start(problem);
    const double H0 = state_energy(run.system, &x);
    energy_error error = {0, 0};
    for (int step = 0; step < steps; step++) {
        runner_steps(&run, h, 1, &x);
        const double now = fabs(state_energy(run.system, &x) - H0);
        if (step < steps / 10) error.first = fmax(error.first, now);
        if (step >= steps - steps / 10) error.last = fmax(error.last, now);
    }
    runner_close(&run);
    return error;
}

enum { LONG_RUN = 100000 };

static const struct {
    const test_problem *problem;
    double h;
    tvi_expansion expansion;
    int degree;
    double error; /* of the energy, within a factor 2 */
} energy_rows[] = {
    {&problem_kepler, 0.125, TVI_AT_MIDPOINT, 4, 6.5e-9},
    {&problem_kepler, 0.125, TVI_AT_START, 3, 3.2e-5},
    {&problem_pendulum, 0.125, TVI_AT_MIDPOINT, 4, 2.6e-8},
};
enum { ENERGY_ROWS = sizeof energy_rows / sizeof *energy_rows };

START_TEST(energy_error_has_no_trend)
{
    const tvi_options options = options_type1(energy_rows[_i].expansion, TVI_NODES_ON_CURVE, energy_rows[_i].degree);
    const energy_error error = energy_over(energy_rows[_i].problem, &options, energy_rows[_i].h, LONG_RUN);
    ck_assert_double_eq_tol(error.last, error.first, 0.05 * error.first);
    ck_assert_double_lt(error.last, 2 * energy_rows[_i].error);
    ck_assert_double_gt(error.last, energy_rows[_i].error / 2);
}
END_TEST

/* A method of the same order. */
START_TEST(energy_of_taylor_drifts)
{
    const tvi_options options = options_taylor(2 * energy_rows[_i].degree + 1);
    const energy_error error = energy_over(energy_rows[_i].problem, &options, energy_rows[_i].h, LONG_RUN / 10);
    ck_assert_double_gt(error.last, 5 * error.first);
}
END_TEST

/* Errors of Kepler's energy. With a reset before every step the low-order parts of the state are forgotten. */
static sample energy_errors(const tvi_options *options, bool resets)
{
    enum { STEPS = 1000 };
    sample errors = {0};
    for (int k = 0; k < ORBITS; k++) {
        runner run = runner_open(&problem_kepler, options);
        test_state x = problem_start(&problem_kepler);
        x.p[1] += start_shift(k);
        const double start = state_energy(run.system, &x);
        for (int call = 0; call < (resets ? STEPS : 1); call++) {
            if (resets) tvi_integrator_reset(run.integrator);
            runner_steps(&run, 0.0625, resets ? 1 : STEPS, &x);
        }
        sample_add(&errors, state_energy(run.system, &x) - start);
        runner_close(&run);
    }
    return errors;
}

/* Section 6: with compensated sums the energy error of a converged run is a random walk of roundoff. RMS is above that
 * of every instruction set and compiler, which is 4.7e-16 to 4.9e-16. The control has plain sums, and 2.6e-15 or
 * more. */
START_TEST(roundoff_does_not_drift)
{
    static const double RMS = 5.2e-16;
    const tvi_options options = options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 8);
    const sample errors = energy_errors(&options, false), of_plain_sums = energy_errors(&options, true);
    const double most = rms_factor(ORBITS) * RMS;
    ck_assert_double_lt(sample_drift(&errors), NO_DRIFT);
    ck_assert_double_lt(sample_rms(&errors), most);
    ck_assert_double_gt(sample_rms(&of_plain_sums), most);
}
END_TEST

START_TEST(time_is_compensated)
{
    const tvi_options options = options_verlet();
    runner run = runner_open(&problem_kepler, &options);
    test_state x = problem_start(&problem_kepler);
    runner_steps(&run, 0.1, LONG_RUN, &x);
    ck_assert_double_eq_tol(x.t, 0.1 * LONG_RUN, 2e-12); /* a unit in the last place */
    runner_close(&run);
}
END_TEST

Suite *suite_structure(void)
{
    Suite *suite = suite_create("structure");
    TCase *tcase = tcase_create("structure");
    tcase_add_loop_test(tcase, kepler_keeps_angular_momentum, 0, KEPLER_ROWS);
    tcase_add_loop_test(tcase, solar_system_keeps_momentum, 0, 3);
    tcase_add_test(tcase, taylor_does_not_keep_angular_momentum);
    tcase_add_loop_test(tcase, midpoint_is_reversible, 0, REVERSIBLE * PLACES);
    tcase_add_loop_test(tcase, start_is_not_reversible, 0, PLACES);
    tcase_add_loop_test(tcase, end_is_the_adjoint_of_start, 0, 2 * PLACES);
    tcase_add_loop_test(tcase, energy_error_has_no_trend, 0, ENERGY_ROWS);
    tcase_add_loop_test(tcase, energy_of_taylor_drifts, 0, ENERGY_ROWS);
    tcase_add_test(tcase, roundoff_does_not_drift);
    tcase_add_test(tcase, time_is_compensated);
    suite_add_tcase(suite, tcase);
    return suite;
}
