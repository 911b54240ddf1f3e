/* test_spark_quad.c - Tests steps on constraints in quadruple precision: those of the library against their definition,
 * and of the definition itself its order, the symplectic form and reversal (gcc only). */
#include "constraints.h"
#include "spark_quad.h"

#include <math.h>
#include <quadmath.h>
#include <string.h>

enum { NODES_MOST = 8, REFERENCE_NODES = SPARK_NODES };

/* The largest difference of two states' coordinates or momenta; NAN where one is. */
static double between(const spark_problem *of, const spark_state *x, const spark_state *y)
{
    quad most = 0;
    for (int i = 0; i < of->n; i++) {
        const quad in_q = fabsq(x->q[i] - y->q[i]), in_p = fabsq(x->p[i] - y->p[i]);
        if (isnanq(in_q) || isnanq(in_p)) return NAN; /* which fmaxq leaves out */
        most = fmaxq(most, fmaxq(in_q, in_p));
    }
    return (double)most;
}

static spark_state after(const spark_problem *of, const spark_method *method, quad duration, int steps)
{
    spark_state x = spark_start(of);
    for (int step = 0; step < steps; step++) spark_step(of, method, duration / steps, &x);
    return x;
}

/* ---- The library ------------------------------------------------------------------------------------------------- */

/* Three steps of the library, from the start rounded to double and put onto the constraints by itself. */
START_TEST(steps_are_the_definition)
{
    static const double H = 0.0625;
    const spark_problem *of = &spark_problems[_i / NODES_MOST];
    const int nodes = 1 + _i % NODES_MOST;
    const spark_method method = spark_method_of(nodes);
    spark_state x = spark_start(of), seen = {0};
    double t = of->t, q[SPARK_N], p[SPARK_N];
    tvi_system *base, *system;
    ck_assert_int_eq(of->make(&base), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, base, of->m, of->phi, NULL), TVI_OK);
    tvi_integrator *integrator = integrator_of_order(system, 2 * nodes);
    for (int i = 0; i < of->n; i++) q[i] = (double)x.q[i], p[i] = (double)x.p[i];
    for (int step = 1; step <= 3; step++) {
        ck_assert_int_eq(tvi_step(integrator, H, &t, q, p), TVI_OK);
        spark_step(of, &method, H, &x);
        for (int i = 0; i < of->n; i++) seen.q[i] = q[i], seen.p[i] = p[i];
        const double error = between(of, &seen, &x);
        ck_assert_msg(error < 2e-15, "%s, %d nodes, step %d: %.2e", of->name, nodes, step, error);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* ---- The definition ---------------------------------------------------------------------------------------------- */

/* The error of s nodes falls by 4^s with half the step, and by terms of h^2 relative to that. The order of a symmetric
 * method is even, so that less than 1 beside 2 s tells it from all others. */
START_TEST(order_is_twice_the_nodes)
{
    static const quad durations[] = {0.0625, 0.25, 0.125, 0.125}; /* of each problem, for errors above roundoff */
    const quad duration = durations[_i / NODES_MOST];
    const spark_problem *of = &spark_problems[_i / NODES_MOST];
    const int nodes = 1 + _i % NODES_MOST;
    const spark_method method = spark_method_of(nodes), reference = spark_method_of(REFERENCE_NODES);
    const spark_state end = after(of, &reference, duration, 4);
    const spark_state one = after(of, &method, duration, 2), two = after(of, &method, duration, 4);
    const double error = between(of, &two, &end), order = log2(between(of, &one, &end) / error);
    ck_assert_double_gt(error, 1e-31);
    ck_assert_msg(fabs(order - 2 * nodes) < 0.75, "%s, %d nodes: order %.3f", of->name, nodes, order);
    ck_assert_double_lt(spark_defect(of, &two), 1e-31);
}
END_TEST

/* A method in which K_0 moves positions by a relative 1e-9 too much: X_1, or P_1 in what is not separable. */
static spark_method nearly(const spark_method *method)
{
    spark_method broken = *method;
    broken.nu_dd[1][0] *= 1 + 1e-9;
    broken.mu_d[0][0] *= 1 + 1e-9;
    return broken;
}

/* The symplectic form of two vectors tangent to the constraints, from states 2 delta apart. */
static quad form_of(const spark_problem *of, const spark_state near[2][2], quad delta)
{
    quad sum = 0;
    for (int i = 0; i < of->n; i++)
        sum += (near[0][1].q[i] - near[0][0].q[i]) * (near[1][1].p[i] - near[1][0].p[i]) -
               (near[0][1].p[i] - near[0][0].p[i]) * (near[1][1].q[i] - near[1][0].q[i]);
    return sum / (4 * delta * delta);
}

/* The change of the form in a step, relative to what it is. Differences have an error of delta^2, and roundoff that is
 * divided by delta. */
static double form_change(const spark_problem *of, const spark_method *method, quad h)
{
    static const quad DELTA = 1e-11;
    spark_state near[2][2];
    for (int way = 0; way < 2; way++)
        for (int side = 0; side < 2; side++) {
            spark_state *x = &near[way][side];
            *x = spark_start(of);
            for (int i = 0; i < of->n; i++) {
                x->q[i] += (side ? DELTA : -DELTA) * cosq(1 + 3 * i + 5 * way);
                x->p[i] += (side ? DELTA : -DELTA) * sinq(2 + 7 * i + 4 * way);
            }
            spark_project(of, x);
        }
    const quad before = form_of(of, (const spark_state(*)[2])near, DELTA);
    for (int k = 0; k < 4; k++) spark_step(of, method, h, &near[k / 2][k % 2]);
    return (double)fabsq(form_of(of, (const spark_state(*)[2])near, DELTA) / before - 1);
}

/* What a step of 0.125 by the method leaves, and by one that is nearly it. */
static void expect_property(int i, double (*left)(const spark_problem *, const spark_method *, quad), double most,
                            double least)
{
    static const quad H = 0.125;
    const spark_problem *of = &spark_problems[i / NODES_MOST];
    const int nodes = 1 + i % NODES_MOST;
    const spark_method method = spark_method_of(nodes), broken = nearly(&method);
    const double is = left(of, &method, H), control = left(of, &broken, H);
    ck_assert_msg(is < most, "%s, %d nodes: %.2e", of->name, nodes, is);
    ck_assert_msg(control > least, "%s, %d nodes: a broken method has %.2e", of->name, nodes, control);
}

START_TEST(form_is_kept) { expect_property(_i, form_change, 1e-20, 1e-19); }
END_TEST

static double reversal(const spark_problem *of, const spark_method *method, quad h)
{
    const spark_state start = spark_start(of);
    spark_state x = start;
    spark_step(of, method, h, &x);
    ck_assert_double_gt(between(of, &x, &start), 0.01);
    spark_step(of, method, -h, &x);
    return between(of, &x, &start);
}

START_TEST(steps_go_back) { expect_property(_i, reversal, 1e-30, 1e-20); }
END_TEST

Suite *suite_spark_quad(void)
{
    Suite *suite = suite_create("steps, quadruple");
    TCase *tcase = tcase_create("library");
    const int rows = spark_problem_count * NODES_MOST;
    tcase_add_loop_test(tcase, steps_are_the_definition, 0, rows);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("definition");
    tcase_add_loop_test(tcase, order_is_twice_the_nodes, 0, rows);
    tcase_add_loop_test(tcase, form_is_kept, 0, rows);
    tcase_add_loop_test(tcase, steps_go_back, 0, rows);
    suite_add_tcase(suite, tcase);
    return suite;
}
