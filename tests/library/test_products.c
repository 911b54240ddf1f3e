/* test_products.c - Tests Jacobians as products (curve.h): against the matrices of the same curve, and whole steps of
 * many bodies against those of few, which use matrices. */
#include "generating/curve.h"
#include "problems/problems.h"
#include "suites.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COPIES = 7, DEGREE = 9 };

static double wave(int i) { return cos(1 + 0.7 * i) / (1 + 0.1 * i); }

/* ---- Products against matrices ----------------------------------------------------------------------------------- */

typedef struct {
    void *memory;
    tvi_curve curve;
    tvi_series_sum q, u;
} open_curve;

static void lay_out(open_curve *x, tvi_arena *arena, const tvi_system *system, tvi_jacobians jacobians)
{
    tvi_curve_allocate(&x->curve, arena, system, DEGREE, jacobians);
    x->q = tvi_series_sum_allocate(&x->curve, arena);
    x->u = tvi_series_sum_allocate(&x->curve, arena);
}

/* The curve from the problem's start, and sums of it at s = 0.9 for q and s = -0.8 for u. */
static open_curve open_at(const test_problem *problem, const tvi_system *system, tvi_jacobians jacobians)
{
    open_curve x = {0};
    tvi_arena arena = {0};
    lay_out(&x, &arena, system, jacobians);
    x.memory = tvi_arena_obtain_memory(&arena);
    ck_assert_ptr_nonnull(x.memory);
    lay_out(&x, &arena, system, jacobians);
    tvi_blocks_set_constants(arena.first_tape_block);
    tvi_curve_fill_tables(&x.curve);
    const test_state start = problem_start(problem);
    double z[2 * N_MAX];
    const double tau = problem->t_end / 50;
    for (int i = 0; i < system->n; i++) {
        z[i] = start.q[i];
        z[system->n + i] = tau * start.p[i] / system->mass[i];
    }
    curve_set_tau(&x.curve, tau);
    curve_set_z(&x.curve, z);
    ck_assert_int_eq(tvi_curve_expand(&x.curve, start.t), TVI_OK);
    tvi_series_sum_set_powers(&x.q, &x.curve, false, DEGREE, 1, 0.9, -1, 0);
    tvi_series_sum_set_powers(&x.u, &x.curve, true, DEGREE - 1, 1, -0.8, 0, 0);
    if (jacobians == TVI_JACOBIAN_MATRICES) tvi_curve_compute_jacobians(&x.curve);
    return x;
}

static void check_close(int count, const double got[], const double want[])
{
    double size = 0;
    for (int i = 0; i < count; i++) size = fmax(size, fabs(want[i]));
    ck_assert_double_gt(size, 0);
    for (int i = 0; i < count; i++)
        ck_assert_msg(fabs(got[i] - want[i]) <= 1e-13 * size, "%d: %.17g, not %.17g", i, got[i], want[i]);
}

static const test_problem *const product_problems[] = {&problem_kepler, &problem_chain, &problem_fpu, &problem_solar,
                                                       &problem_ring};

START_TEST(products_are_those_of_the_matrices)
{
    const test_problem *problem = product_problems[_i];
    tvi_system *system = problem_system(problem);
    const int n = system->n;
    open_curve matrices = open_at(problem, system, TVI_JACOBIAN_MATRICES);
    open_curve products = open_at(problem, system, TVI_JACOBIAN_PRODUCTS);
    double seed[(DEGREE + 1) * N_MAX], x[2 * N_MAX], got[2 * N_MAX], want[2 * N_MAX], matrix[2 * N_MAX * N_MAX];
    for (int i = 0; i < (DEGREE + 1) * n; i++) seed[i] = wave(3 * i);
    for (int i = 0; i < 2 * n; i++) x[i] = wave(i);
    tvi_curve_multiply_seeds(&matrices.curve, seed, NULL, want);
    tvi_multiply_transposed(&products.curve, products.curve.highest_order, &(tvi_transposed_product){.seed_Q = seed},
                            got);
    check_close(2 * n, got, want);
    tvi_curve_set_dz(&matrices.curve, x);
    tvi_curve_set_dz(&products.curve, x);
    tvi_series_sum_compute_change(&matrices.curve, &matrices.u, want);
    tvi_series_sum_compute_change(&products.curve, &products.u, got);
    check_close(n, got, want);
    memset(want, 0, sizeof want);
    for (int second = 0; second < 2; second++) {
        tvi_series_sum_compute_jacobian(&matrices.curve, second ? &matrices.u : &matrices.q, matrix);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < 2 * n; j++) want[j] += matrix[i * 2 * n + j] * x[second * n + i];
    }
    const tvi_transposed_product of = {.factor = 1, .upper = &products.q, .lower = &products.u, .x = x, .y = x + n};
    tvi_multiply_transposed(&products.curve, DEGREE, &of, got);
    check_close(2 * n, got, want);
    free(matrices.memory);
    free(products.memory);
    tvi_system_free(system);
}
END_TEST

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* V of Kepler problems that do not know of each other, q of copy i at 2 i. */
static jet copies_of_kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet V = jet_const(0);
    for (int i = 0; i < COPIES; i++) V = jet_sub(V, jet_pow(jet_add(jet_sqr(q[2 * i]), jet_sqr(q[2 * i + 1])), -0.5));
    return V;
}

