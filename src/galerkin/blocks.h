/* blocks.h - Evaluates the gradient of a Lagrangian L(q, v) or a Hamiltonian K(q, p) at the nodes of a Galerkin curve,
 * with or without its second derivatives. The passes that use second derivatives call these functions (docs/method.md
 * section 5). The library and generated code include this file; in generated code all sizes are constants. */
#ifndef TVI_SRC_GALERKIN_BLOCKS_H
#define TVI_SRC_GALERKIN_BLOCKS_H

#include "galerkin/in_library.h"
#include "galerkin/loops.h"

#include <stdbool.h>
#include <string.h>

/* The blocks of numbers of the tapes that compute a gradient: that of L(q, v), or that of K(q, p) (hamiltonian.c). A
 * block begins with the input_count inputs of the tape, one row of lane_count numbers each: n rows for q, n rows for v
 * or p, then the time and the parameters. */
typedef struct {
    int n, lane_count, input_count;
    const void *field_for_sweep; /* the galerkin_field whose tapes tvi_galerkin_sweep_tape evaluates */
    /* gradient_block is the block of the tape that computes the gradient alone. hessian_block is the block of the tape
     * that also computes second derivatives; one row of zeros follows hessian_block. */
    double *gradient_block, *hessian_block;
} galerkin_tape_blocks;

/* Evaluates the tape of gradient_block, or of hessian_block if with_hessian is set. Returns false if an operand is
 * outside its domain. */
typedef bool galerkin_sweep(const galerkin_tape_blocks *blocks, bool with_hessian);

/* Evaluates the gradient at the points whose coordinates are in gradient_block, with or without second derivatives.
 * Returns the block that contains the result, or NULL if an operand is outside its domain. */
static inline const double *galerkin_evaluate_gradient(const galerkin_tape_blocks *blocks, galerkin_sweep *sweep,
                                                       bool with_hessian)
{
    if (with_hessian)
        memcpy(blocks->hessian_block, blocks->gradient_block,
               (size_t)(blocks->input_count * blocks->lane_count) * sizeof(double));
    return !sweep(blocks, with_hessian) ? NULL : with_hessian ? blocks->hessian_block : blocks->gradient_block;
}

/* Evaluates the gradient at the nodes, with the coordinates q [n][lanes] and the velocities or momenta v_or_p
 * [n][lanes]. */
static inline const double *galerkin_evaluate_gradient_at_nodes(const galerkin_tape_blocks *blocks,
                                                                galerkin_sweep *sweep, bool with_hessian,
                                                                const double *q, const double *v_or_p)
{
    const int half = blocks->n * blocks->lane_count;
    memcpy(blocks->gradient_block, q, (size_t)half * sizeof *q);
    memcpy(blocks->gradient_block + half, v_or_p, (size_t)half * sizeof *v_or_p);
    return galerkin_evaluate_gradient(blocks, sweep, with_hessian);
}

#endif
