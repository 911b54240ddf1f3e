/* input_steps.c - Tests steps that cannot be made: each has its status and leaves the state bit for bit as it was. The
 * contracts are those of tvi.h. */
#include "input.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- Steps refused at once --------------------------------------------------------------------------------------- */

typedef struct {
    const char *name;
    double h;
    state s;
    tvi_status status;
    const char *culprit;
} bad_step;

#define SOUND                                                                                                          \
    {0.5, 0.25}, { 0.5, 0.5 }

static const bad_step bad_steps[] = {
    {"h = 0", 0, {0, SOUND}, TVI_EINVAL, "h is 0"},
    {"h = -0", -0.0, {0, SOUND}, TVI_EINVAL, "h is 0"},
    {"h NaN", NAN, {0, SOUND}, TVI_EINVAL, "h = "},
    {"h infinite", INFINITY, {0, SOUND}, TVI_EINVAL, "h = inf"},
    {"h minus infinite", -INFINITY, {0, SOUND}, TVI_EINVAL, "h = -inf"},
    {"t NaN", 0.1, {NAN, SOUND}, TVI_ENONFINITE, "t = "},
    {"t infinite", 0.1, {-INFINITY, SOUND}, TVI_ENONFINITE, "t = -inf"},
    {"q NaN", 0.1, {0, {NAN, 0.25}, {0.5, 0.5}}, TVI_ENONFINITE, "q[0]"},
    {"the last q NaN", 0.1, {0, {0.5, NAN}, {0.5, 0.5}}, TVI_ENONFINITE, "q[1]"},
    {"q infinite", 0.1, {0, {0.5, INFINITY}, {0.5, 0.5}}, TVI_ENONFINITE, "q[1] = inf"},
    {"p NaN", 0.1, {0, {0.5, 0.25}, {NAN, 0.5}}, TVI_ENONFINITE, "p[0]"},
    {"the last p NaN", 0.1, {0, {0.5, 0.25}, {0.5, NAN}}, TVI_ENONFINITE, "p[1]"},
    {"p infinite", 0.1, {0, {0.5, 0.25}, {0.5, -INFINITY}}, TVI_ENONFINITE, "p[1] = -inf"},
    {"t overflows", DBL_MAX, {DBL_MAX, SOUND}, TVI_ETOOLARGE, "step of 1.79769e+308"},
    {"t overflows, back", -DBL_MAX, {-DBL_MAX, SOUND}, TVI_ETOOLARGE, "step of -1.79769e+308"},
    {"q overflows", 1e10, {0, {1e300, 0.25}, {1e300, 0.5}}, TVI_ENONFINITE, "step of 1e+10"},
    {"the force overflows", 0.1, {0, {1e308, 1e308}, {0, 0}}, TVI_ENONFINITE, "step of 0.1 from t = 0"},
};

/* Calls tvi_step and tvi_integrate. */
static void expect_bad_step(const char *method_name, tvi_integrator *integrator, const bad_step *bad)
{
    char what[100];
    snprintf(what, sizeof what, "%s with %s", bad->name, method_name);
    state s = bad->s;
    expect_refusal(what, tvi_step(integrator, bad->h, &s.t, s.q, s.p), bad->status, bad->culprit);
    expect_same(what, &s, &bad->s);
    expect_refusal(what, tvi_integrate(integrator, bad->h, 3, &s.t, s.q, s.p, NULL, NULL), bad->status, bad->culprit);
    expect_same(what, &s, &bad->s);
    ck_assert_int_eq(tvi_integrator_stats(integrator)->steps, 0);
}

