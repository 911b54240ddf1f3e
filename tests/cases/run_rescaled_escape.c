/* An unbound body (hyperbola of e = 2, pericentre 1 at t = 0) in rescaled steps, g = r^(3/2), to a given time. In s
 * the orbit reaches t = infinity in a finite time (2 / t^(1/2) is left at t), so that the step that would pass t_end
 * has no solution once t_end is large: tvi_integrate_to ends with TVI_ETOOLARGE, "its passes overflow: the step is
 * too large", at t = 158 or 1246, though the part of the step that ends at t_end is easy. The last step of a run has
 * lost up to 9 digits.
 * Right: Kepler's hyperbola at every t_end (tvi_orbit_state, a closed form), to 1e-9 of t_end, for the steps of
 * docs/adaptive.md and for those that tvi_suggest_step returns for the wanted error 1e-6. */
#include <math.h>
#include <stdlib.h>
#include <tvi.h>
#include <tvi_bodies.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

static jet g(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_pow(jet_dot(q, q, 2), 0.75);
}

/* Runs to t_end with the step h; 0: with the suggested one. */
static void escape(const tvi_system *rescaled, double t_end, double h)
{
    const tvi_orbit orbit = {.q = 1, .e = 2, .time = t_end};
    const bool is_suggested = h == 0;
    double t = 0, q[] = {1, 0}, p[] = {0, sqrt(3)}, x[3], v[3];
    tvi_integrator *it;
    TVI_OR_EXIT(tvi_orbit_state(&orbit, 1, x, v));
    TVI_OR_EXIT(tvi_integrator_create(&it, rescaled, NULL));
    if (is_suggested) TVI_OR_EXIT(tvi_suggest_step(rescaled, NULL, t, q, p, t_end, 1e-6, &h));
    const tvi_status status = tvi_integrate_to(it, h, t_end, &t, q, p, NULL, NULL);
    const double error = hypot(q[0] - x[0], q[1] - x[1]) / t_end;
    row(status == TVI_OK && error < 1e-9, "t_end = %g, h = %.3g%s: %s at t = %.4g, error %.0e", t_end, h,
        is_suggested ? " (suggested)" : "", tvi_status_string(status), t, error);
    tvi_integrator_free(it);
}

int main(void)
{
    static const double ends[] = {10, 30, 100, 300, 1000, 1e4, 1e5}, steps[] = {0.05, 0.1, 0.3, 0.5, 0};
    tvi_system *system, *rescaled;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, V, NULL));
    TVI_OR_EXIT(tvi_system_rescaled(&rescaled, system, g, NULL));
    for (int i = 0; i < 7; i++)
        for (int k = 0; k < 5; k++) escape(rescaled, ends[i], steps[k]);
    tvi_system_free(rescaled), tvi_system_free(system);
    return verdict();
}
