/* test_guard.c - Tests that steps that are too large are refused, and steps that are right are not: a ladder of steps,
 * each step beside one that is not looked at (docs/stability.md). */
#include "stability.h"
#include "stability/ladder.h"

#include <math.h>
#include <string.h>

static const hard_method climbers[] = {
    {"galerkin", 16, false}, {"galerkin", 8, false}, {"midpoint", 16, false}, {"midpoint", 8, false},
    {"poincare", 16, false}, {"poincare", 8, false}, {"right", 8, false},     {"start", 16, false},
    {"both-ends", 8, false}, {"taylor", 16, false},  {"tvi", 8, false},       {"stormer-verlet", 2, false},
    {"galerkin", 2, false},  {"start", 4, false},    {"tvi", 2, false}, /* whose tail is 0; */
    {"left", 10, false},                                                /* and is so where something is at rest */
};
enum { CLIMBERS = sizeof climbers / sizeof *climbers };

static tvi_integrator *open_integrator(const tvi_system *system, const hard_method *m, double max_tail)
{
    tvi_options options;
    tvi_integrator *integrator;
    ck_assert(hard_options(m, &options));
    options.max_tail = max_tail;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    return integrator;
}

/* A part of what `make guard` climbs: no step that is accepted is wrong, and none that is refused is right. A step of
 * Stormer-Verlet may change the energy (a_stable_step_is_accepted). */
START_TEST(ladder)
{
    const ladder_case *c = &ladder_cases[_i / CLIMBERS];
    const hard_method *m = &climbers[_i % CLIMBERS];
    ladder_counts sum = {0};
    for (double steps = 6; steps <= 3200; steps *= 2.6) {
        const ladder_counts rung = ladder_climb(c, m, c->period / steps, 60);
        ladder_add(&sum, &rung);
    }
    if (!c->problem->lagrangian) ck_assert_int_gt(sum.accepted, 70); /* which not all of them serve */
    ck_assert_msg(sum.wrong == 0 || ladder_is_explicit(m), "%s, %s %d: %ld wrong, %.3f", c->title, m->name, m->order,
                  sum.wrong, sum.most);
    ck_assert_msg(sum.right == 0, "%s, %s %d: %ld right", c->title, m->name, m->order, sum.right);
    if (c->problem == &kepler_99.scene) ck_assert_int_gt(sum.refused, 0); /* there are such steps */
}
END_TEST

/* The options: none is refused, or all but the smallest; what is counted, and what a reset forgets. */
START_TEST(options_of_the_guard)
{
    static const hard_method method = {"galerkin", 8, false};
    tvi_system *system;
    const hard_state start = start_of(&kepler_99);
    ck_assert_int_eq(hard_system(&kepler_99, &system), TVI_OK);
    tvi_integrator *strict = open_integrator(system, &method, 1e-9), *blind = open_integrator(system, &method, -1);
    hard_state x = start;
    tvi_integrator *usual = open_integrator(system, &method, 0);
    ck_assert_double_eq(tvi_integrator_options(usual)->max_tail, TVI_MAX_TAIL);
    tvi_integrator_free(usual);
    ck_assert_int_eq(tvi_step(strict, 0.1, &x.t, x.q, x.p), TVI_ETOOLARGE);
    ck_assert(memcmp(&x, &start, sizeof x) == 0);
    const double tail = tvi_integrator_stats(strict)->largest_tail;
    ck_assert_double_gt(tail, 1e-9);
    ck_assert_int_eq(tvi_step(strict, 1e-4, &x.t, x.q, x.p), TVI_OK);
    ck_assert_double_eq(tvi_integrator_stats(strict)->largest_tail, tail);
    tvi_integrator_reset(strict);
    ck_assert_double_eq(tvi_integrator_stats(strict)->largest_tail, 0);
    for (int step = 0; step < 40; step++) (void)!tvi_step(blind, 0.5, &x.t, x.q, x.p);
    ck_assert_double_gt(tvi_integrator_stats(blind)->largest_tail, 0.05);
    tvi_integrator_free(strict);
    tvi_integrator_free(blind);
    tvi_system_free(system);
}
END_TEST

static jet attraction(const jet q[], jet t, void *ctx)
{
    (void)t;
    return jet_mul(-*(const double *)ctx, jet_pow(jet_add(jet_sqr(q[0]), jet_sqr(q[1])), -0.5));
}

/* From the pericentre of e = 0.9, of a body of this mass, steps of 1e-3 units and more: their statuses, a bit for each,
 * set where it is TVI_ETOOLARGE, but not since it overflows, which knows units. */
static unsigned long refused_steps(const tvi_system *system, const hard_method *m, double mass, double unit)
{
    unsigned long refused = 0;
    for (double h = 1e-3; h < 10; h *= 1.25) {
        tvi_integrator *integrator = open_integrator(system, m, 0);
        double t = 0, q[] = {0.1, 0}, p[] = {0, mass * sqrt(19)};
        const bool is_too_large = tvi_step(integrator, unit * h, &t, q, p) == TVI_ETOOLARGE;
        refused = 2 * refused + (is_too_large && !strstr(tvi_last_error(), "overflow"));
        tvi_integrator_free(integrator);
    }
    return refused;
}

