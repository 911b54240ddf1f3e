/* test_balance.c - Tests that the energy changes by the work of the forces, and a planet's orbit decays as its drag
 * says. */
#include "driven.h"

#include <math.h>

enum { NODES = 8 };
static const double node[NODES / 2] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363},
                                 weight[NODES / 2] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                                      0.1012285362903763};

/* Work in the last step, by the quadrature of "galerkin" 16: sum h b_i f_i v_i on the curve. */
static double work_of(const form *as, tvi_integrator *it, double t, double h)
{
    double sum = 0;
    for (int i = 0; i < NODES; i++) {
        const double c = (1 + (i % 2 ? 1 : -1) * node[i / 2]) / 2;
        double q, p, y, rate;
        ck_assert_int_eq(tvi_dense(it, c, &q, &p), TVI_OK);
        from_form(as, q, p, &y, &rate);
        sum += h * weight[i / 2] / 2 * rate * (AMPLITUDE * cos(OMEGA * (t + c * h)) - 2 * FRICTION * rate);
    }
    return sum;
}

/* The largest difference between what a step changes and its work. */
static double imbalance_of(const form *as, double h, int steps)
{
    tvi_system *system = system_of(as);
    tvi_integrator *it = integrator_of(system, "galerkin", 16);
    double t = 0, q, p, most = 0, before, after;
    to_form(as, 1, 0, &q, &p);
    for (int step = 0; step < steps; step++) {
        const double start = t;
        ck_assert_int_eq(tvi_energy(system, t, &q, &p, &before), TVI_OK);
        ck_assert_int_eq(tvi_step(it, h, &t, &q, &p), TVI_OK);
        ck_assert_int_eq(tvi_energy(system, t, &q, &p, &after), TVI_OK);
        most = fmax(most, fabs(after - before - work_of(as, it, start, h)));
    }
    tvi_integrator_free(it);
    tvi_system_free(system);
    return most;
}

/* To roundoff; and with steps so large that the energy of the step itself is not kept, not. */
START_TEST(work_is_the_change_of_energy)
{
    ck_assert_double_le(imbalance_of(&forms[_i], 0.125, 200), 1e-15);
    if (_i > 0) ck_assert_double_ge(imbalance_of(&forms[_i], 0.75, 8), 1e-10); /* of quadratic ones it is, for all h */
}
END_TEST

static jet quadratic(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(jet_sqr(q[0]), 2);
}

static void brake(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    force[0] = jet_mul(-2, v[0]);
}

/* y'' = -y - 2 y', y = (1 + t) e^-t: the energy falls by a third in each step, as that of a
 * closed system never does. */
START_TEST(heavy_friction_is_no_error)
{
    tvi_system *base, *system;
    ck_assert_int_eq(tvi_system_potential(&base, 1, NULL, quadratic, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_driven(&system, base, brake, NULL), TVI_OK);
    tvi_integrator *it = integrator_of(system, _i ? "taylor" : "galerkin", 16);
    double t = 0, q = 1, p = 0;
    ck_assert_int_eq(tvi_integrate(it, 0.25, 16, &t, &q, &p, NULL, NULL), TVI_OK);
    ck_assert_double_eq_tol(q, (1 + t) * exp(-t), 1e-14);
    ck_assert_double_eq_tol(p, -t * exp(-t), 1e-14);
    tvi_integrator_free(it);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* ---- A planet with drag ------------------------------------------------------------------------------------------ */

static const double SUN = 39.47841760435743, DRAG = 1e-7; /* astronomical units and years */

static jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_div(SUN, jet_hypot(q[0], q[1])));
}

static void drag(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    for (int i = 0; i < 2; i++) force[i] = jet_mul(-DRAG, v[i]);
}

/* dL/dt = -DRAG L on any orbit, da/dt = -2 DRAG a on a circle: 10^5 years, the rates to 1e-6 of themselves. */
START_TEST(orbit_decays_at_its_rate)
{
    static const double YEARS = 1e5, H = 0.0625;
    tvi_system *base, *system;
    ck_assert_int_eq(tvi_system_potential(&base, 2, NULL, kepler, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_driven(&system, base, drag, NULL), TVI_OK);
    tvi_integrator *it = integrator_of(system, "galerkin", 16);
    double t = 0, q[] = {1, 0}, p[] = {0, sqrt(SUN)}, energy;
    const double L = q[0] * p[1];
    ck_assert_int_eq(tvi_integrate(it, H, (long)(YEARS / H), &t, q, p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(tvi_energy(base, t, q, p, &energy), TVI_OK);
    const double of_L = -log((q[0] * p[1] - q[1] * p[0]) / L) / t, of_a = -log(-SUN / (2 * energy)) / t;
    ck_assert_double_eq_tol(of_L / DRAG, 1, 1e-9);
    ck_assert_double_eq_tol(of_a / (2 * DRAG), 1, 1e-6);
    tvi_integrator_free(it);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

Suite *suite_balance(void)
{
    Suite *suite = suite_create("balance");
    TCase *tests = tcase_create("balance");
    tcase_add_loop_test(tests, work_is_the_change_of_energy, 0, FORMS);
    tcase_add_loop_test(tests, heavy_friction_is_no_error, 0, 2);
    tcase_add_test(tests, orbit_decays_at_its_rate);
    suite_add_tcase(suite, tests);
    return suite;
}
