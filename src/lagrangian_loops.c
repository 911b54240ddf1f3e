/* lagrangian_loops.c - see lagrangian_loops.h. */
#include "lagrangian_loops.h"
#include "lanes.h"
#include "rule.h"

#include <math.h>

#define EACH_LANE for (size_t w = 0; w < (size_t)lanes; w++)

static inline double larger(double a, double b) { return a > b ? a : b; }

/* x <- x / size(x), with what multiplied it. count numbers, one every stride. */
INLINE void set_scale(int count, size_t stride, double *x, double *restrict scale, int lanes)
{
    EACH_LANE scale[w] = 0;
    for (int i = 0; i < count; i++) EACH_LANE scale[w] = larger(fabs(x[(size_t)i * stride + w]), scale[w]);
    EACH_LANE scale[w] = 1 / scale[w];
    for (int i = 0; i < count; i++) EACH_LANE x[(size_t)i * stride + w] *= scale[w];
}

/* Exchanges rows j and `other` of a matrix of so many columns, in one lane. */
INLINE void swap_rows(int columns, double *a, int j, int other, size_t w, int lanes)
{
    const size_t stride = (size_t)lanes, row = (size_t)columns * stride;
    double *x = a + (size_t)j * row + w, *y = a + (size_t)other * row + w;
    for (size_t k = 0; k < row; k += stride) {
        const double kept = x[k];
        x[k] = y[k];
        y[k] = kept;
    }
}

/* The row of the largest element on or below the diagonal in column j, in each lane, comes to row j. */
INLINE void pivot_column(int n, double *a, int j, int *pivot, int lanes)
{
    const size_t stride = (size_t)lanes, row = (size_t)n * stride;
    const double *column = a + (size_t)j * stride;
    EACH_LANE {
        int largest = j;
        for (int i = j + 1; i < n; i++)
            if (fabs(column[(size_t)i * row + w]) > fabs(column[(size_t)largest * row + w])) largest = i;
        pivot[w] = largest;
        if (largest != j) swap_rows(n, a, j, largest, w, lanes);
    }
}

/* R A C with rows, then columns, of size 1; then L and U in its place, with 1 / U_jj in the diagonal. */
INLINE double factor_lanes(const tvi_lanes_factor *f, int n, int lanes)
{
    const size_t stride = (size_t)lanes, row = (size_t)n * stride;
    double *a = f->lu, least = 1;
    for (int i = 0; i < n; i++) set_scale(n, stride, a + (size_t)i * row, f->row_scale + (size_t)i * stride, lanes);
    for (int j = 0; j < n; j++) set_scale(n, row, a + (size_t)j * stride, f->column_scale + (size_t)j * stride, lanes);
    for (int j = 0; j < n; j++) {
        pivot_column(n, a, j, f->pivot + (size_t)j * stride, lanes);
        double *restrict const upper = a + (size_t)j * row, *restrict const diagonal = upper + (size_t)j * stride;
        EACH_LANE if (!(fabs(diagonal[w]) >= least)) least = fabs(diagonal[w]) > 0 ? fabs(diagonal[w]) : 0;
        EACH_LANE diagonal[w] = 1 / diagonal[w];
        for (int i = j + 1; i < n; i++) {
            double *restrict const lower = a + (size_t)i * row;
            double *restrict const factor = lower + (size_t)j * stride;
            EACH_LANE factor[w] *= diagonal[w];
            for (size_t k = (size_t)(j + 1) * stride; k < row; k += stride)
                EACH_LANE lower[k + w] -= factor[w] * upper[k + w];
        }
    }
    return least;
}

static double factor(const tvi_lanes_factor *f)
{
    double least;
#define CALL(lanes) least = factor_lanes(f, f->n, lanes)
    FOR_LANES(f->lanes, CALL)
#undef CALL
    return least;
}

/* A^-1 = C (R A C)^-1 R. */
INLINE void solve_lanes(const tvi_lanes_factor *f, double *restrict x, int n, int lanes)
{
    const size_t stride = (size_t)lanes, row = (size_t)n * stride;
    const double *a = f->lu;
    for (size_t i = 0; i < row; i++) x[i] *= f->row_scale[i];
    for (int j = 0; j < n; j++)
        EACH_LANE {
            const int other = f->pivot[(size_t)j * stride + w];
            if (other != j) swap_rows(1, x, j, other, w, lanes);
        }
    for (int j = 0; j < n; j++)
        for (int i = j + 1; i < n; i++)
            EACH_LANE x[(size_t)i * stride + w] -=
                a[(size_t)i * row + (size_t)j * stride + w] * x[(size_t)j * stride + w];
    for (int j = n - 1; j >= 0; j--) {
        EACH_LANE x[(size_t)j * stride + w] *= a[(size_t)j * row + (size_t)j * stride + w];
        for (int i = 0; i < j; i++)
            EACH_LANE x[(size_t)i * stride + w] -=
                a[(size_t)i * row + (size_t)j * stride + w] * x[(size_t)j * stride + w];
    }
    for (size_t i = 0; i < row; i++) x[i] *= f->column_scale[i];
}

static void solve(const tvi_lanes_factor *f, double *x)
{
#define CALL(lanes) solve_lanes(f, x, f->n, lanes)
    FOR_LANES(f->lanes, CALL)
#undef CALL
}

INLINE void multiply_lanes(int count, const tvi_second *second, const int output[], const double *x, const double *d,
                           double *restrict out, int lanes)
{
    const size_t stride = (size_t)lanes;
    for (int k = 0; k < count; k++) {
        const double *s = x + (size_t)output[k] * stride;
        const size_t i = (size_t)second[k].row * stride, j = (size_t)second[k].column * stride;
        EACH_LANE out[i + w] += s[w] * d[j + w];
        if (i == j) continue;
        EACH_LANE out[j + w] += s[w] * d[i + w];
    }
}

static void multiply(int lanes, int count, const tvi_second *second, const int output[], const double *x,
                     const double *d, double *out)
{
#define CALL(lanes) multiply_lanes(count, second, output, x, d, out, lanes)
    FOR_LANES(lanes, CALL)
#undef CALL
}

const lagrangian_loops JET_FOR_ISA(lagrangian_loops) = {factor, solve, multiply};
