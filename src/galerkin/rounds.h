/* rounds.h - the rounds of a pass that knows second derivatives (kernel_rounds.h): their numbers, which are in single
 * precision, and when they end. */
#ifndef TVI_SRC_GALERKIN_ROUNDS_H
#define TVI_SRC_GALERKIN_ROUNDS_H

#include "galerkin/lanes.h"

enum { MOST_ROUNDS = 32 };
/* They end where the next movement is as small as twice what the first order leaves out; a square, as sizes are. Half
 * of that takes more time, and twice as much more passes. */
#define ROUNDS_LEFT_OUT 4
/* The unit of relative movements, whose squares, from 2^-144 on, are single numbers in it. */
#define ROUNDS_UNIT 0x1p-40

/* What stood on the diagonal is no smaller a part of the pivot of a plain matrix than this (kernel_matrices.h). */
#define LANES_LEAST_PLAIN (1.0 / 16)

typedef float single_jet_v8 __attribute__((vector_size(32), aligned(4), may_alias));
typedef float single_jet_v4 __attribute__((vector_size(16), aligned(4), may_alias));
typedef float single_jet_v2 __attribute__((vector_size(8), aligned(4), may_alias));
typedef float single_jet_v1;

/* From the one precision to the other. */
#define NARROW_jet_v8(x) __builtin_convertvector(x, single_jet_v8)
#define NARROW_jet_v4(x) __builtin_convertvector(x, single_jet_v4)
#define NARROW_jet_v2(x) __builtin_convertvector(x, single_jet_v2)
#define NARROW_jet_v1(x) ((float)(x))
#define WIDEN_jet_v8(x)  __builtin_convertvector(x, jet_v8)
#define WIDEN_jet_v4(x)  __builtin_convertvector(x, jet_v4)
#define WIDEN_jet_v2(x)  __builtin_convertvector(x, jet_v2)
#define WIDEN_jet_v1(x)  ((double)(x))

#endif
