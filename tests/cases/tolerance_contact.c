/* A mass on a spring meets a smooth contact V = 500 (0.01 ln(1 + e^(100 (x - 1/2))))^2, run by
 * tvi_integrate_tolerance to t = 20. With 1e-4 and 1e-6 the run ends with TVI_OK, q off by 2 and H off by 1 to 5;
 * with less it is refused with TVI_ENOCONV from deep inside of the contact.
 * Right: TVI_OK, with q and H to 1000 tolerances: q(20) = -0.121300376 (galerkin of order 16 with h = 0.001 and
 * 0.002 agree to 1e-15, DOP853 of 1e-12 to 1e-10) and H = 1/2.
 * Kind and other inputs: tolerance_contact.py. */
#include <math.h>
#include <stdlib.h>
#include <tvi.h>
#include "verdict.h"

static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet depth = jet_mul(0.01, jet_log(jet_add(1, jet_exp(jet_mul(100, jet_sub(q[0], 0.5))))));
    return jet_add(jet_div(jet_sqr(q[0]), 2), jet_mul(500, jet_sqr(depth)));
}

int main(void)
{
    static const double tolerances[] = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
    tvi_system *system;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, potential, NULL));
    for (int i = 0; i < 5; i++) {
        tvi_integrator *it;
        tvi_options options;
        double t = 0, q = -1, p = 0, H = NAN;
        TVI_OR_EXIT(tvi_options_named("taylor", tvi_taylor_order(tolerances[i]), &options));
        TVI_OR_EXIT(tvi_integrator_create(&it, system, &options));
        const tvi_status status = tvi_integrate_tolerance(it, tolerances[i], 20, &t, &q, &p, NULL, NULL);
        if (tvi_energy(system, t, &q, &p, &H) != TVI_OK) H = INFINITY;
        const double bound = 1000 * tolerances[i] + 1e-9;
        row(status == TVI_OK && fabs(q + 0.121300376) < bound && fabs(H - 0.5) < bound,
            "%.0e: %s at t = %g, q = %.9f, H = %g", tolerances[i], tvi_status_string(status), t, q, H);
        tvi_integrator_free(it);
    }
    tvi_system_free(system);
    return verdict();
}
