/* A fast flyby: a hyperbola of e = 50 past a fixed centre, with pericentre 1 at t = 0 and speed 1 far away (an
 * asteroid past the Earth), from t = -2805.5 to 2698.5 with the wanted error 1e-4, and 40 runs of other durations
 * with 1e-4 and 1e-9. tvi_suggest_step returns h = 2e3, and the run ends with TVI_OK in 3 steps that fly over the
 * whole deflection of 2 asin(1/50) = 0.04. Its tail 0.003 is below the 0.01 of docs/choosing.md, and the run with h
 * / 2 agrees to 5e-5.
 * Right: an error of at most the wanted one, or a refusal of tvi_suggest_step; a refusal of the run is wrong, since
 * h was advised. Reference: Kepler's hyperbola (tvi_orbit_state, which 40 digits confirm). tvi_integrate_tolerance
 * of 1e-6 has 3e-8.
 * Kind: no trial of the whole run decides about the step. e = 16 fails from |t| = 300 on, e = 5 from 1000 on. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <tvi.h>
#include <tvi_bodies.h>
#include "verdict.h"

static const double mu = 1.0 / 49;

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(-mu, jet_pow(jet_dot(q, q, 2), -0.5));
}

static void at(double t, double x[4])
{
    const tvi_orbit orbit = {.q = 1, .e = 50, .time = t};
    double q[3], v[3];
    TVI_OR_EXIT(tvi_orbit_state(&orbit, mu, q, v));
    memcpy(x, q, 2 * sizeof *q), memcpy(x + 2, v, 2 * sizeof *v);
}

static void fly(const tvi_system *system, double from, double to, double wanted)
{
    double x[4], end[4], t = from, h;
    tvi_integrator *it;
    at(from, x), at(to, end);
    if (tvi_suggest_step(system, NULL, t, x, x + 2, to - from, wanted, &h) != TVI_OK) {
        row(true, "from %g to %g, wanted %.0e: %s", from, to, wanted, tvi_last_error());
        return;
    }
    TVI_OR_EXIT(tvi_integrator_create(&it, system, NULL));
    const tvi_status status = tvi_integrate_to(it, h, to, &t, x, x + 2, NULL, NULL);
    const double error = fmax(fabs(x[0] - end[0]), fabs(x[1] - end[1])) / to;
    row(status == TVI_OK && error <= wanted, "from %g to %g, wanted %.0e: h = %.2g, %s, error %.1e", from, to, wanted,
        h, tvi_status_string(status), error);
    tvi_integrator_free(it);
}

int main(void)
{
    tvi_system *system;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, V, NULL));
    fly(system, -2805.5, 2698.5, 1e-4);
    for (int k = 0; k < 40; k++) fly(system, -(1500 + 37.3 * k), 1680 + 29.1 * k, k % 2 ? 1e-4 : 1e-9);
    tvi_system_free(system);
    return verdict();
}
