/* kepler.c - a potential: a planet on an eccentric orbit, a thousand revolutions, and what is kept.
 *   cc kepler.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* V = -1/r; the force is derived from it. */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

/* Called after each step: the largest errors of energy and angular momentum so far. */
typedef struct {
    const tvi_system *system;
    double H0, L0, energy, momentum;
} errors;

static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    errors *worst = ctx;
    double H;
    (void)step;
    TVI_OR_EXIT(tvi_energy(worst->system, t, q, p, &H));
    worst->energy = fmax(worst->energy, fabs(H - worst->H0));
    worst->momentum = fmax(worst->momentum, fabs(q[0] * p[1] - q[1] * p[0] - worst->L0));
    return 0; /* goes on */
}

int main(void)
{
    double t = 0, q[] = {1, 0}, p[] = {0, 0.8}; /* the apocentre; eccentricity 0.36 */
    errors worst = {.L0 = 0.8};
    tvi_system *system;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, potential, NULL));
    worst.system = system;
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &worst.H0));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    TVI_OR_EXIT(tvi_integrate(integrator, 0.25, 16000, &t, q, p, watch, &worst));
    printf("t = %g: H = %.12f, kept to %.0e; angular momentum to %.0e\n", t, worst.H0, worst.energy, worst.momentum);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
