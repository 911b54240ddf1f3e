/* main.c - Runs the suites on the hard cases of bench/stability. */
#include "stability.h"
#include "problems/run_suites.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const hard_case *const all_cases[] = {
    &kepler_60,     &kepler_90,     &kepler_99,       &separatrix,     &pythagorean,  &fpu_50,
    &fpu_100,       &fpu_200,       &spring_pendulum, &henon_heiles_6, &figure_eight, &unequal_masses,
    &pendulum_tiny, &pendulum_huge, &kepler_tiny,     &kepler_huge,
};
const int case_count = sizeof all_cases / sizeof *all_cases;

const hard_method all_methods[] = {
    {"tvi", 1, false},           {"tvi", 4, false},        {"tvi", 7, false},        {"tvi", 8, true},
    {"start", 2, false},         {"start", 8, false},      {"start", 8, true},       {"start", 20, false},
    {"end", 4, false},           {"end", 12, false},       {"midpoint", 2, false},   {"midpoint", 8, false},
    {"midpoint", 20, false},     {"both-ends", 4, false},  {"both-ends", 16, false}, {"symmetric-tvi", 4, false},
    {"symmetric-tvi", 8, false}, {"htvi-right", 3, false}, {"htvi-right", 8, false}, {"htvi-left", 3, false},
    {"htvi-left", 8, false},     {"right", 8, false},      {"right", 16, false},     {"left", 8, false},
    {"left", 16, false},         {"svhd", 2, false},       {"poincare", 2, false},   {"poincare", 8, false},
    {"poincare", 20, false},     {"taylor", 4, false},     {"taylor", 20, false},    {"stormer-verlet", 2, false},
    {"galerkin", 2, false},      {"galerkin", 8, false},   {"galerkin", 16, false},  {"galerkin", 20, false},
};
const int method_count = sizeof all_methods / sizeof *all_methods;

hard_state start_of(const hard_case *c)
{
    hard_state x = {0};
    memcpy(x.q, c->scene.q, (size_t)c->scene.n * sizeof *x.q);
    memcpy(x.p, c->scene.p, (size_t)c->scene.n * sizeof *x.p);
    return x;
}

bool is_finite(const hard_state *x)
{
    bool finite = isfinite(x->t);
    for (int i = 0; i < STATE_MOST; i++) finite = finite && isfinite(x->q[i]) && isfinite(x->p[i]);
    return finite;
}

hard_pair pair_open(const hard_case *c, const hard_method *m, int max_passes)
{
    hard_pair pair = {.problem = c};
    tvi_options options;
    ck_assert(hard_options(m, &options));
    options.max_passes = max_passes;
    ck_assert_int_eq(hard_system(c, &pair.system), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&pair.integrator, pair.system, &options), TVI_OK);
    snprintf(pair.name, sizeof pair.name, "%s, %s %d%s", c->scene.name, m->name, m->order,
             m->composed ? " composed" : "");
    return pair;
}

void pair_close(hard_pair *pair)
{
    tvi_integrator_free(pair->integrator);
    tvi_system_free(pair->system);
}

tvi_status pair_step(const hard_pair *pair, double h, hard_state *x)
{
    return tvi_step(pair->integrator, h, &x->t, x->q, x->p);
}

static Suite *(*const suites[])(void) = {suite_failing,    suite_limits, suite_extremes, suite_lowest,
                                         suite_equilibria, suite_guard,  suite_zero};

int main(void) { return RUN_SUITES(suites); }
