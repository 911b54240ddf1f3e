/* energy.h - the energy of a state, in memory that its caller has taken. */
#ifndef TVI_SRC_SYSTEM_ENERGY_H
#define TVI_SRC_SYSTEM_ENERGY_H

#include "system/legendre.h"

typedef struct {
    const tvi_system *system;
    double *block;         /* of the tape of the energy */
    tvi_legendre legendre; /* of a Lagrangian, as is */
    double *velocity;      /* [n] where Newton's method starts, and its result */
    long double *precise;  /* [slots of the tape] of a Hamiltonian whose values are wanted in long double; else NULL */
} tvi_energy_work;

/* Of a system that has an energy. */
void tvi_energy_take(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system);
void tvi_energy_prepare(tvi_energy_work *work);
/* tvi_energy, and tvi_momentum or tvi_velocity, with these values of the parameters; NULL: as recorded. */
TVI_NODISCARD tvi_status tvi_energy_at(const tvi_system *system, const double parameters[], double t, const double q[],
                                       const double p[], double *H);
TVI_NODISCARD tvi_status tvi_transform(const tvi_system *system, const double parameters[], double t, const double q[],
                                       const double in[], double out[], bool to_momenta);
/* The next one does not start where the one before ended. */
static inline void tvi_energy_forget(tvi_energy_work *work)
{
    if (work->velocity) memset(work->velocity, 0, (size_t)work->system->n * sizeof *work->velocity);
}
/* tvi_energy of a state that is finite. */
TVI_NODISCARD tvi_status tvi_energy_of(tvi_energy_work *work, double t, const double q[], const double p[], double *H);

/* The energies of several states, [n][width], each in a lane of the block; not finite where there is none. Not of a
 * Lagrangian, as is. */
typedef struct {
    const tvi_system *system;
    double *block;
    int width;
} tvi_energy_lanes;
void tvi_energy_lanes_take(tvi_energy_lanes *lanes, tvi_arena *arena, const tvi_system *system, int width);
void tvi_energy_in_lanes(const tvi_energy_lanes *lanes, const double t[], const double q[], const double p[],
                         double H[]);

/* The same of a Hamiltonian in long double, where what is taken has room for that; NaN where it has no value. */
void tvi_energy_take_precise(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system);
long double tvi_energy_precise(tvi_energy_work *work, double t, const double q[], const double p[]);

#endif
