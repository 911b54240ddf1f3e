/* test_zero.c - Tests that a constant in V, L or H changes neither the status of a step nor the orbit: the guard knows
 * no zero of the energy (integrator/guard.c). */
#include "stability.h"

#include <math.h>
#include <string.h>

/* ---- Motions ----------------------------------------------------------------------------------------------------- */

static jet spring(const jet q[]) { return jet_div(jet_sqr(q[0]), 2); }
static jet attraction(const jet q[]) { return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5)); }
static jet pendulum(const jet q[]) { return jet_neg(jet_cos(q[0])); }
static jet valley(const jet q[])
{
    const jet cubic = jet_mul(q[1], jet_sub(jet_sqr(q[0]), jet_div(jet_sqr(q[1]), 3)));
    return jet_add(jet_div(jet_dot(q, q, 2), 2), cubic);
}
static jet wells(const jet q[]) { return jet_mul(jet_sqr(q[0]), jet_sub(jet_div(jet_sqr(q[0]), 4), 0.5)); }
static jet moved_wells(const jet q[]) { return wells((const jet[]){jet_sub(q[0], 1)}); }
static jet flat_valley(const jet q[]) { return jet_div(jet_sqr(jet_sqr(q[0])), 4); }

/* `period` is about the shortest time in which the motion changes; `growth` is that of a small difference in a run,
 * in the order of magnitude: a passage between two wells enlarges it by 1 / 0.01. */
typedef struct {
    const char *name;
    jet (*potential)(const jet q[]);
    int n;
    double q[2], p[2], period, growth;
} motion;

static const motion motions[] = {
    {"spring from rest", spring, 1, {1}, {0}, 6.28, 1},
    {"spring", spring, 1, {0.3}, {0.8}, 6.28, 1},
    {"Kepler, e = 0.9, from the apocentre", attraction, 2, {1.9, 0}, {0, 0.22941573387056177}, 6.28, 1},
    {"Kepler, e = 0.9, from the pericentre", attraction, 2, {0.1, 0}, {0, 4.358898943540674}, 0.4, 1},
    {"pendulum from rest", pendulum, 1, {1.5}, {0}, 7, 1},
    {"pendulum that turns", pendulum, 1, {0.5}, {2.5}, 3, 1},
    {"Henon-Heiles from rest", valley, 2, {0.3, -0.35}, {0, 0}, 6.28, 1},
    {"Henon-Heiles", valley, 2, {0, 0.1}, {0.5, 0.1}, 6.28, 1},
    {"spring of order 4 from rest", flat_valley, 1, {1}, {0}, 7, 1},
    {"spring of order 4 from its equilibrium", flat_valley, 1, {0}, {0.7}, 7, 1},
    {"two wells, from between them", wells, 1, {0}, {0.01}, 6.28, 1e4},
    {"two wells, moved by 1", moved_wells, 1, {1}, {0.01}, 6.28, 1e4},
    {"small spring", spring, 1, {0.05}, {0}, 6.28, 1},
};
enum { MOTIONS = sizeof motions / sizeof *motions };

static const motion *motion_named(const char *name)
{
    for (int i = 0; i < MOTIONS; i++)
        if (strcmp(motions[i].name, name) == 0) return &motions[i];
    ck_abort_msg("no motion %s", name);
    return NULL;
}

/* ---- Systems ----------------------------------------------------------------------------------------------------- */

typedef struct {
    const motion *motion;
    double constant;
} energy;

static jet potential(const jet q[], jet t, void *ctx)
{
    const energy *e = ctx;
    (void)t;
    return jet_add(e->motion->potential(q), e->constant);
}

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_div(jet_dot(p, p, ((const energy *)ctx)->motion->n), 2), potential(q, t, ctx));
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_div(jet_dot(v, v, ((const energy *)ctx)->motion->n), 2), potential(q, t, ctx));
}

static jet time_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    const motion *a = ((const energy *)ctx)->motion;
    (void)p, (void)t;
    return jet_add(0.5, jet_div(jet_dot(q, q, a->n), 4));
}

