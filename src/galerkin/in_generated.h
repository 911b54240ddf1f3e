/* in_generated.h - Defines the macros by which the files of a Galerkin step call its loops over nodes in generated code
 * (emit.c): the loops are compiled for one number of nodes and are inlined. In the library in_library.h defines the
 * same macros, by calls through tables of functions. */
#ifndef TVI_SRC_GALERKIN_IN_GENERATED_H
#define TVI_SRC_GALERKIN_IN_GENERATED_H

/* Computes a b + c. The compiler fuses the two operations if it can. The header with vector intrinsics is not
 * included, since it would take longer to compile than all other code. */
#define FUSED(V, a, b, c) ((a) * (b) + (c))

#define KERNEL_FUNCTION      JET_INLINE
#define NODE_COUNT_OF(nodes) ((void)(nodes), GALERKIN_NODE_COUNT)

#define GALERKIN_KERNEL(kernels, name, ...) ((void)(kernels), NAME(name)(__VA_ARGS__))

#endif
