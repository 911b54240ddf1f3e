/* curve_step.h - makes the fast-path step of a method that expands one Taylor curve, and computes the parts of all
 * other steps of such a method. The fast-path step is the common case of a whole step, whose passes converge as usual.
 * It has no fallbacks, such as row exchanges or Jacobians by differences. If a step needs a fallback, the fast-path
 * step reports failure, and curve_stepper.c makes the step. curve_stepper.c and fast_path.c call this file. */
#ifndef TVI_SRC_GENERATING_CURVE_STEP_H
#define TVI_SRC_GENERATING_CURVE_STEP_H

#include "algebra/linear_small.h"
#include "generating/curve_stepper.h"
#include "generating/orders.h"
#include "generating/matrices.h"

/* Computes z, the state at the centre, as the value of the curve that was expanded at the start of the step. */
static inline void step_compute_state_at_centre(const tvi_curve_workspace *work, double z[])
{
    const tvi_corrected_curve *corrected = &work->corrected_curve;
    CURVE_CALL(sum_combination, &corrected->curve, &work->q_at_centre_weights, z);
    CURVE_CALL(sum_combination, &corrected->curve, &work->velocity_at_centre_weights,
               z + curve_dimension(&corrected->curve));
}

/* Computes the natural sizes of the unknowns, by which their corrections are measured. A curve of degree 0 or 1 from a
 * state of rest has size 0. For these degrees the sizes of the last corrections of the ends are added. The sizes of a
 * Lagrangian's unknowns stay unchanged, since these corrections have another unit. */
static inline void step_compute_unknown_scales(const tvi_corrected_curve *corrected, double scale[])
{
    const tvi_curve *curve = &corrected->curve;
    const int numbers = curve_dimension(curve);
    CURVE_CALL(compute_centre_state_sizes, curve, scale);
    if (curve_highest_order(curve) > 1 || curve_system_form(&corrected->curve) == TVI_LAGRANGIAN) return;
    for (int i = 0; i < numbers; i++) {
        const double kappa = fabs(corrected->curve.momentum_scale_factor[i]);
        scale[i] += fabs(corrected->start_correction_q[i]) + fabs(corrected->increment_correction_q[i]);
        scale[numbers + i] +=
            kappa * (fabs(corrected->start_correction_p[i]) + fabs(corrected->increment_correction_p[i]));
    }
}

/* Computes the residual r = (q- + start_correction_q - q0, kappa (p- + start_correction_p - p0)) of the corrector, the
 * difference between the corrected start of the curve and the state (q0, p0). Small differences are added first. */
static inline void step_compute_residual(const tvi_curve_workspace *work, const tvi_step_origin *origin,
                                         double *restrict r)
{
    const tvi_corrected_curve *corrected = &work->corrected_curve;
    const int n = curve_dimension(&corrected->curve);
    const double *Q0 = tvi_curve_position_coefficients(&corrected->curve, 0);
    CURVE_CALL(sum_combination, &corrected->curve, &work->q_start_minus_centre_weights, r);
    CURVE_CALL(sum_combination, &corrected->curve, &corrected->scaled_p_at_start_weights, r + n);
    for (int i = 0; i < n; i++) {
        const double kappa = corrected->curve.momentum_scale_factor[i];
        r[i] += (Q0[i] - origin->q[i]) + (corrected->start_correction_q[i] - origin->q_low[i]);
        r[n + i] = (r[n + i] - kappa * origin->p[i]) + kappa * (corrected->start_correction_p[i] - origin->p_low[i]);
    }
}

/* Computes out, the sum of the combination at the centre state z + dz to first order in dz, with dz the last correction
 * of the passes, which has not been added to z. */
