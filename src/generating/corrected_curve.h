/* corrected_curve.h - declares the Taylor curve of a step together with the small corrections that a generating
 * function adds to its ends, and the equations and solvers that compute these corrections. curve_stepper.c calls it in
 * each pass.
 *
 * A step is the curve from one end to the other plus small corrections, which make it symplectic:
 *     q0 = q- + start_correction_q,   q1 - q0 = (q+ - q-) + increment_correction_q,
 *     p0 = p- + start_correction_p,   p1 - p0 = (p+ - p-) + increment_correction_p,
 * with the states (q0, p0) and (q1, p1) at the ends of the step, and the states (q-, p-) and (q+, p+) at the curve's
 * ends. The equations of a generating function determine these corrections of the ends from D_z, the gradient of the
 * discrete action in defect form (action.h), and from the Jacobians of the curve's ends by its centre state z. All
 * other parts of a step are the same for all generating functions (curve_stepper.c). */
#ifndef TVI_SRC_GENERATING_CORRECTED_CURVE_H
#define TVI_SRC_GENERATING_CORRECTED_CURVE_H

#include "generating/seeds.h"
#include "method/descriptor.h"

struct tvi_corrected_curve;
/* A solver of the equations A^T x = D_z, with factored Jacobian matrices (matrices.c), or without matrices, by products
 * of Jacobians with vectors (products.c). */
typedef struct tvi_end_correction_solver {
    /* Allocates the memory of the solver, corrected->solver_data. */
    void (*allocate)(struct tvi_corrected_curve *corrected, tvi_arena *arena);
    /* Begins a step: it discards the factors and guesses of the step before. */
    void (*begin)(struct tvi_corrected_curve *corrected);
    /* Solves the equations of the generating function (method/closing.h); gradient_then_solution becomes (x, y).
     * corrected->curve was expanded from the unknowns z; scale [2n] has the natural sizes of z. Returns TVI_ESINGULAR,
     * TVI_ENONFINITE or TVI_ENOCONV if it fails. */
    tvi_status (*solve)(struct tvi_corrected_curve *corrected, const double z[], const double scale[],
                        tvi_stats *stats);
    /* The corrector uses one of the next two functions; the other is NULL. `jacobian` writes J = d(q-, u-)/dz [2n][2n],
     * or returns false if the corrector may reuse the Jacobian before it; `correct` multiplies the correction by an
     * approximate J^-1. */
    bool (*jacobian)(const struct tvi_corrected_curve *corrected, double matrix[]);
    void (*correct)(struct tvi_corrected_curve *corrected, double correction[]);
} tvi_end_correction_solver;
extern const tvi_end_correction_solver tvi_solver_by_matrices;

typedef struct tvi_corrected_curve {
    const tvi_system *system;
    int n;
    tvi_step_span span; /* the ends of the step in scaled time */
    tvi_curve curve;
    tvi_coefficient_combination ends[TVI_END_SUMS]; /* the sums at the ends of the step; [TVI_NO_SUM] is not used */
    /* The degree to which the momentum is summed. */
    int p_degree;
    /* [n] The sum of |P_k| over all orders k, with P_k the coefficient of s^k in the momentum.
     * momentum_term_abs_sum_weights are the weights of |U_k| in |kappa| times this sum. */
    double *momentum_term_abs_sum;
    tvi_coefficient_combination momentum_term_abs_sum_weights;
    const tvi_curve_definition *definition; /* the generating function */
    /* [highest_order + 1][n] The derivatives of the discrete action, in defect form, by the coefficients Q_k of the
     * position and U_k of the scaled momentum: D_z = sum_k (dQ_k/dz)^T (those by Q_k) + (dU_k/dz)^T (those by U_k). */
    double *action_gradient_by_coefficients_Q, *action_gradient_by_coefficients_U;
    double *gradient_then_solution; /* [2n] first D_z, then the solution of the equations */
    const tvi_end_correction_solver *solver;
    void *solver_data; /* the memory of the solver: tvi_jacobian_factors or tvi_conjugate_residuals */
    /* [n] The corrections of the start of the step and of its increments (see the head of this file). */
    double *start_correction_q, *start_correction_p, *increment_correction_q, *increment_correction_p;
} tvi_corrected_curve;

/* Computes the corrections of the ends from the solution (x, y) in gradient_then_solution, multiplied by
 * the factors of the method. */
static inline void ends_compute_corrections_from_solution(const tvi_corrected_curve *corrected)
{
    const tvi_curve_end_correction_factors *factors = &corrected->definition->end_correction_factors;
    double *restrict start_correction_q = corrected->start_correction_q, *restrict increment_correction_q =
                                                                             corrected->increment_correction_q;
    double *restrict start_correction_p = corrected->start_correction_p, *restrict increment_correction_p =
                                                                             corrected->increment_correction_p;
    for (int i = 0; i < curve_dimension(&corrected->curve); i++) {
        const double x = corrected->gradient_then_solution[i],
                     y = corrected->gradient_then_solution[curve_dimension(&corrected->curve) + i],
                     of_q = corrected->curve.momentum_scale_factor[i] * y;
        start_correction_q[i] = factors->start_q_correction_factor * of_q;
        increment_correction_q[i] = factors->increment_q_correction_factor * of_q;
        start_correction_p[i] = factors->start_p_correction_factor[0] * x + factors->start_p_correction_factor[1] * y;
        increment_correction_p[i] =
            factors->increment_p_correction_factor[0] * x + factors->increment_p_correction_factor[1] * y;
    }
}

/* Computes momentum_term_abs_sum, the sums of the magnitudes of the momenta's terms, relative to which corrections of p
 * are measured. */
static inline void ends_compute_momentum_term_abs_sums(const tvi_corrected_curve *corrected)
{
    curve_sum_combination_with_adder(tvi_add_weighted_magnitudes, &corrected->curve,
                                     &corrected->momentum_term_abs_sum_weights, corrected->momentum_term_abs_sum);
    for (int i = 0; i < curve_dimension(&corrected->curve); i++)
        corrected->momentum_term_abs_sum[i] /= fabs(corrected->curve.momentum_scale_factor[i]);
}

#endif
