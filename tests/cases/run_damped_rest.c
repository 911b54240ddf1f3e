/* A damped oscillator q'' = -q - q' is run until long after it has come to rest, to t = 1500.
 * tvi_integrate_tolerance makes steps of 1e-8 once |q| is below 1e-280 (t = 1311) and does not come to an end, as
 * 10^6 steps move t by 0.02; fixed steps end with TVI_ETOOLARGE, "its passes overflow: the step is too large", once
 * q is below 2e-308 (t = 1417).
 * Right: TVI_OK at t = 1500, with q = 0 to 300 digits.
 * Kind: STEP_SIZE_LEAST = 1e-280 of src/generating/taylor.c, and passes relative to a size that is subnormal. */
#include <math.h>
#include <stdlib.h>
#include <tvi.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

static void brake(const jet q[], const jet v[], jet t, jet F[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    F[0] = jet_neg(v[0]);
}

static int is_endless(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p, (void)ctx;
    return step >= 200000;
}

static void end(const char *name, tvi_status status, double t, double q)
{
    row(status == TVI_OK && t == 1500 && fabs(q) < 1e-300, "%s: %s at t = %g, q = %g", name, tvi_status_string(status),
        t, q);
}

int main(void)
{
    tvi_system *spring, *damped;
    tvi_integrator *it;
    tvi_options options;
    double t = 0, q = 0.5, p = 0.5;
    TVI_OR_EXIT(tvi_system_potential(&spring, 1, NULL, V, NULL));
    TVI_OR_EXIT(tvi_system_driven(&damped, spring, brake, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&it, damped, NULL));
    tvi_status status = tvi_integrate_to(it, 0.2, 1500, &t, &q, &p, NULL, NULL);
    end("fixed steps", status, t, q);
    tvi_integrator_free(it);
    t = 0, q = p = 0.5;
    TVI_OR_EXIT(tvi_options_named("taylor", tvi_taylor_order(1e-9), &options));
    TVI_OR_EXIT(tvi_integrator_create(&it, damped, &options));
    status = tvi_integrate_tolerance(it, 1e-9, 1500, &t, &q, &p, is_endless, NULL);
    end("tolerance", status, t, q);
    tvi_integrator_free(it), tvi_system_free(damped), tvi_system_free(spring);
    return verdict();
}
