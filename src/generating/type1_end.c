/* type1_end.c - defines the descriptor of the type I method, Ld(q0, q1), with the Taylor curve expanded at the end of
 * the step, for the list of methods (method/list.h). Its equations are (docs/method.md section 4)
 *     q- = q0,   q1 = q+,   p0 = p- + d0,   p1 = p+ + d1   with   G+^T d1 - G-^T d0 = D_z.
 * (q-, p-) and (q+, p+) are the ends of the curve, G- and G+ the Jacobians of q- and q+ by its centre state z, D_z is
 * the gradient of the action in defect form (action.h), and d0 and d1 are the corrections. */
#include "generating/corrected_curve.h"
#include "method/list.h"

/* Computes the corrections d0 and d1 of the momenta at the ends. The unknowns are z = (q1, v). With
 * G+ = (I, 0), G- = (A, B), R = G+ - G- = (I - A, -B), and with the blocks
 * (D_q, D_v) of D_z and (R_q, R_v) of R, the equations are
 *     R_v^T d0 = D_v,   d1 - d0 = D_q - R_q^T d0. */
static tvi_status solve_end_corrections(tvi_corrected_curve *corrected)
{
    return tvi_solve_end_corrections_by_jacobian_block(corrected, &corrected->q_increment_weights, TVI_LAST_COLUMNS);
}

const tvi_descriptor tvi_type1_end = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_END,
    .title = "type I, end",
    .nodes = {[TVI_NODES_ON_CURVE] = {"end", 2, 0}, [TVI_NODES_TRUNCATED] = {NULL, 1, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_type1,
    .adjoint = &tvi_type1_start,
    .quadrature = TVI_CHOSEN_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.step_span = {-1, 0, 1},
              .action = TVI_ACTION_LAGRANGE,
              .correct_ends = solve_end_corrections,
              .end_correction_factors = {.start_p_correction_factor = {0, 1}, .increment_p_correction_factor = {1, 0}},
              .needs_extra_newton_pass = true},
};
