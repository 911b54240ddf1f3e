/* model.h - Declares the gradient of a Lagrangian L or a Hamiltonian K at the nodes of a curve, and its Hessian (the
 * second derivatives) as a sparse matrix. Passes that use second derivatives solve the equations to first order about
 * the points where the gradient was evaluated (docs/method.md section 5). */
#ifndef TVI_SRC_GALERKIN_MODEL_H
#define TVI_SRC_GALERKIN_MODEL_H

#include "galerkin/blocks.h"
#include "galerkin/field.h"

/* The Hessian of L(q, v) or K(q, p) at all nodes, as a sparse matrix [2n][2n]: the blocks that contain the values of
 * its elements, and the list of the elements that are not always 0. */
typedef struct {
    galerkin_derivative_tapes derivative_tapes;
    /* [2 hessian_entry_count] The elements that are not always 0, row after row. */
    lanes_hessian_element *hessian_element;
    int *row_end; /* [2n] the index in hessian_element at which each row ends */
} galerkin_sparse_hessian;

void tvi_galerkin_allocate_sparse_hessian(galerkin_sparse_hessian *sparse_hessian, tvi_arena *arena,
                                          const galerkin_equations *equations);
/* Lists the elements of the Hessian that are not always 0, and sets
 * equations->impulse_to_predicted_unknown_or_rate_matrix. */
void tvi_galerkin_set_sparse_hessian_tables(galerkin_sparse_hessian *sparse_hessian,
                                            const galerkin_equations *equations);

/* Evaluates the tape of the gradient, or that of the second derivatives, in its block, and adds
 * tape_output_roundoff_to_add to its outputs. Returns false if an operand is outside its domain. */
galerkin_sweep tvi_galerkin_sweep_tape;

/* Inverts the matrix of each lane by elimination with row exchanges. `lu_factor` is a tvi_lu_factor. Returns false if a
 * matrix is singular or not finite. */
bool tvi_galerkin_invert_with_row_exchanges(const lanes_matrix_inverse *inverse, int lanes, void *lu_factor);

/* Writes the list of the elements that are not always 0 into generated code, as constants. */
void tvi_galerkin_emit_sparse_hessian(jet_text *text, const galerkin_sparse_hessian *sparse_hessian);

#endif
