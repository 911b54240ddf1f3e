/* closing.h - Declares two constants of each method with a Taylor curve: where the step's start and end lie in the
 * curve's scaled time s, and the factors with which the solution of the generating function's equations is added to the
 * curve's ends, so that the step is symplectic (docs/method.md, section 4). Descriptors of methods (descriptor.h)
 * contain both. */
#ifndef TVI_SRC_METHOD_CLOSING_H
#define TVI_SRC_METHOD_CLOSING_H

#include "tvi.h"

/* The ends of a step in the scaled time s, in which a Taylor curve is a polynomial: s- (start_s) and s+ (end_s). One
 * unit of s is the time tau_over_h h. */
typedef struct {
    double start_s, end_s, tau_over_h;
} tvi_step_span;

struct tvi_corrected_curve;
/* The type of a function that computes the corrections of a curve's ends by the equations of a generating function
 * (generating/corrected_curve.h). */
typedef tvi_status tvi_correct_ends_fn(struct tvi_corrected_curve *corrected);

/* The factors by which the solution (x, y) of the equations [J1; J2]^T (x, y) = D_z (generating/corrected_curve.h)
 * enters the corrections of both ends. J1 is the Jacobian matrix of the mean of the ends' coordinates.
 * tvi_solve_end_corrections_by_jacobian_block, which solves other equations for (x, y), uses the same factors. In the
 * notation of docs/notation.md the corrections of the start are
 *     start_correction_q = start_q_correction_factor kappa y,
 *     start_correction_p = start_p_correction_factor[0] x + start_p_correction_factor[1] y,
 * and those of the increments are
 *     increment_correction_q = increment_q_correction_factor kappa y,
 *     increment_correction_p = increment_p_correction_factor[0] x + increment_p_correction_factor[1] y,
 * with kappa = 1 unless the system is separable. */
typedef struct {
    /* true: J2 is the Jacobian matrix of the mean of the ends' scaled momenta; false: that of the difference of their
     * coordinates. */
    bool uses_mean_momentum;
    double start_q_correction_factor, increment_q_correction_factor;
    double start_p_correction_factor[2], increment_p_correction_factor[2];
} tvi_curve_end_correction_factors;

#endif
