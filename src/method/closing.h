/* closing.h - Declares the data by which a generating function corrects the ends of a curve (docs/method.md, section
 * 4). Descriptors of methods (descriptor.h) contain them. The file is part of the text of generated code. */
#ifndef TVI_SRC_METHOD_CLOSING_H
#define TVI_SRC_METHOD_CLOSING_H

#include "tvi.h"

/* The ends s- and s+ of a step in the scaled time s of its curve, and the scale tau of the time, as a multiple of
 * h. */
typedef struct {
    double from, to, tau;
} tvi_scaled_span;

struct tvi_closure;
/* The type of a function that computes the corrections of the curve's ends by the equations of a generating function
 * (generating/closure.h). */
typedef tvi_status tvi_correct_ends_fn(struct tvi_closure *closure);

/* The factors of the corrections of both ends, as sums of multiples of the solution (x, y) of the equations [J1;
 * J2]^T (x, y) = D_z (generating/closure.h). J1 is the Jacobian matrix of the mean of the ends' coordinates. In the
 * notation of docs/notation.md the corrections are
 *     from_q = from_q_factor kappa y, from_p = from_p_factor[0] x + from_p_factor[1] y at the start of the step,
 *     rise_q = rise_q_factor kappa y, rise_p = rise_p_factor[0] x + rise_p_factor[1] y of the increments,
 * with kappa = 1 unless the system is separable. */
typedef struct {
    /* true: J2 is the Jacobian matrix of the mean of the ends' scaled momenta; false: that of the difference of their
     * coordinates. */
    bool uses_mean_momentum;
    double from_q_factor, rise_q_factor;
    double from_p_factor[2], rise_p_factor[2];
} tvi_mean_factors;

#endif
