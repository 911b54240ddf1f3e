/* test_steps.c - Tests steps on constraints: their order, that states stay on the constraints, reversal, the symplectic
 * form, tangent maps, RATTLE, momenta. */
#include "constraints.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_STEPS = 1 << 12 };

/* ---- Orders ------------------------------------------------------------------------------------------------------ */

/* The error of m nodes falls by 4^m with half the step: the quotient of the last two errors above roundoff. */
static const int node_counts[] = {1, 2, 3, 4, 6, 8};
enum { NODE_COUNTS = sizeof node_counts / sizeof *node_counts };
START_TEST(orders)
{
    const problem *of = &problems[_i / NODE_COUNTS];
    const int nodes = node_counts[_i % NODE_COUNTS];
    tvi_system *system = system_of(of);
    const state start = start_of(of, system);
    const double duration = 0.5;
    state end = start;
    ck_assert_int_eq(make_run(system, 20, duration, 200, &end), TVI_OK);
    double before = INFINITY, order = 0;
    for (long steps = 1; steps <= MOST_STEPS; steps *= 2) {
        state x = start;
        if (make_run(system, 2 * nodes, duration, steps, &x) != TVI_OK) continue;
        const double error = distance(of, &x, &end);
        if (error < 1e-13) break;
        if (before < 1e-3) order = log2(before / error);
        before = error;
    }
    /* Where no error is above roundoff, as on a line, none shows the order. With many nodes only those of large steps
     * are above it, which show less than the order. */
    const double less = nodes < 4 ? 0.2 * nodes + 0.1 : 0.65 * nodes, more = nodes < 4 ? less : nodes + 0.2;
    if (before < INFINITY && order > 0)
        ck_assert_msg(-less < order - 2 * nodes && order - 2 * nodes < more,
                      "%s, %d nodes: order %.2f at the error %.2g", of->name, nodes, order, before);
    else ck_assert_msg(nodes >= 6 || before == INFINITY, "%s, %d nodes: error %.2g", of->name, nodes, before);
    tvi_system_free(system);
}
END_TEST

/* ---- What is kept ------------------------------------------------------------------------------------------------ */

