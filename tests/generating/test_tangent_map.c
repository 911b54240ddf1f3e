/* test_tangent_map.c - the derivative of a step (docs/method.md section 10): against differences of steps and closed
 * forms, its algebra, and what a step with it leaves alone. That it is symplectic is in test_geometry.c. */
#include "generating.h"
#include "models.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 2 * N_MAX };
typedef double matrix[MOST * MOST]; /* [2n][2n], row after row */

/* max |a - b| relative to the largest element of b, or 1. */
static double matrix_distance(int n, const matrix a, const matrix b)
{
    double largest = 0, size = 1;
    for (int i = 0; i < 4 * n * n; i++) {
        ck_assert(isfinite(a[i]) && isfinite(b[i]));
        largest = fmax(largest, fabs(a[i] - b[i]));
        size = fmax(size, fabs(b[i]));
    }
    return largest / size;
}

static void set_identity(int n, matrix a)
{
    for (int i = 0; i < 4 * n * n; i++) a[i] = i % (2 * n + 1) == 0;
}

static void multiply(int n, const matrix a, const matrix b, matrix c)
{
    const int rows = 2 * n;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < rows; j++) {
            c[i * rows + j] = 0;
            for (int k = 0; k < rows; k++) c[i * rows + j] += a[i * rows + k] * b[k * rows + j];
        }
}

/* A system and an integrator of it. */
typedef struct {
    const model *m;
    tvi_system *system;
    tvi_integrator *integrator;
} runs;

static runs open_runs(const model *m, const tvi_options *options)
{
    runs r = {.m = m, .system = model_system(m)};
    r.integrator = integrator_of(r.system, options);
    return r;
}

static void close_runs(runs *r)
{
    tvi_integrator_free(r->integrator);
    tvi_system_free(r->system);
}

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

/* ---- Algebra ----------------------------------------------------------------------------------------------------- */

static void tangent_step(const runs *r, double h, test_state *x, double D[], int columns)
{
    const tvi_status status = tvi_step_tangent(r->integrator, h, &x->t, x->q, x->p, D, columns);
    ck_assert_msg(status == TVI_OK, "%s: %s", r->m->name, tvi_status_string(status));
}

/* Over two steps of different size D becomes M(h2) M(h1); and for a symmetric method, back again the identity. */
START_TEST(maps_multiply)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    const tvi_options options = kind_options(k, 3);
    runs r = open_runs(m, &options);
    const int n = m->n;
    const double h1 = m->h, h2 = 0.5 * m->h;
    test_state x = model_place(m), y = x;
    matrix D, first, second, product, identity;
    set_identity(n, identity);
    set_identity(n, D);
    tangent_step(&r, h1, &x, D, 2 * n);
    tangent_step(&r, h2, &x, D, 2 * n);
    go_tangent(n, r.integrator, h1, &y, first);
    go_tangent(n, r.integrator, h2, &y, second);
    multiply(n, second, first, product);
    ck_assert_msg(matrix_distance(n, D, product) < 1e-14, "%s, %s", m->name, describe(&options));
    if (k->symmetric) {
        tangent_step(&r, -h2, &x, D, 2 * n);
        tangent_step(&r, -h1, &x, D, 2 * n);
        ck_assert_msg(matrix_distance(n, D, identity) < 1e-14, "%s, %s, back", m->name, describe(&options));
    }
    close_runs(&r);
}
END_TEST

/* A column's result is its own, whatever stands beside it; a power of two comes through exactly, very small and very
 * large columns too; and 0 stays 0. */
START_TEST(columns_are_alone)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    enum { COLUMNS = 4 };
    static const double factor[COLUMNS] = {1, 0x1p-300, 0x1p300, 0};
    const tvi_options options = kind_options(k, 3);
    runs r = open_runs(m, &options);
    const test_state at = model_place(m);
    double alone[MOST], beside[MOST * COLUMNS];
    for (int i = 0; i < 2 * m->n; i++) {
        alone[i] = sin(1 + i);
        for (int j = 0; j < COLUMNS; j++) beside[i * COLUMNS + j] = factor[j] * alone[i];
    }
    test_state x = at, y = at;
    tangent_step(&r, m->h, &x, alone, 1);
    tvi_integrator_reset(r.integrator);
    tangent_step(&r, m->h, &y, beside, COLUMNS);
    for (int i = 0; i < 2 * m->n; i++)
        for (int j = 0; j < COLUMNS; j++)
            ck_assert_msg(beside[i * COLUMNS + j] == factor[j] * alone[i], "%s, %s: column %d", m->name,
                          describe(&options), j);
    close_runs(&r);
}
END_TEST

