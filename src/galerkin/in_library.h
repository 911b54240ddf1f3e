/* in_library.h - says how the texts of a Galerkin step call one another where the library compiles them for any system.
 * Generated code has in_generated.h in the place of this file. */
#ifndef TVI_SRC_GALERKIN_IN_LIBRARY_H
#define TVI_SRC_GALERKIN_IN_LIBRARY_H

#include "fused.h"

/* a b + c: of members, and of nodes, rounded alike. */
#define FUSED(V, a, b, c) JET_FUSED(V, a, b, c)

/* Each number of lanes has functions of its own, which spares the compiler the registers of the others. */
#define OWN              JET_APART
#define POINTS_OF(nodes) ((nodes)->points)

/* A loop of loops.h. */
#define GALERKIN_LOOP(loops, name, ...) (loops)->name(__VA_ARGS__)

#endif
