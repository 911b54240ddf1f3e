/* matrices.h - decides when the Jacobian matrices of the curve's ends are computed anew, and forms them. matrices.c
 * and curve_step.h call it. Generated code includes this text (emit.c) with every size as a constant. */
#ifndef TVI_SRC_GENERATING_MATRICES_H
#define TVI_SRC_GENERATING_MATRICES_H

#include "generating/closure.h"
#include "generating/tangents.h"

/* The Jacobians of the curve's ends and their factors. jacobian_computations_in_step counts how often Jacobians are
 * computed, from 0 in each step. A factor is valid if no Jacobians were computed after it. */
typedef struct {
    double *z_of_last_jacobians;                /* [2n] the centre state z at which the last Jacobians were computed */
    int jacobian_computations_in_step;          /* how many times Jacobians were computed in this step */
    int jacobian_computations_at_factorisation; /* jacobian_computations_in_step when the factor was computed */
    bool has_corrector_jacobian;                /* whether the corrector's Jacobian was computed in this step */
    /* [width] the sum of the distances that z has moved since the corrector's Jacobian was computed, relative to the
     * size of z. */
    double *relative_distance_since_jacobian;
    double *end_jacobian; /* [n][2n] scratch for Jacobians of the ends */
    /* [2n][2n] for several members: the corrector's Jacobian of each, which may be older for some than for others. */
    double *corrector_jacobian;
    tvi_lu_factor jacobian_block_factor; /* the factored n x n block of the Jacobian, or unused */
    tvi_lu_factor full_jacobian_factor;  /* the factored whole 2n x 2n Jacobian; a method uses one of the two factors */
} tvi_jacobian_factors;

static inline tvi_jacobian_factors *matrices_get_factors(const tvi_closure *closure) { return closure->solver_data; }

static inline void matrices_discard_factors(tvi_closure *closure)
{
    tvi_jacobian_factors *factors = matrices_get_factors(closure);
    factors->jacobian_computations_in_step = factors->jacobian_computations_at_factorisation = 0;
    factors->has_corrector_jacobian = false;
}

/* Records that the Jacobians of the curve were computed at the centre state z. */
static inline void matrices_record_z_of_jacobians(const tvi_closure *closure, const double z[])
{
    const tvi_curve *curve = &closure->curve;
    double *z_of_last_jacobians = matrices_get_factors(closure)->z_of_last_jacobians;
    const int numbers = 2 * curve_vector_length(curve), width = curve_width(curve);
    for (int at = 0; at < numbers; at += width)
        curve_store_values_of_due_members(curve, z + at, z_of_last_jacobians + at);
    matrices_get_factors(closure)->jacobian_computations_in_step++;
}

/* Writes the Jacobians of two combinations, one above the other: [2n][2n]. */
static inline void matrices_stack_combination_jacobians(const tvi_closure *closure, const tvi_combination *first,
                                                        const tvi_combination *second, double matrix[])
{
    CURVE_CALL(sum_combination_jacobian, &closure->curve, first, matrix);
    CURVE_CALL(sum_combination_jacobian, &closure->curve, second,
               matrix + 2 * curve_dimension(&closure->curve) * curve_vector_length(&closure->curve));
}

/* Returns true if the corrector has no Jacobian in this step, or if z of member m has moved too far since it was
 * computed. */
static inline bool matrices_is_corrector_jacobian_outdated(const tvi_jacobian_factors *matrices, int m)
{
    return !matrices->has_corrector_jacobian || matrices->relative_distance_since_jacobian[m] > MATRICES_MAX_MOVEMENT;
}

/* Chooses the corrector's Jacobian of member m, which `matrix` contains newly computed. If the stored Jacobian is
 * outdated, the new one is stored in its place; otherwise the stored one is copied to `matrix`. */
static inline void matrices_choose_corrector_jacobian_of_member(const tvi_closure *closure, int m, double matrix[])
{
    const int n = curve_dimension(&closure->curve), width = curve_width(&closure->curve);
    double *corrector_jacobian = matrices_get_factors(closure)->corrector_jacobian;
    const bool is_far = matrices_is_corrector_jacobian_outdated(matrices_get_factors(closure), m);
    const double *from = is_far ? matrix : corrector_jacobian;
    double *to = is_far ? corrector_jacobian : matrix;
    for (int at = m; at < 4 * n * n * width; at += width) to[at] = from[at];
}

/* Computes, for the corrector, the Jacobian matrix of the end at s- (q-, u-) by the unknowns z, as
 * corrector_jacobian_of_members [2n][2n][width]. Returns the number of members, among those that iterate, whose
 * Jacobians it renewed. Nothing is computed if all of these members can reuse their Jacobians. */
