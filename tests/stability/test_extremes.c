/* test_extremes.c - Tests short versions of the hard cases at steps that survive, and extremes: states of 1e-150 and
 * 1e150, steps of 1e-8, degree 40, masses 12 orders apart. */
#include "baselines/baseline.h"
#include "stability.h"
#include "stability/gauss_recorded.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Short runs -------------------------------------------------------------------------------------------------- */

typedef struct {
    const hard_case *problem;
    double t_end;
    long steps;
    double energy, position; /* errors at most; position 0: no reference */
} short_run;

/* Not as tight as they could be: some of these are chaotic. */
static const short_run short_runs[] = {
    {&kepler_60, 5 * 6.2831853071795864769, 400, 1e-6, 1e-4},
    {&kepler_90, 5 * 6.2831853071795864769, 4000, 1e-5, 1e-3},
    {&kepler_99, 6.2831853071795864769, 20000, 1e-4, 1e-2},
    {&separatrix, 10.5977502180147128, 400, 1e-9, 1e-4},
    {&pythagorean, 0.125, 2500, 1e-4, 0},
    {&fpu_50, 1, 500, 1e-6, 0},
    {&fpu_100, 1, 1000, 1e-6, 0},
    {&fpu_200, 1, 2000, 1e-6, 0},
    {&spring_pendulum, 1, 1000, 1e-6, 0},
    {&henon_heiles_6, 50, 500, 1e-6, 0},
    {&figure_eight, 6.32591398292621, 100, 1e-6, 1e-4},
    {&unequal_masses, 6.2831853071795864769 * (1 - 5e-13), 100, 1e-7, 1e-5},
    {&pendulum_tiny, 20, 400, 1e-5, 0},
    {&pendulum_huge, 20, 400, 1e-5, 0},
};
enum { SHORT_RUNS = sizeof short_runs / sizeof *short_runs };
static const hard_method short_methods[] = {{"midpoint", 8, false},  {"poincare", 8, false},  {"start", 8, true},
                                            {"both-ends", 8, false}, {"midpoint", 20, false}, {"galerkin", 8, false},
                                            {"galerkin", 16, false}, {"gauss", 8, false}};
enum { SHORT_METHODS = sizeof short_methods / sizeof *short_methods };

START_TEST(hard_cases_run)
{
    const short_run *row = &short_runs[_i / SHORT_METHODS];
    const hard_method *m = &short_methods[_i % SHORT_METHODS];
    hard_case shorter = *row->problem;
    tvi_system *system;
    shorter.scene.t_end = row->t_end;
    ck_assert_int_eq(hard_system(&shorter, &system), TVI_OK);
    const hard_run run = hard_run_make(&shorter, system, m, row->steps);
    ck_assert_msg(hard_run_survives(&run), "%s, %s %d: %s", shorter.scene.name, m->name, m->order,
                  hard_run_cause(&run));
    ck_assert_msg(run.energy_error <= row->energy, "%s, %s %d: energy %g", shorter.scene.name, m->name, m->order,
                  run.energy_error);
    if (row->position > 0)
        ck_assert_msg(run.position_error <= row->position, "%s, %s %d: position %g", shorter.scene.name, m->name,
                      m->order, run.position_error);
    tvi_system_free(system);
}
END_TEST

/* A run that is said to survive has an energy within the bound, and one whose energy leaves it says so. */
START_TEST(energy_is_judged)
{
    static const hard_method verlet = {"stormer-verlet", 2, false};
    tvi_system *system;
    ck_assert_int_eq(hard_system(&kepler_90, &system), TVI_OK);
    const hard_run run = hard_run_make(&kepler_90, system, &verlet, 20000);
    ck_assert_str_eq(hard_run_cause(&run), "energy");
    ck_assert(!hard_run_survives(&run));
    ck_assert_double_gt(run.energy_error, kepler_90.bound);
    ck_assert_int_lt(run.steps, 20000);
    tvi_system_free(system);
}
END_TEST

/* The collocation on the recorded force is the one on the force by hand, up to roundoff. */
START_TEST(gauss_is_the_baseline)
{
    const scene *s = &scene_kepler;
    const baseline *gauss = baseline_find("gauss", 2 * _i);
    const baseline_task task = {.scene = s, .h = 0.1, .steps = 100};
    double q[2] = {s->q[0], s->q[1]}, p[2] = {s->p[0], s->p[1]}, other_q[2] = {q[0], q[1]}, other_p[2] = {p[0], p[1]};
    baseline_counts counts;
    tvi_system *system;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    ck_assert_int_eq(gauss->run(gauss, &task, q, p, &counts), TVI_OK);
    ck_assert_int_eq(gauss_recorded(system, 2 * _i, &task, other_q, other_p, &counts), TVI_OK);
    for (int i = 0; i < 2; i++) {
        ck_assert_double_eq_tol(other_q[i], q[i], 1e-12);
        ck_assert_double_eq_tol(other_p[i], p[i], 1e-12);
    }
    tvi_system_free(system);
}
END_TEST

