/* lagrangian_loops.c - see lagrangian_loops.h. */
#include "galerkin/lagrangian_loops.h"
#include "algebra/sizes.h"
#include "galerkin/lanes.h"
#include "rule.h"

#include <math.h>
#include <string.h>

#define EACH_LANE for (size_t w = 0; w < stride; w++)

/* ---- Factors ----------------------------------------------------------------------------------------------------- */

#define LARGER(V, a, b)            TVI_LARGER_OF_##V(a, b)
#define TVI_LARGER_OF_jet_v1(a, b) ((a) > (b) ? (a) : (b))
#define TVI_LARGER_OF_jet_v2(a, b) JET_CHOOSE(jet_v2, (a) > (b), a, b)
#define TVI_LARGER_OF_jet_v4(a, b) JET_CHOOSE(jet_v4, (a) > (b), a, b)
#define TVI_LARGER_OF_jet_v8(a, b) JET_CHOOSE(jet_v8, (a) > (b), a, b)
/* 0 of what is no number. */
#define SIZE(V, x) LARGER(V, LARGER(V, x, -(x)), (V){0})

/* Element i of a row or a column. */
#define ELEMENT(V, i) (*(V *)(x + (size_t)(i)*apart + here))
#define SCALE(V, S)                                                                                                    \
    {                                                                                                                  \
        V size = {0};                                                                                                  \
        for (int i = 0; i < count; i++) size = LARGER(V, SIZE(V, ELEMENT(V, i)), size);                                \
        JET_AT(V, scale, 0) = 1 / size;                                                                                \
        for (int i = 0; i < count; i++) ELEMENT(V, i) *= JET_OF(V, scale, 0);                                          \
    }

/* x <- x / size(x), with what multiplied it. count numbers, one every `apart`. */
JET_INLINE void set_scale(int count, size_t apart, double *x, double *scale, int lanes)
{
    const size_t stride = (size_t)lanes;
    JET_BLOCKS(lanes, SCALE, );
}

JET_INLINE void exchange(int columns, double *x, double *y, size_t stride)
{
    for (int k = 0; k < columns; k++, x += stride, y += stride) {
        const double kept = *x;
        *x = *y;
        *y = kept;
    }
}

/* Whether an element below the diagonal of column j is larger than it in any lane. */
JET_INLINE bool wants_exchange(const double *column, int n, int j, size_t row, size_t stride)
{
    int larger = 0;
    for (int i = j + 1; i < n; i++) {
        const double *below = column + (size_t)i * row, *diagonal = column + (size_t)j * row;
        JET_IN_VECTORS
        EACH_LANE larger |= fabs(below[w]) > fabs(diagonal[w]);
    }
    return larger;
}

/* The row of the largest element on or below the diagonal of column j comes to row j. */
JET_INLINE void pivot_column(lanes_inverse *f, int j, int lanes)
{
    const size_t stride = (size_t)lanes, row = (size_t)f->n * stride;
    const double *column = f->lu + (size_t)j * stride;
    int *pivot = f->pivot + (size_t)j * stride;
    EACH_LANE pivot[w] = j;
    if (!wants_exchange(column, f->n, j, row, stride)) return;
    f->exchanges = true;
    EACH_LANE
    {
        for (int i = j + 1; i < f->n; i++)
            if (fabs(column[(size_t)i * row + w]) > fabs(column[(size_t)pivot[w] * row + w])) pivot[w] = i;
        if (pivot[w] != j) exchange(f->n, f->lu + (size_t)j * row + w, f->lu + (size_t)pivot[w] * row + w, stride);
    }
}

#define INVERT(V, S)                                                                                                   \
    {                                                                                                                  \
        const V u = JET_OF(V, diagonal, 0), size = SIZE(V, u), before = JET_OF(V, least, 0);                           \
        JET_AT(V, least, 0) = -LARGER(V, -size, -before);                                                              \
        JET_AT(V, diagonal, 0) = 1 / u;                                                                                \
    }

#define ELIMINATE(V, S)                                                                                                \
    {                                                                                                                  \
        const V part = JET_OF(V, lower, j) * JET_OF(V, upper, j);                                                      \
        JET_AT(V, lower, j) = part;                                                                                    \
        for (int k = j + 1; k < f->n; k++) JET_AT(V, lower, k) -= part * JET_OF(V, upper, k);                          \
    }

