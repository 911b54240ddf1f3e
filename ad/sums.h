/* sums.h - Declares the runs that need no rule: sums of multiples, and sums of products, of which most forces consist.
 * They are compiled once for each instruction set. */
#ifndef TVI_AD_SUMS_H
#define TVI_AD_SUMS_H

#include "rule.h"
#include "tape.h"

#define jet_linear_values   JET_FOR_ISA(jet_linear_values)
#define jet_linear_order    JET_FOR_ISA(jet_linear_order)
#define jet_linear_adjoint  JET_FOR_ISA(jet_linear_adjoint)
#define jet_product_values  JET_FOR_ISA(jet_product_values)
#define jet_product_series  JET_FOR_ISA(jet_product_series)
#define jet_product_tangent JET_FOR_ISA(jet_product_tangent)
#define jet_product_adjoint JET_FOR_ISA(jet_product_adjoint)

/* Compute LINEAR runs in the block of one order: x of order 0, of order k >= 1 of a series or of any order of a
 * tangent, bar of any order. */
void jet_linear_values(const jet_tape *tape, const jet_run *run, double *x, int lanes);
void jet_linear_order(const jet_tape *tape, const jet_run *run, double *x, int lanes);
void jet_linear_adjoint(const jet_tape *tape, const jet_run *run, double *bar);

/* Compute PRODUCTS and SQUARES, as the sweeps of the same names do (tape.h). */
void jet_product_values(const jet_tape *tape, const jet_run *run, double *x, int lanes);
void jet_product_series(const jet_tape *tape, const jet_run *run, double *x, int k, int lanes);
/* x has one lane, or as many as dx. */
void jet_product_tangent(const jet_tape *tape, const jet_run *run, const double *x, double *dx, int k, int lanes_of_x,
                         int lanes);
void jet_product_adjoint(const jet_tape *tape, const jet_run *run, const double *x, double *bar, int k, int top);

/* Defines name_T(parameters), which calls body(..., T), for T = 1 .. JET_TERMS_MAX terms. Each T has a function of its
 * own, so that the compiler knows T and saves the registers of the other cases. */
#define JET_BY_TERMS(name, body, parameters, ...)                                                                      \
    static void name##_1 parameters { body(__VA_ARGS__, 1); }                                                          \
    static void name##_2 parameters { body(__VA_ARGS__, 2); }                                                          \
    static void name##_3 parameters { body(__VA_ARGS__, 3); }                                                          \
    static void name##_4 parameters { body(__VA_ARGS__, 4); }

#define JET_COMBINE(V, S)                                                                                              \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM_UPWARDS(V, sum, 0, count - 1, c[(size_t)(count - 1 - j) * of_c] * S(V, table, count - 1 - j));         \
        JET_AT(V, out, 0) = sum;                                                                                       \
    }

/* Does what the sweep of this name does (tape.h), for rows that stand farther apart than they are wide. */
JET_INLINE void jet_combine_apart(int count, const double *c, size_t of_c, int width, size_t stride,
                                  const double *table, double *out)
{
    JET_BLOCKS(width, JET_COMBINE, JET_OF);
}
JET_INLINE void jet_combine(int count, const double *c, size_t of_c, int width, const double *table, double *out)
{
    jet_combine_apart(count, c, of_c, width, (size_t)width, table, out);
}

#endif
