/* test_suggest.c - Tests the step that is chosen for an error: the error of a run with it, which is measured, and what
 * ends the search. */
#include "events.h"
#include "scenes/hard.h"

#include <math.h>
#include <string.h>

enum { N_MAX = 18 };

/* A run, and where it ends. */
typedef struct {
    const tvi_system *system;
    tvi_options options;
    int n;
    const double *q, *p;
    double duration;
    double end[2 * N_MAX], size[2]; /* the largest coordinate and momentum */
} trip;

static int take_sizes(long step, double t, const double q[], const double p[], void *ctx)
{
    trip *to = ctx;
    (void)step, (void)t;
    for (int i = 0; i < to->n; i++)
        to->size[0] = fmax(to->size[0], fabs(q[i])), to->size[1] = fmax(to->size[1], fabs(p[i]));
    return 0;
}

/* *steps: those of the run. */
static tvi_status travel(const trip *to, const tvi_options *options, double h, double end[], tvi_observer *observer,
                         void *ctx, long *steps)
{
    tvi_integrator *it;
    double t = 0, *q = end, *p = end + to->n;
    memcpy(q, to->q, (size_t)to->n * sizeof *q);
    memcpy(p, to->p, (size_t)to->n * sizeof *p);
    ck_assert_int_eq(tvi_integrator_create(&it, to->system, options), TVI_OK);
    const tvi_status status = tvi_integrate_to(it, h, to->duration, &t, q, p, observer, ctx);
    *steps = tvi_integrator_stats(it)->steps;
    tvi_integrator_free(it);
    return status;
}

/* The end and the sizes, by steps that are small. */
static void look_ahead(trip *to, double h)
{
    tvi_options options;
    long steps;
    ck_assert_int_eq(tvi_options_named("galerkin", 16, &options), TVI_OK);
    to->size[0] = to->size[1] = 0;
    ck_assert_int_eq(travel(to, &options, h, to->end, take_sizes, to, &steps), TVI_OK);
}

static double error_of(const trip *to, const double end[])
{
    double error = 0;
    for (int i = 0; i < 2 * to->n; i++) error = fmax(error, fabs(end[i] - to->end[i]) / to->size[i / to->n]);
    return error;
}

/* That of a run with steps of h; infinite where one is refused. */
static double error_with(const trip *to, double h, long *steps)
{
    double end[2 * N_MAX];
    return travel(to, &to->options, h, end, NULL, NULL, steps) == TVI_OK ? error_of(to, end) : INFINITY;
}

/* Below this an error may be roundoff, of which the measured one is a model. */
#define ROUNDOFF 1e-10

/* The error is at most the wanted one, and at most twice the measured one, and the step is not much shorter than it has
 * to be; or roundoff makes more. Once an error is refused, smaller ones are. */
static void assert_measured(const trip *to, const char *name, double smallest)
{
    bool is_refused = false;
    for (double wanted = 1e-3; wanted > smallest; wanted /= 10) {
        const tvi_run_plan plan = {.t_end = to->duration};
        double h = 0, measured = 0;
        long steps;
        const tvi_status status =
            tvi_measure_step(to->system, &to->options, &plan, 0, to->q, to->p, wanted, &h, &measured);
        ck_assert_msg(status == TVI_OK || status == TVI_EROUNDOFF, "%s, %g: %s", name, wanted, tvi_last_error());
        ck_assert_msg(!is_refused || status == TVI_EROUNDOFF, "%s: %g is refused, and %g is not", name, wanted * 10,
                      wanted);
        is_refused = status == TVI_EROUNDOFF;
        ck_assert(h * to->duration > 0 && (measured <= wanted) == !is_refused);
        const double error = error_with(to, h, &steps);
        ck_assert_msg(is_refused || error <= wanted, "%s, %g: h = %g, %g", name, wanted, h, error);
        ck_assert_msg(error <= 2 * measured + ROUNDOFF, "%s, %g: h = %g, %g measured as %g", name, wanted, h, error,
                      measured);
        ck_assert_msg(is_refused || measured >= wanted / 100 || wanted < 100 * ROUNDOFF ||
                          !(error_with(to, 3 * h, &steps) <= wanted / 2) || 3 * fabs(h) > fabs(to->duration),
                      "%s, %g: h = %g is small, %g", name, wanted, h, measured);
    }
}

