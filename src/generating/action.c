/* action.c - the gradient of the discrete action, as seeds for the gradient of the curve.
 *
 * With p the curve's momentum series, w_i the weights in scaled time, and a dot for d/ds,
 *   Lagrange   D_z = sum_i w_i [ dq_i^T tau L_q - dg_i^T p. + dg.^T (L_v - p) ]
 *   Hamilton   D_z = sum_i w_i [ dp_i^T (g. - tau H_p) - dg_i^T (p. + tau H_q) ]                             on-curve
 *              D_z = sum_i w_i [ dq_i^T tau (H_qp p - H_q) + dp_i^T tau H_pp p - dg_i^T p. - dg.^T p ]      truncated,
 * q'_i = H_p and in both, with e_r the error of the quadrature for s^r,
 *            + sum_{j,k} (j+k) e_{j+k-1} (dQ_k/dz)^T P_j,
 * what summation by parts of (p^T dg). leaves when the quadrature is not exact to its degree: with it every quadrature
 * serves every degree. For a separable system L_v - p = 0, and g. - tau H_p = 0 where p has degree q_degree - 1. */
#include "generating/action.h"
#include "algebra/passes.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- The curve at the nodes -------------------------------------------------------------------------------------- */

/* row[node] = sum_{k <= degree} coefficient_k table[k][node], coefficient_k at first + k * stride. */
static void at_nodes(const tvi_action *action, int degree, const double *first, size_t stride, const double *table,
                     double row[])
{
    action->sweeps->combine(degree + 1, first, stride, action->points, table, row);
}

static void place_times(const tvi_action *action, const tvi_curve *curve, double *x)
{
    double *t = x + curve->system->inputs * action->points;
    if (!curve->system->uses_time) return;
    for (int node = 0; node < action->points; node++) t[node] = curve->centre + curve->tau * action->s[node];
}

/* q at the nodes into the inputs of a block; the time too. */
static void place_positions(const tvi_action *action, const tvi_curve *curve, double *x)
{
    const tvi_system *system = curve->system;
    const size_t stride = (size_t)system->field_series->slots;
    for (int i = 0; i < curve->n; i++)
        at_nodes(action, action->q_degree, tvi_curve_Q(curve, 0) + i, stride, action->node_power,
                 x + i * action->points);
    place_times(action, curve, x);
}

/* v = g./tau at the nodes into the second input. */
static void place_velocities(const tvi_action *action, const tvi_curve *curve, double *v)
{
    const int points = action->points;
    const size_t stride = (size_t)curve->system->field_series->slots;
    for (int i = 0; i < curve->n; i++) {
        at_nodes(action, action->q_degree, tvi_curve_Q(curve, 0) + i, stride, action->slope, v + i * points);
        for (int node = 0; node < points; node++) v[i * points + node] /= curve->tau;
    }
}

/* The momentum of the curve, where it is needed, and its derivative. */
static void momenta_at_nodes(tvi_action *action, const tvi_curve *curve)
{
    const int n = curve->n, points = action->points, degree = action->p_degree;
    const bool has_momenta = action->kind == TVI_ACTION_HAMILTON || action->has_velocity_defect;
    tvi_curve_momenta(curve, degree, action->P);
    for (int i = 0; i < n; i++) {
        const double *P = action->P + i;
        if (has_momenta) at_nodes(action, degree, P, (size_t)n, action->power, action->momentum + i * points);
        at_nodes(action, degree, P, (size_t)n, action->slope, action->force + i * points);
    }
}

static const double *output_row(const tvi_action *action, const jet_tape *tape, const double *x, int i)
{
    return x + (size_t)tape->output[i] * (size_t)action->points;
}

/* ---- What multiplies dq_i, dv_i and dp_i ------------------------------------------------------------------------- */

static tvi_status run_field(const tvi_action *action, const tvi_curve *curve)
{
    return jet_sweep_values(curve->system->field_values, action->x, action->points) ? TVI_OK : TVI_EDOMAIN;
}

