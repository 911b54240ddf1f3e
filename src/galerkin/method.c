/* method.c - Describes the Galerkin curve as a method: a type I generating function of a curve whose values at the
 * Gauss nodes are unknowns (galerkin.c). */
#include "method/list.h"

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
};
