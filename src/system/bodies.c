/* bodies.c - Compiles the functions of tvi_bodies.h, which are inline functions in C, as exported functions of the
 * library. Languages that cannot compile a C header call them. */
#define TVI_INLINE extern
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif
#include "tvi_bodies.h"
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
