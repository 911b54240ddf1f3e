/* ensemble_openmp.c - many orbits on the cores of one machine: one system for all, one integrator a thread.
 *   cc -fopenmp ensemble_openmp.c $(pkg-config --cflags --libs tvi) -lm */
#include "ensemble.h"

#include <stdio.h>

int main(void)
{
    double reach[ORBITS] = {0}, error[ORBITS] = {0}, mean = 0, worst = 0;
    int failed = 0;
    tvi_system *system;
    if (tvi_system_potential(&system, 2, NULL, potential, NULL) != TVI_OK) return 1;
#pragma omp parallel reduction(+ : failed)
    {
        tvi_integrator *integrator;
        if (tvi_integrator_create(&integrator, system, NULL) != TVI_OK) failed++;
#pragma omp for schedule(dynamic)
        for (int k = 0; k < ORBITS; k++)
            if (!integrator || orbit(integrator, system, k, &reach[k], &error[k]) != TVI_OK) failed++;
        tvi_integrator_free(integrator);
    }
    tvi_system_free(system);
    for (int k = 0; k < ORBITS; k++) { /* in the order of the orbits: the same for any number of threads */
        mean += reach[k] / ORBITS;
        worst = fmax(worst, error[k]);
    }
    printf("%d orbits, %d failed: mean reach %.12f, largest energy error %.0e\n", ORBITS, failed, mean, worst);
    return failed != 0;
}
