/* poincare.c - describes the method of the Poincare generating function, which depends on the mean of the step's ends,
 * to the list of methods (docs/method.md section 4). Its corrections solve
 *     (dzbar/dz)^T (a, b) = D_z,   z0 = (q- + b/2, p- - a/2),   z1 = (q+ - b/2, p+ + a/2),   zbar the mean of the
 * curve's ends. With the scaled momenta in zbar the solution is (a, b / kappa). */
#include "generating/closure.h"
#include "method/list.h"

const tvi_descriptor tvi_poincare = {
    .method = TVI_POINCARE,
    .expansion = TVI_AT_MIDPOINT,
    .title = "Poincare, midpoint",
    .nodes = {[TVI_NODES_ON_CURVE] = {"poincare", 2, 2}},
    .least_degree = 0,
    .most_degree = TVI_MAX_DEGREE,
    .serves = &tvi_serves_hamilton,
    .adjoint = &tvi_poincare,
    .quadrature = TVI_ANY_QUADRATURE,
    .pairs_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.span = {-1, 1, 0.5},
              .action = TVI_ACTION_HAMILTON,
              .has_top_momentum = true,
              .close = tvi_close_by_mean_of_ends,
              .mean = {true, .from_q = 0.5, .rise_q = -1, .from_p = {-0.5, 0}, .rise_p = {1, 0}}},
};
