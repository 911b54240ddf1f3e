/* bounce.c - an event that changes the momenta: a ball keeps 0.9 of its speed at each bounce. A terminal event ends the
 * run at the floor; p is changed there, and the next run goes on from it.
 *   cc bounce.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double G = 9.8, END = 7;

static jet potential(const jet q[], jet t, void *ctx) /* V = g q, of the mass 1 */
{
    (void)t, (void)ctx;
    return jet_mul(G, q[0]);
}

static jet height(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

int main(void)
{
    double t = 0, q[] = {1}, p[] = {0}, right = sqrt(2 / G);
    int bounces = 0;
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_event *floor;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, potential, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    TVI_OR_EXIT(tvi_event_create(&floor, 1, TVI_FALLING, true, height, NULL));
    const tvi_event *const events[] = {floor};
    const tvi_run_plan plan = {.h = 0.1, .t_end = END, .has_t_end = true, .events = events, .event_count = 1};
    while (t < END) {
        const tvi_status status = tvi_run(integrator, &plan, &t, q, p);
        if (status == TVI_ESTOPPED) /* at the floor, which is not reported again from here */
            p[0] *= -0.9, bounces++;
        else TVI_OR_EXIT(status);
    }
    for (int k = 1; k < bounces; k++) right += 2 * sqrt(2 / G) * pow(0.9, k); /* the last bounce, in closed form */
    printf("%d bounces, t = %g s: %.6f m high\n", bounces, t, q[0]);
    right = q[0] - pow(0.9, bounces) * sqrt(2 * G) * (END - right) + G * (END - right) * (END - right) / 2;
    printf("right to %.0e m\n", fabs(right));
    tvi_event_free(floor);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
