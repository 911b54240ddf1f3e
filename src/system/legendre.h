/* legendre.h - Transforms velocities to momenta and back at a point: the Legendre transform of the system. Energies and
 * the starts of curves call it. */
#ifndef TVI_SRC_SYSTEM_LEGENDRE_H
#define TVI_SRC_SYSTEM_LEGENDRE_H

#include "algebra/linear.h"
#include "system/roundoff.h"
#include "system/system.h"

/* The transform y = f(x) that the system states: p = L_v(q, v) of a Lagrangian, v = H_p(q, p) of a Hamiltonian, p = M v
 * of a separable system. */
typedef struct {
    const tvi_system *system;
    /* Block of the field at one point; x is its second input. */
    double *x;
    double *dx;                         /* n directions */
    double *correction, *moved, *value; /* [n] scratch */
    tvi_factor slope;                   /* dy/dx: L_vv or H_pp */
    tvi_roundoff roundoff;              /* of the field at the point */
} tvi_legendre;

void tvi_legendre_take(tvi_legendre *legendre, tvi_arena *arena, const tvi_system *system);
void tvi_legendre_prepare(tvi_legendre *legendre);

/* Computes y = f(x). TVI_EDOMAIN, TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_legendre_state(tvi_legendre *legendre, double t, const double q[], const double x[],
                                            double y[]);

/* Solves f(x) = y for x by Newton's method from the given x. Also TVI_ESINGULAR and TVI_ENOCONV, with x undefined. */
TVI_NODISCARD tvi_status tvi_legendre_solve(tvi_legendre *legendre, double t, const double q[], const double y[],
                                            double x[]);

/* Computes z [2n] for a curve that starts at (q, p): (q, tau v), or (q, p) for a Hamiltonian. velocity [n] is the start
 * and the result of Newton's method. Only a Lagrangian uses `legendre`. */
TVI_NODISCARD tvi_status tvi_legendre_start(tvi_legendre *legendre, const tvi_system *system, double tau, double t,
                                            const double q[], const double p[], double velocity[], double z[]);

/* Creates a transform outside of an integrator, with these values of the parameters. NULL leaves them as recorded.
 * *memory is to be freed. TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_legendre_create(tvi_legendre *legendre, const tvi_system *system,
                                             const double parameters[], void **memory);

/* Sets system->regular if the slope is regular somewhere. TVI_ESINGULAR for a Lagrangian that is singular
 * everywhere. */
TVI_NODISCARD tvi_status tvi_legendre_probe(tvi_system *system);

#endif
