/* momenta.c - finds the momenta that belong to velocities, for Lagrange's action of a Hamiltonian: H_p(q_i, p_i) = v_i
 * at all nodes i, by Newton's method. All nodes are solved at once, as lanes of the sweeps. By the Legendre transform
 * of one node after the other (system/legendre.h) a step of type I takes 1.3 to 1.6 times as many instructions. seeds.c
 * calls it. */
#include "generating/action.h"
#include "algebra/passes.h"
#include "sums.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* [iterations] Newton's method for the momenta of the nodes, H_p = v, fails after this many (suite statements of
 * build/check/generating). */
#define MOMENTA_MAX_ITERATIONS 50 /* found: make check-generating */
/* [1] Corrections of the momenta of the nodes that no longer shrink are roundoff if they are this part of the largest
 * momentum. */
#define MOMENTA_STALLED_CORRECTION 1e-13 /* found: make check-generating */
/* [1] H_pp is reused as long as each correction is less than this part of the one before. */
#define MOMENTA_REUSE_MAX_RATIO 1e-3 /* found: make check-generating */

/* Replaces H_pp by H_pp^-1 at all nodes. */
static tvi_status invert_H_pp(const tvi_action *action, tvi_curve *curve)
{
    const int n = curve->n, nodes = action->nodes;
    double *H_pp = action->momenta.H_pp;
    for (int j = 0; j < n; j++) {
        double *direction = action->momenta.tangents + (n + j) * nodes;
        for (int node = 0; node < nodes; node++) direction[node] = 1;
        jet_sweep_one_tangent_per_lane(action->tape, action->slots, action->momenta.tangents, 0, nodes);
        for (int i = 0; i < n; i++)
            memcpy(H_pp + (i * n + j) * nodes, action_output(action, action->tape, action->momenta.tangents, n + i),
                   (size_t)nodes * sizeof *H_pp);
        for (int node = 0; node < nodes; node++) direction[node] = 0;
    }
    return tvi_factor_invert_lanes(&curve->centre.L_vv, nodes, H_pp, H_pp, curve->centre.column);
}

/* Computes the corrections dp = H_pp^-1 (v - H_p), and returns the largest. The velocities are in by_v. */
static double compute_dp(const tvi_action *action, int n)
{
    const int nodes = action->nodes;
    double *dp = action->momenta.dp, rest[2 * HALF];
    memset(dp, 0, (size_t)(n * nodes) * sizeof *dp);
    for (int j = 0; j < n; j++) {
        const double *H_p = action_output(action, action->tape, action->slots, n + j),
                     *v = action->at_nodes.by_v + j * nodes;
        JET_IN_VECTORS
        for (int node = 0; node < nodes; node++) rest[node] = v[node] - H_p[node];
        for (int i = 0; i < n; i++) JET_IN_VECTORS
        for (int node = 0; node < nodes; node++)
            dp[i * nodes + node] += action->momenta.H_pp[(i * n + j) * nodes + node] * rest[node];
    }
    return tvi_largest_magnitude(n * nodes, dp, 1);
}

/* Returns whether the last correction of each momentum is below a unit of roundoff of that momentum. */
static bool is_dp_roundoff(const tvi_action *action, int n, const double p[])
{
    const int nodes = action->nodes;
    for (int i = 0; i < n; i++)
        if (tvi_largest_magnitude(nodes, action->momenta.dp + i * nodes, 1) >
            DBL_EPSILON * tvi_largest_magnitude(nodes, p + i * nodes, 1))
            return false;
    return true;
}

/* Estimates the roundoff of the corrections of the momenta from that of the last H_p. */
static double dp_roundoff(tvi_action *action, tvi_curve *curve)
{
    const int n = curve->n, nodes = action->nodes;
    tvi_roundoff_estimator *roundoff = &action->roundoff;
    if (tvi_curve_factor_L_vv(curve) != TVI_OK) return 0;
    (void)tvi_roundoff_estimate_field(roundoff, curve->system, action->slots, nodes, nodes);
    for (int i = 0; i < n; i++) {
        const double of_v = DBL_EPSILON * tvi_largest_magnitude(nodes, action->at_nodes.by_v + i * nodes, 1);
        action->momenta.dp[i] = tvi_roundoff_sign_randomly(roundoff, roundoff->output_roundoff[n + i] + of_v);
    }
    tvi_factor_solve(&curve->centre.L_vv, action->momenta.dp);
    return ROUNDOFF_MAX_UNITS * tvi_largest_magnitude(n, action->momenta.dp, 1);
}

tvi_status tvi_action_find_node_momenta(tvi_action *action, tvi_curve *curve)
{
    const int count = curve->n * action->nodes;
    double *p = action->slots + count;
    tvi_convergence_test passes;
    tvi_convergence_begin(&passes, 0);
    memcpy(p, action->at_nodes.p, (size_t)count * sizeof *p);
    const double size = tvi_largest_magnitude(count, p, 1);
    const tvi_stopping_rule rule = {.correction_goal = DBL_EPSILON * size,
                                    .max_trusted_ratio = PASSES_MAX_CONTRACTION,
                                    .stall_ratio = TVI_STALL_WITHOUT_DECREASE,
                                    .stall_comparison_lag = 1};
    for (int step = 0; step < MOMENTA_MAX_ITERATIONS; step++) {
        tvi_status status = action_evaluate_field(action);
        if (status == TVI_OK && (step == 0 || !(passes.size <= MOMENTA_REUSE_MAX_RATIO * passes.previous_size)))
            status = invert_H_pp(action, curve);
        if (status != TVI_OK) return status;
        const double largest = compute_dp(action, curve->n);
        if (!isfinite(largest)) return TVI_ENONFINITE;
        if (step > 0 && is_dp_roundoff(action, curve->n, p)) return TVI_OK;
        const tvi_passes_verdict verdict = tvi_convergence_add_pass(&passes, &rule, largest);
        for (int i = 0; i < count; i++) p[i] += action->momenta.dp[i];
        if (verdict == TVI_PASSES_MAY_END ||
            (verdict == TVI_PASSES_STUCK && (largest <= MOMENTA_STALLED_CORRECTION * size ||
                                             tvi_convergence_set_roundoff(&passes, dp_roundoff(action, curve)))))
            return action_evaluate_field(action);
    }
    return TVI_ENOCONV;
}
