/* statement.h - Declares what a system is recorded from, a statement: the user's function (V, L, H or a force), or a
 * function of the library that records a system made of another one, such as a lift. statement.c records it, and
 * brings its equations into one of the forms of tvi_form. */
#ifndef TVI_SRC_SYSTEM_STATEMENT_H
#define TVI_SRC_SYSTEM_STATEMENT_H

#include "system/system.h"

typedef struct system_statement system_statement;
typedef struct system_recording system_recording;

/* The user's statement of a system, or what the library makes of another one. Exactly one of the first six functions,
 * `copied` and `record` is set. */
struct system_statement {
    tvi_force_fn *force;
    tvi_potential_fn *potential;
    tvi_lagrangian_fn *lagrangian;
    tvi_hamiltonian_fn *hamiltonian;
    tvi_factors_fn *hamiltonian_factors;
    tvi_rates_fn *rates;
    const tvi_system *copied; /* The system that is recorded once more (tvi_system_copy). */
    const double *mass;
    void *ctx;
    /* Records a system that moves with the motion of the system `base` (lift.c, adjoint.c). */
    tvi_status (*record)(system_recording *recording, const system_statement *statement);
    const tvi_system *base;
    bool has_velocities; /* The field that `record` makes depends on velocities or momenta, too. */
    /* [parameters] The recorded values of a lift's own parameters, which belong to the first tangent vector; NULL: 0.
     */
    const double *parameter_rates;
    tvi_drive_fn *drive; /* The forces of a driven Hamiltonian or Lagrangian; NULL: there are none. */
    void *drive_ctx;
};

/* A system whose recording is open. All jets belong to its graph. */
struct system_recording {
    tvi_system *system;
    /* Inputs of the graph: coordinates; velocities or momenta; the vector r of the gradient of r.H_p, which truncated
     * nodes need; time. */
    jet *q, *v, *r, t;
    jet user_function;       /* The user's V, L or H; without a node if there is none. */
    jet *field;              /* [2n] The field, which belongs to the system. */
    jet *r_dot_H_p_gradient; /* [2n] The gradient by q and p of r.H_p, r a vector. */
    jet *field_and_hessian;  /* [2n + hessian.entry_count] The field, and then the second derivatives. */
};

/* Records a valid statement of a system with n coordinates, and creates its tapes. On failure *out is NULL. */
TVI_NODISCARD tvi_status tvi_system_record(tvi_system **out, int n, const system_statement *statement);
/* Records the gradient of r.H_p. */
TVI_NODISCARD tvi_status tvi_record_r_dot_H_p_gradient(system_recording *recording);

#endif
