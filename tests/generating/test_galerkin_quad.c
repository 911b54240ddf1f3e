/* test_galerkin_quad.c - the Galerkin curve against Gauss collocation in its first-order form, in quadruple precision
 * (gcc only). */
#include "generating.h"
#include "problems.h"
#include "quad.h"

#include <math.h>
#include <quadmath.h>

static const test_problem *const problems[] = {
    &problem_pendulum, &problem_kepler, &problem_henon_heiles, &problem_chain,
};
static const double steps[] = {0.25, 0.2, 0.5, 0.125};
enum { PROBLEMS = sizeof problems / sizeof *problems, STEPS = 3, PASSES = 60, MOST = 3 };

/* int_0^s of the polynomial that is 1 at node j and 0 at the others: Gauss on [0, s] is exact. */
static quad integral(const quad_method *gauss, int j, quad s)
{
    quad sum = 0;
    for (int k = 0; k < gauss->points; k++) {
        quad value = 1;
        for (int i = 0; i < gauss->points; i++)
            if (i != j) value *= (s * gauss->c[k] - gauss->c[i]) / (gauss->c[j] - gauss->c[i]);
        sum += s * gauss->b[k] * value;
    }
    return sum;
}

/* Q_i = q0 + h sum a_ij V_j, V_i = v0 + h sum a_ij F(Q_j) / m. */
static void collocate(const quad_system *system, const test_problem *problem, const quad_method *gauss, quad h, quad *t,
                      quad q[], quad p[])
{
    const int n = problem->scene->n, m = gauss->points;
    quad Q[TVI_MAX_NODES][MOST], P[TVI_MAX_NODES][MOST], F[TVI_MAX_NODES][MOST], a[TVI_MAX_NODES][TVI_MAX_NODES];
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) a[i][j] = integral(gauss, j, gauss->c[i]);
    for (int j = 0; j < m; j++)
        for (int k = 0; k < n; k++) Q[j][k] = q[k], P[j][k] = p[k];
    for (int pass = 0; pass < PASSES; pass++) {
        for (int j = 0; j < m; j++) quad_force(system, *t + gauss->c[j] * h, Q[j], F[j]);
        for (int i = 0; i < m; i++)
            for (int k = 0; k < n; k++) {
                P[i][k] = p[k];
                for (int j = 0; j < m; j++) P[i][k] += h * a[i][j] * F[j][k];
            }
        for (int i = 0; i < m; i++)
            for (int k = 0; k < n; k++) {
                Q[i][k] = q[k];
                for (int j = 0; j < m; j++) Q[i][k] += h * a[i][j] * P[j][k] / problem_mass(problem, k);
            }
    }
    for (int j = 0; j < m; j++)
        for (int k = 0; k < n; k++) {
            q[k] += h * gauss->b[j] * P[j][k] / problem_mass(problem, k);
            p[k] += h * gauss->b[j] * F[j][k];
        }
    *t += h;
}

START_TEST(step_is_that_of_collocation)
{
    const test_problem *problem = problems[_i % PROBLEMS];
    const scene *s = problem->scene;
    const int nodes = 1 + _i / PROBLEMS;
    const double h = steps[_i % PROBLEMS];
    const quad_method gauss = quad_method_gauss(TVI_AT_START, TVI_NODES_ON_CURVE, nodes, nodes);
    const tvi_options options = {.method = TVI_TYPE1, .expansion = TVI_AT_NODES, .degree = nodes};
    quad_system *system = problem->force ? quad_system_force(s->n, s->mass, problem->force, NULL)
                                         : quad_system_potential(s->n, s->mass, s->potential, NULL);
    ck_assert_ptr_nonnull(system);
    runner run = runner_open(problem, &options);
    test_state x = problem_start(problem);
    quad t = x.t, q[MOST], p[MOST];
    for (int k = 0; k < s->n; k++) q[k] = x.q[k], p[k] = x.p[k];
    runner_steps(&run, h, STEPS, &x);
    for (int step = 0; step < STEPS; step++) collocate(system, problem, &gauss, h, &t, q, p);
    for (int k = 0; k < s->n; k++) {
        ck_assert_msg(fabsq(x.q[k] - q[k]) < 3e-15, "%s, %d nodes: q %.1e", s->name, nodes, (double)(x.q[k] - q[k]));
        ck_assert_msg(fabsq(x.p[k] - p[k]) < 6e-15, "%s, %d nodes: p %.1e", s->name, nodes, (double)(x.p[k] - p[k]));
    }
    runner_close(&run);
    quad_system_free(system);
}
END_TEST

Suite *suite_galerkin_quad(void)
{
    Suite *suite = suite_create("galerkin, quadruple");
    TCase *tcase = tcase_create("collocation");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, step_is_that_of_collocation, 0, PROBLEMS * TVI_MAX_NODES);
    suite_add_tcase(suite, tcase);
    return suite;
}
