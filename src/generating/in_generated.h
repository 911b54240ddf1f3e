/* in_generated.h - defines, for generated code, the macros by which the headers of curves (series.h and its includers)
 * get their sizes and call one another. Generated code (emit.c) includes this file in place of in_library.h. Sizes are
 * constants, and called functions are inlined. The generated text before this file defines the sizes, such as CURVE_N,
 * and the macros SEEDS_VALUES and SEEDS_TANGENTS. */
#ifndef TVI_SRC_GENERATING_IN_GENERATED_H
#define TVI_SRC_GENERATING_IN_GENERATED_H

#define CURVE_SIZE(constant, variable) ((void)sizeof(variable), constant)
#define CURVE_WIDTH(work)              ((void)(work), 1)
#define CURVE_CALL(function, ...)      curve_##function(__VA_ARGS__)

#define CURVE_COMBINE(tape, ...) ((void)(tape), jet_combine_rows(__VA_ARGS__))
#define CURVE_COMBINE_APART(tape, count, c, c_stride, width, apart, table, out)                                        \
    ((void)(tape), jet_combine_strided_rows(count, c, c_stride, width, apart, table, out))

enum { CURVE_MOST_WIDTH = 1 };
#define CURVE_COMBINE_EACH jet_combine_strided_rows

#define CURVE_FACTOR(factor)   linear_small_equilibrate_and_factor(CURVE_N, factor)
#define CURVE_SOLVE(factor, x) linear_solve_scaled(CURVE_N, factor, false, linear_small_solve_factored, x)

#define ORDERS_SERIES(curve, k)              tvi_series_series_of((curve)->series_block, k)
#define ORDERS_TANGENTS(curve, dx, k, lanes) tvi_series_tangents_of((curve)->series_block, dx, k, lanes)

#define PRODUCTS_TANGENTS tvi_series_tangents
#define PRODUCTS_ADJOINTS tvi_series_adjoints

/* MOMENTA_ROUNDOFF is 0, because generated code does not measure the roundoff of the momenta. If the iteration for the
 * momenta is stuck, the library repeats it and measures the roundoff. */
#define MOMENTA_ROUNDOFF(action, curve) 0

#endif
