/* start.c - Determines the sign of each event function at the start of a step, for search.c.
 *
 * A run that goes on from the integrator's own state takes the value of g from the end of the step before. An event
 * that was reported where a run stopped counts as g = 0 there, whatever roundoff makes of g. Any other state is on an
 * event if |g| is at most its roundoff. A g that leaves 0 has the sign of its first Taylor coefficient along the motion
 * that is above roundoff. That is the sign of g(x + d) - g(x), with the increment d of a tiny step of the method, to
 * roundoff of d. */
#include "run/start.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A rise below UNITS units of roundoff of its terms has no sign. */
static const double UNITS = 64;
/* The roundoff of a state that steps computed, in units of its size. A state is a sum, and so is a point of the
 * curve. */
static const double OF_STEPS = 4;
/* Parts of the step: the first theta that is tried, and in s, where it has to move the time; the least theta at which
 * an event may return; and the factor from one theta to the next. */
static const double FIRST = 0x1p-200, FIRST_IN_S = 0x1p-60, LEAST = 0x1p-52, FARTHER = 16;

static int sign_of(double g) { return (g > 0) - (g < 0); }

static bool same_bits(int n, const double a[], const double b[]) { return memcmp(a, b, (size_t)n * sizeof *a) == 0; }

tvi_search_from tvi_start_of(const tvi_integrator *it, double t, const double q[], const double p[])
{
    const int n = it->system->n;
    const double *stop = it->stop->state;
    if (*it->continues && tvi_integrator_has_state(it, t, q, p)) return TVI_FROM_OWN;
    const bool is_stop = it->stop->is_set && same_bits(n, q, stop) && same_bits(1, &t, &stop[2 * n]);
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
        if (stop->events[i] == event->hash) return true;
    return false;
}

/* Computes g at the state x, with the momentum of the stop in place of its own. */
static tvi_status value_at_stop(tvi_search *s, int which, const double x[], double *g)
{
    const size_t n = (size_t)s->it->system->n;
    memcpy(s->move, x, (2 * n + 1) * sizeof *x);
    memcpy(s->move + n, s->it->stop->state + n, n * sizeof *x);
    return tvi_search_value(s, which, s->move, g);
}

