/* field.h - Evaluates the field of a system at the nodes of a Galerkin step: the tape of its values, or that which also
 * has second derivatives. Both passes with second derivatives (lagrangian_pass.h, hamiltonian_pass.h) share it. */
#ifndef TVI_SRC_GALERKIN_FIELD_H
#define TVI_SRC_GALERKIN_FIELD_H

#include "galerkin/nodes.h"
#include "tape.h"

struct tvi_roundoff_estimator;

/* The tapes of a field at all nodes, and their blocks. A block begins with the inputs of the tape, a row of lane_count
 * numbers each: n rows of q, in equations of first order n rows of v or p, then the time and the parameters. Index
 * false is for the values alone, in a separable system the forces and otherwise the gradient of L or K; index true is
 * for the tape that has the second derivatives, too, whose block ends with a row of zeros. */
typedef struct {
    int n, lane_count, input_count;
    const jet_tape *tape[2];
    double *block[2];
    const int *slot[2]; /* [unknowns] the rows of a block with the rates, in a Lagrangian's with L_q and L_v */
    /* What is added to the outputs while the roundoff of a pass is measured (probe.c); NULL otherwise. */
    struct tvi_roundoff_estimator *added_roundoff;
} galerkin_field;

#ifdef GALERKIN_LANES
/* Generated code has the tapes as functions: emit.c defines the macros, ad/emitted.h VALUES_OF. */
JET_INLINE bool galerkin_sweep(const galerkin_field *field, bool with_hessian)
{
    return with_hessian ? GALERKIN_HESSIAN_VALUES(field->block[true]) : GALERKIN_VALUES(field->block[false]);
}

/* Evaluates the tape for one vector of nodes after the other, if its operations are functions of their own
 * (GALERKIN_IS_SPLIT): all numbers stay in registers, and the impulses alone are stored. Returns false if an operand
 * is outside its domain. */
JET_INLINE bool galerkin_impulses_by_registers(const galerkin_nodes *nodes)
{
    bool is_inside = true;
    for (int v = 0; v < (GALERKIN_IS_SPLIT ? GALERKIN_LANES / NODE_VEC : 0); v++) {
        _Alignas(64) double block[GALERKIN_VALUE_SLOTS * NODE_VEC];
        JET_UNROLL(256)
        for (int i = 0; i < GALERKIN_READ_ONLY_ROWS; i++)
            node_store(block, i, node_load(nodes->x + i * GALERKIN_LANES, v));
        is_inside &= VALUES_OF(tvi_values, block, NODE_VEC);
        JET_UNROLL(256)
        for (int u = 0; u < GALERKIN_UNKNOWNS; u++)
            node_store(nodes->impulse + u * GALERKIN_LANES, v,
                       node_load(nodes->hb, v) * node_load(block, galerkin_rate_row[u]));
    }
    return is_inside;
}
#else
/* Adds numbers of the size of field->added_roundoff, with random signs, to the outputs in the block (probe.c). */
void tvi_galerkin_add_roundoff(const galerkin_field *field, bool with_hessian);

/* Evaluates a tape in its block. Returns false if an operand is outside its domain. */
JET_INLINE bool galerkin_sweep(const galerkin_field *field, bool with_hessian)
{
    if (!jet_sweep_values(field->tape[with_hessian], field->block[with_hessian], field->lane_count)) return false;
    if (field->added_roundoff) tvi_galerkin_add_roundoff(field, with_hessian);
    return true;
}
#endif

/* Evaluates the gradient, with or without second derivatives, at the points of block[false]. Returns the block with the
 * result, or NULL if an operand is outside its domain. */
static inline const double *galerkin_evaluate_gradient(const galerkin_field *field, bool with_hessian)
{
    if (with_hessian)
        memcpy(field->block[true], field->block[false],
               (size_t)(field->input_count * field->lane_count) * sizeof(double));
    return galerkin_sweep(field, with_hessian) ? field->block[with_hessian] : NULL;
}

/* Evaluates the gradient at q and v or p, [n][lanes] each. */
static inline const double *galerkin_evaluate_gradient_at(const galerkin_field *field, bool with_hessian,
                                                          const double *q, const double *v_or_p)
{
    const int half = field->n * field->lane_count;
    memcpy(field->block[false], q, (size_t)half * sizeof *q);
    memcpy(field->block[false] + half, v_or_p, (size_t)half * sizeof *v_or_p);
    return galerkin_evaluate_gradient(field, with_hessian);
}

#endif
