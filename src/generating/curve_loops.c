/* curve_loops.c - see curve_loops.h. */
#include "generating/curve_loops.h"
#include "generating/newton.h"
#include "rule.h"
#include "vector.h"

#include <math.h>

/* Row r of an array, at the block. */
#define ROW(V, x, r)    (*(V *)((x) + (size_t)(r) * (size_t)width + here))
#define OF_ROW(V, x, r) (*(const V *)((x) + (size_t)(r) * (size_t)width + here))
#define LARGER(V, a, b) JET_CHOOSE(V, (a) > (b), a, b)
#define NOTHING(V, x)   (x)

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

/* The vectors of a row stand `part` apart: sums that do not wait for each other, and ask for each weight once. */
#define COMBINE(V, OF)                                                                                                 \
    {                                                                                                                  \
        V sum[PARTS] = {{0}};                                                                                          \
        for (int r = w.rows; r-- > 0;) {                                                                               \
            const double weight = w.weight[(size_t)o * w.per_out + (size_t)r * w.per_row];                             \
            const double *row = x + (size_t)r * stride + here;                                                         \
            if (weight == 0) continue;                                                                                 \
            for (int k = 0; k < parts; k++) sum[k] += weight * OF(V, *(const V *)(row + k * part));                    \
        }                                                                                                              \
        for (int k = 0; k < parts; k++) *(V *)(out + (size_t)o * out_stride + here + k * part) = sum[k];               \
    }

enum { PARTS = 4 };

JET_INLINE void combine_parts(tvi_weights w, size_t stride, int parts, int part, bool sizes, const double *x,
                              size_t out_stride, double *out)
{
    for (int o = 0; o < w.outs; o++)
        if (sizes) JET_EIGHTS(part, COMBINE, JET_ABS)
        else JET_EIGHTS(part, COMBINE, NOTHING)
}

JET_INLINE void combine_all(const tvi_weights *weights, size_t stride, int width, bool sizes, const double *x,
                            size_t out_stride, double *out)
{
    if (width % 32 == 0) combine_parts(*weights, stride, 4, width / 4, sizes, x, out_stride, out);
    else if (width % 16 == 0) combine_parts(*weights, stride, 2, width / 2, sizes, x, out_stride, out);
    else combine_parts(*weights, stride, 1, width, sizes, x, out_stride, out);
}

static void combine(const tvi_weights *weights, size_t stride, int width, const double *x, size_t out_stride,
                    double *out)
{
    combine_all(weights, stride, width, false, x, out_stride, out);
}

static void combine_sizes(const tvi_weights *weights, size_t stride, int width, const double *x, size_t out_stride,
                          double *out)
{
    combine_all(weights, stride, width, true, x, out_stride, out);
}

#define PULL(V, S)                                                                                                     \
    {                                                                                                                  \
        V sum = {0}, odd = {0};                                                                                        \
        int r = rows;                                                                                                  \
        for (; r > 1; r -= 2) {                                                                                        \
            sum += OF_ROW(V, seed, r - 1) * OF_ROW(V, J, d * rows + r - 1);                                            \
            odd += OF_ROW(V, seed, r - 2) * OF_ROW(V, J, d * rows + r - 2);                                            \
        }                                                                                                              \
        if (r > 0) sum += OF_ROW(V, seed, 0) * OF_ROW(V, J, d * rows);                                                 \
        ROW(V, out, d)                                                                                                 \
        = sum + odd;                                                                                                   \
    }

static void pull(int rows, int directions, int width, const double *seed, const double *J, double *out)
{
    for (int d = 0; d < directions; d++) JET_EIGHTS(width, PULL, )
}

#define PUSH(V, S)                                                                                                     \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        for (int d = 0; d < directions; d++) sum += OF_ROW(V, J, d * rows + r) * OF_ROW(V, dz, d);                     \
        ROW(V, out, r)                                                                                                 \
        = sum;                                                                                                         \
    }

static void push(int rows, int directions, int width, const double *J, const double *dz, double *out)
{
    for (int r = 0; r < rows; r++) JET_EIGHTS(width, PUSH, )
}

/* ---- Equations --------------------------------------------------------------------------------------------------- */

