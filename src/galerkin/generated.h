/* generated.h - Defines what all generated steps of the Galerkin curve share (emit.c): sizes as constants. Only
 * generated code includes it, after the texts of kernel.h and steps.h. */
#ifndef TVI_SRC_GALERKIN_GENERATED_H
#define TVI_SRC_GALERKIN_GENERATED_H

#include "galerkin/steps.h"

/* Blocks of up to this many numbers are local to the step: compilers then know that nothing else changes them. */
enum { GALERKIN_MOST_OWN = 4096 };

JET_INLINE galerkin_nodes galerkin_sized(const galerkin_nodes *nodes)
{
    galerkin_nodes sized = *nodes;
    sized.lanes = GALERKIN_LANES;
    sized.points = GALERKIN_POINTS;
    sized.width = 1;
    sized.unknowns = GALERKIN_UNKNOWNS;
    sized.half = GALERKIN_N;
    sized.moving = GALERKIN_MOVING;
    sized.parts.count = GALERKIN_PARTS;
    return sized;
}

JET_INLINE galerkin_tail_inputs galerkin_sized_tail_inputs(const galerkin_tail_inputs *tail_inputs)
{
    galerkin_tail_inputs sized = *tail_inputs;
    sized.n = GALERKIN_N;
    sized.is_separable = GALERKIN_IS_SEPARABLE;
    sized.parts.count = GALERKIN_PARTS;
    return sized;
}

/* Copies the rows of a block from the first ones, which are set anew, up to `kept`. */
JET_INLINE void galerkin_keep_rows(double *own, const double *block, int first, int kept)
{
    for (int i = first * GALERKIN_LANES; i < kept * GALERKIN_LANES; i++) own[i] = block[i];
}

#endif
