/* action.h - the discrete action of a curve and its gradient.
 *
 * S(z) = h sum_i b_i L(q_i, v_i, t_i) with L = v^T M v / 2 - V. Integrating the kinetic part by parts leaves the defect
 * form (docs/method.md section 4, I-defect): S_z = G+^T p+ - G-^T p- + D_z, where D_z is small, because on the curve
 * the Euler-Lagrange equations nearly hold. */
#ifndef TVI_SRC_ACTION_H
#define TVI_SRC_ACTION_H

#include "curve.h"

/* Where the step's ends lie in the scaled time of a curve, and tau as a multiple of h: start 0, 1, 1; midpoint -1, 1, 1/2. */
typedef struct {
    double from, to, tau;
} tvi_span;

typedef struct {
    int degree, points;
    double *s;            /* [points] the nodes in scaled time */
    double *weight;       /* [points], sum = to - from */
    double *power;        /* [degree + 1][points]: s_i^k */
    double *node_power;   /* the same as used for q_i, 0 where the node rule leaves the term out */
    double *kinetic;      /* [degree + 1][degree + 1]: j (j+k-1) (error of the quadrature for s^(j+k-2)), NULL: all 0 */
    double *x;            /* block of the force's values at the nodes */
    double *defect;       /* [n][points]: w_i tau (F(q_i) - M g''_i / tau^2) */
    double *curvature;    /* [points] scratch: one component of g'' */
} tvi_action;

/* Fills the tables of an action; everything in the options is resolved. */
void tvi_action_take(tvi_action *action, tvi_arena *arena, const tvi_system *system, const tvi_options *options);
void tvi_action_prepare(tvi_action *action, const tvi_system *system, const tvi_options *options, tvi_span span);

/* seed[degree + 1][n] with D_z = sum_k (dC_k/dz)^T seed_k for the curve; one force value at each node. TVI_EDOMAIN,
 * TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_action_seed(tvi_action *action, const tvi_curve *curve, double seed[]);

#endif
