/* test_galerkin_lagrangian.c - Tests the Galerkin curve of Lagrangians (docs/method.md sections 4 and 5): against the
 * Hamiltonian form of the same system, its passes, and where it fails. */
#include "generating.h"
#include "models.h"

#include <math.h>
#include <string.h>

static tvi_options galerkin(int nodes) { return kind_options(&kinds[kind_count], nodes); }

static tvi_system *lagrangian_system(int n, tvi_lagrangian_fn *lagrangian, void *ctx)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_lagrangian(&system, n, lagrangian, ctx), TVI_OK);
    return system;
}

/* ---- The Hamiltonian form of the same system --------------------------------------------------------------------- */

/* Bodies on a ring, each coupled to all: L = sum_i v_i^2/2 - (1 + i/8) q_i^2/2 + 2/(5 n) sum_{j < i} v_i v_j cos(q_i -
 * q_j). */
static jet coupled(const jet q[], const jet v[], jet t, void *ctx)
{
    const int n = *(const int *)ctx;
    jet sum = jet_const(0);
    (void)t;
    for (int i = 0; i < n; i++) {
        sum = jet_add(sum, jet_mul(0.5, jet_sub(jet_sqr(v[i]), jet_mul(1 + i / 8.0, jet_sqr(q[i])))));
        for (int j = 0; j < i; j++)
            sum = jet_add(sum, jet_mul(jet_mul(0.4 / n, jet_mul(v[i], v[j])), jet_cos(jet_sub(q[i], q[j]))));
    }
    return sum;
}

/* m v = p - e A of the scene. */
static jet bottle(const jet q[], const jet p[], jet t, void *ctx)
{
    const double m = 0.75, e = 1.25;
    const jet s = jet_mul(e / 2, jet_add(1, jet_sqr(q[2])));
    const jet v[] = {jet_add(p[0], jet_mul(s, q[1])), jet_sub(p[1], jet_mul(s, q[0])), p[2]};
    (void)t, (void)ctx;
    return jet_div(jet_dot(v, v, 3), 2 * m);
}

/* (b p_0^2 - 2 c p_0 p_1 + a p_1^2) / (2 (a b - c^2)) + V of the scene. */
static jet two_pendulums(const jet q[], const jet p[], jet t, void *ctx)
{
    const double m1 = 1, m2 = 0.625, l1 = 1, l2 = 0.75, g = 9.8125, a = (m1 + m2) * l1 * l1, b = m2 * l2 * l2;
    const jet c = jet_mul(m2 * l1 * l2, jet_cos(jet_sub(q[0], q[1])));
    const jet squares = jet_add(jet_mul(b, jet_sqr(p[0])), jet_mul(a, jet_sqr(p[1])));
    const jet kinetic = jet_sub(jet_mul(0.5, squares), jet_mul(c, jet_mul(p[0], p[1])));
    const jet weight = jet_add(jet_mul((m1 + m2) * g * l1, jet_cos(q[0])), jet_mul(m2 * g * l2, jet_cos(q[1])));
    (void)t, (void)ctx;
    return jet_sub(jet_div(kinetic, jet_sub(a * b, jet_sqr(c))), weight);
}

/* The sheared chain is driven: its time shows. */
static const struct {
    const model *lagrangian;
    const model hamiltonian;
    double h;
} twins[] = {
    {&model_double_pendulum, {.n = 2, .hamiltonian = two_pendulums}, 0.0625},
    {&model_magnetic, {.n = 3, .hamiltonian = bottle}, 0.25},
    {&model_sheared_lagrangian, {.n = 3, .hamiltonian = NULL}, 0.125},
};
enum { TWINS = sizeof twins / sizeof *twins, TWIN_STEPS = 20 };

