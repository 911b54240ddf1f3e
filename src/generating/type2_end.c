/* type2_end.c - computes the corrections that the type II method, Hd+(q0, p1), the right discrete Hamiltonian, adds to
 * the ends of a Taylor curve that is expanded at the end of the step, and defines the descriptor of the method for the
 * list of methods (method/list.h). The equations are in docs/method.md, section 4. */
#include "generating/corrected_curve.h"
#include "method/list.h"

/* Computes the corrections with z = (w, p1), q- = q0, p1 = p+:
 *     (q-_w)^T d0 = -D_w,   p0 = p- + d0,   q1 = w - D_p - (q-_p)^T d0.
 * Here the centre state is z = (w, p1), so that w is the position there. Subscripts are derivatives of q-, q+, p-
 * and p+ by a half of z; D_q, D_p and D_w are the halves of the gradient D_z (action.h). */
static tvi_status solve_end_corrections(tvi_corrected_curve *corrected)
{
    return tvi_solve_end_corrections_by_jacobian_block(corrected, &corrected->q_at_start_weights, TVI_FIRST_COLUMNS);
}

const tvi_descriptor tvi_type2_end = {
    .method = TVI_TYPE2,
    .expansion = TVI_AT_END,
    .title = "type II, end",
    .nodes = {[TVI_NODES_ON_CURVE] = {NULL, 2, 0}, [TVI_NODES_TRUNCATED] = {NULL, 1, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_hamilton,
    .adjoint = &tvi_type3_start,
    .quadrature = TVI_CHOSEN_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.step_span = {-1, 0, 1},
              .action = TVI_ACTION_HAMILTON,
              .correct_ends = solve_end_corrections,
              .end_correction_factors = {.start_p_correction_factor = {-1, 0},
                                         .increment_q_correction_factor = -1,
                                         .increment_p_correction_factor = {1, 0}},
              .needs_extra_newton_pass = true},
};
