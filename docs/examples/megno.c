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

/* The exponent and MEGNO after so many steps, from a circle: with d_k the length of the tangent vector after k steps,
 *   lambda = ln(d_k / d_0) / t,  Y_k = (2/k) sum_{j <= k} j ln(d_j / d_{j-1}),  and the mean of Y_1 ... Y_k. */
static void look(tvi_integrator *integrator, double beta, double h, long steps, double *lambda, double *megno)
{
    double t = 0, q[] = {-A - MU, 0}, p[] = {0, -sqrt((1 - beta) / A)}, sum = 0, total = 0, all = 0;
    double D[5] = {0.5, 0.5, 0.5, 0.5, 0}; /* rows (dq, dp, dbeta), one column */
    TVI_OR_EXIT(tvi_integrator_set_parameters(integrator, &beta));
    for (long k = 1; k <= steps; k++) {
        TVI_OR_EXIT(tvi_step_tangent(integrator, h, &t, q, p, D, 1));
        const double d = sqrt(D[0] * D[0] + D[1] * D[1] + D[2] * D[2] + D[3] * D[3]);
        for (int i = 0; i < 4; i++) D[i] /= d; /* the map is linear: back to length 1 */
        sum += (double)k * log(d), all += log(d);
        total += 2 / (double)k * sum;
    }
    *lambda = all / t, *megno = total / (double)steps;
}

int main(void)
{
    tvi_system *system;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, potential, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    for (double beta = 0; beta < 0.2; beta += 0.1) {
        double lambda, megno;
        look(integrator, beta, 0.2, 10000, &lambda, &megno);
        printf("beta = %.1f: %s\n", beta, megno < 3 && lambda < 0.01 ? "regular" : "chaotic");
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