/* A state after a step is on the constraints to some units of its size: to project it moves it by no more. */
START_TEST(states_stay_on_constraints)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    state x = start_of(of, system);
    tvi_integrator *integrator = integrator_of_order(system, 12);
    for (int step = 0; step < 200; step++) {
        ck_assert_int_eq(tvi_step(integrator, 0.01, &x.t, x.q, x.p), TVI_OK);
        state projected = x;
        double size_q = 0, size_p = 0;
        ck_assert_int_eq(tvi_project(system, x.t, projected.q, projected.p), TVI_OK);
        for (int i = 0; i < of->n; i++) size_q = fmax(size_q, fabs(x.q[i])), size_p = fmax(size_p, fabs(x.p[i]));
        for (int i = 0; i < of->n; i++) {
            ck_assert_double_le(fabs(projected.q[i] - x.q[i]), 4 * DBL_EPSILON * size_q);
            ck_assert_double_le(fabs(projected.p[i] - x.p[i]), 8 * DBL_EPSILON * (size_p + 1));
        }
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

START_TEST(steps_are_reversible)
{
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    const state start = start_of(of, system);
    state x = start, there;
    tvi_integrator *integrator = integrator_of_order(system, 6);
    ck_assert_int_eq(tvi_integrate(integrator, 0.05, 20, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    there = x;
    ck_assert_int_eq(tvi_integrate(integrator, -0.05, 20, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    ck_assert_double_gt(distance(of, &there, &start), 0.01);
    ck_assert_double_le(distance(of, &x, &start), 1e-12);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* The symplectic form of two tangent vectors of the constraints, by differences of projected states. */
static double form_of(const problem *of, const state near[2][2])
{
    double sum = 0;
    for (int i = 0; i < of->n; i++)
        sum += (near[0][1].q[i] - near[0][0].q[i]) * (near[1][1].p[i] - near[1][0].p[i]) -
               (near[0][1].p[i] - near[0][0].p[i]) * (near[1][1].q[i] - near[1][0].q[i]);
    return sum;
}

/* A large step of low order changes the energy, but not the symplectic form: differences of states 2 delta apart see it
 * with an error of delta^2. Friction, which the driven pendulum has, changes it. */
START_TEST(steps_are_symplectic)
{
    static const double DELTA = 1e-4;
    const problem *of = &problems[_i];
    tvi_system *system = system_of(of);
    const state start = start_of(of, system);
    state near[2][2];
    for (int way = 0; way < 2; way++)
        for (int side = 0; side < 2; side++) {
            state *x = &near[way][side];
            *x = start;
            for (int i = 0; i < of->n; i++) {
                x->q[i] += (side ? DELTA : -DELTA) * cos(1 + 3 * i + 5 * way);
                x->p[i] += (side ? DELTA : -DELTA) * sin(2 + 7 * i + 4 * way);
            }
            ck_assert_int_eq(tvi_project(system, x->t, x->q, x->p), TVI_OK);
        }
    const double before = form_of(of, (const state(*)[2])near);
    for (int k = 0; k < 4; k++) ck_assert_int_eq(make_run(system, 4, 0.2, 1, &near[k / 2][k % 2]), TVI_OK);
    const double size = 4 * DELTA * DELTA, after = form_of(of, (const state(*)[2])near);
    const double change = fabs(after - before) / size;
    if (strcmp(of->name, "driven pendulum") == 0) ck_assert_double_gt(change, 1e-3);
    else ck_assert_msg(change < 1e-5, "%s: %.3g of %.3g", of->name, change, before / size);
    tvi_system_free(system);
}
END_TEST

/* ---- RATTLE ------------------------------------------------------------------------------------------------------ */

/* "stormer-verlet" on constraints is of order 2, stays on them, and goes back; it is for the systems that it is for
 * without them. */
START_TEST(rattle)
{
    const problem *of = &problems[_i];
    tvi_system *base = base_of(of), *system = system_of(of);
    tvi_options options;
    tvi_integrator *integrator;
    double error[2] = {0};
    ck_assert_int_eq(tvi_options_named("stormer-verlet", 2, &options), TVI_OK);
    const tvi_status status = tvi_integrator_create(&integrator, base, &options);
    tvi_integrator_free(integrator);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), status);
    tvi_integrator_free(integrator);
    for (int k = 0; k < 2 && status == TVI_OK; k++) {
        const state start = start_of(of, system);
        state x = start, end = start;
        const long steps = 50 << k;
        const double h = 0.5 / (double)steps;
        ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
        ck_assert_int_eq(make_run(system, 16, 0.5, 50, &end), TVI_OK);
        ck_assert_int_eq(tvi_integrate(integrator, h, steps, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
        error[k] = distance(of, &x, &end);
        state projected = x;
        ck_assert_int_eq(tvi_project(system, x.t, projected.q, projected.p), TVI_OK);
        ck_assert_double_le(distance(of, &x, &projected), 1e-14);
        ck_assert_int_eq(tvi_integrate(integrator, -h, steps, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
        ck_assert_double_le(distance(of, &x, &start), 1e-12);
        tvi_integrator_free(integrator);
    }
    if (status == TVI_OK && error[1] > 1e-12)
        ck_assert_msg(fabs(log2(error[0] / error[1]) - 2) < 0.1, "%s: errors %.3g and %.3g", of->name, error[0],
                      error[1]);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* ---- Tangent maps ------------------------------------------------------------------------------------------------ */

static double form_of_columns(int n, const double D[])
{
    double sum = 0;
    for (int i = 0; i < n; i++) sum += D[2 * i] * D[2 * (n + i) + 1] - D[2 * (n + i)] * D[2 * i + 1];
    return sum;
}

static tvi_options options_of(const char *method, int order)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    options.max_tail = -1;
    return options;
}

/* The end of 10 steps from a state that is `delta` along column 0 of D from x. */
static state end_of_neighbour(const problem *of, const tvi_system *system, const tvi_options *options, const state *x,
                              const double D[], double delta)
{
    state near = *x;
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    for (int i = 0; i < of->n; i++) {
        near.q[i] += delta * D[2 * i];
        near.p[i] += delta * D[2 * (of->n + i)];
    }
    ck_assert_int_eq(tvi_project(system, near.t, near.q, near.p), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, 0.03, 10, &near.t, near.q, near.p, NULL, NULL), TVI_OK);
    tvi_integrator_free(integrator);
    return near;
}

/* Columns are put onto the tangent space of the constraints by the first step, and from then on the map is the
 * derivative of the steps: it keeps the symplectic form to roundoff, unless there is friction, and is what differences
 * tell. */
static void columns_move(const problem *of, const tvi_options *options)
{
    static const double DELTA = 1e-5;
    tvi_system *system = system_of(of);
    state x = start_of(of, system);
    tvi_integrator *integrator;
    double D[4 * MOST_N], start[4 * MOST_N];
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    for (int i = 0; i < 4 * of->n; i++) D[i] = cos(1 + 3 * i);
    const tvi_status status = tvi_step_tangent(integrator, 0.03, &x.t, x.q, x.p, D, 2);
    ck_assert_msg(status == TVI_OK, "%s: %s", of->name, tvi_last_error());
    const double form = form_of_columns(of->n, D);
    const state end[] = {end_of_neighbour(of, system, options, &x, D, -DELTA),
                         end_of_neighbour(of, system, options, &x, D, DELTA)};
    memcpy(start, D, sizeof D);
    for (int step = 0; step < 10; step++)
        ck_assert_int_eq(tvi_step_tangent(integrator, 0.03, &x.t, x.q, x.p, D, 2), TVI_OK);
    const double change = fabs(form_of_columns(of->n, D) - form);
    if (strcmp(of->name, "driven pendulum") == 0) ck_assert_double_gt(change, 1e-3);
    else ck_assert_msg(change < 1e-13, "%s: %.3g of %.3g", of->name, change, form);
    ck_assert_double_gt(fabs(D[0] - start[0]), 1e-3);
    for (int i = 0; i < of->n; i++) {
        ck_assert_double_eq_tol(D[2 * i], (end[1].q[i] - end[0].q[i]) / (2 * DELTA), 1e-7);
        ck_assert_double_eq_tol(D[2 * (of->n + i)], (end[1].p[i] - end[0].p[i]) / (2 * DELTA), 1e-7);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}

START_TEST(tangent_maps)
{
    const tvi_options options = options_of("galerkin", 8);
    columns_move(&problems[_i], &options);
}
END_TEST

START_TEST(tangent_maps_of_rattle)
{
    const tvi_options options = options_of("stormer-verlet", 2);
    tvi_system *system = system_of(&problems[_i]);
    const tvi_status status = tvi_options_check(system, &options, NULL);
    tvi_system_free(system);
    if (status == TVI_OK) columns_move(&problems[_i], &options);
}
END_TEST

/* ---- Columns of parameters of constraints ------------------------------------------------------------------------ */

enum { LENGTH, UNIT };

/* c (q.q - l^2) / 2: the motion depends on the length l, and not on the unit c. */
static void rod_with_parameters(const jet q[], jet t, jet value[], void *ctx)
{
    (void)ctx;
    const jet l = jet_parameter(t, LENGTH, 1.25), c = jet_parameter(t, UNIT, 3);
    value[0] = jet_mul(c, jet_mul(0.5, jet_sub(jet_dot(q, q, 2), jet_sqr(l))));
}

/* The column of a parameter after so many steps of the size h. */
static void run_column(const problem *of, const tvi_options *options, int parameter, double h, long steps, double D[])
{
    tvi_system *base = base_of(of), *system;
    tvi_integrator *integrator;
    double t = of->t, q[] = {0.75, -1}, p[] = {0.4, 0.3};
    memset(D, 0, 6 * sizeof *D);
    D[4 + parameter] = 1;
    ck_assert_int_eq(tvi_system_constrained(&system, base, 1, rod_with_parameters, NULL), TVI_OK);
    ck_assert_int_eq(tvi_project(system, t, q, p), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    for (long step = 0; step < steps; step++)
        ck_assert_msg(tvi_step_tangent(integrator, h, &t, q, p, D, 1) == TVI_OK, "%s, %ld steps: %s", of->name, steps,
                      tvi_last_error());
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    tvi_system_free(base);
}

/* However small the steps are, the columns are made, and are the same: roundoff, of which that of impulses is 1/h times
 * as large, is not taken for passes that do not converge, nor a column that is 0 made large. */
static void columns_of_parameters(const problem *of, const char *method, int order, double bound)
{
    const tvi_options options = options_of(method, order);
    double accurate[6], D[6];
    const tvi_options best = options_of("galerkin", 16);
    run_column(of, &best, LENGTH, 0.1 / 8, 8, accurate);
    for (long steps = 2; steps <= 2048; steps *= 8) {
        run_column(of, &options, UNIT, 0.1 / (double)steps, steps, D);
        for (int i = 0; i < 4; i++) ck_assert_double_le(fabs(D[i]), 1e-13 * sqrt((double)steps));
        run_column(of, &options, LENGTH, 0.1 / (double)steps, steps, D);
        for (int i = 0; i < 4; i++)
            ck_assert_msg(fabs(D[i] - accurate[i]) <= bound * pow((double)steps, -order) + 1e-13 * (double)steps,
                          "%s: %.3g", of->name, D[i] - accurate[i]);
    }
}

/* The problems whose rod has one end at rest. */
static const int rods[] = {PENDULUM, OF_A_FORCE, BENT, 4, 5, 9, 10};
enum { RODS = sizeof rods / sizeof *rods };

START_TEST(columns_of_lengths)
{
    static const int of[] = {4, 8, 16, 20};
    columns_of_parameters(&problems[rods[_i / 4]], "galerkin", of[_i % 4], 10);
}
END_TEST

/* From steps of 4e-5 on the first pass, which begins at the step before, moves the places by less than 2^-26. */
START_TEST(columns_of_lengths_by_rattle)
{
    const tvi_options options = options_of("stormer-verlet", 2);
    double D[6];
    columns_of_parameters(&problems[rods[_i]], "stormer-verlet", 2, 10);
    run_column(&problems[rods[_i]], &options, UNIT, 2e-5, 50, D);
    for (int i = 0; i < 4; i++) ck_assert_double_le(fabs(D[i]), 1e-13);
}
END_TEST

/* ---- A molecule that is free ------------------------------------------------------------------------------------- */

static jet spring(const jet q[], jet t, void *ctx)
{
    const jet d[] = {jet_sub(q[0], q[4]), jet_sub(q[1], q[5])};
    (void)t, (void)ctx;
    return jet_exp(jet_neg(jet_dot(d, d, 2)));
}

static void two_bonds(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    for (int k = 0; k < 2; k++) {
        const jet d[] = {jet_sub(q[2 * k + 2], q[2 * k]), jet_sub(q[2 * k + 3], q[2 * k + 1])};
        value[k] = jet_sub(jet_dot(d, d, 2), 1);
    }
}

/* Forces between points, constraints included, keep both momenta of the plane to roundoff at any step. */
START_TEST(momenta_are_kept)
{
    const double mass[] = {1, 1, 3, 3, 0.25, 0.25};
    tvi_system *base, *system;
    double t = 0, q[] = {-1, 0.1, 0, 0, 0.6, 0.8}, p[] = {0.1, 0.7, -0.4, -0.5, 0.2, 0.3}, of_start[3], size = 0;
    ck_assert_int_eq(tvi_system_potential(&base, 6, mass, spring, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, base, 2, two_bonds, NULL), TVI_OK);
    ck_assert_int_eq(tvi_project(system, t, q, p), TVI_OK);
    tvi_integrator *integrator = integrator_of_order(system, 6);
    for (int step = 0; step <= 400; step++) {
        double kept[3] = {0};
        for (int k = 0; k < 3; k++) {
            kept[0] += p[2 * k];
            kept[1] += p[2 * k + 1];
            kept[2] += q[2 * k] * p[2 * k + 1] - q[2 * k + 1] * p[2 * k];
        }
        if (step == 0) memcpy(of_start, kept, sizeof kept);
        for (int k = 0; k < 3; k++) ck_assert_double_le(fabs(kept[k] - of_start[k]), 1e-13 * (1 + size));
        size = fmax(size, fabs(q[0]) + fabs(q[1]));
        ck_assert_int_eq(tvi_step(integrator, 0.25, &t, q, p), TVI_OK);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

Suite *suite_steps(void)
{
    Suite *suite = suite_create("steps");
    TCase *tcase = tcase_create("orders");
    tcase_add_loop_test(tcase, orders, 0, problem_count * NODE_COUNTS);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("kept");
    tcase_add_loop_test(tcase, states_stay_on_constraints, 0, problem_count);
    tcase_add_loop_test(tcase, steps_are_reversible, 0, problem_count);
    tcase_add_loop_test(tcase, steps_are_symplectic, 0, problem_count);
    tcase_add_loop_test(tcase, rattle, 0, problem_count);
    tcase_add_test(tcase, momenta_are_kept);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("tangents");
    tcase_add_loop_test(tcase, tangent_maps, 0, problem_count);
    tcase_add_loop_test(tcase, tangent_maps_of_rattle, 0, problem_count);
    tcase_add_loop_test(tcase, columns_of_lengths, 0, 4 * RODS);
    tcase_add_loop_test(tcase, columns_of_lengths_by_rattle, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