/* Step by step, each from the state of the Lagrangian: sizes that change, too. */
START_TEST(hamiltonian_form_is_the_same)
{
    const model *m = twins[_i % TWINS].lagrangian;
    const bool has_twin = twins[_i % TWINS].hamiltonian.hamiltonian != NULL;
    const tvi_options options = galerkin(1 + _i / TWINS);
    tvi_system *L = model_system(m),
               *H = model_system(has_twin ? &twins[_i % TWINS].hamiltonian : &model_sheared_hamiltonian);
    tvi_integrator *it = integrator_of(L, &options), *other = integrator_of(H, &options);
    test_state x = model_start(m);
    for (int step = 0; step < TWIN_STEPS; step++) {
        const double h = twins[_i % TWINS].h * (step % 5 == 4 ? 0.75 : 1);
        test_state y = x;
        tvi_integrator_reset(other);
        go(it, h, 1, &x);
        go(other, h, 1, &y);
        const double error = distance(m->n, &x, &y);
        ck_assert_msg(error < 3e-15, "%s, %s, step %d: %.1e", m->name, describe(&options), step, error);
    }
    tvi_integrator_free(it);
    tvi_integrator_free(other);
    tvi_system_free(L);
    tvi_system_free(H);
}
END_TEST

/* Against type I at the midpoint, which shares no equation with it, for more degrees of freedom. */
START_TEST(large_systems)
{
    int n = _i;
    const tvi_options options = galerkin(8), midpoint = options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 10);
    tvi_system *system = lagrangian_system(n, coupled, &n);
    tvi_integrator *it = integrator_of(system, &options), *other = integrator_of(system, &midpoint);
    test_state x = {0};
    for (int i = 0; i < n; i++) x.q[i] = sin(i + 1), x.p[i] = cos(2 * i);
    test_state y = x;
    go(it, 0.125, 16, &x);
    go(other, 0.125, 16, &y);
    ck_assert_double_lt(distance(n, &x, &y), 1e-14);
    tvi_integrator_free(it);
    tvi_integrator_free(other);
    tvi_system_free(system);
}
END_TEST

/* ---- The energy of long runs ------------------------------------------------------------------------------------- */

/* A bead on a wire, of p = v / (q^2 + 1) and H = (q^2 + 1)(p^2 + 1)/2. */
static jet bead(const jet q[], const jet v[], jet t, void *ctx)
{
    const jet stretch = jet_add(jet_sqr(q[0]), 1);
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sub(jet_div(jet_sqr(v[0]), stretch), stretch));
}
static const model model_bead = {.name = "bead", .n = 1, .lagrangian = bead};

/* The control ends its passes sooner. Its energy drifts with a ratio above 11.3. */
START_TEST(energy_does_not_drift)
{
    enum { STEPS = 4000 };
    static const struct {
        const model *m;
        double h, tolerance;
    } rows[] = {{&model_double_pendulum, 0.015625, 1e-6}, {&model_bead, 0.125, 3e-3}};
    const model *m = rows[_i % 2].m;
    const double h = rows[_i % 2].h;
    const test_state start = m->scene ? model_start(m) : (test_state){.q = {0.3}, .p = {0.5}};
    tvi_options options = galerkin(7 + _i / 2);
    const sample errors = energy_errors(m, &start, &options, h, STEPS);
    options.tolerance = rows[_i % 2].tolerance;
    const sample biased = energy_errors(m, &start, &options, h, STEPS);
    ck_assert_msg(sample_drift(&errors) < NO_DRIFT, "%s, %d nodes: %g", m->name, options.degree, sample_drift(&errors));
    ck_assert_msg(sample_drift(&biased) > NO_DRIFT, "%s, %d nodes: %g with a tolerance", m->name, options.degree,
                  sample_drift(&biased));
}
END_TEST

/* ---- Passes ------------------------------------------------------------------------------------------------------ */

enum { COUNTED_STEPS = 100 };

