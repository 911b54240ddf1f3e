/* search.c - Searches the curve of a step for roots of the event functions (search.h). It evaluates all functions at
 * the sample points of the step (tvi_sample_theta), and looks for sign changes between samples, and for dips of |g|
 * (local minima), which may hide two roots. */
#include "events/search.h"
#include "events/dip.h"
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
/* [h] The secant method ends when theta changes by no more. */
#define EVENT_SECANT_MIN_CHANGE 1e-4 /* found: make check-events */
/* [secants] The secant method ends after this many. */
#define EVENT_MAX_SECANTS 6 /* found: make check-events */

static bool have_same_nonzero_sign(double a, double b) { return a > 0 ? b > 0 : a < 0 && b < 0; }

tvi_status tvi_search_compute_curve_state(tvi_event_search *search, double theta, double state[])
{
    const int n = search->integrator->system->n;
    return tvi_evaluate_dense_output(search->integrator, theta, &state[2 * n], state, state + n);
}

static tvi_status add_event_to_error_text(int event_index, tvi_status status)
{
    return status == TVI_OK ? status : jet_refuse(status, "events[%d]: %s", event_index, jet_last_refusal_text());
}

tvi_status tvi_search_evaluate_event(tvi_event_search *search, int event_index, const double state[], double *g)
{
    return add_event_to_error_text(event_index,
                                   tvi_event_evaluate(search->watched_events[event_index].event,
                                                      search->watched_events[event_index].tape_block, state, g));
}

static tvi_status evaluate_event_on_curve(tvi_event_search *search, int event_index, double theta, double *g)
{
    const tvi_status status = tvi_search_compute_curve_state(search, theta, search->scratch_state);
    return status == TVI_OK ? tvi_search_evaluate_event(search, event_index, search->scratch_state, g) : status;
}

/* Estimates a zero between `left` and `right` by the secant method, applied to the polynomial through all samples of g.
 * The polynomial has Newton's form, with divided differences. */
static double guess_root_by_interpolation(const double g_samples[], double left, double g_left, double right,
                                          double g_right)
{
    static const double part[] = {0, 1, 1. / 2, 1. / 3, 1. / 4, 1. / 5, 1. / 6, 1. / 7, 1. / 8};
    double c[TVI_SAMPLES + 1], now = g_left, before = g_right, at = left, last = right;
    memcpy(c, g_samples, sizeof c);
    for (int k = 1; k <= TVI_SAMPLES; k++)
        for (int i = TVI_SAMPLES; i >= k; i--) c[i] = (c[i] - c[i - 1]) * part[k];
    for (int k = 0; k < EVENT_MAX_SECANTS && now != before && fabs(at - last) > EVENT_SECANT_MIN_CHANGE; k++) {
        const double next = fmin(fmax(at - now * (at - last) / (now - before), left), right), x = TVI_SAMPLES * next;
        double p = c[TVI_SAMPLES];
        for (int i = TVI_SAMPLES; i-- > 0;) p = c[i] + (x - i) * p;
        last = at, before = now;
        at = next, now = p;
    }
    return at;
}

/* The context argument of the function that tvi_narrow_bracket calls: the event whose function it evaluates. */
typedef struct {
    tvi_event_search *search;
    int event_index;
} search_event_context;

static tvi_status evaluate_searched_event(void *ctx, double theta, double *g)
{
    const search_event_context *context = ctx;
    return evaluate_event_on_curve(context->search, context->event_index, theta, g);
}

tvi_status tvi_search_find_curve_root(tvi_event_search *search, const tvi_event_root *root, double *theta)
{
    tvi_sign_bracket bracket = {root->bracket.left, root->bracket.g_left, root->bracket.right, root->bracket.g_right};
    const tvi_status status = tvi_narrow_bracket(&bracket, DBL_EPSILON / 2, evaluate_searched_event,
                                                 &(search_event_context){search, root->event_index});
    *theta = bracket.g_left == 0 ? bracket.left : bracket.right;
    return status;
}

/* Adds a root between the samples `left` and `right` to the search, if the user has asked for this direction of the
 * sign change. g_sign_after is the sign of g after the root. Returns NULL if the direction was not asked for. */
