/* orders.h - computes one order of a curve and of its tangents. It is part of the text of generated code, where every
 * size is a constant.
 *
 * An order k of a Lagrangian's field is first computed with V_k = 0, which omits the term L_vv V_k of [s^k] L_v. Then
 * the equations are solved for V_k. Last, each slot of the order gets its missing term: its derivatives by the velocity
 * at the centre, which are the same for all orders, times V_k. */
#ifndef TVI_SRC_GENERATING_ORDERS_H
#define TVI_SRC_GENERATING_ORDERS_H

#include "generating/advance.h"
#include "generating/tangents.h"

/* Generated code defines CURVE_FOLLOWS, which tells whether a slot depends on the velocity (emit.c). */
#ifdef CURVE_FOLLOWS
#define ORDERS_UNROLLED JET_UNROLL(32)
#else
#define ORDERS_UNROLLED
#define CURVE_FOLLOWS(slot) true
#endif

/* Returns the first slot that the tape computes; before it are the inputs, the time and the constants. */
static inline int orders_first_computed_slot(const tvi_curve *curve)
{
    return curve_input_count(curve) + curve_uses_time(curve) + curve_constant_count(curve);
}

/* ---- The centre -------------------------------------------------------------------------------------------------- */

/* Computes the derivatives of all slots with respect to the velocity, [slots][n], as tangents of order 0. */
static inline void orders_differentiate_by_velocity(tvi_curve *curve)
{
    const int n = curve_dimension(curve);
    memset(curve->velocity_derivatives, 0,
           (size_t)(orders_first_computed_slot(curve) * n) * sizeof *curve->velocity_derivatives);
    for (int i = 0; i < n; i++) curve->velocity_derivatives[(n + i) * n + i] = 1;
    ORDERS_TANGENTS(curve, curve->velocity_derivatives, 0, n);
}

static inline void orders_copy_velocity_hessian(const tvi_curve *curve)
{
    const int n = curve_dimension(curve);
    for (int i = 0; i < n; i++)
        memcpy(curve->velocity_hessian.lu + i * n, curve->velocity_derivatives + curve_output_slot(curve, n + i) * n,
               (size_t)n * sizeof(double));
}

/* Inverts L_vv at the centre if it is small and needs no row exchanges, and factors it otherwise. */
static inline tvi_status orders_factor_velocity_hessian(tvi_curve *curve)
{
    orders_differentiate_by_velocity(curve);
    orders_copy_velocity_hessian(curve);
    curve->is_hessian_inverted = curve_dimension(curve) <= LINEAR_SMALL &&
                                 linear_unpivoted_invert(curve_dimension(curve), curve->velocity_hessian.lu);
    if (curve->is_hessian_inverted) return TVI_OK;
    orders_copy_velocity_hessian(curve);
    return CURVE_FACTOR(&curve->velocity_hessian);
}

/* ---- Orders of all lanes ----------------------------------------------------------------------------------------- */

#define ORDERS_MULTIPLY_BY_INVERSE(V, S)                                                                               \
    {                                                                                                                  \
        V sum = inverse[0] * JET_OF(V, right_side, 0);                                                                 \
        for (int j = 1; j < n; j++) sum += inverse[j] * JET_OF(V, right_side, j);                                      \
        JET_AT(V, out, 0) = sum;                                                                                       \
    }

/* Computes out = L_vv^-1 right_side, both [n][lanes]. */
static inline void orders_solve_for_velocity(const tvi_curve *curve, int lanes, double right_side[], double out[])
{
    const int n = curve_dimension(curve);
    const size_t stride = (size_t)lanes;
    const double *inverse = curve->velocity_hessian.lu;
    if (curve->is_hessian_inverted) {
        for (int i = 0; i < n; i++, inverse += n, out += lanes) JET_BLOCKS(lanes, ORDERS_MULTIPLY_BY_INVERSE, );
        return;
    }
    for (int lane = 0; lane < lanes; lane++) {
        double *column = curve->column;
        for (int i = 0; i < n; i++) column[i] = right_side[i * lanes + lane];
        CURVE_SOLVE(&curve->velocity_hessian, column);
        for (int i = 0; i < n; i++) out[i * lanes + lane] = column[i];
    }
}

