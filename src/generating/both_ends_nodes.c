/* both_ends_nodes.c - computes the gradient of the action on the blend y = w a + (1 - w) b of the two curves a and b
 * from the ends of a step. both_ends.c calls it in each pass and gives the formulas. */
#include "generating/both_ends.h"

#include <string.h>

/* Computes row = sum_{least <= k <= degree} coefficient_k table_k, with coefficient_k at first + k * stride. */
static void evaluate_series_at_nodes(tvi_both_ends_workspace *w, int least, int degree, const double *first,
                                     size_t stride, const double *table)
{
    for (int node = 0; node < w->points; node++) w->row[node] = 0;
    for (int k = degree; k >= least; k--)
        for (int node = 0; node < w->points; node++)
            w->row[node] += first[(size_t)k * stride] * table[k * w->points + node];
}

/* Adds w a or (1 - w) b of the sums to out. */
static void add_blended_series(tvi_both_ends_workspace *w, const tvi_end_curve *x, int degree, const double *first,
                               size_t stride, const double *table, double out[])
{
    evaluate_series_at_nodes(w, 0, degree, first, stride, table);
    for (int node = 0; node < w->points; node++) out[node] += x->blend[node] * w->row[node];
}

/* Subtracts a from out or adds b, for a - b, whose coefficients 0 nearly cancel; `apart` is their difference a_0 -
 * b_0. */
static void add_curve_difference(tvi_both_ends_workspace *w, const tvi_end_curve *x, int degree, const double *first,
                                 size_t stride, double apart, double out[])
{
    evaluate_series_at_nodes(w, 1, degree, first, stride, x->action.power_table.all_orders);
    for (int node = 0; node < w->points; node++) out[node] -= x->sign * w->row[node] + apart / 2;
}

/* Adds the part of one curve to y, v (in s), pi and pi. of component i. */
static void add_side_at_nodes(tvi_both_ends_workspace *w, tvi_end_curve *x, int i)
{
    const size_t place = (size_t)i * (size_t)w->points, stride = (size_t)w->system->field_series->slots;
    const double *Q = tvi_curve_position_coefficients(&x->curve, 0) + i, *P = x->P + i;
    const double *power = x->action.power_table.all_orders, *slope = x->action.slope_table.all_orders;
    const double q_apart =
        tvi_curve_position_coefficients(&w->a.curve, 0)[i] - tvi_curve_position_coefficients(&w->b.curve, 0)[i];
    const double p_apart = w->a.P[i] - w->b.P[i];
    add_blended_series(w, x, w->degree, Q, stride, power, w->y + place);
    add_blended_series(w, x, w->degree, Q, stride, slope, w->v + place);
    if (w->options->nodes == TVI_NODES_ON_CURVE)
        add_curve_difference(w, x, w->degree, Q, stride, q_apart, w->v + place);
    add_blended_series(w, x, w->degree - 1, P, (size_t)w->n, power, w->pi + place);
    add_blended_series(w, x, w->degree - 1, P, (size_t)w->n, slope, w->pi_rate + place);
    add_curve_difference(w, x, w->degree - 1, P, (size_t)w->n, p_apart, w->pi_rate + place);
}

/* Computes y, v, pi and pi. at the nodes. */
static void compute_blend_at_nodes(tvi_both_ends_workspace *w)
{
    const size_t panel = (size_t)w->n * (size_t)w->points * sizeof(double);
    double *const panels[] = {w->y, w->v, w->pi, w->pi_rate};
    for (size_t i = 0; i < sizeof panels / sizeof *panels; i++) memset(panels[i], 0, panel);
    curve_compute_momentum_coefficients(&w->a.curve, w->degree - 1, w->a.P);
    curve_compute_momentum_coefficients(&w->b.curve, w->degree - 1, w->b.P);
    for (int i = 0; i < w->n; i++) {
        add_side_at_nodes(w, &w->a, i);
        add_side_at_nodes(w, &w->b, i);
    }
    for (int i = 0; i < w->n * w->points; i++) w->v[i] /= w->a.curve.tau;
}

/* Computes the seeds of one curve. */
static void compute_end_curve_seeds(const tvi_both_ends_workspace *w, tvi_end_curve *x)
{
    for (int i = 0; i < w->n; i++)
        for (int k = 0; k <= w->degree; k++) {
            const double *power = x->action.power_table.all_orders + k * w->points,
                         *slope = x->action.slope_table.all_orders + k * w->points;
            double sum = 0;
            for (int node = 0; node < w->points; node++) {
                const int place = i * w->points + node;
                const double blended = x->blend[node] * (power[node] * w->on_q[place] + slope[node] * w->on_v[place]);
                sum += w->a.action.node_weight[node] * (blended + x->sign * power[node] * w->apart[place]);
            }
            x->seed[k * w->n + i] = sum;
        }
}

tvi_status tvi_both_ends_compute_gradient(tvi_both_ends_workspace *w, tvi_stats *stats)
{
    const tvi_action *nodes = &w->a.action;
    const bool on_curve = w->options->nodes == TVI_NODES_ON_CURVE;
    compute_blend_at_nodes(w);
    stats->force_evaluations += w->points;
    const tvi_status status = tvi_evaluate_lagrangian_at_nodes(&w->a.action, &w->a.curve, w->y, w->v, w->pi);
    if (status != TVI_OK) return status;
    for (int i = 0; i < w->n * w->points; i++) {
        w->on_q[i] = nodes->gradient_by_q[i] - (w->has_pi ? w->pi_rate[i] : 0);
        w->on_v[i] = nodes->gradient_by_v[i] + (w->has_pi ? 0 : w->pi[i]);
        w->apart[i] = on_curve ? -w->on_v[i] : w->has_pi ? w->pi[i] : 0;
    }
    compute_end_curve_seeds(w, &w->a);
    compute_end_curve_seeds(w, &w->b);
    tvi_curve_multiply_by_transposes(&w->a.curve, w->a.seed, NULL, w->a.R);
    tvi_curve_multiply_by_transposes(&w->b.curve, w->b.seed, NULL, w->b.R);
    return TVI_OK;
}
