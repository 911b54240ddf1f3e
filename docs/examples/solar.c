/* solar.c - the Sun, Jupiter, Saturn, Uranus, Neptune, Pluto for 200,000 days: events, a bar on the terminal.
 *   cc solar.c $(pkg-config --cflags --libs tvi) -lm */
#include "solar.h"

#include <tvi_bodies.h>

#include <stdio.h>
#include <stdlib.h>

/* Rises through 0 at Pluto's perihelion: r . v, of Pluto from the Sun. */
static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet r[3], v[3];
    for (int k = 0; k < 3; k++)
        r[k] = jet_sub(q[15 + k], q[k]), v[k] = jet_sub(jet_div(p[15 + k], mass[5]), jet_div(p[k], mass[0]));
    return jet_dot(r, v, 3);
}

static int perihelion(int which, double t, const double q[], const double p[], void *ctx)
{
    (void)which, (void)p, (void)ctx;
    return printf("%.2f days: Pluto at %.4f AU\n", t, hypot(hypot(q[15] - q[0], q[16] - q[1]), q[17] - q[2])) < 0;
}

int main(void)
{
    const tvi_bodies bodies = {.bodies = BODIES, .axes = 3, .mass = mass, .G = G}; /* a mass a body */
    double t = 0, q[N], p[N], H0, H;
    for (int i = 0; i < N; i++) q[i] = place[i];
    tvi_bodies_momenta(&bodies, speed, p);
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_event *event;
    TVI_OR_EXIT(tvi_bodies_system(&system, &bodies));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    TVI_OR_EXIT(tvi_event_create(&event, N, TVI_RISING, false, radial, NULL));
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &H0));
    tvi_progress_bar bar = {.steps = 400};
    const tvi_event *const events[] = {event};
    TVI_OR_EXIT(tvi_integrate_events(integrator, 500, bar.steps, events, 1, &t, q, p, tvi_progress, perihelion, &bar));
    TVI_OR_EXIT(tvi_energy(system, t, q, p, &H));
    printf("%.0f days: energy error %.0e\n", t, fabs(H / H0 - 1));
    tvi_event_free(event);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