/* panel = factor * outputs first .. first + n - 1 of the field. */
static void copy_outputs(const tvi_action *action, const tvi_curve *curve, int first, double factor, double *panel)
{
    for (int i = 0; i < curve->n; i++) {
        const double *row = output_row(action, curve->system->field_values, action->x, first + i);
        for (int node = 0; node < action->points; node++) panel[i * action->points + node] = factor * row[node];
    }
}

/* panel -= other. */
static void subtract(const tvi_action *action, int n, const double *other, double *panel)
{
    for (int i = 0; i < n * action->points; i++) panel[i] -= other[i];
}

enum { NEWTON_STEPS = 50 };
/* Corrections of the momenta that no longer shrink are roundoff: below this part of the largest momentum, or below this
 * many units of what the roundoff of H_p and v makes of them. */
static const double STALLED = 1e-13;

/* The roundoff of the corrections, by that of the H_p that was last evaluated. */
static double measure_roundoff(tvi_action *action, const tvi_curve *curve)
{
    const int n = curve->n, points = action->points;
    tvi_roundoff *roundoff = &action->roundoff;
    (void)tvi_roundoff_of_field(roundoff, curve->system, action->x, points, points);
    for (int i = 0; i < n; i++) {
        const double of_v = DBL_EPSILON * tvi_largest(points, action->on_v + i * points, 1);
        action->correction[i] = tvi_roundoff_sign(roundoff, roundoff->change[n + i] + of_v);
    }
    tvi_factor_solve(&curve->slope, action->correction);
    return TVI_ROUNDOFF_UNITS * tvi_largest(n, action->correction, 1);
}

/* Momenta with H_p(q_i, p_i) = v_i at all nodes, from those of the curve, by a Newton method with H_pp at the centre. v
 * is in action->on_v; the momenta are left in the second input. */
static tvi_status solve_node_momenta(tvi_action *action, tvi_curve *curve)
{
    const jet_tape *tape = curve->system->field_values;
    const int n = curve->n, points = action->points;
    double *p = action->x + n * points;
    tvi_passes passes = TVI_NO_PASSES;
    memcpy(p, action->momentum, (size_t)(n * points) * sizeof *p);
    const double size = tvi_largest(n * points, p, 1);
    const tvi_passes_rule rule = {.goal = DBL_EPSILON * size, .stuck = TVI_PASSES_ALL, .roundoff = STALLED * size};
    tvi_status status = tvi_curve_factor_slope(curve);
    for (int step = 0; step < NEWTON_STEPS && status == TVI_OK; step++) {
        status = run_field(action, curve);
        double largest = 0;
        for (int node = 0; node < points && status == TVI_OK; node++) {
            for (int i = 0; i < n; i++)
                action->correction[i] =
                    action->on_v[i * points + node] - output_row(action, tape, action->x, n + i)[node];
            tvi_factor_solve(&curve->slope, action->correction);
            for (int i = 0; i < n; i++) {
                p[i * points + node] += action->correction[i];
                largest = fmax(largest, fabs(action->correction[i]));
            }
        }
        if (!isfinite(largest)) return TVI_ENONFINITE;
        const tvi_passes_verdict verdict = tvi_passes_judge(&passes, &rule, largest);
        if (verdict == TVI_PASSES_MAY_END ||
            (verdict == TVI_PASSES_STUCK && tvi_passes_are_roundoff(&passes, measure_roundoff(action, curve))))
            return run_field(action, curve);
    }
    return status == TVI_OK ? TVI_ENOCONV : status;
}

/* Separable: on_q = tau F; L_v = p on the curve. */
static tvi_status force_terms(tvi_action *action, const tvi_curve *curve)
{
    const tvi_status status = run_field(action, curve);
    copy_outputs(action, curve, 0, curve->tau, action->on_q);
    return status;
}

