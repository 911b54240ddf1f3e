/* hamiltonian_passes.h - Makes the passes of a Hamiltonian's Galerkin curve that use second derivatives
 * (hamiltonian.c). The library calls kernels through tables; in generated code kernels are inlined, and all sizes
 * are constants. */
#ifndef TVI_SRC_GALERKIN_HAMILTONIAN_PASSES_H
#define TVI_SRC_GALERKIN_HAMILTONIAN_PASSES_H

#include "algebra/sizes.h"
#include "galerkin/blocks.h"
#include "galerkin/loops.h"

#include <math.h>

/* The data of the passes. The rows of nodes->values are Q and P, n each; during a prediction 2n rows of their rates
 * follow. */
typedef struct {
    const galerkin_kernels *kernels;
    const galerkin_nodes *nodes;
    /* the rates V and F as unknowns of the predictor, whose values at the start are 0 */
    galerkin_nodes rate_nodes;
    /* [j][i] the factors of impulses in unknowns (coefficients.h) */
    const double *impulse_matrix;
    /* [unknowns] The row of nodes->values that contains each unknown's rate. */
    const int *rate_row;
    galerkin_tape_blocks tape_blocks;
    /* [unknowns] The slot of each unknown's rate, in values_block for index false and in hessian_block for index
     * true. */
    const int *rate_slot[2];
    lanes_inner_rounds rounds;
    /* [unknowns][lanes] The changes of the impulses that the inner rounds make. */
    double *impulse_changes;
    /* The movement of the last pass, as the kernel `move` measures it, or infinity before the first pass of a step. */
    double last_movement;
} hamiltonian_passes;

/* In the first pass of a step the inner rounds end when the square of a relative movement is below this, since a
 * second pass follows in any case. */
#define HAMILTONIAN_ROUNDOFF 0x1p-108

/* Predicts the unknowns, as galerkin_pass_functions.predict. `work` is a hamiltonian_passes. */
static inline void hamiltonian_predict_unknowns(void *work, const galerkin_nodes *nodes,
                                                const galerkin_extrapolation *extrapolation)
{
    hamiltonian_passes *passes = work;
    (void)nodes;
    double moved;
    const galerkin_nodes all = galerkin_nodes_with_all_moving(passes->nodes);
    galerkin_predict_rates(passes->kernels, &passes->rate_nodes, extrapolation);
    GALERKIN_KERNEL(passes->kernels, move, &all, passes->impulse_matrix, passes->nodes->values, passes->rate_row,
                    &moved);
    passes->last_movement = INFINITY;
}

static inline void hamiltonian_set_unknown_sizes(const hamiltonian_passes *passes)
{
    const lanes_inner_rounds *rounds = &passes->rounds;
    for (int i = 0; i < rounds->row_count; i++) {
        rounds->inverse_unknown_size[i] = passes->nodes->inverse_unknown_size[rounds->unknown_of_row[i]];
        rounds->unknown_size[i] = 1 / rounds->inverse_unknown_size[i];
    }
}

/* Makes a pass. Returns false if an unknown is outside the field's domain. */
static inline bool hamiltonian_make_pass(hamiltonian_passes *passes, galerkin_sweep *sweep)
{
    const galerkin_nodes *nodes = passes->nodes;
    const int numbers = nodes->unknowns * nodes->lanes;
    const bool is_first = isinf(passes->last_movement),
               serves = passes->last_movement <= HAMILTONIAN_HESSIAN_MAX_MOVEMENT * numbers;
    const int *slot = passes->rate_slot[!serves];
    const double least = numbers * (is_first ? HAMILTONIAN_ROUNDOFF : GALERKIN_HESSIAN_GOAL * GALERKIN_HESSIAN_GOAL);
    const double *rates = galerkin_evaluate_gradient_at_nodes(&passes->tape_blocks, sweep, !serves, nodes->values,
                                                              nodes->values + numbers / 2);
    if (!rates) return false;
    if (is_first) hamiltonian_set_unknown_sizes(passes);
    GALERKIN_KERNEL(passes->kernels, run_rounds, nodes, &passes->rounds, rates, slot, !serves, passes->last_movement,
                    least, passes->impulse_changes);
    passes->last_movement = GALERKIN_KERNEL(passes->kernels, move_with_changes, nodes, passes->impulse_matrix, rates,
                                            passes->impulse_changes, slot);
    return true;
}

#endif
