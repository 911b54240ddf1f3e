/* tangents.h - computes the Jacobian matrices of a Taylor curve with respect to its centre state, in blocks of
 * tangent directions, and multiplies vectors by them. jacobian.c calls it; other files call the functions of
 * curve.h. */
#ifndef TVI_SRC_GENERATING_TANGENTS_H
#define TVI_SRC_GENERATING_TANGENTS_H

#include "generating/series.h"

/* The layout of a block of tangents in lane_count directions, of which the first is number first_direction: order k of
 * slot i begins at tangent_block + k * order_stride + i * lane_count. */
typedef struct {
    size_t lane_count, order_stride;
    int first_direction;
} curve_tangent_block;

/* Returns how many directions the block contains. They are fewer than its lanes if the last block is wider than the
 * number of directions left. */
static inline int curve_count_directions(const tvi_curve *curve, const curve_tangent_block *block)
{
    const int left = 2 * curve_dimension(curve) - block->first_direction;
    return left < (int)block->lane_count ? left : (int)block->lane_count;
}

static inline double *curve_tangent_row(const tvi_curve *curve, const curve_tangent_block *block, int k, int slot)
{
    return curve->tangent_block + (size_t)k * block->order_stride + (size_t)slot * block->lane_count;
}

static inline void curve_copy_lanes(size_t lanes, const double *in, double *restrict out)
{
    for (size_t lane = 0; lane < lanes; lane++) out[lane] = in[lane];
}

/* Sets the tangents of the inputs to unit vectors, one for each component of z. */
static inline void curve_set_unit_directions(tvi_curve *curve, const curve_tangent_block *block)
{
    const tvi_form form = curve_system_form(curve);
    const int n = curve_dimension(curve);
    for (int d = block->first_direction; d < block->first_direction + curve_count_directions(curve, block); d++) {
        const bool is_second = d >= n;
        double *row = is_second && form == TVI_SEPARABLE ? curve_tangent_row(curve, block, 1, d - n)
                                                         : curve_tangent_row(curve, block, 0, d);
        for (int lane = 0; lane < (int)block->lane_count; lane++)
            row[lane] = block->first_direction + lane == d ? 1 : 0;
        if (is_second && form == TVI_LAGRANGIAN) row[d - block->first_direction] = 1 / curve->time_unit;
    }
}

/* Prepares the block for a sweep: sets the tangents of the centre state to 0, and then to 1 in their own directions.
 * The tangents of the time and of constants are 0 in all orders; they are cleared when the number of lanes changes,
 * which moves them. */
static inline void curve_prepare_tangent_block(tvi_curve *curve, const curve_tangent_block *block)
{
    const size_t inputs = (size_t)curve_field_input_count(curve) * block->lane_count * sizeof(double);
    const size_t others = (size_t)(curve_uses_time(curve) + curve_field_tape_constant_slot_count(curve)) *
                          block->lane_count * sizeof(double);
    const int given = curve_system_form(curve) == TVI_SEPARABLE ? 2 : 1;
    for (int k = 0; k < given && k <= curve_highest_order(curve); k++)
        memset(curve_tangent_row(curve, block, k, 0), 0, inputs);
    for (int k = 0; k <= curve_highest_order(curve) && curve->tangent_block_lane_count != block->lane_count; k++)
        memset(curve_tangent_row(curve, block, k, curve_field_input_count(curve)), 0, others);
    curve->tangent_block_lane_count = block->lane_count;
    curve_set_unit_directions(curve, block);
}

/* Copies the tangents of n slots, one of each component, to the columns of the block's directions in a Jacobian, for
 * all orders. The slots are slot_of_component, or if that is NULL they follow first_slot. */
static inline void curve_store_jacobian_columns(const tvi_curve *curve, const curve_tangent_block *block,
                                                const int slot_of_component[], int first_slot, double *jacobian)
{
    const size_t n = (size_t)curve_dimension(curve);
    for (int k = 0; k <= curve_highest_order(curve); k++)
        for (size_t i = 0; i < n; i++) {
            const int slot = slot_of_component ? slot_of_component[i] : first_slot + (int)i;
            const double *tangent = curve_tangent_row(curve, block, k, slot);
            double *out = jacobian + ((size_t)k * n + i) * 2 * n + (size_t)block->first_direction;
            curve_copy_lanes((size_t)curve_count_directions(curve, block), tangent, out);
        }
}

static inline void curve_store_jacobians_from_tangents(tvi_curve *curve, const curve_tangent_block *block)
{
    const tvi_form form = curve_system_form(curve);
    const int n = curve_dimension(curve);
    if (form == TVI_LAGRANGIAN)
        curve_store_jacobian_columns(curve, block, curve->system->field_series->output_slot + n, 0, curve->dU_dz);
    if (form == TVI_HAMILTONIAN) curve_store_jacobian_columns(curve, block, NULL, n, curve->dU_dz);
    curve_store_jacobian_columns(curve, block, NULL, 0, curve->dQ_dz);
}

static inline const double *curve_coefficient_jacobians(const tvi_curve *curve, bool of_momentum)
{
    return of_momentum ? curve->dU_dz : curve->dQ_dz;
}

static inline void curve_sum_combination_jacobian(const tvi_curve *curve,
                                                  const tvi_coefficient_combination *combination, double matrix[])
{
    CURVE_COMBINE(curve->system->field_series, curve_highest_order(curve) + 1, combination->order_weight, 1,
                  2 * curve_dimension(curve) * curve_dimension(curve),
                  curve_coefficient_jacobians(curve, curve_sums_momentum_coefficients(curve, combination)), matrix);
}

static inline void curve_differentiate_sum_along_set_dz(const tvi_curve *curve,
                                                        const tvi_coefficient_combination *combination, double out[])
{
    const int directions = 2 * curve_dimension(curve);
    curve_sum_combination_jacobian(curve, combination, curve->combination_jacobian);
    for (int i = 0; i < curve_dimension(curve); i++) {
        const double *row = curve->combination_jacobian + i * directions;
        double sum = 0;
        for (int d = 0; d < directions; d++) sum += row[d] * curve->product_direction[d];
        out[i] = sum;
    }
}

static inline void curve_multiply_transposed_coefficient_jacobians(const tvi_curve *curve, bool of_momentum,
                                                                   const double seed[], double out[])
{
    const int n = curve_dimension(curve), directions = 2 * n, rows = (curve_highest_order(curve) + 1) * n;
    const double *J = curve_coefficient_jacobians(curve, of_momentum);
    CURVE_COMBINE(curve->system->field_series, rows, seed, 1, directions, J, out);
}

static inline void curve_multiply_transposed_jacobians_by_seeds(tvi_curve *curve, const double seed_Q[],
                                                                const double seed_U[], double out[])
{
    curve_multiply_transposed_coefficient_jacobians(curve, false, seed_Q, out);
    if (curve_system_form(curve) == TVI_SEPARABLE || !seed_U) return;
    curve_multiply_transposed_coefficient_jacobians(curve, true, seed_U, curve->product_with_dU_dz);
    for (int d = 0; d < 2 * curve_dimension(curve); d++) out[d] += curve->product_with_dU_dz[d];
}

#endif
