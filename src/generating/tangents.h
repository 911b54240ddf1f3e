/* tangents.h - computes the Jacobian matrices of a curve, by blocks of tangents, and multiplies by them. It is part of
 * the text of generated code (emit.c), where every size is a constant. Other files call the functions of curve.h. */
#ifndef TVI_SRC_GENERATING_TANGENTS_H
#define TVI_SRC_GENERATING_TANGENTS_H

#include "generating/series.h"

/* A block holds the tangents of some directions: those of order k of slot i are at dx + k * order + i * lanes. */
typedef struct {
    size_t lanes, order;
    int first;
} curve_block;

/* Returns how many lanes of the block are directions: the last block may be wider. The lanes of several members are one
 * direction, that of each. */
static inline int curve_directions(const tvi_curve *curve, const curve_block *b)
{
    if (curve_width(curve) > 1) return 1;
    const int left = 2 * curve_n(curve) - b->first;
    return left < (int)b->lanes ? left : (int)b->lanes;
}

static inline double *curve_tangent(const tvi_curve *curve, const curve_block *b, int k, int slot)
{
    return curve->dx + (size_t)k * b->order + (size_t)slot * b->lanes;
}

/* Computes out = factor * in, over the lanes. */
static inline void curve_scale_lanes(size_t lanes, double factor, const double *in, double *restrict out)
{
    for (size_t lane = 0; lane < lanes; lane++) out[lane] = factor * in[lane];
}

/* Sets dz to unit vectors, at the inputs that are components of z. */
static inline void curve_seed_directions(tvi_curve *curve, const curve_block *b)
{
    const tvi_form form = curve_form(curve);
    const int n = curve_n(curve);
    for (int d = b->first; d < b->first + curve_directions(curve, b); d++) {
        const bool is_second = d >= n;
        double *row =
            is_second && form == TVI_SEPARABLE ? curve_tangent(curve, b, 1, d - n) : curve_tangent(curve, b, 0, d);
        for (int lane = 0; lane < (int)b->lanes; lane++)
            row[lane] = curve_width(curve) > 1 || b->first + lane == d ? 1 : 0;
        if (is_second && form == TVI_LAGRANGIAN) row[d - b->first] = 1 / curve->tau;
    }
}

/* Clears the inputs that no earlier order gives, except for the direction. All orders of the time and of constants are
 * 0; their place depends on the number of lanes. */
static inline void curve_begin_block(tvi_curve *curve, const curve_block *b)
{
    const size_t inputs = (size_t)curve_inputs(curve) * b->lanes * sizeof(double);
    const size_t others = (size_t)(curve_uses_time(curve) + curve_constants(curve)) * b->lanes * sizeof(double);
    const int given = curve_form(curve) == TVI_SEPARABLE ? 2 : 1;
    for (int k = 0; k < given && k <= curve_top(curve); k++) memset(curve_tangent(curve, b, k, 0), 0, inputs);
    for (int k = 0; k <= curve_top(curve) && curve->lanes != b->lanes; k++)
        memset(curve_tangent(curve, b, k, curve_inputs(curve)), 0, others);
    curve->lanes = b->lanes;
    curve_seed_directions(curve, b);
}

/* Copies a row of tangents of several members, where they are taken. */
static inline void curve_store_taken(const tvi_curve *curve, const double *in, double *restrict out)
{
    const int width = curve_width(curve);
    if (curve->keeps)
        for (int m = 0; m < width; m++) out[m] = curve->is_taken[m] ? in[m] : out[m];
    else curve_scale_lanes((size_t)width, 1, in, out);
}

/* Copies the tangents of a slot for each coefficient and component into columns first .. of a Jacobian. */
static inline void curve_store(const tvi_curve *curve, const curve_block *b, const int slot_of_component[],
                               int first_slot, double *jacobian)
{
    const size_t n = (size_t)curve_n(curve), width = (size_t)curve_width(curve);
    for (int k = 0; k <= curve_top(curve); k++)
        for (size_t i = 0; i < n; i++) {
            const int slot = slot_of_component ? slot_of_component[i] : first_slot + (int)i;
            const double *tangent = curve_tangent(curve, b, k, slot);
            double *out = jacobian + (((size_t)k * n + i) * 2 * n + (size_t)b->first) * width;
            if (width > 1) curve_store_taken(curve, tangent, out);
            else curve_scale_lanes((size_t)curve_directions(curve, b), 1, tangent, out);
        }
}

/* Returns whether generated code reads the Jacobians from the block of tangents. That needs one block with all
 * directions, whose tangents stand in rows. */
static inline bool curve_is_in_place(void) { return CURVE_SIZE(CURVE_IN_PLACE, false); }

