/* method.h - what combines with what, and the degree that an order needs. */
#ifndef TVI_SRC_METHOD_METHOD_H
#define TVI_SRC_METHOD_METHOD_H

#include "method/descriptor.h"

/* The method of the options; NULL where there is none. */
const tvi_descriptor *tvi_method_of(const tvi_options *options);

/* Completes the options in place (degree, order, quadrature, points), or says why they make no method. system may be
 * NULL: then what holds for every system is checked. */
TVI_NODISCARD tvi_status tvi_method_resolve(tvi_options *options, const tvi_system *system, const char **why);

/* The stepper of resolved options. */
const tvi_stepper *tvi_method_stepper(const tvi_options *options);

/* The adjoint Phi*_h = (Phi_-h)^-1 of options whose method has one. */
tvi_options tvi_method_adjoint(const tvi_options *options);

#endif
