/* generated.h - Makes Galerkin steps in generated code: steps.h with the sizes, lists and rule of one system as
 * constants (emit_steps.c), so that the compiler knows the lengths of all loops. With second derivatives, arrays are
 * on the stack if they are short (IS_LOCAL); passes by the forces alone take nothing from here but the constants. Only
 * generated code contains this file. */
#ifndef TVI_SRC_GALERKIN_GENERATED_H
#define TVI_SRC_GALERKIN_GENERATED_H

#include "galerkin/steps.h"

/* [numbers] Blocks of up to this size are local variables of a generated step, so that compilers know that nothing else
 * changes them (make performance ONE=compiled). */
#define GALERKIN_MAX_LOCAL 4096 /* found: make performance ONE=compiled */

/* Whether passes use second derivatives, and whether the blocks of the tapes and the arrays of passes are on the stack:
 * those of nodes.x, of the values, of the second derivatives (rows of lanes), and the packed K''. */
enum {
    IS_LAGRANGIAN = GALERKIN_FORM == GALERKIN_LAGRANGIAN,
    IS_HAMILTONIAN = GALERKIN_FORM == GALERKIN_HAMILTONIAN,
    IS_LOCAL = GALERKIN_FORM != GALERKIN_PLAIN &&
               (GALERKIN_VALUE_SLOTS + GALERKIN_HESSIAN_SLOTS) * GALERKIN_LANES <= GALERKIN_MAX_LOCAL,
    PACKED = GALERKIN_HESSIAN_ROWS * GALERKIN_HESSIAN_COLUMNS * SINGLE_LANES(GALERKIN_LANES),
    IS_PACKED = IS_HAMILTONIAN && PACKED <= 2 * GALERKIN_MAX_LOCAL,
    NODE_ROWS = IS_LOCAL ? (IS_LAGRANGIAN ? 5 : 4) * GALERKIN_N : 0,
    N_ROWS = IS_LOCAL && IS_LAGRANGIAN ? GALERKIN_N : 0,
    SINGLE_ROWS = IS_PACKED ? GALERKIN_HESSIAN_ROWS : 0
};

/* Arrays on the stack. An array that is not used has one element. */
typedef struct {
    _Alignas(64) double values[IS_LOCAL ? GALERKIN_VALUE_SLOTS * GALERKIN_LANES : 1];
    _Alignas(64) double hessian[IS_LOCAL ? (GALERKIN_HESSIAN_SLOTS + 1) * GALERKIN_LANES : 1];
    _Alignas(64) double x[NODE_ROWS * GALERKIN_LANES + 1];
} generated_blocks;
typedef struct {
    _Alignas(64) double q_moved[N_ROWS * GALERKIN_LANES + 1], start_minus_q[2 * N_ROWS * GALERKIN_LANES + 1];
    _Alignas(64) double gradient[2 * N_ROWS * GALERKIN_LANES + 1], displacement[2 * N_ROWS * GALERKIN_LANES + 1];
    _Alignas(64) double matrix[N_ROWS * N_ROWS * GALERKIN_LANES + 1], inverse[N_ROWS * N_ROWS * GALERKIN_LANES + 1];
    _Alignas(64) double column[N_ROWS * GALERKIN_LANES + 1];
} generated_lagrangian;
typedef struct {
    _Alignas(64) float packed[(IS_PACKED ? PACKED : 0) + 1];
    _Alignas(64) float dx[SINGLE_ROWS * SINGLE_LANES(GALERKIN_LANES) + 1];
    _Alignas(64) float dx_sum[SINGLE_ROWS * SINGLE_LANES(GALERKIN_LANES) + 1];
    _Alignas(64) float dL[SINGLE_ROWS * SINGLE_LANES(GALERKIN_LANES) + 1];
    _Alignas(64) float dL_sum[SINGLE_ROWS * SINGLE_LANES(GALERKIN_LANES) + 1];
    double size[SINGLE_ROWS + 1], inverse_size[SINGLE_ROWS + 1];
} generated_hamiltonian;

JET_INLINE void generated_set_counts(galerkin_nodes *nodes)
{
    nodes->lane_count = GALERKIN_LANES;
    nodes->node_count = GALERKIN_NODE_COUNT;
    nodes->unknown_count = GALERKIN_UNKNOWNS;
    nodes->n = GALERKIN_N;
    nodes->moving_count = GALERKIN_MOVING;
    nodes->subsystems.count = GALERKIN_SUBSYSTEMS;
}

JET_INLINE void generated_copy_rows(double *to, const double *from, int first, int end)
{
    for (int i = first * GALERKIN_LANES; i < end * GALERKIN_LANES; i++) to[i] = from[i];
}

/* Makes the blocks local arrays (if IS_LOCAL): lets the step point to those in `own`, and copies the rows that a tape
 * reads and does not set. If the caller has predicted the unknowns, copies their rows, too. */
