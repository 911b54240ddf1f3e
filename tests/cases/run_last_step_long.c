/* tvi_integrate_to far from t = 0: the last step is longer than h where t / h > 2^51, by up to 4 units of t's last
 * place; at t = 1e16 it is 45 h and is refused, after which t is beyond where the run came to. Right: 10 steps of
 * 0.1 for each unit of time and an error as at t = 0, where order 4 has a phase error of 1.4e-7 for each unit, and so
 * 1.4e-7 |sin d| d after d units; or a refusal before a step is made. */
#include <math.h>
#include <stdlib.h>
#include <tvi.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

int main(void)
{
    static const double starts[] = {0, 1e13, 1e14, 1e15, 1e16, 1e17};
    tvi_system *system;
    tvi_options options;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    TVI_OR_EXIT(tvi_options_named("galerkin", 4, &options));
    for (int i = 0; i < 6; i++) {
        const double start = starts[i], duration = start > 1e16 ? 64 : 16;
        tvi_integrator *it;
        double t = start, q = 1, p = 0;
        TVI_OR_EXIT(tvi_integrator_create(&it, system, &options));
        const tvi_status status = tvi_integrate_to(it, 0.1, start + duration, &t, &q, &p, NULL, NULL);
        const long steps = (long)tvi_integrator_stats(it)->steps;
        const double error = fabs(q - cos(duration));
        row(status == TVI_OK ? steps == lround(10 * duration) && error < 1.5e-7 * fabs(sin(duration)) * duration
                             : t == start && steps == 0,
            "t = %g + %g: status %d, %ld steps of %ld, error %.2g", start, t - start, status, steps,
            lround(10 * duration), error);
        tvi_integrator_free(it);
    }
    tvi_system_free(system);
    return verdict();
}
