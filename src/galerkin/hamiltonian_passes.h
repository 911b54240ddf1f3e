/* hamiltonian_passes.h - Makes the passes of a product's Galerkin curve (hamiltonian.c). The library runs them with the
 * loops of its tables, and generated code with its own, where all sizes are constants. */
#ifndef TVI_SRC_GALERKIN_HAMILTONIAN_PASSES_H
#define TVI_SRC_GALERKIN_HAMILTONIAN_PASSES_H

#include "algebra/sizes.h"
#include "galerkin/blocks.h"
#include "galerkin/loops.h"

#include <math.h>

/* The work of the passes. The rows of nodes->x are Q and P, n each, and their rates at a start or in a prediction. */
typedef struct {
    const galerkin_loops *loops;
    const galerkin_nodes *nodes;
    galerkin_nodes rates; /* as unknowns that begin at 0 */
    const double *matrix; /* of a movement */
    const int *rate_row;  /* [unknowns] the row of each unknown's rate in nodes->x */
    galerkin_blocks blocks;
    /* [unknowns] The row of each unknown's rate, in the block of values, and in that with second derivatives. */
    const int *slot[2];
    lanes_rounds rounds;
    double *changes; /* [unknowns][lanes] of impulses */
    /* Movement of the last pass, as `move` measures it; infinite before the first one of a step. */
    double moved;
} hamiltonian_passes;

/* Squares of relative movements. After a movement of 2^-25 the second derivatives serve once more, since the next pass
 * leaves its cube. */
#define HAMILTONIAN_SERVES  0x1p-50
#define HAMILTONIAN_NOTHING 0x1p-144
/* The rounds of the first pass of a step end at this square: another pass follows, whose movement is no smaller. */
#define HAMILTONIAN_ROUNDOFF 0x1p-108

static inline void hamiltonian_predict(hamiltonian_passes *w, const galerkin_extrapolation *by)
{
    double moved;
    const galerkin_nodes all = galerkin_all_moving(w->nodes);
    galerkin_predict_rates(w->loops, &w->rates, by);
    GALERKIN_LOOP(w->loops, move, &all, w->matrix, w->nodes->x, w->rate_row, &moved);
    w->moved = INFINITY;
}

static inline void hamiltonian_set_sizes(const hamiltonian_passes *w)
{
    const lanes_rounds *rounds = &w->rounds;
    for (int i = 0; i < rounds->rows; i++) {
        rounds->per_size[i] = w->nodes->inverse_size[rounds->unknown[i]];
        rounds->size[i] = 1 / rounds->per_size[i];
    }
}

/* Makes a pass. Returns false outside the field's domain. */
static inline bool hamiltonian_pass(hamiltonian_passes *w, galerkin_sweep *sweep)
{
    const galerkin_nodes *nodes = w->nodes;
    const int numbers = nodes->unknowns * nodes->lanes;
    const bool is_first = isinf(w->moved), serves = w->moved <= HAMILTONIAN_SERVES * numbers;
    const int *slot = w->slot[!serves];
    const double least = numbers * (is_first ? HAMILTONIAN_ROUNDOFF : HAMILTONIAN_NOTHING);
    const double *rates = galerkin_sweep_at(&w->blocks, sweep, !serves, nodes->x, nodes->x + numbers / 2);
    if (!rates) return false;
    if (is_first) hamiltonian_set_sizes(w);
    GALERKIN_LOOP(w->loops, run_rounds, nodes, &w->rounds, rates, slot, !serves, w->moved, least, w->changes);
    w->moved = GALERKIN_LOOP(w->loops, move_both, nodes, w->matrix, rates, w->changes, slot);
    return true;
}

#endif