/* ---- Sizes ------------------------------------------------------------------------------------------------------- */

/* Powers of 2 commute with rounding: bit for bit the same pendulum. */
START_TEST(sizes_do_not_matter)
{
    static const hard_case *const cases[] = {&pendulum_unit, &pendulum_tiny, &pendulum_huge};
    hard_state x[3];
    for (int k = 0; k < 3; k++) {
        hard_pair pair = pair_open(cases[k], &all_methods[_i], 0);
        x[k] = start_of(cases[k]);
        for (int step = 0; step < 50; step++) ck_assert_int_eq(pair_step(&pair, 0.1, &x[k]), TVI_OK);
        const double length = *(const double *)cases[k]->ctx;
        ck_assert_msg(x[k].q[0] / length == x[0].q[0], "%s: q %a, %a", pair.name, x[k].q[0] / length, x[0].q[0]);
        ck_assert_msg(x[k].p[0] / length == x[0].p[0], "%s: p %a, %a", pair.name, x[k].p[0] / length, x[0].p[0]);
        pair_close(&pair);
    }
    ck_assert_double_ne(x[0].q[0], start_of(cases[0]).q[0]);
}
END_TEST

/* r^-3 is beyond all doubles: refused. */
START_TEST(force_that_overflows_is_refused)
{
    hard_pair pair = pair_open(&kepler_tiny, &all_methods[_i], 0);
    const hard_state start = start_of(&kepler_tiny);
    for (double h = 1e-300; h < 10; h *= 1e10) {
        hard_state x = start;
        const tvi_status status = pair_step(&pair, h, &x);
        ck_assert_msg(status == TVI_ENONFINITE || status == TVI_EDOMAIN || status == TVI_ESINGULAR, "%s, h = %g: %s",
                      pair.name, h, tvi_status_string(status));
        ck_assert(memcmp(&x, &start, sizeof x) == 0);
    }
    pair_close(&pair);
}
END_TEST

/* r^-3 is 0 in doubles: a free particle, which it is to all digits. */
START_TEST(force_that_underflows_is_none)
{
    hard_pair pair = pair_open(&kepler_huge, &all_methods[_i], 0);
    hard_state x = start_of(&kepler_huge);
    for (int step = 0; step < 10; step++) ck_assert_int_eq(pair_step(&pair, 0.125, &x), TVI_OK);
    ck_assert_double_eq(x.q[0], 1e150);
    ck_assert_double_eq_tol(x.q[1], 1.25e150, 1e136);
    ck_assert_double_eq(x.p[1], 1e150);
    pair_close(&pair);
}
END_TEST

/* ---- Small steps, high degrees, unequal masses ------------------------------------------------------------------- */

/* 1,000 steps of 1e-8 against one step of 1e-5 of the Taylor method of degree 20. */
START_TEST(tiny_steps_add_up)
{
    static const hard_method taylor = {"taylor", 19, false};
    hard_pair pair = pair_open(&kepler_60, &all_methods[_i], 0), exact = pair_open(&kepler_60, &taylor, 0);
    hard_state x = start_of(&kepler_60), y = x;
    ck_assert_int_eq(pair_step(&exact, 1e-5, &y), TVI_OK);
    for (int step = 0; step < 1000; step++) ck_assert_int_eq(pair_step(&pair, 1e-8, &x), TVI_OK);
    ck_assert_double_eq_tol(x.t, 1e-5, 1e-20);
    /* of order 1: h T |q''|/2 = 2e-14; at both ends each step rounds p anew, 1,000 times */
    const bool both_ends = tvi_integrator_options(pair.integrator)->expansion == TVI_AT_BOTH_ENDS;
    const double method = all_methods[_i].order == 1 ? 3e-14 : both_ends ? 4e-15 : 0;
    for (int i = 0; i < 2; i++) {
        ck_assert_msg(fabs(x.q[i] - y.q[i]) <= DBL_EPSILON * fabs(y.q[i]) + 1e-20 + method, "%s: q %g", pair.name,
                      x.q[i] - y.q[i]);
        ck_assert_msg(fabs(x.p[i] - y.p[i]) <= DBL_EPSILON * fabs(y.p[i]) + 1e-20 + method, "%s: p %g", pair.name,
                      x.p[i] - y.p[i]);
    }
    pair_close(&pair);
    pair_close(&exact);
}
END_TEST