static inline void step_sum_combination_to_first_order_in_dz(const tvi_curve_workspace *work,
                                                             const tvi_coefficient_combination *combination,
                                                             double out[])
{
    CURVE_CALL(sum_combination, &work->corrected_curve.curve, combination, out);
    if (!work->has_symplectic_end_corrections) return;
    CURVE_CALL(differentiate_sum_along_set_dz, &work->corrected_curve.curve, combination, work->scratch);
    for (int i = 0; i < curve_dimension(&work->corrected_curve.curve); i++) out[i] += work->scratch[i];
}

/* Computes the increments dq = (q+ - q-) + increment_correction_q and dp = (p+ - p-) + increment_correction_p. For
 * increments to a point within the step (dense output), q_increment_weights and scaled_p_increment_weights end there,
 * and correction_fraction of the corrections is added. */
static inline void step_compute_increments(const tvi_curve_workspace *work,
                                           const tvi_coefficient_combination *q_increment_weights,
                                           const tvi_coefficient_combination *scaled_p_increment_weights,
                                           double correction_fraction, double dq[], double dp[])
{
    const tvi_corrected_curve *corrected = &work->corrected_curve;
    step_sum_combination_to_first_order_in_dz(work, q_increment_weights, dq);
    step_sum_combination_to_first_order_in_dz(work, scaled_p_increment_weights, dp);
    for (int i = 0; i < curve_dimension(&corrected->curve); i++) {
        dp[i] /= corrected->curve.momentum_scale_factor[i];
        if (!work->has_symplectic_end_corrections) continue;
        dq[i] += correction_fraction * corrected->increment_correction_q[i];
        dp[i] += correction_fraction * corrected->increment_correction_p[i];
    }
}

/* Stores the velocity at the end of a Lagrangian's curve, from which the next step searches its initial velocity. */
static inline void step_store_end_velocity(const tvi_curve_workspace *work)
{
    const tvi_curve *curve = &work->corrected_curve.curve;
    if (curve_system_form(curve) != TVI_LAGRANGIAN) return;
    CURVE_CALL(sum_combination, curve, &work->scaled_end_velocity_weights, work->velocity_guess);
    for (int i = 0; i < curve_dimension(curve); i++) work->velocity_guess[i] /= curve->time_unit;
}

/* Computes the increments of the step, and stores a Lagrangian's velocity at the end. Returns the tail. */
static inline double step_compute_increments_and_tail(const tvi_curve_workspace *work, double dq[], double dp[])
{
    const tvi_curve *curve = &work->corrected_curve.curve;
    step_compute_increments(work, &work->corrected_curve.q_increment_weights,
                            &work->corrected_curve.scaled_p_increment_weights, 1, dq, dp);
    step_store_end_velocity(work);
    CURVE_CALL(compute_displacement_sizes, curve);
    return CURVE_CALL(compute_tail, curve);
}

/* ---- A whole step ------------------------------------------------------------------------------------------------ */

/* The functions that a fast-path step calls: they expand the curve, without and with its Jacobians, and compute the
 * seeds of the action's gradient. The seeds are not checked to be finite. */
typedef struct {
    tvi_status (*expand)(tvi_curve *curve), (*expand_with_tangents)(tvi_curve *curve);
    tvi_status (*compute_seeds)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[]);
} fast_path_expansion_and_seed_functions;

/* Factors new Jacobians: those of the generating function's equations, and that of the corrector if it was renewed.
 * Rows of one unit are scaled together. In two cases the rows of the second half have another unit than those of the
 * first: in a Hamiltonian's equations, if the second equations are of coordinates, and in a Lagrangian's corrector.
 * Returns false if the factors need row exchanges. */
