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
    double *momentum_coefficients;   /* [degree][n] the coefficients P_k of the momentum */
    double sign_in_curve_difference; /* the sign of this curve in the difference a - b: 1 for a, -1 for b */
    double other_end_scaled_time;    /* the scaled time of the other end: 1 or -1 */
    /* The weights of the Q_k for the difference of q at the other end and at this end: a(1) - q0 or b(-1) - q1. */
    tvi_coefficient_combination q_increment_weights;
    /* The weights of the U_k for the scaled momentum at this end, which is U_0. */
    tvi_coefficient_combination scaled_p_at_expansion_point_weights;
    /* The weights for the increments of q and of u from this end to one point of dense output. */
    tvi_coefficient_combination dense_output_q_weights, dense_output_scaled_p_weights;
    double *node_blend_weight; /* [points] the weight of this curve in the blend at each node: w or 1 - w */
    /* [degree + 1][n] The derivatives of the action by the coefficients Q_k. */
    double *action_gradient_by_coefficients_Q;
    /* [2n] The derivative R of the action (both_ends.c) by z, the state about which this curve is expanded. R is a sum
     * over the nodes in which the residuals of the equations of motion, which nearly vanish, are factors (action.h). */
    double *action_gradient_by_z;
    /* [n][2n] The Jacobian of q at the other end less q at this end, by z. With the identity added to its first n
     * columns it is the Jacobian of q at the other end. */
    double *q_increment_jacobian;
    /* [n] The Lagrange multiplier of the condition that this curve ends where the other curve starts: l of the start
     * curve, and m of the end curve (both_ends.c). */
    double *end_condition_multiplier;
    double *last_newton_dz; /* [2n] the correction of z that is applied to first order after the passes */
    /* The factors of the Jacobian of the position at the other end by the velocity at this end. */
    tvi_lu_factor q_by_velocity_jacobian_lu;
} tvi_one_end_curve;

typedef struct {
    const tvi_system *system;
    const tvi_options *options;
    int n, degree, points;
    /* Whether the action has the terms with pi; if not, pi = 0 in the formulas of both_ends.c. */
    bool action_has_momentum_terms;
    tvi_one_end_curve start_curve, end_curve;
    tvi_newton newton; /* the corrector; its unknowns are v0, q1, v1, scaled as the z of the curves */
    tvi_legendre_transform legendre_transform;
    /* The weights of the start curve's coefficients for q and tau v (of a Hamiltonian p) at the end of the step. They
     * predict the centre state of the end curve. */
    tvi_coefficient_combination q_at_end_weights, velocity_at_end_weights;
    /* [n][points] The blend of both curves at the nodes: coordinates y, velocities v, momenta pi and dpi/ds. */
    double *q_at_nodes, *v_at_nodes, *p_at_nodes, *dp_ds_at_nodes;
    /* [n][points] The derivatives of the action by the blended coordinates y_i and velocities v_i at node i, and by the
     * difference a - b of the two curves there. If v is the derivative of the blend, the action depends on a - b also
     * through v (both_ends.c). */
    double *action_gradient_by_q, *action_gradient_by_v, *action_gradient_by_difference;
    double *series_value_at_node; /* [points] scratch: one component of a series at the nodes */
    double *start_curve_z;        /* [2n] the centre state of the start curve */
    /* [n] a Lagrangian's velocity at the last predictor, from which the next search begins; part of the history. */
    double *velocity_guess;
    double *start_correction_p;          /* [n] p0 less the momentum of the start curve there */
    double *increment_correction_p;      /* [n] p1 - p0 less the difference of the curves' momenta at the two ends */
    double *last_step_dq, *last_step_dp; /* [n] the increments of the last step */
    double *scratch;                     /* [n] scratch: one vector */
} tvi_both_ends_workspace;

/* Computes action_gradient_by_z of both curves in defect form: as a sum over the nodes in which the residuals of the
 * equations of motion, which nearly vanish on the curve, are factors (action.h). Returns TVI_EDOMAIN if the field has
 * no value at a node. The momenta that belong to a Hamiltonian's velocities are found by Newton's method. If that
 * fails, the function returns TVI_ESINGULAR for a singular H_pp at a node, TVI_ENONFINITE for a number that is not
 * finite, and otherwise TVI_ENOCONV. */
TVI_NODISCARD tvi_status tvi_both_ends_compute_action_gradient(tvi_both_ends_workspace *work, tvi_stats *stats);

#endif
