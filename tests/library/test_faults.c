/* test_faults.c - memory: a step allocates nothing, and an allocation that fails anywhere else ends in TVI_ENOMEM with
 * nothing made and nothing leaked. */
#include "allocation.h"
#include "suites.h"
#include "tvi.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Functions with every operation, and more nodes than one piece of a recording holds -------------------------- */

enum { N = 3, TERMS = 16 };

/* Every function where it exists, for |x| < 1. */
static int every_function(jet x, jet y[])
{
    int count = 0;
    y[count++] = jet_add(x, 1);
    y[count++] = jet_sub(0.5, x);
    y[count++] = jet_neg(x);
    y[count++] = jet_sqr(jet_add(x, 2));
    y[count++] = jet_div(jet_add(1, x), jet_add(3, x));
    y[count++] = jet_div(2, jet_add(3, x));
    y[count++] = jet_sqrt(jet_add(2, x));
    y[count++] = jet_pow(jet_add(2, x), -1.5);
    y[count++] = jet_pow(jet_add(2, x), 7);
    y[count++] = jet_pow(jet_add(2, x), -3);
    y[count++] = jet_log(jet_add(2, x));
    y[count++] = jet_asin(jet_mul(0.5, x));
    y[count++] = jet_acos(jet_mul(0.25, x));
    y[count++] = jet_acosh(jet_add(2, x));
    y[count++] = jet_atanh(jet_mul(0.25, x));
    y[count++] = jet_atan2(x, jet_add(2, x));
    y[count++] = jet_hypot(2, x);
    static const jet_function everywhere[] = {JET_EXP,  JET_SIN,  JET_COS,  JET_TAN,   JET_ATAN,
                                              JET_SINH, JET_COSH, JET_TANH, JET_ASINH, JET_ERF};
    for (size_t i = 0; i < sizeof everywhere / sizeof *everywhere; i++)
        y[count++] = jet_record_function(everywhere[i], jet_mul(0.5, x));
    return count;
}

/* The sum over all functions f of f(q_i) f(q_j) / 1000, and TERMS products that are all different; with a context,
 * less: the sum of f(q_0) / 1000 and |q|^2/2, for steps that shall not take long. */
static jet everything(const jet q[], jet t, void *ctx)
{
    jet y[N][32], term[TERMS];
    int count = 0;
    for (int i = 0; i < N; i++) count = every_function(q[i], y[i]);
    if (ctx) return jet_add(jet_mul(1e-3, jet_sum(y[0], count)), jet_mul(0.5, jet_dot(q, q, N)));
    for (int i = 0; i < TERMS; i++)
        term[i] =
            jet_mul(jet_mul(1e-3, q[i % N]), jet_add(i + 1, jet_mul(q[(i + 1) % N], jet_sin(jet_mul(1e-3 * i, t)))));
    const jet dots = jet_add(jet_dot(y[0], y[1], count), jet_dot(y[1], y[2], count));
    return jet_add(jet_mul(1e-3, dots), jet_sum(term, TERMS));
}

static void everything_force(const jet q[], jet t, jet force[], void *ctx)
{
    force[0] = everything(q, t, ctx);
    force[1] = jet_const(0.25);
    force[2] = jet_neg(jet_mul(force[0], q[2]));
}

/* L and H with a mass that is not constant: M(q) = 1 + q_i^2. */
static jet everything_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    jet term[N];
    for (int i = 0; i < N; i++) term[i] = jet_mul(jet_add(1, jet_sqr(q[i])), jet_sqr(v[i]));
    return jet_sub(jet_mul(0.5, jet_sum(term, N)), everything(q, t, ctx));
}

static jet everything_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    jet term[N];
    for (int i = 0; i < N; i++) term[i] = jet_div(jet_sqr(p[i]), jet_add(1, jet_sqr(q[i])));
    return jet_add(jet_mul(0.5, jet_sum(term, N)), everything(q, t, ctx));
}

/* L and H that are seen to be separable. */
static jet separable_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_dot(v, v, N), everything(q, t, ctx));
}

