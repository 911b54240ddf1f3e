/* events.c - Measures what it costs a run to look for events. Writes DIR/events.md.
 *
 *   events DIR */
#include "bodies.h"
#include "experiments/experiment.h"
#include "turns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EVENTS_MOST = 64, ROUNDS = 10 };
static const double FAR = 1000; /* where no orbit comes */

/* The events a run looks for: nothing, what never comes, events. */
typedef enum { WITHOUT, IN_VAIN, WITH, WAYS } way;

/* A run from its start, and events: those of the run, and the same functions shifted far off. */
typedef struct {
    const char *title;
    tvi_system *system;
    tvi_integrator *integrator;
    int n;
    const double *q, *p;
    double h;
    long steps, told; /* told: events of the last run */
    tvi_event *events[WAYS][EVENTS_MOST];
    int count;
} watched;

/* ---- Runs ----------------------------------------------------------------------------------------------------- */

static int count_event(int which, double t, const double q[], const double p[], void *ctx)
{
    (void)which, (void)t, (void)q, (void)p;
    ((watched *)ctx)->told++;
    return 0;
}

static void run_watched(watched *w, way looks)
{
    double t = 0, q[COORDINATES_MOST], p[COORDINATES_MOST];
    memcpy(q, w->q, (size_t)w->n * sizeof *q);
    memcpy(p, w->p, (size_t)w->n * sizeof *p);
    w->told = 0;
    tvi_integrator_reset(w->integrator);
    experiment_insist(tvi_integrate_events(w->integrator, w->h, w->steps, (const tvi_event *const *)w->events[looks],
                                           looks == WITHOUT ? 0 : w->count, &t, q, p, NULL, count_event, w),
                      "events");
}

static void run_without(void *ctx) { run_watched(ctx, WITHOUT); }
static void run_in_vain(void *ctx) { run_watched(ctx, IN_VAIN); }
static void run_with(void *ctx) { run_watched(ctx, WITH); }

static void measure(FILE *table, watched *w)
{
    double step[WAYS] = {INFINITY, INFINITY, INFINITY}; /* s */
    experiment_insist(tvi_integrator_create(&w->integrator, w->system, NULL), "events");
    for (int round = 0; round < ROUNDS; round++) {
        turn turns[WAYS] = {
            {.work = run_without, .ctx = w}, {.work = run_in_vain, .ctx = w}, {.work = run_with, .ctx = w}};
        turns_time(WAYS, turns);
        for (int i = 0; i < WAYS; i++) step[i] = fmin(step[i], turns[i].seconds / (double)w->steps);
    }
    run_in_vain(w);
    if (w->told) experiment_fail("events", "one that should never come");
    run_with(w);
    const double ratio = step[WITH] / step[WITHOUT], search = step[IN_VAIN] / step[WITHOUT] - 1;
    const double found = (step[WITH] - step[IN_VAIN]) / step[WITHOUT] * (double)w->steps / (double)w->told;
    fprintf(table, "| %s | %d | %ld | %ld | %.3g | %.3g | %.2f | %.2f | %.1f |\n", w->title, w->count, w->steps,
            w->told, 1e6 * step[WITHOUT], 1e6 * step[WITH], ratio, search, found);
    for (int i = 0; i < w->count; i++) tvi_event_free(w->events[WITH][i]), tvi_event_free(w->events[IN_VAIN][i]);
    tvi_integrator_free(w->integrator);
    tvi_system_free(w->system);
}

/* ---- Problems ------------------------------------------------------------------------------------------------- */

static void add_event(watched *w, tvi_direction direction, tvi_event_fn *g, void *ctx, void *far)
{
    experiment_insist(tvi_event_create(&w->events[WITH][w->count], w->n, direction, false, g, ctx), "events");
    experiment_insist(tvi_event_create(&w->events[IN_VAIN][w->count++], w->n, direction, false, g, far), "events");
}

/* q_0, whose rise through 0 is the section of Henon and Heiles, less a number. */
static jet section(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return jet_sub(q[0], *(const double *)ctx);
}

/* q.p, which rises through 0 at the pericentre, less a number. */
static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t;
    return jet_sub(jet_dot(q, p, 2), *(const double *)ctx);
}

static void measure_scene(FILE *table, const char *title, const scene *s, double h, long steps, tvi_event_fn *g)
{
    watched w = {.title = title, .n = s->n, .q = s->q, .p = s->p, .h = h, .steps = steps};
    w.system = experiment_system(s);
    add_event(&w, TVI_RISING, g, &(double){0}, &(double){FAR});
    measure(table, &w);
}

typedef struct {
    int i, j;
    double distance;
} pair;

/* The square of the distance of two bodies less that of a given distance. */
static jet apart(const jet q[], const jet p[], jet t, void *ctx)
{
    const pair *x = ctx;
    jet d[3];
    (void)p, (void)t;
    for (int k = 0; k < 3; k++) d[k] = jet_sub(q[3 * x->i + k], q[3 * x->j + k]);
    return jet_sub(jet_dot(d, d, 3), x->distance * x->distance);
}

/* Planets at most as far apart as the larger of their orbits: most pairs meet and part again. */
static void measure_pairs(FILE *table, const char *title, int bodies, double h, long steps)
{
    const big_system b = bodies_make(bodies, 3);
    watched w = {.title = title, .system = b.system, .n = b.n, .q = b.q, .p = b.p, .h = h, .steps = steps};
    for (int i = 1; i < bodies; i++)
        for (int j = 0; j < i; j++) {
            pair x = {i, j, hypot(b.q[3 * i], b.q[3 * i + 1])}, far = {i, j, FAR};
            add_event(&w, TVI_EITHER, apart, &x, &far);
        }
    measure(table, &w);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    FILE *table = experiment_table(&e, "events",
                                   "run, galerkin 16|events|steps|reported|without, us a step (time)|with, us a step "
                                   "(time)|ratio (time)|the search, steps a step (time)|an event "
                                   "found, steps (time)");
    measure_scene(table, "Henon-Heiles, H = 1/12, h = 1, section", &scene_henon_heiles_12, 1, 2000, section);
    measure_scene(table, "Henon-Heiles, H = 1/8, h = 1, section", &scene_henon_heiles_8, 1, 2000, section);
    measure_scene(table, "Kepler of the README, h = 0.25, pericentres", &scene_kepler, 0.25, 16000, radial);
    measure_pairs(table, "star and 8 planets, h = 0.5, distances of all pairs", 9, 0.5, 1000);
    experiment_close(table);
    return EXIT_SUCCESS;
}
