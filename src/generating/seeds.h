/* seeds.h - computes the gradient D_z of the discrete action of a Taylor curve by z, the state at the curve's centre.
 * The gradient is computed in the form of seeds, which are vectors seed_Q[k] and seed_U[k] with D_z = sum_k (dQ_k/dz)^T
 * seed_Q[k] + (dU_k/dz)^T seed_U[k]. Here Q_k and U_k are the coefficients of s^k in the curve's position and in its
 * scaled momentum, and s is the scaled time. action.c and curve_isa.c call this file.
 *
 * D_z is a sum over the nodes of a quadrature. Its formulas use these letters:
 *     g, p              the position and the momentum of the curve, functions of s; P_j is the coefficient of s^j in p
 *     q_i, v_i, p_i     the position, the velocity and the momentum that are used at node i
 *     w_i               the weight of node i for an integral over s
 *     tau               the time unit: the time is that of the centre plus tau s
 *     x., dx            the derivative of a quantity x by s, and its Jacobian matrix by z
 *     e_r               the quadrature's value of an integral of s^r less the exact value
 * g and p without an index are taken at node i, too. L_q, H_p and so on are partial derivatives of the Lagrangian L and
 * the Hamiltonian H there.
 *
 * With Lagrange's action D_z is
 *     sum_i w_i [ dq_i^T tau L_q - dg^T p. + dg.^T (L_v - p) ].
 * With Hamilton's action and nodes on the curve (q_i = g, p_i = p) it is
 *     sum_i w_i [ dp_i^T (g. - tau H_p) - dg^T (p. + tau H_q) ].
 * With Hamilton's action and truncated nodes, at which q_i leaves out the curve's term of the highest degree and the
 * velocity is H_p, it is
 *     sum_i w_i [ dq_i^T tau (H_qp p - H_q) + dp_i^T tau H_pp p - dg^T p. - dg.^T p ].
 * To each of the three sums is added
 *     sum_{j,k} (j + k) e_{j+k-1} (dQ_k/dz)^T P_j.
 * The formulas come from a summation by parts, for which the derivative of p^T dg by s is integrated. The added sum is
 * the error of the quadrature in this integral. With it, every quadrature may be used with every degree. For a
 * separable system L_v - p is 0. There g. - tau H_p is 0, too, if the degree of p is that of g less 1. */
#ifndef TVI_SRC_GENERATING_SEEDS_H
#define TVI_SRC_GENERATING_SEEDS_H

#include "generating/node_momenta.h"
#include "method/origin.h"

/* ---- What multiplies dq_i, dv_i and dp_i ------------------------------------------------------------------------- */

/* Computes gradient_by_q = tau F, with the force F: the only term of Lagrange's action for a separable system, for
 * which L_v = p holds on the curve. */
static inline tvi_status seeds_compute_separable_node_gradient(tvi_action *action, const tvi_curve *curve)
{
    const tvi_status status = seeds_evaluate_field_at_nodes(action);
    seeds_copy_scaled_field_outputs(action, curve, 0, curve->time_unit, action->gradient_by_q);
    return status;
}

/* Computes gradient_by_q = tau L_q and gradient_by_v = L_v - p, from the positions in field_tape_values_at_nodes, the
 * velocities in gradient_by_v and the momenta. */
static inline tvi_status seeds_compute_lagrange_node_gradient(tvi_action *action, tvi_curve *curve)
{
    const int n = curve_dimension(curve), points = action->node_count;
    const size_t panel = (size_t)(n * points) * sizeof(double);
    double *second = action->field_tape_values_at_nodes + n * points;
    tvi_status status = TVI_OK;
    switch (curve_system_form(curve)) {
    case TVI_SEPARABLE:
        status = seeds_compute_separable_node_gradient(action, curve);
        for (int i = 0; i < n * points; i++) action->gradient_by_v[i] *= curve->system->mass[i / points];
        break;
    case TVI_LAGRANGIAN:
        memcpy(second, action->gradient_by_v, panel);
        status = seeds_evaluate_field_at_nodes(action);
        seeds_copy_scaled_field_outputs(action, curve, 0, curve->time_unit, action->gradient_by_q);
        seeds_copy_scaled_field_outputs(action, curve, n, 1, action->gradient_by_v);
        break;
    case TVI_HAMILTONIAN:
        status = momenta_solve_at_nodes(action, curve);
        seeds_copy_scaled_field_outputs(action, curve, 0, -curve->time_unit, action->gradient_by_q);
        memcpy(action->gradient_by_v, second, panel);
        break;
    }
    seeds_subtract_rows(action, n, action->p_at_nodes, action->gradient_by_v);
    return status;
}

