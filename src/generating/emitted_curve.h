/* emitted_curve.h - the curves of generated code (emit.c), which alone reads this, after the text of seeds.h and
 * curve_step.h and the sweeps of the tapes: the functions of tvi_curve_code for one system and degree. Before it stand
 * CURVE_ADVANCE, which makes the coefficients that are CURVE_RISE orders above the field's, CURVE_TANGENTS, theirs in
 * CURVE_LANES directions and in the CURVE_REST that are left of them, and the sizes of series.h. */
#ifndef TVI_SRC_GENERATING_EMITTED_CURVE_H
#define TVI_SRC_GENERATING_EMITTED_CURVE_H

#include "generating/advance.h"
#include "generating/curve_step.h"
#include "generating/lagrangian_orders.h"
#include "generating/reach.h"
#include "generating/seeds.h"
#include "generating/tangents.h"

/* Order k of a recurrence, of which CURVE_EXPAND and CURVE_DIFFERENTIATE are those of the system's form. */
#define CURVE_EXPAND_EXPLICIT(k)                                                                                       \
    if ((k) + CURVE_RISE <= tvi_series_top) {                                                                          \
        if (!tvi_series_series_of(x, (k))) status = TVI_EDOMAIN;                                                       \
        CURVE_ADVANCE(&of, (k));                                                                                       \
    }
#define CURVE_EXPAND_LAGRANGIAN(k)                                                                                     \
    if (status == TVI_OK) status = orders_expand(curve, (k));
#define CURVE_DIFFERENTIATE_EXPLICIT(k)                                                                                \
    if ((k) + CURVE_RISE <= tvi_series_top) {                                                                          \
        tvi_series_tangents_of(x, dx, (k), (int)block.lanes);                                                          \
        CURVE_TANGENTS(&tangents, (k), (int)block.lanes);                                                              \
    }
#define CURVE_DIFFERENTIATE_LAGRANGIAN(k)                                                                              \
    if (status == TVI_OK) orders_differentiate(curve, &block, (k));

