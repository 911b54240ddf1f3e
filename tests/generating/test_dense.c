/* test_dense.c - Tests dense output: the ends of the step, the order between them, continuity. With a curve of degree N
 * the error of one step's inner points is O(h^(N+1)) in q and O(h^N) in p (O(h^2) for N = 1), Poincare O(h^(K+1)) in
 * both (O(h^2) for K = 0): the curve's own, whatever the order of the method. The Galerkin curve O(h^(N+1)) in both,
 * and O(h^(N+2)) in q of a separable system. */
#include "generating.h"
#include "models.h"
#include "method/method.h"

#include <math.h>
#include <string.h>

static void dense(tvi_integrator *integrator, double theta, test_state *x)
{
    ck_assert_int_eq(tvi_dense(integrator, theta, x->q, x->p), TVI_OK);
}

/* Taylor and Stormer-Verlet, then every generating function, and composed. */
enum { TAYLOR, VERLET, OTHERS };
static int methods(void) { return OTHERS + 2 * all_kinds; }

static bool method_options(int method, int degree, const model *m, tvi_options *options)
{
    const int which = method - OTHERS;
    const kind *k = which < 0 ? NULL : &kinds[which % all_kinds];
    if (method == TAYLOR) *options = options_taylor(degree + 1);
    else if (method == VERLET) *options = options_verlet();
    else *options = kind_options(k, degree - 1 + kind_least_degree(k));
    options->compose_adjoint = which >= all_kinds;
    return method == TAYLOR ? true : method == VERLET ? m->problem != NULL : kind_serves(k, m);
}

/* ---- The ends ---------------------------------------------------------------------------------------------------- */

static bool same(int n, const test_state *a, const test_state *b)
{
    const size_t bytes = (size_t)n * sizeof *a->q;
    return memcmp(a->q, b->q, bytes) == 0 && memcmp(a->p, b->p, bytes) == 0;
}

