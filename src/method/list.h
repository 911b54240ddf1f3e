/* list.h - Lists all methods. method.c searches the list. A method whose adjoint is another method stands beside its
 * adjoint. Every other method is symmetric or has no adjoint. */
#ifndef TVI_SRC_METHOD_LIST_H
#define TVI_SRC_METHOD_LIST_H

#include "method/descriptor.h"

#define TVI_METHOD_LIST(ONE, WITH_ADJOINT)                                                                             \
    WITH_ADJOINT(tvi_type1_start, tvi_type1_end)                                                                       \
    ONE(tvi_type1_midpoint)                                                                                            \
    ONE(tvi_type1_both_ends)                                                                                           \
    ONE(tvi_galerkin)                                                                                                  \
    WITH_ADJOINT(tvi_type2_start, tvi_type3_end)                                                                       \
    WITH_ADJOINT(tvi_type3_start, tvi_type2_end)                                                                       \
    ONE(tvi_poincare)                                                                                                  \
    ONE(tvi_taylor)                                                                                                    \
    ONE(tvi_stormer_verlet)

#define TVI_DECLARE_ONE(method)                   extern const tvi_descriptor method;
#define TVI_DECLARE_WITH_ADJOINT(method, adjoint) extern const tvi_descriptor method, adjoint;
TVI_METHOD_LIST(TVI_DECLARE_ONE, TVI_DECLARE_WITH_ADJOINT)

extern const tvi_descriptor *const tvi_methods[]; /* All methods, with NULL at the end. */

/* The preset "svhd", a composition: type II expanded at the start, N = 1, with the trapezoid rule (docs/method.md,
 * section 7). */
extern const tvi_preset tvi_svhd;

#endif
