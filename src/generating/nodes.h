/* nodes.h - evaluates the Taylor curve and the field at the nodes of the discrete action. seeds.h calls it in each
 * pass. */
#ifndef TVI_SRC_GENERATING_NODES_H
#define TVI_SRC_GENERATING_NODES_H

#include "algebra/sizes.h"
#include "fused.h"
#include "generating/series.h"
#include "system/roundoff.h"
#include "vector.h"

/* The powers s_i^k of the nodes s_i, or their derivatives, or these times the weights. values_of_all_orders has the
 * rows of nodes, [highest_order + 1][node_count]. If nodes mirror each other, values_of_even_orders and
 * values_of_odd_orders have the even and the odd k at the first half of the nodes, [(order_count + 1) /
 * 2][half_node_count]; the values at the other half differ by a sign only. Weighted tables are for sums over the nodes;
 * they are transposed, [node_count][highest_order + 1] and [half_node_count][seeds_round_up_to_vectors((order_count +
 * 1) / 2)]. */
typedef struct {
    double *values_of_all_orders, *values_of_even_orders, *values_of_odd_orders;
    /* The sign by which the rows of even k at a node are multiplied to get those at its mirror node, 1 or -1. It is 1
     * for powers and second derivatives, and -1 for first derivatives. */
    double mirror_sign;
} tvi_node_table;

typedef struct tvi_action {
    bool is_phase_space_action;        /* the action is an integral of p.q' - H by t; otherwise of L */
    bool omits_highest_order_at_nodes; /* the positions at the nodes omit the highest order */
    /* The tape of the field at the nodes; it also has tangents if momenta must be found from velocities. */
    const jet_tape *field_tape;
    bool has_gradient_by_v; /* gradient_by_v = L_v - p can differ from 0 */
    bool has_gradient_by_p; /* gradient_by_p = dg/ds - tau H_p can differ from 0 */
    int q_degree, p_degree; /* the degrees to which position and momentum are summed */
    int node_count;         /* the number of nodes, with those that pad a half */
    int order_count;        /* the number of orders of the curve, highest_order + 1 */
    /* [node_count] The nodes s_i in scaled time, and their weights, whose sum is end_s - start_s. */
    double *node_scaled_time, *node_weight;
    /* The number of nodes in a mirrored half, padded to whole vectors, or 0 if the nodes do not mirror each other or if
     * the seeds need second derivatives. The nodes of the first half are first, and their mirror images follow. A node
     * at the centre is in both halves, with half its weight in each; nodes that pad a half repeat its first node with
     * weight 0. */
    int half_node_count;
    /* The powers s_i^k and their derivatives; 0 for k > q_degree. */
    tvi_node_table power_table, slope_table;
    /* The second derivatives of the powers, for all orders. */
    tvi_node_table power_second_derivative_table;
    /* The powers s_i^k by which Q_k is multiplied in the sum q_i; for truncated nodes those of the highest order are 0.
     */
    tvi_node_table power_table_truncated_by_node_rule;
    /* power_table and slope_table times the weights of the nodes. */
    tvi_node_table weighted_power_table, weighted_slope_table;
    double *node_sums_by_order; /* [highest_order + 1] scratch: sums over the nodes for each order */
    /* [highest_order + 1][highest_order + 1] (j+k) times the error of the quadrature for s^(j+k-1), for the orders j of
     * the momentum and k of the position. The summation by parts of seeds.h adds these numbers to the action's
     * gradient. NULL if all of them are 0. */
    double *summation_by_parts_error;
    double *field_tape_values_at_nodes; /* the values of all slots of the field's tape, with one lane for each node */
    /* The block of the tape that computes the products H_qp p and H_pp p of a Hamiltonian at the nodes, for positions
     * that omit the highest order. */
    double *hessian_product_block;
    double *momentum_coefficients; /* [p_degree + 1][n] the coefficients P_k of the momentum */
    /* [n][node_count] The curve's momentum p and its derivative dp/ds at the nodes. */
    double *p_at_nodes, *dp_ds_at_nodes;
    /* [n][node_count] The derivatives of the action by q_i, tau v_i and p_i at node i, without the weight of the node.
     */
    double *gradient_by_q, *gradient_by_v, *gradient_by_p;
    /* [n][node_count] The last correction of the node momenta that belong to given velocities. */
    double *node_momentum_correction;
    double *H_pp; /* [n][n][node_count] H_pp at the nodes, or its inverse */
    /* The block of the field's tangent in one direction, with one lane for each node. */
    double *field_tangent_block;
    tvi_roundoff_estimator field_roundoff; /* the roundoff of the field at the nodes */
} tvi_action;