enum { POTENTIAL, HAMILTONIAN, LAGRANGIAN, RESCALED, FORMS };

static tvi_system *system_of(int form, energy *e)
{
    tvi_system *system = NULL, *rescaled = NULL;
    const int n = e->motion->n;
    if (form == HAMILTONIAN) ck_assert_int_eq(tvi_system_hamiltonian(&system, n, hamiltonian, e), TVI_OK);
    else if (form == LAGRANGIAN) ck_assert_int_eq(tvi_system_lagrangian(&system, n, lagrangian, e), TVI_OK);
    else ck_assert_int_eq(tvi_system_potential(&system, n, NULL, potential, e), TVI_OK);
    if (form != RESCALED) return system;
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, system, time_scale, e), TVI_OK);
    tvi_system_free(system);
    return rescaled;
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

enum { STEPS = 25 };
static const double steps_a_period[] = {3, 8, 20, 100};
enum { SIZES = sizeof steps_a_period / sizeof *steps_a_period };

/* The results of runs with steps of all sizes. */
typedef struct {
    int made[SIZES];
    tvi_status status[SIZES];
    hard_state end[SIZES];
} outcome;

/* false: the method does not serve the form. */
static bool run(int form, energy e, const hard_method *m, outcome *out)
{
    tvi_system *system = system_of(form, &e);
    tvi_options options;
    tvi_integrator *integrator;
    ck_assert(hard_options(m, &options));
    const tvi_status served = tvi_integrator_create(&integrator, system, &options);
    for (int k = 0; served == TVI_OK && k < SIZES; k++) {
        hard_state x = {0, {e.motion->q[0], e.motion->q[1]}, {e.motion->p[0], e.motion->p[1]}};
        const double h = e.motion->period / steps_a_period[k];
        tvi_status status = TVI_OK;
        tvi_integrator_reset(integrator);
        out->made[k] = 0;
        while (out->made[k] < STEPS && (status = tvi_step(integrator, h, &x.t, x.q, x.p)) == TVI_OK) out->made[k]++;
        out->status[k] = status;
        out->end[k] = x;
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    ck_assert(served == TVI_OK || served == TVI_EUNSUPPORTED);
    return served == TVI_OK;
}

static double distance(const hard_state *a, const hard_state *b)
{
    double most = fabs(a->t - b->t);
    for (int i = 0; i < 2; i++) most = fmax(most, fmax(fabs(a->q[i] - b->q[i]), fabs(a->p[i] - b->p[i])));
    return most;
}

/* K = g (H + e) has the constant in H and in e, whose roundoff is left; else the forces are the same bits. The size of
 * e also decides whether a rescaled step that is far too large fails by its passes or by its energy. */
static void compare(int form, const energy *e, const hard_method *m, const outcome *plain, const outcome *shifted)
{
    const double roundoff = form == RESCALED ? 1e-12 * e->motion->growth * (1 + fabs(e->constant)) : 0;
    for (int k = 0; k < SIZES; k++) {
        const bool have_failed = plain->status[k] != TVI_OK && shifted->status[k] != TVI_OK,
                   is_alike = plain->status[k] == shifted->status[k] || (form == RESCALED && have_failed);
        const double apart = distance(&plain->end[k], &shifted->end[k]);
        ck_assert_msg(is_alike && plain->made[k] == shifted->made[k],
                      "%s, form %d, %s %d, constant %g, %g steps: %s after %d, without it %s after %d", e->motion->name,
                      form, m->name, m->order, e->constant, steps_a_period[k], tvi_status_string(shifted->status[k]),
                      shifted->made[k], tvi_status_string(plain->status[k]), plain->made[k]);
        ck_assert_msg(apart <= roundoff, "%s, form %d, %s %d, constant %g, %g steps: apart %g", e->motion->name, form,
                      m->name, m->order, e->constant, steps_a_period[k], apart);
    }
}

/* The orbits of these methods depend on the zero of a momentum, here of e = -H. */
static bool is_gauged(const hard_method *m)
{
    return strcmp(m->name, "htvi-right") == 0 || strcmp(m->name, "htvi-left") == 0 || strcmp(m->name, "svhd") == 0;
}

/* The equations of types II and III have the product of e and the time, whose roundoff may keep passes from ending. */
static bool loses_digits(const hard_method *m) { return strcmp(m->name, "right") == 0 || strcmp(m->name, "left") == 0; }

START_TEST(a_constant_does_not_show)
{
    const motion *a = &motions[_i / FORMS];
    const int form = _i % FORMS;
    tvi_system *system = system_of(POTENTIAL, &(energy){a, 0});
    double H;
    ck_assert_int_eq(tvi_energy(system, 0, a->q, a->p, &H), TVI_OK);
    tvi_system_free(system);
    const double constants[] = {-H, 1e-3 - H, 1, 1e3, 1e6, -1e6};
    for (int i = 0; i < method_count; i++) {
        outcome plain, shifted;
        if (form == RESCALED && is_gauged(&all_methods[i])) continue;
        if (!run(form, (energy){a, 0}, &all_methods[i], &plain)) continue;
        for (size_t k = 0; k < sizeof constants / sizeof *constants; k++) {
            const energy e = {a, constants[k]};
            if (form == RESCALED && fabs(e.constant) > 1e3 && loses_digits(&all_methods[i])) continue;
            run(form, e, &all_methods[i], &shifted);
            compare(form, &e, &all_methods[i], &plain, &shifted);
        }
    }
}
END_TEST

/* At q = 0 all multiples of q are the same place, which is no limit of the energy far away. */
START_TEST(the_origin_does_not_show)
{
    const motion *at_origin = motion_named("two wells, from between them"),
                 *moved = motion_named("two wells, moved by 1");
    for (int i = 0; i < method_count; i++) {
        outcome one, other;
        if (!run(_i, (energy){at_origin, 0}, &all_methods[i], &one)) continue;
        run(_i, (energy){moved, 0}, &all_methods[i], &other);
        for (int k = 1; k < SIZES; k++) /* with three steps a period passes fail by chance */
            ck_assert_msg(one.status[k] == other.status[k] && one.made[k] == other.made[k],
                          "form %d, %s %d, %g steps: %s after %d, moved %s after %d", _i, all_methods[i].name,
                          all_methods[i].order, steps_a_period[k], tvi_status_string(one.status[k]), one.made[k],
                          tvi_status_string(other.status[k]), other.made[k]);
    }
}
END_TEST

/* L = -sqrt(1 - v^2) - q^4/4, whose velocities are those of Newton's method. */
static jet relativistic(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_neg(jet_sqrt(jet_sub(1, jet_sqr(v[0])))), flat_valley(q));
}

