/* test_adjoints.c - Tests the adjoint Phi*_h = (Phi_-h)^-1 of every method, with explicit time Phi*_{h,t} =
 * (Phi_{-h,t+h})^-1, the composition with it, and the symmetry of the methods that are their own adjoints
 * (docs/method.md section 4). */
#include "generating.h"
#include "models.h"
#include "method/method.h"

#include <math.h>

static const struct {
    tvi_quadrature quadrature;
    int points;
} rules[] = {{TVI_QUADRATURE_AUTO, 0}, {TVI_GAUSS, 1},           {TVI_LOBATTO, 3},
             {TVI_TRAPEZOID, 2},       {TVI_RECTANGLE_START, 1}, {TVI_RECTANGLE_END, 1}};
enum { RULES = sizeof rules / sizeof *rules, DEGREES = 4 };

/* Away from any symmetry of the start. */
static test_state somewhere(const model *m)
{
    test_state x = model_start(m);
    x.q[0] += 0.1;
    x.p[m->n - 1] += 0.05;
    return x;
}

static void step_with(const tvi_system *system, const tvi_options *options, double h, test_state *x)
{
    tvi_integrator *integrator = integrator_of(system, options);
    go(integrator, h, 1, x);
    tvi_integrator_free(integrator);
}

/* ---- Adjoints ---------------------------------------------------------------------------------------------------- */

/* How far `back` after a step of -h comes from where it started. */
static double missed(const model *m, double h, const tvi_options *options, const tvi_options *back)
{
    tvi_system *system = model_system(m);
    test_state x = somewhere(m);
    x.t += h;
    const test_state start = x;
    step_with(system, options, -h, &x);
    ck_assert_double_gt(distance(m->n, &x, &start), 1e-3);
    step_with(system, back, h, &x);
    ck_assert_double_eq_tol(x.t, start.t, 1e-15);
    tvi_system_free(system);
    return distance(m->n, &x, &start);
}

START_TEST(adjoint_undoes_the_step_back)
{
    const kind *k = &kinds[_i % kind_count];
    const model *m = models[_i / kind_count];
    if (!kind_serves(k, m)) return;
    for (int degree = 1; degree <= DEGREES; degree++)
        for (int rule = 0; rule < RULES; rule++) {
            const tvi_options options = kind_options_with(k, degree, rules[rule].quadrature, rules[rule].points);
            const tvi_options adjoint = tvi_adjoint_options(&options);
            const double error = missed(m, m->h, &options, &adjoint);
            ck_assert_msg(error < 1e-13, "%s, %s then %s: %.1e", m->name, describe(&options), describe(&adjoint),
                          error);
        }
}
END_TEST

/* The same method over a longer step, or the adjoint without its mirrored quadrature, does not. */
START_TEST(no_other_does)
{
    const kind *k = &kinds[_i % kind_count];
    const model *m = models[_i / kind_count];
    if (!kind_serves(k, m)) return;
    const tvi_options plain = kind_options_with(k, 2, TVI_RECTANGLE_START, 1);
    const tvi_options options = kind_options(k, 2);
    tvi_options wrong = tvi_adjoint_options(&plain);
    wrong.quadrature = TVI_RECTANGLE_START;
    ck_assert_msg(missed(m, m->h, &plain, &wrong) > 1e-8, "%s, %s, not mirrored", m->name, describe(&plain));
    if (!k->symmetric)
        ck_assert_msg(missed(m, 3 * m->h, &options, &options) > 1e-8, "%s, %s", m->name, describe(&options));
}
END_TEST

/* ---- The composition --------------------------------------------------------------------------------------------- */

START_TEST(composition_is_half_a_step_and_half_of_the_adjoint)
{
    const kind *k = &kinds[_i % kind_count];
    const model *m = models[_i / kind_count];
    if (!kind_serves(k, m)) return;
    for (int degree = 1; degree <= DEGREES; degree++)
        for (int rule = 0; rule < RULES; rule++) {
            tvi_options options = kind_options_with(k, degree, rules[rule].quadrature, rules[rule].points);
            const tvi_options adjoint = tvi_adjoint_options(&options);
            tvi_system *system = model_system(m);
            test_state halves = somewhere(m), whole = halves;
            step_with(system, &options, m->h / 2, &halves);
            step_with(system, &adjoint, m->h / 2, &halves);
            options.compose_adjoint = true;
            step_with(system, &options, m->h, &whole);
            ck_assert_double_eq_tol(whole.t, halves.t, 1e-15);
            const double error = distance(m->n, &whole, &halves);
            ck_assert_msg(error < 1e-14, "%s, %s: %.1e", m->name, describe(&options), error);
            tvi_system_free(system);
        }
}
END_TEST

/* ---- There and back again ---------------------------------------------------------------------------------------- */

/* After many steps of h and as many of -h. */
static double return_error(const model *m, const tvi_options *options)
{
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = integrator_of(system, options);
    const test_state start = somewhere(m);
    test_state x = start;
    go(integrator, m->h, m->steps, &x);
    ck_assert_double_gt(distance(m->n, &x, &start), 1e-3);
    go(integrator, -m->h, m->steps, &x);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    ck_assert_double_eq_tol(x.t, start.t, 1e-13);
    return distance(m->n, &x, &start);
}

/* Symmetric methods as they are, the others with their adjoints. */
START_TEST(symmetric_methods_return)
{
    const kind *k = &kinds[_i % all_kinds];
    const model *m = models[_i / all_kinds];
    if (!kind_serves(k, m)) return;
    for (int degree = kind_least_degree(k); degree < DEGREES; degree++) {
        tvi_options options = kind_options(k, degree);
        options.compose_adjoint = !k->symmetric;
        const double error = return_error(m, &options);
        ck_assert_msg(error < 1.5e-13, "%s, %s: %.1e", m->name, describe(&options), error);
    }
}
END_TEST

START_TEST(others_do_not)
{
    const kind *k = &kinds[_i % kind_count];
    const model *m = models[_i / kind_count];
    if (!kind_serves(k, m)) return;
    tvi_options options = kind_options_with(k, 2, k->symmetric ? TVI_RECTANGLE_END : TVI_QUADRATURE_AUTO, 0);
    const double error = return_error(m, &options);
    ck_assert_msg(error > 1e-10, "%s, %s: %.1e", m->name, describe(&options), error);
}
END_TEST

Suite *suite_adjoints(void)
{
    Suite *suite = suite_create("adjoints");
    TCase *tcase = tcase_create("adjoints");
    tcase_add_loop_test(tcase, adjoint_undoes_the_step_back, 0, MODELS * kind_count);
    tcase_add_loop_test(tcase, no_other_does, 0, MODELS * kind_count);
    tcase_add_loop_test(tcase, composition_is_half_a_step_and_half_of_the_adjoint, 0, MODELS * kind_count);
    tcase_add_loop_test(tcase, symmetric_methods_return, 0, MODELS * all_kinds);
    tcase_add_loop_test(tcase, others_do_not, 0, MODELS * kind_count);
    suite_add_tcase(suite, tcase);
    return suite;
}
