/* solution.c - Computes where the bodies are. */
#include "adaptive.h"

#include <math.h>

/* From pericentre at (r, 0) with the velocity (0, v). The orbit is that of r and v as they are rounded, 1/a = (2 - v^2
 * r)/r without cancellation: the roundoff of v alone moves the end of 100 revolutions at e = 0.999 by 1e-8. */
static void kepler_position(const scene *s, double t, long double q[2])
{
    const long double r = s->q[0], v = s->p[1], square = v * v, rest = fmal(v, v, -square);
    const long double a = r / (fmal(-square, r, 2) - rest * r), e = 1 - r / a;
    const long double E = kepler_anomaly(e, t / (a * sqrtl(a)));
    q[0] = a * (cosl(E) - e);
    q[1] = a * sqrtl((1 - e) * (1 + e)) * sinl(E);
}

double adaptive_error(const hard_scene *problem, double t, const double q[])
{
    const scene *s = &problem->scene;
    long double exact[2], sum = 0;
    if (!s->reference) {
        kepler_position(s, t, exact);
        return (double)hypotl(q[0] - exact[0], q[1] - exact[1]);
    }
    for (int i = 0; i < s->n; i++) sum += powl(q[i] - s->reference[i], 2);
    return t == s->t_end ? (double)sqrtl(sum) : NAN;
}
