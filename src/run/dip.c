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
static double next_section(const tvi_dip_point x[TVI_DIP], bool wants_golden)
{
    const double golden = 0.3819660112501051;
    const double left = x[2].at - x[1].at, right = x[3].at - x[2].at, larger = right > left ? right : -left;
    const double rise = (x[3].g - x[2].g) / right, fall = (x[2].g - x[1].g) / left;
    const double bend = (rise - fall) / (left + right), way = -(fall + bend * left) / (2 * bend);
    return x[2].at + (!wants_golden && way != 0 && way > -left && way < right ? way : golden * larger);
}

static double slope_of(tvi_dip_point a, tvi_dip_point b) { return (b.g - a.g) / (b.at - a.at); }

/* The least value between a and b of a convex function with these values, whose slope is at least `down` and at most
 * `up`. */
static double least_between(tvi_dip_point a, double down, tvi_dip_point b, double up)
{
    const double width = b.at - a.at;
    return a.g + down / (down - up) * (b.g - a.g - up * width);
}

/* Tells whether g, convex at the five points, has no zero among them because it lies above the chords from outside. A
 * kink is convex, too. Beside a peak g is not convex: its zeros then lie between two points, with three points on one
 * side. */
static bool stays_away(const tvi_dip_point from[TVI_DIP])
{
    tvi_dip_point x[TVI_DIP];
    for (int i = 0; i < TVI_DIP; i++) x[i] = (tvi_dip_point){from[i].at, from[2].g > 0 ? from[i].g : -from[i].g};
    const double first = slope_of(x[0], x[1]), fall = slope_of(x[1], x[2]);
    const double rise = slope_of(x[2], x[3]), last = slope_of(x[3], x[4]);
    const double least = fmin(least_between(x[1], first, x[2], rise), least_between(x[2], fall, x[3], last));
    return first <= fall && rise <= last && least > 0; /* false if a point is missing */
}

bool tvi_dip_next(const tvi_dip_point x[TVI_DIP], int looks, double *at)
{
    const double change = fmax(fabs(x[1].g), fabs(x[3].g)) - fabs(x[2].g);
    if (looks >= MOST_SECTIONS || x[3].at - x[1].at <= LEAST_SECTION || stays_away(x)) return false;
    if (change <= UNITS * DBL_EPSILON * fabs(x[2].g)) return false;
    *at = next_section(x, looks % 3 == 2);
    return true;
}

void tvi_dip_insert(tvi_dip_point x[TVI_DIP], tvi_dip_point found)
{
    const bool is_right = found.at > x[2].at, is_less = fabs(found.g) < fabs(x[2].g);
    if (is_right == is_less) {
        x[0] = x[1];
        x[1] = is_less ? x[2] : found;
    } else {
        x[4] = x[3];
        x[3] = is_less ? x[2] : found;
    }
    if (is_less) x[2] = found;
}