START_TEST(scenes_reach_what_is_wanted)
{
    static const struct {
        const char *name;
        int order;
        double smallest;
    } methods[] = {{"galerkin", 16, 1e-12}, {"galerkin", 8, 1e-9}, {"taylor", 12, 1e-9}, {"midpoint", 12, 1e-9}};
    for (int list = 0; list < 2; list++)
        for (const scene *const *s = list ? general_scenes : scenes; *s; s++) {
            tvi_system *system;
            ck_assert_int_eq(scene_system(*s, &system), TVI_OK);
            trip to = {.system = system, .n = (*s)->n, .q = (*s)->q, .p = (*s)->p, .duration = (*s)->t_end};
            ck_assert_int_eq(tvi_options_named(methods[_i].name, methods[_i].order, &to.options), TVI_OK);
            if (tvi_options_check(system, &to.options, NULL) == TVI_OK) {
                look_ahead(&to, (*s)->t_end / (200 * (1 + (*s)->t_end / (*s)->steps[0] / 40)));
                assert_measured(&to, (*s)->name, methods[_i].smallest);
            }
            tvi_system_free(system);
        }
}
END_TEST

/* Friction makes errors die out. */
static jet pendulum(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_cos(q[0]));
}

static void drive(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)ctx;
    force[0] = jet_sub(jet_mul(0.9, jet_cos(jet_mul(2.0 / 3, t))), jet_div(v[0], 2));
}

START_TEST(driven_systems)
{
    const double q = 0.1, p = 0;
    tvi_system *base, *system;
    ck_assert_int_eq(tvi_system_potential(&base, 1, NULL, pendulum, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_driven(&system, base, drive, NULL), TVI_OK);
    trip to = {.system = system, .options = tvi_options_default(), .n = 1, .q = &q, .p = &p, .duration = 200};
    look_ahead(&to, 0.1);
    assert_measured(&to, "driven", 1e-12);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* Steps in s, and orbits that are at other times after as many of them. */
START_TEST(rescaled_systems)
{
    const hard_scene *const orbit = _i == 0 ? &hard_kepler_90 : &hard_kepler_99;
    const scene *s = &orbit->scene;
    tvi_system *base, *system;
    ck_assert_int_eq(scene_system(s, &base), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&system, base, orbit->scale, NULL), TVI_OK);
    trip to = {.system = system, .options = tvi_options_default(), .n = 2, .q = s->q, .p = s->p, .duration = s->t_end};
    look_ahead(&to, 0.4);
    assert_measured(&to, s->name, 1e-9);
    tvi_system_free(system);
    tvi_system_free(base);
}
END_TEST

/* A run of 16,000 revolutions. */
START_TEST(long_runs)
{
    const scene *s = &scene_kepler;
    tvi_system *system;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    trip to = {.system = system, .options = tvi_options_default(), .n = 2, .q = s->q, .p = s->p, .duration = 1e5};
    look_ahead(&to, 0.05);
    const tvi_run_plan plan = {.t_end = to.duration};
    for (double wanted = 1e-4; wanted > 1e-12; wanted /= 1000) {
        double h = 0, measured = 0;
        long steps;
        const tvi_status status = tvi_measure_step(system, NULL, &plan, 0, s->q, s->p, wanted, &h, &measured);
        ck_assert_int_eq(status, wanted > 1e-8 ? TVI_OK : TVI_EROUNDOFF); /* roundoff makes 1e-9 of it */
        ck_assert(status == TVI_OK || (measured > 1e-10 && measured < 1e-8));
        ck_assert_double_le(error_with(&to, h, &steps), 2 * measured + 2e-9);
    }
    tvi_system_free(system);
}
END_TEST

/* Back in time from the same apocentre, as far. */
START_TEST(backwards)
{
    const scene *s = &scene_kepler;
    tvi_system *system;
    double there = 0, back = 0;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    ck_assert_int_eq(tvi_suggest_step(system, NULL, 0, s->q, s->p, 40, 1e-8, &there), TVI_OK);
    ck_assert_int_eq(tvi_suggest_step(system, NULL, 0, s->q, s->p, -40, 1e-8, &back), TVI_OK);
    ck_assert_double_eq_tol(back, -there, 0.5 * there);
    tvi_system_free(system);
}
END_TEST

/* ---- What ends a search ------------------------------------------------------------------------------------------ */

static jet height(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], -0.5);
}

