/* dip.c - Searches a dip of |g| for a zero of g, by parabolas and golden sections (dip.h). */
#include "run/dip.h"

#include <float.h>
#include <math.h>

/* The search samples g as long as it changes by more than UNITS units of its roundoff, in parts of the step that are at
 * least LEAST_SECTION. */
static const double UNITS = 64, LEAST_SECTION = 1e-8;
enum { MOST_SECTIONS = 120 };

/* The next abscissa to sample: the minimum of the parabola through the three points. A golden section of the larger
 * part replaces it if the minimum lies outside, or if a section is wanted. */
static double choose_next_theta(const tvi_event_sample x[TVI_DIP_SAMPLES], bool wants_golden_section)
{
    const double golden = 0.3819660112501051;
    const double left = x[2].theta - x[1].theta, right = x[3].theta - x[2].theta, larger = right > left ? right : -left;
    const double rise = (x[3].g - x[2].g) / right, fall = (x[2].g - x[1].g) / left;
    const double bend = (rise - fall) / (left + right), way = -(fall + bend * left) / (2 * bend);
    return x[2].theta + (!wants_golden_section && way != 0 && way > -left && way < right ? way : golden * larger);
}

static double chord_slope(tvi_event_sample a, tvi_event_sample b) { return (b.g - a.g) / (b.theta - a.theta); }

/* The least value between a and b of a convex function with these values, whose slope is at least `down` and at most
 * `up`. */
static double lower_bound_between(tvi_event_sample a, double down, tvi_event_sample b, double up)
{
    const double width = b.theta - a.theta;
    return a.g + down / (down - up) * (b.g - a.g - up * width);
}

/* Tells whether g, convex at the five points, has no zero among them because it lies above the chords from outside. A
 * kink is convex, too. Beside a peak g is not convex: its zeros then lie between two points, with three points on one
 * side. */
static bool is_zero_excluded(const tvi_event_sample from[TVI_DIP_SAMPLES])
{
    tvi_event_sample x[TVI_DIP_SAMPLES];
    for (int i = 0; i < TVI_DIP_SAMPLES; i++)
        x[i] = (tvi_event_sample){from[i].theta, from[2].g > 0 ? from[i].g : -from[i].g};
    const double first = chord_slope(x[0], x[1]), fall = chord_slope(x[1], x[2]);
    const double rise = chord_slope(x[2], x[3]), last = chord_slope(x[3], x[4]);
    const double least =
        fmin(lower_bound_between(x[1], first, x[2], rise), lower_bound_between(x[2], fall, x[3], last));
    return first <= fall && rise <= last && least > 0; /* false if a point is missing */
}

bool tvi_dip_choose_theta(const tvi_event_sample x[TVI_DIP_SAMPLES], int sample_count, double *at)
{
    const double change = fmax(fabs(x[1].g), fabs(x[3].g)) - fabs(x[2].g);
    if (sample_count >= MOST_SECTIONS || x[3].theta - x[1].theta <= LEAST_SECTION || is_zero_excluded(x)) return false;
    if (change <= UNITS * DBL_EPSILON * fabs(x[2].g)) return false;
    *at = choose_next_theta(x, sample_count % 3 == 2);
    return true;
}

void tvi_dip_insert_sample(tvi_event_sample x[TVI_DIP_SAMPLES], tvi_event_sample found)
{
    const bool is_right = found.theta > x[2].theta, is_less = fabs(found.g) < fabs(x[2].g);
    if (is_right == is_less) {
        x[0] = x[1];
        x[1] = is_less ? x[2] : found;
    } else {
        x[4] = x[3];
        x[3] = is_less ? x[2] : found;
    }
    if (is_less) x[2] = found;
}
