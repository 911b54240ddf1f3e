/* megno.c - order and chaos: a tangent vector that moves along two orbits of Henon and Heiles at one energy.
 *   cc megno.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* V = (x^2 + y^2)/2 + x^2 y - y^3/3 */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet x2 = jet_sqr(q[0]), y2 = jet_sqr(q[1]), cubic = jet_sub(x2, jet_div(y2, 3));
    return jet_add(jet_mul(0.5, jet_add(x2, y2)), jet_mul(q[1], cubic));
}

/* MEGNO after so many steps of size h: with d_k the length of the vector after k steps,
 *   Y_k = (2/k) sum_{j <= k} j ln(d_j / d_{j-1}),  and the mean of Y_1 ... Y_k. Near 2: regular; it grows: chaotic. */
static double megno(tvi_integrator *integrator, double h, long steps, double q[], double p[])
{
    double t = 0, D[] = {0.5, 0.5, 0.5, 0.5}, sum = 0, total = 0; /* D: rows (dq, dp), one column */
    for (long k = 1; k <= steps; k++) {
        TVI_OR_EXIT(tvi_step_tangent(integrator, h, &t, q, p, D, 1));
        const double d = sqrt(D[0] * D[0] + D[1] * D[1] + D[2] * D[2] + D[3] * D[3]);
        for (int i = 0; i < 4; i++) D[i] /= d; /* the map is linear: back to length 1 */
        sum += (double)k * log(d);
        total += 2 / (double)k * sum;
    }
    return total / (double)steps;
}

int main(void)
{
    static const double start[2][4] = {{0, 0.375, 0.375, 0.0625}, {0.25, 0.375, 0.1875, 0}}; /* q, p; H = 1/8 */
    tvi_system *system;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, potential, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    for (int orbit = 0; orbit < 2; orbit++) {
        double q[] = {start[orbit][0], start[orbit][1]}, p[] = {start[orbit][2], start[orbit][3]};
        const double mean = megno(integrator, 0.5, 4000, q, p);
        printf("orbit %d: MEGNO is %s\n", orbit + 1, mean < 3 ? "near 2: regular" : "large: chaotic");
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