/* What lies behind a terminal event plays no part: the fall into the centre, with a distance of 1e-7 from it. */
START_TEST(runs_end_at_terminal_events)
{
    const scene *s = &scene_kepler;
    const double q[] = {1, 0}, p[] = {0, 3e-4};
    tvi_system *system;
    tvi_event *event;
    double h = 0, measured = 0;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&event, 2, TVI_FALLING, true, height, NULL), TVI_OK);
    tvi_run_plan plan = {.t_end = 1, .events = (const tvi_event *[]){event}, .event_count = 1, .steps = 100000};
    ck_assert_int_eq(tvi_measure_step(system, NULL, &plan, 0, q, p, 1e-8, &h, &measured), TVI_OK);
    ck_assert(h > 0.05 && measured <= 1e-8);
    plan.t_end = 2; /* the event does not come before the centre does */
    plan.event_count = 0;
    h = measured = 42;
    ck_assert_int_eq(tvi_measure_step(system, NULL, &plan, 0, q, p, 1e-8, &h, &measured), TVI_ESTOPPED);
    ck_assert(h == 42 && measured == 42);
    tvi_event_free(event);
    tvi_system_free(system);
}
END_TEST

static int stop_after(int member, int step, double t, const double q[], const double p[], void *ctx)
{
    int *left = ctx;
    (void)t, (void)q, (void)p;
    ck_assert(member == 0 && step > 0);
    return (*left)-- == 0;
}

START_TEST(searches_are_stopped)
{
    const scene *s = &scene_kepler;
    tvi_system *system;
    int left = 3;
    double h = 42, measured = 42;
    ck_assert_int_eq(scene_system(s, &system), TVI_OK);
    const tvi_run_plan plan = {.t_end = 1e5, .at_step = stop_after, .ctx = &left};
    ck_assert_int_eq(tvi_measure_step(system, NULL, &plan, 0, s->q, s->p, 1e-8, &h, &measured), TVI_ESTOPPED);
    ck_assert(left == -1 && h == 42 && measured == 42);
    tvi_system_free(system);
}
END_TEST

/* ---- Refusals ---------------------------------------------------------------------------------------------------- */

static jet root(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sqrt(q[0]);
}

