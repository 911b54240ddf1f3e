/* test_scales.c - Tests the recommended g on the hard scenes of the bench: as many force evaluations as the g of the
 * scene, which is written by hand, for the same error. */
#include "bodies.h"
#include "scenes/hard.h"

#include <math.h>
#include <string.h>

static const double one[] = {1}, pythagorean[] = {3, 4, 5}, planets[] = {1, 1e-3, 1e-3, 1e-3};

/* ---- Those of bodies that are given ------------------------------------------------------------------------------ */

static const tvi_bodies centre = {.bodies = 1, .axes = 2, .mass = one};

static jet kepler_potential(const jet q[], jet t, void *ctx)
{
    const jet at[2] = {jet_const(0), jet_const(0)};
    (void)t, (void)ctx;
    return tvi_bodies_field(&centre, at, q);
}

static jet kepler_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    const jet at[2] = {jet_const(0), jet_const(0)};
    (void)p, (void)t, (void)ctx;
    return tvi_bodies_field_scale(&centre, at, q);
}

/* The Sun and the planets of bench/scenes/comet.c, in the order of that file. */
enum { BODIES = 5 };
static const double masses[BODIES] = {9.548e-4, 2.859e-4, 4.366e-5, 5.151e-5, 1};
static const tvi_bodies giants = {.bodies = BODIES, .axes = 3, .mass = masses};

static void places(jet t, jet at[3 * BODIES])
{
    static const double radius[] = {5.203, 9.555, 19.22, 30.11}, phase[] = {0, 2, 4, 5};
    for (int i = 0; i < 3 * BODIES; i++) at[i] = jet_const(0);
    for (int k = 0; k < BODIES - 1; k++) {
        const jet angle = jet_add(jet_mul(sqrt((1 + masses[k]) / pow(radius[k], 3)), t), phase[k]);
        at[3 * k] = jet_mul(radius[k], jet_cos(angle)), at[3 * k + 1] = jet_mul(radius[k], jet_sin(angle));
        for (int i = 0; i < 2; i++) at[12 + i] = jet_sub(at[12 + i], jet_mul(masses[k], at[3 * k + i]));
    }
}

static jet comet_potential(const jet q[], jet t, void *ctx)
{
    jet at[3 * BODIES];
    (void)ctx;
    places(t, at);
    return tvi_bodies_field(&giants, at, q);
}

static jet comet_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    jet at[3 * BODIES];
    (void)p, (void)ctx;
    places(t, at);
    return tvi_bodies_field_scale(&giants, at, q);
}

/* Sitnikov's two masses stand at 1/2 from the axis, as softening does. The coordinates pulsate. */
static const tvi_bodies pair = {.bodies = 1, .axes = 1, .mass = one, .softening = 0.5};

static jet sitnikov_potential(const jet q[], jet t, void *ctx)
{
    const jet at[1] = {jet_const(0)}, bend = jet_mul(0.6, jet_cos(t));
    (void)ctx;
    const jet V = jet_add(jet_mul(0.5, jet_mul(bend, jet_sqr(q[0]))), tvi_bodies_field(&pair, at, q));
    return jet_div(V, jet_add(1, bend));
}

static jet sitnikov_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    const jet at[1] = {jet_const(0)}, pulse = jet_sqrt(jet_add(1, jet_mul(0.6, jet_cos(t))));
    (void)p, (void)ctx;
    return jet_mul(pulse, tvi_bodies_field_scale(&pair, at, q));
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

/* bodies, or functions of its own. */
static const struct {
    const hard_scene *problem;
    tvi_bodies bodies;
    tvi_potential_fn *potential;
    tvi_rescale_fn *scale;
    double h;
} rows[] = {
    {&hard_kepler_90, {0}, kepler_potential, kepler_scale, 1.1},
    {&hard_kepler_99, {0}, kepler_potential, kepler_scale, 1.1},
    {&hard_kepler_999, {0}, kepler_potential, kepler_scale, 1.1},
    {&hard_pythagorean, {.bodies = 3, .axes = 2, .mass = pythagorean}, NULL, tvi_bodies_scale, 0.9},
    {&hard_three_planets, {.bodies = 4, .axes = 2, .mass = planets}, NULL, tvi_bodies_scale, 0.7},
    {&hard_comet, {0}, comet_potential, comet_scale, 0.1176},
    {&hard_sitnikov, {0}, sitnikov_potential, sitnikov_scale, 1},
};
enum { ROWS = sizeof rows / sizeof *rows };

/* The largest error of a coordinate at the end; of Kepler's problem, by its closed form. */
static double error_of(const hard_scene *problem, double t, const double q[])
{
    const scene *s = &problem->scene;
    double error = 0;
    for (int i = 0; i < s->n && s->reference; i++) error = fmax(error, fabs(q[i] - s->reference[i]));
    if (s->reference) return error;
    const long double e = 1 - (long double)s->q[0], E = kepler_anomaly(e, t);
    return fmax(fabs(q[0] - (double)(cosl(E) - e)), fabs(q[1] - (double)(sqrtl(1 - e * e) * sinl(E))));
}