JET_INLINE void generated_use_own_blocks(galerkin_step *step, generated_blocks *own, bool is_predicted)
{
    galerkin_field_at_nodes *field = &step->field;
    if (!IS_LOCAL) return;
    generated_copy_rows(own->values, field->block[false], 2 * GALERKIN_N, GALERKIN_READ_ONLY_ROWS);
    generated_copy_rows(own->hessian, field->block[true], GALERKIN_INPUTS, GALERKIN_HESSIAN_READ_ONLY_ROWS);
    generated_copy_rows(own->hessian, field->block[true], GALERKIN_HESSIAN_SLOTS, GALERKIN_HESSIAN_SLOTS + 1);
    if (is_predicted) generated_copy_rows(own->x, step->nodes.x, 0, (IS_LAGRANGIAN ? 3 : 2) * GALERKIN_N);
    field->block[false] = own->values;
    field->block[true] = own->hessian;
    step->nodes.x = own->x;
}

/* Sets the lists of a Lagrangian's pass to constants, and makes its arrays local (if IS_LOCAL). */
JET_INLINE void generated_use_own_lagrangian(lagrangian_pass *pass, generated_lagrangian *own, bool is_predicted)
{
    pass->L_vv.n = GALERKIN_N;
    pass->row_end = galerkin_row_end;
    pass->column = galerkin_element_column;
    pass->slot = galerkin_element_slot;
    if (!IS_LOCAL) return;
    if (is_predicted) generated_copy_rows(own->q_moved, pass->q_moved, 0, GALERKIN_N);
    pass->q_moved = own->q_moved;
    pass->start_minus_q[0] = own->start_minus_q;
    pass->start_minus_q[1] = own->start_minus_q + N_ROWS * GALERKIN_LANES;
    pass->gradient = own->gradient;
    pass->displacement = own->displacement;
    pass->L_vv.matrix = own->matrix;
    pass->L_vv.inverse = own->inverse;
    pass->L_vv.scratch_column = own->column;
}

/* Sets the sizes and lists of a Hamiltonian's pass to constants, and makes its arrays local (if IS_PACKED). */
JET_INLINE void generated_use_own_hamiltonian(hamiltonian_pass *pass, generated_hamiltonian *own)
{
    pass->columns = GALERKIN_HESSIAN_COLUMNS;
    pass->rows = GALERKIN_HESSIAN_ROWS;
    pass->unknown_of_row = galerkin_unknown_of_row;
    pass->index_in_block = galerkin_index_in_block;
    if (!IS_PACKED) return;
    /* The lanes of single precision after those of double precision are 0. */
    if (SINGLE_LANES(GALERKIN_LANES) > GALERKIN_LANES) memset(own, 0, sizeof *own);
    pass->packed = own->packed;
    pass->dx = own->dx;
    pass->dx_sum = own->dx_sum;
    pass->dL = own->dL;
    pass->dL_sum = own->dL_sum;
    pass->size = own->size;
    pass->inverse_size = own->inverse_size;
}

/* Makes steps as galerkin_make_steps does, with a copy of the general step in which sizes and lists are constants. It
 * is generated_steps->make_steps of make_steps in galerkin.c. */
static void galerkin_make_generated_steps(const galerkin_step *general, const tvi_run_request *run,
                                          const tvi_step_origin *origin, const tvi_run_state *state,
                                          galerkin_outcome *outcome)
{
    const bool is_predicted = outcome->equal_step_count == 0;
    galerkin_step step = *general;
    generated_blocks blocks;
    generated_lagrangian own_lagrangian;
    generated_hamiltonian own_hamiltonian;
    lagrangian_pass lagrangian;
    hamiltonian_pass hamiltonian;
    step.form = GALERKIN_FORM;
    step.is_separable = step.tail.is_separable = GALERKIN_IS_SEPARABLE;
    step.rule = (tvi_stopping_rule)GALERKIN_RULE;
    step.rate_row = galerkin_rate_row;
    generated_set_counts(&step.nodes);
    step.tail.n = step.field.n = GALERKIN_N;
    step.tail.subsystems.count = GALERKIN_TAIL_SUBSYSTEMS;
    step.field.lane_count = GALERKIN_LANES;
    step.field.input_count = GALERKIN_INPUTS;
    step.field.slot[false] = galerkin_slot;
    step.field.slot[true] = galerkin_hessian_slot;
    generated_use_own_blocks(&step, &blocks, is_predicted);
    if (IS_LAGRANGIAN) {
        lagrangian = *general->lagrangian;
        generated_use_own_lagrangian(&lagrangian, &own_lagrangian, is_predicted);
        generated_set_counts(&lagrangian.rates);
        lagrangian.rates.x = step.nodes.x + 2 * GALERKIN_N * GALERKIN_LANES;
        step.lagrangian = &lagrangian;
    }
    if (IS_HAMILTONIAN) {
        hamiltonian = *general->hamiltonian;
        generated_use_own_hamiltonian(&hamiltonian, &own_hamiltonian);
        generated_set_counts(&hamiltonian.rates);
        hamiltonian.rates.x = step.nodes.x + GALERKIN_UNKNOWNS * GALERKIN_LANES;
        step.hamiltonian = &hamiltonian;
    }
    galerkin_make_steps(&step, run, origin, state, outcome);
}

#endif
