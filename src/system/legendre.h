/* legendre.h - the Legendre transform at a point: between velocities and momenta. */
#ifndef TVI_SRC_SYSTEM_LEGENDRE_H
#define TVI_SRC_SYSTEM_LEGENDRE_H

#include "algebra/linear.h"
#include "system/roundoff.h"
#include "system/system.h"

/* The transform that the system states, y = f(x): Lagrangian p = L_v(q, v), Hamiltonian v = H_p(q, p), separable p = M
 * v. */
typedef struct {
    const tvi_system *system;
    double *x;                          /* block of the field at one point; x is its second input */
    double *dx;                         /* n directions */
    double *correction, *moved, *value; /* [n] scratch of the solution */
    tvi_factor slope;                   /* dy/dx: L_vv or H_pp */
    tvi_roundoff roundoff;              /* of the field at the point */
} tvi_legendre;

void tvi_legendre_take(tvi_legendre *legendre, tvi_arena *arena, const tvi_system *system);
void tvi_legendre_prepare(tvi_legendre *legendre);

/* y = f(x). TVI_EDOMAIN, TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_legendre_state(tvi_legendre *legendre, double t, const double q[], const double x[],
                                            double y[]);

/* x with f(x) = y by Newton's method from the x given. Also TVI_ESINGULAR, TVI_ENOCONV; x is then undefined. */
TVI_NODISCARD tvi_status tvi_legendre_solve(tvi_legendre *legendre, double t, const double q[], const double y[],
                                            double x[]);

/* z [2n] of a curve that starts at (q, p): (q, tau v), or (q, p) of a Hamiltonian. velocity [n] is where Newton's
 * method starts, and its result; the legendre is used for a Lagrangian only. */
TVI_NODISCARD tvi_status tvi_legendre_start(tvi_legendre *legendre, const tvi_system *system, double tau, double t,
                                            const double q[], const double p[], double velocity[], double z[]);

/* One outside of an integrator, with these values of the parameters, NULL: as recorded; *memory is to be freed.
 * TVI_ENOMEM. */
TVI_NODISCARD tvi_status tvi_legendre_create(tvi_legendre *legendre, const tvi_system *system,
                                             const double parameters[], void **memory);

/* Whether the slope is regular somewhere: sets system->regular. TVI_ESINGULAR for a Lagrangian where it is not. */
TVI_NODISCARD tvi_status tvi_legendre_probe(tvi_system *system);

#endif
