/* test_same.c - Tests that generated code gives what the tape gives, to roundoff: in the time of make check one system
 * with one method for each kind of text that generators write, with TVI_COMPILED=all every scene with every method. */
#include "compiled.h"
#include "method/list.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const whose kepler = {&scene_kepler, 0.1, false, NULL}, pendulum = {&scene_pendulum, 0.2, false, NULL},
                   henon_heiles = {&scene_henon_heiles_12, 0.25, false, NULL}, fpu = {&scene_fpu, 0.02, false, NULL},
                   solar = {&scene_solar, 100, false, NULL}, ring = {&scene_ring, 0.15, false, NULL},
                   double_pendulum = {&scene_double_pendulum, 0.01, false, NULL},
                   magnetic = {&scene_magnetic, 0.05, false, NULL},
                   nonseparable = {&scene_nonseparable, 0.05, false, NULL},
                   vortices = {&scene_vortices, 0.02, false, NULL}, degenerate = {&scene_degenerate, 0.05, false, NULL},
                   kepler_rescaled = {&scene_kepler, 0.2, true, NULL},
                   henon_heiles_rescaled = {&scene_henon_heiles_12, 0.2, true, NULL},
                   chain = {NULL, 0.05, false, &problem_chain};

/* The emitters choose by the form of the system, by the number of lanes (1, 2, 4, 8, 12 for the orders 2, 4, 6, 16, 20,
 * and 8 that are not all full for the order 10), by the number of unknowns, and by the operations. Each choice is made
 * by one of these, and each method has one. The library's own flags compile a separable system, a Lagrangian, the
 * series of a Hamiltonian, and a rescaled system. */
static const struct {
    const whose *subject;
    const char *method;
    int order;
    how_compiled how;
} runs[] = {
    {&kepler, "galerkin", 16, USUAL}, /* few unknowns, in registers; powers */
    {&kepler, "galerkin", 2, QUICK},
    {&pendulum, "galerkin", 4, QUICK},
    {&henon_heiles, "galerkin", 6, WIDE},
    {&chain, "galerkin", 6, QUICK}, /* a force that knows the time */
    {&fpu, "galerkin", 16, QUICK},
    {&ring, "galerkin", 20, WIDE},   /* elementary functions, quotients */
    {&solar, "galerkin", 16, QUICK}, /* too many unknowns for registers, equal operations in runs */
    {&solar, "galerkin", 2, QUICK},
    {&double_pendulum, "galerkin", 6, USUAL},
    {&double_pendulum, "galerkin", 16, QUICK},
    {&magnetic, "galerkin", 20, QUICK},
    {&nonseparable, "galerkin", 16, QUICK},
    {&vortices, "galerkin", 6, QUICK},
    {&degenerate, "galerkin", 10, QUICK},
    {&kepler_rescaled, "galerkin", 16, USUAL},
    {&kepler_rescaled, "taylor", 8, QUICK},
    {&nonseparable, "midpoint", 8, USUAL}, /* the series of a curve */
    {&kepler, "midpoint", 8, WIDE},
    {&fpu, "midpoint", 8, QUICK},
    {&chain, "midpoint", 6, QUICK},
    {&ring, "poincare", 4, WIDE}, /* products with Jacobians */
    {&ring, "poincare", 4, QUICK},
    {&ring, "svhd", 2, QUICK},
    {&nonseparable, "tvi", 2, QUICK},
    {&fpu, "tvi", 2, QUICK},
    {&henon_heiles, "left", 4, QUICK},
    {&henon_heiles, "right", 4, QUICK},
    {&vortices, "htvi-right", 3, QUICK},
    {&magnetic, "start", 4, QUICK},
    {&double_pendulum, "end", 4, QUICK},
    {&degenerate, "both-ends", 6, QUICK},
    {&solar, "symmetric-tvi", 2, QUICK},
    {&pendulum, "stormer-verlet", 2, QUICK},
};

static const whose *const all_systems[] = {
    &pendulum, &kepler,       &henon_heiles, &fpu,        &solar,           &double_pendulum,      &magnetic,
    &ring,     &nonseparable, &vortices,     &degenerate, &kepler_rescaled, &henon_heiles_rescaled};
static const struct {
    const char *name;
    int order;
} methods[] = {{"galerkin", 16},     {"galerkin", 6}, {"midpoint", 8},  {"taylor", 10},
               {"symmetric-tvi", 2}, {"tvi", 2},      {"right", 4},     {"left", 4},
               {"htvi-right", 3},    {"poincare", 4}, {"both-ends", 6}, {"svhd", 2},
               {"start", 4},         {"end", 4},      {"galerkin", 20}, {"stormer-verlet", 2}};
