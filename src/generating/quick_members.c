/* quick_members.c - makes the steps of several members at once whose passes converge as they mostly do. It is compiled
 * once for each instruction set. */
#define CURVE_MEMBERS
#include "generating/members.h"
#include "generating/quick.h"
#include "method/single.h"

static void leave_outside(const tvi_curve_work *w, bool at_nodes, long long is_moving[])
{
    const tvi_curve *curve = &w->closure.curve;
    const jet_tape *tape = at_nodes ? w->action.field : curve->system->field_series;
    const double *x = at_nodes ? w->action.x : curve->x;
    for (int m = 0; m < curve->width; m++)
        if (is_moving[m] && !tvi_single_is_inside(w->by_itself, tape, x, at_nodes ? w->action.points : 1, m))
            is_moving[m] = 0;
}

bool JET_FOR_ISA(tvi_step_members)(tvi_curve_work *work, double tau, const tvi_batch_origin *origin,
                                   const tvi_curve_end *end, tvi_stats *stats)
{
    static const step_makers makers = {quick_expand, quick_expand_all, seeds_plainly, leave_outside};
    return step_quickly(work, &makers, tau, origin, end, stats);
}