static tvi_stats stats_after(const tvi_options *options, bool resets)
{
    tvi_system *system = model_system(&model_magnetic);
    tvi_integrator *it = integrator_of(system, options);
    test_state x = model_start(&model_magnetic);
    for (int i = 0; i < COUNTED_STEPS; i++) {
        if (resets) tvi_integrator_reset(it);
        go(it, 0.0625, 1, &x);
    }
    const tvi_stats stats = *tvi_integrator_stats(it);
    tvi_integrator_free(it);
    tvi_system_free(system);
    return stats;
}

/* A step needs few passes, and one set of second derivatives; without the steps before, a pass and a set more. */
START_TEST(passes_are_few)
{
    const tvi_options options = galerkin(8);
    const tvi_stats stats = stats_after(&options, false), first = stats_after(&options, true);
    ck_assert_int_eq(stats.force_evaluations, 8 * stats.passes + 1);
    ck_assert_int_eq(first.force_evaluations, 8 * first.passes + COUNTED_STEPS);
    ck_assert_int_le(stats.passes, 5 * COUNTED_STEPS);
    ck_assert_int_ge(first.passes - stats.passes, 3 * COUNTED_STEPS / 4);
    ck_assert_int_le(stats.factorisations, 8 * 3 * COUNTED_STEPS / 2);
    ck_assert_int_ge(stats.factorisations, 8 * COUNTED_STEPS);
    ck_assert_int_ge(first.factorisations - stats.factorisations, 8 * COUNTED_STEPS / 2);
}
END_TEST

START_TEST(number_of_passes_is_kept)
{
    tvi_options options = galerkin(4);
    for (int k = 1; k <= 4; k++) {
        options.passes = k;
        const tvi_stats stats = stats_after(&options, false);
        ck_assert_int_eq(stats.passes, COUNTED_STEPS * k);
        ck_assert_int_eq(stats.force_evaluations, COUNTED_STEPS * 4 * k + 1);
    }
    options.passes = 0;
    options.tolerance = 1e-4;
    const tvi_stats loose = stats_after(&options, false);
    ck_assert_int_lt(loose.passes, 2 * COUNTED_STEPS);
    ck_assert_double_le(loose.residual, 1e-4);
}
END_TEST

/* Without passes V and the force are those at the start. */
START_TEST(prediction_goes_straight_on)
{
    tvi_options options = galerkin(3);
    options.passes = TVI_PREDICT_ONLY;
    const model *m = &model_sheared_lagrangian;
    tvi_system *system = model_system(m), *other = model_system(&model_sheared_hamiltonian);
    tvi_integrator *it = integrator_of(system, &options), *plain = integrator_of(other, &options);
    test_state x = model_start(m);
    double v[N_MAX];
    for (int step = 0; step < 3; step++) {
        const test_state start = x;
        test_state y = x;
        go(it, 0.125, 1, &x);
        go(plain, 0.125, 1, &y);
        ck_assert_int_eq(tvi_velocity(system, start.t, start.q, start.p, v), TVI_OK);
        for (int i = 0; i < m->n; i++) ck_assert_double_eq_tol(x.q[i], start.q[i] + 0.125 * v[i], 2e-15);
        ck_assert_double_lt(distance(m->n, &x, &y), 2e-15);
    }
    ck_assert_int_eq(tvi_integrator_stats(it)->passes, 0);
    tvi_integrator_free(it);
    tvi_integrator_free(plain);
    tvi_system_free(system);
    tvi_system_free(other);
}
END_TEST

/* L = v^4/4 - q: L_vv is singular at rest. */
static jet quartic(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(0.25, jet_pow(v[0], 4)), q[0]);
}