/* ---- The curve at the nodes -------------------------------------------------------------------------------------- */

/* SEEDS_HALF is the largest number of even orders or of odd orders of a curve, padded to whole vectors. */
enum { SEEDS_HALF = (TVI_MAX_DEGREE + 2) / 2 + 4 };
static inline int seeds_round_up_to_vectors(int count) { return (count + 3) / 4 * 4; }

/* Computes out[o] = sum_{j < row_count} c_j table[j][o] for o < row_length, with c_j = coefficient[j *
 * stride]. */
static inline void seeds_combine_rows(const tvi_action *action, int row_count, const double *coefficient, size_t stride,
                                      int row_length, const double *table, double *out)
{
    CURVE_COMBINE(action->field_tape, row_count, coefficient, stride, row_length, table, out);
}

/* Evaluates a series at the nodes: row[node] = sum_{k <= degree} c_k table_k(node), with the coefficients c_k =
 * coefficients[k * stride]. */
static inline void seeds_evaluate_series_at_nodes(const tvi_action *action, int degree, const double *coefficients,
                                                  size_t stride, const tvi_node_table *table, double row[])
{
    const int lanes = action->node_count / 2;
    double even[SEEDS_HALF], odd[SEEDS_HALF];
    if (action->half_node_count == 0) {
        seeds_combine_rows(action, degree + 1, coefficients, stride, action->node_count, table->values_of_all_orders,
                           row);
        return;
    }
    seeds_combine_rows(action, degree / 2 + 1, coefficients, 2 * stride, action->half_node_count,
                       table->values_of_even_orders, even);
    seeds_combine_rows(action, (degree + 1) / 2, coefficients + stride, 2 * stride, action->half_node_count,
                       table->values_of_odd_orders, odd);
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) row[i] = even[i] + odd[i];
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) row[lanes + i] = table->mirror_sign * (even[i] - odd[i]);
}

static inline void seeds_set_node_times(const tvi_action *action, const tvi_curve *curve, double *x)
{
    double *t = x + curve_field_input_count(curve) * action->node_count;
    if (!curve_uses_time(curve)) return;
    for (int node = 0; node < action->node_count; node++)
        t[node] = JET_FUSED(jet_v1, curve->time_unit, action->node_scaled_time[node], *curve_time_slot(curve, 0));
}

/* Writes the curve's coordinates q_i at the nodes, and the times of the nodes, into the inputs of the block x. */
static inline void seeds_set_node_coordinates_and_times(const tvi_action *action, const tvi_curve *curve, double *x)
{
    for (int i = 0; i < curve_dimension(curve); i++)
        seeds_evaluate_series_at_nodes(action, action->q_degree, tvi_curve_position_coefficients(curve, 0) + i,
                                       tvi_curve_order_stride(curve), &action->power_table_truncated_by_node_rule,
                                       x + i * action->node_count);
    seeds_set_node_times(action, curve, x);
}

/* Computes the velocities v = (dq/ds)/tau at the nodes. */
static inline void seeds_set_node_velocities(const tvi_action *action, const tvi_curve *curve, double *v)
{
    const int lanes = action->node_count;
    for (int i = 0; i < curve_dimension(curve); i++) {
        seeds_evaluate_series_at_nodes(action, action->q_degree, tvi_curve_position_coefficients(curve, 0) + i,
                                       tvi_curve_order_stride(curve), &action->slope_table, v + i * lanes);
        for (int at = i * lanes; at < (i + 1) * lanes; at++) v[at] /= curve->time_unit;
    }
}