#define ORDERS_ADD_VELOCITY(V, S)                                                                                      \
    {                                                                                                                  \
        V sum = JET_OF(V, row, 0);                                                                                     \
        for (int i = 0; i < n; i++) sum += column[i] * JET_OF(V, velocity, i);                                         \
        JET_AT(V, row, 0) = sum;                                                                                       \
    }

/* Adds the term of V_k to all slots of the order, [slots][lanes], that depend on the velocity. */
static inline void orders_add_velocity_terms(const tvi_curve *curve, int lanes, const double velocity[], double order[])
{
    const int n = curve_dimension(curve), slots = (int)tvi_curve_slot_count(curve);
    const size_t stride = (size_t)lanes;
    ORDERS_UNROLLED for (int slot = orders_first_computed_slot(curve); slot < slots; slot++)
    {
        if (!CURVE_FOLLOWS(slot)) continue;
        const double *column = curve->velocity_derivatives + slot * n;
        double *row = order + slot * lanes;
        JET_BLOCKS(lanes, ORDERS_ADD_VELOCITY, );
    }
}

/* Sets Q_k = tau V_{k-1} / k, and V_k = 0. */
#define ORDERS_ADVANCE_POSITION(V, S)                                                                                  \
    {                                                                                                                  \
        TVI_QUOTIENT(V, JET_AT(V, order, 0), tau *JET_OF(V, before, n), divisor)                                       \
        JET_AT(V, order, n) = (V){0};                                                                                  \
    }

/* Sets right_side to tau [s^{k-1}] L_q / k - [s^k] L_v of component i, which is L_vv V_k. */
#define ORDERS_SET_RIGHT_SIDE(V, S)                                                                                    \
    {                                                                                                                  \
        V part;                                                                                                        \
        TVI_QUOTIENT(V, part, tau *JET_OF(V, before, force), divisor)                                                  \
        JET_AT(V, right_side, 0) = part - JET_OF(V, order, momentum);                                                  \
    }

static inline void orders_advance_position(const tvi_curve *curve, int k, int lanes, const double *before,
                                           double *order)
{
    const int n = curve_dimension(curve);
    const double tau = curve->tau, divisor = k;
    const size_t stride = (size_t)lanes;
    for (int i = 0; i < n; i++, before += lanes, order += lanes) JET_BLOCKS(lanes, ORDERS_ADVANCE_POSITION, );
}

static inline void orders_solve_velocity_order(const tvi_curve *curve, int k, int lanes, const double *before,
                                               double *order)
{
    const int n = curve_dimension(curve);
    const double tau = curve->tau, divisor = k;
    const size_t stride = (size_t)lanes;
    double *right_side = curve->velocity_residual;
    for (int i = 0; i < n; i++, right_side += lanes) {
        const int force = curve_output_slot(curve, i), momentum = curve_output_slot(curve, n + i);
        JET_BLOCKS(lanes, ORDERS_SET_RIGHT_SIDE, );
    }
    orders_solve_for_velocity(curve, lanes, curve->velocity_residual, order + n * lanes);
    if (k < curve_highest_order(curve)) orders_add_velocity_terms(curve, lanes, order + n * lanes, order);
}

/* ---- The recurrence ---------------------------------------------------------------------------------------------- */

/* Computes order k of a Lagrangian's curve. Order 0 may return TVI_EDOMAIN or TVI_ESINGULAR. */
static inline tvi_status orders_expand_lagrangian_order(tvi_curve *curve, int k)
{
    const size_t slots = tvi_curve_slot_count(curve);
    double *order = curve->series_block + (size_t)k * slots;
    if (k == 0) return ORDERS_SERIES(curve, 0) ? orders_factor_velocity_hessian(curve) : TVI_EDOMAIN;
    orders_advance_position(curve, k, 1, order - slots, order);
    (void)ORDERS_SERIES(curve, k);
    orders_solve_velocity_order(curve, k, 1, order - slots, order);
    return TVI_OK;
}

