/* adjoint.h - Declares the adjoint system of a system: the system itself, and the multipliers a of its equations x' =
 * f(x, c, t), which move as a' = -f_x^T a (docs/method.md section 13). Along a run a is the derivative of what the run
 * told by its state x; the integral of a.f_c is the derivative by the parameters c. src/run/gradient.c makes its steps.
 */
#ifndef TVI_SRC_SYSTEM_ADJOINT_H
#define TVI_SRC_SYSTEM_ADJOINT_H

#include "system/integrand.h"

/* The adjoint system of a system that is stepped, with n coordinates, and the user's P parameters. */
typedef struct tvi_adjoint {
    /* The system and its multipliers, in 2n coordinates. Its form, coordinates and momenta:
     *     of a separable system  separable   (q, w)   (p, r)      w = a_p, r = -a_q
     *     of a Lagrangian        Lagrangian  (q, w)   (r, p)
     *     of all others          rates       (q, p)   (a_q, a_p)
     * With running integrals that of a separable system is one of rates, too. The derivatives lambda_k of the loss by
     * these integrals are its parameters from P on. */
    tvi_system *lift;
    /* Computes (a.f)_c and then, if `lift` depends on the time, (a.f)_t: P + 1 outputs, of the coordinates of the lift,
     * then, unless it is separable, its velocities or momenta, and then the time if it is used. */
    jet_tape *integrands;
    /* Computes H_c [P] from x, the inputs of a Hamiltonian of the system; NULL: the system is no Hamiltonian, or has no
     * parameters. */
    jet_tape *energy_by_parameters;
} tvi_adjoint;

/* Creates the adjoint of what is stepped of a system without constraints, with the integrands of running integrals. */
TVI_NODISCARD tvi_status tvi_adjoint_create(tvi_adjoint **out, const tvi_system *system, int integral_count,
                                            const tvi_integrand integrands[]);
/* Returns the adjoint without integrals. It is recorded once, and kept with what is stepped, also if several threads
 * ask for it. */
TVI_NODISCARD tvi_status tvi_adjoint_of(const tvi_system *system, const tvi_adjoint **out);
void tvi_adjoint_free(tvi_adjoint *adjoint);

/* The places of x = (q, p) and of a = (a_q, a_p) in the state of the lift: `index` counts its coordinates and then,
 * from 2n on, its momenta. The element there is `sign` times that of a. */
typedef struct {
    int q, p, a_q, a_p; /* the first index of each */
    double sign_of_a_q;
} tvi_adjoint_layout;
tvi_adjoint_layout tvi_adjoint_layout_of(const tvi_adjoint *adjoint);

#endif