static inline void curve_end_block(tvi_curve *curve, const curve_block *b)
{
    const tvi_form form = curve_form(curve);
    const int n = curve_n(curve);
    if (curve_is_in_place()) return;
    if (form == TVI_LAGRANGIAN)
        curve_store(curve, b, CURVE_SIZE(CURVE_SLOT, curve->system->field_series->output) + n, 0, curve->dU);
    if (form == TVI_HAMILTONIAN) curve_store(curve, b, NULL, n, curve->dU);
    curve_store(curve, b, NULL, 0, curve->dQ);
}

static inline const double *curve_jacobians(const tvi_curve *curve, bool of_momentum)
{
    if (curve_is_in_place()) return curve->dx + (of_momentum ? 2 * curve_n(curve) * curve_n(curve) : 0);
    return of_momentum ? curve->dU : curve->dQ;
}

/* Returns the distance from one order of the Jacobian to the next. */
static inline size_t curve_apart(const tvi_curve *curve)
{
    const size_t n = (size_t)curve_n(curve);
    return 2 * n * (curve_is_in_place() ? tvi_curve_slots(curve) : n * (size_t)curve_width(curve));
}

static inline void curve_sum_jacobian(const tvi_curve *curve, const tvi_combination *combination, double matrix[])
{
    CURVE_COMBINE_APART(curve->system->field_series, curve_top(curve) + 1, combination->weight, 1,
                        2 * curve_n(curve) * curve_numbers(curve), curve_apart(curve),
                        curve_jacobians(curve, curve_is_of_momentum(curve, combination)), matrix);
}

#define CURVE_PUSH(V, S)                                                                                               \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        for (int d = 0; d < directions; d++) sum += JET_OF(V, row, d) * JET_OF(V, curve->dz, d);                       \
        JET_AT(V, out, i) = sum;                                                                                       \
    }

static inline void curve_push(const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    const int directions = 2 * curve_n(curve), width = curve_width(curve);
    const size_t stride = (size_t)width;
    curve_sum_jacobian(curve, combination, curve->pushed);
    for (int i = 0; i < curve_n(curve); i++) {
        const double *row = curve->pushed + i * directions * width;
        JET_BLOCKS(width, CURVE_PUSH, );
    }
}

/* Computes out = sum_k J_k^T seed[k], from Jacobians in the block of tangents. */
#define CURVE_PULL(V, S)                                                                                               \
    {                                                                                                                  \
        V sum = {0}, odd = {0};                                                                                        \
        for (int k = curve_top(curve); k >= 0; k--)                                                                    \
            for (int i = 0; i < n; i++) {                                                                              \
                const V term = seed[k * n + i] * JET_OF(V, J + (size_t)k * curve_apart(curve), i);                     \
                if (i % 2 == 0) sum += term;                                                                           \
                else odd += term;                                                                                      \
            }                                                                                                          \
        JET_AT(V, out, 0) = sum + odd;                                                                                 \
    }

/* Computes this sum of each member, in the order of CURVE_COMBINE. */
#define CURVE_PULL_EACH(V, S)                                                                                          \
    {                                                                                                                  \
        V sum = {0}, odd = {0};                                                                                        \
        int r = rows;                                                                                                  \
        for (; r > 1; r -= 2) {                                                                                        \
            sum += JET_OF(V, seed, r - 1) * JET_OF(V, J, (r - 1) * directions + d);                                    \
            odd += JET_OF(V, seed, r - 2) * JET_OF(V, J, (r - 2) * directions + d);                                    \
        }                                                                                                              \
        if (r > 0) sum += JET_OF(V, seed, 0) * JET_OF(V, J, d);                                                        \
        JET_AT(V, out, d) = sum + odd;                                                                                 \
    }
static inline void curve_pull_each(int width, int rows, int directions, const double *seed, const double *J,
                                   double *out)
{
    const size_t stride = (size_t)width;
    for (int d = 0; d < directions; d++) JET_BLOCKS(width, CURVE_PULL_EACH, );
}

static inline void curve_pull_by(const tvi_curve *curve, bool of_momentum, const double seed[], double out[])
{
    const int n = curve_n(curve), directions = 2 * n, rows = (curve_top(curve) + 1) * n;
    const size_t stride = (size_t)directions;
    const double *J = curve_jacobians(curve, of_momentum);
    if (curve_is_in_place()) JET_BLOCKS(directions, CURVE_PULL, );
    else if (curve_width(curve) > 1) curve_pull_each(curve_width(curve), rows, directions, seed, J, out);
    else CURVE_COMBINE(curve->system->field_series, rows, seed, 1, directions, J, out);
}

static inline void curve_pull(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[])
{
    curve_pull_by(curve, false, seed_Q, out);
    if (curve_form(curve) == TVI_SEPARABLE || !seed_U) return;
    curve_pull_by(curve, true, seed_U, curve->by_U);
    for (int d = 0; d < 2 * curve_numbers(curve); d++) out[d] += curve->by_U[d];
}

#endif
