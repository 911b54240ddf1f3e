/* quick_members.c - makes the steps of several members at once whose passes converge as they mostly do, and those of
 * the plain Taylor method. It is compiled once for each instruction set. */
#define CURVE_MEMBERS
#include "generating/members.h"
#include "generating/quick.h"
#include "generating/reach.h"
#include "method/single.h"

static void leave_outside(const tvi_curve_work *w, bool at_nodes, long long is_moving[])
{
    const tvi_curve *curve = &w->closure.curve;
    const jet_tape *tape = at_nodes ? w->action.field_tape : curve->system->field_series;
    const double *x = at_nodes ? w->action.field_block : curve->series_block;
    for (int m = 0; m < curve->width; m++)
        if (is_moving[m] && !tvi_is_member_inside_domain(w->by_itself, tape, x, at_nodes ? w->action.points : 1, m))
            is_moving[m] = 0;
}

bool JET_FOR_ISA(tvi_step_members)(tvi_curve_work *work, double tau, const tvi_batch_origin *origin,
                                   const tvi_curve_end *end, tvi_stats *stats)
{
    static const step_makers makers = {quick_expand, quick_expand_all, seeds_plainly, leave_outside};
    return step_quickly(work, &makers, tau, origin, end, stats);
}

bool JET_FOR_ISA(tvi_taylor_members)(tvi_curve_work *work, double h, const tvi_batch_origin *origin,
                                     const tvi_curve_end *end, tvi_stats *stats)
{
    tvi_curve *curve = &work->closure.curve;
    const int n = curve_dimension(curve), width = curve_width(curve);
    curve_set_time_unit(curve, h);
    (void)step_place_start(work, origin, work->z);
    if (quick_expand(curve) != TVI_OK) leave_outside(work, false, end->is_moving);
    curve_rescale_and_sum(curve, 1, end->dq, end->dp);
    for (int i = 0; i < n * width; i++) end->dp[i] /= curve->kappa[i / width];
    step_find_tails(curve, end->tail);
    for (int m = 0; m < width; m++) {
        const bool is_finite = tvi_rows_are_finite(n, (size_t)width, 1, end->dq + m) &&
                               tvi_rows_are_finite(n, (size_t)width, 1, end->dp + m);
        end->passes[m] = end->is_moving[m] && is_finite ? 0 : TVI_NOT_MADE;
        stats->expansions += end->passes[m] == 0;
    }
    return true;
}
