/* both_ends_nodes.c - computes the gradient of the action on the blend y = w a + (1 - w) b of the two curves a and b
 * from the ends of a step. both_ends.c calls it in each pass and gives the formulas. */
#include "generating/both_ends.h"

#include <string.h>

/* Sums a series of one component at the nodes: series_value_at_node = sum of coefficient_k * table_k for the orders k =
 * lowest_summed_order .. degree. coefficient_k is at coefficients + k * stride, and table_k are the powers s^k at the
 * nodes, or their derivatives. */
static void evaluate_series_at_nodes(tvi_both_ends_workspace *w, int lowest_summed_order, int degree,
                                     const double *coefficients, size_t stride, const double *table)
{
    for (int node = 0; node < w->points; node++) w->series_value_at_node[node] = 0;
    for (int k = degree; k >= lowest_summed_order; k--)
        for (int node = 0; node < w->points; node++)
            w->series_value_at_node[node] += coefficients[(size_t)k * stride] * table[k * w->points + node];
}

/* Adds the series of one curve at the nodes, times the curve's weight in the blend, to out: w a, or (1 - w) b. */
static void add_blended_series(tvi_both_ends_workspace *w, const tvi_one_end_curve *x, int degree,
                               const double *coefficients, size_t stride, const double *table, double out[])
{
    evaluate_series_at_nodes(w, 0, degree, coefficients, stride, table);
    for (int node = 0; node < w->points; node++)
        out[node] += x->node_blend_weight[node] * w->series_value_at_node[node];
}

/* Adds one curve's part to the difference out = b - a at the nodes: it subtracts the terms of a, or adds those of b,
 * from order 1 on. `order_zero_start_minus_end` is a_0 - b_0, the difference of the coefficients of order 0, which
 * nearly cancel; the call for either curve subtracts half of it. */
static void add_to_end_curve_minus_start_curve(tvi_both_ends_workspace *w, const tvi_one_end_curve *x, int degree,
                                               const double *coefficients, size_t stride,
                                               double order_zero_start_minus_end, double out[])
{
    evaluate_series_at_nodes(w, 1, degree, coefficients, stride, x->action.power_table.values_of_all_orders);
    for (int node = 0; node < w->points; node++)
        out[node] -= x->sign_in_curve_difference * w->series_value_at_node[node] + order_zero_start_minus_end / 2;
}

/* Adds one curve's part to component i of the blended position y, velocity v (dy/ds), momentum pi and its derivative
 * dpi/ds at the nodes. */
static void add_curve_to_blend(tvi_both_ends_workspace *w, tvi_one_end_curve *x, int i)
{
    const size_t place = (size_t)i * (size_t)w->points, stride = (size_t)w->system->field_series->slot_count;
    const double *Q = tvi_curve_position_coefficients(&x->curve, 0) + i, *P = x->momentum_coefficients + i;
    const double *power = x->action.power_table.values_of_all_orders,
                 *slope = x->action.slope_table.values_of_all_orders;
    const double Q0_difference = tvi_curve_position_coefficients(&w->start_curve.curve, 0)[i] -
                                 tvi_curve_position_coefficients(&w->end_curve.curve, 0)[i];
    const double P0_difference = w->start_curve.momentum_coefficients[i] - w->end_curve.momentum_coefficients[i];
    add_blended_series(w, x, w->degree, Q, stride, power, w->q_at_nodes + place);
    add_blended_series(w, x, w->degree, Q, stride, slope, w->v_at_nodes + place);
    if (w->options->nodes == TVI_NODES_ON_CURVE)
        add_to_end_curve_minus_start_curve(w, x, w->degree, Q, stride, Q0_difference, w->v_at_nodes + place);
    add_blended_series(w, x, w->degree - 1, P, (size_t)w->n, power, w->p_at_nodes + place);
    add_blended_series(w, x, w->degree - 1, P, (size_t)w->n, slope, w->dp_ds_at_nodes + place);
    add_to_end_curve_minus_start_curve(w, x, w->degree - 1, P, (size_t)w->n, P0_difference, w->dp_ds_at_nodes + place);
}