/* Nothing is carried from step to step: an integrator that knows no step before gives the same D, bit for bit. */
START_TEST(steps_are_alone)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    const tvi_options options = kind_options(k, 3);
    runs r = open_runs(m, &options);
    test_state x = model_place(m);
    double D[MOST] = {1}, other[MOST];
    for (int step = 0; step < 5; step++) {
        runs fresh = open_runs(m, &options);
        test_state y = x;
        memcpy(other, D, sizeof D);
        tangent_step(&r, m->h, &x, D, 1);
        tangent_step(&fresh, m->h, &y, other, 1);
        ck_assert_mem_eq(D, other, sizeof D);
        close_runs(&fresh);
    }
    close_runs(&r);
}
END_TEST

/* The angular momentum L is the same after the step: its gradient there, times M, is its gradient before. Row
 * vectors. */
static double gradient_change(const model *m, const tvi_options *options)
{
    runs r = open_runs(m, options);
    const test_state from = model_place(m);
    test_state to = from;
    matrix M;
    go_tangent(2, r.integrator, m->h, &to, M);
    const double before[] = {from.p[1], -from.p[0], -from.q[1], from.q[0]},
                 after[] = {to.p[1], -to.p[0], -to.q[1], to.q[0]};
    double largest = 0;
    for (int column = 0; column < 4; column++) {
        double sum = -before[column];
        for (int row = 0; row < 4; row++) sum += after[row] * M[row * 4 + column];
        largest = fmax(largest, fabs(sum));
    }
    close_runs(&r);
    return largest;
}

START_TEST(momentum_maps_are_kept)
{
    const tvi_options options = kind_options(&kinds[_i], 3), taylor = options_taylor(4);
    ck_assert_double_lt(gradient_change(&model_kepler, &options), 1e-14);
    ck_assert_double_gt(gradient_change(&model_kepler, &taylor), 1e-8);
}
END_TEST

/* The measure of symplecticity sees a part in 10^9. */
START_TEST(defect_is_measured)
{
    const tvi_options options = options_verlet();
    runs r = open_runs(&model_kepler, &options);
    test_state x = model_place(&model_kepler);
    matrix M;
    go_tangent(2, r.integrator, 0.1, &x, M);
    for (int i = 8; i < 16; i++) M[i] *= 1 + 1e-9;
    ck_assert_double_eq_tol(symplectic_defect(2, M), 1e-9, 1e-14);
    close_runs(&r);
}
END_TEST

/* ln(d/d_0)/t of a tangent vector: large on a chaotic orbit, ln(t)/t on a regular one, where d grows like t. */
static double exponent(const double q[2], const double p[2])
{
    const double t_end = 2000;
    tvi_system *system;
    tvi_integrator *integrator;
    double t = 0, x[4] = {q[0], q[1], p[0], p[1]}, D[4] = {0.5, 0.5, 0.5, 0.5}, square = 0;
    ck_assert_int_eq(scene_system(&scene_henon_heiles_8, &system), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    while (t < t_end) ck_assert_int_eq(tvi_step_tangent(integrator, 0.5, &t, x, x + 2, D, 1), TVI_OK);
    for (int i = 0; i < 4; i++) square += D[i] * D[i];
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return 0.5 * log(square) / t;
}

START_TEST(chaos_shows)
{
    const double q[] = {0, 0.375}, p[] = {0.375, 0.0625}; /* regular, of the same energy */
    const double of_regular = exponent(q, p), of_chaotic = exponent(scene_henon_heiles_8.q, scene_henon_heiles_8.p);
    ck_assert(of_regular > 0.002 && of_regular < 0.004);
    ck_assert(of_chaotic > 0.015 && of_chaotic < 0.15);
}
END_TEST

/* ---- The step itself --------------------------------------------------------------------------------------------- */

static bool same_bits(int n, const test_state *a, const test_state *b)
{
    const size_t bytes = (size_t)n * sizeof *a->q;
    return memcmp(&a->t, &b->t, sizeof a->t) == 0 && memcmp(a->q, b->q, bytes) == 0 && memcmp(a->p, b->p, bytes) == 0;
}

/* Bit for bit what tvi_step makes, step after step, the low-order parts, dense output and counts too. */
START_TEST(step_is_the_step)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    const tvi_options options = kind_options(k, 4);
    runs plain = open_runs(m, &options), with = open_runs(m, &options);
    test_state x = model_place(m), y = x;
    double D[MOST] = {1};
    for (int step = 0; step < 10; step++) {
        test_state dense_x = x, dense_y = y;
        go(plain.integrator, m->h, 1, &x);
        tangent_step(&with, m->h, &y, D, 1);
        ck_assert_msg(same_bits(m->n, &x, &y), "%s, %s: step %d", m->name, describe(&options), step);
        ck_assert_int_eq(tvi_dense(plain.integrator, 0.3, dense_x.q, dense_x.p), TVI_OK);
        ck_assert_int_eq(tvi_dense(with.integrator, 0.3, dense_y.q, dense_y.p), TVI_OK);
        ck_assert(same_bits(m->n, &dense_x, &dense_y));
    }
    tvi_stats a = *tvi_integrator_stats(plain.integrator), b = *tvi_integrator_stats(with.integrator);
    ck_assert_uint_gt(b.bytes, a.bytes);
    a.bytes = b.bytes = 0;
    ck_assert_mem_eq(&a, &b, sizeof a);
    close_runs(&plain);
    close_runs(&with);
}
END_TEST

