/* between.c - the state inside a step, and results at given times. */
#include "run/between.h"
#include "algebra/sizes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Parts of a step that differ by less have nearly the same nodes. */
static const double NEAR = 1e-3;

tvi_status tvi_between_open(tvi_between *between, const tvi_integrator *steps, bool knows_step)
{
    const size_t n = (size_t)steps->system->n;
    *between = (tvi_between){.steps = steps, .knows_step = knows_step, .q = calloc(2 * n, sizeof(double))};
    if (!between->q) return TVI_ENOMEM;
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
    const size_t state = between->knows_step ? steps->of_state : steps->remembered;
    const bool is_near = between->step == steps->stats.steps && between->part != steps->h && between->part != 0 &&
                         fabs(part - between->part) < NEAR * fabs(steps->h);
    tvi_arena_copy(between->partial->history, steps->before, state);
    if (!is_near) tvi_arena_copy(between->partial->history + state, steps->history + state, steps->remembered - state);
}

tvi_status tvi_between_state(tvi_between *between, double part)
{
    const tvi_integrator *steps = between->steps;
    const size_t bytes = (size_t)steps->system->n * sizeof *between->q;
    const bool is_end = part == steps->h;
    if (between->step == steps->stats.steps && between->part == part) return TVI_OK;
    between->t = is_end ? steps->last->t : steps->t_start;
    memcpy(between->q, is_end ? steps->q : steps->q_start, bytes);
    memcpy(between->p, is_end ? steps->p : steps->p_start, bytes);
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

/* Finite, in the order of h, and none before t. */
static bool are_in_order(double h, double t, const double times[], int count)
{
    for (int i = 0; i < count; i++) {
        const double before = i > 0 ? times[i - 1] : t;
        if (!isfinite(times[i]) || (h > 0 ? times[i] < before : times[i] > before)) return false;
    }
    return true;
}

/* The observer is called at the times from the next on that are not after the last step. */
static tvi_status tell_times(tvi_between *between, const double times[], int count, int *next, tvi_observer *observer,
                             void *ctx)
{
    const tvi_integrator *steps = between->steps;
    const double h = steps->h, t = steps->last->t;
    for (; *next < count && (h > 0 ? times[*next] <= t : times[*next] >= t); ++*next) {
        const double part = (times[*next] - steps->t_start) - steps->t_start_low;
        const double inside = fmax(fmin(part, fmax(h, 0)), fmin(h, 0));
        const tvi_status status = tvi_between_state(between, times[*next] == t ? h : inside);
        if (status != TVI_OK) return status;
        if (observer && observer(*next + 1, times[*next], between->q, between->p, ctx) != 0) return TVI_ESTOPPED;
    }
    return TVI_OK;
}

tvi_status tvi_integrate_at(tvi_integrator *it, double h, const double times[], int count, double *t, double q[],
                            double p[], tvi_observer *observer, void *ctx)
{
    if (!it || !t || !q || !p || h == 0 || !isfinite(h) || count < 0 || (count > 0 && !times)) return TVI_EINVAL;
    if (!are_in_order(h, *t, times, count)) return TVI_EINVAL;
    if (!tvi_all_finite(it->system->n, q) || !tvi_all_finite(it->system->n, p)) return TVI_ENONFINITE;
    int next = 0;
    for (; next < count && times[next] == *t; next++)
        if (observer && observer(next + 1, *t, q, p, ctx) != 0) return TVI_ESTOPPED;
    if (next == count) return TVI_OK;
    tvi_between between;
    tvi_status status = tvi_between_open(&between, it, false);
    if (status != TVI_OK) return status;
    while (next < count && status == TVI_OK) {
        status = tvi_step(it, h, t, q, p);
        if (status == TVI_OK) status = tell_times(&between, times, count, &next, observer, ctx);
    }
    tvi_between_close(&between);
    return status;
}
