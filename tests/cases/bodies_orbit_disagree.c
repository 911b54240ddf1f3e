/* Orbital elements that disagree: q = a (1 - e) does not hold. For e = 0 tvi_orbit_state returns TVI_OK and a circle
 * of radius a or q. Right: TVI_EINVAL; the circle whose a and q agree has r = 3 and the speed 1 / sqrt 3. */
#include <math.h>
#include <tvi_bodies.h>
#include "verdict.h"

int main(void)
{
    static const struct {
        tvi_orbit orbit;
        bool is_refused;
    } cases[] = {
        {{.a = 0.5, .q = 3, .e = 0}, true}, {{.a = 0.5, .q = 3, .e = 0.1}, true}, {{.a = 3, .q = 3, .e = 0}, false}};
    for (int i = 0; i < 3; i++) {
        double x[3] = {0}, v[3] = {0};
        const tvi_status status = tvi_orbit_state(&cases[i].orbit, 1, x, v);
        const bool is_circle = fabs(x[0] - 3) < 1e-14 && fabs(v[1] - 1 / sqrt(3)) < 1e-15;
        row(cases[i].is_refused ? status == TVI_EINVAL : status == TVI_OK && is_circle,
            "a = %g, q = %g, e = %g: status %d, r = %g, speed %g", cases[i].orbit.a, cases[i].orbit.q, cases[i].orbit.e,
            status, x[0], v[1]);
    }
    return verdict();
}
