/* seeds.c - computes the gradient D_z of the discrete action of a Taylor curve by z, the state at the curve's centre,
 * in the form of seeds: vectors seed_Q[k] and seed_U[k] with D_z = sum_k (dQ_k/dz)^T seed_Q[k] + (dU_k/dz)^T seed_U[k].
 * Steppers call it in each pass (docs/method.md section 4).
 *
 * D_z is a sum over the nodes of a quadrature. Its formulas use these letters:
 *     g, p              the position and the momentum of the curve, functions of s; P_j is the coefficient of s^j in p
 *     q_i, v_i, p_i     the position, the velocity and the momentum that are used at node i
 *     w_i               the weight of node i for an integral over s
 *     tau               the unit of time: t is that of the centre plus tau s
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
#include "generating/action.h"
#include "algebra/sizes.h"
#include "sums.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- The curve at the nodes -------------------------------------------------------------------------------------- */

/* Evaluates a series at the nodes: row[node] = sum_{k <= degree} c_k table_k(node), with c_k = c[k * stride]. */
static void evaluate_series(const tvi_action *action, int degree, const double *c, size_t stride,
                            const tvi_node_table *table, double row[])
{
    const int half = action->half;
    double even[HALF], odd[HALF];
    if (half == 0) {
        jet_combine_rows(degree + 1, c, stride, action->nodes, table->all, row);
        return;
    }
    jet_combine_rows(degree / 2 + 1, c, 2 * stride, half, table->even, even);
    jet_combine_rows((degree + 1) / 2, c + stride, 2 * stride, half, table->odd, odd);
    JET_IN_VECTORS
    for (int i = 0; i < half; i++) row[i] = even[i] + odd[i];
    JET_IN_VECTORS
    for (int i = 0; i < half; i++) row[half + i] = table->mirror_sign * (even[i] - odd[i]);
}

static void set_times(const tvi_action *action, const tvi_curve *curve)
{
    const int inputs = curve->system->input_count;
    double *t = action->slots + inputs * action->nodes;
    if (!curve->system->uses_time) return;
    for (int node = 0; node < action->nodes; node++)
        t[node] = JET_FUSED(curve->tau, action->tables.s[node], curve_Q(curve, 0)[inputs]);
}

/* Computes the velocities v = (dq/ds)/tau at the nodes. */
static void set_velocities(const tvi_action *action, const tvi_curve *curve, double *v)
{
    for (int i = 0; i < curve->n; i++, v += action->nodes) {
        evaluate_series(action, action->q_degree, curve_Q(curve, 0) + i, curve_stride(curve), &action->tables.slope, v);
        for (int node = 0; node < action->nodes; node++) v[node] /= curve->tau;
    }
}

/* Divides the row by `divisor`: each number is multiplied by the reciprocal, and the quotient is corrected by the
 * remainder. Many divisions would be slower. */
static void divide_row(int nodes, double divisor, double row[])
{
    const double inverse = 1 / divisor;
    JET_IN_VECTORS
    for (int node = 0; node < nodes; node++) {
        const double quotient = row[node] * inverse;
        row[node] = quotient + inverse * (row[node] - quotient * divisor);
    }
}

/* Evaluates the curve at the nodes: q_i and the times in the inputs of the field, p if Hamilton's action or by_v needs
 * it, and dp/ds. For a separable system dp/ds is M q'' / tau, with q'' the second derivative by s. */
static void evaluate_curve(const tvi_action *action, const tvi_curve *curve)
{
    const bool separable = curve->system->form == TVI_SEPARABLE, needs_p = action->is_hamilton || action->has_by_v;
    const int n = curve->n, nodes = action->nodes, p_degree = action->p_degree;
    const size_t stride = curve_stride(curve);
    if (needs_p || action->tables.by_parts || !separable) curve_compute_P(curve, p_degree, action->P);
    for (int i = 0; i < n; i++) {
        const double *Q = curve_Q(curve, 0) + i, *P = action->P + i;
        double *dp_ds = action->at_nodes.dp_ds + i * nodes;
        if (needs_p)
            evaluate_series(action, p_degree, P, (size_t)n, &action->tables.power, action->at_nodes.p + i * nodes);
        if (separable) {
            evaluate_series(action, p_degree + 1, Q, stride, &action->tables.second, dp_ds);
            divide_row(nodes, curve->kappa[i], dp_ds);
        } else evaluate_series(action, p_degree, P, (size_t)n, &action->tables.slope, dp_ds);
        evaluate_series(action, action->q_degree, Q, stride, &action->tables.node_power, action->slots + i * nodes);
    }
    set_times(action, curve);
}

