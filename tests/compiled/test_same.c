/* Generated code gives what the tape gives, on every scene and method, to roundoff. */
#include "compiled.h"
#include "problems/problems.h"
#include "method/list.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const whose runs[] = {
    {&scene_pendulum, 0.2, false},      {&scene_kepler, 0.1, false},      {&scene_henon_heiles_12, 0.25, false},
    {&scene_fpu, 0.02, false},          {&scene_solar, 100, false},       {&scene_double_pendulum, 0.01, false},
    {&scene_magnetic, 0.05, false},     {&scene_ring, 0.15, false},       {&scene_nonseparable, 0.05, false},
    {&scene_vortices, 0.02, false},     {&scene_degenerate, 0.05, false}, {&scene_kepler, 0.2, true},
    {&scene_henon_heiles_12, 0.2, true}};
static const struct {
    const char *name;
    int order;
} methods[] = {{"galerkin", 16},     {"galerkin", 6}, {"midpoint", 8},  {"taylor", 10},
               {"symmetric-tvi", 2}, {"tvi", 2},      {"right", 4},     {"left", 4},
               {"htvi-right", 3},    {"poincare", 4}, {"both-ends", 6}, {"svhd", 2},
               {"start", 4},         {"end", 4},      {"galerkin", 20}, {"stormer-verlet", 2}};
enum { RUNS = sizeof runs / sizeof *runs, METHODS = sizeof methods / sizeof *methods, STEPS = 100 };

/* In the time of make check each scene and each method, not each of both, and with all optimization "galerkin" alone,
 * of the smaller scenes. */
static bool runs_all(void)
{
    const char *all = getenv("TVI_COMPILED");
    return all && strcmp(all, "all") == 0;
}

static bool is_skipped(int run, int method) { return !runs_all() && method != 0 && (run + method) % RUNS != 9; }

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

START_TEST(compiled_steps_are_those_of_the_tape)
{
    const scene *s = runs[_i].scene;
    systems its;
    const tvi_system *system = systems_open(&runs[_i], &its);
    for (int method = 0; method < METHODS; method++) {
        tvi_options options, compiled;
        tvi_compiled *code;
        if (is_skipped(_i, method)) continue;
        ck_assert_int_eq(tvi_options_named(methods[method].name, methods[method].order, &options), TVI_OK);
        options.max_tail = -1;
        compiled = options;
        if (tvi_options_check(system, &options, NULL) != TVI_OK) continue;
        ck_assert_int_eq(tvi_compile(&code, system, &options, runs_all() || (method == 0 && _i < 4) ? &usual : &quick),
                         TVI_OK);
        compiled.compiled = code;
        const travels of_tape = go_three_times(system, &options, s, runs[_i].h),
                      of_code = go_three_times(system, &compiled, s, runs[_i].h);
        const tvi_stats tape = of_tape.stats, own = of_code.stats;
        ck_assert(own.is_compiled && !tape.is_compiled);
        const double difference = motion_difference(s->n, &of_tape.m, &of_code.m);
        const double most = 64 * DBL_EPSILON + 4 * of_tape.roundoff;
        ck_assert_msg(difference <= most, "%s, %s %d: %.2e, where %.2e is roundoff", s->name, methods[method].name,
                      methods[method].order, difference, most);
        ck_assert_msg(labs(of_code.passes - of_tape.passes) <= 3 * STEPS / 4, "%s, %s: %ld passes, %ld of the tape",
                      s->name, methods[method].name, of_code.passes, of_tape.passes);
        ck_assert_int_le(labs(own.factorisations - tape.factorisations), STEPS / 4 + tape.factorisations / 4);
        ck_assert_double_eq_tol(own.tail, tape.tail, 1e-3 * tape.tail + 64 * DBL_EPSILON);
        tvi_compiled_free(code);
    }
    systems_free(&its);
}
END_TEST

