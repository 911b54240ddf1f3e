/* An observer of a member calls tvi_ensemble_reset and tvi_ensemble_stats while another thread steps members:
 * neither is refused, and with -fsanitize=thread they are data races. Right: tvi_ensemble_stats is refused there;
 * the reset does nothing, so that the run returns the bits of a run whose observer calls nothing. Here it runs
 * without the sanitizer. */
#include <stdlib.h>
#include <string.h>
#include <tvi.h>
#include "verdict.h"

enum { MEMBERS = 64 };
static tvi_ensemble *ensemble;
static tvi_status of_stats = TVI_OK;

static jet V(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_sqr(q[0]));
}

static int look(int member, int step, double t, const double q[], const double p[], void *ctx)
{
    (void)t, (void)q, (void)p;
    if (!ctx || member != 0 || step != 3) return 0;
    tvi_stats stats;
    tvi_ensemble_reset(ensemble);
    of_stats = tvi_ensemble_stats(ensemble, &stats);
    return 0;
}

static tvi_status run(const tvi_system *system, void *ctx, double q[MEMBERS])
{
    const tvi_run_plan plan = {.h = 0.1, .steps = 10, .at_step = look, .ctx = ctx};
    double t[MEMBERS] = {0}, p[MEMBERS] = {0};
    tvi_status each[MEMBERS];
    for (int m = 0; m < MEMBERS; m++) q[m] = 1 + 0.01 * m;
    TVI_OR_EXIT(tvi_ensemble_create(&ensemble, system, NULL, MEMBERS, 2));
    const tvi_status status = tvi_ensemble_run(ensemble, &plan, t, q, p, each);
    tvi_ensemble_free(ensemble);
    return status;
}

int main(void)
{
    tvi_system *system;
    double q[MEMBERS], undisturbed[MEMBERS];
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    TVI_OR_EXIT(run(system, NULL, undisturbed));
    const tvi_status status = run(system, &ensemble, q);
    row(of_stats != TVI_OK, "tvi_ensemble_stats in a run: %d", of_stats);
    row(status == TVI_OK && !memcmp(q, undisturbed, sizeof q), "the run: %d, its bits", status);
    tvi_system_free(system);
    return verdict();
}
