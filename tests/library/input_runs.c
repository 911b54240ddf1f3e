/* input_runs.c - Tests many steps, dense output and counts: what is refused, where a run ends, and what is left then.
 * The contracts are those of tvi.h. */
#include "input.h"

#include <float.h>
#include <math.h>

/* ---- Problems ---------------------------------------------------------------------------------------------------- */

/* V = g q with a factor that exists for q > 0 only: everything falls out of the domain. */
static jet slope(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(q[0], jet_mul(0.01, jet_pow(q[0], 1.5)));
}

static jet free_particle(const jet q[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return jet_const(0);
}

/* ---- Many steps -------------------------------------------------------------------------------------------------- */

enum { RUN = 20 };

typedef struct {
    int n;
    long calls, stop_at;
    state last;
} watcher;

static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    watcher *w = ctx;
    w->calls++;
    ck_assert_int_eq(step, w->calls);
    w->last = start_of(&(scene){.n = w->n, .q = q, .p = p});
    w->last.t = t;
    return w->calls == w->stop_at ? -1 : 0; /* any value but 0 stops */
}

/* Stopped and continued is the same as stepped one by one. */
START_TEST(stopped_by_the_observer)
{
    const scene *x = &scene_henon_heiles_12;
    tvi_system *system = create_scene(x);
    tvi_integrator *one = create_integrator(system, &methods[_i]), *two = create_integrator(system, &methods[_i]);
    state s = start_of(x), by_steps = s;
    for (long stop = 1; stop <= 7; stop++) {
        watcher w = {.n = x->n, .stop_at = stop};
        const long before = tvi_integrator_stats(one)->steps;
        expect("stop", tvi_integrate(one, good_step, stop == 7 ? 7 : RUN, &s.t, s.q, s.p, watch, &w), TVI_ESTOPPED);
        ck_assert_int_eq(w.calls, stop);
        ck_assert_int_eq(tvi_integrator_stats(one)->steps - before, stop);
        expect_same("the state that was shown", &w.last, &s);
        for (long step = 0; step < stop; step++) expect("step", step_once(two, good_step, &by_steps), TVI_OK);
        expect_same("step by step", &s, &by_steps);
    }
    watcher w = {.n = x->n};
    expect("to the end", tvi_integrate(one, good_step, RUN, &s.t, s.q, s.p, watch, &w), TVI_OK);
    ck_assert_int_eq(w.calls, RUN);
    expect_same("the last state", &w.last, &s);
    tvi_integrator_free(one);
    tvi_integrator_free(two);
    tvi_system_free(system);
}
END_TEST