/* Computes the terms of Hamilton's action at on-curve nodes: gradient_by_q = -tau H_q, gradient_by_p = g. - tau H_p. */
static inline tvi_status seeds_compute_hamilton_node_gradient(tvi_action *action, const tvi_curve *curve)
{
    const int n = curve_dimension(curve), lanes = action->node_count;
    const bool separable = curve_system_form(curve) == TVI_SEPARABLE;
    if (!separable)
        memcpy(action->field_tape_values_at_nodes + n * lanes, action->p_at_nodes,
               (size_t)(n * lanes) * sizeof(double));
    const tvi_status status = seeds_evaluate_field_at_nodes(action);
    if (status != TVI_OK) return status;
    seeds_copy_scaled_field_outputs(action, curve, 0, separable ? curve->time_unit : -curve->time_unit,
                                    action->gradient_by_q);
    if (!action->has_gradient_by_p) return status;
    seeds_set_node_velocities(action, curve, action->gradient_by_p);
    for (int i = 0; i < n; i++) {
        const double *H_p = separable ? action->p_at_nodes + i * lanes
                                      : seeds_get_field_output_row(action, action->field_tape,
                                                                   action->field_tape_values_at_nodes, n + i);
        const double tau = curve->time_unit, mass = separable ? curve->system->mass[i] : 1;
        double *restrict by_p = action->gradient_by_p + i * lanes;
        for (int node = 0; node < lanes; node++) by_p[node] = tau * (by_p[node] - H_p[node] / mass);
    }
    return status;
}

/* ---- The seeds --------------------------------------------------------------------------------------------------- */

/* Computes row[k] = sum over the nodes of weight * power (or slope) * x[node], for all orders k. */
static inline const double *seeds_sum_over_nodes(const tvi_action *action, const tvi_node_table *weighted,
                                                 const double *x)
{
    const int half = action->half_node_count, orders = action->order_count;
    const int lanes = action->node_count / 2, padded = seeds_round_up_to_vectors((orders + 1) / 2);
    double sum[SEEDS_HALF], difference[SEEDS_HALF], even[SEEDS_HALF], odd[SEEDS_HALF];
    if (half == 0) {
        seeds_combine_rows(action, action->node_count, x, 1, orders, weighted->values_of_all_orders,
                           action->node_sums_by_order);
        return action->node_sums_by_order;
    }
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) {
        sum[i] = x[i] + x[lanes + i];
        difference[i] = x[i] - x[lanes + i];
    }
    const bool keeps = weighted->mirror_sign > 0;
    seeds_combine_rows(action, half, keeps ? sum : difference, 1, padded, weighted->values_of_even_orders, even);
    seeds_combine_rows(action, half, keeps ? difference : sum, 1, padded, weighted->values_of_odd_orders, odd);
    for (int k = 0; k < orders; k++) action->node_sums_by_order[k] = (k % 2 == 0 ? even : odd)[k / 2];
    return action->node_sums_by_order;
}

/* Sets the seeds of sum_i w_i [ dq_i^T gradient_by_q - dg_i^T dp/ds ] over the nodes i, with dq_i the Jacobian of the
 * node's coordinates by z, and dg_i that of the curve at the node. The difference gradient_by_q - dp/ds is formed
 * first, since the two nearly cancel. A truncated node does not contain the term of the highest order N, but the curve
 * does; the last sum subtracts it from the seed of order N. */
static inline void seeds_set_gradient_by_q_terms(tvi_action *action, const tvi_curve *curve, double seed[])
{
    const int n = curve_dimension(curve), lanes = action->node_count;
    const int points = action->node_count, N = action->q_degree;
    /* gradient_by_q becomes the small difference gradient_by_q - dp/ds. */
    seeds_subtract_rows(action, n, action->dp_ds_at_nodes, action->gradient_by_q);
    for (int i = 0; i < n; i++) {
        const double *defect = action->gradient_by_q + i * lanes, *force = action->dp_ds_at_nodes + i * lanes;
        const double *row = seeds_sum_over_nodes(action, &action->weighted_power_table, defect);
        for (int k = 0; k <= N; k++) seed[k * n + i] = row[k];
        if (!action->omits_highest_order_at_nodes) continue;
        for (int node = 0; node < points; node++)
            seed[N * n + i] -= action->node_weight[node] * (defect[node] + force[node]) *
                               (action->power_table.values_of_all_orders[N * points + node] -
                                action->power_table_truncated_by_node_rule.values_of_all_orders[N * points + node]);
    }
}

static inline void seeds_add_gradient_by_v_terms(const tvi_action *action, int n, double seed[])
{
    for (int i = 0; i < n; i++) {
        const double *row =
            seeds_sum_over_nodes(action, &action->weighted_slope_table, action->gradient_by_v + i * action->node_count);
        for (int k = 1; k <= action->q_degree; k++) seed[k * n + i] += row[k];
    }
}

