/* method.h - what combines with what, and the degree that an order needs. */
#ifndef TVI_SRC_METHOD_METHOD_H
#define TVI_SRC_METHOD_METHOD_H

#include "method/stepper.h"

/* Completes the options in place (degree, order, quadrature, points), or says why they make no method. system may be
 * NULL: then what holds for every system is checked. */
TVI_NODISCARD tvi_status tvi_method_resolve(tvi_options *options, const tvi_system *system, const char **why);

/* The stepper of resolved options. */
const tvi_stepper *tvi_method_stepper(const tvi_options *options);

/* The adjoint Phi*_h = (Phi_-h)^-1 of a resolved generating function: start and end change places, types II and III
 * too, and the quadrature is mirrored. */
tvi_options tvi_options_adjoint(const tvi_options *options);

#endif
