/* narrow.c - Narrows the bracket of a sign change (narrow.h). */
#include "run/narrow.h"

#include <float.h>
#include <math.h>

static int sign_of_value(double g) { return (g > 0) - (g < 0); }

/* Returns the next abscissa at which the function is evaluated: the root of the secant, truncated and projected as ITP
 * prescribes (narrow.h). `width` is that of the first bracket, and `left` the number of evaluations that remain. */
static double choose_next_abscissa(double a, double ga, double b, double gb, double width, double least, int left)
{
    const double middle = (a + b) / 2, secant = (a * gb - b * ga) / (gb - ga), way = middle - secant;
    const double truncation = 0.2 / width * (b - a) * (b - a);
    const double reach = ldexp(least, left) - (b - a) / 2;
    double at = truncation <= fabs(way) ? secant + copysign(truncation, way) : middle;
    if (fabs(at - middle) > reach) at = middle - copysign(fmax(reach, 0), way);
    return fmin(fmax(at, a), b);
}

tvi_status tvi_narrow_bracket(tvi_sign_bracket *bracket, double least, tvi_bracketed_function *g, void *ctx)
{
    const double width = bracket->right - bracket->left;
    const int most = (int)ceil(log2(fmax(width / least, 1))) + 1;
    for (int k = 0;
         k < most && bracket->right - bracket->left > 2 * least && bracket->g_left != 0 && bracket->g_right != 0; k++) {
        if (nextafter(bracket->left, bracket->right) >= bracket->right) break;
        const double at = choose_next_abscissa(bracket->left, bracket->g_left, bracket->right, bracket->g_right, width,
                                               least, most - k);
        double here;
        const tvi_status status = g(ctx, at, &here);
        if (status != TVI_OK) return status;
        if (sign_of_value(here) == sign_of_value(bracket->g_left)) bracket->left = at, bracket->g_left = here;
        else bracket->right = at, bracket->g_right = here;
    }
    return TVI_OK;
}
