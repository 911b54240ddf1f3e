/* ensemble_mpi.c - the orbits of ensemble.c on many machines, a share for each process. All states go into one file,
 * from which the same number of processes goes on after a kill: the end has the same bits, for any number of them.
 *   mpicc ensemble_mpi.c $(pkg-config --cflags --libs tvi) -lm && mpirun -n 2 ./a.out 100; mpirun -n 2 ./a.out 400 */
#define _POSIX_C_SOURCE 200112L /* setenv */
#include "ensemble.h"

#include <mpi.h>
#include <stdlib.h>

enum { PART = 100 }; /* steps between two files */

/* The bytes of all processes, one after the other, to a file or from it. */
static int transfer(const char *name, int mode, char *bytes, long size)
{
    long at = 0;
    MPI_File file;
    MPI_Exscan(&size, &at, 1, MPI_LONG, MPI_SUM, MPI_COMM_WORLD);
    if (MPI_File_open(MPI_COMM_WORLD, name, mode, MPI_INFO_NULL, &file) != MPI_SUCCESS) return 0;
    if (mode == MPI_MODE_RDONLY) MPI_File_read_at_all(file, at, bytes, (int)size, MPI_BYTE, MPI_STATUS_IGNORE);
    else MPI_File_write_at_all(file, at, bytes, (int)size, MPI_BYTE, MPI_STATUS_IGNORE);
    return MPI_File_close(&file) == MPI_SUCCESS;
}

int main(int count, char **arguments)
{
    int rank, size, done = 0, from;
    setenv("OMPI_MCA_sharedfp", "^sm", 0); /* or the next run of Open MPI waits for a lock of one that was killed */
    MPI_Init(&count, &arguments), MPI_Comm_rank(MPI_COMM_WORLD, &rank), MPI_Comm_size(MPI_COMM_WORLD, &size);
    const int first = rank * ORBITS / size, members = (rank + 1) * ORBITS / size - first;
    double t[ORBITS], q[N * ORBITS], p[N * ORBITS], end[ORBITS][2 * N], mine = 0, worst = 0;
    tvi_status status[ORBITS];
    tvi_system *system;
    tvi_ensemble *ensemble;
    size_t each = 0; /* of all members, before the run and after it */
    start(first, members, t, q, p);
    if (tvi_system_potential(&system, N, NULL, potential, NULL) != TVI_OK ||
        tvi_ensemble_create(&ensemble, system, NULL, members, 1) != TVI_OK ||
        tvi_ensemble_member_to_text(ensemble, 0, t, q, p, NULL, &each) != TVI_OK)
        return MPI_Abort(MPI_COMM_WORLD, 1);
    const long bytes = (long)each * members;
    char *texts = malloc((size_t)bytes);
    if (transfer("orbits.state", MPI_MODE_RDONLY, texts, bytes) && move(ensemble, members, 1, texts, each, t, q, p))
        done = (int)lround(t[0] / 0.25);
    else start(first, members, t, q, p);
    for (from = done; done < (count > 1 ? atoi(arguments[1]) : 4 * PART); done += PART)
        if (tvi_ensemble_integrate(ensemble, 0.25, PART, t, q, p, status, NULL, NULL) != TVI_OK ||
            !move(ensemble, members, 0, texts, each, t, q, p) ||
            !transfer("orbits.new", MPI_MODE_CREATE | MPI_MODE_WRONLY, texts, bytes) ||
            (rank == 0 && rename("orbits.new", "orbits.state") != 0)) /* a kill leaves a whole file */
            return MPI_Abort(MPI_COMM_WORLD, 1);
    for (int m = 0; m < members; m++) {
        mine = fmax(mine, energy_error(system, members, m, q, p));
        for (int i = 0; i < N; i++) end[m][i] = q[i * members + m], end[m][N + i] = p[i * members + m];
    }
    MPI_Reduce(&mine, &worst, 1, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
    if (rank == 0) printf("from step %d to step %d: energies to %.0e\n", from, done, worst);
    transfer("orbits.end", MPI_MODE_CREATE | MPI_MODE_WRONLY, (char *)end, members * (long)sizeof *end);
    return MPI_Finalize();
}
