/* in_library.h - defines the macros by which the headers of curves (series.h and its includers) get the number of
 * members, call one another and choose vector instructions. */
#ifndef TVI_SRC_GENERATING_IN_LIBRARY_H
#define TVI_SRC_GENERATING_IN_LIBRARY_H

#include "measured.h"

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

/* CURVE_CALL calls the library's function of curve.h; or, in a file compiled for one instruction set
 * (CURVE_ONE_SET), the inline function of the same name. */
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
/* ORDERS_SERIES computes order k of the field's series, and ORDERS_TANGENTS that of its tangents in `lanes` directions.
 * */
#define ORDERS_SERIES(curve, k)                                                                                        \
    jet_sweep_series((curve)->system->field_series, (curve)->series_block, k, CURVE_WIDTH(curve))
#define ORDERS_TANGENTS(curve, dx, k, lanes)                                                                           \
    (CURVE_WIDTH(curve) > 1 ? jet_sweep_one_tangent_per_lane                                                           \
                            : jet_sweep_tangents)((curve)->system->field_series, (curve)->series_block, dx, k, lanes)

#endif
