/* tangents.h - the Jacobian matrices of a curve, by blocks of tangents, and what is made of them: part of the text of
 * generated code (emit.c), where every size is a constant. All others call the functions of curve.h. */
#ifndef TVI_SRC_GENERATING_TANGENTS_H
#define TVI_SRC_GENERATING_TANGENTS_H

#include "generating/series.h"

/* A block of directions: tangents of order k of slot i are at dx + k * order + i * lanes. */
typedef struct {
    size_t lanes, order;
    int first;
} curve_block;

/* Of which so many are directions: the last block may be wider. */
static inline int curve_directions(const tvi_curve *curve, const curve_block *b)
{
    const int left = 2 * curve_n(curve) - b->first;
    return left < (int)b->lanes ? left : (int)b->lanes;
}

static inline double *curve_tangent(const tvi_curve *curve, const curve_block *b, int k, int slot)
{
    return curve->dx + (size_t)k * b->order + (size_t)slot * b->lanes;
}

/* out = factor * in, over the lanes. */
static inline void curve_scale_lanes(size_t lanes, double factor, const double *in, double *out)
{
    for (size_t lane = 0; lane < lanes; lane++) out[lane] = factor * in[lane];
}

/* dz = unit vectors: where the components of z stand among the inputs. */
static inline void curve_seed_directions(tvi_curve *curve, const curve_block *b)
{
    const tvi_form form = curve_form(curve);
    const int n = curve_n(curve);
    for (int d = b->first; d < b->first + curve_directions(curve, b); d++) {
        const bool is_second = d >= n;
        double *row =
            is_second && form == TVI_SEPARABLE ? curve_tangent(curve, b, 1, d - n) : curve_tangent(curve, b, 0, d);
        for (int lane = 0; lane < (int)b->lanes; lane++) row[lane] = b->first + lane == d ? 1 : 0;
        if (is_second && form == TVI_LAGRANGIAN) row[d - b->first] = 1 / curve->tau;
    }
}

/* Inputs that no order before gives are 0, but for the direction; so are all orders of the time and of constants, which
 * stand where the number of lanes says. */
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

/* Copies the tangents of a slot for each coefficient and component into columns first .. of a Jacobian. */
static inline void curve_store(const tvi_curve *curve, const curve_block *b, const int slot_of_component[],
                               int first_slot, double *jacobian)
{
    const size_t n = (size_t)curve_n(curve);
    for (int k = 0; k <= curve_top(curve); k++)
        for (size_t i = 0; i < n; i++) {
            const int slot = slot_of_component ? slot_of_component[i] : first_slot + (int)i;
            curve_scale_lanes((size_t)curve_directions(curve, b), 1, curve_tangent(curve, b, k, slot),
                              jacobian + ((size_t)k * n + i) * 2 * n + b->first);
        }
}

static inline void curve_end_block(tvi_curve *curve, const curve_block *b)
{
    const tvi_form form = curve_form(curve);
    const int n = curve_n(curve);
    if (form == TVI_LAGRANGIAN)
        curve_store(curve, b, CURVE_SIZE(CURVE_SLOT, curve->system->field_series->output) + n, 0, curve->dU);
    if (form == TVI_HAMILTONIAN) curve_store(curve, b, NULL, n, curve->dU);
    curve_store(curve, b, NULL, 0, curve->dQ);
}

static inline const double *curve_jacobians(const tvi_curve *curve, const tvi_combination *combination)
{
    return curve_is_of_momentum(curve, combination) ? curve->dU : curve->dQ;
}

static inline void curve_sum_jacobian(const tvi_curve *curve, const tvi_combination *combination, double matrix[])
{
    CURVE_COMBINE(curve->system->field_series, curve_top(curve) + 1, combination->weight, 1,
                  2 * curve_n(curve) * curve_n(curve), curve_jacobians(curve, combination), matrix);
}

static inline void curve_push(const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    const int n = curve_n(curve), directions = 2 * n;
    curve_sum_jacobian(curve, combination, curve->pushed);
    for (int i = 0; i < n; i++) {
        double sum = 0;
        for (int d = 0; d < directions; d++) sum += curve->pushed[i * directions + d] * curve->dz[d];
        out[i] = sum;
    }
}

static inline void curve_pull(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[])
{
    const jet_tape *tape = curve->system->field_series;
    const int directions = 2 * curve_n(curve), rows = (curve_top(curve) + 1) * curve_n(curve);
    CURVE_COMBINE(tape, rows, seed_Q, 1, directions, curve->dQ, out);
    if (curve_form(curve) == TVI_SEPARABLE || !seed_U) return;
    CURVE_COMBINE(tape, rows, seed_U, 1, directions, curve->dU, curve->by_U);
    for (int d = 0; d < directions; d++) out[d] += curve->by_U[d];
}

#endif