/* Sets g[0] = 0 if the state x is on the event. */
static tvi_status judge(tvi_search *s, int which, const double x[])
{
    tvi_watch *w = &s->watch[which];
    double before = 0, here = 0, roundoff;
    tvi_status status;
    w->was_reported = s->start_kind == TVI_FROM_STOP && tvi_start_is_among(s->it->stop, w->event);
    if (w->was_reported) w->g[0] = 0;
    if (w->g[0] == 0 || s->start_kind == TVI_FROM_OWN) return TVI_OK;
    /* an event that does not depend on the new p stays as it is */
    if (s->start_kind == TVI_FROM_STOP && s->it->stop->count < TVI_STOP_EVENTS) {
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
    s->has_new_momentum =
        s->start_kind == TVI_FROM_STOP && !same_bits(inputs / 2, x + inputs / 2, s->it->stop->state + inputs / 2);
    for (int i = 0; i < inputs; i++)
        for (int k = 0; k < TVI_SAMPLES; k++) s->samples[i * TVI_SAMPLES + k] = x[i];
    const bool inside = jet_sweep_values(s->tape, s->samples, TVI_SAMPLES);
    for (int which = 0; which < s->count; which++) {
        double *first = &s->watch[which].g[0];
        *first = g[(size_t)s->tape->output[which] * TVI_SAMPLES];
        tvi_status status = TVI_OK;
        if (!inside || !isfinite(*first)) status = tvi_search_value(s, which, x, first);
        if (status == TVI_OK) status = judge(s, which, x);
        if (status != TVI_OK) return status;
    }
    return TVI_OK;
}

/* ---- Leaving an event -------------------------------------------------------------------------------------------- */

/* Sets d to the increments of q and p over the part theta of the step, as accurately as they are known, and that of the
 * time. */
static tvi_status movement(tvi_search *s, double theta, double d[])
{
    const int n = s->it->system->n;
    const tvi_increments *increments = &s->between->partial_integrator->increments;
    const tvi_run_state *start = &s->it->start, *state = &s->it->state;
    const tvi_status status = tvi_between_state(s->between, theta * s->it->h);
    if (status != TVI_OK) return status;
    if (theta == 1) { /* the step itself */
        for (int i = 0; i < n; i++) {
            d[i] = state->q[i] - start->q[i];
            d[n + i] = state->p[i] - start->p[i];
        }
        d[2 * n] = state->q[n] - start->q[n];
        return TVI_OK;
    }
    for (int i = 0; i < n; i++) {
        d[i] = increments->dq[i] + increments->dq_low[i];
        d[n + i] = increments->dp[i] + increments->dp_low[i];
    }
    d[2 * n] = increments->dq[n];
    return TVI_OK;
}

tvi_status tvi_start_rise(tvi_search *s, int which, double theta, double *rise, bool *known)
{
    const tvi_watch *w = &s->watch[which];
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

/* Sets *sign to the sign of the rise of g at theta; 0 if it is not known. */
static tvi_status sign_at(tvi_search *s, int which, double theta, int *sign)
{
    double rise = 0;
    bool known = false;
    const tvi_status status = tvi_start_rise(s, which, theta, &rise, &known);
    *sign = known ? sign_of(rise) : 0;
    return status;
}

/* The theta at which the time has moved by its resolution. search->move holds the increments at the first theta. */
static double first_resolved(const tvi_search *s, double first)
{
    const int n = s->it->system->n;
    const double resolution = DBL_EPSILON * fmax(fabs(s->it->start.q[n]), fabs(s->it->state.q[n]));
    const double theta = resolution * first / fabs(s->move[2 * n]);
    return theta > LEAST && theta < tvi_sample_theta[0] ? theta : LEAST;
}

tvi_status tvi_start_leave(tvi_search *s, int which)
{
    tvi_watch *w = &s->watch[which];
    int first, sign;
    const double at_first = tvi_is_rescaled(s->it) ? FIRST_IN_S : FIRST;
    tvi_status status = sign_at(s, which, at_first, &first);
    if (status != TVI_OK) return status;
    double theta = first_resolved(s, at_first);
    status = sign_at(s, which, theta, &sign);
    const bool is_wanted = w->event->direction == TVI_EITHER || (int)w->event->direction == sign;
    s->rests = status == TVI_OK && w->was_reported && s->has_new_momentum && is_wanted && first * sign < 0;
    if (s->rests)
        return jet_refuse(TVI_ENOCONV, "events[%d] is reached again before the time moves, as of a ball at rest",
                          which);
    while (status == TVI_OK && sign == 0 && theta * FARTHER < tvi_sample_theta[0])
        status = sign_at(s, which, theta *= FARTHER, &sign);
    w->leaves = sign != 0;
    w->left_at = theta;
    w->g[0] = sign != 0 ? copysign(DBL_MIN, sign) : w->g[1];
    return status;
}

/* ---- Roundoff ---------------------------------------------------------------------------------------------------- */

tvi_status tvi_start_is_noise(tvi_search *s, int which, bool *is_noise)
{
    const tvi_watch *w = &s->watch[which];
    const tvi_integrator *it = s->it;
    const size_t n = (size_t)it->system->n;
    double at_start = 0, at_end = 0, *size = s->move;
    for (size_t i = 0; i < n; i++) {
        size[i] = fabs(it->start.q[i]) + fabs(it->state.q[i] - it->start.q[i]);
        size[n + i] = fabs(it->start.p[i]) + fabs(it->state.p[i] - it->start.p[i]);
    }
    size[2 * n] = fmax(fabs(it->start.q[n]), fabs(it->state.q[n]));
    copy_start(s, s->state);
    tvi_status status = tvi_event_roundoff(w->event, &w->near, s->state, size, &at_start);
    tvi_integrator_copy_state(it, &s->state[2 * n], s->state, s->state + n);
    if (status == TVI_OK) status = tvi_event_roundoff(w->event, &w->near, s->state, size, &at_end);
    *is_noise = tvi_largest(TVI_SAMPLES, w->g + 1, 1) <= OF_STEPS * (at_start + at_end);
    return status;
}