/* The search for the reference level leaves nothing to the energies that are compared. */
START_TEST(right_steps_of_a_lagrangian_pass)
{
    static const hard_method methods[] = {{"tvi", 2, false}, {"galerkin", 4, false}, {"midpoint", 4, false}};
    tvi_system *system;
    tvi_options options;
    tvi_integrator *integrator;
    double t = 0, q = 1.2, p = 0.3;
    ck_assert_int_eq(tvi_system_lagrangian(&system, 1, relativistic, NULL), TVI_OK);
    ck_assert(hard_options(&methods[_i], &options));
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    for (int step = 0; step < 60; step++)
        ck_assert_msg(tvi_step(integrator, 0.23, &t, &q, &p) == TVI_OK, "%s, step %d: %s", methods[_i].name, step,
                      tvi_last_error());
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

Suite *suite_zero(void)
{
    Suite *suite = suite_create("zero");
    TCase *tcase = tcase_create("zero");
    tcase_add_loop_test(tcase, a_constant_does_not_show, 0, MOTIONS * FORMS);
    tcase_add_loop_test(tcase, the_origin_does_not_show, 0, RESCALED);
    tcase_add_loop_test(tcase, right_steps_of_a_lagrangian_pass, 0, 3);
    suite_add_tcase(suite, tcase);
    return suite;
}
