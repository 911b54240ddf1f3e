/* series.h - holds the coefficients of a curve, and sums them. Other headers of curves call its inline functions;
 * steppers and solvers mostly call the functions of curve.h. */
#ifndef TVI_SRC_GENERATING_SERIES_H
#define TVI_SRC_GENERATING_SERIES_H

#include "algebra/linear_small.h"
#include "algebra/sizes.h"
#include "algebra/tail.h"
#include "algebra/weigh.h"
#include "generating/in_library.h"
#include "system/system.h"

/* How the Jacobians of a curve are used: not at all; as matrices, from tangents in all 2n directions; or only in
 * products with vectors, each by one adjoint or one tangent sweep, whose cost is a small multiple of the expansion's
 * for any n. */
typedef enum { TVI_NO_JACOBIANS, TVI_JACOBIAN_MATRICES, TVI_JACOBIAN_PRODUCTS } tvi_jacobians;

/* A linear combination of the curve's coefficients, sum_k weight_k Q_k or sum_k weight_k U_k. A method sets its
 * combinations once. */
typedef struct {
    bool is_of_momentum;  /* the U_k of the momentum are combined, and not the Q_k of the position */
    double *order_weight; /* [highest_order + 1] the weight of the coefficient of each order */
} tvi_coefficient_combination;

typedef struct {
    const tvi_system *system;
    tvi_jacobians jacobian_method;
    int n, highest_order;          /* the number of coordinates, and the highest order of Q that is computed */
    double time_unit;              /* the time unit tau: t = time of the centre + tau s */
    double *momentum_scale_factor; /* [n] the factor kappa that scales the momentum, U_k = kappa P_k */
    double *series_block;          /* block of the series of the field, orders 0 .. highest_order */
    /* The derivatives of all slots along directions of the centre state. A sweep computes at most
     * tvi_choose_tangent_lane_count directions, and one direction for products. */
    double *tangent_block;
    size_t tangent_block_lane_count; /* the number of lanes with which tangent_block was last cleared; 0: never */
    double *adjoint_block;           /* the adjoints of all slots in all orders; only for products */
    /* [highest_order + 1][n][2n] The Jacobian matrices dQ_k/dz and dU_k/dz; dU_dz is NULL for a separable system. */
    double *dQ_dz, *dU_dz;
    double *product_direction;    /* [2n] the direction set by tvi_curve_set_product_direction */
    double *product_with_dU_dz;   /* [2n] scratch: sum_k (dU_k/dz)^T g_k, with g_k the derivatives of a scalar by U_k */
    double *combination_jacobian; /* [n][2n] scratch: the Jacobian of a combination's sum */
    double *reciprocal_integer, *log_integer; /* [highest_order + 2] the numbers 1 / k and log k for each order k */
    int q_degree, p_degree;                   /* the degrees to which q and p are summed */
    tvi_coefficient_combination displacement_size_weights, momentum_size_weights;
    double *displacement_size, *momentum_size; /* [n] sum_k k |Q_k|, and |U_0| + sum_k k |U_k| */
    /* [n] Scratch of the tail: each component's share of the motion, and the larger ratio of a last term to its sum. */
    double *motion_share_for_tail, *last_term_ratio_for_tail;
    tvi_lu_factor velocity_hessian; /* L_vv or H_pp at the centre; unused if separable */
    /* [slots][n] The derivatives of all slots by the second input, v or p, at the centre. */
    double *slot_derivatives_by_velocity;
    /* Scratch for solving with velocity_hessian: right sides [n][lanes], and one column [n]. */
    double *velocity_right_sides, *right_side_column;
} tvi_curve;

/* ---- The sizes --------------------------------------------------------------------------------------------------- */

static inline int curve_dimension(const tvi_curve *curve) { return curve->n; }

static inline int curve_highest_order(const tvi_curve *curve) { return curve->highest_order; }

