/* method.h - Completes options: which method, expansion and quadrature go together, and the degree that an order
 * needs. */
#ifndef TVI_SRC_METHOD_METHOD_H
#define TVI_SRC_METHOD_METHOD_H

#include "method/descriptor.h"

/* The method of the options; NULL if there is none. */
const tvi_descriptor *tvi_method_of(const tvi_options *options);

/* Completes degree, order, quadrature and points of the options in place, or sets *why to the reason why they make no
 * method. With system NULL it checks only what holds for every system. */
TVI_NODISCARD tvi_status tvi_method_resolve(tvi_options *options, const tvi_system *system, const char **why);

/* The stepper of resolved options. */
const tvi_stepper *tvi_method_stepper(const tvi_options *options);

/* Options of the adjoint Phi*_h = (Phi_-h)^-1, for a method that has one. */
tvi_options tvi_method_adjoint(const tvi_options *options);

#endif
