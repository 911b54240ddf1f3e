/* test_structure.c - Tests that a step in s is symplectic in (q, t) and (p, e), and nearly keeps K; the field without
 * the terms (H+e) has the same orbit, and its steps are not. */
#include "rescaled.h"
#include "integrator/integrator.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { N = 3, ROWS = 2 * N }; /* of the driven problem */

/* The largest element of M^T Omega M - Omega, relative to the squares of M. */
static double defect(double M[ROWS][ROWS])
{
    double most = 0, size = 1;
    for (int a = 0; a < ROWS; a++)
        for (int b = 0; b < ROWS; b++) {
            double sum = b == a + N ? -1 : a == b + N ? 1 : 0;
            for (int i = 0; i < N; i++) sum += M[i][a] * M[i + N][b] - M[i + N][a] * M[i][b];
            most = fmax(most, fabs(sum));
            size = fmax(size, M[a][b] * M[a][b]);
        }
    return most / size;
}

/* (q, t, p, e) at the start. */
static void extended_start(const tvi_system *rescaled, double q[N], double p[N])
{
    const state x = driven_start();
    double H;
    ck_assert_int_eq(tvi_energy(rescaled, x.t, x.q, x.p, &H), TVI_OK);
    for (int i = 0; i < 2; i++) q[i] = x.q[i], p[i] = x.p[i];
    q[2] = x.t, p[2] = -H;
}

/* By the Jacobian of the step in all of (q, t, p, e), also where K is not 0. */
START_TEST(steps_are_symplectic)
{
    static const double off_orbit[] = {0, 0.05};
    tvi_system *rescaled = rescaled_system(2, driven_mass, driven, driven_scale);
    const tvi_options options = options_of(&all_served[_i]);
    for (int k = 0; k < 2; k++) {
        tvi_integrator *integrator;
        double q[N], p[N], s = 0, M[ROWS][ROWS] = {{0}};
        extended_start(rescaled, q, p);
        p[2] += off_orbit[k];
        for (int i = 0; i < ROWS; i++) M[i][i] = 1;
        ck_assert_int_eq(tvi_integrator_create(&integrator, rescaled->stepped_system, &options), TVI_OK);
        for (int step = 0; step < 3; step++)
            ck_assert_int_eq(tvi_step_tangent(integrator, 0.25, &s, q, p, &M[0][0], ROWS), TVI_OK);
        const bool is_symplectic = strcmp(all_served[_i].name, "taylor") != 0;
        if (is_symplectic) ck_assert_double_le(defect(M), 1e-14);
        else ck_assert_double_ge(defect(M), 1e-8);
        tvi_integrator_free(integrator);
    }
    tvi_system_free(rescaled);
}
END_TEST

/* ---- The implicit midpoint rule by hand -------------------------------------------------------------------------- */

typedef long double number;

/* H, g and their derivatives at z = (x, y, t, px, py, e), once more. */
static void derivatives(const number z[ROWS], number *H, number dH[ROWS], number *g, number dg[ROWS])
{
    const number x = z[0], y = z[1], t = z[2], px = z[3], py = z[4], k = 1 + cosl(t) / 2;
    const number square = x * x + 2 * y * y + x * y, inverse = 1 + x * x + (py * py + sinl(t)) / 4;
    *H = px * px / 2 + py * py / 5 + k * square / 2 + x * x * x * x / 4 + x * x * y;
    *g = 1 / inverse;
    const number of_H[ROWS] = {k * (2 * x + y) / 2 + x * x * x + 2 * x * y,
                               k * (4 * y + x) / 2 + x * x,
                               -sinl(t) * square / 4,
                               px,
                               py / 2.5L,
                               0};
    const number of_g[ROWS] = {2 * x, 0, cosl(t) / 4, 0, py / 2, 0};
    for (int i = 0; i < ROWS; i++) dH[i] = of_H[i], dg[i] = -of_g[i] / (inverse * inverse);
}

/* z' of K; without the terms (H+e) where share is 0. */
static void field(const number z[ROWS], number share, number rate[ROWS])
{
    number H, g, dH[ROWS], dg[ROWS], dK[ROWS];
    derivatives(z, &H, dH, &g, dg);
    dH[5] = 1;
    for (int i = 0; i < ROWS; i++) dK[i] = g * dH[i] + share * (H + z[5]) * dg[i];
    for (int i = 0; i < N; i++) rate[i] = dK[i + N], rate[i + N] = -dK[i];
}

static void midpoint(number h, number share, number z[ROWS])
{
    number middle[ROWS], rate[ROWS];
    memcpy(middle, z, sizeof middle);
    for (int pass = 0; pass < 100; pass++) {
        field(middle, share, rate);
        for (int i = 0; i < ROWS; i++) middle[i] = z[i] + h / 2 * rate[i];
    }
    for (int i = 0; i < ROWS; i++) z[i] += h * rate[i];
}

