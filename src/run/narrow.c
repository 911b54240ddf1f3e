/* narrow.c - Narrows the bracket of a sign change (narrow.h). */
#include "run/narrow.h"

#include <float.h>
#include <math.h>

static int sign_of(double g) { return (g > 0) - (g < 0); }

/* The next abscissa to evaluate, with `left` evaluations left. */
static double next_place(double a, double ga, double b, double gb, double width, double least, int left)
{
    const double middle = (a + b) / 2, secant = (a * gb - b * ga) / (gb - ga), way = middle - secant;
    const double truncation = 0.2 / width * (b - a) * (b - a);
    const double reach = ldexp(least, left) - (b - a) / 2;
    double at = truncation <= fabs(way) ? secant + copysign(truncation, way) : middle;
    if (fabs(at - middle) > reach) at = middle - copysign(fmax(reach, 0), way);
    return fmin(fmax(at, a), b);
}

tvi_status tvi_narrow(tvi_bracket *z, double least, tvi_signed_fn *g, void *ctx)
{
    const double width = z->b - z->a;
    const int most = (int)ceil(log2(fmax(width / least, 1))) + 1;
    for (int k = 0; k < most && z->b - z->a > 2 * least && z->ga != 0 && z->gb != 0; k++) {
        if (nextafter(z->a, z->b) >= z->b) break;
        const double at = next_place(z->a, z->ga, z->b, z->gb, width, least, most - k);
        double here;
        const tvi_status status = g(ctx, at, &here);
        if (status != TVI_OK) return status;
        if (sign_of(here) == sign_of(z->ga)) z->a = at, z->ga = here;
        else z->b = at, z->gb = here;
    }
    return TVI_OK;
}
