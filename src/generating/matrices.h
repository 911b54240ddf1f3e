/* matrices.h - decides when the Jacobian matrices of the curve's ends are computed anew, and forms them. matrices.c
 * and curve_step.h call it. */
#ifndef TVI_SRC_GENERATING_MATRICES_H
#define TVI_SRC_GENERATING_MATRICES_H

#include "generating/corrected_curve.h"
#include "generating/tangents.h"

/* The Jacobians of the curve's ends and their factors. jacobian_computations_in_step counts how often Jacobians are
 * computed, from 0 in each step. A factor is valid if no Jacobians were computed after it. */
typedef struct {
    double *z_of_last_jacobians;       /* [2n] the centre state z at which the last Jacobians were computed */
    int jacobian_computations_in_step; /* how many times Jacobians were computed in this step */
    int jacobian_computations_when_last_factored; /* jacobian_computations_in_step when the factor was computed */
    bool has_corrector_jacobian;                  /* whether the corrector's Jacobian was computed in this step */
    /* [member_count] the sum of the distances that z has moved since the corrector's Jacobian was computed, relative to
     * the size of z. */
    double *relative_distance_since_jacobian;
    double *scratch_end_state_jacobian; /* [n][2n] scratch for Jacobians of the ends */
    /* [2n][2n] for several members: the corrector's Jacobian of each, which may be older for some than for others. */
    double *corrector_jacobian;
    tvi_lu_factor jacobian_block_factor; /* the factored n x n block of the Jacobian, or unused */
    tvi_lu_factor full_jacobian_factor;  /* the factored whole 2n x 2n Jacobian; a method uses one of the two factors */
} tvi_jacobian_factors;

static inline tvi_jacobian_factors *matrices_get_factors(const tvi_corrected_curve *corrected)
{
    return corrected->solver_data;
}

static inline void matrices_discard_factors(tvi_corrected_curve *corrected)
{
    tvi_jacobian_factors *factors = matrices_get_factors(corrected);
    factors->jacobian_computations_in_step = factors->jacobian_computations_when_last_factored = 0;
    factors->has_corrector_jacobian = false;
}

/* Records that the Jacobians of the curve were computed at the centre state z. */
static inline void matrices_record_z_of_jacobians(const tvi_corrected_curve *corrected, const double z[])
{
    const tvi_curve *curve = &corrected->curve;
    double *z_of_last_jacobians = matrices_get_factors(corrected)->z_of_last_jacobians;
    const int numbers = 2 * curve_coefficient_row_length(curve), width = curve_member_count(curve);
    for (int at = 0; at < numbers; at += width)
        curve_copy_members_with_due_jacobians(curve, z + at, z_of_last_jacobians + at);
    matrices_get_factors(corrected)->jacobian_computations_in_step++;
}

/* Writes the Jacobians of two combinations, one above the other: [2n][2n]. */
static inline void matrices_stack_combination_jacobians(const tvi_corrected_curve *corrected,
                                                        const tvi_coefficient_combination *first,
                                                        const tvi_coefficient_combination *second, double matrix[])
{
    CURVE_CALL(sum_combination_jacobian, &corrected->curve, first, matrix);
    CURVE_CALL(sum_combination_jacobian, &corrected->curve, second,
               matrix + 2 * curve_dimension(&corrected->curve) * curve_coefficient_row_length(&corrected->curve));
}

/* Returns true if the corrector has no Jacobian in this step, or if z of member m has moved too far since it was
 * computed. */
static inline bool matrices_is_corrector_jacobian_outdated(const tvi_jacobian_factors *matrices, int m)
{
    return !matrices->has_corrector_jacobian || matrices->relative_distance_since_jacobian[m] > MATRICES_MAX_MOVEMENT;
}

/* Makes new_in_valid_out_jacobian, which contains the newly computed Jacobian of the corrector of each member, contain
 * the Jacobian that the given member uses. If the stored Jacobian of the member is outdated, the new one replaces it in
 * the store; otherwise the stored one is loaded in place of the new one. */
static inline void matrices_replace_jacobian_if_outdated_else_load(const tvi_corrected_curve *corrected, int member,
                                                                   double new_in_valid_out_jacobian[])
{
    const int n = curve_dimension(&corrected->curve), width = curve_member_count(&corrected->curve);
    double *corrector_jacobian = matrices_get_factors(corrected)->corrector_jacobian;
    const bool is_far = matrices_is_corrector_jacobian_outdated(matrices_get_factors(corrected), member);
    const double *from = is_far ? new_in_valid_out_jacobian : corrector_jacobian;
    double *to = is_far ? corrector_jacobian : new_in_valid_out_jacobian;
    for (int at = member; at < 4 * n * n * width; at += width) to[at] = from[at];
}

/* Computes, for the corrector, the Jacobian matrix of the end at s- (q-, u-) by the unknowns z, as
 * corrector_jacobian_of_members [2n][2n][member_count]. Returns the number of members, among those that iterate, whose
 * Jacobians it renewed. Nothing is computed if all of these members can reuse their Jacobians. */
