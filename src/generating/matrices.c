/* matrices.c - solves A^T x = D_z for the corrections of the curve's ends, with D_z the gradient of the discrete action
 * in defect form (action.h) and A made of Jacobian matrices of the ends. It factors them, and reuses the factors as
 * long as the resulting error is below roundoff. corrected_curve.c calls it through tvi_solver_by_matrices. */
#include "generating/corrected_curve.h"
#include "generating/curve.h"

#include <string.h>

/* ---- The Jacobians, and when they are due ------------------------------------------------------------------------ */

/* The Jacobians of the curve's ends and their factors. jacobian_computations_in_step counts how often Jacobians are
 * computed, from 0 in each step. A factor is valid if no Jacobians were computed after it. */
typedef struct {
    double *z_of_last_jacobians;       /* [2n] the centre state z at which the last Jacobians were computed */
    int jacobian_computations_in_step; /* how many times Jacobians were computed in this step */
    int jacobian_computations_when_last_factored; /* jacobian_computations_in_step when the factor was computed */
    bool has_corrector_jacobian;                  /* whether the corrector's Jacobian was computed in this step */
    /* the sum of the distances that z has moved since the corrector's Jacobian was computed, relative to the size of
     * z */
    double relative_distance_since_jacobian;
    double *scratch_end_state_jacobian;  /* [n][2n] scratch for Jacobians of the ends */
    tvi_lu_factor jacobian_block_factor; /* the factored n x n block of the Jacobian, or unused */
    tvi_lu_factor full_jacobian_factor;  /* the factored whole 2n x 2n Jacobian; a method uses one of the two factors */
} tvi_jacobian_factors;

static tvi_jacobian_factors *get_factors(const tvi_corrected_curve *corrected) { return corrected->solver_data; }

static void discard_factors(tvi_corrected_curve *corrected)
{
    tvi_jacobian_factors *factors = get_factors(corrected);
    factors->jacobian_computations_in_step = factors->jacobian_computations_when_last_factored = 0;
    factors->has_corrector_jacobian = false;
}

/* Records that the Jacobians of the curve were computed at the centre state z. */
static void record_z_of_jacobians(const tvi_corrected_curve *corrected, const double z[])
{
    memcpy(get_factors(corrected)->z_of_last_jacobians, z, 2 * (size_t)corrected->n * sizeof *z);
    get_factors(corrected)->jacobian_computations_in_step++;
}

/* Writes the Jacobians of two combinations, one above the other: [2n][2n]. */
static void stack_combination_jacobians(const tvi_corrected_curve *corrected, const tvi_coefficient_combination *first,
                                        const tvi_coefficient_combination *second, double matrix[])
{
    tvi_curve_sum_combination_jacobian(&corrected->curve, first, matrix);
    tvi_curve_sum_combination_jacobian(&corrected->curve, second,
                                       matrix +
                                           2 * curve_dimension(&corrected->curve) * curve_dimension(&corrected->curve));
}

/* Computes, for the corrector, the Jacobian matrix [2n][2n] of the end at s- (q-, u-) by the unknowns z. Returns false,
 * and computes nothing, if it can reuse that of an earlier pass of this step: z has not moved far since. */
static bool renew_corrector_jacobian(const tvi_corrected_curve *corrected, double corrector_jacobian[])
{
    tvi_jacobian_factors *matrices = get_factors(corrected);
    if (matrices->has_corrector_jacobian && !(matrices->relative_distance_since_jacobian > MATRICES_MAX_MOVEMENT))
        return false;
    stack_combination_jacobians(corrected, &corrected->ends[TVI_Q_START], &corrected->ends[TVI_U_START],
                                corrector_jacobian);
    matrices->relative_distance_since_jacobian = 0;
    matrices->has_corrector_jacobian = true;
    return true;
}

