/* curves.h - Declares a curve of the library about the middle of a step, a part of a step of type I at the midpoint. */
#ifndef CURVES_H
#define CURVES_H

#include "generating/curve.h"

typedef struct {
    void *memory;
    tvi_curve curve;
    double tau, *z; /* z [2n] */
} open_curve;

/* Opens a curve of degree N, from (q, p) as the middle of a step h; Jacobians as products. A failure ends the program.
 */
open_curve *curve_open(const tvi_system *system, int N, const double q[], const double p[], double h);
void curve_close(open_curve *c);

/* Makes one plain expansion. It is a turn of turns.h, whose context is an open_curve. */
void curve_expand(void *opened);

#endif
