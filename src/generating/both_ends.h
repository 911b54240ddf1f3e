/* both_ends.h - declares the workspace of the type I method with one Taylor curve from each end of the step
 * (both_ends.c), and the gradient of its action, which both_ends_nodes.c computes. */
#ifndef TVI_SRC_GENERATING_BOTH_ENDS_H
#define TVI_SRC_GENERATING_BOTH_ENDS_H

#include "generating/action.h"
#include "generating/newton.h"
#include "system/legendre.h"

/* This structure holds the data of one of the two curves. */
typedef struct {
    tvi_curve curve;
    tvi_action action;      /* tables of powers at the nodes; that of a evaluates the nodes of both */
    double *P;              /* [r][n] */
    double sign;            /* the sign of the curve in a - b */
    double end;             /* the scaled time of the other end: 1 or -1 */
    tvi_combination to_end; /* a(1) - q0 or b(-1) - q1 */
    tvi_combination near_u; /* U_0 */
    tvi_combination q_dense, u_dense;
    double *blend;        /* [points] w or 1 - w at the nodes */
    double *seed;         /* [r + 1][n] */
    double *R;            /* [2n] */
    double *G;            /* [n][2n] Jacobian of to_end; the identity of Q_0 is not in it */
    double *multiplier;   /* [n] l or m */
    double *dz;           /* [2n] what z lacks at the end of the passes */
    tvi_lu_factor factor; /* B */
} tvi_end_curve;

typedef struct {
    const tvi_system *system;
    const tvi_options *options;
    int n, degree, points;
    bool has_pi;
    tvi_end_curve a, b;
    tvi_newton newton; /* unknowns v0, q1, v1, scaled as the z of the curves */
    tvi_legendre legendre;
    tvi_combination q_unit, z_unit; /* the centre data of a, a unit of scaled time later */
    double *y, *v, *pi, *pi_rate;   /* [n][points] these at the nodes; pi_rate is pi. */
    double *on_q, *on_v, *apart;    /* [n][points] the factors of dy_i, dv_i and (da - db)_i */
    double *row;                    /* [points] */
    double *z;                      /* [2n] */
    double *velocity;               /* [n] the velocity of the last predictor, Lagrangian; in the history */
    double *from_p;                 /* [n] p0 - p_a(0) */
    double *rise_p;                 /* [n] p1 - p0 less p_b(0) - p_a(0) */
    double *dq, *dp;                /* [n] the increments of the last step */
    double *shift;                  /* [n] */
} tvi_both_ends_workspace;

/* Computes R of both curves, in defect form. Returns TVI_EDOMAIN, TVI_ENONFINITE, TVI_ESINGULAR or TVI_ENOCONV. */
TVI_NODISCARD tvi_status tvi_both_ends_compute_gradient(tvi_both_ends_workspace *work, tvi_stats *stats);

#endif
