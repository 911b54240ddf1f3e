/* matrices.c - solves A^T x = D_z for the corrections of the curve's ends, with D_z the gradient of the discrete action
 * in defect form (action.h) and A made of Jacobian matrices of the ends. It factors them, and reuses the factors as
 * long as the resulting error is below roundoff. corrected_curve.c calls it through tvi_solver_by_matrices. */
#include "generating/curve.h"
#include "generating/matrices.h"

#include <string.h>

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

static tvi_status factor_jacobian_block(tvi_corrected_curve *corrected, const tvi_end_correction_equations *equations)
{
    const size_t n = (size_t)corrected->n,
                 first = equations->jacobian_half_used_as_equation_matrix == TVI_FIRST_COLUMNS ? 0 : n;
    tvi_jacobian_factors *factors = matrices_get_factors(corrected);
    tvi_curve_sum_combination_jacobian(&corrected->curve, equations->upper_jacobian_combination,
                                       factors->scratch_end_state_jacobian);
    for (size_t i = 0; i < n; i++)
        memcpy(factors->jacobian_block_factor.lu + i * n, factors->scratch_end_state_jacobian + i * 2 * n + first,
               n * sizeof(double));
    return tvi_factor_compute(&factors->jacobian_block_factor);
}

static tvi_status factor_full_matrix(tvi_corrected_curve *corrected, const tvi_end_correction_equations *equations)
{
    tvi_jacobian_factors *factors = matrices_get_factors(corrected);
    matrices_stack_combination_jacobians(corrected, equations->upper_jacobian_combination,
                                         equations->lower_jacobian_combination, factors->full_jacobian_factor.lu);
    return tvi_factor_compute(&factors->full_jacobian_factor);
}

/* The equations J^T x = D use one n x n half J of a Jacobian matrix (J K) and one half of the gradient, which x has
 * replaced. Subtracts K^T x from the other half of the gradient, which becomes the residual of the equations with K. */
static void compute_residual_in_unsolved_gradient_half(tvi_corrected_curve *corrected,
                                                       const tvi_end_correction_equations *equations)
{
    const size_t n = (size_t)corrected->n,
                 solved = equations->jacobian_half_used_as_equation_matrix == TVI_FIRST_COLUMNS ? 0 : n,
                 other = n - solved;
    double *G = matrices_get_factors(corrected)->scratch_end_state_jacobian;
    tvi_curve_sum_combination_jacobian(&corrected->curve, equations->upper_jacobian_combination, G);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            corrected->gradient_then_solution[other + j] -=
                corrected->gradient_then_solution[solved + i] * G[i * 2 * n + other + j];
}

static tvi_status solve_by_factors(tvi_corrected_curve *corrected, const tvi_end_correction_equations *equations)
{
    tvi_jacobian_factors *factors = matrices_get_factors(corrected);
    tvi_curve_multiply_transposed_jacobians_by_seeds(&corrected->curve, corrected->action_gradient_by_coefficients_Q,
                                                     corrected->action_gradient_by_coefficients_U,
                                                     corrected->gradient_then_solution);
    if (factors->jacobian_computations_when_last_factored != factors->jacobian_computations_in_step) {
        factors->jacobian_computations_when_last_factored = factors->jacobian_computations_in_step;
        const tvi_status status = equations->lower_jacobian_combination ? factor_full_matrix(corrected, equations)
                                                                        : factor_jacobian_block(corrected, equations);
        if (status != TVI_OK) return status;
    }
    if (equations->lower_jacobian_combination) {
        tvi_factor_solve_transposed(&factors->full_jacobian_factor, corrected->gradient_then_solution);
    } else {
        tvi_factor_solve_transposed(
            &factors->jacobian_block_factor,
            corrected->gradient_then_solution +
                (equations->jacobian_half_used_as_equation_matrix == TVI_FIRST_COLUMNS ? 0 : corrected->n));
        compute_residual_in_unsolved_gradient_half(corrected, equations);
    }
    return TVI_OK;
}

/* Computes the corrector's Jacobian anew if the stored one is outdated. Returns true if it did, and false if the
 * corrector may reuse the stored one. */
static bool renew_jacobian_if_outdated(const tvi_corrected_curve *corrected, double jacobian[])
{
    return matrices_renew_corrector_jacobian(corrected, jacobian);
}

/* ---- The corrections --------------------------------------------------------------------------------------------- */

static tvi_status compute_corrections(tvi_corrected_curve *corrected, const double z[], const double scale[],
                                      tvi_stats *stats)
{
    if (matrices_are_jacobians_due(corrected, z, scale)) {
        tvi_curve_compute_jacobians(&corrected->curve);
        matrices_record_z_of_jacobians(corrected, z);
        stats->factorisations++;
    }
    return corrected->solve_end_corrections(corrected);
}

const tvi_end_correction_solver tvi_solver_by_matrices = {allocate_jacobian_factors,  matrices_discard_factors,
                                                          compute_corrections,        solve_by_factors,
                                                          renew_jacobian_if_outdated, NULL};
