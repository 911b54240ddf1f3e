/* narrow.h - Finds a sign change of a function in a bracket. The search for events and the states at given times call
 * it. */
#ifndef TVI_SRC_RUN_NARROW_H
#define TVI_SRC_RUN_NARROW_H

#include "tvi.h"

/* A function of one variable. In a bracket its signs at a and b differ, or one of the values is 0. */
typedef tvi_status tvi_signed_fn(void *ctx, double at, double *g);
typedef struct {
    double a, ga, b, gb;
} tvi_bracket;

/* Narrows the bracket to the width `least`, or to neighbouring numbers, or until a value is 0, at a or b. It
 * interpolates, truncates and projects (Oliveira and Takahashi, "An enhancement of the bisection method average
 * performance preserving minmax optimality", 2020): it is as fast as the secant method, and needs at most one
 * evaluation more than bisection. */
TVI_NODISCARD tvi_status tvi_narrow(tvi_bracket *bracket, double least, tvi_signed_fn *g, void *ctx);

#endif
