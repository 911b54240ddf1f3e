/* corrected.h - declares the Taylor curve of a step together with the small corrections that a generating function adds
 * to its ends, and the solvers of the equations for these corrections. step.c calls them in each pass.
 * A step is the curve from one end to the other plus small corrections, which make it symplectic:
 *     q0 = q- + start_correction_q,   q1 - q0 = (q+ - q-) + increment_correction_q,
 *     p0 = p- + start_correction_p,   p1 - p0 = (p+ - p-) + increment_correction_p,
 * with the states (q0, p0) and (q1, p1) at the ends of the step, and the states (q-, p-) and (q+, p+) at the curve's
 * ends. The equations of a generating function (method/descriptor.h) determine these corrections from D_z, the gradient
 * of the discrete action in defect form (action.h), and from the Jacobians of the curve's ends by its centre state z.
 * All other parts of a step are the same for all generating functions. */
#ifndef TVI_SRC_GENERATING_CORRECTED_H
#define TVI_SRC_GENERATING_CORRECTED_H

#include "generating/action.h"

typedef struct tvi_corrected_curve tvi_corrected_curve;

/* A solver of the equations A^T x = D_z, with factored Jacobian matrices (matrices.c), or without matrices, by products
 * of Jacobians with vectors (products.c). */
typedef struct tvi_end_solver {
    void (*allocate)(tvi_corrected_curve *c, tvi_arena *arena); /* allocates c->solver_memory */
    void (*begin)(tvi_corrected_curve *c);                      /* begins a step */
    /* Computes D_z from the seeds, and solves the equations; D_z becomes (x, y). The curve was expanded from z; scale
     * [2n] has the natural sizes of z. Returns TVI_ESINGULAR, TVI_ENONFINITE or TVI_ENOCONV if it fails. */
    tvi_status (*solve)(tvi_corrected_curve *c, const double z[], const double scale[], tvi_stats *stats);
    /* The corrector uses one of the next two functions; the other is NULL. `jacobian` writes J = d(q-, u-)/dz [2n][2n],
     * or returns false if the corrector may reuse the Jacobian before it; `correct` multiplies the correction by an
     * approximate J^-1. */
    bool (*jacobian)(const tvi_corrected_curve *c, double matrix[]);
    void (*correct)(tvi_corrected_curve *c, double correction[]);
} tvi_end_solver;
extern const tvi_end_solver tvi_solver_by_matrices, tvi_solver_by_products;

struct tvi_corrected_curve {
    const tvi_curve_definition *definition; /* the generating function */
    tvi_step_span span;
    tvi_curve curve;
    tvi_series_sum ends[TVI_END_SUMS]; /* the sums at the ends of the step; ends[TVI_NO_SUM] is not used */
    tvi_series_sum p_size_sum;         /* sum_k U_k */
    double *p_size;                    /* [n] sum_k |P_k| */
    double *seed_Q, *seed_U;           /* [highest_order + 1][n] of D_z (action.h) */
    double *D_z;                       /* [2n] first D_z, then the solution (x, y) */
    const tvi_end_solver *solver;
    void *solver_memory; /* tvi_matrices or tvi_residuals */
    double *start_correction_q, *start_correction_p, *increment_correction_q, *increment_correction_p; /* [n] */
};

/* Computes p_size, relative to which corrections of p are measured. */
static inline void corrected_compute_p_size(const tvi_corrected_curve *c)
{
    series_sum_add_up(&c->curve, &c->p_size_sum, true, c->p_size);
    for (int i = 0; i < c->curve.n; i++) c->p_size[i] /= fabs(c->curve.kappa[i]);
}

#endif
