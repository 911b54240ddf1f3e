/* search.c - Finds the roots of all event functions g(q, p, t) along the curve of the last step (tvi_dense). events.c
 * calls it after each step, and finish.c then computes each root to roundoff.
 *
 * All functions are evaluated at the samples of the step (tvi_sample_theta). A root lies between two samples of
 * different signs, and two roots may hide in a dip, that is a local minimum of |g|, between samples of one sign. The
 * sign of g at the start of the step is that at the end of the step before. Where a run begins, the start may lie on
 * the event: g then leaves 0 with the sign of its first Taylor coefficient along the motion that is above roundoff. */
#include "events/events.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* [h] Extra samples of g are this far from step ends and zeros of g. */
#define EVENT_EDGE 0x1p-20 /* found: make check-events */
/* [mean slope of |g|] Below this slope at a step end, a dip may be near. */
#define EVENT_FLAT_SLOPE 0.1 /* found: make check-events */
/* [1] g has a kink if a 4th or 8th difference of its samples is above this part of their largest first difference. */
#define EVENT_KINK 0.05 /* found: make check-events */
/* [eps] A change of g by fewer units of roundoff of its terms has no certain sign, and ends the search of a dip. */
#define EVENT_ROUNDOFF_UNITS 64.0 /* found: make check-events */
/* [eps] A state after a step, or on the curve, is a sum. Its roundoff is this many units of its components. */
#define EVENT_STATE_ROUNDOFF_UNITS 4.0 /* found: make check-events */
/* [h] If g is 0 at the start of a step, the sign of g just after the start is found at growing theta, first at this
 * one. */
#define EVENT_FIRST_THETA 0x1p-200 /* found: make check-events */
/* [h] The first such theta in a rescaled system, whose time must change by more than the roundoff 2^-106 of t and its
 * low-order part. */
static const double FIRST_RESCALED_THETA = 0x1p-60;

/* The search of a dip ends when its samples are so near that g differs by roundoff alone, as it does over the square
 * root of roundoff beside a minimum. */
static const double LEAST_DIP_WIDTH = 0x1p-26;
/* Secants end when their last change is the cube root of roundoff: the error of the next one is near its square, which
 * is less than the error of the polynomial. */
static const double LAST_SECANT_CHANGE = 6e-6;

static bool have_same_nonzero_sign(double a, double b) { return a > 0 ? b > 0 : a < 0 && b < 0; }

/* ---- Values of g ------------------------------------------------------------------------------------------------- */

tvi_status tvi_watched_evaluate(tvi_watched_event *w, const double state[], double *g)
{
    const tvi_status status = tvi_event_evaluate(w->event, w->tape_block, state, g);
    return status == TVI_OK ? status : jet_refuse(status, "events[%d]: %s", w->index, jet_last_refusal_text());
}

tvi_status tvi_watched_evaluate_on_curve(void *ctx, double theta, double *g)
{
    tvi_watched_event *w = ctx;
    tvi_event_search *search = w->search;
    const int n = search->integrator->system->n;
    double *x = search->scratch_state;
    const tvi_status status = tvi_evaluate_dense_output(search->integrator, theta, &x[2 * n], x, x + n);
    return status == TVI_OK ? tvi_watched_evaluate(w, x, g) : status;
}

/* Returns the values [TVI_SAMPLES] of an event in the joint tape. */
static const double *values_of_joint_tape(const tvi_watched_event *w)
{
    return w->search->joint_tape_block + (size_t)w->search->joint_tape->output_slot[w->index] * TVI_SAMPLES;
}

/* Tells whether |g| stays below its roundoff over the whole step. The size of a component is that at the start and its
 * change. */
