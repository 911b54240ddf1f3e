/* type2_start.c - computes the corrections that the type II method, Hd+(q0, p1), the right discrete Hamiltonian, adds
 * to the ends of a Taylor curve that is expanded at the start of the step, and defines the descriptor of the method for
 * the list of methods (method/list.h). The equations are in docs/method.md, section 4. */
#include "generating/corrected_curve.h"
#include "method/list.h"

/* Computes the corrections with z = (q0, w), p1 = p+:
 *     (p+_w)^T l = -D_w,   q1 = q+ + l,   p0 = p- - D_q - (p+_q)^T l.
 * Here the centre state is z = (q0, w), so that w is the momentum there. Subscripts are derivatives of q-, q+, p- and
 * p+ by a half of z; D_q, D_p and D_w are the halves of the gradient D_z (action.h). A curve stores the scaled momentum
 * u = kappa p, with a scale factor kappa for each component (series.h). With u+ instead of p+ and D_w instead of -D_w
 * in the equation for l, its solution is -l / kappa. */
static tvi_status solve_end_corrections(tvi_corrected_curve *corrected)
{
    return tvi_solve_end_corrections_by_jacobian_block(corrected, &corrected->scaled_p_at_end_weights,
                                                       TVI_LAST_COLUMNS);
}

const tvi_descriptor tvi_type2_start = {
    .method = TVI_TYPE2,
    .expansion = TVI_AT_START,
    .title = "type II, start",
    .nodes = {[TVI_NODES_ON_CURVE] = {"right", 2, 0}, [TVI_NODES_TRUNCATED] = {"htvi-right", 1, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_hamilton,
    .adjoint = &tvi_type3_end,
    .quadrature = TVI_CHOSEN_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.step_span = {0, 1, 1},
              .action = TVI_ACTION_HAMILTON,
              .correct_ends = solve_end_corrections,
              .end_correction_factors = {.start_p_correction_factor = {-1, 0},
                                         .increment_q_correction_factor = -1,
                                         .increment_p_correction_factor = {1, 0}},
              .needs_extra_newton_pass = true},
};

const tvi_preset tvi_svhd = {"svhd",
                             {.method = TVI_TYPE2,
                              .expansion = TVI_AT_START,
                              .nodes = TVI_NODES_TRUNCATED,
                              .degree = 1,
                              .order = 2,
                              .compose_adjoint = true,
                              .quadrature = TVI_TRAPEZOID}};
