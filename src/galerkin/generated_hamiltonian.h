/* generated_hamiltonian.h - generated steps of a product (hamiltonian.c). */
#ifndef TVI_SRC_GALERKIN_GENERATED_HAMILTONIAN_H
#define TVI_SRC_GALERKIN_GENERATED_HAMILTONIAN_H

#include "galerkin/generated_second.h"
#include "galerkin/hamiltonian_passes.h"

/* The library measures the roundoff of passes that are stuck. */
JET_INLINE tvi_status galerkin_pass_hamiltonian(void *of, const galerkin_nodes *nodes, double *moved, double *roundoff)
{
    hamiltonian_passes *w = of;
    (void)nodes;
    if (roundoff || !hamiltonian_pass(w, galerkin_generated_sweep)) return TVI_ENOCONV;
    *moved = w->moved;
    return TVI_OK;
}

JET_INLINE void galerkin_predict_hamiltonian(void *of, const galerkin_nodes *nodes, const galerkin_extrapolation *by)
{
    (void)nodes;
    hamiltonian_predict(of, by);
}

/* The rounds have GALERKIN_COLUMNS columns, and GALERKIN_ROWS rows, of which GALERKIN_ROUND move. */
static void galerkin_steps(const galerkin_frame *of, const tvi_row *row, const tvi_origin *origin,
                           const tvi_run_state *now, galerkin_outcome *to)
{
    enum { PACKED = GALERKIN_ROWS * GALERKIN_COLUMNS * GALERKIN_LANES, IS_PACKED = PACKED <= 2 * GALERKIN_MOST_OWN };
    enum { ROWS = IS_PACKED ? GALERKIN_ROWS : 1, ALL = IS_PACKED ? GALERKIN_ROWS * GALERKIN_LANES : 1 };
    galerkin_room own;
    _Alignas(64) float packed[IS_PACKED ? PACKED : 1], change[ALL], total[ALL], impulse[ALL], all[ALL];
    double size[ROWS], per_size[ROWS];
    const galerkin_motion motion = galerkin_sized_motion(of->motion);
    galerkin_frame frame = *of;
    galerkin_nodes nodes = galerkin_sized(of->nodes);
    hamiltonian_passes w = *(const hamiltonian_passes *)of->own;
    frame.motion = &motion;
    w.nodes = &nodes;
    w.blocks = galerkin_own_blocks(&w.blocks, &nodes, &own);
    if (GALERKIN_IS_OWN) galerkin_keep_rows(own.x, of->nodes->x, 0, to->known > 0 ? 0 : GALERKIN_UNKNOWNS);
    w.drives = galerkin_sized(&w.drives);
    w.drives.x = nodes.x + GALERKIN_UNKNOWNS * GALERKIN_LANES;
    w.of_drives = galerkin_slot;
    w.slot[false] = galerkin_of_values;
    w.slot[true] = galerkin_of_second;
    w.rounds.count = GALERKIN_COLUMNS;
    w.rounds.moving = GALERKIN_ROUND;
    w.rounds.rows = GALERKIN_ROWS;
    w.rounds.unknown = galerkin_unknown;
    w.rounds.place = galerkin_place_of;
    w.rounds.second = w.blocks.second;
    if (IS_PACKED) {
        w.rounds.packed = packed;
        w.rounds.size = size;
        w.rounds.per_size = per_size;
        w.rounds.change = change;
        w.rounds.total = total;
        w.rounds.impulse = impulse;
        w.rounds.all = all;
    }
    const galerkin_drive drive = {galerkin_pass_hamiltonian, galerkin_predict_hamiltonian, NULL, &w};
    galerkin_make_steps(&frame, &nodes, &drive, row, origin, now, to);
}

#endif
