/* dip.c - Chooses where to sample a function g near a dip (a local minimum of |g|) to find a zero, by parabolas and
 * golden sections, and decides when there can be no zero (dip.h). */
#include "events/dip.h"

#include <float.h>
#include <math.h>

/* [h] The search of a dip ends when its three samples span no more. */
#define EVENT_DIP_MIN_WIDTH 1e-8 /* found: make check-events */
/* [samples] The search of a dip ends after this many. */
#define EVENT_DIP_MAX_SAMPLES 120 /* found: make check-events */

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

/* Returns a lower bound, on the interval between a and b, of a convex function with the given values at a and b and a
 * slope between least_slope and largest_slope. */
static double lower_bound_of_convex_function(tvi_event_sample a, double least_slope, tvi_event_sample b,
                                             double largest_slope)
{
    const double width = b.theta - a.theta;
    return a.g + least_slope / (least_slope - largest_slope) * (b.g - a.g - largest_slope * width);
}

/* Tells whether g certainly has no zero between dip[1] and dip[3]. If g is convex where it is positive (concave where
 * it is negative), it lies above the straight lines through neighbouring samples, and these lines may already exclude a
 * zero. The same holds if g has a kink. */
static bool has_certainly_no_zero(const tvi_event_sample dip[TVI_DIP_SAMPLES])
{
    tvi_event_sample x[TVI_DIP_SAMPLES];
    for (int i = 0; i < TVI_DIP_SAMPLES; i++)
        x[i] = (tvi_event_sample){dip[i].theta, dip[2].g > 0 ? dip[i].g : -dip[i].g};
    const double first = chord_slope(x[0], x[1]), fall = chord_slope(x[1], x[2]);
    const double rise = chord_slope(x[2], x[3]), last = chord_slope(x[3], x[4]);
    const double least = fmin(lower_bound_of_convex_function(x[1], first, x[2], rise),
                              lower_bound_of_convex_function(x[2], fall, x[3], last));
    /* All comparisons are false if a sample is missing, since its g is NAN. */
    return first <= fall && rise <= last && least > 0;
}

bool tvi_dip_needs_another_sample(const tvi_event_sample dip[TVI_DIP_SAMPLES], int sample_count, double *theta)
{
    const double change = fmax(fabs(dip[1].g), fabs(dip[3].g)) - fabs(dip[2].g);
    if (sample_count >= EVENT_DIP_MAX_SAMPLES || dip[3].theta - dip[1].theta <= EVENT_DIP_MIN_WIDTH ||
        has_certainly_no_zero(dip))
        return false;
    if (change <= EVENT_ROUNDOFF_UNITS * DBL_EPSILON * fabs(dip[2].g)) return false;
    *theta = next_sample_theta(dip, sample_count % 3 == 2);
    return true;
}

void tvi_dip_insert_sample(tvi_event_sample dip[TVI_DIP_SAMPLES], tvi_event_sample sample)
{
    const bool is_right = sample.theta > dip[2].theta, is_less = fabs(sample.g) < fabs(dip[2].g);
    if (is_right == is_less) {
        dip[0] = dip[1];
        dip[1] = is_less ? dip[2] : sample;
    } else {
        dip[4] = dip[3];
        dip[3] = is_less ? dip[2] : sample;
    }
    if (is_less) dip[2] = sample;
}