static inline bool step_factor_jacobians(tvi_curve_workspace *work, const double z[], tvi_stats *stats)
{
    const tvi_corrected_curve *corrected = &work->corrected_curve;
    const tvi_form form = curve_system_form(&corrected->curve);
    const int n = curve_dimension(&corrected->curve), size = 2 * n;
    const bool uses_momenta = corrected->end_correction_factors->uses_mean_momentum;
    tvi_lu_factor *full = &matrices_get_factors(corrected)->full_jacobian_factor, *back = &work->newton.factor;
    matrices_record_z_of_jacobians(corrected, z);
    matrices_stack_combination_jacobians(corrected, &corrected->q_mean_weights,
                                         ends_get_weights_of_lower_jacobian_rows(corrected), full->lu);
    const bool is_renewed = matrices_renew_corrector_jacobian(corrected, back->lu);
    stats->factorisations += 1 + is_renewed;
    bool is_safe = linear_unpivoted_factor_in_place(size, form != TVI_HAMILTONIAN || uses_momenta ? size : n, full);
    if (is_renewed) is_safe &= linear_unpivoted_factor_in_place(size, form != TVI_LAGRANGIAN ? size : n, back);
    return is_safe;
}

/* Computes the corrections of the unknowns in one pass, but does not add them. Returns false if the pass failed. */
static inline bool step_run_corrector_pass(tvi_curve_workspace *work,
                                           const fast_path_expansion_and_seed_functions *functions,
                                           const tvi_step_origin *origin, bool is_first, tvi_stats *stats)
{
    tvi_corrected_curve *corrected = &work->corrected_curve;
    tvi_newton *newton = &work->newton;
    const int size = 2 * curve_dimension(&corrected->curve);
    double *x = newton->x, *r = newton->correction;
    const bool is_due = matrices_are_jacobians_due(corrected, x, newton->scale);
    curve_set_centre_state(&corrected->curve, x);
    if ((is_due ? functions->expand_with_tangents : functions->expand)(&corrected->curve) != TVI_OK) return false;
    if (functions->compute_seeds(&work->action, &corrected->curve, corrected->action_gradient_by_coefficients_Q,
                                 corrected->action_gradient_by_coefficients_U) != TVI_OK)
        return false;
    if (is_due && !step_factor_jacobians(work, x, stats)) return false;
    CURVE_CALL(multiply_transposed_jacobians_by_seeds, &corrected->curve, corrected->action_gradient_by_coefficients_Q,
               corrected->action_gradient_by_coefficients_U, corrected->gradient_then_solution);
    linear_unpivoted_solve_transposed(size, &matrices_get_factors(corrected)->full_jacobian_factor,
                                      corrected->gradient_then_solution);
    ends_compute_corrections_from_solution(corrected);
    step_compute_residual(work, origin, r);
    if (is_first) {
        step_compute_unknown_scales(corrected, newton->scale);
        newton_raise_scales_of_small_unknowns(newton);
    }
    for (int i = 0; i < size; i++) r[i] = -r[i];
    linear_unpivoted_solve(size, &newton->factor, r);
    return true;
}

/* Runs passes of the corrector until they have converged. Returns their number, or 0 if the step is left to
 * curve_stepper.c, for example because a number is not finite. */
static inline int step_run_corrector_passes(tvi_curve_workspace *work,
                                            const fast_path_expansion_and_seed_functions *functions,
                                            const tvi_step_origin *origin, tvi_stats *stats)
{
    const tvi_newton *newton = &work->newton;
    tvi_newton_convergence_record record;
    tvi_newton_begin_passes(&record, *newton->max_contraction_ratio_growth, &newton->rules,
                            newton->confirms_convergence_by_extra_pass);
    matrices_discard_factors(&work->corrected_curve);
    for (int count = 1; count <= newton->rules.per_unknown_correction_rule.max_passes; count++) {
        if (!step_run_corrector_pass(work, functions, origin, count == 1, stats)) return 0;
        const tvi_correction_sizes sizes = newton_measure_corrections(newton, newton->scale);
        const tvi_passes_verdict verdict = isfinite(sizes.largest_relative_correction)
                                               ? tvi_newton_judge_pass(&record, &newton->rules, &sizes)
                                               : TVI_PASSES_STUCK;
        if (verdict == TVI_PASSES_STUCK) return 0;
        if (verdict == TVI_PASSES_MAY_END) {
            *newton->max_contraction_ratio_growth =
                tvi_larger(*newton->max_contraction_ratio_growth, record.contraction_ratio_growth);
            stats->residual = sizes.largest_relative_correction;
            return count;
        }
        for (int i = 0; i < newton->unknown_count; i++) newton->x[i] += newton->correction[i];
    }
    return 0;
}

