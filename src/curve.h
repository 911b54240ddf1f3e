/* curve.h - prolongation: the Taylor curve at a centre, and its Jacobians with respect to the centre data.
 *
 * Time is scaled: t = centre + tau s, q(t) = g(s) = sum_{k=0}^{N} C_k s^k, so that C_k = q^(k) tau^k / k! are all of one
 * size. The centre data are z = (C_0, C_1), with C_1 = tau v; both have the unit of q. */
#ifndef TVI_SRC_CURVE_H
#define TVI_SRC_CURVE_H

#include "arena.h"
#include "system.h"

typedef struct {
    const tvi_system *system;
    int n, degree;
    double centre, tau;
    double *x;  /* block of the force's series: C_k are its inputs at order k, see tvi_curve_coefficient */
    double *dx; /* the same for CURVE_LANES directions */
    double *dC; /* [degree + 1][n][2n]: dC_k / dz */
} tvi_curve;

/* with_jacobians: whether tvi_curve_differentiate will be called. */
void tvi_curve_take(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int degree, bool with_jacobians);
void tvi_curve_prepare(tvi_curve *curve); /* once, when the memory is there */

/* C_k [n], k <= degree. */
static inline double *tvi_curve_coefficient(const tvi_curve *curve, int k)
{
    return curve->x + (size_t)k * (size_t)curve->system->force_series->slots;
}

/* Expands from C_0, C_1 [n], which must be set. TVI_EDOMAIN, TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_curve_expand(tvi_curve *curve, double centre, double tau);

/* dC of the curve last expanded. */
void tvi_curve_differentiate(tvi_curve *curve);

/* out[n] = sum_k weight_k C_k and matrix[n][2n] = sum_k weight_k dC_k/dz, the small terms first. */
void tvi_curve_sum(const tvi_curve *curve, const double weight[], double out[]);
void tvi_curve_sum_jacobian(const tvi_curve *curve, const double weight[], double matrix[]);

/* out[n] = sum_k weight_k (dC_k/dz) dz. */
void tvi_curve_push(const tvi_curve *curve, const double weight[], const double dz[], double out[]);

/* out[2n] = sum_k (dC_k/dz)^T seed_k, seed [degree + 1][n]: the gradient of any scalar of the curve. */
void tvi_curve_pull(const tvi_curve *curve, const double seed[], double out[]);

#endif
