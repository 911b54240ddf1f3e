/* test_galerkin.c - the Galerkin curve: Gauss collocation for every form of system, its predictor and its passes
 * (docs/method.md sections 4 to 6). What it shares with the generating functions is in the other suites. */
#include "generating.h"
#include "models.h"
#include "algebra/quadrature.h"

#include <float.h>
#include <math.h>
#include <string.h>

static tvi_options galerkin(int nodes) { return kind_options(&kinds[kind_count], nodes); }

/* ---- Any Hamiltonian: the canonical exchange -----------------------------------------------------------------------
 */

/* Collocation does not see a linear canonical change of the variables: Q = p, P = -q, H = sum Q_i^2/(2 m_i) + V(-P). */
static jet kepler_potential(const jet q[], jet t)
{
    (void)t;
    return jet_neg(jet_pow(jet_add(jet_sqr(q[0]), jet_sqr(q[1])), -0.5));
}

/* Quartic springs, driven. */
static jet driven_potential(const jet q[], jet t)
{
    const jet d = jet_sub(q[1], q[0]);
    const jet springs = jet_add(jet_add(jet_sqr(q[0]), jet_pow(d, 4)), jet_mul(0.5, jet_sqr(q[1])));
    return jet_add(springs, jet_mul(jet_mul(0.75, q[0]), jet_cos(jet_mul(1.7, t))));
}

typedef struct {
    jet (*potential)(const jet q[], jet t);
    double mass[2], q[2], p[2], h;
} exchange_case;

static const exchange_case exchange_cases[] = {
    {kepler_potential, {1, 1}, {1, 0}, {0, 0.8}, 0.125},
    {driven_potential, {1.5, 0.4}, {0.3, -0.2}, {0.5, 1}, 0.125},
};
enum { EXCHANGE_CASES = sizeof exchange_cases / sizeof *exchange_cases };

static jet plain_potential(const jet q[], jet t, void *ctx) { return ((const exchange_case *)ctx)->potential(q, t); }

static jet exchanged_hamiltonian(const jet Q[], const jet P[], jet t, void *ctx)
{
    const exchange_case *c = ctx;
    const jet q[] = {jet_neg(P[0]), jet_neg(P[1])};
    const jet kinetic = jet_add(jet_mul(0.5 / c->mass[0], jet_sqr(Q[0])), jet_mul(0.5 / c->mass[1], jet_sqr(Q[1])));
    return jet_add(kinetic, c->potential(q, t));
}

START_TEST(exchange_of_variables_changes_nothing)
{
    exchange_case c = exchange_cases[_i % EXCHANGE_CASES];
    const tvi_options options = galerkin(1 + _i / EXCHANGE_CASES);
    tvi_system *plain, *exchanged_system;
    ck_assert_int_eq(tvi_system_potential(&plain, 2, c.mass, plain_potential, &c), TVI_OK);
    ck_assert_int_eq(tvi_system_hamiltonian(&exchanged_system, 2, exchanged_hamiltonian, &c), TVI_OK);
    tvi_integrator *it = integrator_of(plain, &options), *other = integrator_of(exchanged_system, &options);
    test_state x = {.t = 0.25}, y = {.t = 0.25};
    for (int i = 0; i < 2; i++) x.q[i] = c.q[i], x.p[i] = c.p[i], y.q[i] = c.p[i], y.p[i] = -c.q[i];
    go(it, c.h, 8, &x);
    go(other, c.h, 8, &y);
    for (int i = 0; i < 2; i++) {
        ck_assert_double_eq_tol(y.q[i], x.p[i], 2e-14);
        ck_assert_double_eq_tol(-y.p[i], x.q[i], 2e-14);
    }
    tvi_integrator_free(it);
    tvi_integrator_free(other);
    tvi_system_free(plain);
    tvi_system_free(exchanged_system);
}
END_TEST

/* ---- A field whose components are its inputs -----------------------------------------------------------------------
 */

/* F = (m q_1, m q_0): with m = 1 the coordinates themselves. All else doubles with m, bit for bit. */
static void saddle(const jet q[], jet t, jet force[], void *ctx)
{
    const double m = *(const double *)ctx;
    (void)t;
    for (int i = 0; i < 2; i++) force[i] = m == 1 ? q[1 - i] : jet_mul(m, q[1 - i]);
}

