/* generated_hamiltonian.h - Makes generated steps of a product (hamiltonian.c). */
#ifndef TVI_SRC_GALERKIN_GENERATED_HAMILTONIAN_H
#define TVI_SRC_GALERKIN_GENERATED_HAMILTONIAN_H

#include "galerkin/generated_hessian.h"
#include "galerkin/hamiltonian_passes.h"

/* Makes a pass. The library measures the roundoff of passes that are stuck. */
JET_INLINE tvi_status galerkin_pass_hamiltonian(void *work, const galerkin_nodes *nodes, double *moved,
                                                double *roundoff)
{
    hamiltonian_passes *w = work;
    (void)nodes;
    if (roundoff || !hamiltonian_pass(w, galerkin_generated_sweep)) return TVI_ENOCONV;
    *moved = w->moved;
    return TVI_OK;
}

JET_INLINE void galerkin_predict_hamiltonian(void *work, const galerkin_nodes *nodes, const galerkin_extrapolation *by)
{
    (void)nodes;
    hamiltonian_predict(work, by);
}

/* Makes steps. The rounds have GALERKIN_COLUMNS columns, and GALERKIN_ROWS rows, of which GALERKIN_ROUND move. */
static void galerkin_steps(const galerkin_frame *given, const tvi_step_run *row, const tvi_origin *origin,
                           const tvi_run_state *now, galerkin_outcome *to)
{
    enum { PACKED = GALERKIN_ROWS * GALERKIN_COLUMNS * GALERKIN_LANES, IS_PACKED = PACKED <= 2 * GALERKIN_MOST_OWN };
    enum { ROWS = IS_PACKED ? GALERKIN_ROWS : 1, ALL = IS_PACKED ? GALERKIN_ROWS * GALERKIN_LANES : 1 };
    galerkin_local_blocks own;
    _Alignas(64) float packed[IS_PACKED ? PACKED : 1], change[ALL], total[ALL], impulse[ALL], all[ALL];
    double size[ROWS], per_size[ROWS];
    const galerkin_tail_inputs inputs = galerkin_sized_tail_inputs(given->tail_inputs);
    galerkin_frame frame = *given;
    galerkin_nodes nodes = galerkin_sized(given->nodes);
    hamiltonian_passes w = *(const hamiltonian_passes *)given->own;
    frame.tail_inputs = &inputs;
    w.nodes = &nodes;
    w.blocks = galerkin_own_blocks(&w.blocks, &nodes, &own);
    if (GALERKIN_IS_OWN) galerkin_keep_rows(own.x, given->nodes->x, 0, to->known > 0 ? 0 : GALERKIN_UNKNOWNS);
    w.rates = galerkin_sized(&w.rates);
    w.rates.x = nodes.x + GALERKIN_UNKNOWNS * GALERKIN_LANES;
    w.rate_row = galerkin_slot;
    w.slot[false] = galerkin_value_slot;
    w.slot[true] = galerkin_hessian_slot;
    w.rounds.count = GALERKIN_COLUMNS;
    w.rounds.moving = GALERKIN_ROUND;
    w.rounds.rows = GALERKIN_ROWS;
    w.rounds.unknown = galerkin_unknown;
    w.rounds.index = galerkin_index_of;
    w.rounds.hessian = w.blocks.hessian;
    if (IS_PACKED) {
        w.rounds.packed = packed;
        w.rounds.size = size;
        w.rounds.per_size = per_size;
        w.rounds.change = change;
        w.rounds.total = total;
        w.rounds.impulse = impulse;
        w.rounds.all = all;
    }
    const galerkin_solver solver = {galerkin_pass_hamiltonian, galerkin_predict_hamiltonian, NULL, &w};
    galerkin_make_steps(&frame, &nodes, &solver, row, origin, now, to);
}

#endif
