/* closing.h - the ends of a curve, and how a generating function closes its equations: part of the text of generated
 * code. */
#ifndef TVI_SRC_METHOD_CLOSING_H
#define TVI_SRC_METHOD_CLOSING_H

#include "tvi.h"

/* Where the step's ends lie in the scaled time of a curve, and tau as a multiple of h. */
typedef struct {
    double from, to, tau;
} tvi_span;

/* Solves a generating function's equations for the corrections of the curve's ends: generating/closure.h. */
struct tvi_closure;
typedef tvi_status tvi_close_fn(struct tvi_closure *closure);

/* The corrections of both ends from the solution (x, y) of [J1; J2]^T (x, y) = D_z (generating/closure.h), J1 the
 * Jacobian of the mean of the ends' coordinates: the coordinates' are these parts of kappa y, the momenta's these of x
 * and y. */
typedef struct {
    bool has_momenta; /* J2 is that of the mean of the scaled momenta, else of the rise of the coordinates */
    double from_q, rise_q;
    double from_p[2], rise_p[2];
} tvi_mean_closing;

#endif
