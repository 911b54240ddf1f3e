/* action.c - computes the gradient of the discrete action as seeds: vectors that multiply the transposed Jacobians of
 * the curve's coefficients. seeds.h computes the terms with first derivatives of the Lagrangian or the Hamiltonian, and
 * this file those with second derivatives. For passes that no longer converge, this file also estimates the roundoff of
 * the ends of a step from that of the field at the nodes (docs/method.md section 5). curve_stepper.c, both_ends.c and
 * both_ends_nodes.c call it. */
#include "generating/curve_stepper.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <string.h>

double tvi_estimate_node_momenta_roundoff(tvi_action *action, tvi_curve *curve)
{
    const int n = curve->n, points = action->node_count;
    tvi_roundoff_estimator *roundoff = &action->field_roundoff;
    if (tvi_curve_factor_velocity_hessian(curve) != TVI_OK) return 0;
    (void)tvi_roundoff_estimate_field(roundoff, curve->system, action->field_tape_values_at_nodes, points, points);
    for (int i = 0; i < n; i++) {
        const double of_v = DBL_EPSILON * tvi_largest_magnitude(points, action->gradient_by_v + i * points, 1);
        action->node_momentum_correction[i] =
            tvi_roundoff_sign_randomly(roundoff, roundoff->output_roundoff[n + i] + of_v);
    }
    tvi_factor_solve(&curve->velocity_hessian, action->node_momentum_correction);
    return ROUNDOFF_MAX_UNITS * tvi_largest_magnitude(n, action->node_momentum_correction, 1);
}

int tvi_estimate_end_state_roundoff(tvi_action *action, const tvi_curve *curve, double h, const double q[],
                                    const double p[], double q_roundoff[], double p_roundoff[])
{
    const tvi_system *system = curve->system;
    const double *output_roundoff = action->field_roundoff.output_roundoff;
    const bool separable = system->form == TVI_SEPARABLE;
    const int n = curve->n, points = action->node_count;
    memset(q_roundoff, 0, (size_t)n * sizeof *q_roundoff);
    memset(p_roundoff, 0, (size_t)n * sizeof *p_roundoff);
    if (!tvi_roundoff_may_exceed_motion(system, h, q, p, action->field_tape_values_at_nodes, action->p_at_nodes, points,
                                        points))
        return 0;
    const int values = tvi_roundoff_estimate_field(&action->field_roundoff, system, action->field_tape_values_at_nodes,
                                                   points, points);
    for (int i = 0; i < n; i++) {
        const double of_force = fabs(h) * output_roundoff[i], of_second = separable ? 0 : output_roundoff[n + i];
        p_roundoff[i] = of_force + DBL_EPSILON * fabs(p[i]);
        if (separable) q_roundoff[i] = fabs(h) / system->mass[i] * of_force;
        else if (system->form == TVI_HAMILTONIAN) q_roundoff[i] = fabs(h) * of_second;
        else p_roundoff[i] += of_second;
    }
    return values;
}

tvi_status tvi_evaluate_lagrangian_at_nodes(tvi_action *action, tvi_curve *curve, const double q[], const double v[],
                                            const double p[])
{
    const size_t panel = (size_t)(curve->n * action->node_count) * sizeof *q;
    memcpy(action->field_tape_values_at_nodes, q, panel);
    memcpy(action->gradient_by_v, v, panel);
    memcpy(action->p_at_nodes, p, panel);
    seeds_set_node_times(action, curve, action->field_tape_values_at_nodes);
    return seeds_compute_lagrange_node_gradient(action, curve);
}

/* Computes the derivatives of the action's terms at truncated nodes. There q_i lacks the highest term of the curve, and
 * q'_i = H_p(q_i, p_i). The derivatives are gradient_by_q = tau (H_qp p - H_q), gradient_by_p = tau H_pp p and
 * gradient_by_v = -p. */
static tvi_status compute_action_gradient_with_truncated_q(tvi_action *action, const tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const int n = curve->n, points = action->node_count;
    const size_t panel = (size_t)(n * points) * sizeof(double);
    const bool separable = system->form == TVI_SEPARABLE;
    if (!separable) memcpy(action->field_tape_values_at_nodes + n * points, action->p_at_nodes, panel);
    const tvi_status status = seeds_evaluate_field_at_nodes(action);
    if (status != TVI_OK) return status;
    seeds_copy_scaled_field_outputs(action, curve, 0, separable ? curve->time_unit : -curve->time_unit,
                                    action->gradient_by_q);
    if (!separable) {
        memcpy(action->hessian_product_block, action->field_tape_values_at_nodes,
               (size_t)(2 * n + system->uses_time) * (size_t)points * sizeof(double));
        memcpy(action->hessian_product_block + (2 * n + 1) * points, action->p_at_nodes, panel);
        if (!jet_sweep_values(system->r_dot_Hp_values, action->hessian_product_block, points)) return TVI_EDOMAIN;
    }
    for (int i = 0; i < n; i++)
        for (int node = 0; node < points; node++) {
            const int place = i * points + node;
            if (separable) {
                action->gradient_by_p[place] = curve->time_unit * action->p_at_nodes[place] / system->mass[i];
            } else {
                action->gradient_by_q[place] +=
                    curve->time_unit *
                    seeds_get_field_output_row(action, system->r_dot_Hp_values, action->hessian_product_block, i)[node];
                action->gradient_by_p[place] =
                    curve->time_unit * seeds_get_field_output_row(action, system->r_dot_Hp_values,
                                                                  action->hessian_product_block, n + i)[node];
            }
            action->gradient_by_v[place] = -action->p_at_nodes[place];
        }
    return TVI_OK;
}

/* ---- The seeds --------------------------------------------------------------------------------------------------- */

static tvi_status compute_seeds_without_finite_check(tvi_action *action, tvi_curve *curve, double seed_Q[],
                                                     double seed_U[])
{
    if (seeds_need_no_second_derivatives(action))
        return tvi_choose_curve_isa_functions(action->field_tape)->compute_seeds(action, curve, seed_Q, seed_U);
    seeds_clear_seeds_and_evaluate_curve_at_nodes(action, curve, seed_Q, seed_U);
    const tvi_status status = compute_action_gradient_with_truncated_q(action, curve);
    if (status == TVI_OK) seeds_compute_from_node_gradient(action, curve, seed_Q, seed_U);
    return status;
}

tvi_status tvi_compute_action_seeds(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    const int seeds = (curve->highest_order + 1) * curve->n;
    const bool has_U = curve->system->form != TVI_SEPARABLE;
    const tvi_status status = compute_seeds_without_finite_check(action, curve, seed_Q, seed_U);
    if (status != TVI_OK) return status;
    return tvi_all_finite(seeds, seed_Q) && (!has_U || tvi_all_finite(seeds, seed_U)) ? TVI_OK : TVI_ENONFINITE;
}
