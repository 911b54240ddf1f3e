/* start.c - the sign that g has where a step begins.
 *
 * A run that goes on from the integrator's own state takes the sign that g has there, by the same evaluation that ended
 * the step before. What was told where an event stopped the run is left: g is 0 there, whatever roundoff makes of it.
 * Any other state is on an event where |g| is at most its roundoff. What leaves an event has the sign of the first
 * Taylor coefficient of g along the motion that is above its own roundoff: that of g(x + d) - g(x), where d is what a
 * tiny step of the method adds to the state, to roundoff of d. */
#include "run/start.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A rise below so many units of roundoff of its terms has no sign. */
static const double UNITS = 64;
/* The roundoff of a state that steps computed, in units of that of its size: it is a sum, and so is the curve. */
static const double OF_STEPS = 4;
/* In parts of the step: the first place that is looked at, which in s is one where the time moves; the least one where
 * an event may come back; and how much farther off the following ones are. */
static const double FIRST = 0x1p-200, FIRST_IN_S = 0x1p-60, LEAST = 0x1p-52, FARTHER = 16;

static int sign_of(double g) { return (g > 0) - (g < 0); }

static bool has_bits(int n, const double a[], const double b[]) { return memcmp(a, b, (size_t)n * sizeof *a) == 0; }

tvi_search_from tvi_start_of(const tvi_integrator *it, double t, const double q[], const double p[])
{
    const int n = it->system->n;
    const double *stop = it->stop->state;
    if (*it->continues && tvi_integrator_has(it, t, q, p)) return TVI_FROM_OWN;
    const bool is_stop = it->stop->is_set && has_bits(n, q, stop) && has_bits(1, &t, &stop[2 * n]);
    return is_stop ? TVI_FROM_STOP : TVI_FROM_ANY;
}

static void copy_start(const tvi_search *s, double x[])
{
    const tvi_integrator *it = s->it;
    const size_t n = (size_t)it->system->n;
    memcpy(x, it->start.q, n * sizeof *x);
    memcpy(x + n, it->start.p, n * sizeof *x);
    x[2 * n] = it->start.q[n];
}

bool tvi_start_is_among(const tvi_stop *stop, const tvi_event *event)
{
    for (int64_t i = 0; i < stop->count; i++)
        if (stop->told[i] == event->hash) return true;
    return false;
}

/* At the stop with its own p; x: the start. */
static tvi_status value_at_stop(tvi_search *s, int which, const double x[], double *g)
{
    const size_t n = (size_t)s->it->system->n;
    memcpy(s->move, x, (2 * n + 1) * sizeof *x);
    memcpy(s->move + n, s->it->stop->state + n, n * sizeof *x);
    return tvi_search_value(s, which, s->move, g);
}

/* g[0] = 0 where the state x is on the event. */
static tvi_status judge(tvi_search *s, int which, const double x[])
{
    tvi_watch *w = &s->of[which];
    double before = 0, here = 0, roundoff;
    tvi_status status;
    w->was_told = s->from == TVI_FROM_STOP && tvi_start_is_among(s->it->stop, w->event);
    if (w->was_told) w->g[0] = 0;
    if (w->g[0] == 0 || s->from == TVI_FROM_OWN) return TVI_OK;
    if (s->from == TVI_FROM_STOP && s->it->stop->count < TVI_STOP_TOLD) { /* and the new p changes nothing for it */
        status = value_at_stop(s, which, x, &before);
        if (status == TVI_OK) status = tvi_search_value(s, which, x, &here);
        if (status == TVI_OK && before == here) return TVI_OK;
    }
    for (int i = 0; i < 2 * s->it->system->n + 1; i++) s->move[i] = fabs(x[i]);
    status = tvi_event_roundoff(w->event, &w->near, x, s->move, &roundoff);
    if (status == TVI_OK && fabs(w->g[0]) <= roundoff) w->g[0] = 0;
    return status;
}

tvi_status tvi_start_search(tvi_search *s)
{
    const int inputs = 2 * s->it->system->n + 1;
    const double *g = s->samples;
    double *x = s->state;
    copy_start(s, x);
    s->has_turned = s->from == TVI_FROM_STOP && !has_bits(inputs / 2, x + inputs / 2, s->it->stop->state + inputs / 2);
    for (int i = 0; i < inputs; i++)
        for (int k = 0; k < TVI_SAMPLES; k++) s->samples[i * TVI_SAMPLES + k] = x[i];
    const bool inside = jet_sweep_values(s->tape, s->samples, TVI_SAMPLES);
    for (int which = 0; which < s->count; which++) {
        double *first = &s->of[which].g[0];
        *first = g[(size_t)s->tape->output[which] * TVI_SAMPLES];
        tvi_status status = TVI_OK;
        if (!inside || !isfinite(*first)) status = tvi_search_value(s, which, x, first);
        if (status == TVI_OK) status = judge(s, which, x);
        if (status != TVI_OK) return status;
    }
    return TVI_OK;
}

