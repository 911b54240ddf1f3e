/* type3_end.c - computes the corrections of the type III method, Hd-(q1, p0), the left discrete Hamiltonian, with the
 * curve expanded at the end, and describes it to the list of methods (docs/method.md section 4). */
#include "generating/closure.h"
#include "method/list.h"

/* Computes the corrections with z = (q1, w), p- = p0:
 *     (p-_w)^T l = D_w,   q0 = q- + l,   p1 = w + D_q - (p-_q)^T l. */
static tvi_status correct_ends(tvi_closure *closure)
{
    return tvi_correct_ends_by_block(closure, &closure->u_from, TVI_SECOND);
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
    .quadrature = TVI_FREE_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.span = {-1, 0, 1},
              .action = TVI_ACTION_HAMILTON,
              .correct_ends = correct_ends,
              .mean_factors = {.from_q_factor = 1, .rise_q_factor = -1, .rise_p_factor = {1, 0}},
              .is_first_pass_rough = true},
};
