/* poincare.c - defines the descriptor of the Poincare method for the list of methods (method/list.h). The generating
 * function depends on the mean of the states at the step's ends (docs/method.md section 4). The corrections of the ends
 * are b in the coordinates and a in the momenta, with
 *     (dzbar/dz)^T (a, b) = D_z,   z0 = (q- + b/2, p- - a/2),   z1 = (q+ - b/2, p+ + a/2),
 * with the states z0 and z1 at the ends of the step, the ends (q-, p-) and (q+, p+) of the curve and their mean zbar,
 * and the gradient D_z of the action in defect form (action.h). With the scaled momenta in zbar the solution is (a, b /
 * kappa). */
#include "generating/closure.h"
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
    .curve = {.span = {-1, 1, 0.5},
              .action = TVI_ACTION_HAMILTON,
              .uses_highest_momentum_term = true,
              .correct_ends = tvi_correct_ends_by_mean,
              .end_factors = {true, .start_q_factor = 0.5, .increment_q_factor = -1, .start_p_factor = {-0.5, 0},
                              .increment_p_factor = {1, 0}}},
};