/* Finds the velocity of a Lagrangian that belongs to the momentum, as accurately as predictors need it. Newton's method
 * begins with the velocity at the end of the last step. Returns true if it has converged within a few corrections. */
static inline bool step_try_to_find_velocity(tvi_curve_workspace *work, const double p[], double v[])
{
    tvi_curve *curve = &work->corrected_curve.curve;
    const int n = curve_dimension(curve);
    double largest = INFINITY, size = 0;
    for (int i = 0; i < n; i++) v[i] = work->velocity_guess[i];
    for (int count = 0; count < VELOCITY_MAX_CORRECTIONS && !(largest <= VELOCITY_MAX_CORRECTION * size); count++) {
        if (orders_expand_lagrangian_order(curve, 0) != TVI_OK) return false;
        for (int i = 0; i < n; i++) curve->velocity_right_sides[i] = p[i] - tvi_curve_field_output(curve, 0, n + i);
        orders_solve_with_velocity_hessian(curve, 1, curve->velocity_right_sides, work->scratch);
        largest = size = 0;
        for (int i = 0; i < n; i++) {
            v[i] += work->scratch[i];
            largest = tvi_larger(fabs(work->scratch[i]), largest);
            size = tvi_larger(fabs(v[i]), size);
        }
    }
    return largest <= VELOCITY_MAX_CORRECTION * size;
}

/* Sets the centre state of the curve to the start of the step. Returns false if a Lagrangian's velocity was not found
 * from its momentum. */
static inline bool step_set_centre_state_to_start(tvi_curve_workspace *work, const tvi_step_origin *origin, double z[])
{
    tvi_curve *curve = &work->corrected_curve.curve;
    const int n = curve_dimension(curve);
    for (int i = 0; i < n; i++) {
        z[i] = origin->q[i];
        z[n + i] = curve->momentum_scale_factor[i] * origin->p[i];
    }
    curve_set_centre_state(curve, z);
    curve_set_centre_time(curve, origin->t, origin->t_low, 0);
    if (curve_system_form(curve) != TVI_LAGRANGIAN) return true;
    return step_try_to_find_velocity(work, origin->p, tvi_curve_field_inputs_of_order(curve, 0) + n);
}

/* Makes the step if its passes converge as usual, for the generating functions that
 * tvi_solve_end_corrections_by_mean_q_jacobian serves. Returns whether the step was made; curve_stepper.c makes other
 * steps. */
static inline bool step_try_fast_path_step(tvi_curve_workspace *work,
                                           const fast_path_expansion_and_seed_functions *functions, double tau,
                                           const tvi_step_origin *origin, double dq[], double dp[], tvi_stats *stats)
{
    tvi_curve *curve = &work->corrected_curve.curve;
    tvi_stats counted = *stats;
    curve_set_time_unit(curve, tau);
    if (!step_set_centre_state_to_start(work, origin, work->newton.x) || functions->expand(curve) != TVI_OK)
        return false;
    step_compute_state_at_centre(work, work->newton.x);
    curve_set_centre_time(curve, origin->t, origin->t_low, -work->corrected_curve.span.start_s * tau);
    const int passes = step_run_corrector_passes(work, functions, origin, &counted);
    if (passes == 0) return false;
    for (int i = 0; i < 2 * curve_dimension(curve); i++) curve->product_direction[i] = work->newton.correction[i];
    *stats = counted;
    stats->tail = step_compute_increments_and_tail(work, dq, dp);
    stats->passes += passes;
    stats->expansions += 1 + passes;
    stats->force_evaluations += passes * work->options->quadrature_points;
    return true;
}

#endif