static tvi_status is_g_roundoff(tvi_watched_event *w, bool *is_roundoff)
{
    const tvi_event_search *search = w->search;
    const tvi_run_state *ends[] = {&search->integrator->last_step.start, &search->integrator->state};
    const int n = search->integrator->system->n, time = 2 * n;
    double roundoff[2] = {0}, *state = search->scratch_state, *size = search->scratch_sizes;
    tvi_status status = TVI_OK;
    tvi_run_state_to_vector(ends[0], n, state);
    tvi_run_state_to_vector(ends[1], n, size);
    for (int i = 0; i < time; i++) size[i] = fabs(state[i]) + fabs(size[i] - state[i]);
    size[time] = fmax(fabs(state[time]), fabs(size[time]));
    for (int end = 0; end < 2 && status == TVI_OK; end++) {
        tvi_run_state_to_vector(ends[end], n, state);
        status = tvi_event_estimate_roundoff(w->event, &w->local_series, state, size, &roundoff[end]);
    }
    *is_roundoff = tvi_largest_magnitude(TVI_SAMPLES, w->g_samples + 1, 1) <=
                   EVENT_STATE_ROUNDOFF_UNITS * (roundoff[0] + roundoff[1]);
    return status;
}

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

/* Sets g_samples[0] = 0 if `state`, where the run begins, lies on the event: the event was reported at the stop from
 * which the run goes on, or |g| is at most its roundoff. */
static tvi_status zero_start_g_within_roundoff(tvi_watched_event *w, const double state[])
{
    const tvi_event_search *search = w->search;
    const tvi_event_stop *stop = search->integrator->stop;
    const bool is_at_stop = search->start_state_source == TVI_FROM_STOP;
    double at_stop = 0, here = 0;
    bool is_zero;
    w->was_reported_at_stop = is_at_stop && tvi_stop_has_event(stop, w->event);
    if (w->was_reported_at_stop) w->g_samples[0] = 0;
    if (w->g_samples[0] == 0 || search->start_state_source == TVI_FROM_LAST_STEP) return TVI_OK;
    /* If only p was changed at the stop and g is unchanged, the state does not lie on the event, since the event was
     * not reported at the stop. */
    if (is_at_stop && stop->event_count < TVI_STOP_EVENTS) {
        const bool has_values =
            tvi_watched_evaluate(w, stop->state, &at_stop) == TVI_OK && tvi_watched_evaluate(w, state, &here) == TVI_OK;
        if (has_values && at_stop == here) return TVI_OK;
    }
    const tvi_status status = tvi_watched_is_zero(w, w->g_samples[0], state, &is_zero);
    if (is_zero) w->g_samples[0] = 0;
    return status;
}

/* Sets g_samples[0] of all events at the start of the step: to 0 if it lies on the event up to roundoff. The joint tape
 * is evaluated as for samples, so that the values are those of the end of the step before, bit for bit. */
static tvi_status evaluate_events_at_start(tvi_event_search *search)
{
    double *state = search->scratch_state;
    tvi_status status = TVI_OK;
    tvi_run_state_to_vector(&search->integrator->last_step.start, search->integrator->system->n, state);
    for (int i = 0; i < search->state_size; i++)
        for (int k = 0; k < TVI_SAMPLES; k++) search->joint_tape_block[i * TVI_SAMPLES + k] = state[i];
    const bool inside = jet_sweep_values(search->joint_tape, search->joint_tape_block, TVI_SAMPLES);
    for (int event_index = 0; event_index < search->event_count && status == TVI_OK; event_index++) {
        tvi_watched_event *w = &search->watched_events[event_index];
        w->g_samples[0] = *values_of_joint_tape(w);
        if (!inside || !isfinite(w->g_samples[0])) status = tvi_watched_evaluate(w, state, &w->g_samples[0]);
        if (status == TVI_OK) status = zero_start_g_within_roundoff(w, state);
    }
    return status;
}