/* R A C with rows, then columns, of size 1; then L and U in its place, with 1 / U_jj in the diagonal. */
JET_INLINE double factor_lanes(lanes_inverse *f, int lanes)
{
    const size_t stride = (size_t)lanes, row = (size_t)f->n * stride;
    double *const a = f->lu, least[TVI_GALERKIN_MAX_LANES], smallest = 1;
    EACH_LANE least[w] = 1;
    for (size_t i = 0; i < (size_t)f->n; i++) set_scale(f->n, stride, a + i * row, f->row_scale + i * stride, lanes);
    for (size_t j = 0; j < (size_t)f->n; j++) set_scale(f->n, row, a + j * stride, f->column_scale + j * stride, lanes);
    f->exchanges = false;
    for (int j = 0; j < f->n; j++) {
        pivot_column(f, j, lanes);
        double *const upper = a + (size_t)j * row, *const diagonal = upper + (size_t)j * stride;
        JET_BLOCKS(lanes, INVERT, );
        double *lower = upper + row;
        for (int i = j + 1; i < f->n; i++, lower += row) JET_BLOCKS(lanes, ELIMINATE, );
    }
    EACH_LANE smallest = tvi_smaller(least[w], smallest);
    return smallest;
}

/* ---- The inverse: A^-1 = C (R A C)^-1 R -------------------------------------------------------------------------- */

#define UNIT_COLUMN(V, S) JET_AT(V, x, i) = i == column ? JET_OF(V, f->row_scale, i) : (V){0};

#define FORWARD(V, S)                                                                                                  \
    {                                                                                                                  \
        V sum = JET_OF(V, x, i);                                                                                       \
        for (int j = 0; j < i; j++) sum -= JET_OF(V, a, j) * JET_OF(V, x, j);                                          \
        JET_AT(V, x, i) = sum;                                                                                         \
    }

#define BACK(V, S)                                                                                                     \
    {                                                                                                                  \
        V sum = JET_OF(V, x, i);                                                                                       \
        for (int j = i + 1; j < f->n; j++) sum -= JET_OF(V, a, j) * JET_OF(V, x, j);                                   \
        sum *= JET_OF(V, a, i);                                                                                        \
        JET_AT(V, x, i) = sum;                                                                                         \
        JET_AT(V, f->inverse, i * f->n + column) = sum * JET_OF(V, f->column_scale, i);                                \
    }

JET_INLINE void invert_column(lanes_inverse *f, int column, int lanes)
{
    const size_t stride = (size_t)lanes, row = (size_t)f->n * stride;
    double *const x = f->x;
    const double *a = f->lu;
    for (int i = 0; i < f->n; i++) JET_BLOCKS(lanes, UNIT_COLUMN, );
    if (f->exchanges)
        for (size_t j = 0; j < (size_t)f->n; j++)
            EACH_LANE exchange(1, x + j * stride + w, x + (size_t)f->pivot[j * stride + w] * stride + w, stride);
    for (int i = 0; i < f->n; i++, a += row) JET_BLOCKS(lanes, FORWARD, );
    for (int i = f->n - 1; i >= 0; i--) {
        a -= row;
        JET_BLOCKS(lanes, BACK, );
    }
}

/* ---- Without scales and exchanges, of matrices that are plain ---------------------------------------------------- */

/* What stood on the diagonal as a part of the pivot: no less than this, and no more than 1 / this, as in the inverses
 * of algebra/linear_small.h. */
#define LEAST_PLAIN (1.0 / 16)

#define PLAIN_PIVOT(V, S)                                                                                              \
    {                                                                                                                  \
        const V inverse = 1 / JET_OF(V, row, j), part = SIZE(V, JET_OF(V, a, j * f->n + j) * inverse);                 \
        JET_AT(V, worst, 0) = LARGER(V, LARGER(V, LEAST_PLAIN - part, part - 1 / LEAST_PLAIN), JET_OF(V, worst, 0));   \
        for (int k = 0; k < f->n; k++) JET_AT(V, row, k) *= inverse;                                                   \
        JET_AT(V, row, j) = inverse;                                                                                   \
    }

