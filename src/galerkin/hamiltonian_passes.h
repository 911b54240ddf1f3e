/* hamiltonian_passes.h - the passes of a product's Galerkin curve (hamiltonian.c), which the library runs with the
 * loops of its tables, and generated code with its own, where all sizes are constants. */
#ifndef TVI_SRC_GALERKIN_HAMILTONIAN_PASSES_H
#define TVI_SRC_GALERKIN_HAMILTONIAN_PASSES_H

#include "algebra/sizes.h"
#include "galerkin/blocks.h"
#include "galerkin/loops.h"

#include <math.h>

/* The rows of nodes->x: Q, P, n each, and what drives them at a start or in a prediction. */
typedef struct {
    const galerkin_loops *loops;
    const galerkin_nodes *nodes;
    galerkin_nodes drives; /* as unknowns, which begin at 0 */
    const double *matrix;  /* of a movement, */
    const int *of_drives;  /* and which row drives each unknown there */
    galerkin_blocks blocks;
    const int *slot[2]; /* [unknowns] what drives each, in the block of values, and with second derivatives */
    lanes_rounds rounds;
    double *changes; /* [unknowns][lanes] of impulses */
    double moved;    /* by the last pass, as `move` says; infinite before the first one of a step */
} hamiltonian_passes;

/* Squares of relative movements: after one of 2^-25 the second derivatives serve once more, since what the pass that
 * follows leaves is as its cube. */
#define HAMILTONIAN_SERVES  0x1p-50
#define HAMILTONIAN_NOTHING 0x1p-144
/* The rounds of the first pass of a step end here: another follows, whose movement is no less. */
#define HAMILTONIAN_ROUNDOFF 0x1p-108

static inline void hamiltonian_predict(hamiltonian_passes *w, const galerkin_extrapolation *by)
{
    double moved;
    const galerkin_nodes all = galerkin_all_moving(w->nodes);
    galerkin_predict_drives(w->loops, &w->drives, by);
    GALERKIN_LOOP(w->loops, move, &all, w->matrix, w->nodes->x, w->of_drives, &moved);
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

/* False outside the field's domain. */
static inline bool hamiltonian_pass(hamiltonian_passes *w, galerkin_sweep *sweep)
{
    const galerkin_nodes *nodes = w->nodes;
    const int numbers = nodes->unknowns * nodes->lanes;
    const bool is_first = isinf(w->moved), serves = w->moved <= HAMILTONIAN_SERVES * numbers;
    const int *slot = w->slot[!serves];
    const double least = numbers * (is_first ? HAMILTONIAN_ROUNDOFF : HAMILTONIAN_NOTHING);
    const double *drives = galerkin_sweep_at(&w->blocks, sweep, !serves, nodes->x, nodes->x + numbers / 2);
    if (!drives) return false;
    if (is_first) hamiltonian_set_sizes(w);
    GALERKIN_LOOP(w->loops, go_round, nodes, &w->rounds, drives, slot, !serves, w->moved, least, w->changes);
    w->moved = GALERKIN_LOOP(w->loops, move_both, nodes, w->matrix, drives, w->changes, slot);
    return true;
}

#endif