static unsigned long refused_with_mass(const hard_method *m, double mass)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 2, (const double[]){mass, mass}, attraction, &mass), TVI_OK);
    const unsigned long refused = refused_steps(system, m, mass, 1);
    tvi_system_free(system);
    return refused;
}

/* The refusals depend on no unit of the energy. Masses are powers of two, so that all else is the same bit for bit, as
 * long as what runs off overflows with none of them. */
START_TEST(masses_do_not_show)
{
    const unsigned long of_unit_mass = refused_with_mass(&climbers[_i], 1);
    ck_assert_uint_eq(refused_with_mass(&climbers[_i], 0x1p-60), of_unit_mass);
    ck_assert_uint_eq(refused_with_mass(&climbers[_i], 0x1p60), of_unit_mass);
    ck_assert(_i > 1 || of_unit_mass != 0); /* galerkin */
}
END_TEST

/* g = r^(3/2) / unit. */
static jet scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_div(jet_pow(jet_add(jet_sqr(q[0]), jet_sqr(q[1])), 0.75), *(const double *)ctx);
}

static unsigned long refused_with_scale(const hard_method *m, double unit)
{
    double mass = 1;
    tvi_system *system, *rescaled;
    ck_assert_int_eq(tvi_system_potential(&system, 2, NULL, attraction, &mass), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, system, scale, &unit), TVI_OK);
    const unsigned long refused = refused_steps(rescaled, m, mass, unit);
    tvi_system_free(rescaled);
    tvi_system_free(system);
    return refused;
}

/* Nor one of g, which K has and the energy has not. */
START_TEST(scales_do_not_show)
{
    static const hard_method methods[] = {{"taylor", 16, false}, {"taylor", 8, false}, {"left", 4, false}};
    for (int i = 0; i < 3; i++) {
        const unsigned long of_unit_scale = refused_with_scale(&methods[i], 1);
        ck_assert_uint_ne(of_unit_scale, 0);
        ck_assert_uint_eq(refused_with_scale(&methods[i], 0x1p-20), of_unit_scale);
        ck_assert_uint_eq(refused_with_scale(&methods[i], 0x1p20), of_unit_scale);
    }
}
END_TEST

static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t;
    const double *stiffness = ctx;
    return jet_add(jet_mul(stiffness[0] / 2, jet_sqr(q[0])), jet_mul(stiffness[1] / 2, jet_sqr(q[1])));
}

/* The status of a step of Stormer-Verlet from q and p, of two masses. */
static tvi_status verlet_status(const double mass[2], tvi_potential_fn *V, void *ctx, double h, const double start[4])
{
    static const hard_method verlet = {"stormer-verlet", 2, false};
    tvi_system *system;
    double t = 0, q[] = {start[0], start[1]}, p[] = {start[2], start[3]};
    ck_assert_int_eq(tvi_system_potential(&system, 2, mass, V, ctx), TVI_OK);
    tvi_integrator *it = open_integrator(system, &verlet, 0);
    const tvi_status status = tvi_step(it, h, &t, q, p);
    tvi_integrator_free(it);
    tvi_system_free(system);
    return status;
}

/* Stormer-Verlet changes the energy of an oscillator and comes back if h w < 2, where it is stable. Such steps are
 * accepted, and others are refused with a text that is true, in any unit of the coordinates; the second oscillator is
 * slow, and large in its own unit. A step that changes the energy by more than all of it is refused. */
START_TEST(a_stable_step_is_accepted)
{
    for (double unit = 0x1p-20; unit <= 0x1p20; unit *= 0x1p20) {
        const double mass[] = {1 / (unit * unit), 1};
        double stiffness[] = {9 * mass[0], 1e-8};
        const double start[] = {unit, 1e3, 0.7 / unit, 1e-3}, middle[] = {0.3 * unit, 1e3, 2 / unit, 1e-3};
        for (double phase = 1.81; phase < 2.2; phase += 0.05) {
            const tvi_status status = verlet_status(mass, spring, stiffness, phase / 3, start);
            ck_assert_msg(status == (phase < 2 ? TVI_OK : TVI_ETOOLARGE), "h w = %g, unit %g: %s", phase, unit,
                          tvi_status_string(status));
            ck_assert(status == TVI_OK ||
                      (strstr(tvi_last_error(), "h w = 2.") && strstr(tvi_last_error(), "max_tail")));
        }
        ck_assert_int_eq(verlet_status(mass, spring, stiffness, 1.95 / 3, middle), TVI_ETOOLARGE);
        ck_assert_ptr_nonnull(strstr(tvi_last_error(), "all of it (max_tail"));
    }
}
END_TEST

Suite *suite_guard(void)
{
    Suite *suite = suite_create("guard");
    TCase *tcase = tcase_create("guard");
    int cases = 0;
    while (ladder_cases[cases].problem) cases++;
    tcase_add_loop_test(tcase, ladder, 0, cases * CLIMBERS);
    tcase_add_test(tcase, options_of_the_guard);
    tcase_add_loop_test(tcase, masses_do_not_show, 0, CLIMBERS);
    tcase_add_test(tcase, scales_do_not_show);
    tcase_add_test(tcase, a_stable_step_is_accepted);
    suite_add_tcase(suite, tcase);
    return suite;
}