enum {
    RUNS = sizeof runs / sizeof *runs,
    SYSTEMS = sizeof all_systems / sizeof *all_systems,
    METHODS = sizeof methods / sizeof *methods,
    STEPS = 100
};

/* Steps from the scene's start, and from two that are wrong by units of roundoff, to either side: the largest
 * difference that these make, and the passes of all three. */
typedef struct {
    motion m;
    tvi_stats stats;
    double roundoff;
    long passes;
} travels;

static travels go_three_times(const tvi_system *system, const tvi_options *options, const scene *s, double h)
{
    travels all = {.m = motion_start(s)};
    ck_assert_int_eq(motion_go(system, options, h, STEPS, &all.m, &all.stats), TVI_OK);
    all.passes = all.stats.passes;
    for (int units = -2; units <= 2; units += 4) {
        motion moved = motion_start(s);
        tvi_stats stats;
        for (int i = 0; i < s->n; i++) moved.q[i] *= 1 + units * DBL_EPSILON, moved.p[i] *= 1 - units * DBL_EPSILON;
        ck_assert_int_eq(motion_go(system, options, h, STEPS, &moved, &stats), TVI_OK);
        all.roundoff = fmax(all.roundoff, motion_difference(s->n, &all.m, &moved));
        all.passes += stats.passes;
    }
    return all;
}

/* Nothing is compared if the method does not serve the system. */
static void expect_the_same(const whose *subject, const char *method, int order, how_compiled how)
{
    const scene *s = scene_of(subject);
    const tvi_compiler compiler = compiler_of(how);
    systems its;
    const tvi_system *system = systems_open(subject, &its);
    tvi_options options, compiled;
    tvi_compiled *code;
    ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    if (order < 16) options.max_tail = -1;
    compiled = options;
    if (tvi_options_check(system, &options, NULL) == TVI_OK) {
        ck_assert_msg(tvi_compile(&code, system, &options, &compiler) == TVI_OK, "%s", tvi_last_error());
        compiled.compiled = code;
        const travels of_tape = go_three_times(system, &options, s, subject->h),
                      of_code = go_three_times(system, &compiled, s, subject->h);
        const tvi_stats tape = of_tape.stats, own = of_code.stats;
        ck_assert(own.is_compiled && !tape.is_compiled);
        const double difference = motion_difference(s->n, &of_tape.m, &of_code.m);
        const double most = 64 * DBL_EPSILON + 8 * of_tape.roundoff;
        ck_assert_msg(difference <= most, "%s, %s %d: %.2e, where %.2e is roundoff", s->name, method, order, difference,
                      most);
        ck_assert_msg(labs(of_code.passes - of_tape.passes) <= 3 * STEPS / 4, "%s, %s: %ld passes, %ld of the tape",
                      s->name, method, of_code.passes, of_tape.passes);
        ck_assert_int_le(labs(own.factorisations - tape.factorisations), STEPS / 4 + tape.factorisations / 4);
        ck_assert_double_eq_tol(own.tail, tape.tail, 1e-3 * tape.tail + 64 * DBL_EPSILON);
        tvi_compiled_free(code);
    }
    systems_free(&its);
}

START_TEST(compiled_steps_are_those_of_the_tape)
{
    expect_the_same(runs[_i].subject, runs[_i].method, runs[_i].order, runs[_i].how);
}
END_TEST

START_TEST(all_systems_with_all_methods)
{
    for (int i = 0; i < METHODS && runs_all(); i++)
        expect_the_same(all_systems[_i], methods[i].name, methods[i].order, USUAL);
}
END_TEST

/* Runs to a tolerance, whose errors are far above roundoff: all steps have the sizes that they have on the tape. The
 * library's own flags compile the first one; the last one runs with TVI_COMPILED=all. */
static const scene *const adaptive[] = {&scene_kepler, &scene_magnetic, &scene_vortices, &scene_double_pendulum,
                                        &scene_solar};
enum { ADAPTIVE = sizeof adaptive / sizeof *adaptive };

