/* ensemble.c - many orbits at once, in the lanes and on the cores of one machine; an observer sees all of them.
 *   cc ensemble.c $(pkg-config --cflags --libs tvi) -lm */
#include "ensemble.h"

#include <stdlib.h>

/* The largest |x| that each orbit comes to: an observer, after each step. */
static int look(long step, int members, const double t[], const double q[], const double p[], const tvi_status status[],
                void *ctx)
{
    double *reach = ctx;
    (void)step, (void)t, (void)p, (void)status;
    for (int m = 0; m < members; m++) reach[m] = fmax(reach[m], fabs(q[m]));
    return 0;
}

int main(void)
{
    double t[ORBITS], q[N * ORBITS], p[N * ORBITS], reach[ORBITS] = {0}, mean = 0, worst = 0;
    tvi_status status[ORBITS];
    tvi_system *system;
    tvi_ensemble *ensemble;
    int failed = 0;
    TVI_OR_EXIT(tvi_system_potential(&system, N, NULL, potential, NULL));
    TVI_OR_EXIT(tvi_ensemble_create(&ensemble, system, NULL, ORBITS, 0)); /* 0: all cores */
    start(0, ORBITS, t, q, p);
    TVI_OR_EXIT(tvi_ensemble_integrate(ensemble, 0.25, 400, t, q, p, status, look, reach));
    for (int m = 0; m < ORBITS; m++) {
        failed += status[m] != TVI_OK; /* such a member stays where it was, and the others go on */
        mean += reach[m] / ORBITS;
        worst = fmax(worst, energy_error(system, ORBITS, m, q, p));
    }
    printf("%d orbits, %d failed: mean reach %.12f, largest energy error %.0e\n", ORBITS, failed, mean, worst);
    tvi_ensemble_free(ensemble);
    tvi_system_free(system);
    return failed != 0;
}