tvi_status tvi_watched_evaluate_change(void *ctx, double theta, double *g_per_theta)
{
    tvi_watched_event *w = ctx;
    tvi_event_search *search = w->search;
    const tvi_increments *increments = &search->partial_step.partial_step_integrator->last_step.increments;
    const int n = search->integrator->system->n;
    double scale, *state = search->scratch_state, *change = search->scratch_sizes;
    bool is_exact;
    tvi_status status = tvi_partial_step_compute_state(&search->partial_step, theta * search->integrator->last_step.h);
    if (status != TVI_OK) return status;
    /* The change of the state is the sum of increments, so that it has their roundoff, not that of the states. */
    for (int i = 0; i < n; i++) {
        change[i] = increments->dq[i] + increments->dq_low[i];
        change[n + i] = increments->dp[i] + increments->dp_low[i];
    }
    change[2 * n] = increments->dq[n];
    tvi_run_state_to_vector(&search->integrator->last_step.start, n, state);
    status = tvi_event_compute_change(w->event, &w->local_series, state, change, g_per_theta, &scale, &is_exact);
    w->change_sign = fabs(*g_per_theta) > EVENT_ROUNDOFF_UNITS * DBL_EPSILON * scale ? tvi_sign(*g_per_theta) : 0;
    if (status == TVI_OK && !is_exact) {
        memcpy(state, search->partial_step.state, (size_t)search->state_size * sizeof *state);
        status = tvi_watched_evaluate(w, state, g_per_theta);
    }
    *g_per_theta /= theta;
    return status;
}

/* Sets g_samples[0] of an event on which the step begins (g = 0) to a tiny number with the sign that g has just
 * after the start of the step. This is the sign where the time has changed by one unit of its roundoff, or at a
 * larger theta if it is not certain there; 12 times 16 theta reach the first sample. If g had the other sign before,
 * a stop is repeated. */
static tvi_status find_sign_leaving_zero(tvi_watched_event *w)
{
    tvi_event_search *search = w->search;
    const tvi_integrator *it = search->integrator;
    const int n = it->system->n;
    const double tiny = tvi_is_rescaled(it) ? FIRST_RESCALED_THETA : EVENT_FIRST_THETA;
    double change;
    tvi_status status = tvi_watched_evaluate_change(w, tiny, &change);
    const int first = w->change_sign;
    if (status != TVI_OK) return status;
    const double dt_dtheta = search->partial_step.partial_step_integrator->last_step.increments.dq[n] / tiny;
    double theta = DBL_EPSILON * fmax(fabs(it->last_step.start.q[n]), fabs(it->state.q[n])) / fabs(dt_dtheta);
    if (!(theta > DBL_EPSILON && theta < tvi_sample_theta[0])) theta = DBL_EPSILON;
    status = tvi_watched_evaluate_change(w, theta, &change);
    const bool is_momentum_changed =
        memcmp(it->last_step.start.p, it->stop->state + n, (size_t)n * sizeof *it->last_step.start.p) != 0;
    search->repeats_stop = status == TVI_OK && w->was_reported_at_stop && is_momentum_changed &&
                           first * w->change_sign < 0 && tvi_event_reports_sign_change(w->event, w->change_sign);
    if (search->repeats_stop)
        return jet_refuse(TVI_ENOCONV, "events[%d] is reached again before the time moves, as of a ball at rest",
                          w->index);
    for (; status == TVI_OK && w->change_sign == 0 && 16 * theta < tvi_sample_theta[0]; theta *= 16)
        status = tvi_watched_evaluate_change(w, 16 * theta, &change);
    w->is_zero_at_step_start = w->change_sign != 0;
    w->theta_after_leaving_zero = theta;
    w->g_samples[0] = w->change_sign != 0 ? copysign(DBL_MIN, w->change_sign) : w->g_samples[1];
    return status;
}

/* ---- Dips -------------------------------------------------------------------------------------------------------- */

/* Returns the theta of the minimum of the parabola through the three middle samples. If the minimum lies outside of
 * these samples, or if wants_golden_section is set, the function returns the theta that divides the larger of their two
 * intervals in the golden ratio. */
static double next_sample_theta(const tvi_event_sample dip[TVI_DIP_SAMPLES], bool wants_golden_section)
{
    const double golden = 0.3819660112501051;
    const double left = dip[2].theta - dip[1].theta, right = dip[3].theta - dip[2].theta,
                 larger = right > left ? right : -left;
    const double rise = (dip[3].g - dip[2].g) / right, fall = (dip[2].g - dip[1].g) / left;
    const double bend = (rise - fall) / (left + right), way = -(fall + bend * left) / (2 * bend);
    return dip[2].theta + (!wants_golden_section && way != 0 && way > -left && way < right ? way : golden * larger);
}

