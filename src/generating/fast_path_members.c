/* fast_path_members.c - compiles the fast-path step of several members (curve_step.h: a whole step in the common case
 * that passes converge as usual, without fallbacks), and their plain Taylor step, for one instruction set. The build
 * compiles this file once for each instruction set; choose.c selects among the results for curve_batch.c. */
#define CURVE_MEMBERS
#include "generating/members.h"
#include "generating/fast_path.h"
#include "generating/step_size.h"
#include "method/single.h"

static void drop_members_outside_domain(const tvi_curve_workspace *work, bool at_nodes, long long iterating_mask[])
{
    const tvi_curve *curve = &work->corrected_curve.curve;
    const jet_tape *tape = at_nodes ? work->action.field_tape : curve->system->field_series;
    const double *x = at_nodes ? work->action.field_tape_values_at_nodes : curve->series_block;
    for (int m = 0; m < curve->member_count; m++)
        if (iterating_mask[m] &&
            !tvi_is_member_inside_domain(work->single_stepper, tape, x, at_nodes ? work->action.node_count : 1, m))
            iterating_mask[m] = 0;
}

bool JET_FOR_ISA(tvi_fast_path_step_of_members)(tvi_curve_workspace *work, double tau, const tvi_batch_origin *origin,
                                                const tvi_fast_path_step_results *results, tvi_stats *stats)
{
    static const fast_path_expansion_and_seed_functions functions = {
        curve_expand_series, fast_path_expand_with_tangents, seeds_compute_adjoint_seeds_from_field_only,
        drop_members_outside_domain};
    return step_try_fast_path_steps(work, &functions, tau, origin, results, stats);
}

bool JET_FOR_ISA(tvi_taylor_step_of_members)(tvi_curve_workspace *work, double h, const tvi_batch_origin *origin,
                                             const tvi_fast_path_step_results *results, tvi_stats *stats)
{
    tvi_curve *curve = &work->corrected_curve.curve;
    const int n = curve_dimension(curve), width = curve_member_count(curve);
    curve_set_time_unit(curve, h);
    (void)step_set_centre_state_to_start(work, origin, work->predicted_state);
    if (curve_expand_series(curve) != TVI_OK) drop_members_outside_domain(work, false, results->iterating_mask);
    curve_rescale_and_sum(curve, 1, results->dq, results->dp);
    for (int i = 0; i < n * width; i++) results->dp[i] /= curve->momentum_scale_factor[i / width];
    step_compute_tails(curve, results->tail);
    for (int m = 0; m < width; m++) {
        const bool is_finite = tvi_rows_are_finite(n, (size_t)width, 1, results->dq + m) &&
                               tvi_rows_are_finite(n, (size_t)width, 1, results->dp + m);
        results->pass_counts[m] = results->iterating_mask[m] && is_finite ? 0 : TVI_NOT_MADE;
        stats->expansions += results->pass_counts[m] == 0;
    }
    return true;
}