static const tvi_options forty[] = {
    {.method = TVI_TYPE1, .expansion = TVI_AT_START, .degree = 40},
    {.method = TVI_TYPE1, .expansion = TVI_AT_END, .degree = 40},
    {.method = TVI_TYPE1, .expansion = TVI_AT_MIDPOINT, .degree = 40},
    {.method = TVI_TYPE1, .expansion = TVI_AT_BOTH_ENDS, .degree = 40},
    {.method = TVI_TYPE2, .expansion = TVI_AT_START, .degree = 40},
    {.method = TVI_TYPE3, .expansion = TVI_AT_START, .degree = 40},
    {.method = TVI_POINCARE, .expansion = TVI_AT_MIDPOINT, .degree = 40},
    {.method = TVI_TAYLOR, .expansion = TVI_AT_START, .degree = 40},
    {.method = TVI_TYPE1, .expansion = TVI_AT_START, .nodes = TVI_NODES_TRUNCATED, .degree = 40},
    {.method = TVI_TYPE2, .expansion = TVI_AT_START, .nodes = TVI_NODES_TRUNCATED, .degree = 40},
};
enum { FORTY = sizeof forty / sizeof *forty };

/* One period of Kepler in 64 steps: roundoff alone is left. */
START_TEST(degree_forty)
{
    enum { STEPS = 64 };
    tvi_system *system;
    tvi_integrator *integrator;
    hard_state x = start_of(&kepler_60);
    ck_assert_int_eq(hard_system(&kepler_60, &system), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &forty[_i]), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, kepler_60.period / STEPS, STEPS, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    for (int i = 0; i < 2; i++) {
        ck_assert_msg(fabs(x.q[i] - kepler_60.scene.q[i]) < 2e-14, "row %d: q %g", _i, x.q[i] - kepler_60.scene.q[i]);
        ck_assert_msg(fabs(x.p[i] - kepler_60.scene.p[i]) < 2e-14, "row %d: p %g", _i, x.p[i] - kepler_60.scene.p[i]);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Each body, the heavy one too, is back after a period to its own size. */
START_TEST(light_and_heavy_keep_their_digits)
{
    const hard_case *c = &unequal_masses;
    hard_pair pair = pair_open(c, &short_methods[_i], 0);
    hard_state x = start_of(c);
    const double h = c->period / 64;
    for (int step = 0; step < 64; step++) ck_assert_int_eq(pair_step(&pair, h, &x), TVI_OK);
    const double most = short_methods[_i].order == 20 ? 1e-12 : 3e-5;
    for (int i = 0; i < 4; i++) {
        const double size = i < 2 ? 1.3e-12 : 1.3;
        ck_assert_msg(fabs(x.q[i] - c->scene.q[i]) < most * size, "%s: q[%d] %g", pair.name, i, x.q[i] - c->scene.q[i]);
        ck_assert_msg(fabs(x.p[i] - c->scene.p[i]) < most * 1e-12, "%s: p[%d] %g", pair.name, i,
                      x.p[i] - c->scene.p[i]);
    }
    pair_close(&pair);
}
END_TEST

Suite *suite_extremes(void)
{
    Suite *suite = suite_create("extremes");
    TCase *tcase = tcase_create("extremes");
    tcase_add_loop_test(tcase, hard_cases_run, 0, SHORT_RUNS * SHORT_METHODS);
    tcase_add_test(tcase, energy_is_judged);
    tcase_add_loop_test(tcase, gauss_is_the_baseline, 2, 9);
    tcase_add_loop_test(tcase, sizes_do_not_matter, 0, method_count);
    tcase_add_loop_test(tcase, force_that_overflows_is_refused, 0, method_count);
    tcase_add_loop_test(tcase, force_that_underflows_is_none, 0, method_count);
    tcase_add_loop_test(tcase, tiny_steps_add_up, 0, method_count);
    tcase_add_loop_test(tcase, degree_forty, 0, FORTY);
    tcase_add_loop_test(tcase, light_and_heavy_keep_their_digits, 0, SHORT_METHODS - 1);
    suite_add_tcase(suite, tcase);
    return suite;
}