static long evaluations(tvi_system *base, const hard_scene *problem, tvi_rescale_fn *g, void *ctx, double h,
                        double *error)
{
    const scene *s = &problem->scene;
    double t = 0, q[8], p[8];
    tvi_system *rescaled;
    tvi_integrator *integrator;
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, base, g, ctx), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, rescaled, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrate_to(integrator, h, s->t_end, &t, q, p, NULL, NULL), TVI_OK);
    const long count = tvi_integrator_stats(integrator)->force_evaluations;
    *error = error_of(problem, t, q);
    tvi_integrator_free(integrator);
    tvi_system_free(rescaled);
    tvi_system_free(base);
    return count;
}

/* With several h, since roundoff of the last pass decides whether a short run has some passes more. */
START_TEST(as_by_hand)
{
    enum { SIZES = 6 };
    const scene *s = &rows[_i].problem->scene;
    tvi_bodies b = rows[_i].bodies;
    long wanted = 0, count = 0;
    for (int k = 0; k < SIZES; k++) {
        const double h = rows[_i].h * (1 - 0.03 * k);
        double errors[2];
        tvi_system *base;
        ck_assert_int_eq(scene_system(s, &base), TVI_OK);
        wanted += evaluations(base, rows[_i].problem, rows[_i].problem->scale, NULL, h, &errors[0]);
        ck_assert_int_eq(b.bodies ? tvi_bodies_system(&base, &b)
                                  : tvi_system_potential(&base, s->n, NULL, rows[_i].potential, NULL),
                         TVI_OK);
        count += evaluations(base, rows[_i].problem, rows[_i].scale, &b, h, &errors[1]);
        ck_assert_msg(errors[1] <= 1.5 * errors[0] + 2e-11, "%.1e in the place of %.1e", errors[1], errors[0]);
    }
    ck_assert_msg(fabs((double)(count - wanted)) <= 0.02 * (double)wanted, "%ld in the place of %ld", count, wanted);
}
END_TEST

/* g at a state, from two steps of equal s: their times are in the ratio of g. */
static double time_of_a_step(const tvi_bodies *b, const double q0[])
{
    const double h = 1e-4;
    double t = 0, q[8], p[8] = {0};
    tvi_system *base, *rescaled;
    tvi_integrator *integrator;
    memcpy(q, q0, sizeof q);
    ck_assert_int_eq(tvi_bodies_system(&base, b), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, base, tvi_bodies_scale, (void *)b), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, rescaled, NULL), TVI_OK);
    ck_assert_int_eq(tvi_step(integrator, h, &t, q, p), TVI_OK);
    tvi_integrator_free(integrator);
    tvi_system_free(rescaled);
    tvi_system_free(base);
    return t / h;
}

/* All pairs of which one has a mass steer g, test particles too; sharpness is as documented. */
START_TEST(who_steers)
{
    static const double mass[] = {4, 5, 0, 0}, light[] = {9, 0.2, 0.3, 0};
    static const double q[] = {0, 0, 4, 0, 1, 0, 0, 2};
    const double k1 = pow(cbrt(9) / 4, -1.5), k1_of_three = pow(cbrt(9) / 4 + cbrt(4) + cbrt(5) / 3, -1.5);
    const double k3 = pow(9.2 / 64 + 9.3 + 0.5 / 27 + 9 / 8.0 + 0.2 * pow(20, -1.5) + 0.3 * pow(5, -1.5), -0.5);
    const tvi_bodies two = {.bodies = 3, .axes = 2, .mass = mass, .G = 1},
                     star = {.bodies = 2, .axes = 2, .mass = mass + 1};
    const double alone[8] = {0, 0, 0, 2};
    ck_assert_double_le(fabs(time_of_a_step(&two, q) / k1_of_three - 1), 1e-5);
    ck_assert_double_le(fabs(time_of_a_step(&star, alone) / sqrt(8 / 5.0) - 1), 1e-5);
    const tvi_bodies planets_of_one = {.bodies = 4, .axes = 2, .mass = light};
    ck_assert_double_le(fabs(time_of_a_step(&planets_of_one, q) / k3 - 1), 1e-5);
    tvi_bodies heavy = {.bodies = 2, .axes = 2, .mass = mass, .G = 4};
    ck_assert_double_le(fabs(time_of_a_step(&heavy, q) / (k1 / 2) - 1), 1e-5);
}
END_TEST

/* A star, a planet of hardly any mass and a comet without mass, whose pericentre g sees: the orbit of the comet is
 * right for each eccentricity, as its semi-major axis tells. */