/* Returns how far z is from the point where the Jacobians were computed, relative to the size of z. */
static double distance_since_jacobians(const tvi_corrected_curve *corrected, const double z[], const double scale[])
{
    const double *z_of_last_jacobians = get_factors(corrected)->z_of_last_jacobians;
    double distance = 0;
    for (int i = 0; i < 2 * curve_dimension(&corrected->curve); i++)
        distance = tvi_larger(tvi_ratio_or_zero(fabs(z[i] - z_of_last_jacobians[i]), scale[i]), distance);
    return distance;
}

/* Returns the larger one of max_relative_correction and the relative size of component i: (|start_correction| +
 * |increment_correction| + gradient_factor sum_k |action_gradient_by_coefficients_k|) / component_size. */
static double larger_relative_correction(const tvi_curve *curve, int i, const double start_correction[],
                                         const double increment_correction[], double gradient_factor,
                                         const double action_gradient_by_coefficients[], const double component_size[],
                                         double max_relative_correction)
{
    double size = 0;
    for (int k = 0; action_gradient_by_coefficients && k <= curve_highest_order(curve); k++)
        size += fabs(action_gradient_by_coefficients[k * curve_dimension(curve) + i]);
    const double all = fabs(start_correction[i]) + fabs(increment_correction[i]) + gradient_factor * size;
    return tvi_larger(tvi_ratio_or_zero(all, component_size[i]), max_relative_correction);
}

/* Returns a bound of the relative error that old Jacobians cause in the state, divided by the relative distance of z
 * from the point where they were computed. The relative error of an old Jacobian is about this distance. The error
 * multiplies the corrections of the ends and the seeds; the seeds may be much larger than the D_z that they add up
 * to. */
static double bound_stale_jacobian_error(const tvi_corrected_curve *corrected, const double scale[])
{
    const tvi_curve *curve = &corrected->curve;
    const double *seed_U =
        curve_system_form(curve) != TVI_SEPARABLE ? corrected->action_gradient_by_coefficients_U : NULL;
    double error_per_distance = 0;
    ends_compute_momentum_term_abs_sums(corrected);
    for (int i = 0; i < curve_dimension(curve); i++) {
        error_per_distance =
            larger_relative_correction(curve, i, corrected->start_correction_q, corrected->increment_correction_q,
                                       fabs(curve->momentum_scale_factor[i]), seed_U, scale, error_per_distance);
        error_per_distance = larger_relative_correction(
            curve, i, corrected->start_correction_p, corrected->increment_correction_p, 1,
            corrected->action_gradient_by_coefficients_Q, corrected->momentum_term_abs_sum, error_per_distance);
    }
    return error_per_distance;
}

/* Tells whether the Jacobians must be computed anew at z. The first pass computes them. Later passes reuse them as long
 * as the bound of the resulting error, estimated from the corrections of the last pass, is below roundoff. */
static bool are_jacobians_due(const tvi_corrected_curve *corrected, const double z[], const double scale[])
{
    tvi_jacobian_factors *matrices = get_factors(corrected);
    if (matrices->jacobian_computations_in_step == 0) return true;
    const double distance = distance_since_jacobians(corrected, z, scale);
    if (distance * bound_stale_jacobian_error(corrected, scale) <= CURVE_NEGLIGIBLE_ERROR) return false;
    matrices->relative_distance_since_jacobian += distance;
    return true;
}

static void allocate_jacobian_factors(tvi_corrected_curve *corrected, tvi_arena *arena)
{
    const size_t n = (size_t)corrected->n;
    tvi_jacobian_factors *allocated = tvi_arena_allocate(arena, sizeof *allocated), m = {0};
    m.z_of_last_jacobians = tvi_arena_allocate_doubles(arena, 2 * n);
    m.scratch_end_state_jacobian = tvi_arena_allocate_doubles(arena, n * 2 * n);
    tvi_factor_allocate(&m.jacobian_block_factor, arena, corrected->n);
    tvi_factor_allocate(&m.full_jacobian_factor, arena, 2 * corrected->n);
    if (allocated) *allocated = m;
    corrected->solver_data = allocated;
}

