/* test_tangent_map.c - Tests the derivative of a step (docs/method.md section 10) against differences of steps and
 * closed forms; its algebra and the step itself are in files of their own. That it is symplectic is in test_geometry.c.
 */
#include "generating.h"
#include "tangent.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Differences of steps ---------------------------------------------------------------------------------------- */

enum { STENCIL = 6 };

/* f' = sum_s w_s (f(s d) - f(-s d)) / (2 d) + O(d^12), w_s = 1/s prod_{j != s} j^2 / (j^2 - s^2). */
static double stencil_weight(int s)
{
    double w = 1.0 / s;
    for (int j = 1; j <= STENCIL; j++)
        if (j != s) w *= (double)(j * j) / (j * j - s * s);
    return w;
}

static void differentiate(const runs *r, double h, const test_state *at, matrix M)
{
    const int n = r->m->n;
    const double d = 0.1 * r->m->h;
    memset(M, 0, sizeof(matrix));
    for (int column = 0; column < 2 * n; column++)
        for (int s = -STENCIL; s <= STENCIL; s++) {
            if (s == 0) continue;
            test_state x = *at;
            *(column < n ? &x.q[column] : &x.p[column - n]) += s * d;
            tvi_integrator_reset(r->integrator);
            go(r->integrator, h, 1, &x);
            const double factor = (s > 0 ? 1 : -1) * stencil_weight(abs(s)) / (2 * d);
            for (int i = 0; i < n; i++) {
                M[i * 2 * n + column] += factor * x.q[i];
                M[(n + i) * 2 * n + column] += factor * x.p[i];
            }
        }
}

static void check_differences(const model *m, const tvi_options *options)
{
    tvi_system *system = model_system(m);
    const bool serves = tvi_options_check(system, options, NULL) == TVI_OK;
    tvi_system_free(system);
    if (!serves) return;
    runs r = open_runs(m, options);
    const test_state at = model_place(m);
    test_state x = at;
    matrix M, differences;
    go_tangent(m->n, r.integrator, m->h, &x, M);
    differentiate(&r, m->h, &at, differences);
    const double error = matrix_distance(m->n, M, differences);
    ck_assert_msg(error < 2e-11, "%s, %s, %d passes: %.1e", m->name, describe(options), options->passes, error);
    close_runs(&r);
}

/* Also with a quadrature that is too poor, and of the composition with the adjoint; and after one pass, or none, unless
 * the lift of a separable system has another predictor than the system. */
START_TEST(map_is_the_derivative_of_the_step)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    const bool predicts_alike = !m->problem || k->expansion == TVI_AT_START || k->expansion == TVI_AT_NODES;
    if (!kind_serves(k, m)) return;
    for (int degree = 1; degree <= 3; degree++) {
        tvi_options options = kind_options(k, degree);
        check_differences(m, &options);
        options.compose_adjoint = true;
        check_differences(m, &options);
        options.compose_adjoint = false;
        for (int passes = TVI_PREDICT_ONLY; predicts_alike && passes <= 1; passes += 2) {
            options.passes = passes;
            check_differences(m, &options);
        }
        if (k->expansion == TVI_AT_NODES) continue;
        options = kind_options_with(k, degree, TVI_RECTANGLE_END, 1);
        check_differences(m, &options);
    }
}
END_TEST

START_TEST(map_of_other_methods)
{
    const tvi_options taylor = options_taylor(5), verlet = options_verlet();
    check_differences(models[_i], &taylor);
    check_differences(models[_i], &verlet);
}
END_TEST

/* ---- Closed forms ------------------------------------------------------------------------------------------------ */

/* Stormer-Verlet on the chain: with k_i = -V''(q_i) at the ends of the step,
 *     M = [ I + h^2/2 m^-1 k_0,  h m^-1 ;  h/2 (k_0 + k_1 + h^2/2 k_1 m^-1 k_0),  I + h^2/2 k_1 m^-1 ].
 * Type I with the trapezoid, truncated, N = 1, is the same map. */
