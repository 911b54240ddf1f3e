/* consumer.c - Acts as a program of somebody else, who has only what `make install` put there: a pendulum of length 1
 * m. */
#include <tvi.h>
#include <tvi_bodies.h>

#include <math.h>
#include <stdio.h>

static jet potential(const jet q[], jet t, void *ctx)
{
    const double *gravity = ctx;
    (void)t;
    return jet_mul(*gravity, jet_sub(1, jet_cos(q[0])));
}

int main(void)
{
    double gravity = 9.8, t = 0, q[] = {1}, p[] = {0}, start, end;
    tvi_system *system;
    tvi_integrator *integrator = NULL;
    tvi_status status = tvi_system_potential(&system, 1, NULL, potential, &gravity);
    if (status == TVI_OK) status = tvi_integrator_create(&integrator, system, NULL);
    if (status == TVI_OK) status = tvi_energy(system, t, q, p, &start);
    if (status == TVI_OK) status = tvi_integrate(integrator, 0.02, 500, &t, q, p, NULL, NULL);
    if (status == TVI_OK) status = tvi_energy(system, t, q, p, &end);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    if (status != TVI_OK) {
        fprintf(stderr, "%s\n", tvi_status_string(status));
        return 1;
    }
    const tvi_orbit orbit = {.a = 1 + q[0] * q[0], .e = 0.5, .time = t}; /* by functions of the mathematical library */
    double x[3], v[3];
    if (tvi_orbit_state(&orbit, 1, x, v) != TVI_OK) return 1;
    printf("t = %g, q = %.15f, p = %.15f, energy error %.1e\n", t, q[0], p[0], end - start);
    return !(fabs(end - start) < 1e-12);
}