/* Adds the seeds of sum_i w_i dp_i^T gradient_by_p over the nodes i, with dp_i the Jacobian of the node's momentum by
 * z; a separable system has kappa P_k = (k+1) Q_{k+1}. */
static inline void seeds_add_gradient_by_p_terms(const tvi_action *action, const tvi_curve *curve, double seed_Q[],
                                                 double seed_U[])
{
    const int n = curve_dimension(curve);
    for (int i = 0; i < n; i++) {
        const double *row =
            seeds_sum_over_nodes(action, &action->weighted_power_table, action->gradient_by_p + i * action->node_count);
        const double kappa = curve->momentum_scale_factor[i];
        for (int k = 0; k <= action->p_degree; k++) {
            const bool is_of_Q = curve_system_form(curve) == TVI_SEPARABLE;
            if (is_of_Q && k == curve_highest_order(curve)) continue;
            if (is_of_Q) seed_Q[(k + 1) * n + i] += (k + 1) * (row[k] / kappa);
            else seed_U[k * n + i] = row[k] / kappa;
        }
    }
}

static inline void seeds_add_corrections_for_inexact_quadrature(const tvi_action *action, const tvi_curve *curve,
                                                                double seed[])
{
    const int n = curve_dimension(curve);
    for (int k = 0; k <= action->q_degree; k++)
        for (int j = 0; j <= action->p_degree; j++) {
            const double error = action->summation_by_parts_error[k * (curve_highest_order(curve) + 1) + j];
            if (error == 0) continue;
            for (int i = 0; i < n; i++) seed[k * n + i] += error * action->momentum_coefficients[j * n + i];
        }
}

/* ---- All of them ------------------------------------------------------------------------------------------------- */

/* Sets to 0 the seeds seed_Q of the orders above q_degree, and seed_U, which a separable system does not use. Evaluates
 * the curve at the nodes: its momentum, the derivative of its momentum, and its position. */
static inline void seeds_clear_seeds_and_evaluate_curve_at_nodes(tvi_action *action, const tvi_curve *curve,
                                                                 double seed_Q[], double seed_U[])
{
    const int seeds = (curve_highest_order(curve) + 1) * curve_dimension(curve);
    for (int i = (action->q_degree + 1) * curve_dimension(curve); i < seeds; i++) seed_Q[i] = 0;
    for (int i = 0; i < seeds && curve_system_form(curve) != TVI_SEPARABLE; i++) seed_U[i] = 0;
    seeds_compute_node_momenta(action, curve);
    seeds_compute_dp_ds_at_nodes(action, curve);
    seeds_set_node_coordinates_and_times(action, curve, action->field_tape_values_at_nodes);
}

/* Computes the seeds from gradient_by_q, gradient_by_v and gradient_by_p, the derivatives of the action by position,
 * velocity and momentum at the nodes. */
static inline void seeds_compute_from_node_gradient(tvi_action *action, const tvi_curve *curve, double seed_Q[],
                                                    double seed_U[])
{
    const int n = curve_dimension(curve);
    const bool is_bent = action->is_phase_space_action && action->omits_highest_order_at_nodes;
    seeds_set_gradient_by_q_terms(action, curve, seed_Q);
    if (is_bent || action->has_gradient_by_v) seeds_add_gradient_by_v_terms(action, n, seed_Q);
    if (is_bent || action->has_gradient_by_p) seeds_add_gradient_by_p_terms(action, curve, seed_Q, seed_U);
    if (action->summation_by_parts_error) seeds_add_corrections_for_inexact_quadrature(action, curve, seed_Q);
}

/* Returns whether the seeds need only the field, and no second derivatives. */
static inline bool seeds_need_no_second_derivatives(const tvi_action *action)
{
    return !(action->is_phase_space_action && action->omits_highest_order_at_nodes);
}

static inline tvi_status seeds_compute_adjoint_seeds_from_field_only(tvi_action *action, tvi_curve *curve,
                                                                     double q_coefficient_seed[],
                                                                     double scaled_p_coefficient_seed[])
{
    seeds_clear_seeds_and_evaluate_curve_at_nodes(action, curve, q_coefficient_seed, scaled_p_coefficient_seed);
    if (action->has_gradient_by_v) seeds_set_node_velocities(action, curve, action->gradient_by_v);
    const tvi_status status = action->is_phase_space_action ? seeds_compute_hamilton_node_gradient(action, curve)
                              : action->has_gradient_by_v   ? seeds_compute_lagrange_node_gradient(action, curve)
                                                            : seeds_compute_separable_node_gradient(action, curve);
    if (status == TVI_OK)
        seeds_compute_from_node_gradient(action, curve, q_coefficient_seed, scaled_p_coefficient_seed);
    return status;
}

#endif
