/* generated_curve.h - Defines the functions that generated code offers for the Taylor curve of one system and one
 * degree, such as the expansion of the series, its tangents, its tail and the fast-path step
 * (tvi_generated_curve_functions in seeds.h lists them). Only generated code includes it (emit.c), after the sweeps of
 * its tapes. The generated text before it defines the sizes as macros: those of series.h; CURVE_LANES, the number of
 * directions in one block of tangents; CURVE_REST, that of a smaller last block, or 0; and CURVE_ACTION. The macros
 * CURVE_HAS_MATRICES, CURVE_HAS_PRODUCTS, CURVE_HAS_SEED, CURVE_HAS_STEP and CURVE_HAS_STEP_SIZE say which functions
 * are defined. */
#ifndef TVI_SRC_GENERATING_GENERATED_CURVE_H
#define TVI_SRC_GENERATING_GENERATED_CURVE_H

#include "generating/curve_step.h"
#include "generating/orders.h"
#include "generating/products.h"
#include "generating/step_size.h"
#include "generating/seeds.h"
#include "generating/tangents.h"

/* ---- The series -------------------------------------------------------------------------------------------------- */

/* Order 0 is written before the loop, because the tape's function of this order is not that of the higher orders. */
#define FOR_ALL_ORDERS(ORDER)                                                                                          \
    ORDER(0) for (int k = 1; k <= CURVE_TOP; k++) { ORDER(k) }

#define EXPAND(k) curve_expand_order(curve, k, &status);
/* Expands the whole series. Returns TVI_EDOMAIN, TVI_ESINGULAR, or otherwise TVI_OK, even if coefficients are not
 * finite. */
JET_APART tvi_status code_expand_series(tvi_curve *curve)
{
    tvi_status status = TVI_OK;
    FOR_ALL_ORDERS(EXPAND) return status;
}
#undef EXPAND

static inline tvi_status code_expand_series_and_check_finite(tvi_curve *curve)
{
    const tvi_status status = code_expand_series(curve);
    return status != TVI_OK || curve_has_finite_coefficients(curve) ? status : TVI_ENONFINITE;
}

/* ---- Its tangents ------------------------------------------------------------------------------------------------ */

#if CURVE_HAS_MATRICES

#if CURVE_HAS_STEP

#define EXPAND_WITH_TANGENTS(k)                                                                                        \
    curve_expand_order(curve, k, &status);                                                                             \
    if (CURVE_FORM != TVI_LAGRANGIAN || status == TVI_OK) curve_compute_tangents_of_order(curve, &block, k);
/* Expands the whole series, and after each order computes its tangents in all directions, which the processor can do at
 * the same time as the next order. */
JET_APART tvi_status code_expand_with_tangents(tvi_curve *curve)
{
    const curve_tangent_block block = {CURVE_LANES, tvi_curve_order_stride(curve) * CURVE_LANES, 0};
    tvi_status status = TVI_OK;
    curve_prepare_tangent_block(curve, &block);
    FOR_ALL_ORDERS(EXPAND_WITH_TANGENTS) curve_store_jacobians_from_tangents(curve, &block);
    return status;
}
#undef EXPAND_WITH_TANGENTS

static inline void code_compute_jacobians(tvi_curve *curve) { (void)code_expand_with_tangents(curve); }

#else

#define DIFFERENTIATE(k) curve_compute_tangents_of_order(curve, &block, k);
/* Computes the tangents of the curve last expanded in `lanes` directions, which is a constant; first_direction is the
 * number of the first of them. */
static inline void code_compute_tangent_block(tvi_curve *curve, int lanes, int first_direction)
{
    const curve_tangent_block block = {(size_t)lanes, tvi_curve_order_stride(curve) * (size_t)lanes, first_direction};
    curve_prepare_tangent_block(curve, &block);
    FOR_ALL_ORDERS(DIFFERENTIATE) curve_store_jacobians_from_tangents(curve, &block);
}
#undef DIFFERENTIATE

/* Computes the tangents of the curve last expanded in all directions, block after block. */
static inline void code_compute_jacobians(tvi_curve *curve)
{
    int first = 0;
    for (; first == 0 || first + CURVE_LANES <= 2 * CURVE_N; first += CURVE_LANES)
        code_compute_tangent_block(curve, CURVE_LANES, first);
    if (CURVE_REST > 0) code_compute_tangent_block(curve, CURVE_REST, first);
}

#endif
#endif

/* ---- Seeds and steps --------------------------------------------------------------------------------------------- */

#if CURVE_HAS_SEED

static const tvi_action code_action = CURVE_ACTION;

JET_APART tvi_status code_compute_seeds(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    tvi_action sized_action = *action;
    sized_action.is_phase_space_action = code_action.is_phase_space_action;
    sized_action.omits_highest_order_at_nodes = code_action.omits_highest_order_at_nodes;
    sized_action.has_gradient_by_v = code_action.has_gradient_by_v;
    sized_action.has_gradient_by_p = code_action.has_gradient_by_p;
    sized_action.q_degree = code_action.q_degree;
    sized_action.p_degree = code_action.p_degree;
    sized_action.node_count = code_action.node_count;
    sized_action.order_count = code_action.order_count;
    sized_action.half_node_count = code_action.half_node_count;
    return seeds_compute_adjoint_seeds_from_field_only(&sized_action, curve, seed_Q, seed_U);
}

#endif
#if CURVE_HAS_STEP

static inline bool code_try_fast_path_step(tvi_curve_workspace *work, double tau, const tvi_batch_origin *origin,
                                           const tvi_fast_path_step_results *results, tvi_stats *stats)
{
    static const fast_path_expansion_and_seed_functions functions = {code_expand_series, code_expand_with_tangents,
                                                                     code_compute_seeds, NULL};
    return step_try_fast_path_steps(work, &functions, tau, origin, results, stats);
}

#endif
#if CURVE_HAS_PRODUCTS

static const tvi_end_correction_solver code_solver = {.begin = products_discard_guess,
                                                      .compute_corrections = products_compute_corrections,
                                                      .solve = products_solve_correction_equations,
                                                      .correct = products_apply_inverse_flow_jacobian};

#endif

static const tvi_generated_curve_functions tvi_loops = {
    .highest_order = CURVE_TOP,
    .expand = code_expand_series_and_check_finite,
    .sum_combination = curve_sum_combination,
    .centre_state_sizes = curve_compute_centre_state_sizes,
    .displacement_sizes = curve_compute_displacement_sizes,
    .tail = curve_compute_tail,
#if CURVE_HAS_MATRICES
    .differentiate = code_compute_jacobians,
    .sum_combination_jacobian = curve_sum_combination_jacobian,
    .differentiate_sum_along_set_dz = curve_differentiate_sum_along_set_dz,
    .multiply_transposed_jacobians_by_seeds = curve_multiply_transposed_jacobians_by_seeds,
#endif
#if CURVE_HAS_PRODUCTS
    .matrix_free_solver = &code_solver,
    .set_direction = products_compute_tangents,
    .differentiate_sum_along_set_dz = products_differentiate_sum_along_set_dz,
#endif
#if CURVE_HAS_SEED
    .compute_seeds = code_compute_seeds,
#endif
#if CURVE_HAS_STEP
    .fast_path_step = code_try_fast_path_step,
#endif
#if CURVE_HAS_STEP_SIZE
    .largest_usable_s = curve_estimate_largest_usable_s,
    .rescale_and_sum = curve_rescale_and_sum,
    .energy_change_bound = curve_bound_energy_change,
#endif
};

#endif
