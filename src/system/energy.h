/* energy.h - Computes the energy of a state, in memory that the caller has taken. Integrators use it to check steps. */
#ifndef TVI_SRC_SYSTEM_ENERGY_H
#define TVI_SRC_SYSTEM_ENERGY_H

#include "system/legendre.h"

typedef struct {
    const tvi_system *system;
    double *block;         /* of the energy's tape */
    tvi_legendre legendre; /* of a Lagrangian that is not separable */
    /* [n] start and result of Newton's method. */
    double *velocity;
    /* [slots of the tape] of a Hamiltonian whose values are wanted in long double, otherwise NULL. */
    long double *precise;
} tvi_energy_work;

/* Takes the work for a system that has an energy. */
void tvi_energy_take(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system);
void tvi_energy_prepare(tvi_energy_work *work);
/* Do what tvi_energy, tvi_momentum and tvi_velocity do, with these values of the parameters. NULL leaves them as
 * recorded. */
TVI_NODISCARD tvi_status tvi_energy_at(const tvi_system *system, const double parameters[], double t, const double q[],
                                       const double p[], double *H);
TVI_NODISCARD tvi_status tvi_transform(const tvi_system *system, const double parameters[], double t, const double q[],
                                       const double in[], double out[], bool to_momenta);
/* Makes the next solution independent of the one before. */
static inline void tvi_energy_forget(tvi_energy_work *work)
{
    if (work->velocity) memset(work->velocity, 0, (size_t)work->system->n * sizeof *work->velocity);
}
/* Computes tvi_energy of a finite state. */
TVI_NODISCARD tvi_status tvi_energy_of(tvi_energy_work *work, double t, const double q[], const double p[], double *H);

/* Computes the energies of several states [n][width], each in a lane of the block. Energies without a value are not
 * finite. It does not serve Lagrangians that are not separable. */
typedef struct {
    const tvi_system *system;
    double *block;
    int width;
} tvi_energy_lanes;
void tvi_energy_lanes_take(tvi_energy_lanes *lanes, tvi_arena *arena, const tvi_system *system, int width);
void tvi_energy_in_lanes(const tvi_energy_lanes *lanes, const double t[], const double q[], const double p[],
                         double H[]);

/* Compute the energy of a Hamiltonian in long double, NaN if it has no value. The work has to be taken with room for
 * it. */
void tvi_energy_take_precise(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system);
long double tvi_energy_precise(tvi_energy_work *work, double t, const double q[], const double p[]);

#endif
