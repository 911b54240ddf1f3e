/* eccentric.c - steps that adapt: a comet with eccentricity 0.99, a hundred revolutions, ten steps in each.
 *   cc eccentric.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

/* The local time scale, g = r^(3/2): the steps get shorter near the Sun. NULL in its place is the automatic one. */
static jet scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_pow(jet_dot(q, q, 2), 0.75);
}

int main(void)
{
    const double e = 0.99, turn = 2 * acos(-1), start[] = {1 - e, sqrt((1 + e) / (1 - e))};
    double t = 0, q[] = {start[0], 0}, p[] = {0, start[1]};
    tvi_system *system, *rescaled;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, potential, NULL));
    TVI_OR_EXIT(tvi_system_rescaled(&rescaled, system, scale, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, rescaled, NULL));
    TVI_OR_EXIT(tvi_integrate_to(integrator, 1.15, 100 * turn, &t, q, p, NULL, NULL));
    printf("after %.0f revolutions in %ld steps: q = (%.6f, %.6f), angular momentum %.6f\n", t / turn,
           tvi_integrator_stats(integrator)->steps, q[0], q[1], q[0] * p[1] - q[1] * p[0]);
    tvi_integrator_free(integrator);
    tvi_system_free(rescaled);
    tvi_system_free(system);
}
