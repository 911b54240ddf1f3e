/* masses.c - a sweep over masses, down to a test particle: two bodies on a circle, and how long they take.
 *   cc masses.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi_bodies.h>

#include <stdio.h>
#include <stdlib.h>

/* Rises through 0 when the second body has gone round. */
static jet height(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[3], q[1]);
}

/* At distance 1 about the common centre: angular velocity sqrt(1 + m). */
static double period(double m, const tvi_event *event)
{
    const double mass[] = {1, m}, whole = 1 + m, w = sqrt(whole), v[] = {0, -m / whole * w, 0, w / whole};
    const tvi_bodies bodies = {.bodies = 2, .axes = 2, .mass = mass}; /* read while the system is made */
    double t = 0, q[] = {-m / whole, 0, 1 / whole, 0}, p[4];
    tvi_system *system;
    tvi_integrator *integrator;
    TVI_OR_EXIT(tvi_bodies_system(&system, &bodies));
    tvi_bodies_momenta(&bodies, v, p); /* p = M v */
    TVI_OR_EXIT(tvi_integrator_create(&integrator, system, NULL));
    TVI_OR_EXIT(tvi_integrate_events(integrator, 0.3, 100, &event, 1, &t, q, p, NULL, NULL, NULL));
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return t;
}

int main(void)
{
    static const double masses[] = {1, 0.1, 0.01, 0.001, 0};
    tvi_event *event;
    TVI_OR_EXIT(tvi_event_create(&event, 4, TVI_RISING, true, height, NULL));
    for (int i = 0; i < 5; i++) {
        const double t = period(masses[i], event), wanted = 2 * acos(-1) / sqrt(1 + masses[i]);
        printf("m = %.3f: period %.12f, error %.0e\n", masses[i], t, fabs(t - wanted));
    }
    tvi_event_free(event);
}