/* curve_q_degree and curve_p_degree return the degrees to which Q and P are summed. */
static inline int curve_q_degree(const tvi_curve *curve) { return curve->q_degree; }

static inline int curve_p_degree(const tvi_curve *curve) { return curve->p_degree; }

static inline int curve_field_input_count(const tvi_curve *curve) { return curve->system->input_count; }

static inline int curve_field_tape_constant_slot_count(const tvi_curve *curve)
{
    return curve->system->field_series->constant_count;
}

static inline bool curve_uses_time(const tvi_curve *curve) { return curve->system->uses_time; }

static inline tvi_form curve_system_form(const tvi_curve *curve) { return curve->system->form; }

/* Returns the slots of the field's outputs. */
static inline const int *curve_field_output_slots(const tvi_curve *curve)
{
    return curve->system->field_series->output_slot;
}

static inline int curve_field_output_slot(const tvi_curve *curve, int i) { return curve_field_output_slots(curve)[i]; }

/* Returns whether a combination sums coefficients of the momentum; a separable system's momentum is summed from those
 * of q. */
static inline bool curve_sums_momentum_coefficients(const tvi_curve *curve,
                                                    const tvi_coefficient_combination *combination)
{
    return curve_system_form(curve) != TVI_SEPARABLE && combination->is_of_momentum;
}

/* ---- The block of the series ------------------------------------------------------------------------------------- */

/* Returns the distance, in numbers, from one order of the series' block to the next: its slots. */
static inline size_t tvi_curve_order_stride(const tvi_curve *curve)
{
    return (size_t)curve->system->field_series->slot_count;
}

/* Returns the number of tangent directions of one sweep. Small systems have all directions in one sweep, since a partly
 * filled vector costs less than a second sweep. */
static inline int tvi_choose_tangent_lane_count(const tvi_system *system)
{
    const int directions = 2 * system->n;
    const bool is_small =
        directions <= 4 || (directions > CURVE_TANGENT_DIRECTIONS && directions <= 2 * CURVE_TANGENT_DIRECTIONS);
    return is_small ? directions : CURVE_TANGENT_DIRECTIONS;
}

/* Returns the inputs of order k: q, then the velocity of a Lagrangian or the momentum of a Hamiltonian. */
static inline double *tvi_curve_field_inputs_of_order(const tvi_curve *curve, int k)
{
    return curve->series_block + (size_t)k * tvi_curve_order_stride(curve);
}

/* Returns output i of the field at order k. */
static inline double tvi_curve_field_output(const tvi_curve *curve, int k, int i)
{
    return tvi_curve_field_inputs_of_order(curve, k)[curve_field_output_slot(curve, i)];
}

/* ---- Where it starts --------------------------------------------------------------------------------------------- */

/* Sets the time unit tau of the curve, and the scale of its momenta that follows from it, kappa = tau/m for a separable
 * system. */
static inline void curve_set_time_unit(tvi_curve *curve, double tau)
{
    curve->time_unit = tau;
    for (int i = 0; i < curve_dimension(curve) && curve_system_form(curve) == TVI_SEPARABLE; i++)
        curve->momentum_scale_factor[i] = tau / curve->system->mass[i];
}

/* Writes the centre state z into the block of the series. The second half of z is tau v for a Lagrangian. */
static inline void curve_set_centre_state(const tvi_curve *curve, const double z[])
{
    const int numbers = curve_dimension(curve);
    const bool is_separable = curve_system_form(curve) == TVI_SEPARABLE;
    double *q = tvi_curve_field_inputs_of_order(curve, 0),
           *second = is_separable ? tvi_curve_field_inputs_of_order(curve, 1) : q + numbers;
    const double part = curve_system_form(curve) == TVI_LAGRANGIAN ? curve->time_unit : 1;
    for (int i = 0; i < numbers; i++) {
        q[i] = z[i];
        second[i] = z[numbers + i] / part;
    }
}

