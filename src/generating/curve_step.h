/* curve_step.h - makes the fast-path step of a method that expands one Taylor curve, and computes the parts of all
 * other steps of such a method. The fast-path step is the common case of a whole step, whose passes converge as usual.
 * It has no fallbacks, such as row exchanges or Jacobians by differences. If a step needs a fallback, the fast-path
 * step reports failure, and curve_stepper.c makes the step. curve_stepper.c, fast_path.c and
 * fast_path_members.c call this file. */
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
               z + curve_coefficient_row_length(&corrected->curve));
}

/* Computes the natural sizes of the unknowns, by which their corrections are measured. A curve of degree 0 or 1 from a
 * state of rest has size 0. For these degrees the sizes of the last corrections of the ends are added. The sizes of a
 * Lagrangian's unknowns stay unchanged, since these corrections have another unit. */
static inline void step_compute_unknown_scales(const tvi_corrected_curve *corrected, double scale[])
{
    const tvi_curve *curve = &corrected->curve;
    const int numbers = curve_coefficient_row_length(curve);
    CURVE_CALL(compute_centre_state_sizes, curve, scale);
    if (curve_highest_order(curve) > 1 || curve_system_form(&corrected->curve) == TVI_LAGRANGIAN) return;
    for (int i = 0; i < numbers; i++) {
        const double kappa = fabs(corrected->curve.momentum_scale_factor[i / curve_member_count(curve)]);
        scale[i] += fabs(corrected->start_correction_q[i]) + fabs(corrected->increment_correction_q[i]);
        scale[numbers + i] +=
            kappa * (fabs(corrected->start_correction_p[i]) + fabs(corrected->increment_correction_p[i]));
    }
}

/* Computes the residual r = (q- + start_correction_q - q0, kappa (p- + start_correction_p - p0)) of the corrector, the
 * difference between the corrected start of the curve and the state (q0, p0). Small differences are added first. */
