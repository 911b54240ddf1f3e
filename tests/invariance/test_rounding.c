/* test_rounding.c - Tests that steps, events, runs to a tolerance and saved states are the same to roundoff in each of
 * the four rounding modes of the processor, by every method. */
#include "invariance.h"
#include "methods.h"
#include "motions.h"
#include "problems/texts.h"

#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 12 };

static const struct {
    const char *name;
    int mode;
} roundings[] = {{"downward", FE_DOWNWARD}, {"upward", FE_UPWARD}, {"to 0", FE_TOWARDZERO}, {"nearest", FE_TONEAREST}};
enum { ROUNDINGS = sizeof roundings / sizeof *roundings };

/* ---- Ways to run ------------------------------------------------------------------------------------------------- */

static jet first_coordinate(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], 0.0625);
}

/* Sums the events' times, and counts them in the integer part. */
static int add_event(int which, double t, const double q[], const double p[], void *ctx)
{
    (void)which, (void)q, (void)p;
    *(double *)ctx += 1000 + t;
    return 0;
}

/* The arguments of a run, whose state is in `x`; `sum` is that of its events. */
typedef struct {
    tvi_integrator *integrator;
    const tvi_event *event;
    double h, sum;
    outcome x;
} run;
typedef tvi_status way_fn(run *r);

static tvi_status make_steps(run *r)
{
    return tvi_integrate(r->integrator, r->h, STEPS, &r->x.t, r->x.x, r->x.p, NULL, NULL);
}

static tvi_status make_steps_with_events(run *r)
{
    return tvi_integrate_events(r->integrator, r->h, STEPS, &r->event, 1, &r->x.t, r->x.x, r->x.p, NULL, add_event,
                                &r->sum);
}

static tvi_status run_to_time(run *r)
{
    return tvi_integrate_to(r->integrator, r->h, r->x.t + 10.3 * r->h, &r->x.t, r->x.x, r->x.p, NULL, NULL);
}

static tvi_status run_to_tolerance(run *r)
{
    const tvi_status status = tvi_integrate_tolerance_events(r->integrator, 1e-13, r->x.t + 10.3 * r->h, &r->event, 1,
                                                             &r->x.t, r->x.x, r->x.p, NULL, add_event, &r->sum);
    return status == TVI_EUNSUPPORTED ? TVI_OK : status;
}

/* A text is read between two runs, with its history and without it. */
static tvi_status save_and_load(run *r)
{
    tvi_status status = make_steps(r);
    if (status != TVI_OK) return status;
    char *text = text_of_state(r->integrator, r->x.t, r->x.x, r->x.p);
    const size_t size = strlen(text);
    status = tvi_state_from_text(r->integrator, text, size, &r->x.t, r->x.x, r->x.p);
    if (status == TVI_OK) status = make_steps(r);
    memcpy(history_hash_in(text), "0123456789abcdef", 16);
    sign_text(text);
    if (status == TVI_OK) status = tvi_state_from_text(r->integrator, text, size, &r->x.t, r->x.x, r->x.p);
    free(text);
    return status == TVI_OK ? make_steps(r) : status;
}

static const struct {
    const char *name;
    way_fn *run;
    int least_degree; /* Lower degrees would need too many steps. */
} ways[] = {{"steps", make_steps, LEAST},
            {"events", make_steps_with_events, LEAST},
            {"to a time", run_to_time, LEAST},
            {"to a tolerance", run_to_tolerance, 8},
            {"saved", save_and_load, LEAST}};
enum { WAYS = sizeof ways / sizeof *ways };

/* ------------------------------------------------------------------------------------------------------------------ */

static run run_in(int mode, int way, const setting *s, const tvi_system *system, const tvi_options *options)
{
    run r = {.h = s->motion->h, .x = start_of(s)};
    tvi_event *event = NULL;
    ck_assert_int_eq(tvi_event_create(&event, s->n, TVI_EITHER, false, first_coordinate, NULL), TVI_OK);
    r.event = event;
    fesetround(mode);
    r.x.status = tvi_integrator_create(&r.integrator, system, options);
    if (r.x.status == TVI_OK) r.x.status = ways[way].run(&r);
    fesetround(FE_TONEAREST);
    tvi_integrator_free(r.integrator);
    tvi_event_free(event);
    return r;
}

START_TEST(all_rounding_modes)
{
    const motion *m = &motions[_i % MOTIONS];
    const int way = _i / MOTIONS;
    static const int degrees[] = {LEAST, 3, 8}, composed[] = {LEAST};
    setting s = {m, &as_it_is, m->n, m->most};
    complaints c = complaints_of("%s, %s", m->name, ways[way].name);
    method_list list = {0};
    tvi_system *system = system_of(&s);
    add_methods(system, 3, degrees, false, &list);
    add_methods(system, 1, composed, true, &list);
    for (int i = 0; i < list.count; i++) {
        if (list.options[i].degree < ways[way].least_degree) continue;
        const run wanted = run_in(FE_TONEAREST, way, &s, system, &list.options[i]);
        if (wanted.x.status != TVI_OK) complain(&c, "%s is refused\n", describe(&list.options[i]));
        for (int k = 0; k < ROUNDINGS; k++) {
            const run r = run_in(roundings[k].mode, way, &s, system, &list.options[i]);
            const double error = fmax(distance(&s, &r.x, &wanted.x), fabs(r.sum - wanted.sum));
            if (r.x.status != wanted.x.status || !(error <= 1e-12))
                complain(&c, "%s, %s: %s, %.1e\n", describe(&list.options[i]), roundings[k].name,
                         tvi_status_string(r.x.status), error);
        }
    }
    tvi_system_free(system);
    expect_none(&c);
}
END_TEST

Suite *suite_rounding(void)
{
    Suite *suite = suite_create("rounding");
    TCase *tcase = tcase_create("rounding");
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, all_rounding_modes, 0, MOTIONS * WAYS);
    suite_add_tcase(suite, tcase);
    return suite;
}
