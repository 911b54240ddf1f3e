/* megno.c - order and chaos: a tangent vector that moves along two orbits of Henon and Heiles at one energy.
 *   cc megno.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>

/* V = (x^2 + y^2)/2 + x^2 y - y^3/3 */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet x2 = jet_sqr(q[0]), y2 = jet_sqr(q[1]), cubic = jet_sub(x2, jet_div(y2, 3));
    return jet_add(jet_mul(0.5, jet_add(x2, y2)), jet_mul(q[1], cubic));
}

/* MEGNO after so many steps of size h: with d_k the length of the vector after k steps,
 *   Y_k = (2/k) sum_{j <= k} j ln(d_j / d_{j-1}),  and the mean of Y_1 ... Y_k. Near 2: regular; it grows: chaotic. */
static tvi_status megno(tvi_integrator *integrator, double h, long steps, double q[], double p[], double *mean)
{
    double t = 0, D[] = {0.5, 0.5, 0.5, 0.5}, sum = 0, total = 0; /* D: rows (dq, dp), one column */
    for (long k = 1; k <= steps; k++) {
        const tvi_status status = tvi_step_tangent(integrator, h, &t, q, p, D, 1);
        if (status != TVI_OK) return status;
        const double d = sqrt(D[0] * D[0] + D[1] * D[1] + D[2] * D[2] + D[3] * D[3]);
        for (int i = 0; i < 4; i++) D[i] /= d; /* the map is linear: back to length 1 */
        sum += (double)k * log(d);
        total += 2 / (double)k * sum;
        *mean = total / (double)k;
    }
    return TVI_OK;
}

int main(void)
{
    static const double start[2][4] = {{0, 0.375, 0.375, 0.0625}, {0.25, 0.375, 0.1875, 0}}; /* q, p; H = 1/8 */
    tvi_system *system;
    tvi_integrator *integrator = NULL;
    tvi_status status = tvi_system_potential(&system, 2, NULL, potential, NULL);
    if (status == TVI_OK) status = tvi_integrator_create(&integrator, system, NULL);
    for (int orbit = 0; orbit < 2 && status == TVI_OK; orbit++) {
        double q[] = {start[orbit][0], start[orbit][1]}, p[] = {start[orbit][2], start[orbit][3]}, mean = 0;
        status = megno(integrator, 0.5, 4000, q, p, &mean);
        if (status == TVI_OK)
            printf("orbit %d: MEGNO is %s\n", orbit + 1, mean < 3 ? "near 2: regular" : "large: chaotic");
    }
    if (status != TVI_OK) fprintf(stderr, "%s\n", tvi_last_error());
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return status != TVI_OK;
}
