/* kernel_loops.h - Defines the functions that a Galerkin step calls for all unknowns at all its nodes, for one number
 * of nodes: they predict the unknowns, change them by the forces, sum the impulses of the forces over the step, and
 * compute its increments and its tail. loops.h describes each of them. kernel.h includes this file after the functions
 * for a single unknown. */

KERNEL_FUNCTION void NAME(set_constant_drift_values)(const galerkin_nodes *nodes, int n, const tvi_step_origin *origin)
{
    NAME(set_constant_drift_of_half)(nodes, 0, n, origin->q, origin->q_low);
    NAME(set_constant_drift_of_half)(nodes, n, n, origin->p, origin->p_low);
}

KERNEL_FUNCTION void NAME(set_linear_drift_values)(const galerkin_nodes *nodes, const double *node_abscissa,
                                                   const tvi_step_origin *origin, double *drift, double *drift_low)
{
    for (int u = 0; u < nodes->unknown_count; u++) {
        drift[u] = nodes->unknown_change_per_impulse[u] * origin->p[u];
        drift_low[u] = fma(nodes->unknown_change_per_impulse[u], origin->p[u], -drift[u]) +
                       nodes->unknown_change_per_impulse[u] * origin->p_low[u];
    }
    for (int u = 0; u < nodes->unknown_count; u++)
        NAME(set_linear_drift_of_unknown)(nodes, u, node_abscissa, origin, drift, drift_low);
}

KERNEL_FUNCTION void NAME(predict)(const galerkin_nodes *nodes, const galerkin_extrapolation *extrapolation)
{
    NAME(predict_all)(nodes, extrapolation);
}

KERNEL_FUNCTION void NAME(set_sizes)(const galerkin_nodes *nodes, int n)
{
    const tvi_subsystems parts = nodes->subsystems;
    for (int k = 0, first = 0, end; k < parts.count; k++, first = end) {
        end = tvi_subsystems_end_in_component_list(&parts, k, n);
        NAME(set_sizes_of)(nodes, n, first, end);
    }
}

KERNEL_FUNCTION double NAME(move)(const galerkin_nodes *nodes, const double *matrix, const double *rates,
                                  const int slot[])
{
    NAME(set_impulses)(nodes, rates, slot);
    return NAME(move_unknowns)(nodes, matrix, NULL);
}

KERNEL_FUNCTION void NAME(sum_impulses)(const galerkin_nodes *nodes,
                                        const galerkin_double_integral_and_tail_weights *weights,
                                        const galerkin_impulse_sums *sums)
{
    NAME(sum_all_impulses)(nodes, weights, sums);
}

KERNEL_FUNCTION void NAME(compute_drifting_increments)(const galerkin_nodes *nodes, const galerkin_impulse_sums *sums,
                                                       const double *drift, const double *drift_low,
                                                       const tvi_increments *increments)
{
    for (int u = 0; u < nodes->unknown_count; u++) {
        increments->dq[u] = galerkin_compute_coordinate_increment(
            drift[u], drift_low[u], nodes->unknown_change_per_impulse[u], sums->rate_double_integral[u],
            sums->rate_double_integral_low[u], &increments->dq_low[u]);
        increments->dp[u] = sums->rate_integral[u];
        increments->dp_low[u] = sums->rate_integral_low[u];
    }
}

KERNEL_FUNCTION void NAME(compute_increments)(const galerkin_nodes *nodes, const galerkin_impulse_sums *sums, int n,
                                              const tvi_increments *increments)
{
    for (int i = 0; i < n; i++) {
        increments->dq[i] = nodes->unknown_change_per_impulse[i] * sums->rate_integral[i];
        increments->dq_low[i] = nodes->unknown_change_per_impulse[i] * sums->rate_integral_low[i];
        increments->dp[i] = nodes->unknown_change_per_impulse[n + i] * sums->rate_integral[n + i];
        increments->dp_low[i] = nodes->unknown_change_per_impulse[n + i] * sums->rate_integral_low[n + i];
    }
}

/* Implements the kernel compute_tail. is_separable is a constant in each call, so that the loop over the components
 * has no branches. */
JET_INLINE double NAME(compute_tail_of_form)(const galerkin_tail_inputs *tail_inputs, bool is_separable)
{
    galerkin_tail_inputs inputs = *tail_inputs;
    double *restrict share = inputs.component_share_of_subsystem_motion, *restrict ratio = inputs.component_tail_ratio;
    inputs.is_separable = is_separable;
    for (int i = 0; i < inputs.n; i++) {
        const size_t momentum = (size_t)(is_separable ? i : i + inputs.n);
        const tvi_component_sizes_in_step component = galerkin_compute_component_sizes(&inputs, i, (size_t)i, momentum);
        share[i] = tvi_component_share_of_step_motion(&component, is_separable || inputs.has_masses);
        ratio[i] = tvi_largest_relative_last_series_term(&component);
    }
    return tvi_compute_tail(&inputs.subsystems, inputs.n, share, ratio);
}

KERNEL_FUNCTION double NAME(compute_tail)(const galerkin_tail_inputs *inputs)
{
    return inputs->is_separable ? NAME(compute_tail_of_form)(inputs, true) : NAME(compute_tail_of_form)(inputs, false);
}

KERNEL_FUNCTION double NAME(move_in_parts)(const galerkin_nodes *nodes, const double *matrix, const double *rates,
                                           const int slot[], double *displacements)
{
    NAME(set_impulses)(nodes, rates, slot);
    return NAME(move_unknowns)(nodes, matrix, displacements);
}

KERNEL_FUNCTION double NAME(move_with_changes)(const galerkin_nodes *nodes, const double *matrix, const double *rates,
                                               const double *changes, const int slot[])
{
    for (int u = 0; u < nodes->unknown_count; u++)
        set_impulses_to_weight_times_rate_plus_change(nodes->impulse_weight, rates + slot[u] * LANES,
                                                      changes + u * LANES, nodes->impulses + u * LANES, LANES);
    return NAME(move_unknowns)(nodes, matrix, NULL);
}

KERNEL_FUNCTION void NAME(evaluate)(const galerkin_curve_at_points_inputs *inputs, const double *integral_table,
                                    const double *impulses, double *out)
{
    if (inputs->point_count == TVI_SAMPLES)
        evaluate_curve_at_points(inputs, integral_table, impulses, out, LANES, TVI_SAMPLES);
    else evaluate_curve_at_points(inputs, integral_table, impulses, out, LANES, inputs->point_count);
}

#undef V
