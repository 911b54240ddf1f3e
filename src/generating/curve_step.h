/* curve_step.h - computes the parts of the steps of a method that expands one Taylor curve: the predicted centre, the
 * residual of the corrector, the increments. curve_stepper.c and curve_workspace.c call it. */
#ifndef TVI_SRC_GENERATING_CURVE_STEP_H
#define TVI_SRC_GENERATING_CURVE_STEP_H

#include "generating/curve_stepper.h"

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

#endif
