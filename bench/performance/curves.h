/* curves.h - a curve of the library about the middle of a step, and the gradient of the discrete action along it: the
 * parts of a step of type I at the midpoint. */
#ifndef CURVES_H
#define CURVES_H

#include "generating/action.h"
#include "generating/closure.h"
#include "generating/curve.h"

typedef struct {
    void *memory;
    tvi_curve curve;
    tvi_action action;
    double *seed_Q, *seed_U, *D; /* [top + 1][n], and the gradient [2n] */
    double tau, *z;              /* z [2n] */
} open_curve;

/* Of degree N, from (q, p) as the middle of a step h; Jacobians as products. What fails ends the program. */
open_curve *curve_open(const tvi_system *system, int N, const double q[], const double p[], double h);
void curve_close(open_curve *c);

/* Each is a turn of turns.h; its context is an open_curve. */
void curve_expand(void *opened);   /* one plain expansion */
void curve_gradient(void *opened); /* the force at the nodes, the seeds, and one adjoint sweep */
void curve_pull(void *opened);     /* the adjoint sweep alone */

#endif
