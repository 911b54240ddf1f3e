/* closing.h - Declares the ends of a curve, and the ways in which a generating function corrects them
 * (docs/method.md, section 4). Descriptors of methods (descriptor.h) contain them. It is part of the text of
 * generated code. */
#ifndef TVI_SRC_METHOD_CLOSING_H
#define TVI_SRC_METHOD_CLOSING_H

#include "tvi.h"

/* The ends s- and s+ of a step in the scaled time of its curve, and tau as a multiple of h. */
typedef struct {
    double from, to, tau;
} tvi_scaled_span;

/* The type of a function that computes the corrections of the curve's ends by the equations of a generating function
 * (generating/closure.h). */
struct tvi_closure;
typedef tvi_status tvi_close_fn(struct tvi_closure *closure);

/* Factors that give the corrections of both ends from the solution (x, y) of [J1; J2]^T (x, y) = D_z
 * (generating/closure.h). J1 is the Jacobian matrix of the mean of the ends' coordinates. The coordinates are
 * corrected by multiples of kappa y, and the momenta by multiples of x and y. `from` is for the start of the step,
 * and `rise` for the difference of its ends. */
typedef struct {
    /* J2 is the Jacobian matrix of the mean scaled momentum; otherwise that of the difference of the coordinates. */
    bool has_momenta;
    double from_q, rise_q;
    double from_p[2], rise_p[2];
} tvi_mean_closing;

#endif