static jet separable_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_dot(p, p, N), everything(q, t, ctx));
}

static const double mass[N] = {1, 2, 0.5};

/* The ways to state a problem. */
typedef enum { FORCE, POTENTIAL, LAGRANGIAN, HAMILTONIAN, SEPARABLE_L, SEPARABLE_H, RESCALED, STATEMENTS } statement;

static jet slower_far_away(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(1, jet_mul(0.5, jet_add(jet_dot(q, q, N), jet_mul(p[0], q[1]))));
}

/* The light one has the automatic time scale. */
static tvi_status rescale(tvi_system **out, void *ctx)
{
    tvi_system *base;
    const tvi_status status = tvi_system_potential(&base, N, mass, everything, ctx);
    *out = NULL;
    if (status != TVI_OK) return status;
    const tvi_status rescaled = tvi_system_rescaled(out, base, ctx ? NULL : slower_far_away, NULL);
    tvi_system_free(base);
    return rescaled;
}

static tvi_status state_system(statement by, tvi_system **out, void *ctx)
{
    switch (by) {
    case FORCE: return tvi_system_force(out, N, mass, everything_force, ctx);
    case POTENTIAL: return tvi_system_potential(out, N, mass, everything, ctx);
    case LAGRANGIAN: return tvi_system_lagrangian(out, N, everything_lagrangian, ctx);
    case HAMILTONIAN: return tvi_system_hamiltonian(out, N, everything_hamiltonian, ctx);
    case RESCALED: return rescale(out, ctx);
    case SEPARABLE_L: return tvi_system_lagrangian(out, N, separable_lagrangian, ctx);
    default: return tvi_system_hamiltonian(out, N, separable_hamiltonian, ctx);
    }
}

static tvi_system *create_system(statement by, bool light)
{
    tvi_system *system;
    ck_assert_int_eq(state_system(by, &system, light ? &light : NULL), TVI_OK);
    return system;
}

/* ---- The k-th allocation fails, for every k ---------------------------------------------------------------------- */

/* Makes something with allocations of its own, says whether *out is NULL on failure, and frees what it made. */
typedef tvi_status maker(const void *argument, bool *cleared);

static tvi_status make_system(const void *argument, bool *cleared)
{
    tvi_system *system = (tvi_system *)&(char){0};
    const tvi_status status = state_system(*(const statement *)argument, &system, NULL);
    *cleared = system == NULL;
    tvi_system_free(system);
    return status;
}

typedef struct {
    const tvi_system *system;
    const tvi_options *options;
} integrator_arguments;

static tvi_status make_integrator(const void *argument, bool *cleared)
{
    const integrator_arguments *of = argument;
    tvi_integrator *integrator = (tvi_integrator *)&(char){0};
    const tvi_status status = tvi_integrator_create(&integrator, of->system, of->options);
    *cleared = integrator == NULL;
    tvi_integrator_free(integrator);
    return status;
}

static const double some_q[N] = {0.1, 0.2, 0.3}, some_p[N] = {1, 2, 3};

static tvi_status ask_energy(const void *argument, bool *cleared)
{
    double H = 42;
    const tvi_status status = tvi_energy(argument, 0, some_q, some_p, &H);
    *cleared = H == 42;
    return status;
}

static tvi_status ask_momentum(const void *argument, bool *cleared)
{
    double p[N] = {42, 42, 42};
    const tvi_status status = tvi_momentum(argument, 0, some_q, some_p, p);
    *cleared = p[0] == 42 && p[1] == 42 && p[2] == 42;
    return status;
}

static tvi_status ask_velocity(const void *argument, bool *cleared)
{
    double v[N] = {42, 42, 42};
    const tvi_status status = tvi_velocity(argument, 0, some_q, some_p, v);
    *cleared = v[0] == 42 && v[1] == 42 && v[2] == 42;
    return status;
}

static jet radius(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_dot(q, q, N), jet_mul(0.5, jet_dot(p, p, N)));
}

