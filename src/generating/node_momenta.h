/* node_momenta.h - solves H_p(q, p) = v for the momenta p at the nodes of the action by Newton's method, with the
 * positions q and velocities v of the curve given. seeds.h calls it for a Hamiltonian whose action is Lagrange's. */
#ifndef TVI_SRC_GENERATING_NODE_MOMENTA_H
#define TVI_SRC_GENERATING_NODE_MOMENTA_H

#include "algebra/passes.h"
#include "generating/nodes.h"

/* Estimates the roundoff of the momenta's corrections at the nodes from the roundoff of the last H_p (action.c). */
double tvi_estimate_node_momenta_roundoff(tvi_action *action, tvi_curve *curve);

enum { MOMENTA_MOST_NODES = 2 * SEEDS_HALF };

/* Computes H_pp at the nodes, [n][n][points]. */
static inline void momenta_compute_H_pp(const tvi_action *action, const tvi_curve *curve)
{
    const int n = curve_dimension(curve), points = action->node_count;
    const jet_tape *tape = action->field_tape;
    for (int j = 0; j < n; j++) {
        double *direction = action->field_tangent_block + (n + j) * points;
        for (int node = 0; node < points; node++) direction[node] = 1;
        jet_sweep_one_tangent_per_lane(tape, action->field_tape_values_at_nodes, action->field_tangent_block, 0,
                                       points);
        for (int i = 0; i < n; i++)
            memcpy(action->H_pp + (i * n + j) * points,
                   seeds_get_field_output_row(action, tape, action->field_tangent_block, n + i),
                   (size_t)points * sizeof(double));
        for (int node = 0; node < points; node++) direction[node] = 0;
    }
}

/* Copies the matrix H_pp of one node to velocity_hessian of the curve, where it is factored. */
static inline void momenta_copy_H_pp_of_node(const tvi_action *action, const tvi_curve *curve, int node)
{
    for (int i = 0; i < curve_dimension(curve) * curve_dimension(curve); i++)
        curve->velocity_hessian.lu[i] = action->H_pp[i * action->node_count + node];
}

/* Inverts H_pp of a node column by column, with row exchanges. Returns TVI_ESINGULAR or TVI_ENONFINITE. */
static inline tvi_status momenta_invert_H_pp_by_columns(const tvi_action *action, tvi_curve *curve, int node)
{
    const int n = curve_dimension(curve);
    const tvi_status status = tvi_factor_compute(&curve->velocity_hessian);
    for (int j = 0; j < n && status == TVI_OK; j++) {
        for (int i = 0; i < n; i++) curve->right_side_column[i] = i == j;
        tvi_factor_solve(&curve->velocity_hessian, curve->right_side_column);
        for (int i = 0; i < n; i++) action->H_pp[(i * n + j) * action->node_count + node] = curve->right_side_column[i];
    }
    return status;
}

/* Replaces H_pp by H_pp^-1 at all nodes. */
static inline tvi_status momenta_invert_H_pp(const tvi_action *action, tvi_curve *curve)
{
    tvi_status status = TVI_OK;
    momenta_compute_H_pp(action, curve);
    for (int node = 0; node < action->node_count && status == TVI_OK; node++) {
        momenta_copy_H_pp_of_node(action, curve, node);
        status = momenta_invert_H_pp_by_columns(action, curve, node);
    }
    return status;
}

/* Computes the corrections H_pp^-1 (v - H_p) of the momenta, and returns the largest. The velocities v are in
 * gradient_by_v, which stays unchanged. */
static inline double momenta_compute_corrections(const tvi_action *action, const tvi_curve *curve)
{
    const int n = curve_dimension(curve), points = action->node_count;
    double *correction = action->node_momentum_correction, rest[MOMENTA_MOST_NODES];
    memset(correction, 0, (size_t)(n * points) * sizeof *correction);
    for (int j = 0; j < n; j++) {
        const double *H_p =
            seeds_get_field_output_row(action, action->field_tape, action->field_tape_values_at_nodes, n + j);
        JET_IN_VECTORS
        for (int node = 0; node < points; node++) rest[node] = action->gradient_by_v[j * points + node] - H_p[node];
        for (int i = 0; i < n; i++) JET_IN_VECTORS
        for (int node = 0; node < points; node++)
            correction[i * points + node] += action->H_pp[(i * n + j) * points + node] * rest[node];
    }
    return tvi_largest_magnitude(n * points, correction, 1);
}

/* Returns whether each momentum's last correction is below a unit roundoff of that momentum. */
static inline bool momenta_are_corrections_roundoff(const tvi_action *action, int n, const double p[])
{
    const int points = action->node_count;
    for (int i = 0; i < n; i++)
        if (tvi_largest_magnitude(points, action->node_momentum_correction + i * points, 1) >
            DBL_EPSILON * tvi_largest_magnitude(points, p + i * points, 1))
            return false;
    return true;
}

/* Finds momenta with H_p(q_i, p_i) = v_i at all nodes, from those of the curve, by Newton's method. The momenta are
 * left in the second input of field_tape_values_at_nodes, and the field is evaluated with them. */
static inline tvi_status momenta_solve_at_nodes(tvi_action *action, tvi_curve *curve)
{
    const int count = curve_dimension(curve) * action->node_count;
    double *p = action->field_tape_values_at_nodes + count;
    tvi_convergence_test passes;
    tvi_convergence_begin(&passes, 0);
    memcpy(p, action->p_at_nodes, (size_t)count * sizeof *p);
    const double size = tvi_largest_magnitude(count, p, 1);
    const tvi_stopping_rule rule = {.correction_goal = DBL_EPSILON * size,
                                    .max_trusted_ratio = PASSES_MAX_CONTRACTION,
                                    .stall_ratio = TVI_STALL_WITHOUT_DECREASE,
                                    .stall_comparison_lag = 1};
    for (int step = 0; step < MOMENTA_MAX_ITERATIONS; step++) {
        tvi_status status = seeds_evaluate_field_at_nodes(action);
        if (status == TVI_OK && (step == 0 || !(passes.size <= MOMENTA_REUSE_MAX_RATIO * passes.previous_size)))
            status = momenta_invert_H_pp(action, curve);
        if (status != TVI_OK) return status;
        const double largest = momenta_compute_corrections(action, curve);
        if (!isfinite(largest)) return TVI_ENONFINITE;
        if (step > 0 && momenta_are_corrections_roundoff(action, curve_dimension(curve), p)) return TVI_OK;
        const tvi_passes_verdict verdict = tvi_convergence_add_pass(&passes, &rule, largest);
        for (int i = 0; i < count; i++) p[i] += action->node_momentum_correction[i];
        if (verdict == TVI_PASSES_MAY_END ||
            (verdict == TVI_PASSES_STUCK &&
             (largest <= MOMENTA_STALLED_CORRECTION * size ||
              tvi_convergence_set_roundoff(&passes, tvi_estimate_node_momenta_roundoff(action, curve)))))
            return seeds_evaluate_field_at_nodes(action);
    }
    return TVI_ENOCONV;
}

#endif
