/* dip.c - see dip.h. */
#include "run/dip.h"

#include <float.h>
#include <math.h>

/* g is looked at where it changes by more than so many units of its roundoff, in parts of the step that are no less. */
static const double UNITS = 64, LEAST_SECTION = 1e-8;
enum { MOST_SECTIONS = 120 };

/* The next place to look at: where the parabola through the three is least; or a golden section of the larger part, if
 * that is outside or a section is wanted. */
static double next_section(const tvi_place x[TVI_DIP], bool wants_golden)
{
    const double golden = 0.3819660112501051;
    const double left = x[2].at - x[1].at, right = x[3].at - x[2].at, larger = right > left ? right : -left;
    const double rise = (x[3].g - x[2].g) / right, fall = (x[2].g - x[1].g) / left;
    const double bend = (rise - fall) / (left + right), way = -(fall + bend * left) / (2 * bend);
    return x[2].at + (!wants_golden && way != 0 && way > -left && way < right ? way : golden * larger);
}

static double slope_of(tvi_place a, tvi_place b) { return (b.g - a.g) / (b.at - a.at); }

/* The least value that a convex function with these has between a and b, whose slope there is at least `down` and at
 * most `up`. */
static double least_between(tvi_place a, double down, tvi_place b, double up)
{
    const double width = b.at - a.at;
    return a.g + down / (down - up) * (b.g - a.g - up * width);
}

/* Whether g, convex where the five places are, has no zero among them: it lies above the chords that lead there. A kink
 * is convex, too; beside a peak g is not, which shows as its zeros lie between two places and three are on one side. */
static bool stays_away(const tvi_place from[TVI_DIP])
{
    tvi_place x[TVI_DIP];
    for (int i = 0; i < TVI_DIP; i++) x[i] = (tvi_place){from[i].at, from[2].g > 0 ? from[i].g : -from[i].g};
    const double first = slope_of(x[0], x[1]), fall = slope_of(x[1], x[2]);
    const double rise = slope_of(x[2], x[3]), last = slope_of(x[3], x[4]);
    const double least = fmin(least_between(x[1], first, x[2], rise), least_between(x[2], fall, x[3], last));
    return first <= fall && rise <= last && least > 0; /* not where a place is nowhere */
}

bool tvi_dip_next(const tvi_place x[TVI_DIP], int looks, double *at)
{
    const double change = fmax(fabs(x[1].g), fabs(x[3].g)) - fabs(x[2].g);
    if (looks >= MOST_SECTIONS || x[3].at - x[1].at <= LEAST_SECTION || stays_away(x)) return false;
    if (change <= UNITS * DBL_EPSILON * fabs(x[2].g)) return false;
    *at = next_section(x, looks % 3 == 2);
    return true;
}

void tvi_dip_take(tvi_place x[TVI_DIP], tvi_place found)
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
