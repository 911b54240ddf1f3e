/* energy.h - Computes the energy of a state in memory that the caller has allocated. Integrators check their steps
 * with it (run/guard.c). */
#ifndef TVI_SRC_SYSTEM_ENERGY_H
#define TVI_SRC_SYSTEM_ENERGY_H

#include "system/legendre.h"

/* The memory in which energies are computed, one state at a time. */
typedef struct {
    const tvi_system *system;
    double *tape_block;    /* Block of the energy's tape. */
    tvi_legendre legendre; /* Computes velocities from momenta, for a Lagrangian that is not separable. */
    /* [n] The velocities that Newton's method finds for a Lagrangian. It starts at rest. */
    double *velocity;
    /* [slots of the tape] Values in long double of a Hamiltonian; NULL if they are not asked for. */
    long double *long_double_values;
} tvi_energy_work;

/* Allocates the memory for a system that has an energy, in an arena (algebra/arena.h). */
void tvi_energy_allocate(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system);
void tvi_energy_prepare(tvi_energy_work *work);
/* Do the same as tvi_energy, tvi_momentum and tvi_velocity, with these values of the parameters. NULL stands for the
 * values in the recording. */
TVI_NODISCARD tvi_status tvi_energy_with_parameters(const tvi_system *system, const double parameters[], double t,
                                                    const double q[], const double p[], double *H);
TVI_NODISCARD tvi_status tvi_transform_velocities(const tvi_system *system, const double parameters[], double t,
                                                  const double q[], const double input[], double output[],
                                                  bool to_momenta);
/* Computes the energy of a finite state, as tvi_energy does. */
TVI_NODISCARD tvi_status tvi_energy_compute(tvi_energy_work *work, double t, const double q[], const double p[],
                                            double *H);

/* The memory in which the energies of several states are computed at once. Each state is a lane of the block. The
 * system must not be a Lagrangian, unless it is separable. */
typedef struct {
    const tvi_system *system;
    double *tape_block;
    int lane_count;
} tvi_energy_batch;
void tvi_energy_batch_allocate(tvi_energy_batch *batch, tvi_arena *arena, const tvi_system *system, int lane_count);
/* Computes H [lane_count] of the states q, p [n][lane_count] at the times t. An energy without a value is not
 * finite. */
void tvi_energy_batch_compute(const tvi_energy_batch *batch, const double t[], const double q[], const double p[],
                              double H[]);

/* Allocates the memory, and computes the energy of a Hamiltonian in long double. The result is NaN if the energy has
 * no value. */
void tvi_energy_allocate_long_double(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system);
long double tvi_energy_compute_long_double(tvi_energy_work *work, double t, const double q[], const double p[]);

#endif
