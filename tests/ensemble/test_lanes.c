/* test_lanes.c - Tests that members whose passes do not converge to the roundoff of the others, that are outside of the
 * domain or whose equations need other pivots go by themselves. */
#include "ensemble.h"

#include <math.h>
#include <string.h>

/* ---- Small motions ----------------------------------------------------------------------------------------------- */

/* About (1000, -1000), in momenta of no size of their own. */
static jet far_away(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet x = jet_sub(q[0], 1000), y = jet_add(q[1], 1000), mass = jet_add(1, jet_div(jet_sqr(x), 4));
    return jet_add(jet_div(jet_dot(p, p, N), jet_mul(2, mass)), jet_mul(0.5, jet_add(jet_sqr(x), jet_sqr(y))));
}

static void start_small(group *c, int member, int orbit)
{
    const double size = pow(10, -orbit);
    c->t[member] = 0;
    c->q[member] = 1000 + size;
    c->q[c->members + member] = -1000 - size / 2;
    c->p[member] = c->p[c->members + member] = 0;
}

static void run_small(const tvi_system *system, const tvi_options *options, group *c)
{
    tvi_ensemble *ensemble;
    OK(tvi_ensemble_create(&ensemble, system, options, c->members, 1));
    OK(tvi_ensemble_integrate(ensemble, 0.25, 200, c->t, c->q, c->p, c->status, NULL, NULL));
    for (int m = 0; m < c->members; m++) ck_assert_int_eq(c->status[m], TVI_OK);
    tvi_ensemble_free(ensemble);
}

static const method by_themselves[] = {{"galerkin", 16}, {"poincare", 12}};
enum { BY_THEMSELVES = sizeof by_themselves / sizeof *by_themselves, SMALL = 64, SIZES = 13 }; /* whole blocks */

/* Their passes end at a roundoff that is measured, of one member alone, while the others go on. */
START_TEST(small_motions_go_by_themselves)
{
    static group all, one;
    tvi_system *system;
    tvi_options options;
    OK(tvi_system_hamiltonian(&system, N, far_away, NULL));
    OK(tvi_options_named(by_themselves[_i].name, by_themselves[_i].order, &options));
    all.members = SMALL;
    for (int m = 0; m < all.members; m++) start_small(&all, m, m % SIZES);
    run_small(system, &options, &all);
    for (int m = 0; m < all.members; m++) {
        tvi_integrator *integrator;
        one.members = 1;
        start_small(&one, 0, m % SIZES);
        run_small(system, &options, &one);
        expect_same("small", &all, m, &one, 0);
        start_small(&one, 0, m % SIZES);
        OK(tvi_integrator_create(&integrator, system, &options));
        one.status[0] = tvi_integrate(integrator, 0.25, 200, one.t, one.q, one.p, NULL, NULL);
        expect_same("alone", &all, m, &one, 0);
        tvi_integrator_free(integrator);
    }
    tvi_system_free(system);
}
END_TEST

/* ---- Members that the others' step does not serve ---------------------------------------------------------------- */

typedef struct {
    tvi_system *system;
    tvi_options options;
    tvi_ensemble *ensemble;
} stage;

static stage open_stage(tvi_force_fn *force, const method *by, int degree)
{
    stage s;
    OK(tvi_system_force(&s.system, N, NULL, force, NULL));
    OK(tvi_options_named(by->name, by->order, &s.options));
    s.options.quadrature = TVI_LOBATTO;
    s.options.degree = degree;
    s.options.max_tail = -1;
    OK(tvi_ensemble_create(&s.ensemble, s.system, &s.options, SMALL, 1));
    ck_assert(has_lanes(s.ensemble));
    return s;
}

/* Expects that each member has the status and the bits of an integrator of its own that starts as `start` says. */
static void expect_integrators(stage s, const group *all, const group *start, const double value[], double h, int steps)
{
    static group one;
    for (int m = 0; m < SMALL; m++) {
        tvi_integrator *integrator;
        OK(tvi_integrator_create(&integrator, s.system, &s.options));
        if (value) OK(tvi_integrator_set_parameters(integrator, &value[m]));
        one.members = 1;
        one.t[0] = start->t[m];
        for (int i = 0; i < N; i++) one.q[i] = start->q[i * SMALL + m], one.p[i] = start->p[i * SMALL + m];
        one.status[0] = tvi_integrate(integrator, h, steps, one.t, one.q, one.p, NULL, NULL);
        expect_same("by itself", all, m, &one, 0);
        tvi_integrator_free(integrator);
    }
    tvi_ensemble_free(s.ensemble);
    tvi_system_free(s.system);
}