/* Computes order k of the tangents of a Lagrangian's curve. Their recurrence has the same matrix L_vv. */
static inline void orders_differentiate_lagrangian_order(tvi_curve *curve, const curve_tangent_block *block, int k)
{
    const int lanes = (int)block->lanes;
    double *order = curve->tangent_block + (size_t)k * block->order_stride;
    if (k > 0) orders_advance_position(curve, k, lanes, order - block->order_stride, order);
    ORDERS_TANGENTS(curve, curve->tangent_block, k, lanes);
    if (k > 0) orders_solve_velocity_order(curve, k, lanes, order - block->order_stride, order);
}

/* ---- Any form of system ------------------------------------------------------------------------------------------ */

static inline tvi_series_recurrence curve_get_recurrence(const tvi_curve *curve, size_t order, double *block)
{
    return (tvi_series_recurrence){curve_dimension(curve), curve_width(curve), order, curve_output_slots(curve), block,
                                   curve->kappa,           curve->tau};
}

/* Returns whether order k of the field gives a coefficient of the curve. */
static inline bool curve_has_order(const tvi_curve *curve, int k)
{
    return k + (curve_form(curve) == TVI_SEPARABLE ? 2 : 1) <= curve_highest_order(curve);
}

/* Evaluates order k of the field, and computes the coefficients of the curve that follow from it. After a failure the
 * expansion of a Lagrangian's curve ends; other systems continue, because other members may be valid. */
static inline void curve_expand_order(tvi_curve *curve, int k, tvi_status *status)
{
    const tvi_series_recurrence series = curve_get_recurrence(curve, tvi_curve_slot_count(curve), curve->series_block);
    if (curve_form(curve) == TVI_LAGRANGIAN) {
        if (*status == TVI_OK) *status = orders_expand_lagrangian_order(curve, k);
    } else if (curve_has_order(curve, k)) {
        if (!ORDERS_SERIES(curve, k)) *status = TVI_EDOMAIN;
        if (curve_form(curve) == TVI_SEPARABLE) tvi_advance_separable(&series, k);
        else tvi_advance_hamiltonian(&series, k);
    }
}

/* Expands the curve from its centre data. Returns TVI_EDOMAIN, TVI_ESINGULAR, or otherwise TVI_OK, even if coefficients
 * are not finite. */
static inline tvi_status curve_expand_series(tvi_curve *curve)
{
    tvi_status status = TVI_OK;
    for (int k = 0; k <= curve_highest_order(curve); k++) curve_expand_order(curve, k, &status);
    return status;
}

/* Computes order k of the tangents of a block of directions. */
static inline void curve_differentiate_order(tvi_curve *curve, const curve_tangent_block *block, int k)
{
    const tvi_series_recurrence tangents = curve_get_recurrence(curve, block->order_stride, curve->tangent_block);
    const int lanes = (int)block->lanes;
    if (curve_form(curve) == TVI_LAGRANGIAN) {
        orders_differentiate_lagrangian_order(curve, block, k);
    } else if (curve_has_order(curve, k)) {
        ORDERS_TANGENTS(curve, curve->tangent_block, k, lanes);
        if (curve_form(curve) == TVI_SEPARABLE) tvi_advance_separable_tangents(&tangents, k, lanes);
        else tvi_advance_hamiltonian_tangents(&tangents, k, lanes);
    }
}

/* Computes the tangents of the curve last expanded: of one member in blocks of directions, and of several members one
 * direction after the other. */
static inline void curve_differentiate(tvi_curve *curve)
{
    const int directions = 2 * curve_dimension(curve), width = curve_width(curve),
              most = width > 1 ? 1 : TVI_CURVE_LANES;
    for (int first = 0; first < directions; first += most) {
        const int left = directions - first, count = left < most ? left : most;
        const size_t lanes = (size_t)(width * count);
        const curve_tangent_block block = {lanes, tvi_curve_slot_count(curve) * (size_t)count, first};
        curve_clear_tangent_block(curve, &block);
        for (int k = 0; k <= curve_highest_order(curve); k++) curve_differentiate_order(curve, &block, k);
        curve_store_tangent_block(curve, &block);
    }
}

#endif
