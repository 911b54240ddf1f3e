/* pendulum.c - a force: a pendulum of length 1 m, released from 1 rad, and how long it takes to swing once.
 *   cc pendulum.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* F = dp/dt = -g sin q */
static void force(const jet q[], jet t, jet F[], void *ctx)
{
    const double *gravity = ctx;
    (void)t;
    F[0] = jet_mul(-*gravity, jet_sin(q[0]));
}

/* The event: q = 0, the lowest point. */
static jet angle(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

int main(void)
{
    double gravity = 9.8, t = 0, q[] = {1}, p[] = {0};
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_event *event;
    TVI_OR_EXIT(tvi_system_force(&system, 1, NULL, force, &gravity));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    TVI_OR_EXIT(tvi_event_create(&event, 1, TVI_FALLING, true, angle,
                                 NULL));
    const tvi_event *const events[] = {event};
    TVI_OR_EXIT(tvi_integrate_events(integrator, 0.05, 100, events, 1,
                                     &t, q, p, NULL, NULL, NULL));
    /* from rest to the lowest point is a quarter of a swing */
    printf("period %.12f s; of a small swing %.3f s\n", 4 * t,
           2 * acos(-1) / sqrt(gravity));
    tvi_event_free(event);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
