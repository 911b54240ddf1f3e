/* model.h - Declares the tape blocks and tables of passes that use second derivatives: the gradient of L or of K and
 * its derivatives at the nodes. These passes solve the equations to first order about the points where the gradient
 * was evaluated (docs/method.md section 5). */
#ifndef TVI_SRC_GALERKIN_MODEL_H
#define TVI_SRC_GALERKIN_MODEL_H

#include "galerkin/blocks.h"
#include "galerkin/field.h"

typedef struct {
    galerkin_tape_blocks blocks;
    /* [2 hessian_entry_count] The elements of the Hessian, row after row. */
    lanes_hessian_element *hessian_element;
    int *row_end; /* [2n] the index in hessian_element at which each row ends */
} galerkin_hessian_tables;

void tvi_galerkin_allocate_hessian_tables(galerkin_hessian_tables *tables, tvi_arena *arena,
                                          const galerkin_field *field);
/* Fills the tables of second derivatives, and field->impulse_to_predicted_matrix. */
void tvi_galerkin_prepare_hessian_tables(galerkin_hessian_tables *tables, const galerkin_field *field);

/* Evaluates a tape of the field in its block, and adds the field's output_displacements. */
galerkin_sweep tvi_galerkin_sweep_tape;

/* Inverts the matrix of each lane by elimination with row exchanges. `lu_factor` is a tvi_lu_factor. Returns false if a
 * matrix is singular or not finite. */
bool tvi_galerkin_invert_with_row_exchanges(const lanes_matrix_inverse *inverse, int lanes, void *lu_factor);

/* Writes the tables of second derivatives into generated code, as constants. */
void tvi_galerkin_emit_hessian_tables(jet_text *text, const galerkin_hessian_tables *tables);

#endif
