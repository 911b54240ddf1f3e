/* type3_end.c - computes the corrections that the type III method, Hd-(q1, p0), the left discrete Hamiltonian, adds to
 * the ends of a Taylor curve that is expanded at the end of the step, and defines the descriptor of the method for the
 * list of methods (method/list.h). The equations are in docs/method.md, section 4. */
#include "generating/corrected_curve.h"
#include "method/list.h"

/* Computes the corrections with z = (q1, w), p- = p0:
 *     (p-_w)^T l = D_w,   q0 = q- + l,   p1 = w + D_q - (p-_q)^T l.
 * Here the centre state is z = (q1, w), so that w is the momentum there. Subscripts are derivatives of q-, q+, p-
 * and p+ by a half of z; D_q, D_p and D_w are the halves of the gradient D_z (action.h). */
static tvi_status solve_end_corrections(tvi_corrected_curve *corrected)
{
    return tvi_solve_end_corrections_by_jacobian_block(corrected, &corrected->scaled_p_at_start_weights,
                                                       TVI_LAST_COLUMNS);
}

const tvi_descriptor tvi_type3_end = {
    .method = TVI_TYPE3,
    .expansion = TVI_AT_END,
    .title = "type III, end",
    .nodes = {[TVI_NODES_ON_CURVE] = {NULL, 2, 0}, [TVI_NODES_TRUNCATED] = {NULL, 1, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_hamilton,
    .adjoint = &tvi_type2_start,
    .quadrature = TVI_CHOSEN_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.step_span = {-1, 0, 1},
              .action = TVI_ACTION_HAMILTON,
              .correct_ends = solve_end_corrections,
              .end_correction_factors = {.start_q_correction_factor = 1,
                                         .increment_q_correction_factor = -1,
                                         .increment_p_correction_factor = {1, 0}},
              .needs_extra_newton_pass = true},
};
