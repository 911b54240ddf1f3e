/* in_library.h - defines, for the library, the macros by which the headers of curves (series.h and its includers) get
 * their sizes and call one another, for any system. Generated code includes in_generated.h in place of this file. */
#ifndef TVI_SRC_GENERATING_IN_LIBRARY_H
#define TVI_SRC_GENERATING_IN_LIBRARY_H

#include "measured.h"

/* CURVE_SIZE is the constant in generated code, and the variable in the library. */
#define CURVE_SIZE(constant, variable) (variable)

/* CURVE_WIDTH is the number of members. It is 1, unless the file defines CURVE_MEMBERS to handle several members. The
 * mask -BATCH_MIN_WIDTH tells the compiler that a width is a multiple of the least width. */
#ifdef CURVE_MEMBERS
enum { CURVE_MOST_WIDTH = BATCH_MAX_WIDTH };
#define CURVE_WIDTH(work)  ((work)->member_count & -BATCH_MIN_WIDTH)
#define CURVE_COMBINE_EACH members_combine_rows
#else
enum { CURVE_MOST_WIDTH = 1 };
#define CURVE_WIDTH(work)                                               ((void)(work), 1)
#define CURVE_COMBINE_EACH(count, c, c_stride, width, stride, row, out) ((void)(stride), (void)(out))
#endif

/* CURVE_CALL calls the library's function of curve.h; or, in a file compiled for one instruction set (CURVE_ONE_SET)
 * and in generated code, the inline function of the same name. */
#ifdef CURVE_ONE_SET
#define CURVE_CALL(function, ...) curve_##function(__VA_ARGS__)
#else
#define CURVE_CALL(function, ...) tvi_curve_##function(__VA_ARGS__)
#endif

/* CURVE_COMBINE computes out[width] = sum_{j < count} c_j table[j][width], with c_j = c[j * c_stride], with the vector
 * instructions of the tape's sweeps, or of the instruction set for which the file is compiled. */
#ifdef CURVE_MEMBERS
#define CURVE_COMBINE(tape, count, c, c_stride, width, table, out)                                                     \
    ((void)(tape), members_combine_rows(count, c, c_stride, width, (size_t)(width), table, out))
#elif defined CURVE_ONE_SET
#define CURVE_COMBINE(tape, ...) ((void)(tape), jet_combine_rows(__VA_ARGS__))
#else
#define CURVE_COMBINE(tape, ...) (tape)->sweeps->combine(__VA_ARGS__)
#endif
/* CURVE_COMBINE_APART computes the sum of CURVE_COMBINE from rows that begin `apart` numbers apart. In the library the
 * rows are contiguous, and `apart` is ignored. */
#define CURVE_COMBINE_APART(tape, count, c, c_stride, width, apart, table, out)                                        \
    ((void)(apart), CURVE_COMBINE(tape, count, c, c_stride, width, table, out))

/* CURVE_FACTOR factors a matrix, and CURVE_SOLVE solves with its factors. */
#define CURVE_FACTOR tvi_factor_compute
#define CURVE_SOLVE  tvi_factor_solve

/* ORDERS_SERIES computes order k of the field's series, and ORDERS_TANGENTS that of its tangents in `lanes` directions.
 * */
#define ORDERS_SERIES(curve, k)                                                                                        \
    jet_sweep_series((curve)->system->field_series, (curve)->series_block, k, CURVE_WIDTH(curve))
#define ORDERS_TANGENTS(curve, dx, k, lanes)                                                                           \
    (CURVE_WIDTH(curve) > 1 ? jet_sweep_one_tangent_per_lane                                                           \
                            : jet_sweep_tangents)((curve)->system->field_series, (curve)->series_block, dx, k, lanes)

/* PRODUCTS_TANGENTS and PRODUCTS_ADJOINTS multiply by the Jacobian of order k of the field and by its transpose. */
#define PRODUCTS_TANGENTS jet_sweep_tangents
#define PRODUCTS_ADJOINTS jet_sweep_adjoints
/* SEEDS_VALUES evaluates the field at the nodes, and SEEDS_TANGENTS its tangents. */
#define SEEDS_VALUES(tape, x, lanes)       jet_sweep_values(tape, x, lanes)
#define SEEDS_TANGENTS(tape, x, dx, lanes) jet_sweep_one_tangent_per_lane(tape, x, dx, 0, lanes)

/* MOMENTA_ROUNDOFF is the roundoff of the momenta at the nodes. */
#define MOMENTA_ROUNDOFF(action, curve) tvi_estimate_node_momenta_roundoff(action, curve)

#endif
