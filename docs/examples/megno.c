/* megno.c - order and chaos with a force of your own: a grain of dust inside of Jupiter's orbit, with and without the
 * pressure of sunlight, which is beta times as large as the Sun's attraction.
 *   cc megno.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi_bodies.h>

#include <stdio.h>
#include <stdlib.h>

/* Jupiter's mass, and the grain's distance. In units of both masses together and of Jupiter's distance. */
static const double MU = 9.54e-4, A = 0.825;

/* The Sun and Jupiter go round their centre in a time of 2 pi. */
static jet potential(const jet q[], jet t, void *ctx)
{
    const double mass[] = {1 - MU, MU};
    const tvi_bodies bodies = {.bodies = 2, .axes = 2, .mass = mass};
    const jet c = jet_cos(t), s = jet_sin(t), beta = jet_parameter(t, 0, 0);
    const jet at[] = {jet_mul(-MU, c), jet_mul(-MU, s), jet_mul(1 - MU, c), jet_mul(1 - MU, s)};
    const jet r = jet_hypot(jet_sub(q[0], at[0]), jet_sub(q[1], at[1]));
    (void)ctx;
    return jet_add(tvi_bodies_field(&bodies, at, q), jet_div(jet_mul(1 - MU, beta), r));
}

/* The exponent and MEGNO after so many steps, from a circle. */
static tvi_chaos look(tvi_integrator *integrator, double beta, double h, long steps)
{
    double t = 0, q[] = {-A - MU, 0}, p[] = {0, -sqrt((1 - beta) / A)};
    tvi_chaos chaos = {0};
    TVI_OR_EXIT(tvi_integrator_set_parameters(integrator, &beta));
    TVI_OR_EXIT(tvi_run_chaos(integrator, &(tvi_run_plan){.h = h, .steps = steps}, &chaos, &t, q, p));
    return chaos;
}

int main(void)
{
    tvi_system *system;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, potential, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    for (double beta = 0; beta < 0.2; beta += 0.1) {
        const tvi_chaos chaos = look(integrator, beta, 0.2, 10000);
        printf("beta = %.1f: %s\n", beta, chaos.megno < 3 && chaos.lyapunov < 0.01 ? "regular" : "chaotic");
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