/* Runs to a tolerance, whose errors are far above roundoff: all steps have the sizes that they have on the tape. */
static const scene *const adaptive[] = {&scene_kepler, &scene_solar, &scene_magnetic, &scene_vortices,
                                        &scene_double_pendulum};
enum { ADAPTIVE = sizeof adaptive / sizeof *adaptive };

START_TEST(compiled_runs_to_a_tolerance)
{
    const scene *s = adaptive[_i];
    systems its;
    const tvi_system *system = systems_open(&(whose){s, 0, false}, &its);
    tvi_options options;
    tvi_compiled *code;
    motion end[2];
    tvi_stats stats[2];
    ck_assert_int_eq(tvi_options_named("taylor", 8, &options), TVI_OK);
    ck_assert_int_eq(tvi_compile(&code, system, &options, &usual), TVI_OK);
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
    ck_assert_int_eq(scene_system(&scene_kepler, &system), TVI_OK);
    ck_assert_int_eq(tvi_compile(&code, system, &options, &usual), TVI_OK);
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
    ck_assert_int_eq(tvi_system_hamiltonian(&system, 1, drifting, NULL), TVI_OK);
    ck_assert_int_eq(tvi_options_named("start", 4, &options), TVI_OK);
    options.max_tail = -1;
    ck_assert_int_eq(tvi_compile(&code, system, &options, &quick), TVI_OK);
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

/* What the compiler is given is what runs: with a number of the tape changed there, the motion is another. */
START_TEST(another_code_moves_otherwise)
{
    static const char *const names[] = {"galerkin", "midpoint", "taylor"};
    const tvi_compiler broken = {
        .compiler = "sh tests/compiled/edited.sh s/-0x1\\.8p+0/-0x1.4p+0/ cc", .flags = "-O1", .cache = ""};
    for (int i = 0; i < 3; i++) {
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

/* Of "galerkin" one function makes whole steps, from the first one on, with the passes of the tape; the tail that it
 * tells is changed here. */
START_TEST(steps_are_whole)
{
    static const whose of[] = {{&scene_kepler, 0.1, false},
                               {&scene_double_pendulum, 0.01, false},
                               {&scene_nonseparable, 0.05, false},
                               {&scene_kepler, 0.2, true},
                               {&scene_henon_heiles_12, 0.2, true}};
    const tvi_compiler edited = {
        .compiler = "sh tests/compiled/edited.sh s/tried.tail.=.*/tried.tail=7;/ cc", .flags = "-O1", .cache = ""};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        systems its;
        const tvi_system *system = systems_open(&of[i], &its);
        tvi_options options;
        tvi_compiled *code;
        ck_assert_int_eq(tvi_options_named("galerkin", 8, &options), TVI_OK);
        options.max_tail = -1;
        ck_assert_int_eq(tvi_compile(&code, system, &options, &edited), TVI_OK);
        for (int steps = 1; steps <= 3; steps++) {
            motion of_tape = motion_start(of[i].scene), of_code = of_tape;
            tvi_stats tape, own;
            options.compiled = NULL;
            ck_assert_int_eq(motion_go(system, &options, of[i].h, steps, &of_tape, &tape), TVI_OK);
            options.compiled = code;
            ck_assert_int_eq(motion_go(system, &options, of[i].h, steps, &of_code, &own), TVI_OK);
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
    tcase_set_timeout(same, 600);
    tcase_set_timeout(control, 60);
    tcase_add_loop_test(same, compiled_steps_are_those_of_the_tape, 0, RUNS);
    tcase_add_loop_test(same, compiled_runs_to_a_tolerance, 0, ADAPTIVE);
    tcase_add_loop_test(same, steps_fail_as_those_of_the_tape, 0, 3);
    tcase_add_test(same, momenta_that_are_roundoff_are_found);
    tcase_add_test(same, steps_are_whole);
    tcase_add_test(control, another_code_moves_otherwise);
    suite_add_tcase(suite, same);
    suite_add_tcase(suite, control);
    return suite;
}
