/* test_unguarded.c - Tests steps that are too large for the orbit and are not refused by the guard: what ends with
 * TVI_OK solves the equations of the step, whatever motion that is. */
#include "invariance.h"
#include "methods.h"

#include <math.h>

static jet central(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(jet_const(-1), jet_sqrt(jet_add(jet_sqr(q[0]), jet_sqr(q[1]))));
}

typedef struct {
    double q[2], p[2];
} state;

static tvi_status step_unguarded(const tvi_system *system, const tvi_options *options, double h, state *x)
{
    tvi_integrator *integrator;
    tvi_options unguarded = *options;
    double t = 0;
    unguarded.max_tail = -1;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &unguarded), TVI_OK);
    const tvi_status status = tvi_step(integrator, h, &t, x->q, x->p);
    tvi_integrator_free(integrator);
    return status;
}

static double relative_distance(const double x[2], const double y[2])
{
    return hypot(x[0] - y[0], x[1] - y[1]) / hypot(y[0], y[1]);
}

/* The state at this angle from the pericentre of an orbit of eccentricity e, whose period is 2 pi. */
static state state_at(double e, double angle)
{
    const double r = (1 - e * e) / (1 + e * cos(angle)), v = 1 / sqrt(1 - e * e);
    return (state){{r * cos(angle), r * sin(angle)}, {-v * sin(angle), v * (e + cos(angle))}};
}

/* The step -h of a symmetric method leads back from each solution. Near a pericentre, and at up to a sixth of the
 * period, the series of a prediction have terms of any size, and nothing may count as small beside them. Equations with
 * several solutions may lead back to another one: one of the 780 steps at e = 0.6 did. */
START_TEST(steps_and_back)
{
    enum { ANGLES = 5, HALVINGS = 10, OTHER_SOLUTIONS = 3 };
    static const int degrees[] = {4, 8, 12};
    static const double eccentricities[] = {0.6, 0.9, 0.99}, angles[ANGLES] = {0, 1e-8, 0.1, 2, 3.14};
    complaints c = complaints_of("Kepler, e = %g", eccentricities[_i]);
    method_list list = {0};
    tvi_system *system;
    const double mass[2] = {1, 1};
    int solved = 0;
    ck_assert_int_eq(tvi_system_potential(&system, 2, mass, central, NULL), TVI_OK);
    add_methods(system, 3, degrees, false, &list);
    for (int i = 0; i < list.count; i++)
        for (int k = 0; k < (is_symmetric(&list.options[i]) ? ANGLES * HALVINGS : 0); k++) {
            const double h = acos(-1) / 3 / pow(2, k / ANGLES);
            const state start = state_at(eccentricities[_i], angles[k % ANGLES]);
            state x = start;
            if (step_unguarded(system, &list.options[i], h, &x) != TVI_OK) continue;
            if (step_unguarded(system, &list.options[i], -h, &x) != TVI_OK) continue;
            const double distance = relative_distance(x.q, start.q) + relative_distance(x.p, start.p);
            solved++;
            if (!(distance <= 1e-6))
                complain(&c, "%s, angle %g, h = %g: back to %g of the start\n", describe(&list.options[i]),
                         angles[k % ANGLES], h, distance);
        }
    tvi_system_free(system);
    ck_assert_int_gt(solved, 200);
    if (c.count > OTHER_SOLUTIONS) expect_none(&c);
}
END_TEST

Suite *suite_unguarded(void)
{
    Suite *suite = suite_create("unguarded");
    TCase *tcase = tcase_create("unguarded");
    tcase_add_loop_test(tcase, steps_and_back, 0, 3);
    suite_add_tcase(suite, tcase);
    return suite;
}
