/* The derivative of atan2 is lost where the squares of its arguments overflow or underflow, beyond 1e154 and below
 * 1e-154. Right, at every scale s: H = atan2(s p, s) = atan(p) has H_p = 1 / (1 + p^2), by which a step of "galerkin"
 * and one of "taylor" move q, and K = hypot(s p, s) / s has K_p = p / (1 + p^2)^(1/2). */
#include <math.h>
#include <stdlib.h>
#include <tvi.h>
#include "verdict.h"

static double s;

static jet H(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return jet_atan2(jet_mul(s, p[0]), jet_add(jet_mul(0, p[0]), s));
}

static jet K(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return jet_div(jet_hypot(jet_mul(s, p[0]), s), s);
}

static bool is_near(double a, double b) { return fabs(a - b) <= 1e-12 * fabs(b); }

static void check_scale(tvi_hamiltonian_fn *function, const char *name, double p, double right)
{
    static const char *const methods[] = {"galerkin", "taylor"};
    tvi_system *system;
    double q = 0, v = 7, moved[2] = {7, 7};
    TVI_OR_EXIT(tvi_system_hamiltonian(&system, 1, function, NULL));
    const tvi_status status = tvi_velocity(system, 0, &q, &p, &v);
    for (int i = 0; i < 2; i++) {
        tvi_options options;
        tvi_integrator *integrator;
        double t = 0, x = 0, y = p;
        TVI_OR_EXIT(tvi_options_named(methods[i], 8, &options));
        TVI_OR_EXIT(tvi_integrator_create(&integrator, system, &options));
        if (tvi_step(integrator, 0.1, &t, &x, &y) == TVI_OK) moved[i] = x / 0.1;
        tvi_integrator_free(integrator);
    }
    row(status == TVI_OK && is_near(v, right) && is_near(moved[0], right) && is_near(moved[1], right),
        "%s, s = %g, p = %g: status %d, %g, steps %g and %g for %g", name, s, p, status, v, moved[0], moved[1], right);
    tvi_system_free(system);
}

int main(void)
{
    static const double scales[] = {1e-300, 1e-200, 1e-150, 1, 1e150, 1e200, 1e300};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++)
        for (double p = 0.01; p < 200; p *= 10) {
            s = scales[i];
            check_scale(H, "atan2", p, 1 / (1 + p * p));
            check_scale(K, "hypot", p, p / sqrt(1 + p * p));
        }
    return verdict();
}
