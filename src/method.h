/* method.h - what combines with what, and the degree that an order needs. */
#ifndef TVI_SRC_METHOD_H
#define TVI_SRC_METHOD_H

#include "stepper.h"

/* Completes the options in place (degree, order, quadrature, points) and gives the stepper that serves them, or says why
 * they make no method. system may be NULL: then what holds for every system is checked. */
TVI_NODISCARD tvi_status tvi_method_resolve(tvi_options *options, const tvi_system *system, const tvi_stepper **stepper,
                                            const char **why);

#endif
