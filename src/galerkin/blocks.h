/* blocks.h - Evaluates the gradient of a Lagrangian L(q, v) or a Hamiltonian K(q, p) at the nodes of a Galerkin curve,
 * with or without its second derivatives. The passes that use second derivatives call these functions (docs/method.md
 * section 5). The library and generated code include this file; in generated code all sizes are constants. */
#ifndef TVI_SRC_GALERKIN_BLOCKS_H
#define TVI_SRC_GALERKIN_BLOCKS_H

#include "galerkin/in_library.h"
#include "galerkin/loops.h"

#include <stdbool.h>
#include <string.h>

/* The tapes that compute a gradient, that of L(q, v) or that of K(q, p) (hamiltonian.c), and their memory. A tape works
 * on a block of numbers. A block begins with the input_count inputs of the tape, one row of lane_count numbers each: n
 * rows for q, n rows for v or p, then the time and the parameters. */
typedef struct {
    int coordinate_count, lane_count, input_count;
    /* The galerkin_equations whose tapes tvi_galerkin_sweep_tape evaluates. Generated code does not use them. */
    const void *galerkin_equations_for_sweep;
    /* gradient_block is the block of the tape that computes the gradient alone. hessian_block is the block of the tape
     * that also computes second derivatives; one row of zeros follows hessian_block. */
    double *gradient_block, *hessian_block;
} galerkin_derivative_tapes;

/* Evaluates the tape of gradient_block, or of hessian_block if with_hessian is set. Returns false if an operand is
 * outside its domain. */
typedef bool galerkin_sweep(const galerkin_derivative_tapes *tapes, bool with_hessian);

/* Evaluates the gradient at the points whose coordinates are in gradient_block, with or without second derivatives.
 * Returns the block that contains the result, or NULL if an operand is outside its domain. */
static inline const double *galerkin_evaluate_gradient(const galerkin_derivative_tapes *tapes, galerkin_sweep *sweep,
                                                       bool with_hessian)
{
    if (with_hessian)
        memcpy(tapes->hessian_block, tapes->gradient_block,
               (size_t)(tapes->input_count * tapes->lane_count) * sizeof(double));
    return !sweep(tapes, with_hessian) ? NULL : with_hessian ? tapes->hessian_block : tapes->gradient_block;
}

/* Evaluates the gradient at the nodes, with the coordinates q [n][lanes] and the velocities or momenta v_or_p
 * [n][lanes]. */
static inline const double *galerkin_evaluate_gradient_at_nodes(const galerkin_derivative_tapes *tapes,
                                                                galerkin_sweep *sweep, bool with_hessian,
                                                                const double *q, const double *v_or_p)
{
    const int half = tapes->coordinate_count * tapes->lane_count;
    memcpy(tapes->gradient_block, q, (size_t)half * sizeof *q);
    memcpy(tapes->gradient_block + half, v_or_p, (size_t)half * sizeof *v_or_p);
    return galerkin_evaluate_gradient(tapes, sweep, with_hessian);
}

#endif
