/* both_ends.h - declares the workspace of the type I method with one Taylor curve from each end of the step
 * (both_ends.c), and the gradient of its action, which both_ends_nodes.c computes. */
#ifndef TVI_SRC_GENERATING_BOTH_ENDS_H
#define TVI_SRC_GENERATING_BOTH_ENDS_H

#include "generating/action.h"
#include "generating/newton.h"
#include "system/legendre.h"

/* One of the two curves: a(s), which starts at the start of the step, or b(s - 1), which starts at its end
 * (both_ends.c). */
typedef struct {
    tvi_curve curve;
    /* The action of this curve; the tables of the start curve's action serve the nodes of both curves. */
    tvi_action action;
    double *momentum_coefficients;    /* [degree][n] the coefficients P_k of the momentum */
    double sign_in_difference;        /* the sign of this curve in the difference a - b: 1 for a, -1 for b */
    double other_end_s;               /* the scaled time of the other end: 1 or -1 */
    tvi_combination q_increment;      /* q at the other end less q at this end: a(1) - q0 or b(-1) - q1 */
    tvi_combination u_at_own_end;     /* the scaled momentum U_0 at this end */
    tvi_combination dense_q, dense_u; /* the increments of q and u to one point of dense output */
    double *node_blend_weight;        /* [points] the weight of this curve in the blend at each node: w or 1 - w */
    double *seed;                     /* [degree + 1][n] the derivatives of the action by the coefficients Q_k */
    double *action_gradient;          /* [2n] the derivative of the action by z, in defect form (action.h) */
    /* [n][2n] The Jacobian of q_increment by z. With the identity added to its first n columns it is the Jacobian of q
     * at the other end. */
    double *other_end_jacobian;
    double *multiplier;   /* [n] the multiplier of the condition that the curve ends where the other one starts */
    double *unapplied_dz; /* [2n] the correction of z that is applied to first order after the passes */
    /* The factors of the Jacobian of the position at the other end by the velocity at this end. */
    tvi_lu_factor velocity_jacobian_factor;
} tvi_end_curve;

typedef struct {
    const tvi_system *system;
    const tvi_options *options;
    int n, degree, points;
    bool has_momentum_terms; /* the momentum pi is in the action (both_ends.c) */
    tvi_end_curve start_curve, end_curve;
    tvi_newton newton; /* the corrector; its unknowns are v0, q1, v1, scaled as the z of the curves */
    tvi_legendre legendre;
    /* The combinations of the start curve's coefficients that predict the centre state of the end curve: q and tau v
     * (of a Hamiltonian p) at the end of the step. */
    tvi_combination q_at_end, velocity_at_end;
    /* [n][points] Position y, velocity v, momentum pi and dpi/ds of the blend of both curves at the nodes. */
    double *node_position, *node_velocity, *node_momentum, *node_force;
    /* [n][points] The derivatives of the action by y_i, v_i and by the difference a - b of the curves at node i. */
    double *gradient_by_q, *gradient_by_v, *gradient_by_difference;
    double *series_value_at_node; /* [points] scratch: one component of a series at the nodes */
    double *start_z;              /* [2n] the centre state of the start curve */
    /* [n] a Lagrangian's velocity at the last predictor, from which the next search begins; part of the history. */
    double *velocity_guess;
    double *start_correction_p;     /* [n] the correction p0 - p_a(0) */
    double *increment_correction_p; /* [n] the correction (p1 - p0) - (p_b(0) - p_a(0)) */
    double *dq, *dp;                /* [n] the increments of the last step */
    double *scratch;                /* [n] scratch: one vector */
} tvi_both_ends_workspace;

/* Computes action_gradient of both curves, in defect form (action.h). Returns TVI_EDOMAIN, TVI_ENONFINITE,
 * TVI_ESINGULAR or TVI_ENOCONV. */
TVI_NODISCARD tvi_status tvi_both_ends_compute_action_gradient(tvi_both_ends_workspace *work, tvi_stats *stats);

#endif
