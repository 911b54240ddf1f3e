/* type3_start.c - computes the corrections of the type III method, Hd-(q1, p0), the left discrete Hamiltonian, with the
 * curve expanded at the start, and describes it to the list of methods (docs/method.md section 4). */
#include "generating/closure.h"
#include "method/list.h"

/* Computes the corrections with z = (w, p0), q1 = q+:
 *     (q+_w)^T d = D_w,   p1 = p+ + d,   q0 = w + D_p - (q+_p)^T d. */
static tvi_status correct_ends(tvi_closure *closure)
{
    const int n = closure->n;
    double *d = closure->D, *from_u = closure->D + n;
    const tvi_status status = tvi_solve_transposed_half(closure, &closure->q_to, TVI_FIRST);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        closure->from_q[i] = closure->curve.kappa[i] * from_u[i];
        closure->from_p[i] = 0;
        closure->rise_q[i] = -closure->from_q[i];
        closure->rise_p[i] = d[i];
    }
    return TVI_OK;
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
    .quadrature = TVI_FREE_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve = {.span = {0, 1, 1},
              .action = TVI_ACTION_HAMILTON,
              .correct_ends = correct_ends,
              .is_first_pass_rough = true},
};
