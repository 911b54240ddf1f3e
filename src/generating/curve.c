/* curve.c - expands a Taylor curve: it solves the equations of motion by a recurrence for the coefficients. Steppers
 * call it in each pass (docs/method.md section 2):
 *
 *     separable    (k+1)(k+2) Q_{k+2} = tau^2 M^-1 [s^k] F
 *
 *     Lagrangian   (k+1) [s^{k+1}] L_v = tau [s^k] L_q, solved for the velocity's coefficient k+1 with L_vv at
 *         the centre
 *
 *     Hamiltonian  (k+1) Q_{k+1} = tau [s^k] H_p,  (k+1) P_{k+1} = -tau [s^k] H_q
 *
 * Here [s^k] x is the coefficient of s^k in the series of x. The field is evaluated as a power series along the curve,
 * one order after the other. */
#include "generating/curve_stepper.h"
#include "generating/orders.h"
#include "generating/step_size.h"

#include <math.h>
#include <string.h>

/* Allocates the blocks of tangents and adjoints, the Jacobians, and the velocity Hessian with its scratch. */
static void allocate_tangents_and_hessian(tvi_curve *curve, tvi_arena *arena)
{
    const tvi_system *system = curve->system;
    const size_t orders = (size_t)curve->highest_order + 1, n = (size_t)curve->n, jacobian = orders * n * 2 * n,
                 slots = (size_t)system->field_series->slot_count,
                 tangent_lanes = (size_t)tvi_choose_tangent_lane_count(system);
    if (curve->jacobian_method == TVI_JACOBIAN_PRODUCTS) {
        curve->tangent_block = tvi_arena_allocate_doubles(arena, orders * slots);
        curve->adjoint_block = tvi_arena_allocate_doubles(arena, orders * slots);
    }
    if (curve->jacobian_method == TVI_JACOBIAN_MATRICES) {
        curve->tangent_block = tvi_arena_allocate_doubles(arena, orders * slots * tangent_lanes);
        curve->product_direction = tvi_arena_allocate_doubles(arena, 2 * n);
        curve->dQ_dz = tvi_arena_allocate_doubles(arena, jacobian);
        curve->product_with_dU_dz = tvi_arena_allocate_doubles(arena, 2 * n);
        curve->combination_jacobian = tvi_arena_allocate_doubles(arena, 2 * n * n);
        curve->dU_dz = system->form == TVI_SEPARABLE ? NULL : tvi_arena_allocate_doubles(arena, jacobian);
    }
    if (system->form != TVI_SEPARABLE) {
        tvi_factor_allocate(&curve->velocity_hessian, arena, system->n);
        curve->slot_derivatives_by_velocity = tvi_arena_allocate_doubles(arena, slots * n);
        curve->velocity_right_sides = tvi_arena_allocate_doubles(arena, n * tangent_lanes);
        curve->right_side_column = tvi_arena_allocate_doubles(arena, n);
    }
}

void tvi_curve_allocate(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int highest_order,
                        tvi_jacobians jacobians)
{
    const size_t orders = (size_t)highest_order + 1, n = (size_t)system->n;
    memset(curve, 0, sizeof *curve);
    curve->system = system;
    curve->jacobian_method = jacobians;
    curve->n = system->n;
    curve->highest_order = highest_order;
    curve->momentum_scale_factor = tvi_arena_allocate_doubles(arena, n);
    curve->displacement_size = tvi_arena_allocate_doubles(arena, n);
    curve->momentum_size = tvi_arena_allocate_doubles(arena, n);
    curve->motion_share_for_tail = tvi_arena_allocate_doubles(arena, n);
    curve->last_term_ratio_for_tail = tvi_arena_allocate_doubles(arena, n);
    curve->displacement_size_weights = tvi_combination_allocate(curve, arena);
    curve->momentum_size_weights = tvi_combination_allocate(curve, arena);
    curve->reciprocal_integer = tvi_arena_allocate_doubles(arena, orders + 1);
    curve->log_integer = tvi_arena_allocate_doubles(arena, orders + 1);
    curve->series_block = tvi_arena_allocate_block(arena, system->field_series, highest_order + 1, 1, 0);
    allocate_tangents_and_hessian(curve, arena);
}