static jet one_kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_add(jet_sqr(q[0]), jet_sqr(q[1])), -0.5));
}

/* Copy i starts at q = (1, 0), p = (0, 0.8 + 0.03 i), with masses 1 + i/10 in both directions. */
static void start_copy(int i, double q[], double p[], double mass[])
{
    q[0] = 1, q[1] = 0;
    mass[0] = mass[1] = 1 + 0.1 * i;
    p[0] = 0, p[1] = mass[0] * (0.8 + 0.03 * i) / sqrt(mass[0]);
}

static const struct {
    const char *name;
    int order;
    double h;
} product_methods[] = {{"midpoint", 16, 0.15},  {"midpoint", 6, 0.05}, {"start", 12, 0.1},     {"end", 12, 0.1},
                       {"right", 12, 0.1},      {"left", 12, 0.1},     {"poincare", 14, 0.15}, {"tvi", 4, 0.02},
                       {"htvi-right", 4, 0.02}, {"htvi-left", 4, 0.02}};

static void run(const tvi_system *system, const tvi_options *options, double h, double q[], double p[])
{
    tvi_integrator *integrator;
    double t = 0;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, h, 40, &t, q, p, NULL, NULL), TVI_OK);
    tvi_integrator_free(integrator);
}

START_TEST(many_bodies_move_as_one)
{
    tvi_options options;
    tvi_system *many, *one;
    double Q[2 * COPIES], P[2 * COPIES], masses[2 * COPIES];
    ck_assert_int_eq(tvi_options_named(product_methods[_i].name, product_methods[_i].order, &options), TVI_OK);
    for (int i = 0; i < COPIES; i++) start_copy(i, Q + 2 * i, P + 2 * i, masses + 2 * i);
    ck_assert_int_eq(tvi_system_potential(&many, 2 * COPIES, masses, copies_of_kepler, NULL), TVI_OK);
    ck_assert_int_eq(tvi_curve_choose_jacobians(many), TVI_JACOBIAN_PRODUCTS);
    run(many, &options, product_methods[_i].h, Q, P);
    for (int i = 0; i < COPIES; i++) {
        double q[2], p[2], mass[2];
        start_copy(i, q, p, mass);
        ck_assert_int_eq(tvi_system_potential(&one, 2, mass, one_kepler, NULL), TVI_OK);
        ck_assert_int_eq(tvi_curve_choose_jacobians(one), TVI_JACOBIAN_MATRICES);
        run(one, &options, product_methods[_i].h, q, p);
        for (int j = 0; j < 2; j++) {
            ck_assert_double_eq_tol(Q[2 * i + j], q[j], 3e-13);
            ck_assert_double_eq_tol(P[2 * i + j], p[j], 3e-13);
        }
        tvi_system_free(one);
    }
    tvi_system_free(many);
}
END_TEST

/* V of a chain whose bodies rest, n = 2 COPIES. */
static jet chain(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet V = jet_const(0);
    for (int i = 0; i < 2 * COPIES; i++) {
        V = jet_add(V, jet_mul(0.5 + 0.1 * i, jet_sqr(q[i])));
        if (i > 0) V = jet_add(V, jet_mul(0.1, jet_mul(q[i], q[i - 1])));
    }
    return V;
}