START_TEST(no_steps)
{
    const scene *x = &scene_henon_heiles_12;
    tvi_system *system = create_scene(x);
    tvi_integrator *integrator = create_integrator(system, &methods[_i]);
    const state was = start_of(x);
    state s = was;
    watcher w = {.n = x->n, .stop_at = 1};
    expect("no steps", tvi_integrate(integrator, good_step, 0, &s.t, s.q, s.p, watch, &w), TVI_OK);
    expect_same("no steps", &s, &was);
    ck_assert_int_eq(w.calls, 0);
    ck_assert_int_eq(tvi_integrator_stats(integrator)->steps, 0);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* On failure the state is that of the last successful step. */
START_TEST(failure_on_the_way)
{
    tvi_system *system = create_system(1, slope);
    tvi_integrator *integrator = create_integrator(system, &methods[_i]);
    state s = {0, {0.5}, {0}};
    watcher w = {.n = 1};
    expect(methods[_i].name, tvi_integrate(integrator, 0.125, RUN, &s.t, s.q, s.p, watch, &w), TVI_EDOMAIN);
    ck_assert_int_ge(w.calls, 5);
    ck_assert_int_le(w.calls, 9); /* q = 0 at t = 1 or a little later */
    ck_assert_int_eq(tvi_integrator_stats(integrator)->steps, w.calls);
    expect_same("the last good state", &s, &w.last);
    ck_assert_double_eq(s.t, 0.125 * (double)w.calls);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* A particle without force, which has no nodes in its recording but constants. */
START_TEST(without_a_force)
{
    tvi_system *system = create_system(2, free_particle);
    tvi_integrator *integrator = create_integrator(system, &methods[_i]);
    state s = {0, {1, 2}, {0.5, -0.25}};
    for (int step = 0; step < 4; step++) expect(methods[_i].name, step_once(integrator, 2, &s), TVI_OK);
    const double left = fabs(s.q[0] - 5) + fabs(s.q[1]) + fabs(s.p[0] - 0.5) + fabs(s.p[1] + 0.25);
    ck_assert_msg(left < 1e-14 && s.t == 8, "%s: %g from the straight line", methods[_i].name, left);
    state late = {DBL_MAX, {1, 2}, {0, 0}}; /* only the time overflows */
    expect("late", step_once(integrator, DBL_MAX, &late), TVI_ETOOLARGE);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* ---- Dense output ------------------------------------------------------------------------------------------------ */

static void expect_no_dense(const char *what, tvi_integrator *integrator, double theta)
{
    state s = {.q = {42, 43}, .p = {44, 45}};
    const state was = s;
    expect(what, tvi_dense(integrator, theta, s.q, s.p), TVI_EINVAL);
    expect_same(what, &s, &was);
}

/* At theta = 0 and 1 it is the state before and after the step, to roundoff. */
static void expect_dense(const char *what, tvi_integrator *integrator, int n, double theta, const state *wanted)
{
    state s = {0};
    expect(what, tvi_dense(integrator, theta, s.q, s.p), TVI_OK);
    for (int i = 0; i < n; i++) {
        ck_assert_msg(fabs(s.q[i] - wanted->q[i]) <= 1e-14 * (1 + fabs(wanted->q[i])), "%s: q at %g", what, theta);
        ck_assert_msg(fabs(s.p[i] - wanted->p[i]) <= 1e-14 * (1 + fabs(wanted->p[i])), "%s: p at %g", what, theta);
    }
}

START_TEST(dense_output)
{
    pair x;
    if (!open_pair(&x, _i)) return;
    tvi_integrator *integrator = create_integrator(x.system, x.m);
    state s = start_of(x.problem);
    const state before = s;
    expect_no_dense("before a step", integrator, 0.5);
    expect(x.name, step_once(integrator, good_step, &s), TVI_OK);
    expect_no_dense("theta < 0", integrator, -1e-9);
    expect_no_dense("theta > 1", integrator, 1 + 1e-9);
    expect_no_dense("theta NaN", integrator, NAN);
    expect("integrator", tvi_dense(NULL, 0.5, s.q, s.p), TVI_EINVAL);
    expect("q", tvi_dense(integrator, 0.5, NULL, s.p), TVI_EINVAL);
    expect("p", tvi_dense(integrator, 0.5, s.q, NULL), TVI_EINVAL);
    expect_dense(x.name, integrator, x.problem->n, 0, &before);
    expect_dense(x.name, integrator, x.problem->n, 1, &s);
    expect("h NaN", step_once(integrator, NAN, &s), TVI_EINVAL);
    expect_no_dense("after a step that was refused", integrator, 0.5);
    expect(x.name, step_once(integrator, good_step, &s), TVI_OK);
    if (step_once(integrator, DBL_MAX, &s) != TVI_OK) {
        expect_no_dense("after a step that failed", integrator, 0.5);
        expect(x.name, step_once(integrator, good_step, &s), TVI_OK);
    }
    expect_dense(x.name, integrator, x.problem->n, 1, &s);
    tvi_integrator_free(integrator);
    close_pair(&x);
}
END_TEST

/* Between two steps it leaves no trace. */
START_TEST(dense_leaves_no_trace)
{
    pair x;
    if (!open_pair(&x, _i)) return;
    tvi_integrator *with = create_integrator(x.system, x.m), *without = create_integrator(x.system, x.m);
    state s = start_of(x.problem), wanted = s, dense = s;
    for (int step = 0; step < RUN; step++) {
        expect(x.name, step_once(with, good_step, &s), TVI_OK);
        expect(x.name, step_once(without, good_step, &wanted), TVI_OK);
        for (int i = 0; i <= 4; i++) expect(x.name, tvi_dense(with, i / 4.0, dense.q, dense.p), TVI_OK);
        ck_assert(state_is_finite(&dense));
    }
    expect_same(x.name, &s, &wanted);
    tvi_integrator_free(with);
    tvi_integrator_free(without);
    close_pair(&x);
}
END_TEST

/* ---- Counts ------------------------------------------------------------------------------------------------------ */

/* From the start of Henon-Heiles. */
static tvi_stats stats_after(const tvi_options *options, long steps)
{
    tvi_system *system = create_scene(&scene_henon_heiles_12);
    tvi_integrator *it;
    ck_assert_int_eq(tvi_integrator_create(&it, system, options), TVI_OK);
    const tvi_stats *stats = tvi_integrator_stats(it);
    ck_assert(stats->steps == 0 && stats->passes == 0 && stats->expansions == 0 && stats->force_evaluations == 0 &&
              stats->factorisations == 0 && stats->residual == 0 && stats->tail == 0 && stats->bytes > 0);
    const size_t bytes = stats->bytes;
    state s = start_of(&scene_henon_heiles_12);
    ck_assert_int_eq(tvi_integrate(it, good_step, steps, &s.t, s.q, s.p, NULL, NULL), TVI_OK);
    const tvi_stats after = *stats;
    ck_assert_int_eq(after.steps, steps);
    ck_assert_uint_eq(after.bytes, bytes);
    ck_assert(after.residual >= 0 && after.residual < (options->passes > 0 ? 0.1 : fmax(1e-6, options->tolerance)));
    ck_assert(after.tail >= 0 && after.tail < 0.1);
    tvi_integrator_free(it);
    tvi_system_free(system);
    return after;
}

static tvi_options options_named(const char *name, int order)
{
    tvi_options options;
    ck_assert_int_eq(tvi_options_named(name, order, &options), TVI_OK);
    return options;
}

START_TEST(counts_of_explicit_methods)
{
    const tvi_options taylor = options_named("taylor", 6), verlet = options_named("stormer-verlet", 2);
    tvi_stats stats = stats_after(&taylor, RUN);
    ck_assert_int_eq(stats.expansions, RUN);
    ck_assert_int_eq(stats.passes, 0);
    ck_assert_int_eq(stats.force_evaluations, 0);
    ck_assert_int_eq(stats.factorisations, 0);
    ck_assert_double_eq(stats.residual, 0);
    ck_assert_double_gt(stats.tail, 0);
    stats = stats_after(&verlet, RUN);
    ck_assert_int_eq(stats.expansions, 0);
    ck_assert_int_eq(stats.passes, 0);
    ck_assert_int_eq(stats.force_evaluations, 2 * RUN);
    ck_assert_double_eq(stats.residual, 0);
}
END_TEST

/* Exactly k passes: k residuals, each a force value at each node and an expansion of each curve. Away from the start
 * the predictor is one more expansion. */
START_TEST(counts_of_fixed_passes)
{
    static const struct {
        const char *name;
        int curves, predictor;
    } rows[] = {{"tvi", 1, 0},       {"start", 1, 0}, {"end", 1, 1},  {"midpoint", 1, 1},
                {"both-ends", 2, 1}, {"right", 1, 0}, {"left", 1, 0}, {"poincare", 1, 1}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        for (int passes = 1; passes <= 4; passes++) {
            tvi_options options = options_named(rows[i].name, 6);
            options.passes = passes;
            options.quadrature = TVI_GAUSS;
            options.quadrature_points = 5;
            const tvi_stats stats = stats_after(&options, RUN);
            ck_assert_int_eq(stats.passes, passes * RUN);
            ck_assert_int_eq(stats.force_evaluations, 5 * passes * RUN);
            ck_assert_int_eq(stats.expansions, (rows[i].curves * passes + rows[i].predictor) * RUN);
            ck_assert_int_ge(stats.factorisations, RUN);
        }
}
END_TEST

START_TEST(counts_of_prediction)
{
    tvi_options options = options_named("midpoint", 6);
    options.passes = TVI_PREDICT_ONLY;
    const tvi_stats stats = stats_after(&options, RUN);
    ck_assert_int_eq(stats.passes, 0);
    ck_assert_int_eq(stats.expansions, 2 * RUN);
    ck_assert_double_eq(stats.residual, 0);
}
END_TEST

/* Until converged: a tolerance is kept and costs fewer passes than roundoff. */
START_TEST(counts_of_convergence)
{
    tvi_options options = options_named("midpoint", 4);
    const tvi_stats roundoff = stats_after(&options, RUN);
    options.tolerance = 1e-3;
    const tvi_stats loose = stats_after(&options, RUN);
    ck_assert_int_ge(loose.passes, RUN);
    ck_assert_int_gt(roundoff.passes, loose.passes);
    ck_assert_double_le(loose.residual, 1e-3);
}
END_TEST

/* ---- The cases --------------------------------------------------------------------------------------------------- */

TCase *tcase_integrate(void)
{
    TCase *tcase = tcase_create("many steps");
    tcase_add_loop_test(tcase, stopped_by_the_observer, 0, method_count);
    tcase_add_loop_test(tcase, no_steps, 0, method_count);
    tcase_add_loop_test(tcase, failure_on_the_way, 0, method_count);
    tcase_add_loop_test(tcase, without_a_force, 0, method_count);
    return tcase;
}

TCase *tcase_dense(void)
{
    TCase *tcase = tcase_create("dense");
    tcase_add_loop_test(tcase, dense_output, 0, problem_count * method_count);
    tcase_add_loop_test(tcase, dense_leaves_no_trace, 0, problem_count * method_count);
    return tcase;
}

TCase *tcase_stats(void)
{
    TCase *tcase = tcase_create("counts");
    tcase_add_test(tcase, counts_of_explicit_methods);
    tcase_add_test(tcase, counts_of_fixed_passes);
    tcase_add_test(tcase, counts_of_prediction);
    tcase_add_test(tcase, counts_of_convergence);
    return tcase;
}