/* 1 / pivot stands in the diagonal. */
#define FACTOR(V, S)                                                                                                   \
    for (int j = 0; j < size; j++) {                                                                                   \
        const V pivot = OF_ROW(V, A, j * size + j), inverse = 1.0 / pivot, distance = JET_ABS(V, pivot);               \
        const V nearest = OF_ROW(V, least, 0);                                                                         \
        ROW(V, least, 0)                                                                                               \
        = JET_CHOOSE(V, distance >= nearest, nearest, distance);                                                       \
        ROW(V, A, j *size + j)                                                                                         \
        = inverse;                                                                                                     \
        for (int i = j + 1; i < size; i++) {                                                                           \
            const V factor = OF_ROW(V, A, i * size + j) * inverse;                                                     \
            ROW(V, A, i *size + j)                                                                                     \
            = factor;                                                                                                  \
            for (int k = j + 1; k < size; k++) ROW(V, A, i *size + k)                                                  \
            -= factor * OF_ROW(V, A, j * size + k);                                                                    \
        }                                                                                                              \
    }

static void factor(int size, int width, double *A, double *least) { JET_EIGHTS(width, FACTOR, ) }

#define SOLVE(V, S)                                                                                                    \
    {                                                                                                                  \
        for (int i = 0; i < size; i++)                                                                                 \
            for (int j = 0; j < i; j++) ROW(V, x, i)                                                                   \
        -= OF_ROW(V, lu, i * size + j) * OF_ROW(V, x, j);                                                              \
        for (int i = size; i-- > 0;) {                                                                                 \
            for (int j = i + 1; j < size; j++) ROW(V, x, i)                                                            \
            -= OF_ROW(V, lu, i * size + j) * OF_ROW(V, x, j);                                                          \
            ROW(V, x, i)                                                                                               \
            *= OF_ROW(V, lu, i * size + i);                                                                            \
        }                                                                                                              \
    }

static void solve(int size, int width, const double *lu, double *x) { JET_EIGHTS(width, SOLVE, ) }

#define SOLVE_TRANSPOSED(V, S)                                                                                         \
    {                                                                                                                  \
        for (int i = 0; i < size; i++) {                                                                               \
            for (int j = 0; j < i; j++) ROW(V, x, i)                                                                   \
            -= OF_ROW(V, lu, j * size + i) * OF_ROW(V, x, j);                                                          \
            ROW(V, x, i)                                                                                               \
            *= OF_ROW(V, lu, i * size + i);                                                                            \
        }                                                                                                              \
        for (int i = size; i-- > 0;)                                                                                   \
            for (int j = i + 1; j < size; j++) ROW(V, x, i)                                                            \
        -= OF_ROW(V, lu, j * size + i) * OF_ROW(V, x, j);                                                              \
    }

static void solve_transposed(int size, int width, const double *lu, double *x) { JET_EIGHTS(width, SOLVE_TRANSPOSED, ) }

/* ---- Corrections ------------------------------------------------------------------------------------------------- */

static void subtract(int count, double a, const double *field, double b, const double *other, double *restrict out)
{
    for (int at = 0; at < count; at++) out[at] = a * field[at] - b * other[at];
}

static void close(const tvi_curve_members *of, const tvi_mean_closing *closing)
{
    const int width = of->width, half = of->n * width;
    const double *restrict x = of->D, *restrict y = of->D + half;
    double *restrict from = of->from, *restrict rise = of->rise;
    for (int i = 0; i < of->n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            const double of_q = of->kappa[i] * y[at];
            from[at] = closing->from_q * of_q;
            rise[at] = closing->rise_q * of_q;
            from[half + at] = closing->from_p[0] * x[at] + closing->from_p[1] * y[at];
            rise[half + at] = closing->rise_p[0] * x[at] + closing->rise_p[1] * y[at];
        }
}

static void residual(const tvi_curve_members *of, const double *restrict Q0, const tvi_batch_origin *origin)
{
    const int width = of->width, half = of->n * width;
    const double *q = origin->q, *q_low = origin->q_low, *p = origin->p, *p_low = origin->p_low;
    double *restrict r = of->correction;
    for (int i = 0; i < of->n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            const double kappa = of->kappa[i], of_p = of->from[half + at] - p_low[at];
            r[at] = -(r[at] + ((Q0[at] - q[at]) + (of->from[at] - q_low[at])));
            r[half + at] = -((r[half + at] - kappa * p[at]) + kappa * of_p);
        }
}

