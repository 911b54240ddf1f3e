/* A program that is compiled with -ffast-math uses tvi_bodies.h: its checks are folded away, and NaN comes out with
 * TVI_OK. Right: elements that are not finite are refused and x is left as it was, and so is an orbit of NaN; the
 * orbit of a state is the one that made it, to 1e-12; a parabola, whose a is infinite, is the one of the same q.
 * Built with: -O2 -ffast-math */
#include <math.h>
#include <stdlib.h>
#include <tvi_bodies.h>
#include "verdict.h"

int main(void)
{
    const double nan = strtod("nan", NULL), inf = strtod("inf", NULL);
    const tvi_orbit good = {.q = 1, .e = 0.5, .time = 1};
    const tvi_orbit bad[] = {{.q = nan, .e = 0.5},
                             {.q = 1, .e = 0.5, .time = nan},
                             {.q = 1, .e = 0.5, .i = nan},
                             {.q = 1, .e = inf},
                             {.a = inf, .q = 1, .e = 0.5, .time = 1}};
    double x[3], v[3];
    for (int i = 0; i < 5; i++) {
        x[0] = 7;
        const tvi_status status = tvi_orbit_state(&bad[i], 1, x, v);
        row(status != TVI_OK && x[0] == 7, "elements %d: status %d, x = %g", i, status, x[0]);
    }
    const double X[] = {1, 0, 0}, speeds[] = {0, 1.2, nan};
    tvi_orbit orbit = {0};
    row(tvi_orbit_of(1, X, speeds, &orbit) != TVI_OK, "orbit of NaN");
    const tvi_status there = tvi_orbit_state(&good, 1, x, v), back = tvi_orbit_of(1, x, v, &orbit);
    row(there == TVI_OK && back == TVI_OK && fabs(orbit.e - 0.5) < 1e-12 && fabs(orbit.time - 1) < 1e-12,
        "there and back: e = %.15g, time = %.15g", orbit.e, orbit.time);
    const tvi_orbit parabola = {.q = 1, .e = 1, .time = 1}, with_a = {.a = inf, .q = 1, .e = 1, .time = 1};
    double y[3], w[3];
    const tvi_status one = tvi_orbit_state(&parabola, 1, x, v), other = tvi_orbit_state(&with_a, 1, y, w);
    row(one == TVI_OK && other == TVI_OK && fabs(x[0] - y[0]) < 1e-12, "parabola: %d and %d, x = %g, %g", one, other,
        x[0], y[0]);
    return verdict();
}
