/* bodies.c - has the functions of tvi_bodies.h for languages that cannot compile a header: the same text, exported. */
#define TVI_INLINE extern
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif
#include "tvi_bodies.h"
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