#define FILL_SCALE(V, S)                                                                                               \
    for (int first = 0; first < 2 * of->n; first += of->n) {                                                           \
        V largest = {0}, nothing = {0};                                                                                \
        for (const int *i = member; i < end; i++) largest = LARGER(V, OF_ROW(V, of->scale, first + *i), largest);      \
        const V most = JET_CHOOSE(V, largest > nothing, largest, nothing + 1.0);                                       \
        for (const int *at = member; at < end; at++) {                                                                 \
            const int i = first + *at;                                                                                 \
            const V size = OF_ROW(V, of->scale, i), least = TVI_LEAST_SHARE * most;                                    \
            ROW(V, of->scale, i)                                                                                       \
            = JET_CHOOSE(V, size == nothing, most, LARGER(V, least, size));                                            \
        }                                                                                                              \
    }

static void fill_scale(const tvi_curve_members *of)
{
    const int width = of->width, *member = of->parts->member;
    for (int k = 0; k < of->parts->count; k++) {
        const int *const end = of->parts->member + of->parts->end[k];
        JET_EIGHTS(width, FILL_SCALE, )
        member = end;
    }
}

/* What is no number makes the sizes none: x - x is 0 of all others. */
#define MEASURE(V, S)                                                                                                  \
    {                                                                                                                  \
        V relative = OF_ROW(V, of->relative, 0), of_group = OF_ROW(V, of->of_group, 0), nothing = {0};                 \
        for (int first = 0; first < 2 * of->n; first += of->n) {                                                       \
            V largest = {0}, most = {0};                                                                               \
            for (const int *at = member; at < end; at++) {                                                             \
                const int i = first + *at;                                                                             \
                const V x = OF_ROW(V, of->correction, i), size = JET_ABS(V, x), scale = OF_ROW(V, of->scale, i);       \
                const V part = size / scale;                                                                           \
                nothing += x - x;                                                                                      \
                relative = LARGER(V, part, relative);                                                                  \
                largest = LARGER(V, size, largest);                                                                    \
                most = LARGER(V, scale, most);                                                                         \
            }                                                                                                          \
            const V share = largest / most;                                                                            \
            of_group = LARGER(V, share, of_group);                                                                     \
        }                                                                                                              \
        ROW(V, of->relative, 0)                                                                                        \
        = relative + nothing;                                                                                          \
        ROW(V, of->of_group, 0)                                                                                        \
        = of_group + nothing;                                                                                          \
    }

static void measure(const tvi_curve_members *of)
{
    const int width = of->width, *member = of->parts->member;
    for (int m = 0; m < width; m++) of->relative[m] = of->of_group[m] = 0;
    for (int k = 0; k < of->parts->count; k++) {
        const int *const end = of->parts->member + of->parts->end[k];
        JET_EIGHTS(width, MEASURE, )
        member = end;
    }
}

#define MOVE(V, S)                                                                                                     \
    for (int i = 0; i < 2 * of->n; i++) {                                                                              \
        const JET_MASK(V) mask = *(const JET_MASK(V) *)(is_moving + here);                                             \
        const V z = OF_ROW(V, of->z, i), moved = z + OF_ROW(V, of->correction, i);                                     \
        ROW(V, of->z, i)                                                                                               \
        = JET_CHOOSE(V, mask, moved, z);                                                                               \
    }

static void move(const tvi_curve_members *of, const long long *is_moving)
{
    const int width = of->width;
    JET_EIGHTS(width, MOVE, )
}

static void end(const tvi_curve_members *of, const double *curve, const double *change, double *restrict dq,
                double *restrict dp)
{
    const int width = of->width, half = of->n * width;
    for (int i = 0; i < of->n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            dq[at] = (curve[at] + change[at]) + of->rise[at];
            dp[at] = (curve[half + at] + change[half + at]) / of->kappa[i] + of->rise[half + at];
        }
}

const tvi_curve_loops JET_FOR_ISA(tvi_curve_loops) = {combine,    combine_sizes,    pull,     push,  factor,
                                                      solve,      solve_transposed, subtract, close, residual,
                                                      fill_scale, measure,          move,     end};
