/* Sun, Jupiter, and a moon on a circle about Jupiter (Io's distance, 0.0028 AU) as a test particle of mass 0, in
 * rescaled steps with tvi_bodies_scale and the h of about 1 that docs/bodies.md names ("h is a phase, 0.5 to 1.1 for
 * the default method"), to t = 60. Every step returns TVI_OK, the largest tail is 0.05 (below the 0.1 of Python's
 * warning), the energy is kept to 1e-15, and the moon is thrown out to 55 AU.
 * Right: the moon stays at 0.0028 AU from Jupiter (float128 Taylor series: 0.00282 all the time), or a refusal.
 * Kind: a body without a mass has no share in the energy and in the size of p that the passes, the tail and the
 * guard look at. Fixed steps of more than 30 periods do the same to moons of any mass. */
#include <math.h>
#include <stdlib.h>
#include <tvi.h>
#include <tvi_bodies.h>
#include "verdict.h"

static const double mass[] = {1, 9.5e-4, 0};
static const tvi_bodies bodies = {.bodies = 3, .axes = 3, .mass = mass};

static void start(double q[9], double p[9])
{
    static const tvi_orbit jupiter = {.a = 5.2, .e = 0.048}, moon = {.a = 0.00282, .i = 0.05};
    double v[9] = {0};
    q[0] = q[1] = q[2] = 0;
    TVI_OR_EXIT(tvi_orbit_state(&jupiter, mass[0] + mass[1], q + 3, v + 3));
    TVI_OR_EXIT(tvi_orbit_state(&moon, mass[1], q + 6, v + 6));
    for (int k = 0; k < 3; k++) q[6 + k] += q[3 + k], v[6 + k] += v[3 + k];
    tvi_bodies_momenta(&bodies, v, p), tvi_bodies_to_centre(&bodies, q, p);
}

int main(void)
{
    tvi_system *system, *rescaled;
    TVI_OR_EXIT(tvi_bodies_system(&system, &bodies));
    TVI_OR_EXIT(tvi_system_rescaled(&rescaled, system, tvi_bodies_scale, (void *)&bodies));
    for (int i = 4; i < 12; i++) {
        double q[9], p[9], t = 0;
        tvi_integrator *it;
        start(q, p);
        TVI_OR_EXIT(tvi_integrator_create(&it, rescaled, NULL));
        const tvi_status status = tvi_integrate_to(it, 0.1 * i, 60, &t, q, p, NULL, NULL);
        const double distance = hypot(hypot(q[6] - q[3], q[7] - q[4]), q[8] - q[5]);
        row(status != TVI_OK || fabs(distance - 0.00282) < 1e-4, "h = %.1f: %s, t = %.3g, tail %.2g, moon at %.4g AU",
            0.1 * i, tvi_status_string(status), t, tvi_integrator_stats(it)->largest_tail, distance);
        tvi_integrator_free(it);
    }
    tvi_system_free(rescaled), tvi_system_free(system);
    return verdict();
}