static tvi_event_root *add_root(tvi_event_search *search, int event_index, int g_sign_after, tvi_event_sample left,
                                tvi_event_sample right)
{
    if (!tvi_event_reports_sign_change(search->watched_events[event_index].event, g_sign_after)) return NULL;
    tvi_event_root *added = &search->roots[search->root_count];
    *added = (tvi_event_root){.event_index = event_index,
                              .index_in_order_found = search->root_count,
                              .g_sign_after = g_sign_after,
                              .bracket = {left.theta, left.g, right.theta, right.g},
                              .is_return_to_zero =
                                  left.theta == 0 && search->watched_events[event_index].is_zero_at_step_start,
                              .theta_guess = NAN};
    search->root_count++;
    return added;
}

/* Evaluates g at the given distance from theta, a sample where g is 0. */
static tvi_status sample_event_at_distance(tvi_event_search *search, int event_index, double theta,
                                           double distance_from_theta, tvi_event_sample *sample)
{
    sample->theta = theta + distance_from_theta;
    return evaluate_event_on_curve(search, event_index, sample->theta, &sample->g);
}

/* Adds two roots, before and after the point `middle`, where g is 0 or has another sign than at `left` and `right`. If
 * g is 0 at `middle`, samples beside `middle` decide: if g has the other sign there, two roots are added; if g only
 * touches 0, one root. */
static tvi_status add_root_pair(tvi_event_search *search, int event_index, tvi_event_sample left,
                                tvi_event_sample middle, tvi_event_sample right)
{
    const int sign = tvi_sign(left.g);
    tvi_event_sample near = middle;
    tvi_status status = TVI_OK;
    if (middle.g == 0)
        status = sample_event_at_distance(search, event_index, middle.theta,
                                          -fmin(EVENT_EDGE, (middle.theta - left.theta) / 2), &near);
    if (middle.g == 0 && tvi_sign(near.g) != -sign && status == TVI_OK)
        status = sample_event_at_distance(search, event_index, middle.theta,
                                          fmin(EVENT_EDGE, (right.theta - middle.theta) / 2), &near);
    if (status != TVI_OK) return status;
    const bool crosses = tvi_sign(near.g) == -sign;
    (void)add_root(search, event_index, -sign, left, crosses ? near : middle);
    if (crosses) (void)add_root(search, event_index, sign, near, right);
    return TVI_OK;
}

/* Samples g near a dip of |g| until a sample has another sign, which shows two roots, or until there can be none. */
static tvi_status search_dip_for_roots(tvi_event_search *search, int event_index,
                                       const tvi_event_sample dip[TVI_DIP_SAMPLES])
{
    tvi_event_sample x[TVI_DIP_SAMPLES], new;
    memcpy(x, dip, sizeof x);
    for (int sample_count = 0; tvi_dip_needs_another_sample(x, sample_count, &new.theta); sample_count++) {
        const tvi_status status = evaluate_event_on_curve(search, event_index, new.theta, &new.g);
        if (status != TVI_OK) return status;
        if (tvi_sign(new.g) != tvi_sign(x[2].g)) return add_root_pair(search, event_index, dip[1], new, dip[3]);
        tvi_dip_insert_sample(x, new);
    }
    return TVI_OK;
}

/* Tells whether |g| has a local minimum at the sample g[0]. */
static bool is_local_minimum_of_abs_g(const double g[])
{
    return (fabs(g[0]) < fabs(g[-1])) & (fabs(g[0]) <= fabs(g[1]));
}

/* Tells whether |g| falls at the start of the step, or rises there with less than EVENT_FLAT_SLOPE times its mean slope
 * between the first two samples. abs_g_increase_to_next_sample is the increase of |g| between these samples. The slope
 * at the start is that of the polynomial through five samples. With stride = -1 the samples are read backwards from the
 * end of the step. */
