/* A list of times in two calls, of which the second begins in the step that the first one has ended with: an
 * integrator reports 0.28 and 0.4, and an ensemble of one member reports nothing and fails. Right: both report 0.28
 * and 0.4 at cos t, and return TVI_OK. */
#include <math.h>
#include <stdlib.h>
#include <tvi.h>
#include "verdict.h"

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

static int reported;

static int at_time(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)which, (void)p, (void)ctx;
    reported += fabs(q[0] - cos(t)) < 1e-12;
    return 0;
}

int main(void)
{
    static const double first[] = {0.1, 0.25}, second[] = {0.28, 0.4};
    const tvi_run_plan one = {.h = 0.3, .times = first, .time_count = 2, .at_time = at_time};
    const tvi_run_plan two = {.h = 0.3, .times = second, .time_count = 2, .at_time = at_time};
    tvi_system *system;
    tvi_integrator *it;
    tvi_ensemble *ensemble;
    tvi_status each = TVI_OK, status, again;
    double t = 0, q = 1, p = 0;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&it, system, NULL));
    TVI_OR_EXIT(tvi_ensemble_create(&ensemble, system, NULL, 1, 1));
    status = tvi_run(it, &one, &t, &q, &p), again = tvi_run(it, &two, &t, &q, &p);
    row(status == TVI_OK && again == TVI_OK && reported == 4, "integrator: %d, %d, %d of 4 times", status, again,
        reported);
    t = 0, q = 1, p = 0, reported = 0;
    status = tvi_ensemble_run(ensemble, &one, &t, &q, &p, &each),
    again = tvi_ensemble_run(ensemble, &two, &t, &q, &p, &each);
    row(status == TVI_OK && again == TVI_OK && each == TVI_OK && reported == 4,
        "ensemble: %d, %d, its member %d, %d of 4 times", status, again, each, reported);
    tvi_ensemble_free(ensemble), tvi_integrator_free(it), tvi_system_free(system);
    return verdict();
}
