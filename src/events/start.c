/* start.c - Determines the sign of each event function g at the start of a step, also where the step begins exactly on
 * the event. search.c calls it.
 *
 * If a run goes on from the end of the integrator's last step, g at the start is its value at the end of that step. If
 * a run goes on from a state where an event has stopped an earlier run, that event has g = 0 there, whatever value
 * roundoff gives to g. Any other state lies on an event if |g| is at most its roundoff. If a step begins on an event, g
 * first leaves 0 with the sign of its first Taylor coefficient along the motion that is larger than roundoff. That
 * coefficient has the sign of g(x + d) - g(x), where x is the state at the start of the step, and d the increment of a
 * tiny step of the method. */
#include "events/search.h"
#include "events/dip.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* [eps] A state after a step, or on the curve, is a sum. Its roundoff is this many units of its components. */
#define EVENT_STATE_ROUNDOFF_UNITS 4.0 /* found: make check-events */
/* [h] If g is 0 at the start of a step, the sign of g just after the start is found at growing theta, first at this
 * one. */
#define EVENT_FIRST_THETA 0x1p-200 /* found: make check-events */
/* [h] The first such theta in a rescaled system. */
#define EVENT_FIRST_RESCALED_THETA 0x1p-60 /* found: make check-events */
/* [h] The least theta at which a g that left 0 is checked to be off 0. */
#define EVENT_RETURN_MIN_THETA 0x1p-52 /* found: make check-events */
/* [1] An unsure sign of g is taken again at this many times theta. */
#define EVENT_RETURN_THETA_GROWTH 16.0 /* found: make check-events */

static bool are_bitwise_equal(int n, const double a[], const double b[])
{
    return memcmp(a, b, (size_t)n * sizeof *a) == 0;
}

tvi_start_state_source tvi_find_start_state_source(const tvi_integrator *it, double t, const double q[],
                                                   const double p[])
{
    const int n = it->system->n;
    const double *stop = it->stop->state;
    if (*it->is_state_from_step && tvi_integrator_state_equals(it, t, q, p)) return TVI_FROM_LAST_STEP;
    const bool is_stop = it->stop->is_set && are_bitwise_equal(n, q, stop) && are_bitwise_equal(1, &t, &stop[2 * n]);
    return is_stop ? TVI_FROM_STOP : TVI_FROM_ANY;
}

static void copy_step_start_state(const tvi_event_search *search, double state[])
{
    const tvi_integrator *it = search->integrator;
    const size_t n = (size_t)it->system->n;
    memcpy(state, it->start.q, n * sizeof *state);
    memcpy(state + n, it->start.p, n * sizeof *state);
    state[2 * n] = it->start.q[n];
}

bool tvi_stop_has_event(const tvi_event_stop *stop, const tvi_event *event)
{
    for (int64_t i = 0; i < stop->event_count; i++)
        if (stop->event_hashes[i] == event->hash) return true;
    return false;
}

/* Computes g at the q and t of the given state with the momentum p of the last stop. */
static tvi_status evaluate_event_with_stop_p(tvi_event_search *search, int event_index, const double state[], double *g)
{
    const size_t n = (size_t)search->integrator->system->n;
    memcpy(search->scratch_increment, state, (2 * n + 1) * sizeof *state);
    memcpy(search->scratch_increment + n, search->integrator->stop->state + n, n * sizeof *state);
    return tvi_search_evaluate_event(search, event_index, search->scratch_increment, g);
}

/* Sets g_samples[0] = 0 if the state at the start of the run lies on the event: the event was reported at the stop from
 * which the run goes on, or |g| is at most its roundoff. */
