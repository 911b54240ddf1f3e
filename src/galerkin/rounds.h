/* rounds.h - Declares the rounds of a pass that knows second derivatives (kernel_rounds.h): their numbers, which are in
 * single precision, and when they end. */
#ifndef TVI_SRC_GALERKIN_ROUNDS_H
#define TVI_SRC_GALERKIN_ROUNDS_H

#include "galerkin/lanes.h"

enum { MOST_ROUNDS = 32 };
/* Rounds end when the next movement is as small as twice the error of the first order; a square, as sizes are. Half
 * of that takes more time, and twice as much more passes. */
#define ROUNDS_LEFT_OUT 4
/* The unit of relative movements, whose squares, from 2^-144 on, are single numbers in it. */
#define ROUNDS_UNIT 0x1p-40

typedef float single_jet_v8 JET_VECTOR(float, 8);
typedef float single_jet_v4 JET_VECTOR(float, 4);
typedef float single_jet_v2 JET_VECTOR(float, 2);
typedef float single_jet_v1;

/* Convert from one precision to the other. */
#define NARROW_jet_v8(x) JET_CONVERT(single_jet_v8, x)
#define NARROW_jet_v4(x) JET_CONVERT(single_jet_v4, x)
#define NARROW_jet_v2(x) JET_CONVERT(single_jet_v2, x)
#define NARROW_jet_v1(x) ((float)(x))
#define WIDEN_jet_v8(x)  JET_CONVERT(jet_v8, x)
#define WIDEN_jet_v4(x)  JET_CONVERT(jet_v4, x)
#define WIDEN_jet_v2(x)  JET_CONVERT(jet_v2, x)
#define WIDEN_jet_v1(x)  ((double)(x))

#endif
