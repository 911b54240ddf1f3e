/* test_input.c - Tests bad input, by name: each has its status, and what the arguments point to stays as it was. The
 * contracts are those of jet.h and tvi.h. The refusals are tested in input_*.c; this file has the parts that they
 * share. */
#include "input.h"
#include "suites.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- States, methods and refusals -------------------------------------------------------------------------------- */

const method methods[] = {
    {"tvi", 1},       {"tvi", 4},       {"tvi", 7},           {"start", 2},     {"start", 6},
    {"start", 12},    {"end", 4},       {"end", 8},           {"midpoint", 2},  {"midpoint", 12},
    {"both-ends", 4}, {"both-ends", 8}, {"htvi-right", 3},    {"right", 6},     {"htvi-left", 3},
    {"left", 6},      {"svhd", 2},      {"symmetric-tvi", 4}, {"poincare", 2},  {"poincare", 8},
    {"taylor", 1},    {"taylor", 8},    {"galerkin", 2},      {"galerkin", 16}, {"stormer-verlet", 2},
};
const int method_count = sizeof methods / sizeof *methods;

state start_of(const scene *s)
{
    state start = {0};
    memcpy(start.q, s->q, (size_t)s->n * sizeof *s->q);
    memcpy(start.p, s->p, (size_t)s->n * sizeof *s->p);
    return start;
}

bool state_is_finite(const state *s)
{
    bool finite = isfinite(s->t);
    for (int i = 0; i < STATE_MAX; i++) finite = finite && isfinite(s->q[i]) && isfinite(s->p[i]);
    return finite;
}

void expect_same(const char *what, const state *is, const state *was)
{
    ck_assert_msg(memcmp(is, was, sizeof *is) == 0, "%s: the state was changed", what);
}

tvi_system *create_system(int n, tvi_potential_fn *potential)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, n, NULL, potential, NULL), TVI_OK);
    return system;
}

tvi_system *create_scene(const scene *s)
{
    tvi_system *system;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    return system;
}

tvi_options options_of(const method *m)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(m->name, m->order, &options), TVI_OK);
    return options;
}

tvi_integrator *create_integrator(const tvi_system *system, const method *m)
{
    const tvi_options options = options_of(m);
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    return integrator;
}

/* ---- Problems, each with every method ---------------------------------------------------------------------------- */

/* V = q^2/2 - log q: a well that exists for q > 0 only, so that steps beyond it leave the domain. */
static jet half_line(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_mul(0.5, jet_sqr(q[0])), jet_log(q[0]));
}

/* V = q^4 + q sin t. */
static jet driven(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return jet_add(jet_pow(q[0], 4), jet_mul(q[0], jet_sin(t)));
}

static const double one_q[] = {0.5}, one_p[] = {0.5};
static const scene scene_half_line = {.name = "half line", .n = 1, .potential = half_line, .q = one_q, .p = one_p};
static const scene scene_driven = {.name = "driven", .n = 1, .potential = driven, .q = one_q, .p = one_p};

static const scene *const problems[] = {
    &scene_pendulum,        &scene_kepler,   &scene_henon_heiles_12, &scene_half_line, &scene_driven,
    &scene_double_pendulum, &scene_magnetic, &scene_nonseparable,    &scene_vortices,  &scene_degenerate,
};
const int problem_count = sizeof problems / sizeof *problems;
const double good_step = 1.0 / 64;

bool open_pair(pair *x, int i)
{
    x->problem = problems[i / method_count];
    x->m = &methods[i % method_count];
    x->system = create_scene(x->problem);
    snprintf(x->name, sizeof x->name, "%s, %s %d", x->problem->name, x->m->name, x->m->order);
    const tvi_options options = options_of(x->m);
    const bool serves = tvi_options_check(x->system, &options, NULL) == TVI_OK;
    if (!serves) tvi_system_free(x->system);
    return serves;
}

void close_pair(pair *x) { tvi_system_free(x->system); }

/* ---- The suite --------------------------------------------------------------------------------------------------- */

Suite *suite_input(void)
{
    Suite *suite = suite_create("input");
    suite_add_tcase(suite, tcase_systems());
    suite_add_tcase(suite, tcase_functions());
    suite_add_tcase(suite, tcase_vectors());
    suite_add_tcase(suite, tcase_options());
    suite_add_tcase(suite, tcase_bad_steps());
    suite_add_tcase(suite, tcase_failed_steps());
    suite_add_tcase(suite, tcase_integrate());
    suite_add_tcase(suite, tcase_dense());
    suite_add_tcase(suite, tcase_stats());
    suite_add_tcase(suite, tcase_texts());
    return suite;
}
