/* The derivative of atan2 is lost where its arguments are beyond 1e154, as their squares overflow. Right: H =
 * atan2(1, 1 / p) = atan(p) has H = p and H_p = 1 for p far below 1; K = 1e-200 p - atan2(p, 1e200) at p = 1e200 has
 * K_p = 1e-200 - 1e200 / (p^2 + 1e400) = 5e-201. */
#include <math.h>
#include <stdlib.h>
#include <tvi.h>
#include "verdict.h"

static jet H(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return jet_atan2(1, jet_div(1, p[0]));
}

static jet K(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t, (void)ctx;
    return jet_sub(jet_mul(p[0], 1e-200), jet_atan2(p[0], 1e200));
}

static bool is_near(double a, double b) { return fabs(a - b) <= 1e-12 * fabs(b); }

int main(void)
{
    tvi_system *system;
    double q = 0, large = 1e200, energy = 0, v = 7;
    TVI_OR_EXIT(tvi_system_hamiltonian(&system, 1, H, NULL));
    for (double p = 1e-150; p > 1e-300; p *= 1e-20) {
        const tvi_status of_energy = tvi_energy(system, 0, &q, &p, &energy),
                         of_velocity = tvi_velocity(system, 0, &q, &p, &v);
        row(of_energy == TVI_OK && of_velocity == TVI_OK && is_near(energy, p) && is_near(v, 1),
            "p = %g: status %d and %d, H = %g, H_p = %g", p, of_energy, of_velocity, energy, v);
    }
    tvi_system_free(system);
    TVI_OR_EXIT(tvi_system_hamiltonian(&system, 1, K, NULL));
    const tvi_status status = tvi_velocity(system, 0, &q, &large, &v);
    row(status == TVI_OK && is_near(v, 5e-201), "K: status %d, K_p = %g", status, v);
    tvi_system_free(system);
    return verdict();
}