/* TVI_EDOMAIN, TVI_ESINGULAR; else finite or not. */
#define CURVE_EMITTED_EXPAND(NAME)                                                                                     \
    static tvi_status NAME##_series(tvi_curve *curve)                                                                  \
    {                                                                                                                  \
        const size_t order = (size_t)tvi_series.slots;                                                                 \
        double *const x = curve->x;                                                                                    \
        const tvi_recurrence of = {CURVE_N, order, NAME##_output, x, curve->kappa, curve->tau};                        \
        tvi_status status = TVI_OK;                                                                                    \
        (void)of;                                                                                                      \
        tvi_series_ORDERS(CURVE_EXPAND) return status;                                                                 \
    }                                                                                                                  \
    static tvi_status NAME##_expand(tvi_curve *curve)                                                                  \
    {                                                                                                                  \
        const tvi_status status = NAME##_series(curve);                                                                \
        return status != TVI_OK || curve_is_finite(curve) ? status : TVI_ENONFINITE;                                   \
    }

#define CURVE_EMITTED_SUMS(NAME)                                                                                       \
    static void NAME##_sizes(const tvi_curve *curve, double size[]) { curve_sizes(curve, size); }                      \
    static void NAME##_sum(const tvi_curve *curve, const tvi_combination *combination, double out[])                   \
    {                                                                                                                  \
        curve_sum(curve, combination, out);                                                                            \
    }                                                                                                                  \
    static void NAME##_measure(const tvi_curve *curve) { curve_measure(curve); }                                       \
    static double NAME##_tail(const tvi_curve *curve) { return curve_tail(curve); }

#define CURVE_EMITTED_REACH(NAME)                                                                                      \
    static double NAME##_reach(const tvi_curve *curve, double log_tolerance)                                           \
    {                                                                                                                  \
        return curve_reach(curve, log_tolerance);                                                                      \
    }                                                                                                                  \
    static void NAME##_end_at(tvi_curve *curve, double factor, double q[], double u[])                                 \
    {                                                                                                                  \
        curve_end_at(curve, factor, q, u);                                                                             \
    }                                                                                                                  \
    static double NAME##_change(const tvi_curve *curve) { return curve_change(curve); }

#define CURVE_EMITTED_MATRICES(NAME)                                                                                   \
    static void NAME##_sum_jacobian(const tvi_curve *curve, const tvi_combination *combination, double matrix[])       \
    {                                                                                                                  \
        curve_sum_jacobian(curve, combination, matrix);                                                                \
    }                                                                                                                  \
    static void NAME##_push(const tvi_curve *curve, const tvi_combination *combination, double out[])                  \
    {                                                                                                                  \
        curve_push(curve, combination, out);                                                                           \
    }                                                                                                                  \
    static void NAME##_pull(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[])              \
    {                                                                                                                  \
        curve_pull(curve, seed_Q, seed_U, out);                                                                        \
    }

#define CURVE_EXPAND_ALL(k)                                                                                            \
    CURVE_EXPAND(k)                                                                                                    \
    CURVE_DIFFERENTIATE(k)

/* The whole series, each order with that of its tangents in all directions, which do not wait for each other. */
#define CURVE_EMITTED_EXPAND_ALL(NAME)                                                                                 \
    static tvi_status NAME##_series_and_tangents(tvi_curve *curve)                                                     \
    {                                                                                                                  \
        const size_t order = (size_t)tvi_series.slots;                                                                 \
        double *const x = curve->x, *const dx = curve->dx;                                                             \
        const tvi_recurrence of = {CURVE_N, order, NAME##_output, x, curve->kappa, curve->tau},                        \
                             tangents = {CURVE_N, order * CURVE_LANES, NAME##_output, dx, curve->kappa, curve->tau};   \
        const curve_block block = {CURVE_LANES, order * CURVE_LANES, 0};                                               \
        tvi_status status = TVI_OK;                                                                                    \
        (void)of, (void)tangents;                                                                                      \
        curve_begin_block(curve, &block);                                                                              \
        tvi_series_ORDERS(CURVE_EXPAND_ALL) curve_end_block(curve, &block);                                            \
        return status;                                                                                                 \
    }                                                                                                                  \
    static void NAME##_differentiate(tvi_curve *curve) { (void)NAME##_series_and_tangents(curve); }

/* Blocks of all directions, in the order of them. */
#define CURVE_EMITTED_BLOCK(NAME, LANES)                                                                               \
    static void NAME##_differentiate_##LANES(tvi_curve *curve, int first)                                              \
    {                                                                                                                  \
        const size_t order = (size_t)(tvi_series.slots * LANES);                                                       \
        const double *const x = curve->x;                                                                              \
        double *const dx = curve->dx;                                                                                  \
        const tvi_recurrence tangents = {CURVE_N, order, NAME##_output, dx, curve->kappa, curve->tau};                 \
        const curve_block block = {LANES, order, 2 * CURVE_N > LANES ? first : 0};                                     \
        const tvi_status status = TVI_OK; /* of the curve, which has been expanded */                                  \
        (void)x, (void)tangents, (void)status;                                                                         \
        curve_begin_block(curve, &block);                                                                              \
        tvi_series_ORDERS(CURVE_DIFFERENTIATE) curve_end_block(curve, &block);                                         \
    }
#define CURVE_EMITTED_DIFFERENTIATE(NAME)                                                                              \
    static void NAME##_differentiate(tvi_curve *curve)                                                                 \
    {                                                                                                                  \
        int first = 0;                                                                                                 \
        for (; first == 0 || first + CURVE_LANES <= 2 * CURVE_N; first += CURVE_LANES)                                 \
            NAME##_differentiate_CURVE_LANES(curve, first);                                                            \
        if (CURVE_REST > 0) {                                                                                          \
            NAME##_differentiate_CURVE_REST(curve, first);                                                             \
        }                                                                                                              \
    }

/* After the text of products.h. */
#define CURVE_EMITTED_PRODUCTS(NAME)                                                                                   \
    static void NAME##_aim(tvi_curve *curve, const double dz[]) { products_aim(curve, dz); }                           \
    static void NAME##_push(const tvi_curve *curve, const tvi_combination *combination, double out[])                  \
    {                                                                                                                  \
        products_push(curve, combination, out);                                                                        \
    }                                                                                                                  \
    static tvi_status NAME##_close(tvi_closure *c, const double z[], const double scale[], tvi_stats *stats)           \
    {                                                                                                                  \
        return products_close(c, z, scale, stats);                                                                     \
    }                                                                                                                  \
    static tvi_status NAME##_solve(tvi_closure *c, const tvi_transposed *a) { return products_solve(c, a); }           \
    static void NAME##_correct(tvi_closure *c, double correction[]) { products_correct(c, correction); }               \
    static void NAME##_begin(tvi_closure *c) { products_begin(c); }                                                    \
    static const tvi_solver NAME##_solver = {                                                                          \
        .begin = NAME##_begin, .close = NAME##_close, .solve = NAME##_solve, .correct = NAME##_correct};

/* NAME_shape: the sizes of the action. */
#define CURVE_EMITTED_SEED(NAME)                                                                                       \
    JET_INLINE void NAME##_size_action(tvi_action *action)                                                             \
    {                                                                                                                  \
        action->is_hamilton = NAME##_shape.is_hamilton;                                                                \
        action->truncated = NAME##_shape.truncated;                                                                    \
        action->has_velocity_defect = NAME##_shape.has_velocity_defect;                                                \
        action->has_momentum_defect = NAME##_shape.has_momentum_defect;                                                \
        action->q_degree = NAME##_shape.q_degree;                                                                      \
        action->p_degree = NAME##_shape.p_degree;                                                                      \
        action->points = NAME##_shape.points;                                                                          \
        action->orders = NAME##_shape.orders;                                                                          \
        action->half = NAME##_shape.half;                                                                              \
    }                                                                                                                  \
    static tvi_status NAME##_seed(tvi_action *given, tvi_curve *curve, double seed_Q[], double seed_U[])               \
    {                                                                                                                  \
        tvi_action action = *given;                                                                                    \
        NAME##_size_action(&action);                                                                                   \
        return seeds_plainly(&action, curve, seed_Q, seed_U);                                                          \
    }

#define CURVE_EMITTED_STEP(NAME)                                                                                       \
    static bool NAME##_step(tvi_curve_work *work, double tau, const tvi_origin *origin, double dq[], double dp[],      \
                            tvi_stats *stats)                                                                          \
    {                                                                                                                  \
        static const step_makers makers = {NAME##_series, NAME##_series_and_tangents, NAME##_seed};                    \
        return step_quickly(work, &makers, tau, origin, dq, dp, stats);                                                \
    }

#endif