/* Returns the address of the time at order k in the block, for systems that use the time. */
static inline double *curve_time_slot(const tvi_curve *curve, int k)
{
    return tvi_curve_field_inputs_of_order(curve, k) + curve_field_input_count(curve);
}

/* Sets the time of the centre to t + (t_low + time_offset). */
static inline void curve_set_centre_time(const tvi_curve *curve, double t, double t_low, double time_offset)
{
    if (!curve_uses_time(curve)) return;
    *curve_time_slot(curve, 0) = t + (t_low + time_offset);
    if (curve_highest_order(curve) > 0) *curve_time_slot(curve, 1) = curve->time_unit;
}

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

/* Returns U_k = kappa P_k of component i. */
static inline double tvi_curve_momentum_coefficient(const tvi_curve *curve, int k, int i)
{
    switch (curve_system_form(curve)) {
    case TVI_SEPARABLE:
        return k < curve_highest_order(curve) ? (k + 1) * tvi_curve_field_inputs_of_order(curve, k + 1)[i] : 0;
    case TVI_LAGRANGIAN: return tvi_curve_field_output(curve, k, curve_dimension(curve) + i);
    default: return (tvi_curve_field_inputs_of_order(curve, k) + curve_dimension(curve))[i];
    }
}

/* Returns the coefficients Q_k, [n]. */
static inline const double *tvi_curve_position_coefficients(const tvi_curve *curve, int k)
{
    return tvi_curve_field_inputs_of_order(curve, k);
}

static inline bool curve_has_finite_coefficients(const tvi_curve *curve)
{
    return tvi_rows_are_finite(curve_highest_order(curve) + 1, tvi_curve_order_stride(curve),
                               curve_field_input_count(curve), curve->series_block);
}

/* Computes the natural sizes of the numbers of the centre state z [2n]: sum_k |Q_k|, and sum_{k>=1} |Q_k| for tau v or
 * sum_k |P_k| for p. */
static inline void curve_compute_centre_state_sizes(const tvi_curve *curve, double size[])
{
    const int numbers = curve_dimension(curve);
    const bool hamiltonian = curve_system_form(curve) == TVI_HAMILTONIAN;
    memset(size, 0, 2 * (size_t)numbers * sizeof *size);
    for (int k = curve_highest_order(curve); k >= 0; k--) {
        const double *Q = tvi_curve_position_coefficients(curve, k), *second = hamiltonian ? Q + numbers : Q;
        for (int i = 0; i < numbers; i++) {
            size[i] += fabs(Q[i]);
            if (k > 0 || hamiltonian) size[numbers + i] += fabs(second[i]);
        }
    }
}

/* Computes P_k of all orders k, [degree + 1][n]. */
static inline void curve_compute_momentum_coefficients(const tvi_curve *curve, int degree, double out[])
{
    const int n = curve_dimension(curve);
    for (int k = 0; k <= degree; k++, out += n)
        for (int i = 0; i < n; i++)
            out[i] = tvi_curve_momentum_coefficient(curve, k, i) / curve->momentum_scale_factor[i];
}

typedef void curve_row_adder(size_t, const double[], size_t, size_t, const double[], double[]);

static inline void curve_sum_combination_with_adder(curve_row_adder *add, const tvi_curve *curve,
                                                    const tvi_coefficient_combination *combination, double out[])
{
    const int n = curve_dimension(curve), numbers = curve_dimension(curve);
    memset(out, 0, (size_t)numbers * sizeof *out);
    const size_t orders = (size_t)curve_highest_order(curve) + 1, stride = tvi_curve_order_stride(curve);
    if (curve_sums_momentum_coefficients(curve, combination) && curve_system_form(curve) == TVI_LAGRANGIAN)
        for (int i = 0; i < n; i++)
            add(orders, combination->order_weight, stride, 1,
                curve->series_block + curve_field_output_slot(curve, n + i), out + i);
    else
        add(orders, combination->order_weight, stride, (size_t)numbers,
            curve->series_block + (curve_sums_momentum_coefficients(curve, combination) ? numbers : 0), out);
}

