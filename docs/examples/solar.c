/* solar.c - the Sun, Jupiter, Saturn, Uranus, Neptune, Pluto for 200,000 days: events, a bar on the terminal.
 *   cc solar.c $(pkg-config --cflags --libs tvi) -lm */
#include "solar.h"

#include <tvi.h>

#include <math.h>
#include <stdio.h>

/* V = -G sum_{i<j} m_i m_j / |q_i - q_j| */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet V = jet_const(0);
    for (int i = 1; i < BODIES; i++)
        for (int j = 0; j < i; j++) {
            jet d[3];
            for (int k = 0; k < 3; k++) d[k] = jet_sub(q[3 * i + k], q[3 * j + k]);
            V = jet_sub(V, jet_mul(G * mass[i] * mass[j], jet_pow(jet_dot(d, d, 3), -0.5)));
        }
    return V;
}

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
    double t = 0, m[N], q[N], p[N], H0, H;
    for (int i = 0; i < N; i++) m[i] = mass[i / 3], q[i] = place[i], p[i] = m[i] * speed[i];
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_event *event;
    if (tvi_system_potential(&system, N, m, potential, NULL) || tvi_integrator_create(&integrator, system, NULL) ||
        tvi_event_create(&event, N, TVI_RISING, false, radial, NULL) || tvi_energy(system, t, q, p, &H0))
        return 1;
    tvi_progress_bar bar = {.steps = 400};
    const tvi_event *const events[] = {event};
    if (tvi_integrate_events(integrator, 500, bar.steps, events, 1, &t, q, p, tvi_progress, perihelion, &bar) ||
        tvi_energy(system, t, q, p, &H))
        return 1;
    printf("%.0f days: energy error %.0e\n", t, fabs(H / H0 - 1));
    tvi_event_free(event);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
