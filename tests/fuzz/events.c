/* events.c - Makes random events and results at random times. Whatever the system does, they must be told within
 * their step and in order, an event of the time is found at its time, one of a coordinate where the coordinate is,
 * and the steps are those without. */
#include "world.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* a is not after b on the way of h. */
static bool in_order(double h, double a, double b) { return h > 0 ? a <= b : a >= b; }

/* The same steps from the saved integrator. */
static void expect_same_steps(world *w, double h, const char *saved, size_t size, long steps, const state *before,
                              const char *what)
{
    if (steps == 0) return;
    state again = *before;
    insist(tvi_state_from_text(w->integrator, saved, size, &again.t, again.q, again.p) == TVI_OK, "load");
    const tvi_status status = tvi_integrate(w->integrator, h, steps, &again.t, again.q, again.p, NULL, NULL);
    insist(status == TVI_OK && memcmp(&again, &w->x, sizeof again) == 0, what);
}

/* ---- Events: of the time, of a coordinate, of all ---------------------------------------------------------------- */

enum { EVENTS = 3, OF_TIME = 0, OF_COORDINATE = 1, KINDS = 3 };

typedef struct {
    recorder f;
    int kind, coordinate;
    tvi_direction direction;
    double at; /* the time or the coordinate */
    tvi_event *event;
} wish;

/* The state of the run for its observers. */
typedef struct {
    const world *w;
    double h, told; /* the last time told in the step at hand */
    state from;     /* its start */
    wish wishes[EVENTS];
    long events, stop_at; /* the event that ends the run, 0 = none */
    int found[EVENTS];
} watch;

static jet event_function(const jet q[], const jet p[], jet t, void *ctx)
{
    const wish *x = ctx;
    if (x->kind == OF_TIME) return jet_sub(t, x->at);
    if (x->kind == OF_COORDINATE) return jet_sub(q[x->coordinate], x->at);
    return scalar_of(&x->f, q, p, t);
}

static void make_wish(bytes *b, const world *w, double h, wish *x)
{
    const int n = below(b, 32) ? w->n : integer(b, N_MAX);
    *x = (wish){.f = {b, n < N_MAX ? n : N_MAX}, .kind = below(b, KINDS)};
    x->coordinate = n > 0 ? below(b, x->f.n) : 0;
    x->at = x->kind == OF_TIME ? w->x.t + byte(b) / 64.0 * h : number(b);
    x->direction = (tvi_direction)(below(b, 16) ? below(b, 3) - 1 : integer(b, 3));
    const tvi_status status = tvi_event_create(&x->event, n, x->direction, below(b, 8) == 0, event_function, x);
    expect_status(status);
    insist((status == TVI_OK) == (x->event != NULL), "an event and its status");
}

/* The step is so small that its curve is close to the solution, and solved to roundoff. */
static bool is_resolved(const watch *x)
{
    const tvi_options *o = tvi_integrator_options(x->w->integrator);
    const double tail = tvi_integrator_stats(x->w->integrator)->tail;
    return tail > 0 && tail < 1e-3 && fabs(x->h) < 0.5 && o->tolerance == 0 && o->passes == 0;
}

/* How far from its time an event of it may be. In a rescaled system the time is solved for, as a coordinate is. */
static double error_of_time(const watch *x, double t)
{
    const double size = fmax(fmax(fabs(t), fabs(x->from.t)), fabs(x->h));
    if (!x->w->adapts) return 4 * DBL_EPSILON * size;
    return is_resolved(x) ? (4 * DBL_EPSILON + tvi_integrator_stats(x->w->integrator)->residual) * size : INFINITY;
}

static double size_of(const watch *x, const wish *of)
{
    double size = fabs(of->at);
    for (int i = 0; i < x->w->n; i++) size = fmax(size, fmax(fabs(x->from.q[i]), fabs(x->w->x.q[i])));
    return size;
}

static int on_event(int which, double t, const double q[], const double p[], void *ctx)
{
    watch *x = ctx;
    insist(which >= 0 && which < EVENTS, "which event");
    const wish *met = &x->wishes[which];
    insist(finite_all(x->w->n, q) && finite_all(x->w->n, p), "what an event observer sees");
    insist(in_order(x->h, x->told, t) && in_order(x->h, t, x->w->x.t), "an event within its step, in order");
    x->told = t;
    x->found[which]++;
    if (met->kind == OF_TIME) insist(fabs(t - met->at) <= error_of_time(x, t), "an event of the time");
    if (met->kind == OF_COORDINATE && is_resolved(x))
        insist(fabs(q[met->coordinate] - met->at) <= 1e-6 * size_of(x, met), "an event of a coordinate");
    return ++x->events == x->stop_at;
}