/* Passes that are far from the end, so that their order shows. */
START_TEST(field_may_be_its_input)
{
    tvi_options options = galerkin(3);
    options.passes = 2;
    test_state end[2];
    for (int k = 0; k < 2; k++) {
        double m = 1 + k, masses[] = {m, m};
        tvi_system *system;
        ck_assert_int_eq(tvi_system_force(&system, 2, masses, saddle, &m), TVI_OK);
        tvi_integrator *it = integrator_of(system, &options);
        end[k] = (test_state){.q = {1, 0.25}, .p = {-0.5 * m, 0.125 * m}};
        go(it, 0.5, 5, &end[k]);
        tvi_integrator_free(it);
        tvi_system_free(system);
    }
    for (int i = 0; i < 2; i++) {
        ck_assert_double_eq(end[0].q[i], end[1].q[i]);
        ck_assert_double_eq(2 * end[0].p[i], end[1].p[i]);
    }
}
END_TEST

/* H = p_0 p_1 + q_0 q_1: q_0' = p_1, p_1' = -q_0, a rotation; likewise (q_1, p_0). */
static jet crossed(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_mul(p[0], p[1]), jet_mul(q[0], q[1]));
}

START_TEST(hamiltonian_field_may_be_its_input)
{
    const tvi_options options = galerkin(8);
    tvi_system *system;
    ck_assert_int_eq(tvi_system_hamiltonian(&system, 2, crossed, NULL), TVI_OK);
    tvi_integrator *it = integrator_of(system, &options);
    test_state x = {.q = {1, 0.5}, .p = {0.25, -0.75}};
    go(it, 0.25, 8, &x);
    ck_assert_double_eq_tol(x.q[0], cos(2) - 0.75 * sin(2), 1e-14);
    ck_assert_double_eq_tol(x.p[1], -0.75 * cos(2) - sin(2), 1e-14);
    ck_assert_double_eq_tol(x.q[1], 0.5 * cos(2) + 0.25 * sin(2), 1e-14);
    ck_assert_double_eq_tol(x.p[0], 0.25 * cos(2) - 0.5 * sin(2), 1e-14);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* ---- The energy of long runs ------------------------------------------------------------------------------------- */

/* H - H0 of Kepler after 100,000 steps, where the method's own error is far below roundoff. */
static double energy_after(const tvi_options *options)
{
    tvi_system *system = model_system(&model_kepler);
    tvi_integrator *it = integrator_of(system, options);
    test_state x = model_start(&model_kepler);
    const double start = state_energy(system, &x);
    double sum = 0;
    for (int i = 0; i < 100; i++) {
        go(it, 0.125, 1000, &x);
        if (i >= 90) sum += (state_energy(system, &x) - start) / 10;
    }
    tvi_integrator_free(it);
    tvi_system_free(system);
    return fabs(sum);
}

/* Roundoff alone: 1e-14 is 0.2 units in the last place for the square root of the steps. Weights or nodes of one double
 * each make 1e-13 to 3e-13, which grows like the steps; passes that end sooner bias the energy too. */
START_TEST(energy_does_not_drift)
{
    tvi_options options = galerkin(6 + _i);
    const double error = energy_after(&options);
    ck_assert_msg(error < 3e-14, "%d nodes: %.1e", options.degree, error);
    options.tolerance = 1e-10;
    const double biased = energy_after(&options);
    ck_assert_msg(biased > 1e-13, "%d nodes: %.1e with a tolerance", options.degree, biased);
}
END_TEST

/* ---- The predictor and the passes ---------------------------------------------------------------------------------
 */

/* Kepler from its apocentre, `steps` steps of h and h times ratio in turns. */
static tvi_stats stats_after(const tvi_options *options, double h, double ratio, bool resets, int steps)
{
    tvi_system *system = model_system(&model_kepler);
    tvi_integrator *it = integrator_of(system, options);
    test_state x = model_start(&model_kepler);
    for (int i = 0; i < steps; i++) {
        if (resets) tvi_integrator_reset(it);
        go(it, i % 2 ? ratio * h : h, 1, &x);
    }
    const tvi_stats stats = *tvi_integrator_stats(it);
    tvi_integrator_free(it);
    tvi_system_free(system);
    return stats;
}

/* The steps before save 1.9 of the five passes, of whatever size they were, and the force at the start; two of the same
 * size save a third of a pass more. */
START_TEST(steps_before_predict)
{
    static const double ratios[] = {1, 0.75, 1.25, -1, -0.5};
    static const double least[] = {2.2, 1.9, 1.9, 2.8, 2.6};
    enum { STEPS = 200 };
    const tvi_options options = galerkin(8);
    const tvi_stats stats = stats_after(&options, 0.0625, ratios[_i], false, STEPS);
    const tvi_stats first = stats_after(&options, 0.0625, ratios[_i], true, STEPS);
    const double saved = (double)(first.passes - stats.passes) / STEPS;
    ck_assert_msg(saved > least[_i], "ratio %g: %.2f passes saved", ratios[_i], saved);
    ck_assert_int_eq(stats.force_evaluations, 8 * stats.passes + 1);
    ck_assert_int_eq(first.force_evaluations, 8 * first.passes + STEPS);
}
END_TEST

/* A step that is much longer than the one before it, or goes back over more, begins anew. */
START_TEST(other_steps_begin_anew)
{
    static const double ratios[] = {8, 1e-3, -8, -1e-3};
    const tvi_options options = galerkin(8);
    const double h = fabs(ratios[_i]) > 1 ? 0.015625 : 0.125;
    const tvi_stats stats = stats_after(&options, h, ratios[_i], false, 20);
    ck_assert_int_ge(stats.force_evaluations - 8 * stats.passes, 10);
}
END_TEST

/* The halves of a composition do not continue each other: what one predicts would be for another time. */
START_TEST(halves_begin_anew)
{
    enum { STEPS = 40 };
    tvi_options options = galerkin(8);
    options.compose_adjoint = true;
    const tvi_stats stats = stats_after(&options, 0.125, 1, false, STEPS);
    ck_assert_int_eq(stats.force_evaluations, 8 * stats.passes + 2 * STEPS);
    ck_assert_int_lt(stats.passes, 2 * 6 * STEPS);
}
END_TEST

START_TEST(number_of_passes_is_kept)
{
    tvi_options options = galerkin(4);
    for (int k = 1; k <= 5; k++) {
        options.passes = k;
        const tvi_stats stats = stats_after(&options, 0.125, 1, false, 10);
        ck_assert_int_eq(stats.passes, 10 * k);
        ck_assert_int_eq(stats.force_evaluations, 10 * 4 * k + 1);
        ck_assert_int_eq(stats.expansions + stats.factorisations, 0);
    }
}
END_TEST

START_TEST(tolerance_ends_the_passes)
{
    tvi_options options = galerkin(8);
    const tvi_stats roundoff = stats_after(&options, 0.125, 1, false, 50);
    options.tolerance = 1e-6;
    const tvi_stats loose = stats_after(&options, 0.125, 1, false, 50);
    ck_assert_int_lt(loose.passes, roundoff.passes - 50);
    ck_assert_double_le(loose.residual, 1e-6);
    ck_assert_double_gt(loose.residual, roundoff.residual);
    ck_assert_double_lt(roundoff.residual, 1e-13);
}
END_TEST

/* Without passes the force is that at the start: a parabola, whatever steps were before. */
START_TEST(prediction_is_a_parabola)
{
    tvi_options options = galerkin(5);
    options.passes = TVI_PREDICT_ONLY;
    tvi_system *system = problem_system(&problem_chain);
    tvi_integrator *it = integrator_of(system, &options);
    test_state x = problem_start(&problem_chain);
    for (int step = 0; step < 3; step++) {
        const test_state start = x;
        const double h = 0.03125 * (1 + step);
        long double q[N_MAX], F[N_MAX];
        for (int i = 0; i < 3; i++) q[i] = start.q[i];
        problem_chain.plain(start.t, q, F);
        go(it, h, 1, &x);
        for (int i = 0; i < 3; i++) {
            const double m = problem_mass(&problem_chain, i), force = (double)F[i];
            ck_assert_double_eq_tol(x.p[i], start.p[i] + h * force, 1e-15);
            ck_assert_double_eq_tol(x.q[i], start.q[i] + h / m * (start.p[i] + h / 2 * force), 1e-15);
        }
    }
    ck_assert_int_eq(tvi_integrator_stats(it)->passes, 0);
    ck_assert_int_eq(tvi_integrator_stats(it)->force_evaluations, 3);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* A fixed point that does not contract: bounded, and nothing is touched; the step after it is as if it had not been. */
/* t^power. */
static jet power_of(jet t, int power)
{
    jet product = jet_const(1);
    for (int i = 0; i < power; i++) product = jet_mul(product, t);
    return product;
}

static jet pushed(const jet q[], jet t, void *ctx) { return jet_neg(jet_mul(q[0], power_of(t, *(int *)ctx))); }
static jet carried(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q;
    return jet_mul(p[0], power_of(t, *(int *)ctx));
}

/* h k!^2 / (2k)! h^k: the last term, k = N - 1, of Legendre's series of t^k over a step of size h, times h. */
static double last_of_power(int k, double h)
{
    double last = h;
    for (int i = 1; i <= k; i++) last *= h * i / (2 * (2 * i - 1));
    return last;
}

/* Of m q'' = t^k, relative to |p0| + |dp| + h (t_1^k + t_N^k), t_1 and t_N the first and the last node; of q' = t^k
 * relative to the last of the three. With one node there is no tail. */
START_TEST(tail_is_the_last_term)
{
    const int N = _i;
    int power = N - 1;
    const double mass = 2.5, h = 0.75, q0 = 4, p0 = -1, t0 = 1.25;
    long double s[TVI_MAX_NODES], b[TVI_MAX_NODES];
    tvi_quadrature_nodes(TVI_GAUSS, N, s, b);
    const double ends = pow(t0 + h * (1 + (double)s[0]) / 2, power) + pow(t0 + h * (1 + (double)s[N - 1]) / 2, power);
    const double rise = (pow(t0 + h, N) - pow(t0, N)) / N, last = N > 1 ? last_of_power(power, h) : 0;
    const double want[] = {last / (fabs(p0) + rise + h * ends), last / (h * ends)};
    const tvi_options options = galerkin(N);
    tvi_system *systems[2];
    ck_assert_int_eq(tvi_system_potential(&systems[0], 1, &mass, pushed, &power), TVI_OK);
    ck_assert_int_eq(tvi_system_hamiltonian(&systems[1], 1, carried, &power), TVI_OK);
    for (int i = 0; i < 2; i++) {
        tvi_integrator *it = integrator_of(systems[i], &options);
        test_state x = {.t = t0, .q = {q0}, .p = {p0}};
        go(it, h, 1, &x);
        ck_assert_double_eq_tol(tvi_integrator_stats(it)->tail, want[i], 1e-6 * want[i] + 1e-13);
        tvi_integrator_free(it);
        tvi_system_free(systems[i]);
    }
}
END_TEST

START_TEST(too_large_steps_fail)
{
    tvi_options options = galerkin(8);
    const int bounds[] = {0, 7};
    options.max_passes = bounds[_i];
    tvi_system *system = model_system(&model_pendulum);
    tvi_integrator *it = integrator_of(system, &options), *other = integrator_of(system, &options);
    test_state x = model_start(&model_pendulum), y = x;
    options.max_passes = 0;
    go(it, 0.0625, 2, &x);
    go(other, 0.0625, 2, &y);
    const test_state before = x;
    const long passes = tvi_integrator_stats(it)->passes;
    ck_assert_int_eq(tvi_step(it, 16, &x.t, x.q, x.p), TVI_ENOCONV);
    ck_assert_mem_eq(&x, &before, sizeof x);
    ck_assert_int_eq(tvi_integrator_stats(it)->passes - passes, bounds[_i] ? bounds[_i] : 100);
    go(it, 0.0625, 20, &x);
    go(other, 0.0625, 20, &y);
    ck_assert_mem_eq(&x, &y, sizeof x);
    tvi_integrator_free(it);
    tvi_integrator_free(other);
    tvi_system_free(system);
}
END_TEST

Suite *suite_galerkin(void)
{
    Suite *suite = suite_create("galerkin");
    TCase *tcase = tcase_create("galerkin");
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, exchange_of_variables_changes_nothing, 0, EXCHANGE_CASES * TVI_MAX_NODES);
    tcase_add_test(tcase, field_may_be_its_input);
    tcase_add_test(tcase, hamiltonian_field_may_be_its_input);
    tcase_add_loop_test(tcase, energy_does_not_drift, 0, 4);
    tcase_add_loop_test(tcase, steps_before_predict, 0, 5);
    tcase_add_loop_test(tcase, other_steps_begin_anew, 0, 4);
    tcase_add_test(tcase, halves_begin_anew);
    tcase_add_test(tcase, number_of_passes_is_kept);
    tcase_add_test(tcase, tolerance_ends_the_passes);
    tcase_add_test(tcase, prediction_is_a_parabola);
    tcase_add_loop_test(tcase, tail_is_the_last_term, 1, TVI_MAX_NODES + 1);
    tcase_add_loop_test(tcase, too_large_steps_fail, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