/* p = v^3 = -t: q = q0 - (3/4) t^(4/3). No lane is ever at rest, also where there are more lanes than nodes. */
START_TEST(lanes_beyond_the_nodes_follow)
{
    const tvi_options options = galerkin(_i);
    tvi_system *system = lagrangian_system(1, quartic, NULL);
    tvi_integrator *it = integrator_of(system, &options);
    test_state x = {.t = 1, .p = {-1}};
    go(it, 0.0625, 16, &x);
    ck_assert_double_eq_tol(x.p[0], -2, 1e-15);
    if (_i >= 8) ck_assert_double_eq_tol(x.q[0], -0.75 * (pow(2, 4.0 / 3) - 1), 1e-14);
    ck_assert_int_eq(tvi_integrator_stats(it)->force_evaluations, _i * tvi_integrator_stats(it)->passes + 1);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* ---- Where there is no step -------------------------------------------------------------------------------------- */

/* L_vv = (t - 1)^2. */
static jet fading_mass(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)ctx;
    return jet_sub(jet_mul(0.5, jet_sqr(jet_mul(jet_sub(t, 1), v[0]))), q[0]);
}

/* L_vv = log(t). */
static jet logarithmic_mass(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)ctx;
    return jet_sub(jet_mul(0.5, jet_mul(jet_log(t), jet_sqr(v[0]))), q[0]);
}

/* The last of an odd number of nodes at the middle of the step is at t = 1, or before t = 0. */
START_TEST(nodes_without_a_value_fail)
{
    static const struct {
        tvi_lagrangian_fn *lagrangian;
        double t, h;
        tvi_status status;
    } rows[] = {
        {fading_mass, 0.5, 1, TVI_ESINGULAR}, {logarithmic_mass, 2, -4, TVI_EDOMAIN}, {fading_mass, 3, 1, TVI_OK}};
    const tvi_options options = galerkin(1 + 2 * (_i / 3));
    tvi_system *system = lagrangian_system(1, rows[_i % 3].lagrangian, NULL);
    tvi_integrator *it = integrator_of(system, &options);
    test_state x = {.t = rows[_i % 3].t, .q = {0.5}, .p = {0.25}};
    const test_state before = x;
    const tvi_status status = tvi_step(it, rows[_i % 3].h, &x.t, x.q, x.p);
    ck_assert_msg(status == rows[_i % 3].status, "row %d: %s", _i % 3, tvi_status_string(status));
    if (status != TVI_OK) ck_assert_mem_eq(&x, &before, sizeof x);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* The step after one that failed is as if that had not been. */
START_TEST(too_large_steps_fail)
{
    const tvi_options options = galerkin(8);
    tvi_system *system = model_system(&model_double_pendulum);
    tvi_integrator *it = integrator_of(system, &options), *other = integrator_of(system, &options);
    test_state x = model_start(&model_double_pendulum), y = x;
    go(it, 0.0625, 3, &x);
    go(other, 0.0625, 3, &y);
    const test_state before = x;
    ck_assert_int_ne(tvi_step(it, 1e3, &x.t, x.q, x.p), TVI_OK);
    ck_assert_mem_eq(&x, &before, sizeof x);
    go(it, 0.0625, 20, &x);
    go(other, 0.0625, 20, &y);
    ck_assert_mem_eq(&x, &y, sizeof x);
    tvi_integrator_free(it);
    tvi_integrator_free(other);
    tvi_system_free(system);
}
END_TEST

Suite *suite_galerkin_lagrangian(void)
{
    Suite *suite = suite_create("galerkin, Lagrangian");
    TCase *tcase = tcase_create("lagrangian");
    tcase_add_loop_test(tcase, hamiltonian_form_is_the_same, 0, TWINS * TVI_MAX_NODES);
    tcase_add_loop_test(tcase, large_systems, 1, 16);
    tcase_add_loop_test(tcase, energy_does_not_drift, 0, 6);
    tcase_add_test(tcase, passes_are_few);
    tcase_add_test(tcase, number_of_passes_is_kept);
    tcase_add_test(tcase, prediction_goes_straight_on);
    tcase_add_loop_test(tcase, lanes_beyond_the_nodes_follow, 1, TVI_MAX_NODES + 1);
    tcase_add_loop_test(tcase, nodes_without_a_value_fail, 0, 6);
    tcase_add_test(tcase, too_large_steps_fail);
    suite_add_tcase(suite, tcase);
    return suite;
}
