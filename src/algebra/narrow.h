/* narrow.h - Finds a sign change of a function in a bracket. The search for events (events/finish.c)
 * and the computation of states at given times (integrator/inside_step.c) call it. */
#ifndef TVI_SRC_ALGEBRA_NARROW_H
#define TVI_SRC_ALGEBRA_NARROW_H

#include "tvi.h"

/* Computes the value *g of a function of one variable at x. */
typedef tvi_status tvi_bracketed_function(void *ctx, double x, double *g);
/* An interval [left, right], and the values of a function at its ends. The two values have different signs, or one of
 * them is 0. */
typedef struct {
    double left, g_left, right, g_right;
} tvi_sign_bracket;

/* Narrows the bracket until its width is least_width, or its ends are neighbouring numbers, or the function is 0 at
 * one end. The method is ITP: interpolate, truncate, project (Oliveira and Takahashi, "An enhancement of the
 * bisection method average performance preserving minmax optimality", 2020). It is as fast as the secant method, and
 * needs at most one evaluation more than bisection. */
TVI_NODISCARD tvi_status tvi_narrow_bracket(tvi_sign_bracket *bracket, double least_width,
                                            tvi_bracketed_function *function, void *ctx);

#endif
