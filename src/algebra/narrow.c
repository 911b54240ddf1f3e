/* narrow.c - Narrows a bracket of a sign change of a function until it contains the zero to the wanted accuracy, by the
 * ITP method (narrow.h). */
#include "algebra/narrow.h"
#include "algebra/sizes.h"

#include <math.h>

/* [1 / first width] The constant kappa_1 of the ITP root finder. */
#define EVENT_ITP_TRUNCATION 0.2 /* found: make check-events */

/* Returns the next abscissa at which the function is evaluated: the root of the secant, truncated and projected as
 * ITP prescribes (narrow.h). first_width is the width of the first bracket, and evaluations_left the number of
 * evaluations that remain. */
static double choose_next_abscissa(double left, double g_left, double right, double g_right, double first_width,
                                   double least_width, int evaluations_left)
{
    const double middle = (left + right) / 2, secant = (left * g_right - right * g_left) / (g_right - g_left),
                 way = middle - secant;
    const double truncation = EVENT_ITP_TRUNCATION / first_width * (right - left) * (right - left);
    const double reach = ldexp(least_width, evaluations_left) - (right - left) / 2;
    double at = truncation <= fabs(way) ? secant + copysign(truncation, way) : middle;
    if (fabs(at - middle) > reach) at = middle - copysign(fmax(reach, 0), way);
    return fmin(fmax(at, left), right);
}

tvi_status tvi_narrow_bracket(tvi_sign_bracket *bracket, double least_width, tvi_bracketed_function *function,
                              void *ctx)
{
    const double width = bracket->right - bracket->left;
    const int most = (int)ceil(log2(fmax(width / least_width, 1))) + 1;
    for (int k = 0;
         k < most && bracket->right - bracket->left > 2 * least_width && bracket->g_left != 0 && bracket->g_right != 0;
         k++) {
        if (nextafter(bracket->left, bracket->right) >= bracket->right) break;
        const double at = choose_next_abscissa(bracket->left, bracket->g_left, bracket->right, bracket->g_right, width,
                                               least_width, most - k);
        double here;
        const tvi_status status = function(ctx, at, &here);
        if (status != TVI_OK) return status;
        if (tvi_sign(here) == tvi_sign(bracket->g_left)) bracket->left = at, bracket->g_left = here;
        else bracket->right = at, bracket->g_right = here;
    }
    return TVI_OK;
}