static double defect_by_hand(const number start[ROWS], number share)
{
    const number d = 1e-5L;
    double M[ROWS][ROWS];
    for (int column = 0; column < ROWS; column++) {
        number z[2][ROWS];
        for (int side = 0; side < 2; side++) {
            memcpy(z[side], start, sizeof z[side]);
            z[side][column] += side ? d : -d;
            for (int step = 0; step < 3; step++) midpoint(0.25L, share, z[side]);
        }
        for (int row = 0; row < ROWS; row++) M[row][column] = (double)((z[1][row] - z[0][row]) / (2 * d));
    }
    return defect(M);
}

/* The library's step is that by hand, which is symplectic; that of the field without the terms is not. */
START_TEST(midpoint_rule_by_hand)
{
    run r = open_run(rescaled_system(2, driven_mass, driven, driven_scale), "poincare", 2, &(state){0});
    r.x = driven_start();
    double q[N], p[N];
    number z[ROWS];
    extended_start(r.system, q, p);
    for (int i = 0; i < N; i++) z[i] = q[i], z[i + N] = p[i];
    ck_assert_double_le(defect_by_hand(z, 1), 1e-8);
    ck_assert_double_ge(defect_by_hand(z, 0), 1e-3);
    ck_assert_int_eq(run_steps(&r, 0.25, 3), TVI_OK);
    for (int step = 0; step < 3; step++) midpoint(0.25L, 1, z);
    const state by_hand = {(double)z[2], {(double)z[0], (double)z[1]}, {(double)z[3], (double)z[4]}};
    ck_assert_double_le(state_distance(2, &r.x, &by_hand), 4e-15);
    close_run(&r);
}
END_TEST

/* ---- e ----------------------------------------------------------------------------------------------------------- */

/* -H at the start, in long double, where H in double has lost two digits by cancellation; its low part, too. The
 * roundoff of H is up to 1.1e-13, that of a number near 1000: of twelve orbits it is above 1e-14 once at least, but for
 * a chance of 0.1^12. */
START_TEST(e_has_no_roundoff)
{
    enum { ORBITS = 12 };
    number largest = 0;
    for (int k = 0; k < ORBITS; k++) {
        run r = open_kepler(0.999 + 1e-5 * k, kepler_scale, NULL, 0);
        const state x = r.x;
        double H;
        ck_assert_int_eq(run_steps(&r, 0.1, 1), TVI_OK);
        const tvi_run_state *now = &r.integrator->state;
        const number e = (number)now->p[2] + now->p_low[2];
        const number exact = (number)x.p[1] * x.p[1] / 2 - 1 / (number)x.q[0];
        ck_assert_int_eq(tvi_energy(r.system, x.t, x.q, x.p, &H), TVI_OK);
        ck_assert(fabsl(e + exact) <= 1e-16L);
        largest = fmaxl(largest, fabsl(H - exact));
        close_run(&r);
    }
    ck_assert(largest >= 1e-14L);
}
END_TEST

/* ---- Long runs --------------------------------------------------------------------------------------------------- */

static double energy_of(const run *r)
{
    double H;
    ck_assert_int_eq(tvi_energy(r->system, r->x.t, r->x.q, r->x.p, &H), TVI_OK);
    return H;
}

/* In 200 revolutions at e = 0.9, equal steps of s keep the energy as well in the second half as in the first; Taylor's
 * method, of the same order, does not. */
static double growth(const char *method, int order, double h, long steps)
{
    run r = open_kepler(0.9, kepler_scale, method, order);
    double most[2] = {0};
    for (long step = 0; step < steps; step++) {
        ck_assert_int_eq(run_steps(&r, h, 1), TVI_OK);
        double *of_half = &most[2 * step / steps];
        *of_half = fmax(*of_half, fabs(energy_of(&r) + 0.5));
    }
    close_run(&r);
    return most[1] / most[0];
}

START_TEST(energy_is_bounded)
{
    ck_assert_double_le(growth("galerkin", 8, 0.5, 4000), 1.05);
    ck_assert_double_le(growth("poincare", 8, 0.5, 4000), 1.05);
    ck_assert_double_ge(growth("taylor", 8, 0.5, 4000), 1.8);
}
END_TEST

Suite *suite_structure(void)
{
    Suite *suite = suite_create("structure");
    TCase *tests = tcase_create("structure");
    tcase_add_loop_test(tests, steps_are_symplectic, 0, SERVED);
    tcase_add_test(tests, midpoint_rule_by_hand);
    tcase_add_test(tests, e_has_no_roundoff);
    tcase_add_test(tests, energy_is_bounded);
    suite_add_tcase(suite, tests);
    return suite;
}
