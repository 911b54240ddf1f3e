/* poincare.c - defines the descriptor of the Poincare method for the list of methods (method/list.h). The generating
 * function of this method depends on the mean of the states at the ends of a step (docs/method.md section 4). A step is
 * a Taylor curve, whose state at the midpoint is z, plus small corrections at its ends: b in the coordinates and a in
 * the momenta. The states (q0, p0) at the start and (q1, p1) at the end of the step are
 *     q0 = q- + b/2,   p0 = p- - a/2,   q1 = q+ - b/2,   p1 = p+ + a/2,
 * with the states (q-, p-) and (q+, p+) at the ends of the curve. The corrections solve the linear equations
 *     (dzbar/dz)^T (a, b) = D_z.
 * Here zbar is the mean of (q-, p-) and (q+, p+), a function of z, and D_z is the gradient of the curve's action in
 * defect form by z (action.h). A curve stores each momentum multiplied by a scale factor kappa (series.h). With the
 * mean of these scaled momenta in zbar, the unknowns of the equations become a and b / kappa. */
#include "generating/corrected_curve.h"
#include "method/list.h"

const tvi_descriptor tvi_poincare = {
    .method = TVI_POINCARE,
    .expansion = TVI_AT_MIDPOINT,
    .title = "Poincare, midpoint",
    .nodes = {[TVI_NODES_ON_CURVE] = {"poincare", 2, 2}},
    .least_degree = 0,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_hamilton,
    .adjoint = &tvi_poincare,
    .quadrature = TVI_CHOSEN_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.step_span = {-1, 1, 0.5},
              .action = TVI_ACTION_HAMILTON,
              .uses_highest_momentum_term = true,
              .correct_ends = tvi_solve_end_corrections_by_mean_q_jacobian,
              .end_correction_factors = {true, .start_q_correction_factor = 0.5, .increment_q_correction_factor = -1,
                                         .start_p_correction_factor = {-0.5, 0},
                                         .increment_p_correction_factor = {1, 0}}},
};
