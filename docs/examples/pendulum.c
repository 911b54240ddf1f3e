/* pendulum.c - a force: a pendulum of length 1 m, released from 1 rad, and how long it takes to swing once.
 *   cc pendulum.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>

/* F = dp/dt = -g sin q */
static void force(const jet q[], jet t, jet F[], void *ctx)
{
    const double *gravity = ctx;
    (void)t;
    F[0] = jet_mul(-*gravity, jet_sin(q[0]));
}

/* Where in the last step q was 0: by bisection on the step's own curve, which runs from above 0 to below. */
static tvi_status crossing(tvi_integrator *integrator, double *theta)
{
    double low = 0, high = 1, q[1], p[1];
    while (high - low > 1e-15) {
        *theta = (low + high) / 2;
        const tvi_status status = tvi_dense(integrator, *theta, q, p);
        if (status != TVI_OK) return status;
        *(q[0] > 0 ? &low : &high) = *theta;
    }
    return TVI_OK;
}

int main(void)
{
    double gravity = 9.8, h = 0.05, t = 0, q[] = {1}, p[] = {0}, theta = 0;
    tvi_system *system;
    tvi_integrator *integrator = NULL;
    tvi_status status = tvi_system_force(&system, 1, NULL, force, &gravity);
    if (status == TVI_OK) status = tvi_integrator_create(&integrator, system, NULL);
    while (status == TVI_OK && q[0] > 0) status = tvi_step(integrator, h, &t, q, p);
    if (status == TVI_OK) status = crossing(integrator, &theta);
    /* from rest to the lowest point is a quarter of a swing */
    if (status == TVI_OK)
        printf("period %.12f s; of a small swing %.3f s\n", 4 * (t - h + theta * h), 2 * acos(-1) / sqrt(gravity));
    else fprintf(stderr, "%s\n", tvi_status_string(status));
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return status != TVI_OK;
}
