/* test_tangent.c - Tests the tangent of the flow at equal time, of steps in s. */
#include "hard.h"
#include "rescaled.h"

#include <math.h>
#include <string.h>

enum { ROWS = 4 };

/* The largest difference of two Jacobians, relative to the elements. */
static double matrix_distance(double a[ROWS][ROWS], double b[ROWS][ROWS])
{
    double most = 0, size = 0;
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < ROWS; j++) {
            most = fmax(most, fabs(a[i][j] - b[i][j]));
            size = fmax(size, fabs(b[i][j]));
        }
    return most / size;
}

static void identity(double M[ROWS][ROWS])
{
    memset(M, 0, sizeof(double[ROWS][ROWS]));
    for (int i = 0; i < ROWS; i++) M[i][i] = 1;
}

/* By steps of equal time to the time that the steps in s have led to. */
static void flow_tangent(tvi_potential_fn *potential, const double mass[], const state *start, double t,
                         double M[ROWS][ROWS])
{
    enum { STEPS = 2000 };
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, mass, potential, NULL), TVI_OK);
    run r = open_run(system, NULL, 0, start);
    identity(M);
    for (int step = 0; step < STEPS; step++)
        ck_assert_int_eq(tvi_step_tangent(r.integrator, (t - start->t) / STEPS, &r.x.t, r.x.q, r.x.p, &M[0][0], ROWS),
                         TVI_OK);
    close_run(&r);
}

static void check_tangent(tvi_potential_fn *potential, const double mass[], tvi_rescale_fn *g, const state *start,
                          const served *method, double h, double tolerance)
{
    double M[ROWS][ROWS], exact[ROWS][ROWS];
    run r = open_run(rescaled_system(2, mass, potential, g), method->name, method->order, start);
    run plain = open_run(rescaled_system(2, mass, potential, g), method->name, method->order, start);
    identity(M);
    for (int step = 0; step < 40; step++)
        ck_assert_int_eq(tvi_step_tangent(r.integrator, h, &r.x.t, r.x.q, r.x.p, &M[0][0], ROWS), TVI_OK);
    ck_assert_int_eq(run_steps(&plain, h, 40), TVI_OK);
    ck_assert(memcmp(&plain.x, &r.x, sizeof r.x) == 0); /* bit for bit the steps without */
    flow_tangent(potential, mass, start, r.x.t, exact);
    ck_assert_double_le(matrix_distance(M, exact), tolerance);
    ck_assert_double_ge(matrix_distance(M, exact), 1e-16);
    close_run(&r);
    close_run(&plain);
}

static const served accurate[] = {
    {"galerkin", 16, false}, {"poincare", 16, false}, {"right", 16, false}, {"taylor", 20, false}};

START_TEST(tangent_of_kepler)
{
    const state start = kepler_start(0.6);
    check_tangent(kepler, NULL, kepler_scale, &start, &accurate[_i], 0.1, 1e-11);
}
END_TEST

/* With explicit time, and g of q, p and t. */
START_TEST(tangent_of_the_driven_problem)
{
    const state start = driven_start();
    check_tangent(driven, driven_mass, driven_scale, &start, &accurate[_i], 0.1, 1e-11);
    check_tangent(driven, driven_mass, NULL, &start, &accurate[_i], 0.1, 1e-9);
}
END_TEST

/* A tangent along the flow stays one: (q', p') is carried to (q', p'). */
START_TEST(flow_is_carried_along)
{
    run r = open_kepler(0.9, NULL, NULL, 0);
    double D[ROWS] = {r.x.p[0], r.x.p[1], -pow(r.x.q[0], -2), 0};
    for (int step = 0; step < 60; step++) {
        ck_assert_int_eq(tvi_step_tangent(r.integrator, 0.4, &r.x.t, r.x.q, r.x.p, D, 1), TVI_OK);
        const double radius = hypot(r.x.q[0], r.x.q[1]), force = -pow(radius, -3);
        for (int i = 0; i < 2; i++) {
            ck_assert_double_eq_tol(D[i], r.x.p[i], 1e-11 * hypot(r.x.p[0], r.x.p[1]));
            ck_assert_double_eq_tol(D[2 + i], force * r.x.q[i], 1e-11 * fabs(force) * radius);
        }
    }
    close_run(&r);
}
END_TEST

/* ---- Order and chaos --------------------------------------------------------------------------------------------- */

/* With steps of different size, docs/chaos.md: Y(t) = (2/t) sum t_j ln(d_j / d_{j-1}), and its mean over time. */
static double megno(run *r, int n, double h, double t_end)
{
    double D[ROWS] = {0.5, 0.5, 0.5, 0.5}, weighted = 0, area = 0;
    while (r->x.t < t_end) {
        const double before = r->x.t;
        double square = 0;
        ck_assert_int_eq(tvi_step_tangent(r->integrator, h, &r->x.t, r->x.q, r->x.p, D, 1), TVI_OK);
        for (int i = 0; i < 2 * n; i++) square += D[i] * D[i];
        for (int i = 0; i < 2 * n; i++) D[i] /= sqrt(square);
        weighted += r->x.t * log(square) / 2;
        area += 2 * weighted / r->x.t * (r->x.t - before);
    }
    return area / r->x.t;
}

/* 2 on regular orbits, however their steps change; large on a chaotic one. */
static const struct {
    double start, t_end, least, most; /* start 0: Kepler's problem, e = 0.9; else that of Sitnikov's */
} orders[] = {
    {0, 2000, 1.9, 2.1}, {0.5, 2000, 1.9, 2.1}, {0.7, 2000, 1.9, 2.1}, {0.8, 1250, 5, 100}}; /* it may leave */

START_TEST(order_and_chaos)
{
    const hard_scene *s = &hard_sitnikov;
    const state start = {0, {orders[_i].start}, {0}};
    const bool is_kepler = orders[_i].start == 0;
    run r = is_kepler ? open_kepler(0.9, kepler_scale, NULL, 0)
                      : open_run(rescaled_system(1, NULL, s->scene.potential, s->scale), NULL, 0, &start);
    const double Y = megno(&r, is_kepler ? 2 : 1, is_kepler ? 0.8 : 0.5, orders[_i].t_end);
    ck_assert_msg(Y > orders[_i].least && Y < orders[_i].most, "%g", Y);
    close_run(&r);
}
END_TEST

Suite *suite_tangent(void)
{
    Suite *suite = suite_create("tangent");
    TCase *tests = tcase_create("tangent");
    tcase_add_loop_test(tests, tangent_of_kepler, 0, 4);
    tcase_add_loop_test(tests, tangent_of_the_driven_problem, 0, 4);
    tcase_add_test(tests, flow_is_carried_along);
    tcase_add_loop_test(tests, order_and_chaos, 0, 4);
    suite_add_tcase(suite, tests);
    return suite;
}