/* ---- The field at the nodes -------------------------------------------------------------------------------------- */

/* Sets out [n][nodes] to n outputs of the field, from number `first` on, times `factor`. */
static void copy_outputs(const tvi_action *action, int n, int first, double factor, double *restrict out)
{
    for (int i = 0; i < n; i++, out += action->nodes) {
        const double *row = action_output(action, action->tape, action->slots, first + i);
        JET_IN_VECTORS
        for (int node = 0; node < action->nodes; node++) out[node] = factor * row[node];
    }
}

static void subtract(int count, const double *other, double *restrict out)
{
    for (int i = 0; i < count; i++) out[i] -= other[i];
}

/* ---- What multiplies dq_i, dv_i and dp_i ------------------------------------------------------------------------- */

/* Lagrange's action: by_q = tau L_q and by_v = L_v - p, from the positions in the field's inputs, the velocities in
 * by_v and the momenta. On the curve of a separable system, without has_by_v, L_v = p. */
static tvi_status compute_lagrange(tvi_action *action, tvi_curve *curve, bool has_by_v)
{
    const int n = curve->n, count = n * action->nodes;
    const double tau = curve->tau;
    double *second = action->slots + count;
    tvi_status status = TVI_OK;
    switch (curve->system->form) {
    case TVI_SEPARABLE:
        status = action_evaluate_field(action);
        copy_outputs(action, n, 0, tau, action->at_nodes.by_q);
        if (!has_by_v) return status;
        for (int i = 0; i < count; i++) action->at_nodes.by_v[i] *= curve->system->mass[i / action->nodes];
        break;
    case TVI_LAGRANGIAN:
        memcpy(second, action->at_nodes.by_v, (size_t)count * sizeof *second);
        status = action_evaluate_field(action);
        copy_outputs(action, n, 0, tau, action->at_nodes.by_q);
        copy_outputs(action, n, n, 1, action->at_nodes.by_v);
        break;
    case TVI_HAMILTONIAN:
    case TVI_FIELD:
        status = tvi_action_find_node_momenta(action, curve);
        copy_outputs(action, n, 0, -tau, action->at_nodes.by_q);
        memcpy(action->at_nodes.by_v, second, (size_t)count * sizeof *second);
        break;
    }
    subtract(count, action->at_nodes.p, action->at_nodes.by_v);
    return status;
}

/* Hamilton's action at nodes on the curve: by_q = -tau H_q, by_p = g. - tau H_p. */
static tvi_status compute_hamilton(tvi_action *action, const tvi_curve *curve)
{
    const bool separable = curve->system->form == TVI_SEPARABLE;
    const int n = curve->n, nodes = action->nodes;
    const double tau = curve->tau;
    if (!separable) memcpy(action->slots + n * nodes, action->at_nodes.p, (size_t)(n * nodes) * sizeof(double));
    const tvi_status status = action_evaluate_field(action);
    if (status != TVI_OK) return status;
    copy_outputs(action, n, 0, separable ? tau : -tau, action->at_nodes.by_q);
    if (!action->has_by_p) return status;
    set_velocities(action, curve, action->at_nodes.by_p);
    for (int i = 0; i < n; i++) {
        const double mass = separable ? curve->system->mass[i] : 1,
                     *H_p = separable ? action->at_nodes.p + i * nodes
                                      : action_output(action, action->tape, action->slots, n + i);
        double *restrict by_p = action->at_nodes.by_p + i * nodes;
        for (int node = 0; node < nodes; node++) by_p[node] = tau * (by_p[node] - H_p[node] / mass);
    }
    return status;
}

