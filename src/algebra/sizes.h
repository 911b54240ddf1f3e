/* sizes.h - Computes the magnitudes of numbers and arrays, and tests whether they are finite. All folders call it. */
#ifndef TVI_SRC_SIZES_H
#define TVI_SRC_SIZES_H

#include "compiler.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Returns the bits of x as an integer. */
static inline uint64_t tvi_double_bits(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* Returns 0 if x is finite, and otherwise another number. An exponent of ones is carried into the bit of the sign. The
 * rounding mode has no effect, as it has on the sign of x - x. */
static inline uint64_t tvi_nonzero_if_nonfinite(double x)
{
    const uint64_t exponent = UINT64_C(0x7ff) << 52, one = UINT64_C(1) << 52;
    return ((tvi_double_bits(x) & exponent) + one) >> 63;
}

/* Tells whether all numbers in rows of n numbers, `stride` apart, are finite. It combines the bits of all numbers,
 * so that compilers can use vectors. */
static inline bool tvi_rows_are_finite(int rows, size_t stride, int n, const double x[])
{
    uint64_t any = 0;
    for (int r = 0; r < rows; r++)
        for (int i = 0; i < n; i++) any |= tvi_nonzero_if_nonfinite(x[(size_t)r * stride + (size_t)i]);
    return any == 0;
}

static inline bool tvi_all_finite(int n, const double x[]) { return tvi_rows_are_finite(1, 0, n, x); }

/* Returns max |x_i| over n numbers that are `stride` apart. */
static inline double tvi_largest_magnitude(int n, const double x[], int stride)
{
    double size = 0;
    for (int i = 0; i < n; i++) {
        const double one = fabs(x[(size_t)i * (size_t)stride]);
        size = one > size ? one : size;
    }
    return size;
}

/* The least size of a quantity that others are divided by. The products of smaller numbers with roundoff have lost
 * digits to underflow, so that they count as no larger than 0. */
static const double TVI_LEAST_SIZE = DBL_MIN / DBL_EPSILON;

/* Return the larger and the smaller of two numbers without the function call that fmax and fmin may need. The result
 * is b if one of them is NaN. */
static inline double tvi_larger(double a, double b) { return a > b ? a : b; }
static inline double tvi_smaller(double a, double b) { return a < b ? a : b; }
/* Returns the one of two numbers that has the smaller magnitude, with its sign. */
static inline double tvi_number_nearer_to_zero(double a, double b) { return fabs(a) < fabs(b) ? a : b; }

/* Returns 1, -1 or 0. */
static inline int tvi_sign(double x) { return (x > 0) - (x < 0); }
/* Returns the number of the interval that is nearest to x. */
static inline double tvi_clamp(double least, double x, double most) { return fmin(fmax(x, least), most); }

/* Returns part / whole, or 0 if part is 0. */
static inline double tvi_ratio_or_zero(double part, double whole) { return part == 0 ? 0 : part / whole; }

/* Returns the rounded sum of a and b, and sets *rest to its exact rounding error (two-sum). */
static inline double tvi_two_sum(double a, double b, double *rest)
{
    const double sum = a + b, part = sum - a;
    *rest = (a - (sum - part)) + (b - part);
    return sum;
}

#endif