static tvi_status zero_start_g_within_roundoff(tvi_event_search *search, int event_index, const double state[])
{
    tvi_watched_event *w = &search->watched_events[event_index];
    double before = 0, here = 0, roundoff;
    tvi_status status;
    w->was_reported_at_stop =
        search->start_state_source == TVI_FROM_STOP && tvi_stop_has_event(search->integrator->stop, w->event);
    if (w->was_reported_at_stop) w->g_samples[0] = 0;
    if (w->g_samples[0] == 0 || search->start_state_source == TVI_FROM_LAST_STEP) return TVI_OK;
    /* If only p was changed at the stop and g is unchanged, the state does not lie on the event, since the event was
     * not reported at the stop. */
    if (search->start_state_source == TVI_FROM_STOP && search->integrator->stop->event_count < TVI_STOP_EVENTS) {
        status = evaluate_event_with_stop_p(search, event_index, state, &before);
        if (status == TVI_OK) status = tvi_search_evaluate_event(search, event_index, state, &here);
        if (status == TVI_OK && before == here) return TVI_OK;
    }
    for (int i = 0; i < 2 * search->integrator->system->n + 1; i++) search->scratch_increment[i] = fabs(state[i]);
    status = tvi_event_estimate_roundoff(w->event, &w->local_series, state, search->scratch_increment, &roundoff);
    if (status == TVI_OK && fabs(w->g_samples[0]) <= roundoff) w->g_samples[0] = 0;
    return status;
}

tvi_status tvi_evaluate_events_at_start(tvi_event_search *search)
{
    const int inputs = 2 * search->integrator->system->n + 1;
    const double *g = search->joint_tape_block;
    double *state = search->scratch_state;
    copy_step_start_state(search, state);
    search->is_momentum_changed_at_stop =
        search->start_state_source == TVI_FROM_STOP &&
        !are_bitwise_equal(inputs / 2, state + inputs / 2, search->integrator->stop->state + inputs / 2);
    for (int i = 0; i < inputs; i++)
        for (int k = 0; k < TVI_SAMPLES; k++) search->joint_tape_block[i * TVI_SAMPLES + k] = state[i];
    const bool inside = jet_sweep_values(search->joint_tape, search->joint_tape_block, TVI_SAMPLES);
    for (int event_index = 0; event_index < search->event_count; event_index++) {
        double *first = &search->watched_events[event_index].g_samples[0];
        *first = g[(size_t)search->joint_tape->output_slot[event_index] * TVI_SAMPLES];
        tvi_status status = TVI_OK;
        if (!inside || !isfinite(*first)) status = tvi_search_evaluate_event(search, event_index, state, first);
        if (status == TVI_OK) status = zero_start_g_within_roundoff(search, event_index, state);
        if (status != TVI_OK) return status;
    }
    return TVI_OK;
}

/* ---- Leaving an event -------------------------------------------------------------------------------------------- */

/* Computes the increment [2n + 1] of q, p and t from the start of the step to theta, not as a difference of two states
 * but to roundoff of the increment itself. */
static tvi_status compute_increment_to_theta(tvi_event_search *search, double theta, double increment[])
{
    const int n = search->integrator->system->n;
    const tvi_increments *increments = &search->partial_step->partial_step_integrator->increments;
    const tvi_run_state *start = &search->integrator->start, *state = &search->integrator->state;
    const tvi_status status = tvi_partial_step_compute_state(search->partial_step, theta * search->integrator->h);
    if (status != TVI_OK) return status;
    if (theta == 1) { /* The increment of the full step is the difference of its states. */
        for (int i = 0; i < n; i++) {
            increment[i] = state->q[i] - start->q[i];
            increment[n + i] = state->p[i] - start->p[i];
        }
        increment[2 * n] = state->q[n] - start->q[n];
        return TVI_OK;
    }
    for (int i = 0; i < n; i++) {
        increment[i] = increments->dq[i] + increments->dq_low[i];
        increment[n + i] = increments->dp[i] + increments->dp_low[i];
    }
    increment[2 * n] = increments->dq[n];
    return TVI_OK;
}

tvi_status tvi_compute_g_change_from_start(tvi_event_search *search, int event_index, double theta, double *g_change,
                                           bool *is_sign_certain)
{
    const tvi_watched_event *w = &search->watched_events[event_index];
    double scale;
    bool is_exact;
    tvi_status status = compute_increment_to_theta(search, theta, search->scratch_increment);
    copy_step_start_state(search, search->scratch_state);
    if (status == TVI_OK)
        status = tvi_event_compute_change(w->event, &w->local_series, search->scratch_state, search->scratch_increment,
                                          g_change, &scale, &is_exact);
    if (status != TVI_OK) return status;
    *is_sign_certain = fabs(*g_change) > EVENT_ROUNDOFF_UNITS * DBL_EPSILON * scale;
    if (is_exact) return TVI_OK;
    tvi_partial_step_copy_state(search->partial_step, search->scratch_state);
    return tvi_search_evaluate_event(search, event_index, search->scratch_state, g_change);
}