static bool is_abs_g_falling_or_flat(const double g[], int stride, double abs_g_increase_to_next_sample)
{
    const double slope = -25 * g[0] + 48 * g[stride] - 36 * g[2 * stride] + 16 * g[3 * stride] - 3 * g[4 * stride];
    return (g[0] > 0 ? slope : -slope) <= 12 * EVENT_FLAT_SLOPE * abs_g_increase_to_next_sample;
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

/* Tells whether |g| may have a dip between the start of the step and the first sample, or with stride = -1 between the
 * last two samples. */
static bool may_have_dip_at_boundary(const double g[], int stride)
{
    const double abs_g_increase = fabs(g[stride]) - fabs(g[0]);
    /* Equal values of the last two samples are excluded, since is_local_minimum_of_abs_g then finds the dip at the
     * sample before the end. */
    const bool rises = stride > 0 ? abs_g_increase >= 0 : abs_g_increase > 0;
    return have_same_nonzero_sign(g[0], g[stride]) && rises &&
           (is_abs_g_falling_or_flat(g, stride, abs_g_increase) || has_kink_at_boundary(g, stride));
}

/* Tells whether g certainly has no root in the step: all samples are finite and have one sign, and |g| has no dip. Most
 * steps end here. */
static bool has_certainly_no_root(const double g[])
{
    bool may_have_root = false;
    for (int j = 1; j <= TVI_SAMPLES; j++)
        may_have_root |=
            !(g[j - 1] * g[j] > 0) | !(fabs(g[j]) <= DBL_MAX) | (j < TVI_SAMPLES && is_local_minimum_of_abs_g(g + j));
    return !(may_have_root || may_have_dip_at_boundary(g, 1) || may_have_dip_at_boundary(g + TVI_SAMPLES, -1));
}

/* Searches for a dip between an end of the step and the sample next to it. A dip lies inside the step only if |g| falls
 * from the end into the step, which a value of g very near the end shows. */
static tvi_status search_dip_at_boundary(tvi_event_search *search, int event_index, bool is_at_step_end)
{
    const double *g = search->watched_events[event_index].g_samples, part = 1.0 / TVI_SAMPLES;
    const tvi_event_sample nowhere = {NAN, NAN};
    tvi_event_sample x[TVI_DIP_SAMPLES] = {nowhere, {0, g[0]}, {EVENT_EDGE, 0}, {part, g[1]}, {2 * part, g[2]}};
    const tvi_event_sample last[TVI_DIP_SAMPLES] = {
        {1 - 2 * part, g[6]}, {1 - part, g[7]}, {1 - EVENT_EDGE, 0}, {1, g[8]}, nowhere};
    if (is_at_step_end) memcpy(x, last, sizeof x);
    const tvi_status status = evaluate_event_on_curve(search, event_index, x[2].theta, &x[2].g);
    if (status != TVI_OK) return status;
    if (tvi_sign(x[2].g) != tvi_sign(x[1].g)) return add_root_pair(search, event_index, x[1], x[2], x[3]);
    if (fabs(x[2].g) < fabs(x[is_at_step_end ? 3 : 1].g)) return search_dip_for_roots(search, event_index, x);
    return TVI_OK;
}

/* Adds the roots that the signs of two neighbouring samples show, and a root at `right` itself. If g is 0 at a sample,
 * its sign beside the sample is used, since another root may be hidden there. */
static tvi_status search_between_samples(tvi_event_search *search, int event_index, tvi_event_sample left,
                                         tvi_event_sample right, bool may_interpolate)
{
    const tvi_event_sample at_right = right;
    tvi_status status = TVI_OK;
    if (left.g == 0) status = sample_event_at_distance(search, event_index, left.theta, EVENT_EDGE, &left);
    if (status == TVI_OK && right.g == 0)
        status = sample_event_at_distance(search, event_index, right.theta, -EVENT_EDGE, &right);
    if (status != TVI_OK) return status;
    if (left.g != 0 && right.g != 0 && tvi_sign(left.g) != tvi_sign(right.g)) {
        tvi_event_root *root = add_root(search, event_index, tvi_sign(right.g), left, right);
        if (root && may_interpolate && !root->is_return_to_zero)
            root->theta_guess =
                guess_root_by_interpolation(search->watched_events[event_index].g_samples, root->bracket.left,
                                            root->bracket.g_left, root->bracket.right, root->bracket.g_right);
    }
    const tvi_event_sample before = right.g != 0 ? right : left;
    if (at_right.g == 0 && before.g != 0) (void)add_root(search, event_index, -tvi_sign(before.g), before, at_right);
    return TVI_OK;
}

/* Drops the roots of an event, from number first_root on, if the g of the event is only roundoff over the whole
 * step. This is tested if g changes from sample to sample by as much as its own size. */
static tvi_status drop_roots_if_g_is_roundoff(tvi_event_search *search, int event_index, int first_root)
{
    const double *g = search->watched_events[event_index].g_samples;
    bool is_roundoff = false;
    if (2 * largest_sample_change(g) < tvi_largest_magnitude(TVI_SAMPLES, g + 1, 1)) return TVI_OK;
    const tvi_status status = tvi_search_is_g_roundoff(search, event_index, &is_roundoff);
    if (is_roundoff) search->root_count = first_root;
    return status;
}

/* Adds all roots of one event in the step to the search. */
static tvi_status search_event_for_roots(tvi_event_search *search, int event_index)
{
    const double *g = search->watched_events[event_index].g_samples;
    const int before = search->root_count;
    if (has_certainly_no_root(g)) return TVI_OK;
    if (!tvi_all_finite(TVI_SAMPLES, g + 1))
        return add_event_to_error_text(event_index, tvi_refuse_failed_evaluation("event function", TVI_ENONFINITE));
    /* x[-1] and x[TVI_SAMPLES + 1], beyond the ends of the step, are missing samples. */
    tvi_event_sample all[1 + TVI_SAMPLES + 2] = {{NAN, NAN}, {0, g[0]}}, *const x = all + 1;
    for (int j = 1; j <= TVI_SAMPLES; j++) x[j] = (tvi_event_sample){tvi_sample_theta[j - 1], g[j]};
    x[TVI_SAMPLES + 1] = all[0];
    const bool may_return =
        !search->watched_events[event_index].is_zero_at_step_start && may_have_dip_at_boundary(g, 1);
    tvi_status status = may_return ? search_dip_at_boundary(search, event_index, false) : TVI_OK;
    for (int j = 1; j <= TVI_SAMPLES && status == TVI_OK; j++) {
        if (!have_same_nonzero_sign(g[j - 1], g[j]))
            status = search_between_samples(search, event_index, x[j - 1], x[j], g[j - 1] != 0 && g[j] != 0);
        else if (j < TVI_SAMPLES && have_same_nonzero_sign(g[j], g[j + 1]) && is_local_minimum_of_abs_g(g + j))
            status = search_dip_for_roots(search, event_index, x + j - 2);
    }
    if (status == TVI_OK && may_have_dip_at_boundary(g + TVI_SAMPLES, -1))
        status = search_dip_at_boundary(search, event_index, true);
    return status == TVI_OK && search->root_count > before ? drop_roots_if_g_is_roundoff(search, event_index, before)
                                                           : status;
}

/* Finds the event whose function is undefined at a sample, after the joint tape has failed, and sets the error text
 * accordingly. */
static tvi_status refuse_failing_event(tvi_event_search *search)
{
    double g;
    for (int event_index = 0; event_index < search->event_count; event_index++)
        for (int j = 0; j < TVI_SAMPLES; j++)
            if (evaluate_event_on_curve(search, event_index, tvi_sample_theta[j], &g) == TVI_EDOMAIN)
                return TVI_EDOMAIN;
    return tvi_refuse_failed_evaluation("event function", TVI_EDOMAIN);
}

/* Evaluates the functions of all events at the sample points of the last step. If the step before was searched, too,
 * the values at its end are the values at the start of this one. */
static tvi_status sample_all_events(tvi_event_search *search)
{
    const long step = search->integrator->stats.steps;
    const bool continues = search->last_searched_step_number > 0 && *search->integrator->was_state_from_step &&
                           step == search->last_searched_step_number + 1;
    for (int event_index = 0; event_index < search->event_count; event_index++)
        search->watched_events[event_index].g_samples[0] = search->watched_events[event_index].g_samples[TVI_SAMPLES];
    tvi_status status = continues ? TVI_OK : tvi_evaluate_events_at_start(search);
    if (status != TVI_OK) return status;
    tvi_sample_dense_output(search->integrator, search->used_components, search->joint_tape_block);
    if (!jet_sweep_values(search->joint_tape, search->joint_tape_block, TVI_SAMPLES))
        status = refuse_failing_event(search);
    for (int event_index = 0; event_index < search->event_count && status == TVI_OK; event_index++) {
        tvi_watched_event *w = &search->watched_events[event_index];
        memcpy(w->g_samples + 1,
               search->joint_tape_block + (size_t)search->joint_tape->output_slot[event_index] * TVI_SAMPLES,
               TVI_SAMPLES * sizeof *w->g_samples);
        w->is_zero_at_step_start = false;
        if (w->g_samples[0] == 0) status = tvi_find_sign_leaving_zero(search, event_index);
        w->was_reported_at_stop = false;
    }
    search->start_state_source =
        TVI_FROM_ANY; /* The next step may start from any state, since an observer may change it. */
    search->last_searched_step_number = step;
    return status;
}

tvi_status tvi_search_last_step_for_roots(tvi_event_search *search)
{
    tvi_status status = sample_all_events(search);
    search->root_count = 0;
    for (int event_index = 0; event_index < search->event_count && status == TVI_OK; event_index++)
        status = search_event_for_roots(search, event_index);
    return status;
}
