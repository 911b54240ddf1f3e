/* type1_midpoint.c - defines the descriptor of the type I method, Ld(q0, q1), with the Taylor curve expanded at the
 * midpoint of the step, for the list of methods (method/list.h). Its equations are (docs/method.md section 4)
 *     q- = q0,   q1 = q+,   p0 = p- + d0,   p1 = p+ + d1   with   G+^T d1 - G-^T d0 = D_z.
 * (q-, p-) and (q+, p+) are the ends of the curve, G- and G+ the Jacobians of q- and q+ by its centre state z, D_z is
 * the gradient of the action in defect form (action.h), and d0 and d1 are the corrections. With the mean M of G- and
 * G+, and R = G+ - G-, the matrix is I + O(h):
 *     M^T (d1 - d0) + R^T (d1 + d0)/2 = D_z. */
#include "generating/corrected_curve.h"
#include "method/list.h"

const tvi_descriptor tvi_type1_midpoint = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_MIDPOINT,
    .title = "type I, midpoint",
    .nodes = {[TVI_NODES_ON_CURVE] = {"midpoint", 2, 0}, [TVI_NODES_TRUNCATED] = {NULL, 1, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_type1,
    .adjoint = &tvi_type1_midpoint,
    .quadrature = TVI_CHOSEN_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.step_span = {-1, 1, 0.5},
              .action = TVI_ACTION_LAGRANGE,
              .correct_ends = tvi_solve_end_corrections_by_mean_q_jacobian,
              .end_correction_factors = {false, .start_p_correction_factor = {-0.5, 1},
                                         .increment_p_correction_factor = {1, 0}}},
};
