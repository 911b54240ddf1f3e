/* kernel_loops.h - Defines the functions that a Galerkin step calls for all unknowns at all its nodes, for one number
 * of nodes: they predict the unknowns, change them by the forces, sum the impulses of the forces over the step, and
 * compute its increments and its tail. loops.h describes each of them. kernel.h includes this file after the functions
 * for a single unknown. */

KERNEL_FUNCTION void NAME(set_constant_drift_values)(const galerkin_nodes *nodes, int n, const tvi_step_origin *origin)
{
    EACH_VECTOR(NAME(set_constant_drift_of_half)(nodes, 0, n, origin->q, origin->q_low, shape, here));
    EACH_VECTOR(NAME(set_constant_drift_of_half)(nodes, n, n, origin->p, origin->p_low, shape, here));
}

KERNEL_FUNCTION void NAME(set_linear_drift_values)(const galerkin_nodes *nodes, const double *node_abscissa,
                                                   const tvi_step_origin *origin, double *drift, double *drift_low)
{
    const int width = MEMBERS ? nodes->member_count : 1;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int at = u * width; at < (u + 1) * width; at++) {
            drift[at] = nodes->unknown_change_per_impulse[u] * origin->p[at];
            drift_low[at] = fma(nodes->unknown_change_per_impulse[u], origin->p[at], -drift[at]) +
                            nodes->unknown_change_per_impulse[u] * origin->p_low[at];
        }
    for (int u = 0; u < nodes->unknown_count; u++)
        EACH_VECTOR(NAME(set_linear_drift_of_unknown)(nodes, u, node_abscissa, origin, drift, drift_low, shape, here));
}

KERNEL_FUNCTION void NAME(predict)(const galerkin_nodes *nodes, const galerkin_extrapolation *extrapolation)
{
    EACH_VECTOR(NAME(predict_all)(nodes, extrapolation, shape, here));
}

KERNEL_FUNCTION void NAME(set_sizes)(const galerkin_nodes *nodes, int n)
{
    const tvi_subsystems parts = nodes->subsystems;
    for (int k = 0, first = 0, end; k < parts.count; k++, first = end) {
        end = tvi_subsystems_end_in_component_list(&parts, k, n);
        EACH_VECTOR(NAME(set_sizes_of)(nodes, n, first, end, shape, here));
    }
}

KERNEL_FUNCTION void NAME(move)(const galerkin_nodes *nodes, const double *matrix, const double *rates,
                                const int slot[], double movement[])
{
    EACH_VECTOR(NAME(move_all)(nodes, matrix, rates, slot, movement, shape, here));
}

KERNEL_FUNCTION void NAME(sum_impulses)(const galerkin_nodes *nodes,
                                        const galerkin_double_integral_and_tail_weights *weights,
                                        const galerkin_impulse_sums *sums)
{
    EACH_VECTOR(NAME(sum_all_impulses)(nodes, weights, sums, shape, here));
}

KERNEL_FUNCTION void NAME(compute_drifting_increments)(const galerkin_nodes *nodes, const galerkin_impulse_sums *sums,
                                                       const double *drift, const double *drift_low,
                                                       const tvi_increments *increments)
{
    const int width = MEMBERS ? nodes->member_count : 1;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int at = u * width; at < (u + 1) * width; at++) {
            increments->dq[at] = galerkin_compute_coordinate_increment(
                drift[at], drift_low[at], nodes->unknown_change_per_impulse[u], sums->rate_double_integral[at],
                sums->rate_double_integral_low[at], &increments->dq_low[at]);
            increments->dp[at] = sums->rate_integral[at];
            increments->dp_low[at] = sums->rate_integral_low[at];
        }
}

KERNEL_FUNCTION void NAME(compute_increments)(const galerkin_nodes *nodes, const galerkin_impulse_sums *sums, int n,
                                              const tvi_increments *increments)
{
    const int width = MEMBERS ? nodes->member_count : 1, half = n * width;
    for (int i = 0; i < n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            increments->dq[at] = nodes->unknown_change_per_impulse[i] * sums->rate_integral[at];
            increments->dq_low[at] = nodes->unknown_change_per_impulse[i] * sums->rate_integral_low[at];
            increments->dp[at] = nodes->unknown_change_per_impulse[n + i] * sums->rate_integral[half + at];
            increments->dp_low[at] = nodes->unknown_change_per_impulse[n + i] * sums->rate_integral_low[half + at];
        }
}

/* Implements the kernel compute_tails. is_separable is a constant in each call, so that the loop over the components
 * has no branches. */
JET_INLINE void NAME(compute_tails_of_form)(const galerkin_tail_inputs *tail_inputs, bool is_separable, int width,
                                            double tail[])
{
    galerkin_tail_inputs inputs = *tail_inputs;
    double *restrict share = inputs.component_share_of_subsystem_motion, *restrict ratio = inputs.component_tail_ratio;
    inputs.is_separable = is_separable;
    for (int i = 0; i < inputs.n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            const size_t momentum = (size_t)(is_separable ? at : at + inputs.n * width);
            const tvi_component_sizes_in_step component =
                galerkin_compute_component_sizes(&inputs, i, (size_t)at, momentum);
            share[at] = tvi_component_share_of_step_motion(&component, is_separable || inputs.has_masses);
            ratio[at] = tvi_largest_relative_last_series_term(&component);
        }
    tvi_compute_tails_of_ensemble_members(&inputs.subsystems, inputs.n, width, share, ratio, tail);
}

