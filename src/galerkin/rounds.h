/* rounds.h - Defines the single-precision vectors and the limits of the inner rounds of a pass that uses second
 * derivatives (kernel_rounds.h). */
#ifndef TVI_SRC_GALERKIN_ROUNDS_H
#define TVI_SRC_GALERKIN_ROUNDS_H

#include "galerkin/lanes.h"

enum { MOST_ROUNDS = 32 };
/* Rounds end when the next movement is at most twice the error of the expansion to first order. Half of this bound
 * takes more time, and twice this bound takes more passes. It is a square, as movements are measured. */
#define ROUNDS_LEFT_OUT 4
/* Relative movements are measured in this unit, so that their squares, down to 2^-144, are single-precision numbers. */
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
