/* in_generated.h - Defines how the parts of a Galerkin step call one another in generated code (emit.c), in place of
 * in_library.h. There is one number of lanes, all sizes are constants, and all functions are inlined. */
#ifndef TVI_SRC_GALERKIN_IN_GENERATED_H
#define TVI_SRC_GALERKIN_IN_GENERATED_H

/* Computes a b + c. The compiler fuses the two operations if it can. The header with vector intrinsics is not
 * included, since it would take longer to compile than all other code. */
#define FUSED(V, a, b, c) ((a) * (b) + (c))

#define KERNEL_FUNCTION      JET_INLINE
#define NODE_COUNT_OF(nodes) ((void)(nodes), GALERKIN_NODE_COUNT)

#define GALERKIN_KERNEL(kernels, name, ...) ((void)(kernels), NAME(name)(__VA_ARGS__))

#endif
