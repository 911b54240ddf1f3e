/* methods.c - defines the descriptors of the methods, for the list of methods (method/list.h): a row for each
 * generating function and each place where its Taylor curve is expanded (docs/method.md section 4), and at the end
 * "taylor" and "galerkin", whose curve is none of Taylor's. "stormer-verlet" has its descriptor in method/verlet.c.
 *
 * The letters: (q-, p-) and (q+, p+) are the ends of the curve, functions of the state z at its centre, and u = kappa
 * p, where the factor kappa gives momenta the unit of coordinates; G- and G+ are the Jacobians of q- and q+ by z, M
 * their mean, and R = G+ - G-. Subscripts are derivatives by the first half of z, the coordinates, or by the second.
 * D_z is the gradient of the discrete action in defect form (action.h), with the halves D_q and D_v, or D_w for the
 * half of z that the kept end leaves free. What is added to an end is small: d0 to p-, d1 to p+ (type I), d to the
 * momentum and l to the coordinate (types II and III), a and b in the equations of Poincare. */
#include "method/list.h"

/* The columns of a method: the title, the names with on-curve and with truncated nodes, the forms of systems, and the
 * adjoint. */
#define METHOD(words, on_curve, truncated, forms, its_adjoint)                                                         \
    .title = words, .nodes = {{on_curve, 2, 0}, {truncated, 1, 0}}, .least_degree = 1, .most_degree = TVI_MAX_DEGREE,  \
    .supports = &forms, .adjoint = &its_adjoint, .quadrature = TVI_CHOSEN_QUADRATURE, .needs_conjugate_momenta = true

/* The columns of a curve: the span, s-, s+ and tau/h; the action; whether p has the degree of q; the equations of the
 * corrections, with the columns of a block; the factors of their solution (x, y) in the corrections: of kappa y in
 * those of q0 and of q1 - q0, of x and y in those of p0 and of p1 - p0; and whether a step makes one more pass. */

/* ---- Type I, Ld(q0, q1):  q- = q0,  q1 = q+,  p0 = p- + d0,  p1 = p+ + d1,  G+^T d1 - G-^T d0 = D_z -------------- */

/* z = (q0, v), G- = (I, 0):  R_v^T d1 = D_v,  d1 - d0 = D_q - R_q^T d1. */
const tvi_descriptor tvi_type1_start = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_START,
    METHOD("type I, start", "start", "tvi", tvi_supports_type1, tvi_type1_end),
    .stepper = &tvi_stepper_curve,
    .curve = {{0, 1, 1}, TVI_ACTION_LAGRANGE, false, {TVI_Q_STEP, TVI_NO_SUM, true}, {0, 0, {-1, 1}, {1, 0}}, false},
};

/* The matrix of these equations for d1 - d0 and (d1 + d0)/2 is I + O(h):  M^T (d1 - d0) + R^T (d1 + d0)/2 = D_z. */
const tvi_descriptor tvi_type1_midpoint = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_MIDPOINT,
    METHOD("type I, midpoint", "midpoint", NULL, tvi_supports_type1, tvi_type1_midpoint),
    .stepper = &tvi_stepper_curve,
    .curve =
        {{-1, 1, 0.5}, TVI_ACTION_LAGRANGE, false, {TVI_Q_MEAN, TVI_Q_STEP, false}, {0, 0, {-0.5, 1}, {1, 0}}, false},
};

/* z = (q1, v), G+ = (I, 0):  R_v^T d0 = D_v,  d1 - d0 = D_q - R_q^T d0. */
const tvi_descriptor tvi_type1_end = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_END,
    METHOD("type I, end", "end", NULL, tvi_supports_type1, tvi_type1_start),
    .stepper = &tvi_stepper_curve,
    .curve = {{-1, 0, 1}, TVI_ACTION_LAGRANGE, false, {TVI_Q_STEP, TVI_NO_SUM, true}, {0, 0, {0, 1}, {1, 0}}, true},
};

/* A curve from each end (both_ends.c). */
const tvi_descriptor tvi_type1_both_ends = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_BOTH_ENDS,
    METHOD("type I, both ends", "both-ends", "symmetric-tvi", tvi_supports_type1, tvi_type1_both_ends),
    .stepper = &tvi_stepper_both_ends,
    .predictor = &tvi_stepper_curve,
    .curve = {.step_span = {0, 1, 1}},
};

/* ---- Type II, Hd+(q0, p1), the right discrete Hamiltonian -------------------------------------------------------- */

/* z = (q0, w), p1 = p+:  (p+_w)^T l = -D_w,  q1 = q+ + l,  p0 = p- - D_q - (p+_q)^T l. With u+ in place of p+ and D_w
 * in place of -D_w the solution is -l / kappa. */
const tvi_descriptor tvi_type2_start = {
    .method = TVI_TYPE2,
    .expansion = TVI_AT_START,
    METHOD("type II, start", "right", "htvi-right", tvi_supports_hamilton, tvi_type3_end),
    .stepper = &tvi_stepper_curve,
    .curve = {{0, 1, 1}, TVI_ACTION_HAMILTON, false, {TVI_U_END, TVI_NO_SUM, true}, {0, -1, {-1, 0}, {1, 0}}, true},
};

