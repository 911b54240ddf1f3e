/* closing.h - Declares three constants of each method with a Taylor curve: where the step's start and end lie in the
 * curve's scaled time s, the equations of the generating function, and the factors with which their solution is added
 * to the curve's ends, so that the step is symplectic (docs/method.md, section 4). Descriptors of methods
 * (descriptor.h) contain them. */
#ifndef TVI_SRC_METHOD_CLOSING_H
#define TVI_SRC_METHOD_CLOSING_H

#include "tvi.h"

#include <stdbool.h>

/* The ends of a step in the scaled time s, in which a Taylor curve is a polynomial: s- (start_s) and s+ (end_s). One
 * unit of s is the time tau_over_h h. */
typedef struct {
    double start_s, end_s, tau_over_h;
} tvi_step_span;

/* Sums of the curve's coefficients at the ends s- and s+ of the step: those of q, and those of the scaled momentum u =
 * kappa p. STEP is the difference of the two ends, and MEAN is (s+ x- - s- x+)/(s+ - s-), which has no term of order 1;
 * it is the mean of the ends if the curve is expanded at the midpoint. */
typedef enum {
    TVI_NO_SUM,
    TVI_Q_START,
    TVI_Q_END,
    TVI_Q_STEP,
    TVI_Q_MEAN,
    TVI_U_START,
    TVI_U_END,
    TVI_U_STEP,
    TVI_U_MEAN,
    TVI_END_SUMS
} tvi_end_sum;

/* The linear equations A^T x = D_z for the corrections of the ends, with D_z the gradient of the discrete action by the
 * state z at the curve's centre, in defect form. If lower is not 0, A is the Jacobian by z of the sum `upper` above
 * that of `lower`, and (x, y) is the solution. Otherwise A is one n x n half of the Jacobian J of `upper`: by the first
 * half of z, the coordinates, or by the last. The solution takes the place of this half of (x, y), and the other half
 * is what it leaves there, D_z - J^T x. */
typedef struct {
    tvi_end_sum upper, lower; /* upper 0: there are no equations, and the ends are not corrected */
    bool has_last_columns;
} tvi_end_equations;

/* The factors by which the solution (x, y) of the equations enters the corrections of both ends. The corrections of the
 * start are
 *     start_correction_q = start_q_correction_factor kappa y,
 *     start_correction_p = start_p_correction_factor[0] x + start_p_correction_factor[1] y,
 * and those of the increments are
 *     increment_correction_q = increment_q_correction_factor kappa y,
 *     increment_correction_p = increment_p_correction_factor[0] x + increment_p_correction_factor[1] y,
 * with kappa = 1 unless the system is separable. */
typedef struct {
    double start_q_correction_factor, increment_q_correction_factor;
    double start_p_correction_factor[2], increment_p_correction_factor[2];
} tvi_curve_end_correction_factors;

#endif