static inline void step_compute_residual(const tvi_curve_workspace *work, const tvi_batch_origin *origin,
                                         double *restrict r)
{
    const tvi_corrected_curve *corrected = &work->corrected_curve;
    const int numbers = curve_coefficient_row_length(&corrected->curve), width = curve_member_count(&corrected->curve);
    const double *Q0 = tvi_curve_position_coefficients(&corrected->curve, 0);
    CURVE_CALL(sum_combination, &corrected->curve, &work->q_start_minus_centre_weights, r);
    CURVE_CALL(sum_combination, &corrected->curve, &corrected->scaled_p_at_start_weights, r + numbers);
    for (int i = 0; i < curve_dimension(&corrected->curve); i++) {
        const double kappa = corrected->curve.momentum_scale_factor[i];
        for (int at = i * width; at < (i + 1) * width; at++) {
            r[at] += (Q0[at] - origin->q[at]) + (corrected->start_correction_q[at] - origin->q_low[at]);
            r[numbers + at] = (r[numbers + at] - kappa * origin->p[at]) +
                              kappa * (corrected->start_correction_p[at] - origin->p_low[at]);
        }
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
    for (int i = 0; i < curve_coefficient_row_length(&work->corrected_curve.curve); i++) out[i] += work->scratch[i];
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
    const int width = curve_member_count(&corrected->curve);
    step_sum_combination_to_first_order_in_dz(work, q_increment_weights, dq);
    step_sum_combination_to_first_order_in_dz(work, scaled_p_increment_weights, dp);
    for (int i = 0; i < curve_coefficient_row_length(&corrected->curve); i++) {
        dp[i] /= corrected->curve.momentum_scale_factor[i / width];
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

static inline void step_compute_tails(const tvi_curve *curve, double tail[])
{
    if (curve_member_count(curve) == 1) tail[0] = CURVE_CALL(compute_tail, curve);
    else curve_compute_relative_last_term_per_member(curve, tail);
}

/* Computes the increments of the step and the tails of the members, and stores a Lagrangian's velocity at the end. */
static inline void step_compute_increments_and_tails(const tvi_curve_workspace *work, double dq[], double dp[],
                                                     double tail[])
{
    const tvi_curve *curve = &work->corrected_curve.curve;
    step_compute_increments(work, &work->corrected_curve.q_increment_weights,
                            &work->corrected_curve.scaled_p_increment_weights, 1, dq, dp);
    step_store_end_velocity(work);
    CURVE_CALL(compute_displacement_sizes, curve);
    step_compute_tails(curve, tail);
}

/* ---- A whole step ------------------------------------------------------------------------------------------------ */

/* The functions that a fast-path step calls: they expand the curve, without and with its Jacobians, and compute the
 * seeds of the action's gradient. The seeds are not checked to be finite. */
typedef struct {
    tvi_status (*expand)(tvi_curve *curve), (*expand_with_tangents)(tvi_curve *curve);
    tvi_status (*compute_seeds)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[]);
    /* For several members, clears iterating_mask of each member for which the tape of the nodes (at_nodes is true) or
     * of the series has no values. */
    void (*drop_members_outside_domain)(const tvi_curve_workspace *work, bool at_nodes, long long iterating_mask[]);
} fast_path_expansion_and_seed_functions;

/* The memory and functions that all Newton passes of a fast-path step share, the start of the step and the progress.
 * iterating_mask [member_count] has all bits set for a member whose passes have not ended, and is 0 for the others. */
typedef struct {
    tvi_curve_workspace *work;
    const fast_path_expansion_and_seed_functions *functions;
    const tvi_batch_origin *origin;
    long long *iterating_mask;
    long factorisation_count;
} step_newton_pass_context;

/* Returns the number of members whose passes have not ended. */
static inline int step_count_iterating_members(const step_newton_pass_context *pass_context)
{
    int count = 0;
    for (int m = 0; m < curve_member_count(&pass_context->work->corrected_curve.curve); m++)
        count += pass_context->iterating_mask[m] != 0;
    return count;
}

/* Ends the passes of members for which an evaluation, at the nodes or of the series, failed with this status. Returns
 * whether the step continues. After a failure a step of a single member does not; in a step of several members only
 * those outside of the domain are dropped, and the step continues. */
static inline bool step_continue_without_failed_members(const step_newton_pass_context *pass_context, tvi_status status,
                                                        bool at_nodes)
{
    if (status == TVI_OK) return true;
    if (curve_member_count(&pass_context->work->corrected_curve.curve) == 1) return false;
    pass_context->functions->drop_members_outside_domain(pass_context->work, at_nodes, pass_context->iterating_mask);
    return true;
}

/* Finds the members whose Jacobians must be computed anew at z, and returns their number. */
static inline int step_find_members_with_due_jacobians(const step_newton_pass_context *pass_context, const double z[])
{
    tvi_corrected_curve *corrected = &pass_context->work->corrected_curve;
    const int width = curve_member_count(&corrected->curve);
    long long is_one_due, *due_jacobian_mask = width > 1 ? corrected->curve.due_jacobian_mask : &is_one_due;
    int count = 0;
    matrices_find_members_with_due_jacobians(corrected, z, pass_context->work->newton.scale,
                                             pass_context->iterating_mask, due_jacobian_mask);
    for (int m = 0; m < width; m++) count += (due_jacobian_mask[m] & pass_context->iterating_mask[m]) != 0;
    if (width > 1)
        corrected->curve.keeps_old_jacobians =
            count < width && matrices_get_factors(corrected)->jacobian_computations_in_step > 0;
    return count;
}

/* Factors new Jacobians: those of the generating function's equations, and that of the corrector if it was renewed.
 * Rows of one unit are scaled together. In two cases the rows of the second half have another unit than those of the
 * first: in a Hamiltonian's equations, if the second equations are of coordinates, and in a Lagrangian's corrector. The
 * passes of a member end if its factors need row exchanges. */
static inline void step_factor_jacobians(step_newton_pass_context *pass_context, int due_count, const double z[])
{
    const tvi_corrected_curve *corrected = &pass_context->work->corrected_curve;
    const tvi_form form = curve_system_form(&corrected->curve);
    const int n = curve_dimension(&corrected->curve), size = 2 * n, width = curve_member_count(&corrected->curve);
    const bool uses_momenta = corrected->end_correction_factors->uses_mean_momentum;
    tvi_lu_factor *full = &matrices_get_factors(corrected)->full_jacobian_factor,
                  *back = &pass_context->work->newton.factor;
    matrices_record_z_of_jacobians(corrected, z);
    matrices_stack_combination_jacobians(corrected, &corrected->q_mean_weights,
                                         ends_get_weights_of_lower_jacobian_rows(corrected), full->lu);
    const int renewed = matrices_renew_corrector_jacobians(corrected, pass_context->iterating_mask, back->lu);
    linear_unpivoted_factor_in_place(size, form != TVI_HAMILTONIAN || uses_momenta ? size : n, width, full,
                                     pass_context->iterating_mask);
    if (renewed > 0)
        linear_unpivoted_factor_in_place(size, form != TVI_LAGRANGIAN ? size : n, width, back,
                                         pass_context->iterating_mask);
    pass_context->factorisation_count += due_count + renewed;
}

/* Computes the corrections of the unknowns in one pass, but does not add them. Returns false if no member continues. */
static inline bool step_run_corrector_pass(step_newton_pass_context *pass_context, bool is_first)
{
    tvi_curve_workspace *work = pass_context->work;
    const fast_path_expansion_and_seed_functions *functions = pass_context->functions;
    tvi_corrected_curve *corrected = &work->corrected_curve;
    tvi_newton *newton = &work->newton;
    const int size = 2 * curve_dimension(&corrected->curve), width = curve_member_count(&corrected->curve);
    double *x = newton->x, *r = newton->correction;
    const int due_count = step_find_members_with_due_jacobians(pass_context, x);
    curve_set_centre_state(&corrected->curve, x);
    tvi_status status = (due_count > 0 ? functions->expand_with_tangents : functions->expand)(&corrected->curve);
    if (!step_continue_without_failed_members(pass_context, status, false)) return false;
    status = functions->compute_seeds(&work->action, &corrected->curve, corrected->action_gradient_by_coefficients_Q,
                                      corrected->action_gradient_by_coefficients_U);
    if (!step_continue_without_failed_members(pass_context, status, true)) return false;
    if (due_count > 0) step_factor_jacobians(pass_context, due_count, x);
    if (step_count_iterating_members(pass_context) == 0) return false;
    CURVE_CALL(multiply_transposed_jacobians_by_seeds, &corrected->curve, corrected->action_gradient_by_coefficients_Q,
               corrected->action_gradient_by_coefficients_U, corrected->gradient_then_solution);
    linear_unpivoted_solve_transposed(size, width, &matrices_get_factors(corrected)->full_jacobian_factor,
                                      corrected->gradient_then_solution);
    ends_compute_corrections_from_solution(corrected);
    step_compute_residual(work, pass_context->origin, r);
    if (is_first) {
        step_compute_unknown_scales(corrected, newton->scale);
        for (int m = 0; m < width; m++) newton_raise_scales_of_small_unknowns(newton, m);
    }
    for (int i = 0; i < size * width; i++) r[i] = -r[i];
    linear_unpivoted_solve(size, width, &newton->factor, r);
    return true;
}

/* Judges the correction of member m. The passes of the member end if this was its last correction, or if its step is
 * left to curve_stepper.c, for example because a number is not finite. */
static inline void step_judge_correction(const step_newton_pass_context *pass_context,
                                         tvi_newton_convergence_record *record, const tvi_correction_sizes *sizes,
                                         int m, const tvi_fast_path_step_results *results)
{
    const tvi_newton *newton = &pass_context->work->newton;
    tvi_passes_verdict verdict = TVI_PASSES_STUCK;
    if (isfinite(sizes->largest_relative_correction[m]))
        verdict = tvi_newton_judge_pass(record, &newton->rules, sizes, m);
    if (verdict != TVI_PASSES_GO_ON) pass_context->iterating_mask[m] = 0;
    if (verdict != TVI_PASSES_MAY_END) return;
    newton->max_contraction_ratio_growth_of_member[m] =
        tvi_larger(newton->max_contraction_ratio_growth_of_member[m], record->contraction_ratio_growth);
    results->residual[m] = sizes->largest_relative_correction[m];
    results->pass_counts[m] = record->passes_measured_per_unknown.count;
}

/* Adds the corrections to the unknowns of the members whose passes continue. */
static inline void step_apply_corrections(const step_newton_pass_context *pass_context)
{
    const tvi_newton *newton = &pass_context->work->newton;
    const int width = curve_member_count(&pass_context->work->corrected_curve.curve);
    const double *correction = newton->correction;
    double *restrict x = newton->x;
    for (int i = 0; i < newton->unknown_count; i++, x += width, correction += width)
        for (int m = 0; m < width; m++) x[m] = pass_context->iterating_mask[m] ? x[m] + correction[m] : x[m];
}

/* Runs passes of the corrector until those of every member have ended, or until the greatest number of passes. */
static inline void step_run_corrector_passes(step_newton_pass_context *pass_context,
                                             const tvi_fast_path_step_results *results)
{
    const tvi_newton *newton = &pass_context->work->newton;
    const int width = curve_member_count(&pass_context->work->corrected_curve.curve);
    tvi_newton_convergence_record record_of_member[CURVE_MOST_WIDTH];
    for (int m = 0; m < width; m++)
        tvi_newton_begin_passes(&record_of_member[m], newton->max_contraction_ratio_growth_of_member[m], &newton->rules,
                                newton->confirms_convergence_by_extra_pass);
    matrices_discard_factors(&pass_context->work->corrected_curve);
    for (int count = 1; count <= newton->rules.per_unknown_correction_rule.max_passes; count++) {
        tvi_correction_sizes sizes;
        if (!step_run_corrector_pass(pass_context, count == 1)) return;
        newton_measure_corrections(newton, newton->scale, &sizes);
        for (int m = 0; m < width; m++)
            if (pass_context->iterating_mask[m])
                step_judge_correction(pass_context, &record_of_member[m], &sizes, m, results);
        if (step_count_iterating_members(pass_context) == 0) return;
        step_apply_corrections(pass_context);
    }
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
static inline bool step_set_centre_state_to_start(tvi_curve_workspace *work, const tvi_batch_origin *origin, double z[])
{
    tvi_curve *curve = &work->corrected_curve.curve;
    const int n = curve_dimension(curve), width = curve_member_count(curve);
    for (int i = 0; i < n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            z[at] = origin->q[at];
            z[n * width + at] = curve->momentum_scale_factor[i] * origin->p[at];
        }
    curve_set_centre_state(curve, z);
    curve_set_centre_time(curve, origin->t, origin->t_low, 0);
    if (curve_system_form(curve) != TVI_LAGRANGIAN) return true;
    return step_try_to_find_velocity(work, origin->p, tvi_curve_field_inputs_of_order(curve, 0) + n);
}

/* Makes the steps of the members whose passes converge as usual, for the generating functions that
 * tvi_solve_end_corrections_by_mean_q_jacobian serves. Returns whether any member's step was made; curve_stepper.c
 * makes the other steps.
 * */
static inline bool step_try_fast_path_steps(tvi_curve_workspace *work,
                                            const fast_path_expansion_and_seed_functions *functions, double tau,
                                            const tvi_batch_origin *origin, const tvi_fast_path_step_results *results,
                                            tvi_stats *stats)
{
    tvi_curve *curve = &work->corrected_curve.curve;
    step_newton_pass_context pass_context = {work, functions, origin, results->iterating_mask, 0};
    int steps = 0, passes = 0;
    curve_set_time_unit(curve, tau);
    for (int m = 0; m < curve_member_count(curve); m++) results->pass_counts[m] = TVI_NOT_MADE;
    if (!step_set_centre_state_to_start(work, origin, work->newton.x) ||
        !step_continue_without_failed_members(&pass_context, functions->expand(curve), false))
        return false;
    step_compute_state_at_centre(work, work->newton.x);
    curve_set_centre_time(curve, origin->t, origin->t_low, -work->corrected_curve.span.start_s * tau);
    step_run_corrector_passes(&pass_context, results);
    for (int m = 0; m < curve_member_count(curve); m++) {
        if (results->pass_counts[m] == TVI_NOT_MADE) continue;
        steps++;
        passes += results->pass_counts[m];
    }
    if (steps == 0) return false;
    for (int i = 0; i < 2 * curve_coefficient_row_length(curve); i++)
        curve->product_direction[i] = work->newton.correction[i];
    step_compute_increments_and_tails(work, results->dq, results->dp, results->tail);
    stats->passes += passes;
    stats->expansions += steps + passes;
    stats->factorisations += pass_context.factorisation_count;
    stats->force_evaluations += passes * work->options->quadrature_points;
    return true;
}

#endif