START_TEST(ends_are_the_states)
{
    const model *m = models[_i / methods()];
    tvi_options options;
    if (!method_options(_i % methods(), 3, m, &options)) return;
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, &options);
    test_state x = model_start(m), at = {0};
    for (int step = 0; step < 10; step++) {
        const test_state before = x;
        go(integrator, step % 3 == 2 ? -m->h : m->h, 1, &x);
        dense(integrator, 0, &at);
        ck_assert_msg(same(m->n, &at, &before), "%s, %s: theta = 0", m->name, describe(&options));
        dense(integrator, 1, &at);
        ck_assert_msg(same(m->n, &at, &x), "%s, %s: theta = 1", m->name, describe(&options));
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Near the ends, and where the halves of a composition meet. */
START_TEST(output_is_continuous)
{
    static const double places[][2] = {{0, 1e-9}, {0.3, 0.3 + 1e-9}, {0.5, 0.5 + 1e-9}, {1, 1 - 1e-9}};
    const model *m = models[_i / methods()];
    tvi_options options;
    if (!method_options(_i % methods(), 3, m, &options)) return;
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, &options);
    test_state x = model_start(m), a = {0}, b = {0};
    go(integrator, m->h, 2, &x);
    for (int i = 0; i < 4; i++) {
        dense(integrator, places[i][0], &a);
        dense(integrator, places[i][1], &b);
        ck_assert_msg(distance(m->n, &a, &b) < 1e-8, "%s, %s at %g", m->name, describe(&options), places[i][0]);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* A composition has the output of its halves. */
START_TEST(composition_has_the_output_of_its_halves)
{
    static const double places[] = {0.1, 0.3, 0.45, 0.55, 0.7, 0.95};
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    tvi_system *system = model_system(m);
    const tvi_options first = kind_options(k, 2), second = tvi_adjoint_options(&first);
    tvi_options composed = first;
    composed.compose_adjoint = true;
    tvi_integrator *whole = integrator_of(system, &composed),
                   *half[] = {integrator_of(system, &first), integrator_of(system, &second)};
    test_state x = model_start(m), y = x, a = {0}, b = {0};
    go(whole, m->h, 1, &x);
    for (int i = 0; i < 2; i++) go(half[i], m->h / 2, 1, &y);
    for (int i = 0; i < 6; i++) {
        dense(whole, places[i], &a);
        dense(half[i / 3], 2 * places[i] - i / 3, &b);
        ck_assert_msg(distance(m->n, &a, &b) < 1e-14, "%s, %s at %g", m->name, describe(&composed), places[i]);
    }
    tvi_integrator_free(whole);
    for (int i = 0; i < 2; i++) tvi_integrator_free(half[i]);
    tvi_system_free(system);
}
END_TEST

/* ---- The order --------------------------------------------------------------------------------------------------- */

/* The solution from *x at time t, by a method of order 16. */
static void follow(tvi_integrator *fine, double t, test_state *x)
{
    enum { STEPS = 6 };
    tvi_integrator_reset(fine);
    go(fine, (t - x->t) / STEPS, STEPS, x);
}

/* The largest error at inner points of one step of size h. */
static two_errors error_inside(const model *m, tvi_integrator *integrator, tvi_integrator *fine, double h)
{
    two_errors error = {0, 0};
    test_state x = model_start(m), at = {0};
    x.q[0] += 0.1;
    x.p[0] += 0.05;
    test_state exact = x;
    tvi_integrator_reset(integrator);
    go(integrator, h, 1, &x);
    for (int point = 1; point < 8; point++) {
        dense(integrator, point / 8.0, &at);
        follow(fine, model_start(m).t + point / 8.0 * h, &exact);
        const two_errors now = state_difference(m->n, &at, &exact);
        error = (two_errors){fmax(error.q, now.q), fmax(error.p, now.p)};
    }
    return error;
}

static const model *const order_models[] = {&model_kepler, &model_magnetic, &model_sheared_hamiltonian};
enum { ORDER_MODELS = sizeof order_models / sizeof *order_models, DEGREES = 4 };

static double larger_degree(double degree, double least) { return fmax(degree, least); }

/* The exponents of h in q and p. */
static two_errors exponents(const model *m, const tvi_options *options)
{
    const int N = options->degree;
    if (options->expansion == TVI_AT_NODES) return (two_errors){N + (m->problem ? 2 : 1), N + 1};
    if (options->method == TVI_STORMER_VERLET) return (two_errors){3, 3};
    if (options->method == TVI_POINCARE) return (two_errors){larger_degree(N + 1, 2), larger_degree(N + 1, 2)};
    return (two_errors){N + 1, larger_degree(N, 2)};
}

START_TEST(inner_points_have_the_order_of_the_curve)
{
    const model *m = order_models[_i / methods()];
    const kind midpoint = {TVI_TYPE1, TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, true};
    const tvi_options fine_options = kind_options(&midpoint, 8);
    tvi_system *system = model_system(m);
    tvi_integrator *fine = integrator_of(system, &fine_options);
    const bool galerkin = _i % methods() >= OTHERS &&
                          (_i % methods() - OTHERS) % all_kinds == kind_count; /* wanders before roundoff at 4 */
    const int most = _i % methods() == VERLET ? 1 : galerkin ? DEGREES - 1 : DEGREES;
    for (int degree = 1; degree <= most; degree++) {
        tvi_options options;
        if (!method_options(_i % methods(), degree, m, &options)) break;
        tvi_integrator *integrator = integrator_of(system, &options);
        const double part[] = {0.1, 0.25, 0.5, 1}, h = part[degree - 1] * m->h, ratio = 0.5;
        const two_errors coarse = error_inside(m, integrator, fine, h),
                         less = error_inside(m, integrator, fine, ratio * h);
        const two_errors expected = exponents(m, &options);
        const double q = log(less.q / coarse.q) / log(ratio), p = log(less.p / coarse.p) / log(ratio);
        ck_assert_msg(fabs(q - expected.q) < 0.45 && fabs(p - expected.p) < 0.45,
                      "%s, %s: %.2f in q, %.2f in p (errors %.1e, %.1e)", m->name, describe(&options), q, p, less.q,
                      less.p);
        tvi_integrator_free(integrator);
    }
    tvi_integrator_free(fine);
    tvi_system_free(system);
}
END_TEST

/* ---- When there is none ------------------------------------------------------------------------------------------ */

static jet root(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sqrt(q[0]);
}

static void check_refusal(tvi_integrator *integrator, double theta)
{
    double q = 3, p = 4;
    ck_assert_int_eq(tvi_dense(integrator, theta, &q, &p), TVI_EINVAL);
    ck_assert_double_eq(q, 3);
    ck_assert_double_eq(p, 4);
}

START_TEST(no_output_without_a_step)
{
    const model *m = &model_pendulum;
    tvi_options options;
    if (!method_options(_i, 3, m, &options)) return;
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, root, NULL), TVI_OK);
    tvi_integrator *integrator = integrator_of(system, &options);
    test_state x = {.q = {1}, .p = {0.5}}, outside = {.q = {-1}};
    double q, p;
    check_refusal(integrator, 0.5);
    go(integrator, 0.0625, 1, &x);
    ck_assert_int_eq(tvi_dense(integrator, 0.5, &q, &p), TVI_OK);
    check_refusal(integrator, -0.001);
    check_refusal(integrator, 1.001);
    check_refusal(integrator, NAN);
    ck_assert_int_eq(tvi_dense(integrator, 0.5, NULL, &p), TVI_EINVAL);
    ck_assert_int_eq(tvi_dense(integrator, 0.5, &q, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_dense(NULL, 0.5, &q, &p), TVI_EINVAL);
    ck_assert_int_eq(tvi_step(integrator, 0.0625, &outside.t, outside.q, outside.p), TVI_EDOMAIN);
    check_refusal(integrator, 0.5);
    go(integrator, 0.0625, 1, &x);
    ck_assert_int_eq(tvi_dense(integrator, 0.5, &q, &p), TVI_OK);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

Suite *suite_dense(void)
{
    Suite *suite = suite_create("dense");
    TCase *tcase = tcase_create("dense");
    tcase_add_loop_test(tcase, ends_are_the_states, 0, MODELS * methods());
    tcase_add_loop_test(tcase, output_is_continuous, 0, MODELS * methods());
    tcase_add_loop_test(tcase, composition_has_the_output_of_its_halves, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, inner_points_have_the_order_of_the_curve, 0, ORDER_MODELS * methods());
    tcase_add_loop_test(tcase, no_output_without_a_step, 0, methods());
    suite_add_tcase(suite, tcase);
    return suite;
}