/* From rest, of all bodies, of all but one displaced, and at the origin, where nothing has a size. */
START_TEST(bodies_start_at_rest)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2 * COPIES, NULL, chain, NULL), TVI_OK);
    for (int order = 2; order <= 8; order += 2)
        for (int displaced = 0; displaced < 3; displaced++) {
            tvi_options options;
            double q[2 * COPIES] = {0}, p[2 * COPIES] = {0}, before, after;
            if (tvi_options_named(product_methods[_i].name, order, &options) != TVI_OK) continue;
            for (int i = 0; i < (displaced == 2 ? 2 * COPIES : displaced); i++) q[i] = 0.5;
            ck_assert_int_eq(tvi_energy(system, 0, q, p, &before), TVI_OK);
            run(system, &options, 0.05, q, p);
            ck_assert_int_eq(tvi_energy(system, 0, q, p, &after), TVI_OK);
            ck_assert_double_le(fabs(after - before), 0.02 * before);
        }
    tvi_system_free(system);
}
END_TEST

/* Q_1 = 0 there, and Q_2 is not: the first corrections are made to a curve that has it. */
START_TEST(a_first_step_from_rest_takes_few_passes)
{
    tvi_system *system;
    tvi_options options;
    tvi_integrator *integrator;
    double t = 0, Q[2 * COPIES], P[2 * COPIES], masses[2 * COPIES];
    ck_assert_int_eq(tvi_options_named(product_methods[_i].name, 12, &options), TVI_OK);
    for (int i = 0; i < COPIES; i++) start_copy(i, Q + 2 * i, P + 2 * i, masses + 2 * i);
    memset(P, 0, sizeof P);
    ck_assert_int_eq(tvi_system_potential(&system, 2 * COPIES, masses, copies_of_kepler, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_step(integrator, 0.1, &t, Q, P), TVI_OK);
    ck_assert_int_le(tvi_integrator_stats(integrator)->passes, 4);
    ck_assert_double_gt(fabs(P[0]), 1e-3); /* it moves */
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

enum { LONG_CHAIN = 60 };

static jet long_chain(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet V = jet_const(0);
    for (int i = 0; i < LONG_CHAIN; i++) {
        const jet d = i > 0 ? jet_sub(q[i], q[i - 1]) : q[0];
        V = jet_add(V, jet_add(jet_mul(0.5, jet_sqr(d)), jet_mul(0.25, jet_sqr(jet_sqr(d)))));
    }
    return V;
}

/* A wave enters a chain at rest: what has not been reached has sizes down to 1e-100, and is no obstacle. */
START_TEST(bodies_far_from_a_wave_rest)
{
    tvi_system *system;
    tvi_options options;
    tvi_integrator *integrator;
    double t = 0, q[LONG_CHAIN] = {1}, p[LONG_CHAIN] = {0}, before, after;
    ck_assert_int_eq(tvi_system_potential(&system, LONG_CHAIN, NULL, long_chain, NULL), TVI_OK);
    ck_assert_int_eq(tvi_options_named(product_methods[_i].name, product_methods[_i].order, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_energy(system, 0, q, p, &before), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, 0.05, 40, &t, q, p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(tvi_energy(system, 0, q, p, &after), TVI_OK);
    ck_assert_double_le(fabs(after - before), 1e-5 * before);
    ck_assert_double_gt(fabs(q[5]), 1e-6); /* it moves on */
    ck_assert_int_lt(tvi_integrator_stats(integrator)->passes, 40 * 11);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Steps beyond what the passes can solve end with a status, and leave the state alone: all from 2.0e3 to 2.3e5 days do,
 * with each instruction set; these are far from both ends. */
START_TEST(too_large_steps_are_refused)
{
    const tvi_options options = options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, DEGREE);
    runner solar = runner_open(&problem_solar, &options);
    test_state x = problem_start(&problem_solar);
    const test_state before = x;
    const double steps[] = {6e3, 2e4, 6e4};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        ck_assert_int_ne(tvi_step(solar.integrator, steps[i], &x.t, x.q, x.p), TVI_OK);
        ck_assert_mem_eq(&x, &before, sizeof x);
    }
    runner_steps(&solar, 100, 3, &x);
    runner_close(&solar);
}
END_TEST

Suite *suite_products(void)
{
    Suite *suite = suite_create("products");
    TCase *products = tcase_create("products");
    const int problems = sizeof product_problems / sizeof *product_problems;
    const int methods = sizeof product_methods / sizeof *product_methods;
    tcase_add_loop_test(products, products_are_those_of_the_matrices, 0, problems);
    tcase_add_loop_test(products, many_bodies_move_as_one, 0, methods);
    tcase_add_loop_test(products, bodies_start_at_rest, 0, methods);
    tcase_add_loop_test(products, a_first_step_from_rest_takes_few_passes, 0, methods);
    tcase_add_loop_test(products, bodies_far_from_a_wave_rest, 0, methods);
    tcase_add_test(products, too_large_steps_are_refused);
    suite_add_tcase(suite, products);
    return suite;
}