/* ---- The equations ----------------------------------------------------------------------------------------------- */

static tvi_status factor_jacobian_block(tvi_corrected_curve *corrected)
{
    const size_t n = (size_t)corrected->n, first = corrected->definition->equations.has_last_columns ? n : 0;
    tvi_jacobian_factors *factors = get_factors(corrected);
    tvi_curve_sum_combination_jacobian(&corrected->curve, &corrected->ends[corrected->definition->equations.upper],
                                       factors->scratch_end_state_jacobian);
    for (size_t i = 0; i < n; i++)
        memcpy(factors->jacobian_block_factor.lu + i * n, factors->scratch_end_state_jacobian + i * 2 * n + first,
               n * sizeof(double));
    return tvi_factor_compute(&factors->jacobian_block_factor);
}

static tvi_status factor_full_matrix(tvi_corrected_curve *corrected)
{
    tvi_jacobian_factors *factors = get_factors(corrected);
    stack_combination_jacobians(corrected, &corrected->ends[corrected->definition->equations.upper],
                                &corrected->ends[corrected->definition->equations.lower],
                                factors->full_jacobian_factor.lu);
    return tvi_factor_compute(&factors->full_jacobian_factor);
}

/* The equations J^T x = D use one n x n half J of a Jacobian matrix (J K) and one half of the gradient, which x has
 * replaced. Subtracts K^T x from the other half of the gradient, which becomes the residual of the equations with K. */
static void compute_residual_in_unsolved_gradient_half(tvi_corrected_curve *corrected)
{
    const size_t n = (size_t)corrected->n, solved = corrected->definition->equations.has_last_columns ? n : 0,
                 other = n - solved;
    double *G = get_factors(corrected)->scratch_end_state_jacobian;
    tvi_curve_sum_combination_jacobian(&corrected->curve, &corrected->ends[corrected->definition->equations.upper], G);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            corrected->gradient_then_solution[other + j] -=
                corrected->gradient_then_solution[solved + i] * G[i * 2 * n + other + j];
}

static tvi_status solve_by_factors(tvi_corrected_curve *corrected)
{
    tvi_jacobian_factors *factors = get_factors(corrected);
    tvi_curve_multiply_transposed_jacobians_by_seeds(&corrected->curve, corrected->action_gradient_by_coefficients_Q,
                                                     corrected->action_gradient_by_coefficients_U,
                                                     corrected->gradient_then_solution);
    if (factors->jacobian_computations_when_last_factored != factors->jacobian_computations_in_step) {
        factors->jacobian_computations_when_last_factored = factors->jacobian_computations_in_step;
        const tvi_status status =
            corrected->definition->equations.lower ? factor_full_matrix(corrected) : factor_jacobian_block(corrected);
        if (status != TVI_OK) return status;
    }
    if (corrected->definition->equations.lower) {
        tvi_factor_solve_transposed(&factors->full_jacobian_factor, corrected->gradient_then_solution);
    } else {
        tvi_factor_solve_transposed(&factors->jacobian_block_factor,
                                    corrected->gradient_then_solution +
                                        (corrected->definition->equations.has_last_columns ? corrected->n : 0));
        compute_residual_in_unsolved_gradient_half(corrected);
    }
    return TVI_OK;
}

/* ---- The corrections --------------------------------------------------------------------------------------------- */

static tvi_status solve(tvi_corrected_curve *corrected, const double z[], const double scale[], tvi_stats *stats)
{
    if (are_jacobians_due(corrected, z, scale)) {
        tvi_curve_compute_jacobians(&corrected->curve);
        record_z_of_jacobians(corrected, z);
        stats->factorisations++;
    }
    return solve_by_factors(corrected);
}

const tvi_end_correction_solver tvi_solver_by_matrices = {allocate_jacobian_factors, discard_factors, solve,
                                                          renew_corrector_jacobian, NULL};