/* Hamilton's action at truncated nodes: by_q = tau (H_qp p - H_q), by_p = tau H_pp p, by_v = -p. */
static tvi_status compute_truncated_hamilton(tvi_action *action, const tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const jet_tape *products = system->r_dot_Hp_values;
    const bool separable = system->form == TVI_SEPARABLE;
    const int n = curve->n, nodes = action->nodes;
    const size_t panel = (size_t)(n * nodes) * sizeof(double);
    const double tau = curve->tau;
    if (!separable) memcpy(action->slots + n * nodes, action->at_nodes.p, panel);
    const tvi_status status = action_evaluate_field(action);
    if (status != TVI_OK) return status;
    copy_outputs(action, n, 0, separable ? tau : -tau, action->at_nodes.by_q);
    if (!separable) {
        memcpy(action->Hp_slots, action->slots, (size_t)((2 * n + system->uses_time) * nodes) * sizeof(double));
        memcpy(action->Hp_slots + (2 * n + 1) * nodes, action->at_nodes.p, panel);
        if (!jet_sweep_values(products, action->Hp_slots, nodes)) return TVI_EDOMAIN;
    }
    for (int i = 0; i < n; i++)
        for (int node = 0; node < nodes; node++) {
            const int at = i * nodes + node;
            if (separable) action->at_nodes.by_p[at] = tau * action->at_nodes.p[at] / system->mass[i];
            else {
                action->at_nodes.by_q[at] += tau * action_output(action, products, action->Hp_slots, i)[node];
                action->at_nodes.by_p[at] = tau * action_output(action, products, action->Hp_slots, n + i)[node];
            }
            action->at_nodes.by_v[at] = -action->at_nodes.p[at];
        }
    return TVI_OK;
}

/* ---- The seeds --------------------------------------------------------------------------------------------------- */

/* Computes row[k] = sum over the nodes of weight * power (or slope) * x[node], for all orders k. */
static const double *sum_over_nodes(const tvi_action *action, const tvi_node_table *weighted, const double *x)
{
    const int half = action->half, orders = action->order_count, width = TVI_WHOLE_VECTORS((orders + 1) / 2);
    double sum[HALF], difference[HALF], even[HALF], odd[HALF];
    if (half == 0) {
        jet_combine_rows(action->nodes, x, 1, orders, weighted->all, action->node_sums);
        return action->node_sums;
    }
    JET_IN_VECTORS
    for (int i = 0; i < half; i++) {
        sum[i] = x[i] + x[half + i];
        difference[i] = x[i] - x[half + i];
    }
    const bool keeps = weighted->mirror_sign > 0;
    jet_combine_rows(half, keeps ? sum : difference, 1, width, weighted->even, even);
    jet_combine_rows(half, keeps ? difference : sum, 1, width, weighted->odd, odd);
    for (int k = 0; k < orders; k++) action->node_sums[k] = (k % 2 == 0 ? even : odd)[k / 2];
    return action->node_sums;
}

/* Sets the seeds of sum_i w_i [ dq_i^T by_q - dg^T p. ]. The difference by_q - p. is formed first, since the two nearly
 * cancel. A truncated node does not contain the term of the highest order N, but the curve does; the last sum subtracts
 * it from the seed of order N. */
static void set_by_q_seeds(tvi_action *action, const tvi_curve *curve, double seed[])
{
    const int n = curve->n, nodes = action->nodes, N = action->q_degree;
    const double *power = action->tables.power.all + N * nodes, *node_power = action->tables.node_power.all + N * nodes;
    subtract(n * nodes, action->at_nodes.dp_ds, action->at_nodes.by_q);
    for (int i = 0; i < n; i++) {
        const double *defect = action->at_nodes.by_q + i * nodes, *force = action->at_nodes.dp_ds + i * nodes;
        const double *row = sum_over_nodes(action, &action->tables.weighted_power, defect);
        for (int k = 0; k <= N; k++) seed[k * n + i] = row[k];
        for (int node = 0; node < nodes && action->is_truncated; node++)
            seed[N * n + i] -=
                action->tables.weight[node] * (defect[node] + force[node]) * (power[node] - node_power[node]);
    }
}

static void add_by_v_seeds(const tvi_action *action, int n, double seed[])
{
    for (int i = 0; i < n; i++) {
        const double *row =
            sum_over_nodes(action, &action->tables.weighted_slope, action->at_nodes.by_v + i * action->nodes);
        for (int k = 1; k <= action->q_degree; k++) seed[k * n + i] += row[k];
    }
}

