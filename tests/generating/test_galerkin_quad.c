/* test_galerkin_quad.c - Tests the Galerkin curve against Gauss collocation in its first-order form, in quadruple
 * precision (gcc only). */
#include "equations_quad.h"
#include "generating.h"
#include "problems/problems.h"
#include "references/quad.h"

#include <math.h>
#include <quadmath.h>

/* Problems of a force, then scenes of a Lagrangian or a Hamiltonian. */
static const test_problem *const problems[] = {
    &problem_pendulum,
    &problem_kepler,
    &problem_henon_heiles,
    &problem_chain,
};
enum { PROBLEMS = sizeof problems / sizeof *problems, ROWS = PROBLEMS + EQUATIONS, STEPS = 3, PASSES = 150 };
static const double steps[ROWS] = {0.25, 0.2, 0.5, 0.125, 0.0625, 0.25, 0.25, 0.03125, 0.125};

/* (q', p') of a row. */
typedef struct {
    int n;
    const test_problem *problem; /* and its force, else: */
    quad_system *system;
    const quad_equations *equations;
} quad_slopes;

static void slopes_at(const quad_slopes *s, quad t, const quad_point *x, quad_point *dx)
{
    if (s->equations) {
        s->equations->field(x, dx);
        return;
    }
    quad_force(s->system, t, x->q, dx->p);
    for (int k = 0; k < s->n; k++) dx->q[k] = x->p[k] / problem_mass(s->problem, k);
}

/* x += h sum_j w_j dx_j. */
static void add(int n, int count, quad h, const quad w[], const quad_point dx[], quad_point *x)
{
    for (int k = 0; k < n; k++)
        for (int j = 0; j < count; j++) {
            x->q[k] += h * w[j] * dx[j].q[k];
            x->p[k] += h * w[j] * dx[j].p[k];
        }
}

/* X_i = x0 + h sum_j a_ij X'_j, x1 = x0 + h sum_j b_j X'_j. */
static void collocate(const quad_slopes *s, const quad_method *gauss, quad h, quad *t, quad_point *x)
{
    const int m = gauss->points;
    quad_point X[TVI_MAX_NODES], dX[TVI_MAX_NODES];
    quad a[TVI_MAX_NODES][TVI_MAX_NODES];
    for (int i = 0; i < m; i++) {
        for (int j = 0; j < m; j++) a[i][j] = quad_method_integral(gauss, j, gauss->c[i]);
        X[i] = *x;
    }
    for (int pass = 0; pass < PASSES; pass++) {
        for (int j = 0; j < m; j++) slopes_at(s, *t + gauss->c[j] * h, &X[j], &dX[j]);
        for (int i = 0; i < m; i++) {
            X[i] = *x;
            add(s->n, m, h, a[i], dX, &X[i]);
        }
    }
    add(s->n, m, h, gauss->b, dX, x);
    *t += h;
}

static quad_slopes open_slopes(int row)
{
    if (row >= PROBLEMS)
        return (quad_slopes){.n = equations[row - PROBLEMS].scene->n, .equations = &equations[row - PROBLEMS]};
    const test_problem *problem = problems[row];
    const scene *s = problem->scene;
    quad_system *system = problem->force ? quad_system_force(s->n, s->mass, problem->force, NULL)
                                         : quad_system_potential(s->n, s->mass, s->potential, NULL);
    ck_assert_ptr_nonnull(system);
    return (quad_slopes){.n = s->n, .problem = problem, .system = system};
}

static tvi_system *open_system(const quad_slopes *s)
{
    tvi_system *system;
    if (s->problem) return problem_system(s->problem);
    ck_assert_int_eq(scene_system(s->equations->scene, &system), TVI_OK);
    return system;
}

static test_state start_of(const quad_slopes *s)
{
    if (s->problem) return problem_start(s->problem);
    test_state x = {0};
    for (int k = 0; k < s->n; k++) x.q[k] = s->equations->scene->q[k], x.p[k] = s->equations->scene->p[k];
    return x;
}

/* |x - y| relative to the largest component of q or of p, or 1. */
static double distance_of(int n, const double x[], const quad y[])
{
    quad distance = 0, size = 1;
    for (int k = 0; k < n; k++) {
        distance = fmaxq(distance, fabsq(x[k] - y[k]));
        size = fmaxq(size, fabsq(y[k]));
    }
    return (double)(distance / size);
}

START_TEST(step_is_that_of_collocation)
{
    const int row = _i % ROWS, nodes = 1 + _i / ROWS;
    const quad_slopes slopes = open_slopes(row);
    const char *name = slopes.problem ? slopes.problem->scene->name : slopes.equations->scene->name;
    const quad_method gauss = quad_method_gauss(TVI_AT_START, TVI_NODES_ON_CURVE, nodes, nodes);
    const tvi_options options = {.method = TVI_TYPE1, .expansion = TVI_AT_NODES, .degree = nodes};
    tvi_system *system = open_system(&slopes);
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    test_state x = start_of(&slopes);
    quad t = x.t;
    quad_point y = {{0}, {0}};
    for (int k = 0; k < slopes.n; k++) y.q[k] = x.q[k], y.p[k] = x.p[k];
    for (int step = 1; step <= STEPS; step++) {
        ck_assert_int_eq(tvi_step(integrator, steps[row], &x.t, x.q, x.p), TVI_OK);
        collocate(&slopes, &gauss, steps[row], &t, &y);
        const double q = distance_of(slopes.n, x.q, y.q), p = distance_of(slopes.n, x.p, y.p);
        ck_assert_msg(q < 3e-15 && p < 6e-15, "%s, %d nodes, step %d: q %.1e, p %.1e", name, nodes, step, q, p);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    quad_system_free(slopes.system);
}
END_TEST

Suite *suite_galerkin_quad(void)
{
    Suite *suite = suite_create("galerkin, quadruple");
    TCase *tcase = tcase_create("collocation");
    tcase_add_loop_test(tcase, step_is_that_of_collocation, 0, ROWS * TVI_MAX_NODES);
    suite_add_tcase(suite, tcase);
    return suite;
}