START_TEST(bad_input_is_refused)
{
    tvi_system *kepler, *bounded;
    tvi_options odd = tvi_options_default();
    odd.order = 7;
    ck_assert_int_eq(scene_system(&scene_kepler, &kepler), TVI_OK);
    const tvi_run_plan with_h = {.h = 0.1, .t_end = 10};
    double h = 42, measured = 42;
    ck_assert_int_eq(tvi_measure_step(kepler, NULL, NULL, 0, scene_kepler.q, scene_kepler.p, 1e-6, &h, &measured),
                     TVI_EINVAL);
    ck_assert(strstr(tvi_last_error(), "plan is NULL") && h == 42 && measured == 42);
    ck_assert_int_eq(tvi_measure_step(kepler, NULL, &with_h, 0, scene_kepler.q, scene_kepler.p, 1e-6, &h, &measured),
                     TVI_EINVAL);
    ck_assert(strstr(tvi_last_error(), "the plan has an h"));
    ck_assert_int_eq(tvi_system_potential(&bounded, 1, NULL, root, NULL), TVI_OK);
    const double *const q = scene_kepler.q, *const p = scene_kepler.p, bad[] = {1, NAN}, minus = -1, none = 0;
    double out;
    const struct {
        const char *culprit;
        tvi_status status;
        const tvi_system *system;
        const tvi_options *options;
        double t;
        const double *q, *p;
        double duration, error, *h;
    } rows[] = {
        {"system is NULL", TVI_EINVAL, NULL, NULL, 0, q, p, 10, 1e-6, &out},
        {"q is NULL", TVI_EINVAL, kepler, NULL, 0, NULL, p, 10, 1e-6, &out},
        {"p is NULL", TVI_EINVAL, kepler, NULL, 0, q, NULL, 10, 1e-6, &out},
        {"h is NULL", TVI_EINVAL, kepler, NULL, 0, q, p, 10, 1e-6, NULL},
        {"duration = 0", TVI_EINVAL, kepler, NULL, 0, q, p, 0, 1e-6, &out},
        {"duration = inf", TVI_EINVAL, kepler, NULL, 0, q, p, INFINITY, 1e-6, &out},
        {"roundoff of t", TVI_EINVAL, kepler, NULL, 1, q, p, 1e-15, 1e-6, &out},
        {"error = 0", TVI_EINVAL, kepler, NULL, 0, q, p, 10, 0, &out},
        {"error = 1 ", TVI_EINVAL, kepler, NULL, 0, q, p, 10, 1, &out},
        {"error = -1", TVI_EINVAL, kepler, NULL, 0, q, p, 10, -1, &out},
        {"error = nan", TVI_EINVAL, kepler, NULL, 0, q, p, 10, NAN, &out},
        {"error = 1e-16", TVI_EINVAL, kepler, NULL, 0, q, p, 10, 1e-16, &out},
        {"order = 7", TVI_EINVAL, kepler, &odd, 0, q, p, 10, 1e-6, &out},
        {"t = nan", TVI_ENONFINITE, kepler, NULL, NAN, q, p, 10, 1e-6, &out},
        {"q[1] = nan", TVI_ENONFINITE, kepler, NULL, 0, bad, p, 10, 1e-6, &out},
        {"jet_sqrt", TVI_EDOMAIN, bounded, NULL, 0, &minus, &none, 10, 1e-6, &out},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        out = 42;
        const tvi_status status = tvi_suggest_step(rows[i].system, rows[i].options, rows[i].t, rows[i].q, rows[i].p,
                                                   rows[i].duration, rows[i].error, rows[i].h);
        ck_assert_msg(status == rows[i].status, "%s: %s, %s", rows[i].culprit, tvi_status_string(status),
                      tvi_last_error());
        ck_assert_msg(strstr(tvi_last_error(), rows[i].culprit), "\"%s\" names no \"%s\"", tvi_last_error(),
                      rows[i].culprit);
        ck_assert(out == 42);
    }
    tvi_system_free(bounded);
    tvi_system_free(kepler);
}
END_TEST

Suite *suite_suggest(void)
{
    Suite *suite = suite_create("suggested steps");
    TCase *errors = tcase_create("errors"), *input = tcase_create("input");
    tcase_set_timeout(errors, 120);
    tcase_add_loop_test(errors, scenes_reach_what_is_wanted, 0, 4);
    tcase_add_test(errors, driven_systems);
    tcase_add_loop_test(errors, rescaled_systems, 0, 2);
    tcase_add_test(errors, long_runs);
    tcase_add_test(errors, backwards);
    tcase_add_test(input, runs_end_at_terminal_events);
    tcase_add_test(input, searches_are_stopped);
    tcase_add_test(input, bad_input_is_refused);
    suite_add_tcase(suite, errors);
    suite_add_tcase(suite, input);
    return suite;
}
