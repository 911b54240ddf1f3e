/* sizes.h - Measures the sizes of numbers and arrays, and tests whether they are finite. */
#ifndef TVI_SRC_SIZES_H
#define TVI_SRC_SIZES_H

#include "compiler.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t tvi_bits(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* 0 if and only if x is finite, as then x - x is 0. */
static inline uint64_t tvi_bits_of_infinite(double x) { return tvi_bits(x - x); }

/* Tells whether all rows [n] are finite. The bits are combined in any order. */
static inline bool tvi_rows_are_finite(int rows, size_t stride, int n, const double x[])
{
    uint64_t any = 0;
    for (int r = 0; r < rows; r++)
        for (int i = 0; i < n; i++) any |= tvi_bits_of_infinite(x[(size_t)r * stride + (size_t)i]);
    return any == 0;
}

static inline bool tvi_all_finite(int n, const double x[]) { return tvi_rows_are_finite(1, 0, n, x); }

/* max |x_i| over n numbers, `stride` apart. */
static inline double tvi_largest(int n, const double x[], int stride)
{
    double size = 0;
    for (int i = 0; i < n; i++) {
        const double one = fabs(x[(size_t)i * (size_t)stride]);
        size = one > size ? one : size;
    }
    return size;
}

/* The larger and the smaller of two numbers without a call, unlike fmax and fmin; b if one is no number. */
static inline double tvi_larger(double a, double b) { return a > b ? a : b; }
static inline double tvi_smaller(double a, double b) { return a < b ? a : b; }
/* The number nearer to 0. */
static inline double tvi_shorter(double a, double b) { return fabs(a) < fabs(b) ? a : b; }

/* part / whole; 0 if part is 0. */
static inline double tvi_ratio(double part, double whole) { return part == 0 ? 0 : part / whole; }

#endif
