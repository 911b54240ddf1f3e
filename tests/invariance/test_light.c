/* test_light.c - Tests that a light oscillator that a heavy one drives has the error that it has where masses do not
 * matter, as in the equations of a potential. */
#include "invariance.h"
#include "methods.h"

#include <float.h>
#include <math.h>

/* q_0'' = -q_0 and q_1'' = -w^2 q_1 - c q_0, but for what the light one does to the heavy one. */
#define FREQUENCY 100.0
#define COUPLING  10.0

static jet potential(const jet q[], jet t, void *ctx)
{
    const double m = *(const double *)ctx;
    const jet of_light =
        jet_add(jet_mul(FREQUENCY * FREQUENCY / 2, jet_sqr(q[1])), jet_mul(COUPLING, jet_mul(q[0], q[1])));
    (void)t;
    return jet_add(jet_div(jet_sqr(q[0]), 2), jet_mul(m, of_light));
}

/* With d/dt (m q^2 / 2) in L, so that p = m (v + q) and nothing is separable. */
static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    const double mass[] = {1, *(const double *)ctx};
    jet sum = potential(q, t, ctx);
    for (int i = 0; i < 2; i++)
        sum = jet_add(sum, jet_div(jet_sqr(jet_sub(p[i], jet_mul(mass[i], q[i]))), 2 * mass[i]));
    return sum;
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    const double mass[] = {1, *(const double *)ctx};
    jet sum = jet_neg(potential(q, t, ctx));
    for (int i = 0; i < 2; i++)
        sum = jet_add(sum, jet_mul(mass[i], jet_add(jet_div(jet_sqr(v[i]), 2), jet_mul(q[i], v[i]))));
    return sum;
}

static void no_drag(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    for (int i = 0; i < 2; i++) force[i] = jet_mul(0x1p-1000, v[i]);
}

static tvi_status make_potential(tvi_system **system, double *m)
{
    const double mass[] = {1, *m};
    return tvi_system_potential(system, 2, mass, potential, m);
}

static tvi_status make_hamiltonian(tvi_system **system, double *m)
{
    return tvi_system_hamiltonian(system, 2, hamiltonian, m);
}

static tvi_status make_lagrangian(tvi_system **system, double *m)
{
    return tvi_system_lagrangian(system, 2, lagrangian, m);
}

static tvi_status make_driven(tvi_system **system, double *m)
{
    tvi_system *base;
    tvi_status status = make_potential(&base, m);
    if (status != TVI_OK) return status;
    status = tvi_system_driven(system, base, no_drag, NULL);
    tvi_system_free(base);
    return status;
}

static const struct {
    const char *name;
    tvi_status (*make)(tvi_system **system, double *m);
    bool has_gauge;
} forms[] = {{"potential", make_potential, false},
             {"driven", make_driven, false},
             {"Hamiltonian", make_hamiltonian, true},
             {"Lagrangian", make_lagrangian, true}};
enum { FORMS = sizeof forms / sizeof *forms, PHASES = 20 };

/* The light one released from rest where the phase is 0. */
static void set_state(int form, double m, int phase, double t, double q[], double p[])
{
    const double angle = 2 * acos(-1) * phase / PHASES, mass[] = {1, m};
    const double part = -COUPLING / (FREQUENCY * FREQUENCY - 1); /* of q_0, that q_1 follows */
    q[0] = cos(t + 1);
    q[1] = part * q[0] + cos(FREQUENCY * t + angle);
    const double v[] = {-sin(t + 1), -part * sin(t + 1) - FREQUENCY * sin(FREQUENCY * t + angle)};
    for (int i = 0; i < 2; i++) p[i] = mass[i] * (v[i] + (forms[form].has_gauge ? q[i] : 0));
}

/* In units of roundoff, of all phases. */
static double error_of_light(int form, double m, const tvi_options *options)
{
    const double h = 0.5 / FREQUENCY;
    double worst = 0;
    tvi_system *system;
    tvi_integrator *integrator;
    ck_assert_int_eq(forms[form].make(&system, &m), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    for (int phase = 0; phase < PHASES; phase++) {
        double t = 0, q[2], p[2], q_exact[2], p_exact[2];
        set_state(form, m, phase, t, q, p);
        const tvi_status status = tvi_integrate(integrator, h, 20, &t, q, p, NULL, NULL);
        set_state(form, m, phase, t, q_exact, p_exact);
        worst = fmax(worst, status == TVI_OK ? fabs(q[1] - q_exact[1]) / DBL_EPSILON : INFINITY);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return worst;
}

/* The masses are so small that the heavy one is not disturbed; powers of two. */
START_TEST(light_oscillator_is_solved)
{
    static const char *const methods[] = {"galerkin", "midpoint", "poincare", "right", "left", "start", "taylor"};
    complaints c = complaints_of("%s", forms[_i].name);
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        tvi_options options;
        double m = 1, error[2];
        tvi_system *system;
        ck_assert_int_eq(tvi_options_named(methods[i], 16, &options), TVI_OK);
        ck_assert_int_eq(forms[_i].make(&system, &m), TVI_OK);
        const bool serves = tvi_options_check(system, &options, NULL) == TVI_OK;
        tvi_system_free(system);
        if (!serves) continue;
        for (int k = 0; k < 2; k++) error[k] = error_of_light(_i, k == 0 ? 0x1p-60 : 0x1p-100, &options);
        const double alone = error_of_light(0, 0x1p-60, &options);
        for (int k = 0; k < 2; k++)
            if (!(error[k] <= 2 * alone + 4))
                complain(&c, "%s, mass 2^%d: %.3g units, of a potential %.3g\n", methods[i], k == 0 ? -60 : -100,
                         error[k], alone);
    }
    expect_none(&c);
}
END_TEST

Suite *suite_light(void)
{
    Suite *suite = suite_create("light");
    TCase *tcase = tcase_create("light");
    tcase_add_loop_test(tcase, light_oscillator_is_solved, 0, FORMS);
    suite_add_tcase(suite, tcase);
    return suite;
}
