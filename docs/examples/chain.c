/* chain.c - a chain of ten links in Cartesian coordinates: what it pulls at its pivot while it falls.
 *   cc chain.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LINKS = 10, N = 2 * LINKS };
static const double length = 0.1, g = 9.8; /* m, m/s^2; masses of 1 kg at the ends of the links */

static jet weight(const jet q[], jet t, void *ctx)
{
    jet height = q[1];
    (void)t, (void)ctx;
    for (int i = 3; i < N; i += 2) height = jet_add(height, q[i]);
    return jet_mul(g, height);
}

/* (d.d - length^2) / 2 of each link, with d from one mass to the next */
static void links(const jet q[], jet t, jet value[], void *ctx)
{
    (void)t, (void)ctx;
    for (int k = 0; k < LINKS; k++) {
        const jet *x = q + 2 * k, d[] = {k ? jet_sub(x[0], x[-2]) : x[0], k ? jet_sub(x[1], x[-1]) : x[1]};
        value[k] = jet_mul(0.5, jet_sub(jet_dot(d, d, 2), length * length));
    }
}

static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    double lambda[LINKS], H;
    (void)step;
    TVI_OR_EXIT(tvi_multipliers(ctx, t, q, p, lambda, NULL));
    TVI_OR_EXIT(tvi_energy(ctx, t, q, p, &H)); /* 0 at the start */
    return printf("%.1f s: end at (%7.4f, %7.4f) m, pivot %8.3f N, energy error %.0e\n", t, q[N - 2], q[N - 1],
                  lambda[0] * length, fabs(H) / (g * LINKS * (LINKS + 1) / 2 * length)) < 0;
}

int main(void)
{
    tvi_system *masses, *chain;
    tvi_integrator *integrator;
    double t = 0, q[N] = {0}, p[N] = {0};
    const double times[] = {0.2, 0.4, 0.6, 0.8, 1};
    for (int k = 0; k < LINKS; k++) q[2 * k] = length * (k + 1); /* straight and level, at rest */
    TVI_OR_EXIT(tvi_system_potential(&masses, N, NULL, weight, NULL));
    TVI_OR_EXIT(tvi_system_constrained(&chain, masses, LINKS, links, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&integrator, chain, NULL));
    TVI_OR_EXIT(tvi_integrate_at(integrator, 0.005, times, 5, &t, q, p, watch, chain));
    tvi_integrator_free(integrator);
    tvi_system_free(chain);
    tvi_system_free(masses);
}