START_TEST(compiled_runs_to_a_tolerance)
{
    const scene *s = adaptive[_i];
    systems its;
    const tvi_system *system = systems_open(&(whose){s, 0, false, NULL}, &its);
    tvi_options options;
    tvi_compiled *code;
    motion end[2];
    tvi_stats stats[2];
    const tvi_compiler compiler = compiler_of(_i == 0 || runs_all() ? USUAL : QUICK);
    ck_assert_int_eq(tvi_options_named("taylor", 8, &options), TVI_OK);
    options.max_tail = -1;
    ck_assert_int_eq(tvi_compile(&code, system, &options, &compiler), TVI_OK);
    for (int i = 0; i < 2; i++) {
        tvi_integrator *integrator;
        motion *m = &end[i];
        *m = motion_start(s);
        options.compiled = i > 0 ? code : NULL;
        ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
        ck_assert_int_eq(tvi_integrate_tolerance(integrator, 1e-6, s->t_end / 10, &m->t, m->q, m->p, NULL, NULL),
                         TVI_OK);
        stats[i] = *tvi_integrator_stats(integrator);
        tvi_integrator_free(integrator);
    }
    ck_assert(stats[1].is_compiled && !stats[0].is_compiled);
    ck_assert_int_eq(stats[1].steps, stats[0].steps);
    ck_assert_double_eq_tol(stats[1].tail, stats[0].tail, 1e-9 * stats[0].tail + DBL_EPSILON);
    ck_assert_double_le(motion_difference(s->n, &end[0], &end[1]), 1e-12);
    tvi_compiled_free(code);
    systems_free(&its);
}
END_TEST

/* A fall into the center: the last step fails where that of the tape does, and says the same. */
START_TEST(steps_fail_as_those_of_the_tape)
{
    tvi_system *system;
    tvi_options options = tvi_options_default();
    tvi_compiled *code;
    tvi_stats stats[2];
    tvi_status status[2];
    char why[2][200];
    const tvi_compiler compiler = compiler_of(USUAL);
    ck_assert_int_eq(scene_system(&scene_kepler, &system), TVI_OK);
    ck_assert_int_eq(tvi_compile(&code, system, &options, &compiler), TVI_OK);
    for (int i = 0; i < 2; i++) {
        motion m = {.q = {1, 0.5}};
        options.compiled = i > 0 ? code : NULL;
        status[i] = motion_go(system, &options, 0.05 + 0.01 * _i, 100, &m, &stats[i]);
        snprintf(why[i], sizeof why[i], "%s", tvi_last_error());
    }
    ck_assert_int_ne(status[0], TVI_OK);
    ck_assert_int_eq(status[1], status[0]);
    ck_assert_int_gt(stats[0].steps, 10);
    ck_assert_int_eq(stats[1].steps, stats[0].steps);
    ck_assert_str_eq(why[1], why[0]);
    ck_assert_double_eq_tol(stats[1].tail, stats[0].tail, 1e-6 * stats[0].tail);
    ck_assert_double_eq_tol(stats[1].largest_tail, stats[0].largest_tail, 1e-6 * stats[0].largest_tail);
    tvi_compiled_free(code);
    tvi_system_free(system);
}
END_TEST

/* H = p (p/2 + 1 + sin(q)/2): from p = 0 the momenta at the nodes are roundoff, which only the library measures. */
static jet drifting(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(p[0], jet_add(jet_mul(0.5, p[0]), jet_add(1, jet_mul(0.5, jet_sin(q[0])))));
}

START_TEST(momenta_that_are_roundoff_are_found)
{
    tvi_system *system;
    tvi_options options;
    tvi_compiled *code;
    tvi_stats stats;
    motion m[2];
    const tvi_compiler compiler = compiler_of(QUICK);
    ck_assert_int_eq(tvi_system_hamiltonian(&system, 1, drifting, NULL), TVI_OK);
    ck_assert_int_eq(tvi_options_named("start", 4, &options), TVI_OK);
    options.max_tail = -1;
    ck_assert_int_eq(tvi_compile(&code, system, &options, &compiler), TVI_OK);
    for (int i = 0; i < 2; i++) {
        options.compiled = i > 0 ? code : NULL;
        m[i] = (motion){.q = {0.3}};
        ck_assert_int_eq(motion_go(system, &options, 0.01, 1, &m[i], &stats), TVI_OK);
    }
    ck_assert(stats.is_compiled);
    ck_assert_double_eq_tol(m[1].q[0], m[0].q[0], 4 * DBL_EPSILON);
    ck_assert_double_eq_tol(m[1].p[0], m[0].p[0], 1e-12);
    tvi_compiled_free(code);
    tvi_system_free(system);
}
END_TEST

/* An oscillator of frequency 100 and of a mass of 2^-100 beside one that it does not know, released from rest. */
static jet beside(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_div(jet_sqr(q[0]), 2), jet_mul(0x1p-100 * 5000, jet_sqr(q[1])));
}

static void drag(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    force[0] = jet_mul(-1e-9, v[0]);
    force[1] = jet_const(0);
}

