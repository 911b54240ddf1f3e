/* between.c - Computes states inside the last step, at a part of the step or at a given time. */
#include "run/between.h"
#include "run/narrow.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two parts of a step that differ by less than this part of h have nearly the same nodes. */
static const double NEAR = 1e-3;
enum { MOST_CORRECTIONS = 12 };

tvi_status tvi_between_open(tvi_between *between, tvi_integrator *steps, bool knows_step)
{
    const size_t n = (size_t)steps->system->n, wide = 2 * (n + 1) + 1;
    *between = (tvi_between){.integrator = steps, .knows_step = knows_step, .parameter_sets = steps->parameter_sets};
    between->q = calloc(2 * n + 2 * wide, sizeof *between->q);
    if (!between->q) return jet_refuse_memory(TVI_ENOMEM);
    between->p = between->q + n;
    between->x = between->p + n;
    between->rate = between->x + wide;
    tvi_status status = tvi_integrator_create_like(&between->partial_integrator, steps, 1);
    if (status == TVI_OK && tvi_is_rescaled(steps))
        status = tvi_rates_open(&between->rates, steps->system->stepped, steps->parameters);
    if (status != TVI_OK) tvi_between_close(between);
    return jet_refuse_memory(status);
}

void tvi_between_close(tvi_between *between)
{
    tvi_integrator_free(between->partial_integrator);
    tvi_rates_close(&between->rates);
    free(between->q);
    *between = (tvi_between){0};
}

tvi_status tvi_between_set_parameters(tvi_between *between)
{
    const tvi_integrator *steps = between->integrator;
    if (between->parameter_sets == steps->parameter_sets) return TVI_OK;
    between->parameter_sets = steps->parameter_sets;
    between->step = 0;
    if (between->rates.block) tvi_rates_set_parameters(&between->rates, steps->parameters);
    return tvi_integrator_set_parameters(between->partial_integrator, steps->parameters);
}

/* Sets the history that the partial integrator begins with: the low-order parts of the state at the start of the step,
 * and the stepper's history at that start. With `knows_step` the stepper's history is that at the end of the step, or
 * that of a partial step which ended near `part`. */
static void set_history(tvi_between *between, double part)
{
    const tvi_integrator *steps = between->integrator;
    const size_t state = between->knows_step ? steps->state_bytes : steps->marked_bytes;
    const bool is_near = between->knows_step && between->step == steps->stats.steps && between->part != steps->h &&
                         between->part != 0 && fabs(part - between->part) < NEAR * fabs(steps->h);
    tvi_arena_copy(between->partial_integrator->history, steps->history_before, state);
    if (!is_near)
        tvi_arena_copy(between->partial_integrator->history + state, steps->history + state,
                       steps->history_bytes - state);
}

tvi_status tvi_between_state(tvi_between *between, double part)
{
    const tvi_integrator *steps = between->integrator;
    const size_t bytes = (size_t)steps->system->n * sizeof *between->q;
    const bool is_end = part == steps->h;
    if (between->step == steps->stats.steps && between->part == part) return TVI_OK;
    const tvi_run_state *state = is_end ? &steps->state : &steps->start;
    between->t = state->q[steps->system->n];
    memcpy(between->q, state->q, bytes);
    memcpy(between->p, state->p, bytes);
    if (!is_end && part != 0) {
        set_history(between, part);
        between->step = 0;
        const tvi_status status = tvi_step(between->partial_integrator, part, &between->t, between->q, between->p);
        if (status != TVI_OK) return status;
    }
    between->step = steps->stats.steps;
    between->part = part;
    return TVI_OK;
}

void tvi_between_copy(const tvi_between *between, double x[])
{
    const size_t n = (size_t)between->integrator->system->n;
    memcpy(x, between->q, n * sizeof *x);
    memcpy(x + n, between->p, n * sizeof *x);
    x[2 * n] = between->t;
}

/* ---- Given times ------------------------------------------------------------------------------------------------- */

/* A time inside a step in s, measured from the start of the step. */
typedef struct {
    tvi_between *between;
    double time_from_start;
} wanted_time;

/* Sets *g to the time on the step's curve at theta, less the wanted time. */
static tvi_status beyond(void *ctx, double theta, double *g)
{
    const wanted_time *wanted = ctx;
    const tvi_integrator *steps = wanted->between->integrator;
    const tvi_increments *increments = &steps->increments;
    steps->stepper->dense(steps->work, theta, increments->dq, increments->dp);
    *g = increments->dq[steps->system->n] - wanted->time_from_start;
    return isfinite(*g) ? TVI_OK : jet_refuse(TVI_ENONFINITE, "the curve of the step overflows at theta = %g", theta);
}

/* Sets *rate to dt/ds at the end of the last partial step, which is g of the rescaled system. */
static tvi_status time_rate(tvi_between *between, double *rate)
{
    const tvi_integrator *partial = between->partial_integrator;
    const size_t n = (size_t)partial->stepped->n;
    memcpy(between->x, partial->state.q, n * sizeof *between->x);
    memcpy(between->x + n, partial->state.p, n * sizeof *between->x);
    between->x[2 * n] = partial->state.q[n];
    const tvi_status status = tvi_rates_at(&between->rates, between->x, between->rate);
    *rate = between->rate[partial->system->n];
    return status;
}

/* Corrects the place on the curve to that of the method's own solution by Newton's method, and keeps the state whose
 * time is nearest to the wanted one. The time that a part covers is an increment, which is more accurate than the
 * rounded time. */
static tvi_status correct(tvi_between *between, double time, double way, double part)
{
    const tvi_integrator *partial = between->partial_integrator;
    const double h = between->integrator->h;
    double rate, best = part, least = INFINITY;
    tvi_status status = TVI_OK;
    for (int count = 0; count < MOST_CORRECTIONS && part != 0 && part != h; count++) {
        status = tvi_between_state(between, part);
        if (status != TVI_OK) return status;
        const double rest = way - partial->covered;
        if (!(fabs(rest) < least)) break;
        best = part;
        least = fabs(rest);
        if (least <= DBL_EPSILON / 4 * fabs(time)) break;
        status = time_rate(between, &rate);
        if (status != TVI_OK) return status;
        part = fmax(fmin(part + rest / rate, fmax(h, 0)), fmin(h, 0));
    }
    return tvi_between_state(between, least < INFINITY ? best : part);
}

tvi_status tvi_between_time(tvi_between *between, double time)
{
    const tvi_integrator *steps = between->integrator;
    const int n = steps->system->n;
    const double h = steps->h, way = (time - steps->start.q[n]) - steps->start.q_low[n];
    const double part = fmax(fmin(way * (h / steps->covered), fmax(h, 0)), fmin(h, 0));
    tvi_bracket z = {0, -way, 1, steps->covered - way};
    if (time == steps->state.q[n]) return tvi_between_state(between, h);
    /* the independent variable of the steps is the time */
    if (!tvi_is_rescaled(steps)) return tvi_between_state(between, part);
    between->step = 0;
    const tvi_status status = tvi_narrow(&z, DBL_EPSILON / 2, beyond, &(wanted_time){between, way});
    return status == TVI_OK ? correct(between, time, way, (z.ga == 0 ? z.a : z.b) * h) : status;
}
