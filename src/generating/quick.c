/* quick.c - compiles the quick step of one member (curve_step.h), the seeds of the action and the rescaling of a
 * curve for one instruction set. The build compiles this file once for each instruction set; choose.c selects
 * among the results. */
#include "generating/quick.h"
#include "generating/step_size.h"

void JET_FOR_ISA(tvi_rescale_and_sum)(tvi_curve *curve, double factor, double dq[], double du[])
{
    curve_rescale_and_sum(curve, factor, dq, du);
}

tvi_status JET_FOR_ISA(tvi_seeds_from_field)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    return seeds_compute_from_field(action, curve, seed_Q, seed_U);
}

bool JET_FOR_ISA(tvi_quick_step_single)(tvi_curve_workspace *work, double tau, const tvi_batch_origin *origin,
                                        const tvi_quick_step_results *results, tvi_stats *stats)
{
    static const step_curve_functions functions = {curve_expand_series, quick_expand_with_tangents,
                                                   seeds_compute_from_field, NULL};
    return step_by_quick_passes(work, &functions, tau, origin, results, stats);
}