/* ---- Leaving an event -------------------------------------------------------------------------------------------- */

/* The movement by a step of a part of h, as far as it is known, and that of the time. */
static tvi_status movement(tvi_search *s, double theta, double d[])
{
    const int n = s->it->system->n;
    const tvi_increments *by = &s->between->partial->by;
    const tvi_run_state *start = &s->it->start, *now = &s->it->now;
    const tvi_status status = tvi_between_state(s->between, theta * s->it->h);
    if (status != TVI_OK) return status;
    if (theta == 1) { /* the step itself */
        for (int i = 0; i < n; i++) {
            d[i] = now->q[i] - start->q[i];
            d[n + i] = now->p[i] - start->p[i];
        }
        d[2 * n] = now->q[n] - start->q[n];
        return TVI_OK;
    }
    for (int i = 0; i < n; i++) {
        d[i] = by->dq[i] + by->dq_low[i];
        d[n + i] = by->dp[i] + by->dp_low[i];
    }
    d[2 * n] = by->dq[n];
    return TVI_OK;
}

tvi_status tvi_start_rise(tvi_search *s, int which, double theta, double *rise, bool *known)
{
    const tvi_watch *w = &s->of[which];
    double scale;
    bool is_exact;
    tvi_status status = movement(s, theta, s->move);
    copy_start(s, s->state);
    if (status == TVI_OK) status = tvi_event_rise(w->event, &w->near, s->state, s->move, rise, &scale, &is_exact);
    if (status != TVI_OK) return status;
    *known = fabs(*rise) > UNITS * DBL_EPSILON * scale;
    if (is_exact) return TVI_OK;
    tvi_between_copy(s->between, s->state);
    return tvi_search_value(s, which, s->state, rise);
}

/* The sign there, 0 where it is not known. */
static tvi_status sign_at(tvi_search *s, int which, double theta, int *sign)
{
    double rise = 0;
    bool known = false;
    const tvi_status status = tvi_start_rise(s, which, theta, &rise, &known);
    *sign = known ? sign_of(rise) : 0;
    return status;
}

/* Where the time has moved by what it resolves; search->move: the movement at the first place. */
static double first_resolved(const tvi_search *s, double first)
{
    const int n = s->it->system->n;
    const double resolution = DBL_EPSILON * fmax(fabs(s->it->start.q[n]), fabs(s->it->now.q[n]));
    const double theta = resolution * first / fabs(s->move[2 * n]);
    return theta > LEAST && theta < tvi_sample_place[0] ? theta : LEAST;
}

tvi_status tvi_start_leave(tvi_search *s, int which)
{
    tvi_watch *w = &s->of[which];
    int first, sign;
    const double at_first = tvi_is_rescaled(s->it) ? FIRST_IN_S : FIRST;
    tvi_status status = sign_at(s, which, at_first, &first);
    if (status != TVI_OK) return status;
    double theta = first_resolved(s, at_first);
    status = sign_at(s, which, theta, &sign);
    const bool is_wanted = w->event->direction == TVI_EITHER || (int)w->event->direction == sign;
    s->rests = status == TVI_OK && w->was_told && s->has_turned && is_wanted && first * sign < 0;
    if (s->rests)
        return jet_refuse(TVI_ENOCONV, "events[%d] is reached again before the time moves, as of a ball at rest",
                          which);
    while (status == TVI_OK && sign == 0 && theta * FARTHER < tvi_sample_place[0])
        status = sign_at(s, which, theta *= FARTHER, &sign);
    w->leaves = sign != 0;
    w->left_at = theta;
    w->g[0] = sign != 0 ? copysign(DBL_MIN, sign) : w->g[1];
    return status;
}

/* ---- Roundoff ---------------------------------------------------------------------------------------------------- */

tvi_status tvi_start_is_noise(tvi_search *s, int which, bool *is_noise)
{
    const tvi_watch *w = &s->of[which];
    const tvi_integrator *it = s->it;
    const size_t n = (size_t)it->system->n;
    double at_start = 0, at_end = 0, *size = s->move;
    for (size_t i = 0; i < n; i++) {
        size[i] = fabs(it->start.q[i]) + fabs(it->now.q[i] - it->start.q[i]);
        size[n + i] = fabs(it->start.p[i]) + fabs(it->now.p[i] - it->start.p[i]);
    }
    size[2 * n] = fmax(fabs(it->start.q[n]), fabs(it->now.q[n]));
    copy_start(s, s->state);
    tvi_status status = tvi_event_roundoff(w->event, &w->near, s->state, size, &at_start);
    tvi_state_now(it, &s->state[2 * n], s->state, s->state + n);
    if (status == TVI_OK) status = tvi_event_roundoff(w->event, &w->near, s->state, size, &at_end);
    *is_noise = tvi_largest(TVI_SAMPLES, w->g + 1, 1) <= OF_STEPS * (at_start + at_end);
    return status;
}