/* Adds the seeds of sum_i w_i dp_i^T by_p; of a separable system kappa P_k = (k+1) Q_{k+1}. */
static void add_by_p_seeds(const tvi_action *action, const tvi_curve *curve, double seed_Q[], double seed_U[])
{
    const bool separable = curve->system->form == TVI_SEPARABLE;
    const int n = curve->n;
    for (int i = 0; i < n; i++) {
        const double *row =
            sum_over_nodes(action, &action->tables.weighted_power, action->at_nodes.by_p + i * action->nodes);
        for (int k = 0; k <= action->p_degree; k++) {
            if (!separable) seed_U[k * n + i] = row[k] / curve->kappa[i];
            else if (k < curve->highest_order) seed_Q[(k + 1) * n + i] += (k + 1) * (row[k] / curve->kappa[i]);
        }
    }
}

static void add_by_parts_seeds(const tvi_action *action, int n, double seed[])
{
    for (int k = 0; k <= action->q_degree; k++)
        for (int j = 0; j <= action->p_degree; j++) {
            const double error = action->tables.by_parts[k * action->order_count + j];
            for (int i = 0; i < n && error != 0; i++) seed[k * n + i] += error * action->P[j * n + i];
        }
}

tvi_status tvi_action_seeds(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    const bool is_bent = action->is_hamilton && action->is_truncated;
    const int n = curve->n, seeds = action->order_count * n;
    for (int i = (action->q_degree + 1) * n; i < seeds; i++) seed_Q[i] = 0;
    for (int i = 0; i < seeds && curve->system->form != TVI_SEPARABLE; i++) seed_U[i] = 0;
    evaluate_curve(action, curve);
    if (action->has_by_v) set_velocities(action, curve, action->at_nodes.by_v);
    const tvi_status status = is_bent               ? compute_truncated_hamilton(action, curve)
                              : action->is_hamilton ? compute_hamilton(action, curve)
                                                    : compute_lagrange(action, curve, action->has_by_v);
    if (status != TVI_OK) return status;
    set_by_q_seeds(action, curve, seed_Q);
    if (is_bent || action->has_by_v) add_by_v_seeds(action, n, seed_Q);
    if (is_bent || action->has_by_p) add_by_p_seeds(action, curve, seed_Q, seed_U);
    if (action->tables.by_parts) add_by_parts_seeds(action, n, seed_Q);
    const bool has_U = curve->system->form != TVI_SEPARABLE;
    return tvi_all_finite(seeds, seed_Q) && (!has_U || tvi_all_finite(seeds, seed_U)) ? TVI_OK : TVI_ENONFINITE;
}

tvi_status tvi_action_evaluate_lagrangian(tvi_action *action, tvi_curve *curve, const double q[], const double v[],
                                          const double p[])
{
    const size_t panel = (size_t)(curve->n * action->nodes) * sizeof *q;
    memcpy(action->slots, q, panel);
    memcpy(action->at_nodes.by_v, v, panel);
    memcpy(action->at_nodes.p, p, panel);
    set_times(action, curve);
    return compute_lagrange(action, curve, true);
}

/* ---- Roundoff ---------------------------------------------------------------------------------------------------- */

int tvi_action_end_roundoff(tvi_action *action, const tvi_curve *curve, double h, const double q[], const double p[],
                            double q_roundoff[], double p_roundoff[])
{
    const tvi_system *system = curve->system;
    const double *d = action->roundoff.output_roundoff;
    const int n = curve->n, nodes = action->nodes;
    memset(q_roundoff, 0, (size_t)n * sizeof *q_roundoff);
    memset(p_roundoff, 0, (size_t)n * sizeof *p_roundoff);
    if (!tvi_roundoff_may_exceed_motion(system, h, q, p, action->slots, action->at_nodes.p, nodes, nodes)) return 0;
    const int values = tvi_roundoff_estimate_field(&action->roundoff, system, action->slots, nodes, nodes);
    for (int i = 0; i < n; i++) {
        p_roundoff[i] = fabs(h) * d[i] + DBL_EPSILON * fabs(p[i]);
        if (system->form == TVI_SEPARABLE) q_roundoff[i] = fabs(h) / system->mass[i] * (fabs(h) * d[i]);
        else if (system->form == TVI_HAMILTONIAN) q_roundoff[i] = fabs(h) * d[n + i];
        else p_roundoff[i] += d[n + i];
    }
    return values;
}
