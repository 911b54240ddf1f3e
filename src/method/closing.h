/* closing.h - Declares the ends of a curve, and how a generating function closes its equations. It is part of the text
 * of generated code. */
#ifndef TVI_SRC_METHOD_CLOSING_H
#define TVI_SRC_METHOD_CLOSING_H

#include "tvi.h"

/* The ends of the step in the scaled time of a curve, and tau as a multiple of h. */
typedef struct {
    double from, to, tau;
} tvi_span;

/* Solves a generating function's equations for the corrections of the curve's ends (generating/closure.h). */
struct tvi_closure;
typedef tvi_status tvi_close_fn(struct tvi_closure *closure);

/* The corrections of both ends as parts of the solution (x, y) of [J1; J2]^T (x, y) = D_z (generating/closure.h). J1 is
 * the Jacobian matrix of the mean of the ends' coordinates. The coordinates are corrected by parts of kappa y, the
 * momenta by parts of x and y. */
typedef struct {
    /* J2 is the Jacobian matrix of the mean scaled momentum; otherwise of the rise of the coordinates. */
    bool has_momenta;
    double from_q, rise_q;
    double from_p[2], rise_p[2];
} tvi_mean_closing;

#endif