START_TEST(light_body_is_solved)
{
    static const double mass[] = {1, 0x1p-100};
    tvi_system *base, *system;
    tvi_options options = tvi_options_default();
    tvi_compiled *code;
    tvi_stats stats;
    motion m = {.q = {1, 1}, .p = {0.5, 0}};
    const tvi_compiler compiler = compiler_of(QUICK);
    ck_assert_int_eq(tvi_system_potential(&base, 2, mass, beside, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_driven(&system, base, drag, NULL), TVI_OK);
    ck_assert_int_eq(tvi_compile(&code, system, &options, &compiler), TVI_OK);
    options.compiled = code;
    ck_assert_int_eq(motion_go(system, &options, 0.005, 200, &m, &stats), TVI_OK);
    ck_assert(stats.is_compiled);
    ck_assert_double_eq_tol(m.q[1], cos(100.0), 64 * DBL_EPSILON);
    ck_assert_double_gt(stats.largest_tail, 1e-10);
    tvi_compiled_free(code);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* The text that the compiler is given is the one that runs: with a number of the tape changed there, the motion is
 * another. */
START_TEST(another_code_moves_otherwise)
{
    static const char *const names[] = {"galerkin", "midpoint"};
    const tvi_compiler broken = {.compiler = "sh tests/compiled/edited.sh s/-0x1\\.8p+0/-0x1.4p+0/ " QUICK_COMPILER,
                                 .flags = QUICK_FLAGS,
                                 .cache = ""};
    for (int i = 0; i < 2; i++) {
        tvi_system *system;
        tvi_options options;
        tvi_compiled *code;
        tvi_stats stats;
        ck_assert_int_eq(scene_system(&scene_kepler, &system), TVI_OK);
        ck_assert_int_eq(tvi_options_named(names[i], 8, &options), TVI_OK);
        motion of_tape = motion_start(&scene_kepler), of_code = of_tape;
        ck_assert_int_eq(motion_go(system, &options, 0.1, STEPS, &of_tape, &stats), TVI_OK);
        ck_assert_int_eq(tvi_compile(&code, system, &options, &broken), TVI_OK);
        options.compiled = code;
        ck_assert_int_eq(motion_go(system, &options, 0.1, STEPS, &of_code, &stats), TVI_OK);
        ck_assert_msg(motion_difference(2, &of_tape, &of_code) > 1e-3, "%s", names[i]);
        tvi_compiled_free(code);
        tvi_system_free(system);
    }
}
END_TEST

/* For "galerkin" one function makes whole steps, from the first one on, with the passes of the tape; the tail that it
 * tells is changed here. */
START_TEST(steps_are_whole)
{
    static const whose *const subject[] = {&kepler, &double_pendulum, &kepler_rescaled};
    const tvi_compiler edited = {
        .compiler = "sh tests/compiled/edited.sh s/outcome->last_tail.=.tail;/outcome->last_tail=7;/ " QUICK_COMPILER,
        .flags = QUICK_FLAGS,
        .cache = ""};
    for (size_t i = 0; i < sizeof subject / sizeof *subject; i++) {
        systems its;
        const tvi_system *system = systems_open(subject[i], &its);
        tvi_options options;
        tvi_compiled *code;
        ck_assert_int_eq(tvi_options_named("galerkin", 8, &options), TVI_OK);
        options.max_tail = -1;
        ck_assert_int_eq(tvi_compile(&code, system, &options, &edited), TVI_OK);
        for (int steps = 1; steps <= 3; steps++) {
            motion of_tape = motion_start(subject[i]->scene), of_code = of_tape;
            tvi_stats tape, own;
            options.compiled = NULL;
            ck_assert_int_eq(motion_go(system, &options, subject[i]->h, steps, &of_tape, &tape), TVI_OK);
            options.compiled = code;
            ck_assert_int_eq(motion_go(system, &options, subject[i]->h, steps, &of_code, &own), TVI_OK);
            ck_assert_double_lt(tape.tail, 1);
            ck_assert_double_eq(own.tail, 7);
            ck_assert_int_le(labs(own.passes - tape.passes), steps);
        }
        tvi_compiled_free(code);
        systems_free(&its);
    }
}
END_TEST

Suite *suite_same(void)
{
    Suite *suite = suite_create("same");
    TCase *same = tcase_create("scenes"), *control = tcase_create("control");
    tcase_add_loop_test(same, compiled_steps_are_those_of_the_tape, 0, RUNS);
    tcase_add_loop_test(same, all_systems_with_all_methods, 0, SYSTEMS);
    tcase_add_loop_test(same, compiled_runs_to_a_tolerance, 0, runs_all() ? ADAPTIVE : ADAPTIVE - 1);
    tcase_add_loop_test(same, steps_fail_as_those_of_the_tape, 0, 3);
    tcase_add_test(same, momenta_that_are_roundoff_are_found);
    tcase_add_test(same, light_body_is_solved);
    tcase_add_test(same, steps_are_whole);
    tcase_add_test(control, another_code_moves_otherwise);
    suite_add_tcase(suite, same);
    suite_add_tcase(suite, control);
    return suite;
}
