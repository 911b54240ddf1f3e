/* generated_lagrangian.h - Makes generated steps of a Lagrangian (lagrangian.c). */
#ifndef TVI_SRC_GALERKIN_GENERATED_LAGRANGIAN_H
#define TVI_SRC_GALERKIN_GENERATED_LAGRANGIAN_H

#include "galerkin/generated_hessian.h"
#include "galerkin/lagrangian_passes.h"

/* Makes a pass. The library measures the roundoff of passes that are stuck. */
JET_INLINE tvi_status galerkin_pass_lagrangian(void *work, const galerkin_nodes *nodes, double *moved, double *roundoff)
{
    lagrangian_passes *w = work;
    (void)nodes;
    if (roundoff || lagrangian_pass(w, galerkin_generated_sweep) != LAGRANGIAN_PASSED) return TVI_ENOCONV;
    *moved = w->moved;
    return TVI_OK;
}

JET_INLINE void galerkin_predict_lagrangian(void *work, const galerkin_nodes *nodes, const galerkin_extrapolation *by)
{
    (void)nodes;
    lagrangian_predict(work, by);
}

static void galerkin_steps(const galerkin_frame *given, const tvi_step_run *row, const tvi_origin *origin,
                           const tvi_run_state *now, galerkin_outcome *to)
{
    enum { N = GALERKIN_N, ALL = GALERKIN_IS_OWN ? N * GALERKIN_LANES : 1 };
    galerkin_local_blocks own;
    _Alignas(64) double displacements[ALL], rise[2 * ALL], gradient[2 * ALL], moved[2 * ALL];
    _Alignas(64) double lu[N * ALL], inverse[N * ALL], scale[2 * ALL], x[ALL];
    int pivot[ALL];
    const galerkin_tail_inputs inputs = galerkin_sized_tail_inputs(given->tail_inputs);
    galerkin_frame frame = *given;
    galerkin_nodes nodes = galerkin_sized(given->nodes);
    lagrangian_passes w = *(const lagrangian_passes *)given->own;
    frame.tail_inputs = &inputs;
    w.factors = 0;
    w.nodes = &nodes;
    w.blocks = galerkin_own_blocks(&w.blocks, &nodes, &own);
    if (GALERKIN_IS_OWN) galerkin_keep_rows(own.x, given->nodes->x, 0, to->known > 0 ? 0 : 3 * N);
    w.rates = galerkin_sized(&w.rates);
    w.rates.x = nodes.x + 2 * N * GALERKIN_LANES;
    w.slot = galerkin_slot;
    w.output[false] = galerkin_value_slot;
    w.output[true] = galerkin_hessian_slot;
    w.model.n = w.mass.n = N;
    w.model.lanes = GALERKIN_LANES;
    w.model.hessian = w.blocks.hessian;
    w.model.term = galerkin_term;
    w.model.end = galerkin_end;
    if (GALERKIN_IS_OWN) {
        galerkin_keep_rows(displacements, w.displacements, 0, to->known > 0 ? 0 : N);
        w.displacements = displacements;
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
    const galerkin_solver solver = {galerkin_pass_lagrangian, galerkin_predict_lagrangian, NULL, &w};
    galerkin_make_steps(&frame, &nodes, &solver, row, origin, now, to);
    to->factors = w.factors;
}

#endif
