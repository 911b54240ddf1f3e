/* energy.h - Computes the energy of a state in memory that the caller has allocated. Integrators call it to check
 * their steps (integrator/guard.c). */
#ifndef TVI_SRC_SYSTEM_ENERGY_H
#define TVI_SRC_SYSTEM_ENERGY_H

#include "system/legendre.h"

/* The memory in which energies are computed. */
typedef struct {
    const tvi_system *system;
    double *tape_block;              /* The block of the energy's tape. */
    tvi_legendre_transform legendre; /* Computes velocities from momenta, for a Lagrangian that is not separable. */
    /* [n] The velocities of a Lagrangian, which Newton's method finds from the momenta. */
    double *velocity;
    /* [slots of the energy's tape] The values of all slots in long double, for a Hamiltonian. NULL: the energy is
     * computed in double only. */
    long double *long_double_values;
} tvi_energy_work;

/* Allocates the memory for a system that has an energy, in an arena (algebra/arena.h). */
void tvi_energy_allocate(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system);
/* Does the same as tvi_energy, with the given parameters instead of the recorded ones. NULL stands for the recorded
 * parameters. */
TVI_NODISCARD tvi_status tvi_energy_with_parameters(const tvi_system *system, const double parameters[], double t,
                                                    const double q[], const double p[], double *H);
/* Does the same as tvi_momentum if to_momenta is true, and otherwise the same as tvi_velocity, with the given
 * parameters instead of the recorded ones. NULL stands for the recorded parameters. */
TVI_NODISCARD tvi_status tvi_apply_legendre_transform(const tvi_system *system, const double parameters[], double t,
                                                      const double q[], const double input[], double output[],
                                                      bool to_momenta);
/* Computes the energy of a state whose numbers are finite, as tvi_energy does, in the memory `work`. */
TVI_NODISCARD tvi_status tvi_energy_compute(tvi_energy_work *work, double t, const double q[], const double p[],
                                            double *H);

/* Allocates the memory for energies of a Hamiltonian in long double, in the same way as tvi_energy_allocate does. */
void tvi_energy_allocate_long_double(tvi_energy_work *work, tvi_arena *arena, const tvi_system *system);
/* Computes the energy in long double. Returns NaN if the energy has no value. */
long double tvi_energy_compute_long_double(tvi_energy_work *work, double t, const double q[], const double p[]);

#endif
