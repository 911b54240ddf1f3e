/* curve.h - declares the Taylor curve at a centre and its Jacobians with respect to the centre data; steppers and
 * solvers call these functions.
 *
 * Time is scaled: t = centre + tau s, and
 *     q(t) = sum_k Q_k s^k,        p(t) = sum_k U_k s^k / kappa,
 * so that all Q_k are of one size. For a separable system kappa = tau/m, U_k = (k+1) Q_{k+1} and all coefficients are
 * in the unit of q (kappa has the sign of tau); for the others kappa = 1. The centre data z (2n numbers) are (q, tau v)
 * for a Lagrangian, otherwise (q, kappa p). */
#ifndef TVI_SRC_GENERATING_CURVE_H
#define TVI_SRC_GENERATING_CURVE_H

#include "compiled/code.h"
#include "generating/advance.h"
#include "generating/series.h"
#include "method/stepper.h"

void tvi_curve_allocate(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int top, tvi_jacobians jacobians,
                        int width);
void tvi_curve_fill_constant_tables(tvi_curve *curve); /* called once, after allocation */

tvi_combination tvi_combination_allocate(const tvi_curve *curve, tvi_arena *arena);
/* Sets a combination from weights of Q, or from weights of U (which a separable system turns into weights of Q). */
void tvi_combination_set_weights(tvi_combination *combination, const tvi_curve *curve, bool of_momentum,
                                 const double weight[]);

/* Sets weight_k = a at^k + b from^k for k <= degree, and 0 above. */
void tvi_combination_set_power_weights(tvi_combination *combination, const tvi_curve *curve, bool of_momentum,
                                       int degree, double a, double at, double b, double from);

/* Sets tau and z. */
void tvi_curve_set_time_unit_and_data(tvi_curve *curve, double tau, const double z[]);

/* Expands the curve from z. Returns TVI_EDOMAIN, TVI_ENONFINITE or TVI_ESINGULAR (L_vv). */
TVI_NODISCARD tvi_status tvi_curve_expand(tvi_curve *curve, double centre);

/* Factors L_vv or H_pp at the centre of the curve last expanded; a Lagrangian's expansion has done so. Returns
 * TVI_ESINGULAR. */
TVI_NODISCARD tvi_status tvi_curve_factor_velocity_hessian(tvi_curve *curve);

/* Computes the Jacobian matrices of the curve last expanded. */
void tvi_curve_differentiate(tvi_curve *curve);

/* Returns the Jacobians that suit the system: matrices if n is small. Only separable systems have products. */
tvi_jacobians tvi_curve_choose_jacobian_method(const tvi_system *system);

/* Returns the tape sweeps that a stepper runs if its curves have these Jacobians and its action has `points` nodes. */
tvi_used_tapes tvi_curve_find_used_sweeps(const tvi_system *system, const tvi_options *options, int top, int points,
                                          tvi_jacobians jacobians);

/* These emit tvi_curve_code (seeds.h) for tvi_used_tapes.emit_loops: without Jacobians, with products and with
 * matrices. */
void tvi_curve_emit_series(jet_text *text, const tvi_system *system, const tvi_options *options);
void tvi_curve_emit_products(jet_text *text, const tvi_system *system, const tvi_options *options);
void tvi_curve_emit_matrices(jet_text *text, const tvi_system *system, const tvi_options *options);

/* Computes the natural sizes of z [2n]: sum_k |Q_k|, and sum_{k>=1} |Q_k| for tau v or sum_k |P_k| for p. */
void tvi_curve_compute_data_sizes(const tvi_curve *curve, double size[]);
/* Computes out[n], the sum of a combination, or matrix[n][2n], its Jacobian; the small terms are added first. */
void tvi_curve_sum_combination(const tvi_curve *curve, const tvi_combination *combination, double out[]);
void tvi_curve_sum_jacobian(const tvi_curve *curve, const tvi_combination *combination, double matrix[]);
/* Sets the direction dz of the pushes that follow; a push computes out[n] = Jacobian of the combination times dz. */
void tvi_curve_set_product_direction(tvi_curve *curve, const double dz[]);
void tvi_curve_multiply_by_jacobian(const tvi_curve *curve, const tvi_combination *combination, double out[]);

/* Computes out[2n] = sum_k (dQ_k/dz)^T seed_Q[k] + (dU_k/dz)^T seed_U[k] from seeds [top + 1][n]. seed_U may be NULL,
 * and is not read for a separable system, whose U_k = (k+1) Q_{k+1}. */
void tvi_curve_multiply_by_transposes(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[]);

/* tvi_curve_prepare_tail is called once: Q and P are summed to these degrees. tvi_curve_compute_size_sums computes the
 * sizes of movement and momentum of each curve, and tvi_curve_compute_tail computes tvi_stats.tail of a single member
 * from them (tail.h); it is 0 if p' has one term only. */
void tvi_curve_prepare_tail(tvi_curve *curve, int q_degree, int p_degree);
void tvi_curve_compute_size_sums(const tvi_curve *curve);
double tvi_curve_compute_tail(const tvi_curve *curve);

/* Returns more than the terms that are left out change the energy by, for a step that is the curve, after its tail was
 * computed; INFINITY if these terms are not known. */
double tvi_curve_bound_energy_change(const tvi_curve *curve);

/* ---- Steps that adapt (reach.h) ---------------------------------------------------------------------------------- */

/* Returns the largest s at which the curve, of Q and P to the tail's degrees, serves a tolerance; INFINITY if it is
 * exact. */
double tvi_curve_estimate_usable_step(const tvi_curve *curve, double log_tolerance);

/* Writes the curve in s / factor: tau and the coefficients of q and p. The same sweep computes its rise from 0 to 1, of
 * q and kappa p, [n], and what tvi_curve_compute_size_sums measures. */
void tvi_curve_rescale_and_sum(tvi_curve *curve, double factor, double q[], double u[]);

/* These are curve_rescale_and_sum (reach.h), each compiled for one instruction set. */
typedef void tvi_rescale_and_sum_fn(tvi_curve *curve, double factor, double q[], double u[]);
tvi_rescale_and_sum_fn tvi_rescale_and_sum_base, tvi_rescale_and_sum_avx2, tvi_rescale_and_sum_avx512;
tvi_rescale_and_sum_fn *tvi_choose_rescale_and_sum(const tvi_system *system);

#endif
