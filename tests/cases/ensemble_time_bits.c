/* A member of an ensemble of a system that depends on the time has other bits than an integrator of its own, with
 * AVX2 and AVX-512. Right: the same bits, for each of 100 members and three methods (docs/ensembles.md). */
#include <math.h>
#include <stdlib.h>
#include <tvi.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    return jet_neg(jet_mul(jet_add(1, jet_mul(0.1, t)), jet_cos(q[0])));
}

static bool differs(const tvi_system *system, const tvi_options *options, int i)
{
    tvi_integrator *it;
    tvi_ensemble *ensemble;
    tvi_status each;
    double t = 0.01 * i, q = sin(i), p = 0.3, member_t = t, member_q = q, member_p = p;
    TVI_OR_EXIT(tvi_integrator_create(&it, system, options));
    TVI_OR_EXIT(tvi_ensemble_create(&ensemble, system, options, 1, 1));
    TVI_OR_EXIT(tvi_integrate(it, 0.17, 20, &t, &q, &p, NULL, NULL));
    TVI_OR_EXIT(tvi_ensemble_integrate(ensemble, 0.17, 20, &member_t, &member_q, &member_p, &each, NULL, NULL));
    tvi_ensemble_free(ensemble), tvi_integrator_free(it);
    return q != member_q || p != member_p;
}

int main(void)
{
    static const char *const names[] = {"galerkin", "midpoint", "taylor"};
    tvi_system *system;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    for (int k = 0; k < 3; k++) {
        tvi_options options;
        int count = 0;
        TVI_OR_EXIT(tvi_options_named(names[k], 8, &options));
        for (int i = 0; i < 100; i++) count += differs(system, &options, i);
        row(count == 0, "%s: %d of 100 members differ from their integrators", names[k], count);
    }
    tvi_system_free(system);
    return verdict();
}
