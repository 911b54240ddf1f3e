/* fit.c - the mass of a planet from noisy positions of an asteroid, by Gauss-Newton: the mass is a parameter, and
 * tvi_step_tangent gives the derivative of each position with respect to it.
 *   cc fit.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { POSITIONS = 40, STEPS = 12 }; /* observed every 12 steps of 0.1: 12 revolutions of the asteroid */
static const double TRUTH = 9.5e-4, GUESS = 2e-3, NOISE = 1e-7;

/* The asteroid about a sun of mass 1 in the heliocentric plane, and a planet of mass m on a circle of radius 1.9. */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    const jet m = jet_parameter(q[0], 0, GUESS), phase = jet_mul(pow(1.9, -1.5), t);
    const jet X = jet_mul(1.9, jet_cos(phase)), Y = jet_mul(1.9, jet_sin(phase));
    const jet distance = jet_hypot(jet_sub(q[0], X), jet_sub(q[1], Y));
    const jet indirect = jet_div(jet_add(jet_mul(q[0], X), jet_mul(q[1], Y)), pow(1.9, 3));
    return jet_sub(jet_mul(m, jet_sub(indirect, jet_div(1, distance))), jet_div(1, jet_hypot(q[0], q[1])));
}

/* All positions with this mass, and their derivatives. */
static void observe(tvi_integrator *integrator, double mass, double x[][2], double dx[][2])
{
    double t = 0, q[] = {1, 0}, p[] = {0, 1.05}, D[5] = {0, 0, 0, 0, 1}; /* rows dq, dp, dm */
    TVI_OR_EXIT(tvi_integrator_set_parameters(integrator, &mass));
    for (int k = 0; k < POSITIONS * STEPS; k++) {
        TVI_OR_EXIT(tvi_step_tangent(integrator, 0.1, &t, q, p, D, 1));
        for (int i = 0; i < 2; i++) x[k / STEPS][i] = q[i], dx[k / STEPS][i] = D[i];
    }
}

int main(void)
{
    double seen[POSITIONS][2], x[POSITIONS][2], dx[POSITIONS][2], mass = GUESS;
    tvi_system *system;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, potential, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    observe(integrator, TRUTH, seen, dx);
    for (int k = 0; k < 2 * POSITIONS; k++) seen[k / 2][k % 2] += NOISE * sin(1e4 * k * k);
    for (int pass = 1; pass <= 3; pass++) {
        double above = 0, below = 0;
        observe(integrator, mass, x, dx);
        for (int k = 0; k < 2 * POSITIONS; k++) {
            above += dx[k / 2][k % 2] * (seen[k / 2][k % 2] - x[k / 2][k % 2]);
            below += dx[k / 2][k % 2] * dx[k / 2][k % 2];
        }
        mass += above / below;
        printf("pass %d: the correction is 10^%.0f\n", pass, floor(log10(fabs(above / below))));
    }
    printf("the mass is right to 10^%.0f\n", ceil(log10(fabs(mass - TRUTH))));
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