/* Computes the blended position y, velocity v, momentum pi and its derivative dpi/ds at the nodes. */
static void blend_start_and_end_curves_at_nodes(tvi_both_ends_workspace *w)
{
    const size_t panel = (size_t)w->n * (size_t)w->points * sizeof(double);
    double *const panels[] = {w->q_at_nodes, w->v_at_nodes, w->p_at_nodes, w->dp_ds_at_nodes};
    for (size_t i = 0; i < sizeof panels / sizeof *panels; i++) memset(panels[i], 0, panel);
    curve_compute_momentum_coefficients(&w->start_curve.curve, w->degree - 1, w->start_curve.momentum_coefficients);
    curve_compute_momentum_coefficients(&w->end_curve.curve, w->degree - 1, w->end_curve.momentum_coefficients);
    for (int i = 0; i < w->n; i++) {
        add_curve_to_blend(w, &w->start_curve, i);
        add_curve_to_blend(w, &w->end_curve, i);
    }
    for (int i = 0; i < w->n * w->points; i++) w->v_at_nodes[i] /= w->start_curve.curve.time_unit;
}

/* Computes the seeds of one curve: the derivatives of the action by each coefficient Q_k of its position. */
static void compute_end_curve_seeds(const tvi_both_ends_workspace *w, tvi_one_end_curve *x)
{
    for (int i = 0; i < w->n; i++)
        for (int k = 0; k <= w->degree; k++) {
            const double *power = x->action.power_table.values_of_all_orders + k * w->points,
                         *slope = x->action.slope_table.values_of_all_orders + k * w->points;
            double sum = 0;
            for (int node = 0; node < w->points; node++) {
                const int place = i * w->points + node;
                const double blended = x->node_blend_weight[node] * (power[node] * w->action_gradient_by_q[place] +
                                                                     slope[node] * w->action_gradient_by_v[place]);
                sum += w->start_curve.action.node_weight[node] *
                       (blended + x->sign_in_curve_difference * power[node] * w->action_gradient_by_difference[place]);
            }
            x->action_gradient_by_coefficients_Q[k * w->n + i] = sum;
        }
}

tvi_status tvi_both_ends_compute_action_gradient(tvi_both_ends_workspace *w, tvi_stats *stats)
{
    const tvi_action *nodes = &w->start_curve.action;
    const bool on_curve = w->options->nodes == TVI_NODES_ON_CURVE;
    blend_start_and_end_curves_at_nodes(w);
    stats->force_evaluations += w->points;
    const tvi_status status = tvi_evaluate_lagrangian_at_nodes(&w->start_curve.action, &w->start_curve.curve,
                                                               w->q_at_nodes, w->v_at_nodes, w->p_at_nodes);
    if (status != TVI_OK) return status;
    for (int i = 0; i < w->n * w->points; i++) {
        w->action_gradient_by_q[i] =
            nodes->gradient_by_q[i] - (w->action_has_momentum_terms ? w->dp_ds_at_nodes[i] : 0);
        w->action_gradient_by_v[i] = nodes->gradient_by_v[i] + (w->action_has_momentum_terms ? 0 : w->p_at_nodes[i]);
        w->action_gradient_by_difference[i] = on_curve                       ? -w->action_gradient_by_v[i]
                                              : w->action_has_momentum_terms ? w->p_at_nodes[i]
                                                                             : 0;
    }
    compute_end_curve_seeds(w, &w->start_curve);
    compute_end_curve_seeds(w, &w->end_curve);
    tvi_curve_multiply_transposed_jacobians_by_seeds(&w->start_curve.curve,
                                                     w->start_curve.action_gradient_by_coefficients_Q, NULL,
                                                     w->start_curve.action_gradient_by_z);
    tvi_curve_multiply_transposed_jacobians_by_seeds(
        &w->end_curve.curve, w->end_curve.action_gradient_by_coefficients_Q, NULL, w->end_curve.action_gradient_by_z);
    return TVI_OK;
}
