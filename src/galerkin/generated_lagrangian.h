/* generated_lagrangian.h - generated steps of a Lagrangian (lagrangian.c). */
#ifndef TVI_SRC_GALERKIN_GENERATED_LAGRANGIAN_H
#define TVI_SRC_GALERKIN_GENERATED_LAGRANGIAN_H

#include "galerkin/generated_second.h"
#include "galerkin/lagrangian_passes.h"

/* The library measures the roundoff of passes that are stuck. */
JET_INLINE tvi_status galerkin_pass_lagrangian(void *of, const galerkin_nodes *nodes, double *moved, double *roundoff)
{
    lagrangian_passes *w = of;
    (void)nodes;
    if (roundoff || lagrangian_pass(w, galerkin_generated_sweep) != LAGRANGIAN_PASSED) return TVI_ENOCONV;
    *moved = w->moved;
    return TVI_OK;
}

JET_INLINE void galerkin_predict_lagrangian(void *of, const galerkin_nodes *nodes, const galerkin_extrapolation *by)
{
    (void)nodes;
    lagrangian_predict(of, by);
}

static void galerkin_steps(const galerkin_frame *of, const tvi_row *row, const tvi_origin *origin,
                           const tvi_run_state *now, galerkin_outcome *to)
{
    enum { N = GALERKIN_N, ALL = GALERKIN_IS_OWN ? N * GALERKIN_LANES : 1 };
    galerkin_room own;
    _Alignas(64) double ways[ALL], rise[2 * ALL], gradient[2 * ALL], moved[2 * ALL];
    _Alignas(64) double lu[N * ALL], inverse[N * ALL], scale[2 * ALL], x[ALL];
    int pivot[ALL];
    const galerkin_motion motion = galerkin_sized_motion(of->motion);
    galerkin_frame frame = *of;
    galerkin_nodes nodes = galerkin_sized(of->nodes);
    lagrangian_passes w = *(const lagrangian_passes *)of->own;
    frame.motion = &motion;
    w.factors = 0;
    w.nodes = &nodes;
    w.blocks = galerkin_own_blocks(&w.blocks, &nodes, &own);
    if (GALERKIN_IS_OWN) galerkin_keep_rows(own.x, of->nodes->x, 0, to->known > 0 ? 0 : 3 * N);
    w.drives = galerkin_sized(&w.drives);
    w.drives.x = nodes.x + 2 * N * GALERKIN_LANES;
    w.slot = galerkin_slot;
    w.output[false] = galerkin_of_values;
    w.output[true] = galerkin_of_second;
    w.model.n = w.mass.n = N;
    w.model.lanes = w.mass.lanes = GALERKIN_LANES;
    w.model.second = w.blocks.second;
    w.model.term = galerkin_term;
    w.model.end = galerkin_end;
    if (GALERKIN_IS_OWN) {
        galerkin_keep_rows(ways, w.ways, 0, to->known > 0 ? 0 : N);
        w.ways = ways;
        w.rise[0] = rise;
        w.rise[1] = rise + ALL;
        w.model.gradient = w.gradient = gradient;
        w.model.moved = moved;
        w.mass.lu = lu;
        w.mass.inverse = inverse;
        w.mass.row_scale = scale;
        w.mass.column_scale = scale + ALL;
        w.mass.pivot = pivot;
        w.mass.x = x;
    }
    const galerkin_drive drive = {galerkin_pass_lagrangian, galerkin_predict_lagrangian, NULL, &w};
    galerkin_make_steps(&frame, &nodes, &drive, row, origin, now, to);
    to->factors = w.factors;
}

#endif
