/* sums.h - Declares functions that compute sums of multiples (LINEAR) and sums of products (PRODUCTS, SQUARES), of
 * which most forces consist. All other operations of a tape have rules (rule.h). sweep.c and generated code call them.
 * They are compiled once for each instruction set. */
#ifndef TVI_AD_SUMS_H
#define TVI_AD_SUMS_H

#include "rule.h"
#include "tape.h"

/* Compute the LINEAR operations of a run; `block` is that part of a block that holds one order.
 * jet_compute_linear_values is for order 0, and adds the constant terms. jet_compute_linear_part is for order k >= 1 of
 * a series, and for every order of a tangent. jet_add_linear_adjoints is for every order of the adjoints. */
void jet_compute_linear_values(const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes);
void jet_compute_linear_part(const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes);
void jet_add_linear_adjoints(const jet_tape *tape, const jet_run_of_operations *run, double *adjoints);

/* Compute the PRODUCTS or SQUARES operations of a run, as the sweeps of values, series, tangents and adjoints need
 * them (tape.h). k is the order, and `top` the highest order of the series. */
void jet_compute_product_values(const jet_tape *tape, const jet_run_of_operations *run, double *block, int lanes);
void jet_compute_product_series_order(const jet_tape *tape, const jet_run_of_operations *run, double *block, int k,
                                      int lanes);
/* `block` is that of the series, and has one lane (block_lanes = 1) or as many lanes as tangent_block. */
void jet_compute_product_tangents(const jet_tape *tape, const jet_run_of_operations *run, const double *block,
                                  double *tangent_block, int k, int block_lanes, int lanes);
void jet_add_product_adjoints(const jet_tape *tape, const jet_run_of_operations *run, const double *block,
                              double *adjoint_block, int k, int top);

/* Defines functions name_T(parameters), which call body(..., T), for T = 1 .. JET_TERMS_MAX terms. Each T has a
 * function of its own, so that T is a constant for the compiler. */
#define JET_BY_TERMS(name, body, parameters, ...)                                                                      \
    static void name##_1 parameters { body(__VA_ARGS__, 1); }                                                          \
    static void name##_2 parameters { body(__VA_ARGS__, 2); }                                                          \
    static void name##_3 parameters { body(__VA_ARGS__, 3); }                                                          \
    static void name##_4 parameters { body(__VA_ARGS__, 4); }

#define JET_COMBINE(V, S)                                                                                              \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 0, term_count - 1,                                                                             \
                coefficient[(size_t)(term_count - 1 - j) * coefficient_stride] * S(V, table, term_count - 1 - j));     \
        JET_AT(V, out, 0) = sum;                                                                                       \
    }

/* Computes out[w] = sum_{j < term_count} c_j table[j][w] for w < width, with c_j = coefficient[j * coefficient_stride]
 * and rows of the table that are `stride` numbers apart. For a series in powers, the terms of the highest powers are
 * the smallest; they come last in the table, and are added first. */
JET_INLINE void jet_combine_strided_rows(int term_count, const double *coefficient, size_t coefficient_stride,
                                         int width, size_t stride, const double *table, double *out)
{
    JET_BLOCKS(width, JET_COMBINE, JET_OF);
}
JET_INLINE void jet_combine_rows(int term_count, const double *coefficient, size_t coefficient_stride, int width,
                                 const double *table, double *out)
{
    jet_combine_strided_rows(term_count, coefficient, coefficient_stride, width, (size_t)width, table, out);
}

#endif
