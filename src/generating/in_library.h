/* in_library.h - defines, for the library, the macros by which the texts on curves (series.h and its includers) get
 * their sizes and call one another, for any system. Generated code includes in_generated.h in place of this file. */
#ifndef TVI_SRC_GENERATING_IN_LIBRARY_H
#define TVI_SRC_GENERATING_IN_LIBRARY_H

#include "algebra/width.h"

/* CURVE_SIZE is a size: a constant in generated code, otherwise a variable. */
#define CURVE_SIZE(constant, otherwise) (otherwise)

/* CURVE_WIDTH is the number of members: one, but for CURVE_MEMBERS, which only code of one instruction set serves. It
 * tells the compiler that a width is a multiple of the least one. */
#ifdef CURVE_MEMBERS
enum { CURVE_MOST_WIDTH = TVI_MOST_WIDTH };
#define CURVE_WIDTH(work)  ((work)->width & -TVI_LEAST_WIDTH)
#define CURVE_COMBINE_EACH members_combine_rows
#else
enum { CURVE_MOST_WIDTH = 1 };
#define CURVE_WIDTH(work)                                           ((void)(work), 1)
#define CURVE_COMBINE_EACH(count, c, of_c, width, stride, row, out) ((void)(stride), (void)(out))
#endif

/* CURVE_CALL calls a function of curve.h. If CURVE_ONE_SET says that the file is compiled for one instruction set, it
 * calls the function of the text, as generated code does. */
#ifdef CURVE_ONE_SET
#define CURVE_CALL(function, ...) curve_##function(__VA_ARGS__)
#else
#define CURVE_CALL(function, ...) tvi_curve_##function(__VA_ARGS__)
#endif

/* Computes out[width] = sum_{j < count} c_j table[j][width], c_j = c[j * stride], by the vectors of the tape or of the
 * instruction set. */
#ifdef CURVE_MEMBERS
#define CURVE_COMBINE(tape, count, c, of_c, width, table, out)                                                         \
    ((void)(tape), members_combine_rows(count, c, of_c, width, (size_t)(width), table, out))
#elif defined CURVE_ONE_SET
#define CURVE_COMBINE(tape, ...) ((void)(tape), jet_combine_rows(__VA_ARGS__))
#else
#define CURVE_COMBINE(tape, ...) (tape)->sweeps->combine(__VA_ARGS__)
#endif
/* Computes this sum for rows that stand `apart`; the library has copied them side by side. */
#define CURVE_COMBINE_APART(tape, count, c, of_c, width, apart, table, out)                                            \
    ((void)(apart), CURVE_COMBINE(tape, count, c, of_c, width, table, out))

/* These factor matrices of n rows, and solve with the factors. */
#define CURVE_FACTOR tvi_factor_compute
#define CURVE_SOLVE  tvi_factor_solve

/* These run order k of the field's series, and of its tangents in `lanes` directions. */
#define ORDERS_SERIES(curve, k)                                                                                        \
    jet_sweep_series((curve)->system->field_series, (curve)->series_block, k, CURVE_WIDTH(curve))
#define ORDERS_TANGENTS(curve, dx, k, lanes)                                                                           \
    (CURVE_WIDTH(curve) > 1 ? jet_sweep_tangents_per_lane : jet_sweep_tangents)((curve)->system->field_series,         \
                                                                                (curve)->series_block, dx, k, lanes)

/* These multiply by the Jacobian of the field's series. */
#define PRODUCTS_TANGENTS jet_sweep_tangents
#define PRODUCTS_ADJOINTS jet_sweep_adjoints
/* These evaluate the field at the nodes, and its tangents. */
#define SEEDS_VALUES(tape, x, lanes)       jet_sweep_values(tape, x, lanes)
#define SEEDS_TANGENTS(tape, x, dx, lanes) jet_sweep_tangents_per_lane(tape, x, dx, 0, lanes)

/* Returns the roundoff of the momenta at the nodes. */
#define MOMENTA_ROUNDOFF(action, curve) tvi_estimate_node_momenta_roundoff(action, curve)

#endif
