/* in_library.h - defines the macros by which the headers of curves (series.h and its includers) call one another and
 * choose vector instructions. */
#ifndef TVI_SRC_GENERATING_IN_LIBRARY_H
#define TVI_SRC_GENERATING_IN_LIBRARY_H

#include "measured.h"

/* CURVE_CALL calls the library's function of curve.h; or, in a file compiled for one instruction set
 * (CURVE_ONE_SET), the inline function of the same name. */
#ifdef CURVE_ONE_SET
#define CURVE_CALL(function, ...) curve_##function(__VA_ARGS__)
#else
#define CURVE_CALL(function, ...) tvi_curve_##function(__VA_ARGS__)
#endif

/* CURVE_COMBINE computes out[width] = sum_{j < count} c_j table[j][width], with c_j = c[j * c_stride], with the vector
 * instructions of the tape's sweeps, or of the instruction set for which the file is compiled. */
#ifdef CURVE_ONE_SET
#define CURVE_COMBINE(tape, ...) ((void)(tape), jet_combine_rows(__VA_ARGS__))
#else
#define CURVE_COMBINE(tape, ...) (tape)->sweeps->combine(__VA_ARGS__)
#endif

/* ORDERS_SERIES computes order k of the field's series, and ORDERS_TANGENTS that of its tangents in `lanes` directions.
 * */
#define ORDERS_SERIES(curve, k) jet_sweep_series((curve)->system->field_series, (curve)->series_block, k, 1)
#define ORDERS_TANGENTS(curve, dx, k, lanes)                                                                           \
    jet_sweep_tangents((curve)->system->field_series, (curve)->series_block, dx, k, lanes)

#endif