static inline int matrices_renew_corrector_jacobians(const tvi_closure *closure, const long long iterating_mask[],
                                                     double corrector_jacobian_of_members[])
{
    tvi_jacobian_factors *matrices = matrices_get_factors(closure);
    const int width = curve_width(&closure->curve);
    int count = 0;
    for (int m = 0; m < width; m++) count += iterating_mask[m] && matrices_is_corrector_jacobian_outdated(matrices, m);
    if (count == 0) return 0;
    matrices_stack_combination_jacobians(closure, &closure->q_at_start_weights, &closure->u_at_start_weights,
                                         corrector_jacobian_of_members);
    if (width > 1)
        for (int m = 0; m < width; m++)
            matrices_choose_corrector_jacobian_of_member(closure, m, corrector_jacobian_of_members);
    for (int m = 0; m < width; m++)
        if (matrices_is_corrector_jacobian_outdated(matrices, m)) matrices->relative_distance_since_jacobian[m] = 0;
    matrices->has_corrector_jacobian = true;
    return count;
}

/* Computes for each member how far z is from the point where the Jacobians were computed, relative to the size of z. */
static inline void matrices_compute_distance_since_jacobians(const tvi_closure *closure, const double z[],
                                                             const double scale[], double distance[])
{
    const double *z_of_last_jacobians = matrices_get_factors(closure)->z_of_last_jacobians;
    const int width = curve_width(&closure->curve);
    for (int m = 0; m < width; m++) distance[m] = 0;
    for (int i = 0; i < 2 * curve_vector_length(&closure->curve); i += width)
        for (int m = 0; m < width; m++)
            distance[m] =
                tvi_larger(tvi_ratio_or_zero(fabs(z[i + m] - z_of_last_jacobians[i + m]), scale[i + m]), distance[m]);
}

/* Raises largest [width] to the relative size of component i where that is larger: (|start_correction| +
 * |increment_correction| + seed_factor sum_k |seed_k|) / unit. */
static inline void matrices_raise_largest_relative_correction(const tvi_curve *curve, int i,
                                                              const double start_correction[],
                                                              const double increment_correction[], double seed_factor,
                                                              const double seed[], const double unit[],
                                                              double largest[])
{
    const int width = curve_width(curve), at = i * width;
    double size[CURVE_MOST_WIDTH] = {0};
    for (int k = 0; seed && k <= curve_highest_order(curve); k++)
        for (int m = 0; m < width; m++) size[m] += fabs(seed[k * curve_vector_length(curve) + at + m]);
    for (int m = 0; m < width; m++) {
        const double all = fabs(start_correction[at + m]) + fabs(increment_correction[at + m]) + seed_factor * size[m];
        largest[m] = tvi_larger(tvi_ratio_or_zero(all, unit[at + m]), largest[m]);
    }
}

/* Computes for each member a bound of the relative error that old Jacobians cause in the state, divided by the relative
 * distance of z from the point where they were computed. The relative error of an old Jacobian is about this distance.
 * The error multiplies the corrections of the ends and the seeds; the seeds may be much larger than the D_z that they
 * add up to. */
static inline void matrices_bound_stale_jacobian_error(const tvi_closure *closure, const double scale[],
                                                       double error_per_distance[])
{
    const tvi_curve *curve = &closure->curve;
    const double *seed_U = curve_form(curve) != TVI_SEPARABLE ? closure->action_gradient_by_coefficients_U : NULL;
    for (int m = 0; m < curve_width(curve); m++) error_per_distance[m] = 0;
    closure_compute_momentum_term_abs_sums(closure);
    for (int i = 0; i < curve_dimension(curve); i++) {
        matrices_raise_largest_relative_correction(curve, i, closure->start_correction_q,
                                                   closure->increment_correction_q, fabs(curve->kappa[i]), seed_U,
                                                   scale, error_per_distance);
        matrices_raise_largest_relative_correction(
            curve, i, closure->start_correction_p, closure->increment_correction_p, 1,
            closure->action_gradient_by_coefficients_Q, closure->momentum_term_abs_sum, error_per_distance);
    }
}

/* Finds the members whose Jacobians must be computed anew at z, among those that iterate. The first pass computes those
 * of all members. Later passes reuse them as long as the bound of the resulting error, estimated from the corrections
 * of the last pass, is below roundoff. */
static inline void matrices_find_members_with_due_jacobians(const tvi_closure *closure, const double z[],
                                                            const double scale[], const long long iterating_mask[],
                                                            long long due_jacobian_mask[])
{
    tvi_jacobian_factors *matrices = matrices_get_factors(closure);
    double distance[CURVE_MOST_WIDTH], error_per_distance[CURVE_MOST_WIDTH];
    const bool is_first = matrices->jacobian_computations_in_step == 0;
    if (!is_first) matrices_compute_distance_since_jacobians(closure, z, scale, distance);
    if (!is_first) matrices_bound_stale_jacobian_error(closure, scale, error_per_distance);
    for (int m = 0; m < curve_width(&closure->curve); m++) {
        due_jacobian_mask[m] =
            is_first || (iterating_mask[m] && !(distance[m] * error_per_distance[m] <= CURVE_NEGLIGIBLE_ERROR)) ? -1
                                                                                                                : 0;
        if (due_jacobian_mask[m] && !is_first) matrices->relative_distance_since_jacobian[m] += distance[m];
    }
}

#endif
