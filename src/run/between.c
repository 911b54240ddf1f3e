/* between.c - the state inside a step, and results at given times. */
#include "run/between.h"
#include "run/run.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Parts of a step that differ by less have nearly the same nodes. */
static const double NEAR = 1e-3;
/* Half the distance of the points that give the slope of the time along a step. */
static const double CHORD = 1e-4;
enum { MOST_TRIALS = 60, MOST_CORRECTIONS = 6 };

tvi_status tvi_between_open(tvi_between *between, tvi_integrator *steps, bool knows_step)
{
    const size_t n = (size_t)steps->system->n;
    *between = (tvi_between){.steps = steps, .knows_step = knows_step, .q = calloc(2 * n, sizeof(double))};
    if (!between->q) return jet_refuse_memory(TVI_ENOMEM);
    between->p = between->q + n;
    const tvi_status status = tvi_integrator_twin(&between->partial, steps);
    if (status != TVI_OK) free(between->q);
    return status;
}

void tvi_between_close(tvi_between *between)
{
    tvi_integrator_free(between->partial);
    free(between->q);
}

/* What the partial integrator begins with: the low-order parts of the state at the start of the step, and what its
 * stepper knew there; or what it knows now, of the whole step or of a part of it that is near. */
static void set_history(tvi_between *between, double part)
{
    const tvi_integrator *steps = between->steps;
    const size_t state = between->knows_step ? steps->of_state : steps->marked;
    const bool is_near = between->knows_step && between->step == steps->stats.steps && between->part != steps->h &&
                         between->part != 0 && fabs(part - between->part) < NEAR * fabs(steps->h);
    tvi_arena_copy(between->partial->history, steps->before, state);
    if (!is_near) tvi_arena_copy(between->partial->history + state, steps->history + state, steps->remembered - state);
}

tvi_status tvi_between_state(tvi_between *between, double part)
{
    const tvi_integrator *steps = between->steps;
    const size_t bytes = (size_t)steps->system->n * sizeof *between->q;
    const bool is_end = part == steps->h;
    if (between->step == steps->stats.steps && between->part == part) return TVI_OK;
    const tvi_run_state *state = is_end ? &steps->now : &steps->start;
    between->t = state->q[steps->system->n];
    memcpy(between->q, state->q, bytes);
    memcpy(between->p, state->p, bytes);
    if (!is_end && part != 0) {
        set_history(between, part);
        between->step = 0;
        const tvi_status status = tvi_step(between->partial, part, &between->t, between->q, between->p);
        if (status != TVI_OK) return status;
    }
    between->step = steps->stats.steps;
    between->part = part;
    return TVI_OK;
}

/* ---- Given times ------------------------------------------------------------------------------------------------- */

/* The time along the step's curve. */
static tvi_status time_at(tvi_between *between, double theta, double *t)
{
    return tvi_state_at(between->steps, theta, t, between->q, between->p);
}

/* Whether a rest is roundoff of the time. */
static bool is_there(double rest, double time) { return fabs(rest) <= DBL_EPSILON * fabs(time); }

/* The theta at which the curve has the time, from a guess: the false position, and bisections where it is slow. */
static tvi_status find_on_curve(tvi_between *between, double time, double *theta)
{
    const tvi_integrator *steps = between->steps;
    const int n = steps->system->n;
    double a = 0, b = 1, rest_a = time - steps->start.q[n], rest_b = time - steps->now.q[n], t;
    for (int trial = 0; trial < MOST_TRIALS; trial++) {
        const tvi_status status = time_at(between, *theta, &t);
        const double rest = time - t;
        if (status != TVI_OK || is_there(rest, time)) return status;
        const bool is_before = (rest > 0) == (rest_a > 0);
        if (is_before) a = *theta, rest_a = rest;
        else b = *theta, rest_b = rest;
        if (b - a <= DBL_EPSILON) return TVI_OK;
        const double secant = a + (b - a) * (rest_a / (rest_a - rest_b));
        *theta = trial % 4 == 3 || !(secant > a && secant < b) ? (a + b) / 2 : secant;
    }
    return TVI_OK;
}

/* The time that a unit of h takes at theta. */
static tvi_status slope_at(tvi_between *between, double theta, double *slope)
{
    const double a = fmax(theta - CHORD, 0), b = fmin(theta + CHORD, 1);
    double from = 0, to = 0;
    tvi_status status = time_at(between, a, &from);
    if (status == TVI_OK) status = time_at(between, b, &to);
    *slope = (to - from) / ((b - a) * between->steps->h);
    return status;
}

