/* sizes.h - the sizes of numbers and arrays. */
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

/* 0 for a finite x, whose x - x is 0, and only for such a one. */
static inline uint64_t tvi_bits_of_infinite(double x) { return tvi_bits(x - x); }

/* Whether all rows [n] are finite: the bits are gathered in any order. */
static inline bool tvi_rows_are_finite(int rows, size_t stride, int n, const double x[])
{
    uint64_t any = 0;
    for (int r = 0; r < rows; r++)
        for (int i = 0; i < n; i++) any |= tvi_bits_of_infinite(x[(size_t)r * stride + (size_t)i]);
    return any == 0;
}

static inline bool tvi_all_finite(int n, const double x[]) { return tvi_rows_are_finite(1, 0, n, x); }

/* max |x_i| over every stride-th of the array, n of them. */
static inline double tvi_largest(int n, const double x[], int stride)
{
    double size = 0;
    for (int i = 0; i < n; i++) {
        const double one = fabs(x[(size_t)i * (size_t)stride]);
        size = one > size ? one : size;
    }
    return size;
}

/* Unlike fmax and fmin no calls: b where one is no number. */
static inline double tvi_larger(double a, double b) { return a > b ? a : b; }
static inline double tvi_smaller(double a, double b) { return a < b ? a : b; }
/* The one nearer to 0. */
static inline double tvi_shorter(double a, double b) { return fabs(a) < fabs(b) ? a : b; }

/* part / whole, where 0 is no part of 0. */
static inline double tvi_ratio(double part, double whole) { return part == 0 ? 0 : part / whole; }

#endif
