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
#include "method/closing.h"

/* Names one half of the columns of a Jacobian matrix [n][2n] by the centre state z: the first n columns, which belong
 * to the coordinates, or the last n, which belong to the velocities or the momenta. */
typedef enum { TVI_FIRST_COLUMNS, TVI_LAST_COLUMNS } tvi_column_half;

/* The linear equations A^T x = D_z for the corrections of the ends, with the gradient D_z of the action by the centre
 * state z. A is made of Jacobians by z of weighted sums of the curve's coefficients, such as the curve's end: it is an
 * n x n half of one of them, or it consists of two, n x 2n each, one above the other. */
typedef struct {
    /* The weighted sums whose Jacobians form A; lower_jacobian_combination is NULL if A is half of one Jacobian. */
    const tvi_coefficient_combination *upper_jacobian_combination, *lower_jacobian_combination;
    tvi_column_half jacobian_half_used_as_equation_matrix; /* if A is an n x n block of the Jacobian: its columns */
} tvi_end_correction_equations;

/* A solver of the equations A^T x = D_z, with factored Jacobian matrices (matrices.c), or without matrices, by products
 * of Jacobians with vectors (products.c). The functions tvi_correct_ends_fn of the generating functions are the same
 * for both solvers. */
typedef struct tvi_end_correction_solver {
    /* Allocates the memory of the solver, corrected->solver_data. */
    void (*allocate)(struct tvi_corrected_curve *corrected, tvi_arena *arena);
    /* Begins a step: it discards the factors and guesses of the step before. */
    void (*begin)(struct tvi_corrected_curve *corrected);
    /* Computes the corrections that the equations of the generating function add to the ends of the Taylor curve.
     * corrected->curve was expanded from the unknowns z; scale [2n] has the natural sizes of z. */
    tvi_status (*compute_corrections)(struct tvi_corrected_curve *corrected, const double z[], const double scale[],
                                      tvi_stats *stats);
    /* Solves the equations A^T x = D_z, with D_z in gradient_then_solution [2n]. If A has 2n rows, the solution x
     * replaces D_z. If A is an n x n block of a Jacobian J [n][2n], x replaces the half of D_z that belongs to the
     * columns of this block (jacobian_half_used_as_equation_matrix). The other half of D_z is then replaced by its
     * residual D_z - K^T x, where K is the other n x n block of J. Returns TVI_ESINGULAR, TVI_ENONFINITE or TVI_ENOCONV
     * if it fails. */
    tvi_status (*solve)(struct tvi_corrected_curve *corrected, const tvi_end_correction_equations *equations);
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
    /* The weights of the coefficients Q_k whose sums are q- (at the start), q+ (at the end), q+ - q-, and (end_s q- -
     * start_s q+)/(end_s - start_s), with the ends of the span in scaled time. The last sum has no term in Q_1; it is
     * the mean of q- and q+ if the curve is expanded at the midpoint. */
    tvi_coefficient_combination q_at_start_weights, q_at_end_weights, q_increment_weights, q_mean_weights;
    /* The weights of the coefficients U_k for the same four sums of the scaled momentum u = kappa p. */
    tvi_coefficient_combination scaled_p_at_start_weights, scaled_p_at_end_weights, scaled_p_increment_weights,
        scaled_p_mean_weights;
    /* The degree to which the momentum is summed. */
    int p_degree;
    /* [n] The sum of |P_k| over all orders k, with P_k the coefficient of s^k in the momentum.
     * momentum_term_abs_sum_weights are the weights of |U_k| in |kappa| times this sum. */
    double *momentum_term_abs_sum;
    tvi_coefficient_combination momentum_term_abs_sum_weights;
    /* Computes the corrections by the equations of the generating function. */
    tvi_correct_ends_fn *solve_end_corrections;
    /* Solving the linear equations of the generating function gives two vectors, x and y, of n numbers each. These are
     * the factors by which x and y are multiplied in the sums that are the corrections (closing.h). */
    const tvi_curve_end_correction_factors *end_correction_factors;
    /* [highest_order + 1][n] The derivatives of the discrete action, in defect form, by the coefficients Q_k of the
     * position and U_k of the scaled momentum: D_z = sum_k (dQ_k/dz)^T (those by Q_k) + (dU_k/dz)^T (those by U_k). */
    double *action_gradient_by_coefficients_Q, *action_gradient_by_coefficients_U;
    double *gradient_then_solution; /* [2n] first D_z, then the solution of the equations */
    const tvi_end_correction_solver *solver;
    void *solver_data; /* the memory of the solver: tvi_jacobian_factors or tvi_conjugate_residuals */
    /* [n] The corrections of the start of the step and of its increments (see the head of this file). */
    double *start_correction_q, *start_correction_p, *increment_correction_q, *increment_correction_p;
} tvi_corrected_curve;

/* Returns the combination whose Jacobian is J2 in the equations of tvi_solve_end_corrections_by_mean_q_jacobian: the
 * mean of the scaled momenta u- and u+ if end_correction_factors->uses_mean_momentum is true, otherwise the difference
 * q+ - q-. */
static inline const tvi_coefficient_combination *ends_get_weights_of_lower_jacobian_rows(const tvi_corrected_curve *c)
{
    return c->end_correction_factors->uses_mean_momentum ? &c->scaled_p_mean_weights : &c->q_increment_weights;
}

/* Solves [J1; J2]^T (x, y) = D_z, with J1 the Jacobian of the mean of q- and q+ (q_mean_weights) and J2 that of
 * ends_get_weights_of_lower_jacobian_rows, and computes the corrections from (x, y) by end_correction_factors. */
tvi_correct_ends_fn tvi_solve_end_corrections_by_mean_q_jacobian;

/* Solves J^T x = D_z in half of the rows: J is the n x n block of the combination's Jacobian with the columns
 * column_half, and D_z the same half of the gradient. In gradient_then_solution x replaces this half. The other half
 * becomes the residual of the other rows, D_z - K^T x with the other block K of the Jacobian. Computes the corrections
 * from both halves (x, y) by end_correction_factors. */
TVI_NODISCARD tvi_status tvi_solve_end_corrections_by_jacobian_block(tvi_corrected_curve *corrected,
                                                                     const tvi_coefficient_combination *combination,
                                                                     tvi_column_half column_half);

/* Computes the corrections of the ends from the solution (x, y) in gradient_then_solution, multiplied by
 * end_correction_factors. */
static inline void ends_compute_corrections_from_solution(const tvi_corrected_curve *corrected)
{
    const tvi_curve_end_correction_factors *factors = corrected->end_correction_factors;
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
