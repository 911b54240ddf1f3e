/* nearest.h - Declares the control of the coefficients of constraints: integrators made by this thread whose Lobatto
 * nodes and sigma are the nearest doubles, not numbers of a grid for which the symplectic condition holds exactly. The
 * program has the library's tables with this rounding (longrun.mk). */
#ifndef NEAREST_H
#define NEAREST_H

#include "galerkin/tables.h"

extern _Thread_local bool coefficients_are_nearest;

static inline double round_to_nearest(long double x, int bits)
{
    return coefficients_are_nearest ? (double)x : tvi_galerkin_round_to_grid(x, bits);
}
#define tvi_galerkin_round_to_grid round_to_nearest

#endif
