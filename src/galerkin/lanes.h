/* lanes.h - loops over the lanes of a block whose number is one of a few and known to the compiler; for files that are
 * compiled once for each instruction set (ad/vector.h). */
#ifndef TVI_SRC_GALERKIN_LANES_H
#define TVI_SRC_GALERKIN_LANES_H

#include "galerkin/loops.h"
#include "vector.h"

#define FOR_LANES(lanes, call)                                                                                         \
    switch (lanes) {                                                                                                   \
    case 1: call(1); break;                                                                                            \
    case 2: call(2); break;                                                                                            \
    case 4: call(4); break;                                                                                            \
    case 8: call(8); break;                                                                                            \
    default: call(TVI_GALERKIN_MAX_LANES);                                                                             \
    }

#endif
