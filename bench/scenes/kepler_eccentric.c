/* kepler_eccentric.c - Defines the scenes of Kepler's problem with large eccentricities. */
#include "hard.h"

#include <math.h>

/* V = -1/r, from pericentre, a = 1: q = 1 - e, p = sqrt((1 + e)/(1 - e)), H0 = -1/2, period 2 pi. 100 revolutions. */
static jet potential(const jet q[], jet t, void *ctx) { return scene_kepler.potential(q, t, ctx); }

/* g = r^(3/2) */
static jet scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_pow(jet_dot(q, q, 2), 0.75);
}

#define KEPLER(id, e, p_start)                                                                                         \
    const hard_scene hard_kepler_##id = {.scene = {.name = "kepler_eccentric_" #id,                                    \
                                                   .title = "Kepler, e = " #e,                                         \
                                                   .n = 2,                                                             \
                                                   .potential = potential,                                             \
                                                   .q = (const double[]){1 - e, 0},                                    \
                                                   .p = (const double[]){0, p_start},                                  \
                                                   .t_end = 628.318530717958648,                                       \
                                                   .energy_scale = 0.5},                                               \
                                         .scale = scale}

KEPLER(90, 0.9, 4.35889894354067355);
KEPLER(99, 0.99, 14.1067359796658844);
KEPLER(999, 0.999, 44.7101778122163142);

/* By bisection, then Newton's method. */
long double kepler_anomaly(long double e, long double M)
{
    const long double mean = remainderl(M, 2 * acosl(-1));
    long double low = -4, high = 4;
    for (int i = 0; i < 60; i++) {
        const long double E = (low + high) / 2;
        if (E - e * sinl(E) < mean) low = E;
        else high = E;
    }
    long double E = (low + high) / 2;
    for (int i = 0; i < 3; i++) E -= (E - e * sinl(E) - mean) / (1 - e * cosl(E));
    return E;
}
