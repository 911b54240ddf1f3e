/* taylor.c - defines the descriptor of the plain Taylor method for the list of methods (method/list.h). A step is the
 * Taylor curve from the start to the end of the step, without corrections; the curve of p has degree N - 1. The method
 * is explicit and not symplectic. */
#include "generating/corrected_curve.h"
#include "method/list.h"

const tvi_descriptor tvi_taylor = {
    .method = TVI_TAYLOR,
    .expansion = TVI_AT_START,
    .title = "Taylor, start",
    .nodes = {[TVI_NODES_ON_CURVE] = {"taylor", 1, -1}},
    .least_degree = 2,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_all,
    .stepper = &tvi_stepper_taylor,
    .curve = {.step_span = {0, 1, 1}},
};