#define PLAIN_OTHER(V, S)                                                                                              \
    {                                                                                                                  \
        const V part = JET_OF(V, other, j);                                                                            \
        JET_AT(V, other, j) = (V){0};                                                                                  \
        for (int k = 0; k < f->n; k++) JET_AT(V, other, k) -= part * JET_OF(V, row, k);                                \
    }

/* Gauss and Jordan's, in the inverse's place; false: some pivot is not plain, and nothing stands there. */
JET_INLINE bool invert_plainly(lanes_inverse *f, int lanes)
{
    const size_t stride = (size_t)lanes, count = (size_t)f->n * stride;
    const double *const a = f->lu;
    double worst[TVI_GALERKIN_MAX_LANES];
    bool is_plain = true;
    memcpy(f->inverse, a, (size_t)f->n * count * sizeof *a);
    EACH_LANE worst[w] = -INFINITY;
    for (int j = 0; j < f->n; j++) {
        double *const row = f->inverse + (size_t)j * count, *other = f->inverse;
        JET_BLOCKS(lanes, PLAIN_PIVOT, );
        for (int i = 0; i < f->n; i++, other += count)
            if (i != j) JET_BLOCKS(lanes, PLAIN_OTHER, );
    }
    EACH_LANE is_plain &= worst[w] < 0;
    return is_plain;
}

JET_INLINE double invert_lanes(lanes_inverse *f, int lanes)
{
    if (invert_plainly(f, lanes)) return 1;
    const double smallest = factor_lanes(f, lanes);
    for (int column = 0; column < f->n; column++) invert_column(f, column, lanes);
    return smallest;
}

#define MISSING(V, S) JET_AT(V, x, i) = (JET_OF(V, P, i) - JET_OF(V, p, i)) - JET_OF(V, change, i);

#define CORRECT(V, S)                                                                                                  \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        for (int j = 0; j < f->n; j++) sum += JET_OF(V, row, j) * JET_OF(V, x, j);                                     \
        JET_AT(V, velocity, i) = JET_OF(V, from, i) + sum;                                                             \
    }

JET_INLINE void correct_lanes(const lanes_inverse *f, const double *P, const double *p, const double *change,
                              const double *from, double *velocity, int lanes)
{
    const size_t stride = (size_t)lanes;
    double *const x = f->x;
    const double *row = f->inverse;
    for (int i = 0; i < f->n; i++) JET_BLOCKS(lanes, MISSING, );
    for (int i = 0; i < f->n; i++, row += (size_t)f->n * stride) JET_BLOCKS(lanes, CORRECT, );
}

/* ---- The gradient to first order --------------------------------------------------------------------------------- */

/* What is small is added up first. */
#define SUM(V, S)                                                                                                      \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        for (int k = begin; k < m->end[i]; k++)                                                                        \
            if (i < m->n || m->term[k].column < m->n)                                                                  \
                sum += JET_OF(V, m->second, m->term[k].slot) * JET_OF(V, m->moved, m->term[k].column);                 \
        if (i < m->n) sum += JET_OF(V, m->gradient, i);                                                                \
        JET_AT(V, out, i) = sum;                                                                                       \
    }

JET_INLINE void linearise_lanes(const lanes_model *m, double *out, int lanes)
{
    const size_t stride = (size_t)lanes;
    _Pragma("GCC unroll 8") /* where the model is of constants; then the sums are, too */
        for (int i = 0, begin = 0; i < 2 * m->n; begin = m->end[i++]) JET_BLOCKS(lanes, SUM, );
}

/* ---- For any number of lanes ------------------------------------------------------------------------------------- */

#ifndef JET_EMITTED
static double invert(lanes_inverse *f)
{
    double smallest;
#define CALL(lanes) smallest = invert_lanes(f, lanes)
    FOR_LANES(f->lanes, CALL)
#undef CALL
    return smallest;
}

static void correct(const lanes_inverse *f, const double *P, const double *p, const double *change, const double *from,
                    double *V)
{
#define CALL(lanes) correct_lanes(f, P, p, change, from, V, lanes)
    FOR_LANES(f->lanes, CALL)
#undef CALL
}

static void linearise(const lanes_model *m, double *out)
{
#define CALL(lanes) linearise_lanes(m, out, lanes)
    FOR_LANES(m->lanes, CALL)
#undef CALL
}

const lagrangian_loops JET_FOR_ISA(tvi_lagrangian_loops) = {invert, correct, linearise};
#endif
