/* test_failing.c - Tests every hard case with every method, driven past the largest step that can be made: the status
 * names the cause, the state is bit for bit what it was, the work was bounded, and the integrator goes on as if nothing
 * had been. */
#include "stability.h"

#include <math.h>
#include <string.h>

enum { GOOD = 3 }; /* steps before and after */

static const hard_case *case_of(int i) { return all_cases[i / method_count]; }
static const hard_method *method_of(int i) { return &all_methods[i % method_count]; }

/* Both of Kepler's extreme sizes have no force that a double can hold. */
static bool has_force(const hard_case *c) { return c != &kepler_tiny && c != &kepler_huge; }

static bool is_step_failure(tvi_status status)
{
    return status == TVI_EDOMAIN || status == TVI_ENOCONV || status == TVI_ESINGULAR || status == TVI_ENONFINITE ||
           status == TVI_ETOOLARGE;
}

/* The passes of one step: the bound, by default 64 or the Galerkin curve's 100; for each half of a composition, and
 * twice for the Galerkin curve, which may begin again. The expansions: of the predictor and the first pass, then one a
 * pass or, at both ends, two, and three times a Jacobian by 2n differences and a return. */
static void expect_bounded_work(const hard_pair *pair, const tvi_stats *before)
{
    const tvi_options *options = tvi_integrator_options(pair->integrator);
    const bool at_nodes = options->expansion == TVI_AT_NODES;
    const int max_passes = options->max_passes > 0 ? options->max_passes : at_nodes ? 100 : 64;
    const tvi_stats *after = tvi_integrator_stats(pair->integrator);
    const long halves = options->compose_adjoint || at_nodes ? 2 : 1;
    const long curves = options->expansion == TVI_AT_BOTH_ENDS ? 2 : 1;
    const long passes = after->passes - before->passes, expansions = after->expansions - before->expansions;
    const long residuals = max_passes + 3 * (2 * pair->problem->scene.n + 1);
    ck_assert_msg(passes <= halves * max_passes, "%s: %ld passes", pair->name, passes);
    ck_assert_msg(expansions <= halves * (1 + curves * (1 + residuals)), "%s: %ld expansions", pair->name, expansions);
}

/* A step that is made is finite, one that fails has a cause, changes nothing and is bounded. */
static tvi_status try_step(const hard_pair *pair, double h, hard_state *x)
{
    const hard_state was = *x;
    const tvi_stats before = *tvi_integrator_stats(pair->integrator);
    const tvi_status status = pair_step(pair, h, x);
    if (status == TVI_OK) {
        ck_assert_msg(is_finite(x), "%s, h = %g: not finite", pair->name, h);
    } else {
        ck_assert_msg(is_step_failure(status), "%s, h = %g: status %d", pair->name, h, (int)status);
        ck_assert_msg(memcmp(x, &was, sizeof was) == 0, "%s, h = %g: the state was changed", pair->name, h);
        ck_assert_int_eq(tvi_integrator_stats(pair->integrator)->steps, before.steps);
    }
    expect_bounded_work(pair, &before);
    return status;
}

/* The state after GOOD small steps from the start. */
static hard_state run_up(const hard_pair *pair)
{
    hard_state x = start_of(pair->problem);
    for (int step = 0; step < GOOD; step++) ck_assert_int_eq(pair_step(pair, pair->problem->h_least, &x), TVI_OK);
    return x;
}

/* The first of h_least, 2 h_least, 4 h_least, ... that fails; the steps that are made start from the same state. */
static double first_failure(const hard_case *c, const hard_method *m, int max_passes)
{
    hard_pair pair = pair_open(c, m, 0);
    const hard_state start = run_up(&pair);
    pair_close(&pair);
    pair = pair_open(c, m, max_passes);
    double h = c->h_least;
    for (;; h *= 2) {
        hard_state x = start;
        ck_assert_msg(isfinite(h), "%s: no step fails", pair.name);
        if (try_step(&pair, h, &x) != TVI_OK) break;
    }
    pair_close(&pair);
    return h;
}

/* Tells whether a step of h fails after GOOD small steps of the same run, whose energy the guard knows. */
static bool fails_after_run_up(const hard_case *c, const hard_method *m, double h)
{
    hard_pair pair = pair_open(c, m, 0);
    hard_state x = run_up(&pair);
    const tvi_status status = try_step(&pair, h, &x);
    pair_close(&pair);
    return status != TVI_OK;
}

/* Control: an integrator that forgot its low-order parts would not go on alike (test_stepping.c, reset_forgets). */
START_TEST(failing_steps_leave_no_trace)
{
    const hard_case *c = case_of(_i);
    const hard_method *m = method_of(_i);
    if (!has_force(c)) return;
    double h = first_failure(c, m, 0);
    for (double most = 16 * h; !fails_after_run_up(c, m, h); h *= 2) ck_assert(h < most);
    hard_pair tried = pair_open(c, m, 0), plain = pair_open(c, m, 0);
    hard_state x = run_up(&tried), y = run_up(&plain);
    ck_assert_msg(try_step(&tried, h, &x) != TVI_OK, "%s: h = %g fails only at times", m->name, h);
    for (int step = 0; step < GOOD; step++) {
        ck_assert_int_eq(pair_step(&tried, c->h_least, &x), TVI_OK);
        ck_assert_int_eq(pair_step(&plain, c->h_least, &y), TVI_OK);
        ck_assert_msg(memcmp(&x, &y, sizeof x) == 0, "%s, h = %g: %d steps later", tried.name, h, step + 1);
    }
    pair_close(&tried);
    pair_close(&plain);
}
END_TEST

START_TEST(passes_keep_to_the_options)
{
    if (has_force(case_of(_i))) (void)first_failure(case_of(_i), method_of(_i), 5);
}
END_TEST

typedef struct {
    hard_state last;
    int n;
} witness;

static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    witness *w = ctx;
    (void)step;
    w->last.t = t;
    memcpy(w->last.q, q, (size_t)w->n * sizeof *q);
    memcpy(w->last.p, p, (size_t)w->n * sizeof *p);
    ck_assert(is_finite(&w->last));
    return 0;
}

/* Runs with steps around the largest that survives, until one fails: the state is that of the last step made. */
START_TEST(runs_end_at_the_last_good_step)
{
    const hard_case *c = case_of(_i);
    hard_pair pair = pair_open(c, method_of(_i), 0);
    for (double h = c->h_most; h > c->h_most / 100; h /= 3) {
        hard_state x = start_of(c);
        witness w = {x, c->scene.n};
        const tvi_status status = tvi_integrate(pair.integrator, h, 30, &x.t, x.q, x.p, watch, &w);
        ck_assert_msg(status == TVI_OK || is_step_failure(status), "%s, h = %g: status %d", pair.name, h, (int)status);
        ck_assert_msg(memcmp(&x, &w.last, sizeof x) == 0, "%s, h = %g: not the last state", pair.name, h);
    }
    pair_close(&pair);
}
END_TEST

Suite *suite_failing(void)
{
    Suite *suite = suite_create("failing");
    TCase *tcase = tcase_create("failing");
    tcase_add_loop_test(tcase, failing_steps_leave_no_trace, 0, case_count * method_count);
    tcase_add_loop_test(tcase, passes_keep_to_the_options, 0, case_count * method_count);
    tcase_add_loop_test(tcase, runs_end_at_the_last_good_step, 0, case_count * method_count);
    suite_add_tcase(suite, tcase);
    return suite;
}
