/* faults_steps.c - Tests that a step allocates nothing. */
#include "allocation.h"
#include "everything.h"
#include "problems/thorough.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 1000 };

static int observe(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p;
    *(long *)ctx = step;
    return step == STEPS - 1;
}

/* 1,000 steps back and forth one by one with dense output, as many by tvi_integrate, and steps that fail. False where
 * one had not the status that it should have. */
static bool make_steps(tvi_integrator *integrator)
{
    double t = 0, q[N] = {0.1, -0.2, 0.3}, p[N] = {0.1, 0.1, -0.1}, q_dense[N], p_dense[N], D[4 * N * N] = {1};
    bool good = true;
    for (int i = 0; i < STEPS; i++) {
        good = good && tvi_step(integrator, i % 2 ? 0.01 : -0.01, &t, q, p) == TVI_OK;
        good = good && tvi_dense(integrator, 0.25, q_dense, p_dense) == TVI_OK;
        if (i % 10 == 0) tvi_integrator_reset(integrator);
        if (i % 50 == 0) good = good && tvi_step(integrator, 1e200, &t, q, p) != TVI_OK;
        if (i % 50 == 0) good = good && tvi_step(integrator, NAN, &t, q, p) == TVI_EINVAL;
        if (i % 50 == 0) good = good && tvi_step_tangent(integrator, 0.01, &t, q, p, D, 1 + i % N) == TVI_OK;
        if (i % 50 == 0) good = good && tvi_step_tangent(integrator, 1e200, &t, q, p, D, 2 * N) != TVI_OK;
    }
    long seen = 0;
    good =
        good && tvi_integrate(integrator, 1e-4, STEPS, &t, q, p, observe, &seen) == TVI_ESTOPPED && seen == STEPS - 1;
    double far[N] = {-5, -5, -5};
    return good && tvi_step(integrator, 0.01, &t, far, p) == TVI_EDOMAIN;
}

static void expect_no_allocation(const tvi_system *system, const tvi_options options)
{
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    double t = 0, q[N] = {0.1, -0.2, 0.3}, p[N] = {0.1, 0.1, -0.1}, D[4 * N * N] = {1};
    ck_assert_int_eq(tvi_step_tangent(integrator, 0.01, &t, q, p, D, 2 * N), TVI_OK); /* the first may allocate */
    allocation_fail(FAIL_ONWARD, 1);
    const bool good = make_steps(integrator);
    const allocation_counts counts = allocation_stop();
    ck_assert_int_eq(counts.calls, 0);
    ck_assert(good);
    ck_assert(tvi_integrator_stats(integrator)->is_compiled == (options.compiled != NULL));
    tvi_integrator_free(integrator);
}

START_TEST(steps_allocate_nothing)
{
    tvi_system *system = create_everything(ways[_i].by, true);
    expect_no_allocation(system, options_of_way(_i));
    tvi_system_free(system);
}
END_TEST

/* On constraints a run begins at a state that is on them, by "galerkin" and by RATTLE. */
START_TEST(constrained_steps_allocate_nothing)
{
    tvi_system *system = create_everything(CONSTRAINED, true);
    tvi_options options;
    tvi_integrator *integrator;
    double t = 0, q[N] = {0.1, -0.2, 0.3}, p[N] = {0.1, 0.1, -0.1}, q_dense[N], p_dense[N];
    ck_assert_int_eq(tvi_options_named(_i ? "stormer-verlet" : "galerkin", _i ? 2 : 8, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_project(system, t, q, p), TVI_OK);
    bool good = true;
    allocation_fail(FAIL_ONWARD, 1);
    for (int i = 0; i < STEPS; i++) {
        good = good && tvi_step(integrator, i % 2 ? 0.01 : -0.01, &t, q, p) == TVI_OK;
        good = good && tvi_dense(integrator, 0.25, q_dense, p_dense) == TVI_OK;
        if (i % 10 == 0) tvi_integrator_reset(integrator);
    }
    const allocation_counts counts = allocation_stop();
    ck_assert_int_eq(counts.calls, 0);
    ck_assert(good);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* A potential's Galerkin step; with TVI_TESTS=all that of every form but one; with TVI_COMPILED=all all ways. */
static bool is_compiled(const way *w)
{
    const char *all = getenv("TVI_COMPILED");
    if (all && strcmp(all, "all") == 0) return true;
    if (strcmp(w->name, "galerkin") != 0) return false;
    return w->by == POTENTIAL || (is_thorough() && w->by != HAMILTONIAN);
}

START_TEST(steps_of_generated_code_allocate_nothing)
{
    if (!is_compiled(&ways[_i])) return;
    tvi_system *system = create_everything(ways[_i].by, true);
    tvi_options options = options_of_way(_i);
    tvi_compiled *code;
    const tvi_compiler how = {.flags = "-O1", .cache = "build/check/generated"};
    ck_assert_int_eq(tvi_compile(&code, system, &options, &how), TVI_OK);
    options.compiled = code;
    expect_no_allocation(system, options);
    tvi_compiled_free(code);
    tvi_system_free(system);
}
END_TEST

/* Control: the hooks see the allocations of this program. Check's own are among them, so nothing is asserted in
 * between; the blocks are volatile, so that no compiler leaves them out. */
START_TEST(hooks_count)
{
    void *volatile blocks[4];
    allocation_count();
    blocks[0] = malloc(8), blocks[1] = calloc(2, 8), blocks[2] = realloc(NULL, 8), blocks[3] = aligned_alloc(64, 64);
    blocks[0] = realloc(blocks[0], 16);
    const allocation_counts made = allocation_stop();
    for (int i = 0; i < 4; i++) free(blocks[i]);
    const allocation_counts freed = allocation_stop();
    allocation_fail(FAIL_ONCE, 2);
    for (int i = 0; i < 3; i++) blocks[i] = malloc(8);
    const allocation_counts failed = allocation_stop();
    const bool as_told = blocks[0] && !blocks[1] && blocks[2];
    for (int i = 0; i < 3; i++) free(blocks[i]);
    ck_assert_int_eq(made.calls, 5);
    ck_assert_int_eq(made.live, 4);
    ck_assert_uint_eq(made.bytes, 8 + 16 + 8 + 64 + 16);
    ck_assert_int_eq(freed.live, 0);
    ck_assert_int_eq(failed.fails, 1);
    ck_assert(as_told);
}
END_TEST

TCase *tcase_hooks(void)
{
    TCase *tcase = tcase_create("hooks");
    tcase_add_test(tcase, hooks_count);
    return tcase;
}

TCase *tcase_allocations(void)
{
    TCase *tcase = tcase_create("steps");
    tcase_add_loop_test(tcase, steps_allocate_nothing, 0, way_count);
    tcase_add_loop_test(tcase, constrained_steps_allocate_nothing, 0, 2);
    return tcase;
}

TCase *tcase_generated(void)
{
    TCase *tcase = tcase_create("generated");
    tcase_add_loop_test(tcase, steps_of_generated_code_allocate_nothing, 0, way_count);
    return tcase;
}
