/* legendre.h - Transforms velocities to momenta and back at a point, by the Legendre transform of the system.
 * Energies and the starts of curves call it. */
#ifndef TVI_SRC_SYSTEM_LEGENDRE_H
#define TVI_SRC_SYSTEM_LEGENDRE_H

#include "algebra/linear.h"
#include "system/roundoff.h"
#include "system/system.h"

/* The transform y = f(x) that the system defines: p = L_v(q, v) of a Lagrangian with x = v, v = H_p(q, p) of a
 * Hamiltonian with x = p, and p = M v of a separable system with x = v. */
typedef struct {
    const tvi_system *system;
    /* The block of the field at one point, with q and the argument x as inputs. */
    double *field_block;
    double *tangents; /* [slots][n] The derivatives of all slots of the block by x. */
    /* [n] Scratch: Newton's correction of x, the x that is tried, and f(x). */
    double *correction, *trial, *transform_of_x;
    tvi_lu_factor jacobian_factor;   /* The factored Jacobian matrix dy/dx = L_vv or H_pp. */
    tvi_roundoff_estimator roundoff; /* The memory for estimates of the field's roundoff. */
} tvi_legendre_transform;

void tvi_legendre_allocate(tvi_legendre_transform *legendre, tvi_arena *arena, const tvi_system *system);

/* Computes y = f(x). Returns TVI_EDOMAIN or TVI_ENONFINITE if f has no finite value. */
TVI_NODISCARD tvi_status tvi_legendre_evaluate(tvi_legendre_transform *legendre, double t, const double q[],
                                               const double x[], double y[]);

/* Solves f(x) = y for x by Newton's method, which starts from the x that is passed in. Returns TVI_EDOMAIN,
 * TVI_ENONFINITE, TVI_ESINGULAR or TVI_ENOCONV if it fails; x is then undefined. */
TVI_NODISCARD tvi_status tvi_legendre_solve(tvi_legendre_transform *legendre, double t, const double q[],
                                            const double y[], double x[]);

/* Computes the coefficients z = initial_coefficients [2n] with which a Taylor curve starts at (q, p): (q, tau v) with
 * the velocity v and the time_unit tau of the curve, or (q, p) for a Hamiltonian. velocity [n] is the first iterate of
 * Newton's method, and becomes its result v. Only Lagrangians use `legendre` and `velocity`. */
TVI_NODISCARD tvi_status tvi_legendre_compute_start(tvi_legendre_transform *legendre, const tvi_system *system,
                                                    double time_unit, double t, const double q[], const double p[],
                                                    double velocity[], double initial_coefficients[]);

/* Creates a transform outside of an integrator, with these values of the parameters; NULL stands for those in the
 * recording. The caller frees *memory. Returns TVI_ENOMEM if memory is lacking. */
TVI_NODISCARD tvi_status tvi_legendre_create(tvi_legendre_transform *legendre, const tvi_system *system,
                                             const double parameters[], void **memory);

/* Sets system->is_regular if dy/dx is regular at one of several points. Returns TVI_ESINGULAR if L_vv of a Lagrangian
 * is singular at all of them. */
TVI_NODISCARD tvi_status tvi_legendre_test_regularity(tvi_system *system);

#endif