static double chord_slope(tvi_event_sample a, tvi_event_sample b) { return (b.g - a.g) / (b.theta - a.theta); }

/* Tells whether g certainly has no zero between dip[1] and dip[3]. If g is convex where it is positive (concave where
 * it is negative), it lies above the straight lines through dip[2] and its neighbours, beyond them, and these lines may
 * already exclude a zero. The same holds if g has a kink. */
static bool has_certainly_no_zero(const tvi_event_sample dip[TVI_DIP_SAMPLES])
{
    const double sign = dip[2].g > 0 ? 1 : -1;
    const double first = sign * chord_slope(dip[0], dip[1]), fall = sign * chord_slope(dip[1], dip[2]);
    const double rise = sign * chord_slope(dip[2], dip[3]), last = sign * chord_slope(dip[3], dip[4]);
    const double least =
        fabs(dip[2].g) - fmax(rise * (dip[2].theta - dip[1].theta), -fall * (dip[3].theta - dip[2].theta));
    /* All comparisons are false if a sample is missing, since its g is NAN. */
    return first <= fall && rise <= last && least > 0;
}

/* Each third sample is that of a golden section, which cuts a fifth off the width: the search ends. */
bool tvi_dip_needs_another_sample(const tvi_event_sample dip[TVI_DIP_SAMPLES], int sample_count, double *theta)
{
    const double change = fmax(fabs(dip[1].g), fabs(dip[3].g)) - fabs(dip[2].g);
    if (dip[3].theta - dip[1].theta <= LEAST_DIP_WIDTH || has_certainly_no_zero(dip) ||
        change <= EVENT_ROUNDOFF_UNITS * DBL_EPSILON * fabs(dip[2].g))
        return false;
    *theta = next_sample_theta(dip, sample_count % 3 == 2);
    return true;
}

void tvi_dip_insert_sample(tvi_event_sample dip[TVI_DIP_SAMPLES], tvi_event_sample sample)
{
    const bool is_right = sample.theta > dip[2].theta, is_less = fabs(sample.g) < fabs(dip[2].g);
    const int outer = is_right == is_less ? 0 : 4, next = is_right == is_less ? 1 : 3;
    dip[outer] = dip[next];
    dip[next] = is_less ? dip[2] : sample;
    if (is_less) dip[2] = sample;
}

/* ---- Roots ------------------------------------------------------------------------------------------------------- */

/* Adds a root between the samples `left` and `right` to the search, if the user has asked for this direction of the
 * sign change. g_sign_after is the sign of g after the root. Returns NULL if the direction was not asked for. */
static tvi_event_root *add_root(tvi_watched_event *w, int g_sign_after, tvi_event_sample left, tvi_event_sample right)
{
    if (!tvi_event_reports_sign_change(w->event, g_sign_after)) return NULL;
    tvi_event_root *added = &w->search->roots[w->search->root_count++];
    *added = (tvi_event_root){.watched = w, .g_sign_after = g_sign_after, .theta_guess = NAN, .slope_guess = NAN};
    added->bracket = (tvi_sign_bracket){left.theta, left.g, right.theta, right.g};
    return added;
}

/* Sets the guesses of a root by the secant method, applied to the polynomial through all samples of g. The polynomial
 * has Newton's form, with divided differences. */
static void guess_root_by_interpolation(const double g_samples[], tvi_event_root *root)
{
    const double left = root->bracket.left, right = root->bracket.right;
    double c[TVI_SAMPLES + 1], now = root->bracket.g_left, before = root->bracket.g_right, at = left, last = right;
    memcpy(c, g_samples, sizeof c);
    for (int k = 1; k <= TVI_SAMPLES; k++)
        for (int i = TVI_SAMPLES; i >= k; i--) c[i] = (c[i] - c[i - 1]) / k;
    for (int k = 0; k < TVI_SAMPLES && now != before && fabs(at - last) > LAST_SECANT_CHANGE; k++) {
        const double next = tvi_clamp(left, at - now * (at - last) / (now - before), right), x = TVI_SAMPLES * next;
        double p = c[TVI_SAMPLES];
        for (int i = TVI_SAMPLES; i-- > 0;) p = c[i] + (x - i) * p;
        last = at, before = now;
        at = next, now = p;
    }
    root->theta_guess = at;
    root->slope_guess = (now - before) / (at - last);
}