static void verlet_map(const test_state *from, const test_state *to, double h, matrix M)
{
    enum { N = 3 };
    static const double mass[N] = {1, 2.5, 0.4};
    long double at[2][N], k[2][N * N];
    for (int i = 0; i < N; i++) at[0][i] = from->q[i], at[1][i] = to->q[i];
    for (int end = 0; end < 2; end++) chain_hessian(at[end], k[end]);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            long double product = 0;
            for (int l = 0; l < N; l++) product += k[1][i * N + l] * k[0][l * N + j] / mass[l];
            M[i * 2 * N + j] = (i == j) - (double)(h * h / 2 * k[0][i * N + j] / mass[i]);
            M[i * 2 * N + N + j] = i == j ? h / mass[i] : 0;
            M[(N + i) * 2 * N + j] = (double)(h / 2 * (h * h / 2 * product - k[0][i * N + j] - k[1][i * N + j]));
            M[(N + i) * 2 * N + N + j] = (i == j) - (double)(h * h / 2 * k[1][i * N + j] / mass[j]);
        }
}

START_TEST(verlet_on_the_chain)
{
    tvi_options options = options_verlet();
    if (_i == 1) options = options_type1(TVI_AT_START, TVI_NODES_TRUNCATED, 1), options.quadrature = TVI_TRAPEZOID;
    runs r = open_runs(&model_chain, &options);
    const test_state from = model_place(&model_chain);
    test_state to = from;
    matrix M, exact;
    go_tangent(3, r.integrator, 0.1, &to, M);
    verlet_map(&from, &to, 0.1, exact);
    ck_assert_double_lt(matrix_distance(3, M, exact), 4 * DBL_EPSILON);
    close_runs(&r);
}
END_TEST

static const double oscillator_mass = 2.5, oscillator_spring = 4;

static void oscillator_force(const jet q[], jet t, jet force[], void *ctx)
{
    (void)t, (void)ctx;
    force[0] = jet_mul(-oscillator_spring, q[0]);
}

/* The implicit midpoint rule on q' = p/m, p' = -k q, with c = h^2 k / (4 m): M = [1 - c, h/m; -h k, 1 - c] / (1 +
 * c). */
START_TEST(midpoint_rule_on_the_oscillator)
{
    const double h = 0.3, c = h * h * oscillator_spring / (4 * oscillator_mass);
    const matrix exact = {(1 - c) / (1 + c), h / oscillator_mass / (1 + c), -h * oscillator_spring / (1 + c),
                          (1 - c) / (1 + c)};
    const tvi_options poincare = {.method = TVI_POINCARE, .expansion = TVI_AT_MIDPOINT, .order = 2};
    const tvi_options galerkin = {.method = TVI_TYPE1, .expansion = TVI_AT_NODES, .order = 2};
    tvi_system *system;
    ck_assert_int_eq(tvi_system_force(&system, 1, &oscillator_mass, oscillator_force, NULL), TVI_OK);
    tvi_integrator *integrator = integrator_of(system, _i ? &galerkin : &poincare);
    test_state x = {.q = {0.7}, .p = {-0.3}};
    matrix M;
    go_tangent(1, integrator, h, &x, M);
    ck_assert_double_lt(matrix_distance(1, M, exact), 4 * DBL_EPSILON);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Masses of which none is 1. */
static jet heavy(const jet q[], const jet p[], jet t, void *ctx)
{
    static const double mass[] = {3, 0.4};
    (void)t, (void)ctx;
    jet kinetic[2];
    for (int i = 0; i < 2; i++) kinetic[i] = jet_div(jet_sqr(p[i]), 2 * mass[i]);
    return jet_add(jet_sum(kinetic, 2), jet_mul(jet_cosh(q[0]), jet_exp(q[1])));
}

START_TEST(masses_reach_the_lift)
{
    const model m = {.name = "heavy", .n = 2, .with = WITH_ALL, .hamiltonian = heavy, .h = 0.1};
    const tvi_options options = _i < all_kinds    ? kind_options(&kinds[_i], 3)
                                : _i == all_kinds ? options_taylor(5)
                                                  : options_verlet();
    check_differences(&m, &options);
}
END_TEST

static TCase *tcase_tangent_derivative(void)
{
    TCase *tcase = tcase_create("derivative");
    tcase_add_loop_test(tcase, map_is_the_derivative_of_the_step, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, map_of_other_methods, 0, MODELS);
    tcase_add_loop_test(tcase, verlet_on_the_chain, 0, 2);
    tcase_add_loop_test(tcase, midpoint_rule_on_the_oscillator, 0, 2);
    tcase_add_loop_test(tcase, masses_reach_the_lift, 0, all_kinds + 2);
    return tcase;
}

Suite *suite_tangent_map(void)
{
    Suite *suite = suite_create("tangent map");
    suite_add_tcase(suite, tcase_tangent_derivative());
    suite_add_tcase(suite, tcase_tangent_algebra());
    suite_add_tcase(suite, tcase_tangent_steps());
    return suite;
}
