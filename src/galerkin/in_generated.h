/* in_generated.h - says how the texts of a Galerkin step call one another in generated code (emit.c), which has this
 * file in the place of in_library.h. There is one number of lanes, sizes are constants, and what is called is
 * inlined. */
#ifndef TVI_SRC_GALERKIN_IN_GENERATED_H
#define TVI_SRC_GALERKIN_IN_GENERATED_H

/* Computes a b + c. The compiler fuses the two operations if it can; the header with vector intrinsics would take
 * longer to compile than all the rest. */
#define FUSED(V, a, b, c) ((a) * (b) + (c))

#define OWN              JET_INLINE
#define POINTS_OF(nodes) ((void)(nodes), GALERKIN_POINTS)

#define GALERKIN_KERNEL(kernels, name, ...) ((void)(kernels), NAME(name)(__VA_ARGS__))

#endif
