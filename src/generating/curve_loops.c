/* curve_loops.c - computes the loops over members that curve_loops.h declares. */
#include "generating/curve_loops.h"
#include "generating/newton.h"
#include "rule.h"
#include "vector.h"

#include <math.h>

typedef jet_widest vector;
enum { WIDEST = sizeof(vector) / sizeof(double) };

/* This is row r of an array at members `here` to here + WIDEST - 1. */
#define AT_ROW(x, r)       (*(vector *)((x) + (size_t)(r) * (size_t)width + here))
#define OF_ROW(x, r)       (*(const vector *)((x) + (size_t)(r) * (size_t)width + here))
#define EACH_VECTOR(width) for (int here = 0; here < (width); here += WIDEST)

JET_INLINE vector larger(vector a, vector b) { return JET_CHOOSE(jet_widest, a > b, a, b); }
JET_INLINE vector size_of(vector x) { return JET_ABS(jet_widest, x); }

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

enum { PARTS = 4 };

/* Computes sum o of the vectors at x into those at out. The vectors of a row stand `part` apart: there are `parts` sums
 * that do not wait for each other, and that load each weight once. */
JET_INLINE void combine_at(const tvi_weights *w, size_t stride, int parts, int part, bool sizes, const double *x, int o,
                           double *out)
{
    vector sum[PARTS] = {{0}};
    for (int r = w->rows; r-- > 0;) {
        const double weight = w->weight[(size_t)o * w->per_out + (size_t)r * w->per_row], *row = x + (size_t)r * stride;
        if (weight == 0) continue;
        for (int k = 0; k < parts; k++) {
            const vector term = *(const vector *)(row + k * part);
            sum[k] += weight * (sizes ? size_of(term) : term);
        }
    }
    for (int k = 0; k < parts; k++) *(vector *)(out + k * part) = sum[k];
}

