/* type3_start.c - computes the corrections that the type III method, Hd-(q1, p0), the left discrete Hamiltonian, adds
 * to the ends of a Taylor curve that is expanded at the start of the step, and defines the descriptor of the method for
 * the list of methods (method/list.h). The equations are in docs/method.md, section 4. */
#include "generating/corrected_curve.h"
#include "method/list.h"

/* Computes the corrections with z = (w, p0), q1 = q+:
 *     (q+_w)^T d = D_w,   p1 = p+ + d,   q0 = w + D_p - (q+_p)^T d.
 * Here the centre state is z = (w, p0), so that w is the position there. Subscripts are derivatives of q-, q+, p-
 * and p+ by a half of z; D_q, D_p and D_w are the halves of the gradient D_z (action.h). */
static tvi_status solve_end_corrections(tvi_corrected_curve *corrected)
{
    return tvi_solve_end_corrections_by_jacobian_block(corrected, &corrected->q_at_end_weights, TVI_FIRST_COLUMNS);
}

const tvi_descriptor tvi_type3_start = {
    .method = TVI_TYPE3,
    .expansion = TVI_AT_START,
    .title = "type III, start",
    .nodes = {[TVI_NODES_ON_CURVE] = {"left", 2, 0}, [TVI_NODES_TRUNCATED] = {"htvi-left", 1, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_hamilton,
    .adjoint = &tvi_type2_end,
    .quadrature = TVI_CHOSEN_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.step_span = {0, 1, 1},
              .action = TVI_ACTION_HAMILTON,
              .correct_ends = solve_end_corrections,
              .end_correction_factors = {.start_q_correction_factor = 1,
                                         .increment_q_correction_factor = -1,
                                         .increment_p_correction_factor = {1, 0}},
              .needs_extra_newton_pass = true},
};
