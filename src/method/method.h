/* method.h - Completes the options of a method: checks that method, expansion and quadrature go together, and finds the
 * degree that an order needs. Integrators and tvi_compile call tvi_options_resolve. */
#ifndef TVI_SRC_METHOD_METHOD_H
#define TVI_SRC_METHOD_METHOD_H

#include "method/descriptor.h"

/* Finds the method of the options. Returns NULL if there is none. */
const tvi_descriptor *tvi_find_method(const tvi_options *options);

/* Completes degree, order, quadrature and number of points of the options in place. If the options are refused, *why
 * becomes the reason. If system is NULL, only those checks are made that hold for every system. */
TVI_NODISCARD tvi_status tvi_options_resolve(tvi_options *options, const tvi_system *system, const char **why);

/* Returns the stepper for resolved options and the instruction set of the system's tapes. */
const tvi_stepper *tvi_choose_stepper(const tvi_options *options, const tvi_system *system);

/* Returns the options of the adjoint Phi*_h = (Phi_-h)^-1 of a method that has one. */
tvi_options tvi_adjoint_options(const tvi_options *options);

#endif
