/* quick.c - computes the seeds of a field at nodes on the curve (seeds.h), and makes the steps of one member whose
 * passes converge as they mostly do. It is compiled once for each instruction set. */
#include "generating/quick.h"
#include "generating/reach.h"

void JET_FOR_ISA(tvi_end_at)(tvi_curve *curve, double factor, double q[], double u[])
{
    curve_rescale_and_sum(curve, factor, q, u);
}

tvi_status JET_FOR_ISA(tvi_seeds_plainly)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[])
{
    return seeds_plainly(action, curve, seed_Q, seed_U);
}

bool JET_FOR_ISA(tvi_step_quickly)(tvi_curve_work *work, double tau, const tvi_batch_origin *origin,
                                   const tvi_curve_end *end, tvi_stats *stats)
{
    static const step_makers makers = {quick_expand, quick_expand_all, seeds_plainly, NULL};
    return step_quickly(work, &makers, tau, origin, end, stats);
}
