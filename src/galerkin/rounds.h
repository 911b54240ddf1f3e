/* rounds.h - Defines the single-precision vectors and the limits of the inner rounds of a pass that uses second
 * derivatives (kernel_rounds.h). */
#ifndef TVI_SRC_GALERKIN_ROUNDS_H
#define TVI_SRC_GALERKIN_ROUNDS_H

#include "galerkin/lanes.h"

enum { MOST_ROUNDS = 32 };
/* The rounds end when the square of the next movement is at most this times the square of the error of the
 * first-order expansion: a movement of twice the error. Half this bound was slower because of more rounds, twice
 * this bound because of more passes. */
#define ROUNDS_LEFT_OUT 4
/* Relative movements are stored in this unit, so that the squares of movements down to 2^-72 do not underflow in
 * single precision. */
#define ROUNDS_UNIT 0x1p-40

typedef float single_jet_v8 JET_VECTOR(float, 8);
typedef float single_jet_v4 JET_VECTOR(float, 4);
typedef float single_jet_v2 JET_VECTOR(float, 2);
typedef float single_jet_v1;

/* These macros convert vectors from double to single precision, and back. */
#define NARROW_jet_v8(x) JET_CONVERT(single_jet_v8, x)
#define NARROW_jet_v4(x) JET_CONVERT(single_jet_v4, x)
#define NARROW_jet_v2(x) JET_CONVERT(single_jet_v2, x)
#define NARROW_jet_v1(x) ((float)(x))
#define WIDEN_jet_v8(x)  JET_CONVERT(jet_v8, x)
#define WIDEN_jet_v4(x)  JET_CONVERT(jet_v4, x)
#define WIDEN_jet_v2(x)  JET_CONVERT(jet_v2, x)
#define WIDEN_jet_v1(x)  ((double)(x))

#endif
