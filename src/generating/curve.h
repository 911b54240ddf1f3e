/* curve.h - expands the Taylor curve at a centre (prolongation), and computes its Jacobians with respect to the centre
 * data.
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

void tvi_curve_take(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int top, tvi_jacobians jacobians);
void tvi_curve_prepare(tvi_curve *curve); /* once, when the memory is there */

tvi_combination tvi_combination_take(const tvi_curve *curve, tvi_arena *arena);
/* From weights of Q, or weights of U (which a separable system turns into weights of Q). */
void tvi_combination_set(tvi_combination *combination, const tvi_curve *curve, bool of_momentum, const double weight[]);

/* weight_k = a at^k + b from^k for k <= degree, 0 above. */
void tvi_combination_set_powers(tvi_combination *combination, const tvi_curve *curve, bool of_momentum, int degree,
                                double a, double at, double b, double from);

/* Sets tau and z. */
void tvi_curve_set(tvi_curve *curve, double tau, const double z[]);

/* Expands from z. TVI_EDOMAIN, TVI_ENONFINITE, TVI_ESINGULAR (L_vv). */
TVI_NODISCARD tvi_status tvi_curve_expand(tvi_curve *curve, double centre);

/* Factors L_vv or H_pp at the centre of the curve last expanded; a Lagrangian's expansion has done so.
 * TVI_ESINGULAR. */
TVI_NODISCARD tvi_status tvi_curve_factor_slope(tvi_curve *curve);

/* The Jacobian matrices of the curve last expanded. */
void tvi_curve_differentiate(tvi_curve *curve);

/* Returns the Jacobians that suit the system: matrices if n is small. Only separable systems have products. */
tvi_jacobians tvi_curve_jacobians_for(const tvi_system *system);

/* Returns the sweeps that a stepper runs if its curves have these Jacobians and its action has `points` nodes. */
tvi_uses tvi_curve_uses(const tvi_system *system, const tvi_options *options, int top, int points,
                        tvi_jacobians jacobians);

/* tvi_uses.emit_loops: tvi_curve_code (seeds.h), without Jacobians, with products and with matrices. */
void tvi_curve_emit_series(jet_text *text, const tvi_system *system, const tvi_options *options);
void tvi_curve_emit_products(jet_text *text, const tvi_system *system, const tvi_options *options);
void tvi_curve_emit_matrices(jet_text *text, const tvi_system *system, const tvi_options *options);

/* The natural sizes of z [2n]: sum_k |Q_k|, and sum_{k>=1} |Q_k| for tau v or sum_k |P_k| for p. */
void tvi_curve_sizes(const tvi_curve *curve, double size[]);
/* out[n], or matrix[n][2n], of a combination and of its Jacobian; the small terms first. */
void tvi_curve_sum(const tvi_curve *curve, const tvi_combination *combination, double out[]);
void tvi_curve_sum_jacobian(const tvi_curve *curve, const tvi_combination *combination, double matrix[]);
/* Sets the direction dz of the pushes that follow; then out[n] = Jacobian of the combination times dz. */
void tvi_curve_aim(tvi_curve *curve, const double dz[]);
void tvi_curve_push(const tvi_curve *curve, const tvi_combination *combination, double out[]);

/* out[2n] = sum_k (dQ_k/dz)^T seed_Q[k] + (dU_k/dz)^T seed_U[k]; seeds [top + 1][n]. seed_U may be NULL, and is
 * not read for a separable system, whose U_k = (k+1) Q_{k+1}. */
void tvi_curve_pull(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[]);

/* Once: Q and P are summed to these degrees. Then, of each curve, the sizes of movement and momentum, and of these
 * tvi_stats.tail, see tail.h; 0 where p' has one term only. */
void tvi_curve_prepare_tail(tvi_curve *curve, int q_degree, int p_degree);
void tvi_curve_measure(const tvi_curve *curve);
double tvi_curve_tail(const tvi_curve *curve);

/* More than the terms left out change the energy by, after the tail, of a step that is the curve; INFINITY where they
 * are not known. */
double tvi_curve_change(const tvi_curve *curve);

/* ---- Steps that adapt (reach.h) ---------------------------------------------------------------------------------- */

/* The largest s at which the curve, of Q and P to the tail's degrees, serves a tolerance; INFINITY where it is exact.
 */
double tvi_curve_reach(const tvi_curve *curve, double log_tolerance);

/* The same curve in s / factor: tau and its coefficients, of q and p; and in the same sweep its rise from 0 to 1, of q
 * and kappa p, [n], and what tvi_curve_measure measures. */
void tvi_curve_end_at(tvi_curve *curve, double factor, double q[], double u[]);

#endif
