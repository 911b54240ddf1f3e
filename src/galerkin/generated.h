/* generated.h - Copies the data of a Galerkin step with all sizes replaced by constants, in generated code: the arrays
 * of unknowns at the nodes, and the inputs of the tail. The generated steps of all kinds of systems (generated_plain.h,
 * generated_lagrangian.h, generated_hamiltonian.h) use these copies, so that the compiler knows the lengths of all
 * loops. Only generated code includes this file, after kernel.h and steps.h. */
#ifndef TVI_SRC_GALERKIN_GENERATED_H
#define TVI_SRC_GALERKIN_GENERATED_H

#include "galerkin/steps.h"

JET_INLINE galerkin_nodes galerkin_copy_nodes_with_constant_sizes(const galerkin_nodes *nodes)
{
    galerkin_nodes sized = *nodes;
    sized.lane_count = GALERKIN_LANES;
    sized.node_count = GALERKIN_NODE_COUNT;
    sized.unknown_count = GALERKIN_UNKNOWNS;
    sized.coordinate_unknown_count = GALERKIN_N;
    sized.moving_unknown_count = GALERKIN_MOVING_UNKNOWNS;
    sized.subsystems.count = GALERKIN_SUBSYSTEMS;
    return sized;
}

JET_INLINE galerkin_tail_inputs galerkin_copy_tail_inputs_with_constant_sizes(const galerkin_tail_inputs *inputs)
{
    galerkin_tail_inputs sized = *inputs;
    sized.n = GALERKIN_N;
    sized.is_separable = GALERKIN_IS_SEPARABLE;
    sized.subsystems.count = GALERKIN_TAIL_SUBSYSTEMS;
    return sized;
}

/* Copies rows first_row .. end_row - 1 of a block. */
JET_INLINE void galerkin_copy_rows(double *destination, const double *source, int first_row, int end_row)
{
    for (int i = first_row * GALERKIN_LANES; i < end_row * GALERKIN_LANES; i++) destination[i] = source[i];
}

#endif
