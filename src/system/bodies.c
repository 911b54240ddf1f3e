/* bodies.c - Exports the functions of tvi_bodies.h for languages that cannot compile a header. In C they are inline;
 * here the same text is compiled as exported functions. */
#define TVI_INLINE extern
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif
#include "tvi_bodies.h"
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
