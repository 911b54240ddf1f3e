/* triple.c - three stars from orbital elements: a far one on an inclined orbit makes that of the others eccentric, and
 * round again (Kozai and Lidov), in steps that adapt.
 *   cc triple.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi_bodies.h>

#include <stdio.h>
#include <stdlib.h>

static const double mass[] = {1, 0.5, 0.8}; /* one a body */
static const tvi_bodies bodies = {.bodies = 3, .axes = 3, .mass = mass};

/* The orbit of the second star about the first. */
static tvi_orbit inner_orbit(const double q[], const double p[])
{
    tvi_orbit orbit;
    double v[9], x[3], u[3];
    tvi_bodies_velocities(&bodies, p, v);
    for (int k = 0; k < 3; k++) x[k] = q[3 + k] - q[k], u[k] = v[3 + k] - v[k];
    TVI_OR_EXIT(tvi_orbit_of(mass[0] + mass[1], x, u, &orbit));
    return orbit;
}

/* Called after each step: the largest eccentricity, and when it was. */
static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    double *most = ctx;
    const tvi_orbit orbit = inner_orbit(q, p);
    (void)step;
    if (orbit.e > most[0]) most[0] = orbit.e, most[1] = t, most[2] = orbit.i;
    return 0;
}

int main(void)
{
    const tvi_orbit inner = {.a = 1, .e = 0.1}, outer = {.a = 10, .e = 0.2, .i = 1.35, .node = 0.5};
    double t = 0, q[9] = {0}, v[9] = {0}, p[9], most[3] = {0}, L[3], end[3];
    tvi_system *system, *rescaled;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_orbit_state(&inner, 1.5, q + 3, v + 3));
    TVI_OR_EXIT(tvi_orbit_state(&outer, 2.3, q + 6, v + 6)); /* about the centre of the two */
    for (int k = 6; k < 9; k++) q[k] += q[k - 3] / 3, v[k] += v[k - 3] / 3;
    tvi_bodies_momenta(&bodies, v, p); /* p = M v */
    tvi_bodies_to_centre(&bodies, q, p);
    tvi_bodies_angular_momentum(&bodies, q, p, L);
    TVI_OR_EXIT(tvi_bodies_system(&system, &bodies));
    TVI_OR_EXIT(tvi_system_rescaled(&rescaled, system, tvi_bodies_scale, (void *)&bodies));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, rescaled, NULL));
    TVI_OR_EXIT(tvi_integrate_to(integrator, 0.7, 6000, &t, q, p, watch, most));
    tvi_bodies_angular_momentum(&bodies, q, p, end);
    printf("e = %.3f at t = %.0f, i = %.3f; angular momentum to %.0e\n", most[0], most[1], most[2],
           fabs(end[2] / L[2] - 1));
    tvi_integrator_free(integrator);
    tvi_system_free(rescaled);
    tvi_system_free(system);
}