void tvi_curve_fill_constant_tables(tvi_curve *curve)
{
    for (int i = 0; i < curve->n; i++) curve->momentum_scale_factor[i] = 1;
    for (int k = 1; k <= curve->highest_order + 1; k++) {
        curve->reciprocal_integer[k] = 1.0 / k;
        curve->log_integer[k] = log(k);
    }
}

/* ---- Combinations ------------------------------------------------------------------------------------------------ */

tvi_coefficient_combination tvi_combination_allocate(const tvi_curve *curve, tvi_arena *arena)
{
    return (tvi_coefficient_combination){false, tvi_arena_allocate_doubles(arena, (size_t)curve->highest_order + 1)};
}

void tvi_combination_set_weights(tvi_coefficient_combination *combination, const tvi_curve *curve, bool of_momentum,
                                 const double weight[])
{
    /* The scaled momentum of a separable system has the coefficients U_k = (k+1) Q_{k+1}: the weight of Q_k is k times
     * that of U_{k-1}. */
    const bool shifts = of_momentum && curve->system->form == TVI_SEPARABLE;
    combination->is_of_momentum = of_momentum && !shifts;
    combination->order_weight[0] = shifts ? 0 : weight[0];
    for (int k = 1; k <= curve->highest_order; k++)
        combination->order_weight[k] = shifts ? k * weight[k - 1] : weight[k];
}

void tvi_combination_set_power_weights(tvi_coefficient_combination *combination, const tvi_curve *curve,
                                       bool of_momentum, int degree, double a, double s_a, double b, double s_b)
{
    double weight[TVI_MAX_DEGREE + 2] = {0};
    for (int k = 0; k <= degree; k++) weight[k] = a * pow(s_a, k) + b * pow(s_b, k);
    tvi_combination_set_weights(combination, curve, of_momentum, weight);
}

/* ---- The series -------------------------------------------------------------------------------------------------- */

tvi_status tvi_curve_factor_velocity_hessian(tvi_curve *curve)
{
    orders_differentiate_slots_by_velocity(curve);
    orders_copy_velocity_hessian(curve);
    return tvi_factor_compute(&curve->velocity_hessian);
}

tvi_status tvi_curve_expand(tvi_curve *curve, double centre)
{
    curve_set_centre_time(curve, centre, 0, 0);
    const tvi_status status = curve_expand_series(curve);
    return status != TVI_OK || curve_has_finite_coefficients(curve) ? status : TVI_ENONFINITE;
}

/* ---- Sums over the coefficients ---------------------------------------------------------------------------------- */

void tvi_curve_compute_centre_state_sizes(const tvi_curve *curve, double size[])
{
    curve_compute_centre_state_sizes(curve, size);
}

void tvi_curve_sum_combination(const tvi_curve *curve, const tvi_coefficient_combination *combination, double out[])
{
    curve_sum_combination(curve, combination, out);
}

void tvi_curve_set_summed_degrees(tvi_curve *curve, int q_degree, int p_degree)
{
    double weight[TVI_MAX_DEGREE + 2] = {0};
    curve->q_degree = q_degree;
    curve->p_degree = p_degree;
    for (int k = 0; k <= q_degree; k++) weight[k] = k;
    tvi_combination_set_weights(&curve->displacement_size_weights, curve, false, weight);
    for (int k = p_degree + 1; k <= q_degree; k++) weight[k] = 0;
    weight[0] = 1;
    tvi_combination_set_weights(&curve->momentum_size_weights, curve, true, weight);
}

void tvi_curve_compute_displacement_sizes(const tvi_curve *curve) { curve_compute_displacement_sizes(curve); }

double tvi_curve_compute_tail(const tvi_curve *curve) { return curve_compute_tail(curve); }

/* ---- Steps of adapted size --------------------------------------------------------------------------------------- */

double tvi_curve_estimate_largest_usable_s(const tvi_curve *curve, double log_tolerance)
{
    return curve_estimate_largest_usable_s(curve, log_tolerance);
}

void tvi_curve_rescale_and_sum(tvi_curve *curve, double factor, double dq[], double du[])
{
    tvi_choose_curve_isa_functions(curve->system->field_series)->rescale_and_sum(curve, factor, dq, du);
}

double tvi_curve_bound_energy_change(const tvi_curve *curve) { return curve_bound_energy_change(curve); }