/* From the positions in action->x, the velocities in on_v and the momenta: on_q = tau L_q, on_v = L_v - p. */
static tvi_status lagrange_terms(tvi_action *action, tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const int n = curve->n, points = action->points;
    const size_t panel = (size_t)(n * points) * sizeof(double);
    double *second = action->x + n * points;
    tvi_status status = TVI_OK;
    switch (system->form) {
    case TVI_SEPARABLE:
        status = run_field(action, curve);
        copy_outputs(action, curve, 0, curve->tau, action->on_q);
        for (int i = 0; i < n * points; i++) action->on_v[i] *= system->mass[i / points];
        break;
    case TVI_LAGRANGIAN:
        memcpy(second, action->on_v, panel);
        status = run_field(action, curve);
        copy_outputs(action, curve, 0, curve->tau, action->on_q);
        copy_outputs(action, curve, n, 1, action->on_v);
        break;
    case TVI_HAMILTONIAN:
        status = solve_node_momenta(action, curve);
        copy_outputs(action, curve, 0, -curve->tau, action->on_q);
        memcpy(action->on_v, second, panel);
        break;
    }
    subtract(action, n, action->momentum, action->on_v);
    return status;
}

tvi_status tvi_action_lagrange(tvi_action *action, tvi_curve *curve, const double q[], const double v[],
                               const double p[])
{
    const size_t panel = (size_t)(curve->n * action->points) * sizeof *q;
    memcpy(action->x, q, panel);
    memcpy(action->on_v, v, panel);
    memcpy(action->momentum, p, panel);
    place_times(action, curve, action->x);
    return lagrange_terms(action, curve);
}

/* On-curve: on_q = -tau H_q, on_p = g. - tau H_p. */
static tvi_status hamilton_terms(tvi_action *action, const tvi_curve *curve)
{
    const int n = curve->n, points = action->points;
    const bool separable = curve->system->form == TVI_SEPARABLE;
    if (!separable) memcpy(action->x + n * points, action->momentum, (size_t)(n * points) * sizeof(double));
    const tvi_status status = run_field(action, curve);
    if (status != TVI_OK) return status;
    copy_outputs(action, curve, 0, separable ? curve->tau : -curve->tau, action->on_q);
    if (!action->has_momentum_defect) return TVI_OK;
    place_velocities(action, curve, action->on_p);
    for (int i = 0; i < n; i++) {
        const double *H_p = separable ? NULL : output_row(action, curve->system->field_values, action->x, n + i);
        for (int node = 0; node < points; node++) {
            const int place = i * points + node;
            const double rate = separable ? action->momentum[place] / curve->system->mass[i] : H_p[node];
            action->on_p[place] = curve->tau * (action->on_p[place] - rate);
        }
    }
    return status;
}

/* Truncated, q'_i = H_p(q_i, p_i): on_q = tau (H_qp p - H_q), on_p = tau H_pp p, on_v = -p. */
static tvi_status bent_terms(tvi_action *action, const tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const int n = curve->n, points = action->points;
    const size_t panel = (size_t)(n * points) * sizeof(double);
    const bool separable = system->form == TVI_SEPARABLE;
    if (!separable) memcpy(action->x + n * points, action->momentum, panel);
    const tvi_status status = run_field(action, curve);
    if (status != TVI_OK) return status;
    copy_outputs(action, curve, 0, separable ? curve->tau : -curve->tau, action->on_q);
    if (!separable) {
        memcpy(action->bend, action->x, (size_t)(2 * n + system->uses_time) * (size_t)points * sizeof(double));
        memcpy(action->bend + (2 * n + 1) * points, action->momentum, panel);
        if (!jet_sweep_values(system->bend_values, action->bend, points)) return TVI_EDOMAIN;
    }
    for (int i = 0; i < n; i++)
        for (int node = 0; node < points; node++) {
            const int place = i * points + node;
            if (separable) {
                action->on_p[place] = curve->tau * action->momentum[place] / system->mass[i];
            } else {
                action->on_q[place] += curve->tau * output_row(action, system->bend_values, action->bend, i)[node];
                action->on_p[place] = curve->tau * output_row(action, system->bend_values, action->bend, n + i)[node];
            }
            action->on_v[place] = -action->momentum[place];
        }
    return TVI_OK;
}

