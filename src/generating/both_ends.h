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
    tvi_action
        action; /* the action of this curve; the tables of the start curve's action serve the nodes of both curves */
    double *momentum_coefficients; /* [r][n] */
    double sign;                   /* the sign of the curve in a - b */
    double other_end_s;            /* the scaled time of the other end: 1 or -1 */
    tvi_combination q_rise;        /* the rise of q from this end to the other: a(1) - q0 or b(-1) - q1 */
    tvi_combination u_at_own_end;  /* the scaled momentum U_0 at this end */
    tvi_combination dense_q, dense_u;
    double *node_blend_weight; /* [points] the weight of this curve in the blend at each node: w or 1 - w */
    double *seed;              /* [r + 1][n] */
    double *action_gradient;   /* [2n] */
    /* [n][2n] the Jacobian of q_rise; the Jacobian of the other end is this plus the identity. */
    double *other_end_jacobian;
    double *multiplier;   /* [n] l or m */
    double *dz;           /* [2n] the correction of z that is applied to first order after the passes */
    tvi_lu_factor factor; /* B */
} tvi_end_curve;

typedef struct {
    const tvi_system *system;
    const tvi_options *options;
    int n, degree, points;
    bool has_momentum_terms;
    tvi_end_curve start_curve, end_curve;
    tvi_newton newton; /* the corrector; its unknowns are v0, q1, v1, scaled as the z of the curves */
    tvi_legendre legendre;
    tvi_combination q_at_end,
        velocity_at_end; /* these predict the end curve's z: q and tau v, or p, at the end of the start curve */
    double *node_position, *node_velocity, *node_momentum,
        *node_force; /* [n][points] y, v, pi and dpi/ds at the nodes (both_ends.c) */
    double *gradient_by_q, *gradient_by_v,
        *gradient_by_difference; /* [n][points] the factors of dy_i, dv_i and (da - db)_i in the action's gradient */
    double *node_row;            /* [points] */
    double *start_z;             /* [2n] */
    /* [n] a Lagrangian's velocity at the last predictor, from which the next search begins; part of the history. */
    double *velocity_guess;
    double *from_p;  /* [n] the correction p0 - p_a(0) */
    double *rise_p;  /* [n] the correction (p1 - p0) - (p_b(0) - p_a(0)) */
    double *dq, *dp; /* [n] the increments of the last step */
    double *scratch; /* [n] */
} tvi_both_ends_workspace;

/* Computes action_gradient of both curves, in defect form. Returns TVI_EDOMAIN, TVI_ENONFINITE, TVI_ESINGULAR or
 * TVI_ENOCONV. */
TVI_NODISCARD tvi_status tvi_both_ends_compute_gradient(tvi_both_ends_workspace *work, tvi_stats *stats);

#endif