/* Adds two roots, before and after the point `middle`, where g is 0 or has another sign than at `left` and `right`. If
 * g is 0 at `middle`, samples beside `middle` decide: if g has the other sign there, two roots are added; if g only
 * touches 0, one root. */
static tvi_status add_root_pair(tvi_watched_event *w, tvi_event_sample left, tvi_event_sample middle,
                                tvi_event_sample right)
{
    const int sign = tvi_sign(left.g);
    const double gap[] = {middle.theta - left.theta, right.theta - middle.theta};
    tvi_event_sample near = middle;
    for (int side = 0; side < 2 && middle.g == 0 && tvi_sign(near.g) != -sign; side++) {
        near.theta = middle.theta + (side == 0 ? -1 : 1) * fmin(EVENT_EDGE, gap[side] / 2);
        const tvi_status status = tvi_watched_evaluate_on_curve(w, near.theta, &near.g);
        if (status != TVI_OK) return status;
    }
    const bool crosses = tvi_sign(near.g) == -sign;
    (void)add_root(w, -sign, left, crosses ? near : middle);
    if (crosses) (void)add_root(w, sign, near, right);
    return TVI_OK;
}

/* Samples g near a dip of |g| until a sample has another sign, which shows two roots, or until there can be none. */
static tvi_status search_dip(tvi_watched_event *w, const tvi_event_sample dip[TVI_DIP_SAMPLES])
{
    tvi_event_sample x[TVI_DIP_SAMPLES], new;
    memcpy(x, dip, sizeof x);
    for (int sample_count = 0; tvi_dip_needs_another_sample(x, sample_count, &new.theta); sample_count++) {
        const tvi_status status = tvi_watched_evaluate_on_curve(w, new.theta, &new.g);
        if (status != TVI_OK) return status;
        if (tvi_sign(new.g) != tvi_sign(x[2].g)) return add_root_pair(w, dip[1], new, dip[3]);
        tvi_dip_insert_sample(x, new);
    }
    return TVI_OK;
}

/* Returns the largest |g[j + 1] - g[j]| of neighbouring samples. */
static double largest_sample_change(const double g[])
{
    double change = 0;
    for (int j = 0; j < TVI_SAMPLES; j++) change = tvi_larger(fabs(g[j + 1] - g[j]), change);
    return change;
}

/* Tells whether |g| may have a kink or a peak near the start of the step, or with stride = -1 near its end. Its
 * fourth or eighth difference is large in this case, and the polynomial through the samples cannot show a sign
 * change there. */
static bool has_kink_at_boundary(const double g[], int stride)
{
    const double fourth = g[0] - 4 * g[stride] + 6 * g[2 * stride] - 4 * g[3 * stride] + g[4 * stride];
    const double *first = stride > 0 ? g : g - TVI_SAMPLES, noise = 256 * DBL_EPSILON * fabs(g[0]);
    const double eighth = (first[0] + first[8]) - 8 * (first[1] + first[7]) + 28 * (first[2] + first[6]) -
                          56 * (first[3] + first[5]) + 70 * first[4];
    const double size = tvi_larger(fabs(fourth), fabs(eighth));
    return (size > noise) & ((size >= EVENT_KINK * largest_sample_change(first)) | (size >= fabs(g[0])));
}

/* Tells whether |g| may have a dip between the start of the step and the first sample, or with stride = -1, which
 * reads the samples backwards, between the last two samples. |g| falls there from the end of the step, or rises with
 * less than EVENT_FLAT_SLOPE times its mean slope up to the next sample, or it may have a kink. The slope is that of
 * the polynomial through five samples. */