static int after_step(long step, double t, const double q[], const double p[], void *ctx)
{
    watch *x = ctx;
    (void)step;
    insist(finite_all(x->w->n, q) && finite_all(x->w->n, p) && t == x->w->x.t, "what an observer sees");
    x->from = x->w->x;
    x->told = t;
    return 0;
}

/* A run to its end has met an event of the time that is clearly inside of it, once. */
static void expect_time(const watch *x, int which, const state *before)
{
    const wish *asked = &x->wishes[which];
    const double start = before->t, end = x->w->x.t, h = x->h;
    const bool seen = asked->direction == TVI_EITHER || (asked->direction == TVI_RISING) == (h > 0);
    if (asked->kind != OF_TIME || !seen || fabs(h) < 1e-6 * fmax(fabs(start), fabs(end))) return;
    if ((asked->at - start) / h > 0.01 && (end - asked->at) / h > 0.01)
        insist(x->found[which] == 1, "an event of the time is met");
}

void integrate_events(bytes *b, world *w)
{
    watch x = {.w = w, .h = step_size(b), .from = w->x, .told = w->x.t, .stop_at = below(b, 8)};
    const int steps = below(b, 6) - 1, count = below(b, EVENTS + 1);
    const tvi_event *events[EVENTS];
    for (int i = 0; i < count; i++) make_wish(b, w, x.h, &x.wishes[i]), events[i] = x.wishes[i].event;
    const state before = w->x;
    size_t size;
    char *saved = saved_state(w, &size);
    const tvi_status status = tvi_integrate_events(w->integrator, x.h, steps, events, count, &w->x.t, w->x.q, w->x.p,
                                                   after_step, on_event, &x);
    expect_end(w, status, &before, "integrate with events");
    for (int i = 0; i < count && status == TVI_OK; i++) expect_time(&x, i, &before);
    if (status == TVI_OK) expect_same_steps(w, x.h, saved, size, steps, &before, "the steps of events");
    for (int i = 0; i < count; i++) tvi_event_free(x.wishes[i].event);
    free(saved);
}

/* ---- Times ------------------------------------------------------------------------------------------------------- */

enum { TIMES = 6 };

typedef struct {
    const world *w;
    double times[TIMES];
    int told, stop_at;
} list;

static int at_time(long number_of_time, double t, const double q[], const double p[], void *ctx)
{
    list *x = ctx;
    insist(number_of_time == x->told + 1 && t == x->times[x->told], "a time and its number");
    insist(isfinite(t) && finite_all(x->w->n, q) && finite_all(x->w->n, p), "what is seen at a time");
    return ++x->told == x->stop_at;
}

/* The time that a step of size h covers. In a rescaled system, whose time may stop after some steps, the times lie in a
 * part of what TIMES steps cover, so that few steps pass all times. */
static double time_of(const world *w, double h, const char *saved, size_t size)
{
    tvi_integrator *trial;
    state x = w->x;
    if (!w->adapts || !saved) return h;
    insist(tvi_integrator_create(&trial, w->system, tvi_integrator_options(w->integrator)) == TVI_OK, "a trial");
    tvi_status status = tvi_state_from_text(trial, saved, size, &x.t, x.q, x.p);
    if (status == TVI_OK) status = tvi_integrate(trial, h, TIMES, &x.t, x.q, x.p, NULL, NULL);
    expect_status(status);
    tvi_integrator_free(trial);
    return (x.t - w->x.t) / (4 * TIMES);
}

void integrate_at(bytes *b, world *w)
{
    list x = {.w = w, .stop_at = below(b, 16)};
    size_t size;
    char *saved = saved_state(w, &size);
    const double h = step_size(b), unit = time_of(w, h, saved, size);
    const int count = below(b, TIMES + 1);
    double place = 0;
    for (int i = 0; i < count; i++) {
        place += below(b, 64) ? byte(b) / 64.0 : -1; /* few steps, and once back, which is refused */
        x.times[i] = w->x.t + place * unit;
    }
    const state before = w->x;
    const long steps = tvi_integrator_stats(w->integrator)->steps;
    const tvi_status status = tvi_integrate_at(w->integrator, h, x.times, count, &w->x.t, w->x.q, w->x.p, at_time, &x);
    expect_end(w, status, &before, "integrate to times");
    const long made = tvi_integrator_stats(w->integrator)->steps - steps;
    if (status == TVI_OK)
        insist(x.told == count && (count == 0 || in_order(h, x.times[count - 1], w->x.t)), "all times");
    if (status == TVI_OK || status == TVI_ESTOPPED)
        expect_same_steps(w, h, saved, size, made, &before, "the steps to times");
    free(saved);
}
