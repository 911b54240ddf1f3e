/* narrow.h - where a function changes its sign. */
#ifndef TVI_SRC_RUN_NARROW_H
#define TVI_SRC_RUN_NARROW_H

#include "tvi.h"

/* A function of a place, whose signs at a and b are different, or one of them is 0. */
typedef tvi_status tvi_signed_fn(void *ctx, double at, double *g);
typedef struct {
    double a, ga, b, gb;
} tvi_bracket;

/* Narrows the bracket to so little, or to neighbours, or to the first 0: it is then at a or b. By interpolation,
 * truncation and projection (Oliveira and Takahashi, "An enhancement of the bisection method average performance
 * preserving minmax optimality", 2020): as fast as the secant, never slower than bisection by more than one
 * evaluation. */
TVI_NODISCARD tvi_status tvi_narrow(tvi_bracket *bracket, double least, tvi_signed_fn *g, void *ctx);

#endif
