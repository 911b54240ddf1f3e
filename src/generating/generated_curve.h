/* generated_curve.h - defines the functions of tvi_curve_code for one system and degree. Only generated code
 * includes it (emit.c), after the sweeps of its tapes. The generated text before it defines the sizes of series.h;
 * CURVE_LANES, the number of directions in one block of tangents; CURVE_REST, the number of directions left for a
 * last block; the action's sizes CURVE_ACTION; and the switches CURVE_HAS_MATRICES, CURVE_HAS_PRODUCTS,
 * CURVE_HAS_SEED, CURVE_HAS_STEP and CURVE_HAS_REACH, which say which functions are defined. */
#ifndef TVI_SRC_GENERATING_GENERATED_CURVE_H
#define TVI_SRC_GENERATING_GENERATED_CURVE_H

#include "generating/advance.h"
#include "generating/curve_step.h"
#include "generating/orders.h"
#include "generating/products.h"
#include "generating/reach.h"
#include "generating/seeds.h"
#include "generating/tangents.h"

/* ---- The series -------------------------------------------------------------------------------------------------- */

/* Order 0 is apart, since it is computed by other functions. */
#define FOR_ALL_ORDERS(ORDER)                                                                                          \
    ORDER(0) for (int k = 1; k <= CURVE_TOP; k++) { ORDER(k) }

#define EXPAND(k) curve_expand_order(curve, k, &status);
/* Expands the series. Returns TVI_EDOMAIN, TVI_ESINGULAR or otherwise TVI_OK, finite or not. */
JET_APART tvi_status code_series(tvi_curve *curve)
{
    tvi_status status = TVI_OK;
    FOR_ALL_ORDERS(EXPAND) return status;
}
#undef EXPAND

static inline tvi_status code_expand(tvi_curve *curve)
{
    const tvi_status status = code_series(curve);
    return status != TVI_OK || curve_has_finite_coefficients(curve) ? status : TVI_ENONFINITE;
}

/* ---- Its tangents ------------------------------------------------------------------------------------------------ */

#if CURVE_HAS_MATRICES

#if CURVE_HAS_STEP

#define EXPAND_WITH_TANGENTS(k)                                                                                        \
    curve_expand_order(curve, k, &status);                                                                             \
    if (CURVE_FORM != TVI_LAGRANGIAN || status == TVI_OK) curve_differentiate_order(curve, &block, k);
/* Expands the whole series, each order with its tangents in all directions, which do not wait for each other. */
JET_APART tvi_status code_series_and_tangents(tvi_curve *curve)
{
    const curve_tangent_block block = {CURVE_LANES, tvi_curve_slot_count(curve) * CURVE_LANES, 0};
    tvi_status status = TVI_OK;
    curve_clear_tangent_block(curve, &block);
    FOR_ALL_ORDERS(EXPAND_WITH_TANGENTS) curve_store_tangent_block(curve, &block);
    return status;
}
#undef EXPAND_WITH_TANGENTS

static inline void code_differentiate(tvi_curve *curve) { (void)code_series_and_tangents(curve); }

#else

#define DIFFERENTIATE(k) curve_differentiate_order(curve, &block, k);
/* Computes the tangents of the curve last expanded in `lanes` directions, a constant, from `first` on. */
static inline void code_differentiate_block(tvi_curve *curve, int lanes, int first)
{
    const curve_tangent_block block = {(size_t)lanes, tvi_curve_slot_count(curve) * (size_t)lanes, first};
    curve_clear_tangent_block(curve, &block);
    FOR_ALL_ORDERS(DIFFERENTIATE) curve_store_tangent_block(curve, &block);
}
#undef DIFFERENTIATE

/* Computes the blocks of all directions, in their order. */
static inline void code_differentiate(tvi_curve *curve)
{
    int first = 0;
    for (; first == 0 || first + CURVE_LANES <= 2 * CURVE_N; first += CURVE_LANES)
        code_differentiate_block(curve, CURVE_LANES, first);
    if (CURVE_REST > 0) code_differentiate_block(curve, CURVE_REST, first);
}

#endif
#endif

/* ---- Seeds and steps --------------------------------------------------------------------------------------------- */

#if CURVE_HAS_SEED

static const tvi_action code_action = CURVE_ACTION;

JET_APART tvi_status code_seed(tvi_action *given, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    tvi_action action = *given;
    action.is_hamilton = code_action.is_hamilton;
    action.has_truncated_nodes = code_action.has_truncated_nodes;
    action.has_velocity_defect = code_action.has_velocity_defect;
    action.has_momentum_defect = code_action.has_momentum_defect;
    action.q_degree = code_action.q_degree;
    action.p_degree = code_action.p_degree;
    action.points = code_action.points;
    action.orders = code_action.orders;
    action.half_points = code_action.half_points;
    return seeds_compute_from_field(&action, curve, seed_Q, seed_U);
}

#endif
#if CURVE_HAS_STEP

static inline bool code_step(tvi_curve_workspace *work, double tau, const tvi_batch_origin *origin,
                             const tvi_quick_step_results *end, tvi_stats *stats)
{
    static const step_curve_functions functions = {code_series, code_series_and_tangents, code_seed, NULL};
    return step_by_quick_passes(work, &functions, tau, origin, end, stats);
}

#endif
#if CURVE_HAS_PRODUCTS

static const tvi_closure_solver code_solver = {.begin = products_discard_guess,
                                               .close = products_compute_corrections,
                                               .solve = products_solve_equations,
                                               .correct = products_apply_inverse_flow_jacobian};

#endif

static const tvi_curve_code tvi_loops = {
    .top = CURVE_TOP,
    .expand = code_expand,
    .sum = curve_sum_combination,
    .sizes = curve_compute_data_sizes,
    .measure = curve_compute_size_sums,
    .tail = curve_compute_tail,
#if CURVE_HAS_MATRICES
    .differentiate = code_differentiate,
    .sum_jacobian = curve_sum_jacobian,
    .push = curve_multiply_by_jacobian,
    .pull = curve_multiply_by_transposes,
#endif
#if CURVE_HAS_PRODUCTS
    .solver = &code_solver,
    .aim = products_compute_tangents,
    .push = products_multiply_by_jacobian,
#endif
#if CURVE_HAS_SEED
    .seed = code_seed,
#endif
#if CURVE_HAS_STEP
    .step = code_step,
#endif
#if CURVE_HAS_REACH
    .reach = curve_estimate_usable_step,
    .end_at = curve_rescale_and_sum,
    .change = curve_bound_energy_change,
#endif
};

#endif
