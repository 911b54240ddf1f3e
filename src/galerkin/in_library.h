/* in_library.h - Defines the macros by which the files of a Galerkin step call its loops over nodes in the library: by
 * tables of functions, since the number of nodes and the instruction set are chosen at run time. In generated code
 * in_generated.h defines the same macros, by inlined calls. */
#ifndef TVI_SRC_GALERKIN_IN_LIBRARY_H
#define TVI_SRC_GALERKIN_IN_LIBRARY_H

#include "fused.h"

/* Computes a b + c. */
#define FUSED(V, a, b, c) JET_FUSED(V, a, b, c)

/* Kernels are functions of their own, so that the loops of each kernel can use all registers. */
#define KERNEL_FUNCTION      JET_APART
#define NODE_COUNT_OF(nodes) ((nodes)->node_count)

/* Calls a kernel of loops.h through its table. */
#define GALERKIN_KERNEL(kernels, name, ...) (kernels)->name(__VA_ARGS__)

#endif