JET_INLINE void combine_parts(tvi_weights w, size_t stride, int parts, int part, bool sizes, const double *x,
                              size_t out_stride, double *out)
{
    for (int o = 0; o < w.outs; o++)
        EACH_VECTOR(part) combine_at(&w, stride, parts, part, sizes, x + here, o, out + (size_t)o * out_stride + here);
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

/* Sums in two chains, which do not wait for each other. */
static void pull(int rows, int directions, int width, const double *seed, const double *J, double *out)
{
    for (int d = 0; d < directions; d++) EACH_VECTOR(width)
        {
            vector sum = {0}, odd = {0};
            int r = rows;
            for (; r > 1; r -= 2) {
                sum += OF_ROW(seed, r - 1) * OF_ROW(J, d * rows + r - 1);
                odd += OF_ROW(seed, r - 2) * OF_ROW(J, d * rows + r - 2);
            }
            if (r > 0) sum += OF_ROW(seed, 0) * OF_ROW(J, d * rows);
            AT_ROW(out, d) = sum + odd;
        }
}

static void push(int rows, int directions, int width, const double *J, const double *dz, double *out)
{
    for (int r = 0; r < rows; r++) EACH_VECTOR(width)
        {
            vector sum = {0};
            for (int d = 0; d < directions; d++) sum += OF_ROW(J, d * rows + r) * OF_ROW(dz, d);
            AT_ROW(out, r) = sum;
        }
}

/* ---- Equations --------------------------------------------------------------------------------------------------- */

/* Factors the matrices; the diagonal becomes 1 / pivot. */
static void factor(int size, int width, double *A, double *least)
{
    EACH_VECTOR(width)
    for (int j = 0; j < size; j++) {
        const vector inverse = 1.0 / OF_ROW(A, j * size + j), distance = size_of(OF_ROW(A, j * size + j));
        const vector nearest = OF_ROW(least, 0);
        AT_ROW(least, 0) = JET_CHOOSE(jet_widest, distance >= nearest, nearest, distance);
        AT_ROW(A, j * size + j) = inverse;
        for (int i = j + 1; i < size; i++) {
            const vector part = OF_ROW(A, i * size + j) * inverse;
            AT_ROW(A, i * size + j) = part;
            for (int k = j + 1; k < size; k++) AT_ROW(A, i * size + k) -= part * OF_ROW(A, j * size + k);
        }
    }
}

static void solve(int size, int width, const double *lu, double *x)
{
    EACH_VECTOR(width)
    {
        for (int i = 0; i < size; i++)
            for (int j = 0; j < i; j++) AT_ROW(x, i) -= OF_ROW(lu, i * size + j) * OF_ROW(x, j);
        for (int i = size; i-- > 0;) {
            for (int j = i + 1; j < size; j++) AT_ROW(x, i) -= OF_ROW(lu, i * size + j) * OF_ROW(x, j);
            AT_ROW(x, i) *= OF_ROW(lu, i * size + i);
        }
    }
}

static void solve_transposed(int size, int width, const double *lu, double *x)
{
    EACH_VECTOR(width)
    {
        for (int i = 0; i < size; i++) {
            for (int j = 0; j < i; j++) AT_ROW(x, i) -= OF_ROW(lu, j * size + i) * OF_ROW(x, j);
            AT_ROW(x, i) *= OF_ROW(lu, i * size + i);
        }
        for (int i = size; i-- > 0;)
            for (int j = i + 1; j < size; j++) AT_ROW(x, i) -= OF_ROW(lu, j * size + i) * OF_ROW(x, j);
    }
}

/* ---- Corrections ------------------------------------------------------------------------------------------------- */

static void subtract(int count, double a, const double *field, double b, const double *other, double *restrict out)
{
    for (int at = 0; at < count; at++) out[at] = a * field[at] - b * other[at];
}

static void close(const tvi_curve_members *members, const tvi_mean_closing *closing)
{
    const int width = members->width, half = members->n * width;
    const double *restrict x = members->D, *restrict y = members->D + half;
    double *restrict from = members->from, *restrict rise = members->rise;
    for (int i = 0; i < members->n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            const double of_q = members->kappa[i] * y[at];
            from[at] = closing->from_q * of_q;
            rise[at] = closing->rise_q * of_q;
            from[half + at] = closing->from_p[0] * x[at] + closing->from_p[1] * y[at];
            rise[half + at] = closing->rise_p[0] * x[at] + closing->rise_p[1] * y[at];
        }
}

static void residual(const tvi_curve_members *members, const double *restrict Q0, const tvi_batch_origin *origin)
{
    const int width = members->width, half = members->n * width;
    const double *q = origin->q, *q_low = origin->q_low, *p = origin->p, *p_low = origin->p_low;
    double *restrict r = members->correction;
    for (int i = 0; i < members->n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            const double kappa = members->kappa[i], of_p = members->from[half + at] - p_low[at];
            r[at] = -(r[at] + ((Q0[at] - q[at]) + (members->from[at] - q_low[at])));
            r[half + at] = -((r[half + at] - kappa * p[at]) + kappa * of_p);
        }
}

/* Fills in the scales of the unknowns of a group, which begins at `first`, in a subsystem with these components. */
JET_INLINE void fill_scale_at(double *scale, int first, const int *member, const int *end, int width, int here)
{
    vector largest = {0}, nothing = {0};
    for (const int *i = member; i < end; i++) largest = larger(OF_ROW(scale, first + *i), largest);
    const vector most = JET_CHOOSE(jet_widest, largest > nothing, largest, nothing + 1.0);
    for (const int *i = member; i < end; i++) {
        const vector size = OF_ROW(scale, first + *i), filled = larger(TVI_LEAST_SHARE * most, size);
        AT_ROW(scale, first + *i) = JET_CHOOSE(jet_widest, size == nothing, most, filled);
    }
}

static void fill_scale(const tvi_curve_members *members)
{
    const int width = members->width, *member = members->parts->member;
    for (int k = 0; k < members->parts->count; k++) {
        const int *const end = members->parts->member + members->parts->end[k];
        for (int first = 0; first < 2 * members->n; first += members->n)
            EACH_VECTOR(width) fill_scale_at(members->scale, first, member, end, width, here);
        member = end;
    }
}

/* Measures the corrections of the same group. A correction that is not a number makes both sizes NaN: x - x is 0 for
 * all other x. */
JET_INLINE void measure_at(const tvi_curve_members *members, int first, const int *member, const int *end, int width,
                           int here)
{
    vector relative = OF_ROW(members->relative, 0), largest = {0}, most = {0}, nothing = {0};
    for (const int *i = member; i < end; i++) {
        const vector x = OF_ROW(members->correction, first + *i), scale = OF_ROW(members->scale, first + *i);
        nothing += x - x;
        relative = larger(size_of(x) / scale, relative);
        largest = larger(size_of(x), largest);
        most = larger(scale, most);
    }
    AT_ROW(members->relative, 0) = relative + nothing;
    AT_ROW(members->of_group, 0) = larger(largest / most, OF_ROW(members->of_group, 0)) + nothing;
}

static void measure(const tvi_curve_members *members)
{
    const int width = members->width, *member = members->parts->member;
    for (int m = 0; m < width; m++) members->relative[m] = members->of_group[m] = 0;
    for (int k = 0; k < members->parts->count; k++) {
        const int *const end = members->parts->member + members->parts->end[k];
        for (int first = 0; first < 2 * members->n; first += members->n)
            EACH_VECTOR(width) measure_at(members, first, member, end, width, here);
        member = end;
    }
}

static void move(const tvi_curve_members *members, const long long *is_moving)
{
    const int width = members->width;
    for (int i = 0; i < 2 * members->n; i++) EACH_VECTOR(width)
        {
            const vector z = OF_ROW(members->z, i), moved = z + OF_ROW(members->correction, i);
            const JET_MASK(jet_widest) moves = *(const JET_MASK(jet_widest) *)(is_moving + here);
            AT_ROW(members->z, i) = JET_CHOOSE(jet_widest, moves, moved, z);
        }
}

static void end(const tvi_curve_members *members, const double *curve, const double *change, double *restrict dq,
                double *restrict dp)
{
    const int width = members->width, half = members->n * width;
    for (int i = 0; i < members->n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            dq[at] = (curve[at] + change[at]) + members->rise[at];
            dp[at] = (curve[half + at] + change[half + at]) / members->kappa[i] + members->rise[half + at];
        }
}

const tvi_curve_loops JET_FOR_ISA(tvi_curve_loops) = {combine,    combine_sizes,    pull,     push,  factor,
                                                      solve,      solve_transposed, subtract, close, residual,
                                                      fill_scale, measure,          move,     end};