/* ---- The seeds --------------------------------------------------------------------------------------------------- */

/* row[k] = sum over the nodes of weight * power (or slope) * x[node], for all orders k. */
static const double *over_nodes(const tvi_action *action, const double *weighted_table, const double *x)
{
    action->sweeps->combine(action->points, x, 1, action->orders, weighted_table, action->row);
    return action->row;
}

/* dq_i^T on_q - dg_i^T p. as one defect, less what a truncated node leaves out of dq_i. */
static void seed_positions(tvi_action *action, int n, double seed[])
{
    const int points = action->points, N = action->q_degree;
    subtract(action, n, action->force, action->on_q); /* the defect */
    for (int i = 0; i < n; i++) {
        const double *defect = action->on_q + i * points, *force = action->force + i * points;
        const double *row = over_nodes(action, action->weighted_power, defect);
        for (int k = 0; k <= N; k++) seed[k * n + i] = row[k];
        if (!action->truncated) continue;
        for (int node = 0; node < points; node++)
            seed[N * n + i] -= action->weight[node] * (defect[node] + force[node]) *
                               (action->power[N * points + node] - action->node_power[N * points + node]);
    }
}

static void seed_velocities(const tvi_action *action, int n, double seed[])
{
    for (int i = 0; i < n; i++) {
        const double *row = over_nodes(action, action->weighted_slope, action->on_v + i * action->points);
        for (int k = 1; k <= action->q_degree; k++) seed[k * n + i] += row[k];
    }
}

/* dp^T on_p; for a separable system kappa P_k = (k+1) Q_{k+1}. */
static void seed_momenta(const tvi_action *action, const tvi_curve *curve, double seed_Q[], double seed_U[])
{
    const int n = curve->n;
    for (int i = 0; i < n; i++) {
        const double *row = over_nodes(action, action->weighted_power, action->on_p + i * action->points);
        for (int k = 0; k <= action->p_degree; k++) {
            const double seed = row[k] / curve->kappa[i];
            if (curve->system->form != TVI_SEPARABLE) seed_U[k * n + i] = seed;
            else if (k < curve->top) seed_Q[(k + 1) * n + i] += (k + 1) * seed;
        }
    }
}

static void seed_by_parts(const tvi_action *action, const tvi_curve *curve, double seed[])
{
    const int n = curve->n;
    for (int k = 0; k <= action->q_degree; k++)
        for (int j = 0; j <= action->p_degree; j++) {
            const double error = action->by_parts[k * (curve->top + 1) + j];
            if (error == 0) continue;
            for (int i = 0; i < n; i++) seed[k * n + i] += error * action->P[j * n + i];
        }
}

tvi_status tvi_action_seed(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    const int n = curve->n, seeds = (curve->top + 1) * n;
    const bool bent = action->kind == TVI_ACTION_HAMILTON && action->truncated;
    memset(seed_Q, 0, (size_t)seeds * sizeof *seed_Q);
    memset(seed_U, 0, (size_t)seeds * sizeof *seed_U);
    momenta_at_nodes(action, curve);
    place_positions(action, curve, action->x);
    if (action->has_velocity_defect) place_velocities(action, curve, action->on_v);
    const tvi_status status = bent                                  ? bent_terms(action, curve)
                              : action->kind == TVI_ACTION_HAMILTON ? hamilton_terms(action, curve)
                              : action->has_velocity_defect         ? lagrange_terms(action, curve)
                                                                    : force_terms(action, curve);
    if (status != TVI_OK) return status;
    seed_positions(action, n, seed_Q);
    if (bent || action->has_velocity_defect) seed_velocities(action, n, seed_Q);
    if (bent || action->has_momentum_defect) seed_momenta(action, curve, seed_Q, seed_U);
    if (action->by_parts) seed_by_parts(action, curve, seed_Q);
    return tvi_all_finite(seeds, seed_Q) && tvi_all_finite(seeds, seed_U) ? TVI_OK : TVI_ENONFINITE;
}