static bool may_have_dip_at_boundary(const double g[], int stride)
{
    const double abs_g_increase = fabs(g[stride]) - fabs(g[0]);
    /* Equal values of the last two samples are excluded, since there is a local minimum at the sample before the
     * end. */
    const bool rises = stride > 0 ? abs_g_increase >= 0 : abs_g_increase > 0;
    if (!have_same_nonzero_sign(g[0], g[stride]) || !rises) return false;
    const double slope = -25 * g[0] + 48 * g[stride] - 36 * g[2 * stride] + 16 * g[3 * stride] - 3 * g[4 * stride];
    return (g[0] > 0 ? slope : -slope) <= 12 * EVENT_FLAT_SLOPE * abs_g_increase || has_kink_at_boundary(g, stride);
}

/* Tells whether g certainly has no root in the step: all samples are finite and have one sign, and |g| has no dip. Most
 * steps end here. */
static bool has_certainly_no_root(const double g[])
{
    double before = fabs(g[0]), lowest_product = 1, sum = 0;
    bool has_minimum = false, is_falling = false;
    for (int j = 1; j <= TVI_SAMPLES; j++) {
        const double here = fabs(g[j]);
        has_minimum |= is_falling & (here >= before);
        is_falling = here < before;
        lowest_product = tvi_smaller(g[j - 1] * g[j], lowest_product);
        sum += here;
        before = here;
    }
    return lowest_product > 0 && sum <= DBL_MAX && !has_minimum && !may_have_dip_at_boundary(g, 1) &&
           !may_have_dip_at_boundary(g + TVI_SAMPLES, -1);
}

/* Searches for a dip between an end of the step and the sample next to it. A dip lies inside the step only if |g| falls
 * from the end into the step, which a value of g very near the end shows. x[0 .. TVI_SAMPLES] are the samples. */
static tvi_status search_dip_at_boundary(tvi_watched_event *w, const tvi_event_sample x[], bool is_at_step_end)
{
    const tvi_event_sample *near = is_at_step_end ? x + TVI_SAMPLES - 2 : x - 1;
    const tvi_event_sample edge = {is_at_step_end ? 1 - EVENT_EDGE : EVENT_EDGE, 0};
    tvi_event_sample dip[TVI_DIP_SAMPLES] = {near[0], near[1], edge, near[2], near[3]};
    const tvi_status status = tvi_watched_evaluate_on_curve(w, edge.theta, &dip[2].g);
    if (status != TVI_OK) return status;
    if (tvi_sign(dip[2].g) != tvi_sign(dip[1].g)) return add_root_pair(w, dip[1], dip[2], dip[3]);
    return fabs(dip[2].g) < fabs(dip[is_at_step_end ? 3 : 1].g) ? search_dip(w, dip) : TVI_OK;
}

/* Adds the roots that the signs of two neighbouring samples show, and a root at `right` itself. If g is 0 at a sample,
 * its sign beside the sample is used, since another root may be hidden there. */
static tvi_status search_between_samples(tvi_watched_event *w, tvi_event_sample left, tvi_event_sample right)
{
    const tvi_event_sample at_right = right;
    const bool may_interpolate = left.g != 0 && right.g != 0;
    tvi_status status = TVI_OK;
    if (left.g == 0) status = tvi_watched_evaluate_on_curve(w, left.theta += EVENT_EDGE, &left.g);
    if (status == TVI_OK && right.g == 0)
        status = tvi_watched_evaluate_on_curve(w, right.theta -= EVENT_EDGE, &right.g);
    if (status != TVI_OK) return status;
    if (left.g != 0 && right.g != 0 && tvi_sign(left.g) != tvi_sign(right.g)) {
        tvi_event_root *root = add_root(w, tvi_sign(right.g), left, right);
        if (root && may_interpolate) guess_root_by_interpolation(w->g_samples, root);
    }
    const tvi_event_sample before = right.g != 0 ? right : left;
    if (at_right.g == 0 && before.g != 0) (void)add_root(w, -tvi_sign(before.g), before, at_right);
    return TVI_OK;
}