/* Finds the sign of g(theta) - g(0) in a step that begins on the event. *sign = 0 means that the change is below its
 * roundoff. */
static tvi_status find_sign_of_g_change(tvi_event_search *search, int event_index, double theta, int *sign)
{
    double g_change = 0;
    bool is_sign_certain = false;
    const tvi_status status = tvi_compute_g_change_from_start(search, event_index, theta, &g_change, &is_sign_certain);
    *sign = is_sign_certain ? tvi_sign(g_change) : 0;
    return status;
}

/* Returns the theta at which the time has changed by one unit of its roundoff since the start of the step, or
 * EVENT_RETURN_MIN_THETA if that theta does not lie between EVENT_RETURN_MIN_THETA and the first sample.
 * search->scratch_increment must hold the increments of q, p and t from the start of the step to increment_theta. */
static double first_theta_that_moves_time(const tvi_event_search *search, double increment_theta)
{
    const int n = search->integrator->system->n;
    const double resolution =
        DBL_EPSILON * fmax(fabs(search->integrator->start.q[n]), fabs(search->integrator->state.q[n]));
    const double theta = resolution * increment_theta / fabs(search->scratch_increment[2 * n]);
    return theta > EVENT_RETURN_MIN_THETA && theta < tvi_sample_theta[0] ? theta : EVENT_RETURN_MIN_THETA;
}

tvi_status tvi_find_sign_leaving_zero(tvi_event_search *search, int event_index)
{
    tvi_watched_event *w = &search->watched_events[event_index];
    int first, sign;
    const double at_first = tvi_is_rescaled(search->integrator) ? EVENT_FIRST_RESCALED_THETA : EVENT_FIRST_THETA;
    tvi_status status = find_sign_of_g_change(search, event_index, at_first, &first);
    if (status != TVI_OK) return status;
    double theta = first_theta_that_moves_time(search, at_first);
    status = find_sign_of_g_change(search, event_index, theta, &sign);
    search->repeats_stop_at_same_time = status == TVI_OK && w->was_reported_at_stop &&
                                        search->is_momentum_changed_at_stop && first * sign < 0 &&
                                        tvi_event_reports_sign_change(w->event, sign);
    if (search->repeats_stop_at_same_time)
        return jet_refuse(TVI_ENOCONV, "events[%d] is reached again before the time moves, as of a ball at rest",
                          event_index);
    while (status == TVI_OK && sign == 0 && theta * EVENT_RETURN_THETA_GROWTH < tvi_sample_theta[0])
        status = find_sign_of_g_change(search, event_index, theta *= EVENT_RETURN_THETA_GROWTH, &sign);
    w->is_zero_at_step_start = sign != 0;
    w->theta_after_leaving_zero = theta;
    w->g_samples[0] = sign != 0 ? copysign(DBL_MIN, sign) : w->g_samples[1];
    return status;
}

/* ---- Roundoff ---------------------------------------------------------------------------------------------------- */

tvi_status tvi_search_is_g_roundoff(tvi_event_search *search, int event_index, bool *is_roundoff)
{
    const tvi_watched_event *w = &search->watched_events[event_index];
    const tvi_integrator *it = search->integrator;
    const size_t n = (size_t)it->system->n;
    double at_start = 0, at_end = 0, *size = search->scratch_increment;
    for (size_t i = 0; i < n; i++) {
        size[i] = fabs(it->start.q[i]) + fabs(it->state.q[i] - it->start.q[i]);
        size[n + i] = fabs(it->start.p[i]) + fabs(it->state.p[i] - it->start.p[i]);
    }
    size[2 * n] = fmax(fabs(it->start.q[n]), fabs(it->state.q[n]));
    copy_step_start_state(search, search->scratch_state);
    tvi_status status = tvi_event_estimate_roundoff(w->event, &w->local_series, search->scratch_state, size, &at_start);
    tvi_integrator_copy_state(it, &search->scratch_state[2 * n], search->scratch_state, search->scratch_state + n);
    if (status == TVI_OK)
        status = tvi_event_estimate_roundoff(w->event, &w->local_series, search->scratch_state, size, &at_end);
    *is_roundoff =
        tvi_largest_magnitude(TVI_SAMPLES, w->g_samples + 1, 1) <= EVENT_STATE_ROUNDOFF_UNITS * (at_start + at_end);
    return status;
}