/* z = (w, p1), q- = q0:  (q-_w)^T d0 = -D_w,  p0 = p- + d0,  q1 = w - D_p - (q-_p)^T d0. */
const tvi_descriptor tvi_type2_end = {
    .method = TVI_TYPE2,
    .expansion = TVI_AT_END,
    METHOD("type II, end", NULL, NULL, tvi_supports_hamilton, tvi_type3_start),
    .stepper = &tvi_stepper_curve,
    .curve = {{-1, 0, 1}, TVI_ACTION_HAMILTON, false, {TVI_Q_START, TVI_NO_SUM, false}, {0, -1, {-1, 0}, {1, 0}}, true},
};

/* Type II at the start with its adjoint, N = 1, by the trapezoid rule (docs/method.md section 7). */
const tvi_preset tvi_svhd = {"svhd",
                             {.method = TVI_TYPE2,
                              .expansion = TVI_AT_START,
                              .nodes = TVI_NODES_TRUNCATED,
                              .degree = 1,
                              .order = 2,
                              .compose_adjoint = true,
                              .quadrature = TVI_TRAPEZOID}};

/* ---- Type III, Hd-(q1, p0), the left discrete Hamiltonian -------------------------------------------------------- */

/* z = (w, p0), q1 = q+:  (q+_w)^T d = D_w,  p1 = p+ + d,  q0 = w + D_p - (q+_p)^T d. */
const tvi_descriptor tvi_type3_start = {
    .method = TVI_TYPE3,
    .expansion = TVI_AT_START,
    METHOD("type III, start", "left", "htvi-left", tvi_supports_hamilton, tvi_type2_end),
    .stepper = &tvi_stepper_curve,
    .curve = {{0, 1, 1}, TVI_ACTION_HAMILTON, false, {TVI_Q_END, TVI_NO_SUM, false}, {1, -1, {0, 0}, {1, 0}}, true},
};

/* z = (q1, w), p- = p0:  (p-_w)^T l = D_w,  q0 = q- + l,  p1 = w + D_q - (p-_q)^T l. */
const tvi_descriptor tvi_type3_end = {
    .method = TVI_TYPE3,
    .expansion = TVI_AT_END,
    METHOD("type III, end", NULL, NULL, tvi_supports_hamilton, tvi_type2_start),
    .stepper = &tvi_stepper_curve,
    .curve = {{-1, 0, 1}, TVI_ACTION_HAMILTON, false, {TVI_U_START, TVI_NO_SUM, true}, {1, -1, {0, 0}, {1, 0}}, true},
};

/* ---- Methods with other degrees ---------------------------------------------------------------------------------- */

/* Poincare, of the mean zbar of the states at the ends:
 *     (dzbar/dz)^T (a, b) = D_z,  q0 = q- + b/2,  p0 = p- - a/2,  q1 = q+ - b/2,  p1 = p+ + a/2.
 * With the mean of the scaled momenta in zbar, the solution is (a, b / kappa). */
const tvi_descriptor tvi_poincare = {
    .method = TVI_POINCARE,
    .expansion = TVI_AT_MIDPOINT,
    .title = "Poincare, midpoint",
    .nodes = {{"poincare", 2, 2}},
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_hamilton,
    .adjoint = &tvi_poincare,
    .quadrature = TVI_CHOSEN_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &tvi_stepper_curve,
    .curve =
        {{-1, 1, 0.5}, TVI_ACTION_HAMILTON, true, {TVI_Q_MEAN, TVI_U_MEAN, false}, {0.5, -1, {-0.5, 0}, {1, 0}}, false},
};

/* The plain Taylor method: the curve from the start to the end of the step, without corrections. The curve of p has
 * degree N - 1. It is explicit and not symplectic. */
const tvi_descriptor tvi_taylor = {
    .method = TVI_TAYLOR,
    .expansion = TVI_AT_START,
    .title = "Taylor, start",
    .nodes = {{"taylor", 1, -1}},
    .least_degree = 2,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_all_but_field,
    .stepper = &tvi_stepper_taylor,
    .curve = {.step_span = {0, 1, 1}},
};

/* The Galerkin curve (src/galerkin): type I of a curve whose values at the Gauss nodes are unknowns. */
const tvi_descriptor tvi_galerkin = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_NODES,
    .title = "type I, nodes",
    .nodes = {[TVI_NODES_ON_CURVE] = {"galerkin", 2, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_NODES,
    .supports = &tvi_supports_all,
    .adjoint = &tvi_galerkin,
    .quadrature = TVI_GAUSS_OF_DEGREE,
    .stepper = &tvi_stepper_galerkin,
    .constrained = &tvi_stepper_constrained,
    .avx512_degrees = {5, 8}, /* these numbers of nodes fill a vector of eight */
};
