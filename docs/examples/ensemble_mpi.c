/* ensemble_mpi.c - the ensemble of ensemble_openmp.c on many machines: each process has a system and an integrator.
 *   mpicc ensemble_mpi.c $(pkg-config --cflags --libs tvi) -lm && mpirun -n 2 ./a.out */
#include "ensemble.h"

#include <mpi.h>
#include <stdio.h>

/* Orbits rank, rank + size, ... of [ORBITS]; the others are left 0. The number that failed. */
static int share(int rank, int size, double reach[], double error[])
{
    int failed = 0;
    tvi_system *system;
    tvi_integrator *integrator = NULL;
    if (tvi_system_potential(&system, 2, NULL, potential, NULL) != TVI_OK) return ORBITS;
    if (tvi_integrator_create(&integrator, system, NULL) != TVI_OK) failed = ORBITS;
    for (int k = rank; k < ORBITS && !failed; k += size)
        if (orbit(integrator, system, k, &reach[k], &error[k]) != TVI_OK) failed++;
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return failed;
}

int main(int count, char **arguments)
{
    double mine[2][ORBITS] = {{0}}, all[2][ORBITS], mean = 0, worst = 0;
    int rank, size, failed = 0;
    MPI_Init(&count, &arguments);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    const int failures = share(rank, size, mine[0], mine[1]);
    MPI_Allreduce(&failures, &failed, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    MPI_Reduce(mine, all, 2 * ORBITS, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
    for (int k = 0; k < ORBITS && rank == 0;
         k++) { /* sums with zeros are exact: the same for any number of processes */
        mean += all[0][k] / ORBITS;
        worst = fmax(worst, all[1][k]);
    }
    if (rank == 0)
        printf("%d orbits, %d failed: mean reach %.12f, largest energy error %.0e\n", ORBITS, failed, mean, worst);
    MPI_Finalize();
    return failed != 0;
}