static inline int matrices_renew_corrector_jacobians(const tvi_corrected_curve *corrected,
                                                     const long long iterating_mask[],
                                                     double corrector_jacobian_of_members[])
{
    tvi_jacobian_factors *matrices = matrices_get_factors(corrected);
    const int width = curve_member_count(&corrected->curve);
    int count = 0;
    for (int m = 0; m < width; m++) count += iterating_mask[m] && matrices_is_corrector_jacobian_outdated(matrices, m);
    if (count == 0) return 0;
    matrices_stack_combination_jacobians(corrected, &corrected->q_at_start_weights,
                                         &corrected->scaled_p_at_start_weights, corrector_jacobian_of_members);
    if (width > 1)
        for (int m = 0; m < width; m++)
            matrices_replace_jacobian_if_outdated_else_load(corrected, m, corrector_jacobian_of_members);
    for (int m = 0; m < width; m++)
        if (matrices_is_corrector_jacobian_outdated(matrices, m)) matrices->relative_distance_since_jacobian[m] = 0;
    matrices->has_corrector_jacobian = true;
    return count;
}

/* Computes for each member how far z is from the point where the Jacobians were computed, relative to the size of z. */
static inline void matrices_compute_distance_since_jacobians(const tvi_corrected_curve *corrected, const double z[],
                                                             const double scale[], double distance[])
{
    const double *z_of_last_jacobians = matrices_get_factors(corrected)->z_of_last_jacobians;
    const int width = curve_member_count(&corrected->curve);
    for (int m = 0; m < width; m++) distance[m] = 0;
    for (int i = 0; i < 2 * curve_coefficient_row_length(&corrected->curve); i += width)
        for (int m = 0; m < width; m++)
            distance[m] =
                tvi_larger(tvi_ratio_or_zero(fabs(z[i + m] - z_of_last_jacobians[i + m]), scale[i + m]), distance[m]);
}

/* Raises max_relative_correction [member_count] to the relative size of the component where that is larger:
 * (|start_correction| + |increment_correction| + gradient_factor sum_k |action_gradient_by_coefficients_k|) /
 * component_size. */
static inline void matrices_update_max_relative_correction(const tvi_curve *curve, int component,
                                                           const double start_correction[],
                                                           const double increment_correction[], double gradient_factor,
                                                           const double action_gradient_by_coefficients[],
                                                           const double component_size[],
                                                           double max_relative_correction[])
{
    const int width = curve_member_count(curve), at = component * width;
    double size[CURVE_MOST_WIDTH] = {0};
    for (int k = 0; action_gradient_by_coefficients && k <= curve_highest_order(curve); k++)
        for (int m = 0; m < width; m++)
            size[m] += fabs(action_gradient_by_coefficients[k * curve_coefficient_row_length(curve) + at + m]);
    for (int m = 0; m < width; m++) {
        const double all =
            fabs(start_correction[at + m]) + fabs(increment_correction[at + m]) + gradient_factor * size[m];
        max_relative_correction[m] =
            tvi_larger(tvi_ratio_or_zero(all, component_size[at + m]), max_relative_correction[m]);
    }
}

/* Computes for each member a bound of the relative error that old Jacobians cause in the state, divided by the relative
 * distance of z from the point where they were computed. The relative error of an old Jacobian is about this distance.
 * The error multiplies the corrections of the ends and the seeds; the seeds may be much larger than the D_z that they
 * add up to. */
static inline void matrices_bound_stale_jacobian_error(const tvi_corrected_curve *corrected, const double scale[],
                                                       double error_per_distance[])
{
    const tvi_curve *curve = &corrected->curve;
    const double *seed_U =
        curve_system_form(curve) != TVI_SEPARABLE ? corrected->action_gradient_by_coefficients_U : NULL;
    for (int m = 0; m < curve_member_count(curve); m++) error_per_distance[m] = 0;
    ends_compute_momentum_term_abs_sums(corrected);
    for (int i = 0; i < curve_dimension(curve); i++) {
        matrices_update_max_relative_correction(
            curve, i, corrected->start_correction_q, corrected->increment_correction_q,
            fabs(curve->momentum_scale_factor[i]), seed_U, scale, error_per_distance);
        matrices_update_max_relative_correction(
            curve, i, corrected->start_correction_p, corrected->increment_correction_p, 1,
            corrected->action_gradient_by_coefficients_Q, corrected->momentum_term_abs_sum, error_per_distance);
    }
}

/* Finds the members whose Jacobians must be computed anew at z, among those that iterate. The first pass computes those
 * of all members. Later passes reuse them as long as the bound of the resulting error, estimated from the corrections
 * of the last pass, is below roundoff. */
static inline void matrices_find_members_with_due_jacobians(const tvi_corrected_curve *corrected, const double z[],
                                                            const double scale[], const long long iterating_mask[],
                                                            long long due_jacobian_mask[])
{
    tvi_jacobian_factors *matrices = matrices_get_factors(corrected);
    double distance[CURVE_MOST_WIDTH], error_per_distance[CURVE_MOST_WIDTH];
    const bool is_first = matrices->jacobian_computations_in_step == 0;
    if (!is_first) matrices_compute_distance_since_jacobians(corrected, z, scale, distance);
    if (!is_first) matrices_bound_stale_jacobian_error(corrected, scale, error_per_distance);
    for (int m = 0; m < curve_member_count(&corrected->curve); m++) {
        due_jacobian_mask[m] =
            is_first || (iterating_mask[m] && !(distance[m] * error_per_distance[m] <= CURVE_NEGLIGIBLE_ERROR)) ? -1
                                                                                                                : 0;
        if (due_jacobian_mask[m] && !is_first) matrices->relative_distance_since_jacobian[m] += distance[m];
    }
}

#endif