/* Computes the coefficients of the curve's momentum, and its values at the nodes if Hamilton's action or gradient_by_v
 * needs them. Nothing is computed for a separable system whose action needs no such values and has no quadrature error.
 */
static inline void seeds_compute_node_momenta(tvi_action *action, const tvi_curve *curve)
{
    const int lanes = action->node_count, degree = action->p_degree;
    const bool has_momenta = action->is_phase_space_action || action->has_gradient_by_v;
    if (!has_momenta && !action->summation_by_parts_error && curve_system_form(curve) == TVI_SEPARABLE) return;
    curve_compute_momentum_coefficients(curve, degree, action->momentum_coefficients);
    if (!has_momenta) return;
    for (int i = 0; i < curve_dimension(curve); i++)
        seeds_evaluate_series_at_nodes(action, degree, action->momentum_coefficients + i,
                                       (size_t)curve_dimension(curve), &action->power_table,
                                       action->p_at_nodes + i * lanes);
}

/* Divides the row by `divisor`: each number is multiplied by the reciprocal, and the quotient is corrected by the
 * remainder. Many divisions would be slower. */
static inline void seeds_divide_row(int lanes, double divisor, double row[])
{
    const double inverse = 1 / divisor;
    JET_IN_VECTORS
    for (int node = 0; node < lanes; node++) {
        const double quotient = row[node] * inverse;
        row[node] = quotient + inverse * (row[node] - quotient * divisor);
    }
}

/* Computes dp/ds, the derivative of the curve's momentum by scaled time, at the nodes. For a separable system it is M
 * q'' / tau, with q'' the second derivative in s. */
static inline void seeds_compute_dp_ds_at_nodes(tvi_action *action, const tvi_curve *curve)
{
    const int lanes = action->node_count, degree = action->p_degree;
    const size_t stride = tvi_curve_order_stride(curve);
    double *force = action->dp_ds_at_nodes;
    for (int i = 0; i < curve_dimension(curve); i++, force += lanes)
        if (curve_system_form(curve) == TVI_SEPARABLE) {
            seeds_evaluate_series_at_nodes(action, degree + 1, tvi_curve_position_coefficients(curve, 0) + i, stride,
                                           &action->power_second_derivative_table, force);
            seeds_divide_row(lanes, curve->momentum_scale_factor[i], force);
        } else {
            seeds_evaluate_series_at_nodes(action, degree, action->momentum_coefficients + i,
                                           (size_t)curve_dimension(curve), &action->slope_table, force);
        }
}

static inline const double *seeds_get_field_output_row(const tvi_action *action, const jet_tape *tape, const double *x,
                                                       int i)
{
    return x + (size_t)tape->output_slot[i] * (size_t)action->node_count;
}

/* ---- The field at the nodes -------------------------------------------------------------------------------------- */

static inline tvi_status seeds_evaluate_field_at_nodes(const tvi_action *action)
{
    return jet_sweep_values(action->field_tape, action->field_tape_values_at_nodes, action->node_count) ? TVI_OK
                                                                                                        : TVI_EDOMAIN;
}

/* Copies n outputs of the field at the nodes, from number first_output on, times `factor`, to out [n][node_count]. */
static inline void seeds_copy_scaled_field_outputs(const tvi_action *action, const tvi_curve *curve, int first_output,
                                                   double factor, double *restrict out)
{
    const int lanes = action->node_count;
    for (int i = 0; i < curve_dimension(curve); i++) {
        const double *row = seeds_get_field_output_row(action, action->field_tape, action->field_tape_values_at_nodes,
                                                       first_output + i);
        JET_IN_VECTORS
        for (int node = 0; node < lanes; node++) out[i * lanes + node] = factor * row[node];
    }
}

/* Subtracts the rows of `other` from those of out. */
static inline void seeds_subtract_rows(const tvi_action *action, int n, const double *other, double *restrict out)
{
    for (int i = 0; i < n * action->node_count; i++) out[i] -= other[i];
}

#endif
