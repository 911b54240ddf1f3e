/* jacobian.c - computes the Jacobians of a Taylor curve with respect to its centre state as matrices, from tangents in
 * all directions. It also computes the Jacobians of sums of coefficients, and multiplies Jacobians by vectors, with the
 * matrices or without them (products.h). Steppers and solvers call it through curve.h. */
#include "generating/curve.h"
#include "generating/orders.h"
#include "generating/products.h"
#include "generating/seeds.h"
#include "generating/tangents.h"

#include <string.h>

tvi_jacobians tvi_curve_choose_jacobian_method(const tvi_system *system)
{
    return system->form == TVI_SEPARABLE && system->n >= PRODUCTS_MIN_COORDINATES ? TVI_JACOBIAN_PRODUCTS
                                                                                  : TVI_JACOBIAN_MATRICES;
}

/* ---- Matrices ---------------------------------------------------------------------------------------------------- */

void tvi_curve_compute_jacobians(tvi_curve *curve) { curve_compute_jacobians(curve); }

void tvi_curve_sum_combination_jacobian(const tvi_curve *curve, const tvi_coefficient_combination *combination,
                                        double matrix[])
{
    curve_sum_combination_jacobian(curve, combination, matrix);
}

tvi_tapes_of_steps tvi_curve_find_used_tapes(const tvi_system *system, const tvi_options *options, int points,
                                             tvi_jacobians jacobians)
{
    tvi_tapes_of_steps used = {
        .series_tape_emission = {.name_prefix = "tvi_series", .value_lane_counts = {1}, .needs_series_sweep = true}};
    if (jacobians == TVI_NO_JACOBIANS) return used;
    if (system->form == TVI_HAMILTONIAN)
        used.series_tape_emission.value_lane_counts[1] = points; /* for H_pp at the nodes, one lane for each node */
    used.value_tape_emission = (jet_emission_request){.name_prefix = "tvi_values", .value_lane_counts = {points}};
    if (system->r_dot_Hp_values && options->nodes == TVI_NODES_TRUNCATED)
        used.r_dot_Hp_tape_emission =
            (jet_emission_request){.name_prefix = "tvi_r_dot_Hp", .value_lane_counts = {points}};
    return used;
}

/* ---- Products with vectors --------------------------------------------------------------------------------------- */

void tvi_curve_set_product_direction(tvi_curve *curve, const double dz[])
{
    if (curve->jacobian_method == TVI_JACOBIAN_PRODUCTS) products_compute_tangents(curve, dz);
    else memcpy(curve->product_direction, dz, 2 * (size_t)curve->n * sizeof *dz);
}

void tvi_curve_differentiate_sum_along_set_dz(const tvi_curve *curve, const tvi_coefficient_combination *combination,
                                              double derivative[])
{
    if (curve->jacobian_method == TVI_JACOBIAN_PRODUCTS)
        products_differentiate_sum_along_set_dz(curve, combination, derivative);
    else curve_differentiate_sum_along_set_dz(curve, combination, derivative);
}

void tvi_curve_multiply_transposed_jacobians_by_seeds(tvi_curve *curve, const double seed_Q[], const double seed_U[],
                                                      double out[])
{
    if (curve->jacobian_method == TVI_JACOBIAN_PRODUCTS)
        products_multiply_by_transposed_jacobians(curve, curve->highest_order,
                                                  &(tvi_transposed_jacobian_operands){.seed_Q = seed_Q}, out);
    else curve_multiply_transposed_jacobians_by_seeds(curve, seed_Q, seed_U, out);
}