static tvi_status make_event(const void *argument, bool *cleared)
{
    (void)argument;
    tvi_event *event = (tvi_event *)&(char){0};
    const tvi_status status = tvi_event_create(&event, N, TVI_EITHER, false, radius, NULL);
    *cleared = event == NULL;
    tvi_event_free(event);
    return status;
}

typedef struct {
    tvi_integrator *integrator;
    const tvi_event *event;
} run_arguments;

static tvi_status run_with_events(const void *argument, bool *cleared)
{
    const run_arguments *of = argument;
    const tvi_event *const events[] = {of->event, of->event};
    double t = 0, q[N], p[N];
    memcpy(q, some_q, sizeof q);
    memcpy(p, some_p, sizeof p);
    const tvi_status status = tvi_integrate_events(of->integrator, 0.01, 1, events, 2, &t, q, p, NULL, NULL, NULL);
    *cleared = t == 0 && memcmp(q, some_q, sizeof q) == 0 && memcmp(p, some_p, sizeof p) == 0;
    return status;
}

static tvi_status run_to_time(const void *argument, bool *cleared)
{
    const run_arguments *of = argument;
    const double time = 0.005;
    double t = 0, q[N], p[N];
    memcpy(q, some_q, sizeof q);
    memcpy(p, some_p, sizeof p);
    const tvi_status status = tvi_integrate_at(of->integrator, 0.01, &time, 1, &t, q, p, NULL, NULL);
    *cleared = t == 0 && memcmp(q, some_q, sizeof q) == 0 && memcmp(p, some_p, sizeof p) == 0;
    return status;
}

/* The number of allocations that were made to fail before all went well. */
static long fail_each(maker *make, const void *argument, allocation_failure how)
{
    for (long k = 1;; k++) {
        bool cleared;
        ck_assert_int_eq(tvi_dense(NULL, 0, NULL, NULL), TVI_EINVAL); /* leaves another text */
        allocation_fail(how, k);
        const tvi_status status = make(argument, &cleared);
        const allocation_counts counts = allocation_stop();
        ck_assert_msg(counts.live == 0, "%ld blocks left when allocation %ld fails", counts.live, k);
        if (counts.fails == 0) {
            ck_assert_int_eq(status, TVI_OK);
            ck_assert(!cleared);
            return k - 1;
        }
        ck_assert_msg(status == TVI_ENOMEM, "%s when allocation %ld fails", tvi_status_string(status), k);
        ck_assert_msg(cleared, "the output when allocation %ld fails", k);
        ck_assert_ptr_nonnull(strstr(tvi_last_error(), "out of memory"));
    }
}

START_TEST(events_without_memory)
{
    const allocation_failure how = (allocation_failure)_i;
    tvi_system *system = create_system(POTENTIAL, true);
    run_arguments of = {0};
    tvi_event *event;
    ck_assert_int_eq(tvi_integrator_create(&of.integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&event, N, TVI_EITHER, false, radius, NULL), TVI_OK);
    of.event = event;
    ck_assert_int_gt(fail_each(make_event, NULL, how), 5);
    ck_assert_int_eq(fail_each(run_with_events, &of, how), 61);
    ck_assert_int_eq(fail_each(run_to_time, &of, how), 2);
    tvi_event_free(event);
    tvi_integrator_free(of.integrator);
    tvi_system_free(system);
}
END_TEST

START_TEST(systems_without_memory)
{
    const statement by = (statement)(_i / 2);
    ck_assert_int_gt(fail_each(make_system, &by, (allocation_failure)(_i % 2)), by == FORCE ? 100 : 500);
}
END_TEST

/* What is asked of a system: it may allocate. */
START_TEST(questions_without_memory)
{
    const statement by = (statement)(_i / 2);
    const allocation_failure how = (allocation_failure)(_i % 2);
    tvi_system *system = create_system(by, false);
    if (by != FORCE) ck_assert_int_gt(fail_each(ask_energy, system, how), 0);
    const long of_momentum = fail_each(ask_momentum, system, how), of_velocity = fail_each(ask_velocity, system, how);
    ck_assert_int_ge(of_momentum + of_velocity, by == LAGRANGIAN || by == HAMILTONIAN);
    tvi_system_free(system);
}
END_TEST