/* On failure t, q, p and D are what they were, and the run goes on as if nothing had been asked. */
static void check_failure(const runs *r, double h, const test_state *at, double D[], int columns, tvi_status expected)
{
    test_state x = *at;
    double before[MOST * 2];
    const size_t bytes = columns > 0 ? 2 * (size_t)r->m->n * (size_t)columns * sizeof *D : 0;
    if (D) memcpy(before, D, bytes);
    ck_assert_int_eq(tvi_step_tangent(r->integrator, h, &x.t, x.q, x.p, D, columns), expected);
    ck_assert(same_bits(r->m->n, &x, at));
    if (D) ck_assert_mem_eq(before, D, bytes);
    double q[N_MAX], p[N_MAX];
    ck_assert_int_eq(tvi_dense(r->integrator, 0.5, q, p), TVI_EINVAL);
}

START_TEST(failures_leave_all_as_it_was)
{
    const model *m = &model_kepler;
    const tvi_options options = kind_options(&kinds[_i], 4);
    runs r = open_runs(m, &options), undisturbed = open_runs(m, &options);
    test_state x = model_start(m), y = x;
    double D[] = {1, 2, 0, 1, 0, 3, 1, -1}, huge[] = {1e308, 1, -1e308, 1, 1e308, 1, 1e308, 1};
    double nan[] = {1, 2, 0, 1, 0, NAN, 1, -1}, infinite[] = {1, 2, 0, 1, 0, 3, 1, INFINITY};
    go(r.integrator, m->h, 3, &x);
    go(undisturbed.integrator, m->h, 3, &y);
    const test_state at = x;
    check_failure(&r, m->h, &at, NULL, 2, TVI_EINVAL);
    check_failure(&r, m->h, &at, D, 0, TVI_EINVAL);
    check_failure(&r, m->h, &at, D, -1, TVI_EINVAL);
    check_failure(&r, 0, &at, D, 2, TVI_EINVAL);
    check_failure(&r, NAN, &at, D, 2, TVI_EINVAL);
    check_failure(&r, m->h, &at, nan, 2, TVI_ENONFINITE);
    check_failure(&r, m->h, &at, infinite, 2, TVI_ENONFINITE);
    ck_assert_int_eq(tvi_step_tangent(r.integrator, 1e300, &x.t, x.q, x.p, D, 2) == TVI_OK, false);
    ck_assert_int_eq(tvi_step_tangent(r.integrator, m->h, NULL, x.q, x.p, D, 2), TVI_EINVAL);
    ck_assert_int_eq(tvi_step_tangent(r.integrator, m->h, &x.t, NULL, x.p, D, 2), TVI_EINVAL);
    ck_assert_int_eq(tvi_step_tangent(r.integrator, m->h, &x.t, x.q, NULL, D, 2), TVI_EINVAL);
    ck_assert_int_eq(tvi_step_tangent(NULL, m->h, &x.t, x.q, x.p, D, 2), TVI_EINVAL);
    x.q[0] = NAN;
    ck_assert_int_eq(tvi_step_tangent(r.integrator, m->h, &x.t, x.q, x.p, D, 2), TVI_ENONFINITE);
    x = at;
    check_failure(&r, 0.5, &at, huge, 2, TVI_ENONFINITE);
    for (int step = 0; step < 3; step++) {
        tangent_step(&r, m->h, &x, D, 2);
        go(undisturbed.integrator, m->h, 1, &y);
    }
    ck_assert(same_bits(m->n, &x, &y));
    close_runs(&r);
    close_runs(&undisturbed);
}
END_TEST

Suite *suite_tangent_map(void)
{
    Suite *suite = suite_create("tangent map");
    TCase *tcase = tcase_create("tangent map");
    tcase_set_timeout(tcase, 240);
    tcase_add_loop_test(tcase, map_is_the_derivative_of_the_step, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, map_of_other_methods, 0, MODELS);
    tcase_add_loop_test(tcase, verlet_on_the_chain, 0, 2);
    tcase_add_loop_test(tcase, midpoint_rule_on_the_oscillator, 0, 2);
    tcase_add_loop_test(tcase, masses_reach_the_lift, 0, all_kinds + 2);
    tcase_add_loop_test(tcase, maps_multiply, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, columns_are_alone, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, steps_are_alone, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, momentum_maps_are_kept, 0, all_kinds);
    tcase_add_test(tcase, defect_is_measured);
    tcase_add_test(tcase, chaos_shows);
    tcase_add_loop_test(tcase, step_is_the_step, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, failures_leave_all_as_it_was, 0, all_kinds);
    suite_add_tcase(suite, tcase);
    return suite;
}
