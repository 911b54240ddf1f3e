/* curve.h - declares the Taylor curve at a centre and its Jacobians with respect to the centre state; steppers and
 * solvers call these functions.
 *
 * Time is scaled: t = centre + tau s, and
 *     q(t) = sum_k Q_k s^k,        p(t) = sum_k U_k s^k / kappa,
 * so that all Q_k are of one size. For a separable system kappa = tau/m, U_k = (k+1) Q_{k+1} and all coefficients are
 * in the unit of q (kappa has the sign of tau); for other systems kappa = 1. The centre state z (2n numbers) consists
 * of the coordinates q at the centre, and of tau v for a Lagrangian, otherwise of kappa p. */
#ifndef TVI_SRC_GENERATING_CURVE_H
#define TVI_SRC_GENERATING_CURVE_H

#include "compiled/code.h"
#include "generating/series.h"
#include "method/stepper.h"

void tvi_curve_allocate(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int highest_order,
                        tvi_jacobians jacobians);
void tvi_curve_fill_constant_tables(tvi_curve *curve); /* called once, after allocation */

tvi_coefficient_combination tvi_combination_allocate(const tvi_curve *curve, tvi_arena *arena);
/* Sets a combination to sum_k weight_k Q_k, or to sum_k weight_k U_k, which becomes a combination of Q_k for a
 * separable system. */
void tvi_combination_set_weights(tvi_coefficient_combination *combination, const tvi_curve *curve, bool of_momentum,
                                 const double weight[]);

/* Sets the weights to weight_k = a s_a^k + b s_b^k for k <= degree, and to 0 above. */
void tvi_combination_set_power_weights(tvi_coefficient_combination *combination, const tvi_curve *curve,
                                       bool of_momentum, int degree, double a, double s_a, double b, double s_b);

/* Computes the curve's coefficients from its centre state; `centre` is the time at the centre. Returns TVI_EDOMAIN,
 * TVI_ENONFINITE, or TVI_ESINGULAR if L_vv is singular. */
TVI_NODISCARD tvi_status tvi_curve_expand(tvi_curve *curve, double centre);

/* Factors L_vv or H_pp at the centre of the curve last expanded. A Lagrangian does not need this call, since
 * tvi_curve_expand factors L_vv. Returns TVI_ESINGULAR. */
TVI_NODISCARD tvi_status tvi_curve_factor_velocity_hessian(tvi_curve *curve);

/* Computes the Jacobian matrices, by the centre state, of the coefficients of the curve last expanded. */
void tvi_curve_compute_jacobians(tvi_curve *curve);

/* Returns how a stepper uses Jacobians: as products for separable systems of many coordinates, and as matrices for all
 * others. */
tvi_jacobians tvi_curve_choose_jacobian_method(const tvi_system *system);

/* Returns the sweeps of the tapes that a stepper needs if its curves use their Jacobians in the way `jacobians`, and
 * its action has `points` nodes. */
tvi_tapes_of_steps tvi_curve_find_used_tapes(const tvi_system *system, const tvi_options *options, int points,
                                             tvi_jacobians jacobians);

/* Computes the natural sizes of the numbers of the centre state z [2n], relative to which their corrections are
 * measured: sum_k |Q_k|, and sum_{k>=1} |Q_k| for tau v or sum_k |P_k| for p. */
void tvi_curve_compute_centre_state_sizes(const tvi_curve *curve, double size[]);
/* Compute out[n], the sum of a combination of the curve's coefficients, and matrix[n][2n], the Jacobian of that sum by
 * the centre state; small terms are added first. */
void tvi_curve_sum_combination(const tvi_curve *curve, const tvi_coefficient_combination *combination, double out[]);
void tvi_curve_sum_combination_jacobian(const tvi_curve *curve, const tvi_coefficient_combination *combination,
                                        double matrix[]);
/* tvi_curve_set_product_direction sets the direction dz for tvi_curve_differentiate_sum_along_set_dz, which computes
 * derivative[n], the Jacobian of the combination's sum by the centre state, times dz. */
void tvi_curve_set_product_direction(tvi_curve *curve, const double dz[]);
void tvi_curve_differentiate_sum_along_set_dz(const tvi_curve *curve, const tvi_coefficient_combination *combination,
                                              double derivative[]);

/* Computes out[2n] = sum_k (dQ_k/dz)^T seed_Q[k] + (dU_k/dz)^T seed_U[k], the transposed Jacobians of the coefficients
 * times seeds [highest_order + 1][n]. seed_U may be NULL, and is not read for a separable system, whose U_k = (k+1)
 * Q_{k+1}. */
void tvi_curve_multiply_transposed_jacobians_by_seeds(tvi_curve *curve, const double seed_Q[], const double seed_U[],
                                                      double out[]);

/* tvi_curve_set_summed_degrees is called once, and sets the degrees to which Q and P are summed.
 * tvi_curve_compute_displacement_sizes computes displacement_size and momentum_size of each component.
 * tvi_curve_compute_tail computes from these sizes tvi_stats.tail (tail.h); the tail is 0 if p' has
 * one term only. */
void tvi_curve_set_summed_degrees(tvi_curve *curve, int q_degree, int p_degree);
void tvi_curve_compute_displacement_sizes(const tvi_curve *curve);
double tvi_curve_compute_tail(const tvi_curve *curve);

/* Returns an upper bound of the energy change by the terms that a plain Taylor step omits, or INFINITY if the curve has
 * too few terms for a bound. The function reads displacement_size and momentum_size, which
 * tvi_curve_compute_displacement_sizes or tvi_curve_rescale_and_sum must have computed. */
double tvi_curve_bound_energy_change(const tvi_curve *curve);

/* ---- Steps of adapted size (step_size.h) ------------------------------------------------------------------------- */

/* Returns the largest s for which the curve, truncated to the degrees of tvi_curve_set_summed_degrees, meets the
 * tolerance with this logarithm. Returns INFINITY if the last coefficients of q and of p are 0, so that the curve is
 * exact. */
double tvi_curve_estimate_largest_usable_s(const tvi_curve *curve, double log_tolerance);

/* Rescales tau and the coefficients of q and p to the time unit factor * tau. In the same sweep it computes the
 * increments dq = q(1) - q(0) and du = u(1) - u(0), [n], and the sizes of tvi_curve_compute_displacement_sizes. */
void tvi_curve_rescale_and_sum(tvi_curve *curve, double factor, double dq[], double du[]);

#endif