/* ---- The ways to make a step ------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    int order;
    tvi_quadrature quadrature;
    int passes;
    bool compose_adjoint;
    statement by;
} ways[] = {
    {"tvi", 1, TVI_RECTANGLE_START, 0, false, POTENTIAL},
    {"tvi", 2, TVI_TRAPEZOID, 0, false, POTENTIAL},
    {"tvi", 5, TVI_QUADRATURE_AUTO, 0, false, FORCE},
    {"start", 4, TVI_LOBATTO, 0, false, POTENTIAL},
    {"start", 8, TVI_QUADRATURE_AUTO, 2, false, LAGRANGIAN},
    {"end", 6, TVI_QUADRATURE_AUTO, 0, true, HAMILTONIAN},
    {"midpoint", 2, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"midpoint", 6, TVI_LOBATTO, 3, false, POTENTIAL},
    {"midpoint", 12, TVI_QUADRATURE_AUTO, 0, false, SEPARABLE_L},
    {"midpoint", 8, TVI_QUADRATURE_AUTO, 0, false, LAGRANGIAN},
    {"midpoint", 6, TVI_QUADRATURE_AUTO, TVI_PREDICT_ONLY, false, HAMILTONIAN},
    {"both-ends", 6, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"both-ends", 4, TVI_QUADRATURE_AUTO, 0, false, LAGRANGIAN},
    {"symmetric-tvi", 2, TVI_QUADRATURE_AUTO, 0, false, HAMILTONIAN},
    {"right", 6, TVI_QUADRATURE_AUTO, 0, false, SEPARABLE_H},
    {"left", 6, TVI_QUADRATURE_AUTO, 0, false, HAMILTONIAN},
    {"htvi-right", 3, TVI_QUADRATURE_AUTO, 0, false, HAMILTONIAN},
    {"htvi-left", 4, TVI_QUADRATURE_AUTO, 0, true, POTENTIAL},
    {"svhd", 2, TVI_TRAPEZOID, 0, true, POTENTIAL},
    {"poincare", 8, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"poincare", 4, TVI_QUADRATURE_AUTO, 0, false, HAMILTONIAN},
    {"galerkin", 16, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"galerkin", 6, TVI_GAUSS, 0, false, HAMILTONIAN},
    {"galerkin", 10, TVI_QUADRATURE_AUTO, 0, false, LAGRANGIAN},
    {"galerkin", 20, TVI_QUADRATURE_AUTO, 3, true, SEPARABLE_H},
    {"taylor", 7, TVI_QUADRATURE_AUTO, 0, false, POTENTIAL},
    {"taylor", 5, TVI_QUADRATURE_AUTO, 0, false, LAGRANGIAN},
    {"stormer-verlet", 2, TVI_QUADRATURE_AUTO, 0, false, FORCE},
    {"galerkin", 8, TVI_QUADRATURE_AUTO, 0, false, RESCALED},
    {"right", 4, TVI_QUADRATURE_AUTO, 0, true, RESCALED},
    {"taylor", 5, TVI_QUADRATURE_AUTO, 0, false, RESCALED},
};
enum { WAYS = sizeof ways / sizeof *ways };

static tvi_options options_of(int way)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(ways[way].name, ways[way].order, &options), TVI_OK);
    options.quadrature = ways[way].quadrature;
    options.passes = ways[way].passes;
    options.compose_adjoint = ways[way].compose_adjoint;
    return options;
}

START_TEST(integrators_without_memory)
{
    tvi_system *system = create_system(ways[_i].by, true);
    const tvi_options options = options_of(_i);
    const integrator_arguments chosen = {system, &options}, by_default = {system, NULL};
    for (int how = FAIL_ONCE; how <= FAIL_ONWARD; how++) {
        ck_assert_int_gt(fail_each(make_integrator, &chosen, (allocation_failure)how), 0);
        ck_assert_int_gt(fail_each(make_integrator, &by_default, (allocation_failure)how), 0);
    }
    tvi_system_free(system);
}
END_TEST

/* A first step with one tangent vector, then one with more of them. */
static tvi_status make_tangents(const void *argument, bool *cleared)
{
    const integrator_arguments *of = argument;
    tvi_integrator *integrator;
    double t = 0, q[N] = {0.1, -0.2, 0.3}, p[N] = {0.1, 0.1, -0.1}, D[4 * N * N] = {42};
    tvi_status status = tvi_integrator_create(&integrator, of->system, of->options);
    if (status == TVI_OK) status = tvi_step_tangent(integrator, 0.01, &t, q, p, D, 1);
    *cleared = t == 0 && q[0] == 0.1 && D[0] == 42;
    if (status == TVI_OK) {
        const double before = D[0], then = t;
        status = tvi_step_tangent(integrator, 0.01, &t, q, p, D, 2 * N);
        *cleared = t == then && D[0] == before;
    }
    tvi_integrator_free(integrator);
    return status;
}