static inline void curve_sum_combination(const tvi_curve *curve, const tvi_coefficient_combination *combination,
                                         double out[])
{
    curve_sum_combination_with_adder(tvi_add_weighted_rows, curve, combination, out);
}

/* Returns, for component i, the magnitudes from which the tail is computed (tail.h). momentum_size is |U_0| + sum_k k
 * |U_k|, and displacement_size is sum_k k |Q_k|; these sums bound du/ds and dq/ds at the ends of the step.
 * p_change_by_last_term and q_change_by_last_term are the last terms of the two sums; q_change_by_last_term is 0 for a
 * separable system. coordinate_size is |Q_0|. */
static inline tvi_component_sizes_in_step curve_compute_tail_inputs_of_component(const tvi_curve *curve, int i)
{
    const int q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    const bool has_masses = curve_system_form(curve) == TVI_SEPARABLE;
    const double momentum = curve->momentum_size[i], movement = curve->displacement_size[i];
    return (tvi_component_sizes_in_step){
        .momentum_size = momentum,
        .q_change_size = movement,
        .p_change_by_last_term = p_degree * fabs(tvi_curve_momentum_coefficient(curve, p_degree, i)),
        .q_change_by_last_term = has_masses ? 0 : q_degree * fabs(tvi_curve_position_coefficients(curve, q_degree)[i]),
        .coordinate_size = fabs(tvi_curve_position_coefficients(curve, 0)[i]),
        .one_over_momentum_size = 1 / tvi_larger(momentum, TVI_LEAST_SIZE),
        .one_over_q_change_size = 1 / tvi_larger(movement, TVI_LEAST_SIZE)};
}

static inline void curve_compute_displacement_sizes(const tvi_curve *curve)
{
    curve_sum_combination_with_adder(tvi_add_weighted_magnitudes, curve, &curve->displacement_size_weights,
                                     curve->displacement_size);
    curve_sum_combination_with_adder(tvi_add_weighted_magnitudes, curve, &curve->momentum_size_weights,
                                     curve->momentum_size);
}

/* Computes the tail (tvi_stats.tail): the last term relative to the momentum or the movement. */
static inline double curve_compute_tail(const tvi_curve *curve)
{
    double *share = curve->motion_share_for_tail, *ratio = curve->last_term_ratio_for_tail;
    if (curve_p_degree(curve) < 2) return 0;
    for (int i = 0; i < curve_dimension(curve); i++) {
        const tvi_component_sizes_in_step component = curve_compute_tail_inputs_of_component(curve, i);
        share[i] = tvi_component_motion_share(&component, curve->system->has_tail_shares_without_momenta);
        ratio[i] = tvi_component_last_term_ratio(&component);
    }
    return tvi_compute_tail(&curve->system->tail_subsystems, curve_dimension(curve), share, ratio);
}

/* Returns a bound of the energy change |q'| |dp| + |p'| |dq| by the omitted terms dq and dp. The bound is a multiple of
 * the energy change by the last two terms, since one of the two may be small by chance. If each term is at most three
 * quarters of the one before it, all omitted terms add up to three times the last. */
static inline double curve_bound_energy_change(const tvi_curve *curve)
{
    double sum = 0;
    const int q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    if (p_degree < 2) return INFINITY;
    for (int i = 0; i < curve_dimension(curve); i++) {
        double of_q = 0, of_p = 0;
        for (int last = 0; last < 2; last++) {
            of_q += fabs(tvi_curve_position_coefficients(curve, q_degree - last)[i]);
            of_p += fabs(tvi_curve_momentum_coefficient(curve, p_degree - last, i));
        }
        sum += (curve->displacement_size[i] * of_p + curve->momentum_size[i] * of_q) /
               fabs(curve->momentum_scale_factor[i]);
    }
    return CURVE_ENERGY_BOUND_FACTOR * sum / fabs(curve->time_unit);
}

#endif