static void start_all(group *c)
{
    memset(c, 0, sizeof *c);
    start_group(c, SMALL, 0);
    memset(c->D, 0, sizeof c->D);
}

/* The quotients have no value at x = 0 and at t = 1, but what they end in is 0 there, and finite. */
static void force_with_poles(const jet q[], jet t, jet F[], void *ctx)
{
    (void)ctx;
    F[0] = jet_sub(jet_div(0.25, jet_div(1, q[0])), q[0]);
    F[1] = jet_sub(jet_div(0.25, jet_div(1, jet_sub(t, 1))), q[1]);
}

/* A curve of degree 2 has one order of the field, so that no number shows that the field has no value: at the start of
 * a step, or at the last node alone. (Poincare's has two orders; there the last node is what this tests.) */
static const method of_one_order[] = {{"taylor", 2}, {"midpoint", 4}, {"poincare", 4}};
enum { OF_ONE_ORDER = sizeof of_one_order / sizeof *of_one_order };

START_TEST(members_outside_of_the_domain_fail)
{
    static group all, start;
    const stage s = open_stage(force_with_poles, &of_one_order[_i], 2);
    start_all(&start);
    for (int m = 0; m < SMALL; m++) start.t[m] = 2;
    start.q[3] = 0;
    start.t[12] = 1 - 0.25;
    all = start;
    OK(tvi_ensemble_integrate(s.ensemble, 0.25, 4, all.t, all.q, all.p, all.status, NULL, NULL));
    for (int m = 0; m < SMALL; m++) ck_assert_int_eq(all.status[m], m == 3 || m == 12 ? TVI_EDOMAIN : TVI_OK);
    ck_assert(all.t[12] == start.t[12] + (_i == 0 ? 0.25 : 0));
    expect_integrators(s, &all, &start, NULL, 0.25, 4);
}
END_TEST

/* Springs, that of x with the parameter as its constant. */
static void force_of_springs(const jet q[], jet t, jet F[], void *ctx)
{
    (void)t, (void)ctx;
    F[0] = jet_neg(jet_add(jet_mul(jet_parameter(q[0], 0, 1), q[0]), jet_div(q[1], 64)));
    F[1] = jet_neg(jet_add(q[1], jet_div(q[0], 64)));
}

/* The mean of the ends of a curve that is half a turn of a spring does not depend on its middle. This derivative, a
 * pivot, is below 2^-10 of member 20, whose step would lose bits by it, and far above that of most others. */
START_TEST(members_with_small_pivots_go_by_themselves)
{
    static group all, start;
    static const method by_midpoint = {"midpoint", 12};
    static const double h = 0.5, half_turn = 3.14159265358979323846;
    double value[SMALL];
    const stage s = open_stage(force_of_springs, &by_midpoint, 0);
    for (int m = 0; m < SMALL; m++) value[m] = pow(half_turn / h, 2) * (1 + ldexp(m - 20.1, -8));
    OK(tvi_ensemble_set_parameters(s.ensemble, value));
    start_all(&start);
    all = start;
    OK(tvi_ensemble_integrate(s.ensemble, h, 4, all.t, all.q, all.p, all.status, NULL, NULL));
    expect_integrators(s, &all, &start, value, h, 4);
}
END_TEST

/* Members of a block need new Jacobians in different passes of a large step. A member that needs none keeps its own. */
START_TEST(new_jacobians_leave_those_of_others)
{
    static group all, start;
    static const method by[] = {{"midpoint", 8}, {"midpoint", 10}};
    const double h = 1.75 + 0.25 * (_i % 3);
    stage s = {.system = system_of(&forms[0])};
    ck_assert(has_options(s.system, &by[_i / 3], &s.options));
    s.options.max_tail = -1;
    OK(tvi_ensemble_create(&s.ensemble, s.system, &s.options, SMALL, 1));
    ck_assert(has_lanes(s.ensemble));
    start_all(&start);
    all = start;
    OK(tvi_ensemble_integrate(s.ensemble, h, 40, all.t, all.q, all.p, all.status, NULL, NULL));
    expect_integrators(s, &all, &start, NULL, h, 40);
}
END_TEST

Suite *suite_lanes(void)
{
    Suite *suite = suite_create("lanes");
    TCase *tests = tcase_create("lanes");
    tcase_add_loop_test(tests, small_motions_go_by_themselves, 0, BY_THEMSELVES);
    tcase_add_loop_test(tests, members_outside_of_the_domain_fail, 0, OF_ONE_ORDER);
    tcase_add_loop_test(tests, new_jacobians_leave_those_of_others, 0, 6);
    tcase_add_test(tests, members_with_small_pivots_go_by_themselves);
    suite_add_tcase(suite, tests);
    return suite;
}