START_TEST(tangents_without_memory)
{
    tvi_system *system = create_system(ways[_i].by, true);
    const tvi_options options = options_of(_i);
    const integrator_arguments chosen = {system, &options};
    for (int how = FAIL_ONCE; how <= FAIL_ONWARD; how++)
        ck_assert_int_gt(fail_each(make_tangents, &chosen, (allocation_failure)how), 50);
    tvi_system_free(system);
}
END_TEST

/* tvi_stats.bytes is what the integrator asked for. */
START_TEST(bytes)
{
    tvi_system *system = create_system(ways[_i].by, true);
    const tvi_options options = options_of(_i);
    tvi_integrator *integrator;
    allocation_count();
    const tvi_status status = tvi_integrator_create(&integrator, system, &options);
    const allocation_counts counts = allocation_stop();
    ck_assert_int_eq(status, TVI_OK);
    ck_assert_uint_eq(tvi_integrator_stats(integrator)->bytes, counts.bytes);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* ---- No allocation in a step ------------------------------------------------------------------------------------- */

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

START_TEST(steps_allocate_nothing)
{
    tvi_system *system = create_system(ways[_i].by, true);
    const tvi_options options = options_of(_i);
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    double t = 0, q[N] = {0.1, -0.2, 0.3}, p[N] = {0.1, 0.1, -0.1}, D[4 * N * N] = {1};
    ck_assert_int_eq(tvi_step_tangent(integrator, 0.01, &t, q, p, D, 2 * N), TVI_OK); /* the first may allocate */
    allocation_fail(FAIL_ONWARD, 1);
    const bool good = make_steps(integrator);
    const allocation_counts counts = allocation_stop();
    ck_assert_int_eq(counts.calls, 0);
    ck_assert(good);
    tvi_integrator_free(integrator);
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

static TCase *add_case(Suite *suite, const char *name)
{
    TCase *tcase = tcase_create(name);
    suite_add_tcase(suite, tcase);
    return tcase;
}

Suite *suite_faults(void)
{
    Suite *suite = suite_create("faults");
    tcase_add_test(add_case(suite, "hooks"), hooks_count);
    TCase *systems = add_case(suite, "systems");
    tcase_set_timeout(systems, 60);
    tcase_add_loop_test(systems, events_without_memory, 0, 2);
    tcase_add_loop_test(systems, systems_without_memory, 0, 2 * STATEMENTS);
    tcase_add_loop_test(systems, questions_without_memory, 0, 2 * STATEMENTS);
    TCase *integrators = add_case(suite, "integrators");
    tcase_add_loop_test(integrators, integrators_without_memory, 0, WAYS);
    tcase_add_loop_test(integrators, bytes, 0, WAYS);
    TCase *tangents = add_case(suite, "tangents");
    tcase_set_timeout(tangents, 60);
    tcase_add_loop_test(tangents, tangents_without_memory, 0, WAYS);
    tcase_add_loop_test(add_case(suite, "steps"), steps_allocate_nothing, 0, WAYS);
    return suite;
}