/* Adds all roots to the search that the samples of one event show. */
static tvi_status search_samples(tvi_watched_event *w)
{
    const double *g = w->g_samples;
    /* x[-1] and x[TVI_SAMPLES + 1], beyond the ends of the step, are missing samples. */
    tvi_event_sample all[1 + TVI_SAMPLES + 2] = {{NAN, NAN}, {0, g[0]}}, *const x = all + 1;
    for (int j = 1; j <= TVI_SAMPLES; j++) x[j] = (tvi_event_sample){tvi_sample_theta[j - 1], g[j]};
    x[TVI_SAMPLES + 1] = all[0];
    tvi_status status =
        !w->is_zero_at_step_start && may_have_dip_at_boundary(g, 1) ? search_dip_at_boundary(w, x, false) : TVI_OK;
    for (int j = 1; j <= TVI_SAMPLES && status == TVI_OK; j++) {
        if (!have_same_nonzero_sign(g[j - 1], g[j])) status = search_between_samples(w, x[j - 1], x[j]);
        else if (j < TVI_SAMPLES && have_same_nonzero_sign(g[j], g[j + 1]) && fabs(g[j]) < fabs(g[j - 1]) &&
                 fabs(g[j]) <= fabs(g[j + 1]))
            status = search_dip(w, x + j - 2);
    }
    if (status == TVI_OK && may_have_dip_at_boundary(g + TVI_SAMPLES, -1)) status = search_dip_at_boundary(w, x, true);
    return status;
}

/* Refuses the step, since an event function is undefined or not finite at a sample: finds which one, for the error
 * text. */
static tvi_status refuse_samples(tvi_event_search *search, tvi_status expected)
{
    double g;
    for (int k = 0; k < search->event_count * TVI_SAMPLES; k++) {
        tvi_watched_event *w = &search->watched_events[k / TVI_SAMPLES];
        if (tvi_watched_evaluate_on_curve(w, tvi_sample_theta[k % TVI_SAMPLES], &g) == expected) return expected;
    }
    return tvi_refuse_failed_evaluation("event function", expected);
}

/* Adds all roots of one event in the step to the search, but none if its g is only roundoff over the whole step.
 * This is tested if g changes from sample to sample by as much as its own size. */
static tvi_status search_event(tvi_watched_event *w)
{
    tvi_event_search *search = w->search;
    const double *g = w->g_samples;
    const int before = search->root_count;
    bool is_roundoff = false;
    if (has_certainly_no_root(g)) return TVI_OK;
    if (!tvi_all_finite(TVI_SAMPLES, g + 1)) return refuse_samples(search, TVI_ENONFINITE);
    tvi_status status = search_samples(w);
    if (status == TVI_OK && search->root_count > before &&
        2 * largest_sample_change(g) >= tvi_largest_magnitude(TVI_SAMPLES, g + 1, 1))
        status = is_g_roundoff(w, &is_roundoff);
    if (is_roundoff) search->root_count = before;
    return status;
}

/* Evaluates the functions of all events at the samples of the last step, and searches these. If the step before was
 * searched, too, the values at its end are the values at the start of this one. */
tvi_status tvi_search_last_step(tvi_event_search *search)
{
    const long step = search->integrator->stats.steps;
    const bool continues = search->last_searched_step_number > 0 &&
                           *search->integrator->last_step.was_state_from_step &&
                           step == search->last_searched_step_number + 1;
    tvi_status status = continues ? TVI_OK : evaluate_events_at_start(search);
    search->root_count = 0;
    if (status != TVI_OK) return status;
    tvi_sample_dense_output(search->integrator, search->used_components, search->joint_tape_block);
    if (!jet_sweep_values(search->joint_tape, search->joint_tape_block, TVI_SAMPLES))
        status = refuse_samples(search, TVI_EDOMAIN);
    for (int event_index = 0; event_index < search->event_count && status == TVI_OK; event_index++) {
        tvi_watched_event *w = &search->watched_events[event_index];
        if (continues) w->g_samples[0] = w->g_samples[TVI_SAMPLES];
        memcpy(w->g_samples + 1, values_of_joint_tape(w), TVI_SAMPLES * sizeof *w->g_samples);
        w->is_zero_at_step_start = false;
        if (w->g_samples[0] == 0) status = find_sign_leaving_zero(w);
        w->was_reported_at_stop = false;
        if (status == TVI_OK) status = search_event(w);
    }
    search->start_state_source = TVI_FROM_ANY; /* An observer may change the state before the next step. */
    search->last_searched_step_number = step;
    return status;
}