KERNEL_FUNCTION void NAME(compute_tails)(const galerkin_tail_inputs *inputs, int member_count, double tail[])
{
    const int width = MEMBERS ? member_count : 1;
    if (inputs->is_separable) NAME(compute_tails_of_form)(inputs, true, width, tail);
    else NAME(compute_tails_of_form)(inputs, false, width, tail);
}

#if MEMBERS
/* The operations with which judge.h defines members_add_correction_and_check_convergence, which judges the passes of
 * several members at once. */
#define JUDGED(name)       members_##name
#define REAL               V
#define TRUTH              JET_MASK(jet_widest)
#define ABOVE(a, b)        ((a) > (b))
#define AT_MOST(a, b)      ((a) <= (b))
#define NOT(a)             (~(a))
#define AND(a, b)          ((a) & (b))
#define OR(a, b)           ((a) | (b))
#define IF(which, yes, no) JET_CHOOSE(V, which, yes, no)
#include "algebra/judge.h"

KERNEL_FUNCTION int NAME(judge_passes)(galerkin_batch_iteration *iteration, const tvi_stopping_rule *caller_rule,
                                       int width, int count)
{
    const tvi_stopping_rule rule = *caller_rule;
    long long left = 0;
    for (int m = 0; m < width; m += NUMBERS_OF(V)) {
        const JET_MASK(jet_widest) moves = *(const JET_MASK(jet_widest) *)(iteration->moving_mask + m);
        const V movement = *(const V *)(iteration->movement_square + m), infinite = INFINITY - (V){0},
                slowest = *(V *)(iteration->largest_contraction_ratio + m);
        members_convergence_test passes = {.count = count - 1,
                                           .size = *(V *)(iteration->last_judged_movement_square + m),
                                           .previous_size = *(V *)(iteration->previous_judged_movement_square + m),
                                           .ratio = *(V *)(iteration->contraction_ratio + m),
                                           .slowest_ratio = slowest,
                                           .size_without_roundoff =
                                               *(V *)(iteration->movement_square_without_roundoff + m),
                                           .contraction_ratio_growth = 1 - (V){0},
                                           .roundoff = {0}};
        JET_MASK(jet_widest) is_stuck;
        const JET_MASK(jet_widest) may_end =
            members_add_correction_and_check_convergence(&passes, &rule, movement, &is_stuck),
                                   is_finite = movement < infinite;
        *(V *)(iteration->last_judged_movement_square + m) = passes.size;
        *(V *)(iteration->previous_judged_movement_square + m) = passes.previous_size;
        *(V *)(iteration->contraction_ratio + m) = passes.ratio;
        *(V *)(iteration->movement_square_without_roundoff + m) = passes.size_without_roundoff;
        *(V *)(iteration->largest_contraction_ratio + m) = JET_CHOOSE(V, moves, passes.slowest_ratio, slowest);
        if (count == 1) *(V *)(iteration->first_movement_square + m) = movement;
        *(V *)(iteration->pass_count_as_double + m) =
            JET_CHOOSE(V, moves, count - (V){0}, *(V *)(iteration->pass_count_as_double + m));
        *(JET_MASK(jet_widest) *)(iteration->converged_mask + m) |= moves & is_finite & may_end;
        *(JET_MASK(jet_widest) *)(iteration->moving_mask + m) = moves & is_finite & ~(may_end | is_stuck);
    }
    for (int m = 0; m < width; m++) left -= iteration->moving_mask[m];
    return (int)left;
}
#endif

#if !MEMBERS
KERNEL_FUNCTION double NAME(move_in_parts)(const galerkin_nodes *nodes, const double *matrix, const double *rates,
                                           const int slot[], double *displacements)
{
    NAME(set_impulses)(nodes, rates, slot, SHAPE_OF(nodes), 0);
    return NAME(move_unknowns)(nodes, matrix, displacements, SHAPE_OF(nodes), 0);
}

KERNEL_FUNCTION double NAME(move_with_changes)(const galerkin_nodes *nodes, const double *matrix, const double *rates,
                                               const double *changes, const int slot[])
{
    for (int u = 0; u < nodes->unknown_count; u++)
        set_impulses_to_weight_times_rate_plus_change(nodes->impulse_weight, rates + slot[u] * LANES,
                                                      changes + u * LANES, nodes->impulses + u * LANES, LANES);
    return NAME(move_unknowns)(nodes, matrix, NULL, SHAPE_OF(nodes), 0);
}

KERNEL_FUNCTION void NAME(evaluate)(const galerkin_curve_at_points_inputs *inputs, const double *integral_table,
                                    const double *impulses, double *out)
{
    if (inputs->point_count == TVI_SAMPLES)
        evaluate_curve_at_points(inputs, integral_table, impulses, out, LANES, TVI_SAMPLES);
    else evaluate_curve_at_points(inputs, integral_table, impulses, out, LANES, inputs->point_count);
}
#endif

#undef V
