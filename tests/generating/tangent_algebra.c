/* tangent_algebra.c - Tests the tangent map's algebra: maps multiply, columns and steps are alone, invariants are kept,
 * the measure of symplecticity measures, chaos shows. */
#include "tangent.h"

#include <math.h>
#include <string.h>

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

TCase *tcase_tangent_algebra(void)
{
    TCase *tcase = tcase_create("algebra");
    tcase_add_loop_test(tcase, maps_multiply, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, columns_are_alone, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, steps_are_alone, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, momentum_maps_are_kept, 0, all_kinds);
    tcase_add_test(tcase, defect_is_measured);
    tcase_add_test(tcase, chaos_shows);
    return tcase;
}