START_TEST(refused_steps)
{
    tvi_system *system = create_scene(&scene_henon_heiles_12);
    tvi_integrator *integrator = create_integrator(system, &methods[_i]);
    for (size_t i = 0; i < sizeof bad_steps / sizeof *bad_steps; i++)
        expect_bad_step(methods[_i].name, integrator, &bad_steps[i]);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Steps that the time does not show are made, and add up: 16 steps of 1/4 where doubles are 4 apart. */
START_TEST(steps_below_the_time)
{
    tvi_system *system = create_scene(&scene_henon_heiles_12);
    tvi_options options = options_of(&methods[_i]);
    tvi_integrator *integrator;
    options.max_tail = -1; /* for the lowest orders 1/4 is too large */
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    const double start = 18014398509481984.0; /* 2^54 */
    state s = {start, SOUND};
    for (int step = 0; step < 16; step++) {
        expect(methods[_i].name, tvi_step(integrator, 0.25, &s.t, s.q, s.p), TVI_OK);
        ck_assert(s.t == start || s.t == start + 4);
    }
    ck_assert_double_eq(s.t, start + 4);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

START_TEST(null_arguments)
{
    tvi_system *system = create_scene(&scene_henon_heiles_12);
    tvi_integrator *it = create_integrator(system, &methods[_i]);
    const state was = {0, SOUND};
    state s = was;
    refused("integrator is ", tvi_step(NULL, 0.1, &s.t, s.q, s.p), TVI_EINVAL);
    refused("t is ", tvi_step(it, 0.1, NULL, s.q, s.p), TVI_EINVAL);
    refused("q is ", tvi_step(it, 0.1, &s.t, NULL, s.p), TVI_EINVAL);
    refused("p is ", tvi_step(it, 0.1, &s.t, s.q, NULL), TVI_EINVAL);
    for (long steps = 0; steps <= 2; steps++) {
        refused("integrator is ", tvi_integrate(NULL, 0.1, steps, &s.t, s.q, s.p, NULL, NULL), TVI_EINVAL);
        refused("t is ", tvi_integrate(it, 0.1, steps, NULL, s.q, s.p, NULL, NULL), TVI_EINVAL);
        refused("q is ", tvi_integrate(it, 0.1, steps, &s.t, NULL, s.p, NULL, NULL), TVI_EINVAL);
        refused("p is ", tvi_integrate(it, 0.1, steps, &s.t, s.q, NULL, NULL, NULL), TVI_EINVAL);
        refused("h is ", tvi_integrate(it, 0, steps, &s.t, s.q, s.p, NULL, NULL), TVI_EINVAL);
    }
    refused("steps is ", tvi_integrate(it, 0.1, -1, &s.t, s.q, s.p, NULL, NULL), TVI_EINVAL);
    expect_same("null", &s, &was);
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* ---- Steps where the force has no value -------------------------------------------------------------------------- */

static jet root(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sqrt(jet_add(q[0], q[1]));
}

static jet quotient(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(q[1], q[0]);
}

static jet arc(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_asin(jet_mul(q[0], q[1]));
}

static jet late(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return jet_mul(jet_log(t), q[0]);
}

static const struct {
    const char *name;
    tvi_potential_fn *potential;
    state s;
    const char *culprit;
} no_force[] = {
    {"sqrt of negative", root, {0, {-1, 0.5}, {0, 0}}, "jet_sqrt has no power series at -0.5: operation 2 of"},
    {"sqrt of zero", root, {0, {-1, 1}, {0, 0}}, "jet_sqrt has no power series at 0: operation 2 of"},
    {"division by zero", quotient, {0, {0, 1}, {0, 0}}, "jet_div has no power series at 0"},
    {"asin of one", arc, {0, {1, 1}, {0, 0}}, "jet_sqrt in the derivatives of jet_asin has no power series at 0"},
    {"asin beyond one", arc, {0, {-2, 1}, {0, 0}}, "jet_sqrt in the derivatives of jet_asin has no power series at -3"},
    {"log of a negative time", late, {-1, {1, 1}, {0, 0}}, "jet_log has no power series at -"},
};

tvi_status step_once(tvi_integrator *integrator, double h, state *s)
{
    const state was = *s;
    const tvi_status status = tvi_step(integrator, h, &s->t, s->q, s->p);
    if (status == TVI_OK) ck_assert_msg(state_is_finite(s), "h = %g, t = %g: not finite", h, was.t);
    else expect_same(tvi_status_string(status), s, &was);
    return status;
}

START_TEST(no_force_at_the_start)
{
    for (size_t i = 0; i < sizeof no_force / sizeof *no_force; i++) {
        tvi_system *system = create_system(2, no_force[i].potential);
        tvi_integrator *integrator = create_integrator(system, &methods[_i]);
        state s = no_force[i].s;
        const char *const culprit = no_force[i].culprit;
        refused(culprit, step_once(integrator, 0.1, &s), TVI_EDOMAIN);
        refused(culprit, step_once(integrator, -0.1, &s), TVI_EDOMAIN);
        refused(culprit, tvi_integrate(integrator, 0.1, 3, &s.t, s.q, s.p, NULL, NULL), TVI_EDOMAIN);
        tvi_integrator_free(integrator);
        tvi_system_free(system);
    }
}
END_TEST

START_TEST(kepler_at_the_centre)
{
    tvi_system *system = create_scene(&scene_kepler);
    tvi_integrator *integrator = create_integrator(system, &methods[_i]);
    state s = {0, {0, 0}, {0, 0}};
    expect(methods[_i].name, step_once(integrator, 0.1, &s), TVI_EDOMAIN);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* F = sqrt q - 1 has a value at q = 0, and no series. */
static void root_force(const jet q[], jet t, jet force[], void *ctx)
{
    (void)t, (void)ctx;
    force[0] = jet_sub(jet_sqrt(q[0]), 1);
}

/* At q = 0, and for Stormer-Verlet, which uses the force at both ends, one step away from it. */
START_TEST(no_series_of_the_force)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_force(&system, 1, NULL, root_force, NULL), TVI_OK);
    tvi_integrator *integrator = create_integrator(system, &methods[_i]);
    state at = {0}, before = {0, {1}, {-1}};
    expect(methods[_i].name, step_once(integrator, 0.125, &at), TVI_EDOMAIN);
    if (strcmp(methods[_i].name, "stormer-verlet") == 0) expect("end", step_once(integrator, 1, &before), TVI_EDOMAIN);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* ---- Steps far too large ----------------------------------------------------------------------------------------- */

static bool is_step_failure(tvi_status status)
{
    return status == TVI_EDOMAIN || status == TVI_ENOCONV || status == TVI_ESINGULAR || status == TVI_ENONFINITE ||
           status == TVI_ETOOLARGE;
}

/* h = 1e-3 .. 1e6 and back: each step is made with a finite result or fails with a reason. */
START_TEST(large_steps)
{
    pair x;
    if (!open_pair(&x, _i)) return;
    tvi_integrator *integrator = create_integrator(x.system, x.m);
    for (int j = 0; j <= 180; j++) {
        const double h = pow(10, j / 10 / 2.0 - 3) * (j % 2 ? -1 : 1) * (1 + j % 10 / 20.0);
        state s = start_of(x.problem);
        const tvi_status status = step_once(integrator, h, &s);
        ck_assert_msg(status == TVI_OK || is_step_failure(status), "%s, h = %g: %d", x.name, h, (int)status);
        if (fabs(h) < 0.01) expect(x.name, status, TVI_OK);
    }
    tvi_integrator_free(integrator);
    close_pair(&x);
}
END_TEST

static const double extremes[] = {0, DBL_TRUE_MIN, -1e-300, 1e-8, 1, -30, 1e20, -1e150, 1e200, DBL_MAX};
enum { EXTREMES = sizeof extremes / sizeof *extremes };

/* The same from states and with steps of every size. */
START_TEST(extreme_states)
{
    pair x;
    if (!open_pair(&x, _i)) return;
    tvi_integrator *integrator = create_integrator(x.system, x.m);
    for (int i = 0; i < EXTREMES * EXTREMES * EXTREMES; i++) {
        const double q = extremes[i % EXTREMES], p = extremes[i / EXTREMES % EXTREMES];
        const double h = extremes[i / EXTREMES / EXTREMES];
        state s = {.t = i % 7 ? 0 : q};
        for (int j = 0; j < x.problem->n; j++) {
            s.q[j] = j % 2 ? p : q;
            s.p[j] = j % 2 ? q : p;
        }
        const tvi_status status = step_once(integrator, h, &s);
        ck_assert_msg(status == TVI_OK || status == TVI_EINVAL || is_step_failure(status), "%s: %d", x.name,
                      (int)status);
    }
    tvi_integrator_free(integrator);
    close_pair(&x);
}
END_TEST

/* A step that no contraction reaches ends with TVI_ENOCONV, and the bound on the passes is kept. */
START_TEST(no_convergence)
{
    tvi_system *system = create_scene(&scene_kepler);
    tvi_options options;
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_options_named("midpoint", 8, &options), TVI_OK);
    options.max_passes = 1;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    state s = start_of(&scene_kepler);
    expect("one pass", step_once(integrator, 0.25, &s), TVI_ENOCONV);
    ck_assert_int_eq(tvi_integrator_stats(integrator)->passes, 1);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* L = q x'^2 / 2: L_vv = q, regular but where the step starts. */
static jet massless_at_the_origin(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_mul(q[0], jet_sqr(v[0])));
}

START_TEST(singular_at_the_start)
{
    static const char *const names[] = {"start", "midpoint", "taylor"};
    tvi_system *system;
    ck_assert_int_eq(tvi_system_lagrangian(&system, 1, massless_at_the_origin, NULL), TVI_OK);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        tvi_options options;
        tvi_integrator *integrator;
        state s = {0, {0}, {1}};
        const state was = s;
        ck_assert_int_eq(tvi_options_named(names[i], 4, &options), TVI_OK);
        ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
        expect(names[i], tvi_step(integrator, 0.1, &s.t, s.q, s.p), TVI_ESINGULAR);
        expect_same(names[i], &s, &was);
        s.q[0] = 1;
        expect(names[i], tvi_step(integrator, 0.1, &s.t, s.q, s.p), TVI_OK);
        tvi_integrator_free(integrator);
    }
    tvi_system_free(system);
}
END_TEST

/* ---- The cases --------------------------------------------------------------------------------------------------- */

TCase *tcase_bad_steps(void)
{
    TCase *tcase = tcase_create("bad steps");
    tcase_add_loop_test(tcase, refused_steps, 0, method_count);
    tcase_add_loop_test(tcase, steps_below_the_time, 0, method_count);
    tcase_add_loop_test(tcase, null_arguments, 0, method_count);
    tcase_add_loop_test(tcase, no_force_at_the_start, 0, method_count);
    tcase_add_loop_test(tcase, kepler_at_the_centre, 0, method_count);
    tcase_add_loop_test(tcase, no_series_of_the_force, 0, method_count);
    tcase_add_loop_test(tcase, large_steps, 0, problem_count * method_count);
    tcase_add_loop_test(tcase, extreme_states, 0, problem_count * method_count);
    tcase_add_test(tcase, no_convergence);
    tcase_add_test(tcase, singular_at_the_start);
    return tcase;
}