START_TEST(a_comet_without_mass)
{
    static const double comet_masses[] = {1, 1e-12, 0}, steps[] = {0.1, 0.25, 0.5, 0.8, 1.1}, a = 3;
    const double e = 0.1 * _i + (_i == 10 ? -0.05 : 0), q0[] = {0, 0, 1, 0, -a * (1 + e), 0},
                 v0[] = {0, 0, 0, 1, 0, -sqrt((1 - e) / (1 + e) / a)};
    const tvi_bodies bodies = {.bodies = 3, .axes = 2, .mass = comet_masses, .sharpness = 3};
    double mass[6], q[6], p[6], v[6];
    tvi_bodies_masses(&bodies, mass);
    tvi_system *base, *rescaled;
    ck_assert_int_eq(tvi_system_potential(&base, 6, mass, tvi_bodies_potential, (void *)&bodies), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, base, tvi_bodies_scale, (void *)&bodies), TVI_OK);
    const tvi_options options = tvi_options_default();
    for (int k = 0; k < 5; k++) {
        tvi_integrator *integrator;
        double t = 0;
        memcpy(q, q0, sizeof q);
        tvi_bodies_momenta(&bodies, v0, p);
        ck_assert_int_eq(tvi_integrator_create(&integrator, rescaled, &options), TVI_OK);
        const tvi_status status = tvi_integrate(integrator, steps[k], 500, &t, q, p, NULL, NULL);
        const double tail = tvi_integrator_stats(integrator)->largest_tail;
        tvi_bodies_velocities(&bodies, p, v);
        const double energy = (v[4] * v[4] + v[5] * v[5]) / 2 - 1 / hypot(q[4] - q[0], q[5] - q[1]);
        const double error = fabs(-1 / (2 * energy) - a);
        ck_assert_msg(status != TVI_OK || error < 1e-2 || tail > 1e-2, "e = %g, h = %g: a is off by %g, the tail is %g",
                      e, steps[k], error, tail);
        if (steps[k] < 1)
            ck_assert_msg(status == TVI_OK && error < 1e-6 && tail < 1e-2, "e = %g, h = %g: %g, tail %g", e, steps[k],
                          error, tail);
        tvi_integrator_free(integrator);
    }
    tvi_system_free(rescaled);
    tvi_system_free(base);
}
END_TEST

/* Runs the comet of docs/adaptive.md to t = 200 in steps of h, and returns their number; q becomes its place. */
static long comet_among_planets(bool is_rescaled, double h, double place[3])
{
    static const double sun_to_comet[] = {1, 9.5e-4, 2.86e-4, 0};
    static const tvi_orbit orbits[] = {
        {.a = 5.2, .e = 0.048, .i = 0.02}, {.a = 9.55, .e = 0.054, .i = 0.04}, {.a = 6, .e = 0.95, .i = 0.1}};
    const tvi_bodies bodies = {.bodies = 4, .axes = 3, .mass = sun_to_comet};
    double t = 0, q[12] = {0}, v[12] = {0}, p[12];
    for (int k = 0; k < 3; k++)
        ck_assert_int_eq(tvi_orbit_state(&orbits[k], 1 + sun_to_comet[k + 1], q + 3 * (k + 1), v + 3 * (k + 1)),
                         TVI_OK);
    tvi_bodies_momenta(&bodies, v, p);
    tvi_bodies_to_centre(&bodies, q, p);
    tvi_system *base, *rescaled;
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_bodies_system(&base, &bodies), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, base, tvi_bodies_scale, (void *)&bodies), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, is_rescaled ? rescaled : base, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrate_to(integrator, h, 200, &t, q, p, NULL, NULL), TVI_OK);
    const long steps = tvi_integrator_stats(integrator)->steps;
    memcpy(place, q + 9, 3 * sizeof *place);
    tvi_integrator_free(integrator);
    tvi_system_free(rescaled);
    tvi_system_free(base);
    return steps;
}

/* Of docs/adaptive.md: 111 steps in s are as good as 10,000 in t, and half as many have a truncation error. */
START_TEST(a_comet_among_planets)
{
    static const struct {
        bool is_rescaled;
        double h, least_error, largest_error;
        int steps;
    } runs[] = {{true, 0.3, 0, 5e-13, 111},         /* 4e-14 */
                {true, 0.6, 1e-12, 1e-10, 56},      /* 9e-12 */
                {false, 0.02, 0, 5e-13, 10000},     /* 6e-14 */
                {false, 0.08, 1e-12, 1e-10, 2500}}; /* 7e-12 */
    double exact[3], q[3];
    (void)comet_among_planets(true, 0.05, exact);
    for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
        double error = 0;
        ck_assert_int_eq(comet_among_planets(runs[k].is_rescaled, runs[k].h, q), runs[k].steps);
        for (int i = 0; i < 3; i++) error = fmax(error, fabs(q[i] - exact[i]));
        ck_assert_msg(error >= runs[k].least_error && error <= runs[k].largest_error, "h = %g: %.1e", runs[k].h, error);
    }
}
END_TEST

Suite *suite_scales(void)
{
    Suite *suite = suite_create("scales");
    TCase *tests = tcase_create("scales");
    tcase_add_loop_test(tests, as_by_hand, 0, ROWS);
    tcase_add_test(tests, who_steers);
    tcase_add_loop_test(tests, a_comet_without_mass, 0, 11);
    tcase_add_test(tests, a_comet_among_planets);
    suite_add_tcase(suite, tests);
    return suite;
}
