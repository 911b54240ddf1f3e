/* emitted_curve.h - the curves of generated code (emit.c), which alone reads this, after the text of seeds.h and
 * tangents.h and the sweeps of the tapes: the functions of tvi_curve_code for one system and degree. Before it stand
 * ADVANCE, which makes the coefficients that are RISE orders above the field's, TANGENTS, theirs in LANES directions,
 * and the sizes N, FORM, INPUTS, USES_TIME. */
#ifndef TVI_SRC_GENERATING_EMITTED_CURVE_H
#define TVI_SRC_GENERATING_EMITTED_CURVE_H

#include "generating/advance.h"
#include "generating/seeds.h"
#include "generating/tangents.h"

#define CURVE_EXPAND(k)                                                                                                \
    if ((k) + RISE <= tvi_series_top) {                                                                                \
        inside &= tvi_series_series_of(curve->x, (k), 1);                                                              \
        ADVANCE(&of, (k));                                                                                             \
    }

#define CURVE_DIFFERENTIATE(k)                                                                                         \
    if ((k) + RISE <= tvi_series_top) {                                                                                \
        tvi_series_tangents_of(curve->x, curve->dx, (k), LANES);                                                       \
        TANGENTS(&of, (k), LANES);                                                                                     \
    }

/* A curve of the system's sizes in the place of one of the library. */
#define CURVE_SIZED(NAME, of)                                                                                          \
    const jet_tape series = {.inputs = tvi_series.inputs,                                                              \
                             .constants = tvi_series.constants,                                                        \
                             .slots = tvi_series.slots,                                                                \
                             .output = (int *)NAME##_output};                                                          \
    const jet_tape values = {.output = (int *)NAME##_values};                                                          \
    const tvi_system system = {.n = N,                                                                                 \
                               .form = FORM,                                                                           \
                               .inputs = INPUTS,                                                                       \
                               .uses_time = USES_TIME,                                                                 \
                               .mass = (of)->system->mass,                                                             \
                               .field_series = (jet_tape *)&series,                                                    \
                               .field_values = (jet_tape *)&values};                                                   \
    tvi_curve sized = *(of);                                                                                           \
    sized.n = N;                                                                                                       \
    sized.top = tvi_series_top;                                                                                        \
    sized.system = &system;                                                                                            \
    if (FORM == TVI_SEPARABLE) sized.dU = 0;

#define CURVE_EMITTED_EXPAND(NAME)                                                                                     \
    static tvi_status NAME##_expand(tvi_curve *curve)                                                                  \
    {                                                                                                                  \
        const size_t order = (size_t)tvi_series.slots;                                                                 \
        const tvi_recurrence of = {N, order, NAME##_output, curve->x, curve->kappa, curve->tau};                       \
        bool inside = true;                                                                                            \
        tvi_series_ORDERS(CURVE_EXPAND) if (!inside) return TVI_EDOMAIN;                                               \
        CURVE_SIZED(NAME, curve)                                                                                       \
        return curve_is_finite(&sized) ? TVI_OK : TVI_ENONFINITE;                                                      \
    }

#define CURVE_EMITTED_SUMS(NAME)                                                                                       \
    static void NAME##_sizes(const tvi_curve *of, double size[])                                                       \
    {                                                                                                                  \
        CURVE_SIZED(NAME, of)                                                                                          \
        curve_sizes(&sized, size);                                                                                     \
    }                                                                                                                  \
    static void NAME##_sum(const tvi_curve *of, const tvi_combination *combination, double out[])                      \
    {                                                                                                                  \
        CURVE_SIZED(NAME, of)                                                                                          \
        curve_sum(&sized, combination, out);                                                                           \
    }                                                                                                                  \
    static void NAME##_measure(const tvi_curve *of)                                                                    \
    {                                                                                                                  \
        CURVE_SIZED(NAME, of)                                                                                          \
        curve_measure(&sized);                                                                                         \
    }                                                                                                                  \
    static double NAME##_tail(const tvi_curve *of)                                                                     \
    {                                                                                                                  \
        CURVE_SIZED(NAME, of)                                                                                          \
        return curve_tail(&sized);                                                                                     \
    }

#define CURVE_EMITTED_MATRICES(NAME)                                                                                   \
    static void NAME##_sum_jacobian(const tvi_curve *of, const tvi_combination *combination, double matrix[])          \
    {                                                                                                                  \
        CURVE_SIZED(NAME, of)                                                                                          \
        curve_sum_jacobian(&sized, combination, matrix);                                                               \
    }                                                                                                                  \
    static void NAME##_push(const tvi_curve *of, const tvi_combination *combination, double out[])                     \
    {                                                                                                                  \
        CURVE_SIZED(NAME, of)                                                                                          \
        curve_push(&sized, combination, out);                                                                          \
    }                                                                                                                  \
    static void NAME##_pull(tvi_curve *of, const double seed_Q[], const double seed_U[], double out[])                 \
    {                                                                                                                  \
        CURVE_SIZED(NAME, of)                                                                                          \
        curve_pull(&sized, seed_Q, seed_U, out);                                                                       \
    }

#define CURVE_EMITTED_DIFFERENTIATE(NAME)                                                                              \
    static void NAME##_differentiate(tvi_curve *curve, int first)                                                      \
    {                                                                                                                  \
        const size_t order = (size_t)(tvi_series.slots * LANES);                                                       \
        const tvi_recurrence of = {N, order, NAME##_output, curve->dx, curve->kappa, curve->tau};                      \
        const curve_block block = {LANES, order, 2 * N > LANES ? first : 0};                                           \
        CURVE_SIZED(NAME, curve)                                                                                       \
        curve_begin_block(&sized, &block);                                                                             \
        tvi_series_ORDERS(CURVE_DIFFERENTIATE) curve_end_block(&sized, &block);                                        \
    }

/* NAME_shape: the sizes of the action. */
#define CURVE_EMITTED_SEED(NAME)                                                                                       \
    static tvi_status NAME##_seed(tvi_action *given, tvi_curve *of, double seed_Q[], double seed_U[])                  \
    {                                                                                                                  \
        CURVE_SIZED(NAME, of)                                                                                          \
        tvi_action action = *given;                                                                                    \
        action.is_hamilton = NAME##_shape.is_hamilton;                                                                 \
        action.truncated = NAME##_shape.truncated;                                                                     \
        action.has_velocity_defect = false;                                                                            \
        action.has_momentum_defect = NAME##_shape.has_momentum_defect;                                                 \
        action.q_degree = NAME##_shape.q_degree;                                                                       \
        action.p_degree = NAME##_shape.p_degree;                                                                       \
        action.points = NAME##_shape.points;                                                                           \
        action.orders = NAME##_shape.orders;                                                                           \
        return seeds_plainly(&action, &sized, seed_Q, seed_U);                                                         \
    }

#endif