/* From the place on the curve to that of the method's own solution. */
static tvi_status correct(tvi_between *between, double time, double theta, double part)
{
    const tvi_integrator *steps = between->steps, *partial = between->partial;
    const double h = steps->h;
    double slope, before = INFINITY;
    tvi_status status = tvi_between_state(between, part);
    for (int count = 0; count < MOST_CORRECTIONS && status == TVI_OK; count++) {
        const double rest = (time - between->t) - (part == 0 || part == h ? 0 : partial->now.q_low[steps->system->n]);
        if (is_there(rest, time) || !(fabs(rest) < before)) return TVI_OK;
        status = slope_at(between, theta, &slope);
        between->step = 0; /* the slope's states are not that of the part */
        before = fabs(rest);
        part = fmax(fmin(part + rest / slope, fmax(h, 0)), fmin(h, 0));
        if (status == TVI_OK) status = tvi_between_state(between, part);
    }
    return status;
}

tvi_status tvi_between_time(tvi_between *between, double time)
{
    const tvi_integrator *steps = between->steps;
    const int n = steps->system->n;
    const double h = steps->h, rest = (time - steps->start.q[n]) - steps->start.q_low[n];
    const double part = fmax(fmin(rest * (h / steps->covered), fmax(h, 0)), fmin(h, 0));
    double theta = part / h;
    if (time == steps->now.q[n]) return tvi_between_state(between, h);
    if (!tvi_is_rescaled(steps)) return tvi_between_state(between, part); /* they move in the time */
    between->step = 0;
    const tvi_status status = find_on_curve(between, time, &theta);
    return status == TVI_OK ? correct(between, time, theta, theta * h) : status;
}

/* The first that is not finite, or not in the order of h, or before t; count where there is none. */
static int first_out_of_order(double h, double t, const double times[], int count)
{
    for (int i = 0; i < count; i++) {
        const double before = i > 0 ? times[i - 1] : t;
        if (!isfinite(times[i]) || (h > 0 ? times[i] < before : times[i] > before)) return i;
    }
    return count;
}

/* The observer is called at the times from the next on that are not after the last step. */
static tvi_status tell_times(tvi_between *between, const double times[], int count, int *next, tvi_observer *observer,
                             void *ctx)
{
    const tvi_integrator *steps = between->steps;
    const double h = steps->h, t = steps->now.q[steps->system->n];
    for (; *next < count && (h > 0 ? times[*next] <= t : times[*next] >= t); ++*next) {
        const tvi_status status = tvi_between_time(between, times[*next]);
        if (status != TVI_OK) return status;
        if (observer && observer(*next + 1, times[*next], between->q, between->p, ctx) != 0) return TVI_ESTOPPED;
    }
    return TVI_OK;
}

tvi_status tvi_integrate_at(tvi_integrator *it, double h, const double times[], int count, double *t, double q[],
                            double p[], tvi_observer *observer, void *ctx)
{
    if (!it || !t || !q || !p || h == 0 || !isfinite(h) || count < 0 || (count > 0 && !times))
        return tvi_refuse_run((tvi_run_arguments){it, t, q, p, h}, count < 0 ? "count is negative" : "times is NULL");
    const int n = it->system->n, first = first_out_of_order(h, *t, times, count);
    if (first < count)
        return jet_refuse(TVI_EINVAL, "times[%d] = %g is not in order, or not finite", first, times[first]);
    if (!tvi_all_finite(n, q) || !tvi_all_finite(n, p)) return tvi_refuse_state(n, *t, q, "p", p);
    int next = 0, slow = 0;
    for (; next < count && times[next] == *t; next++)
        if (observer && observer(next + 1, *t, q, p, ctx) != 0) return TVI_ESTOPPED;
    if (next == count) return TVI_OK;
    tvi_between between;
    tvi_status status = tvi_between_open(&between, it, false);
    if (status != TVI_OK) return status;
    while (next < count && status == TVI_OK) {
        status = tvi_step(it, h, t, q, p);
        if (status == TVI_OK) status = tell_times(&between, times, count, &next, observer, ctx);
        if (status == TVI_OK && next < count) status = tvi_goes_on(it, times[count - 1], &slow);
    }
    tvi_between_close(&between);
    return status;
}
