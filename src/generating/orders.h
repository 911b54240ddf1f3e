/* orders.h - computes the coefficients of one order of a curve and of its tangents. curve.c and jacobian.c
 * call it.
 *
 * A Lagrangian's order k needs three computations, with V_k the coefficient k of the velocity. First the field is
 * computed with V_k = 0, which omits the term L_vv V_k of [s^k] L_v. Then the equations are solved for V_k. Last, each
 * slot of the order gets its missing term: its derivatives by the velocity at the centre, which are the same for all
 * orders, times V_k. */
#ifndef TVI_SRC_GENERATING_ORDERS_H
#define TVI_SRC_GENERATING_ORDERS_H

#include "fused.h"
#include "generating/tangents.h"

/* Computes out = x / divisor by a multiplication with the reciprocal of the divisor, which is kept in two parts. The
 * reciprocal is known before x is, so that the following orders wait for x only. The quotient is rounded as by a
 * division, unless it is halfway between two numbers. Without a fused multiply-add the macro divides. */
#ifdef __FMA__
#define TVI_QUOTIENT(V, out, x, divisor)                                                                               \
    {                                                                                                                  \
        const double by = 1 / (divisor), by_low = JET_FMA_OF_NUMBERS(-by, divisor, 1) * by;                            \
        const V zero = {0}, dividend = x;                                                                              \
        out = JET_FMA(V, dividend, by + zero, dividend * by_low);                                                      \
    }
#else
#define TVI_QUOTIENT(V, out, x, divisor) out = (x) / (divisor);
#endif

/* Returns the first slot that the tape computes; before it are the inputs, the time and the constants. */
static inline int orders_get_first_slot_computed_by_tape(const tvi_curve *curve)
{
    return curve_field_input_count(curve) + curve_uses_time(curve) + curve_field_tape_constant_slot_count(curve);
}

/* ---- The centre -------------------------------------------------------------------------------------------------- */

/* Computes the derivatives of all slots with respect to the velocity, [slots][n], as tangents of order 0. */
static inline void orders_differentiate_slots_by_velocity(tvi_curve *curve)
{
    const int n = curve_dimension(curve);
    memset(curve->slot_derivatives_by_velocity, 0,
           (size_t)(orders_get_first_slot_computed_by_tape(curve) * n) * sizeof *curve->slot_derivatives_by_velocity);
    for (int i = 0; i < n; i++) curve->slot_derivatives_by_velocity[(n + i) * n + i] = 1;
    ORDERS_TANGENTS(curve, curve->slot_derivatives_by_velocity, 0, n);
}

static inline void orders_copy_velocity_hessian(const tvi_curve *curve)
{
    const int n = curve_dimension(curve);
    for (int i = 0; i < n; i++)
        memcpy(curve->velocity_hessian.lu + i * n,
               curve->slot_derivatives_by_velocity + curve_field_output_slot(curve, n + i) * n,
               (size_t)n * sizeof(double));
}

/* Factors L_vv at the centre. */
static inline tvi_status orders_factor_velocity_hessian(tvi_curve *curve)
{
    orders_differentiate_slots_by_velocity(curve);
    orders_copy_velocity_hessian(curve);
    return tvi_factor_compute(&curve->velocity_hessian);
}

/* ---- Orders of all lanes ----------------------------------------------------------------------------------------- */

/* Computes out = L_vv^-1 right_side, both [n][lanes]. */
static inline void orders_solve_with_velocity_hessian(const tvi_curve *curve, int lanes, double right_side[],
                                                      double out[])
{
    const int n = curve_dimension(curve);
    for (int lane = 0; lane < lanes; lane++) {
        double *column = curve->right_side_column;
        for (int i = 0; i < n; i++) column[i] = right_side[i * lanes + lane];
        tvi_factor_solve(&curve->velocity_hessian, column);
        for (int i = 0; i < n; i++) out[i * lanes + lane] = column[i];
    }
}

#define ORDERS_ADD_VELOCITY(V, S)                                                                                      \
    {                                                                                                                  \
        V sum = JET_OF(V, row, 0);                                                                                     \
        for (int i = 0; i < n; i++) sum += column[i] * JET_OF(V, velocity_coefficient, i);                             \
        JET_AT(V, row, 0) = sum;                                                                                       \
    }

/* Adds the term with the velocity coefficient V_k to all slots of the order, [slots][lanes], that depend on the
 * velocity. */
static inline void orders_add_velocity_terms_to_slots(const tvi_curve *curve, int lanes,
                                                      const double velocity_coefficient[], double slots_of_order[])
{
    const int n = curve_dimension(curve), slots = (int)tvi_curve_order_stride(curve);
    const size_t stride = (size_t)lanes;
    for (int slot = orders_get_first_slot_computed_by_tape(curve); slot < slots; slot++) {
        const double *column = curve->slot_derivatives_by_velocity + slot * n;
        double *row = slots_of_order + slot * lanes;
        JET_BLOCKS(lanes, ORDERS_ADD_VELOCITY, );
    }
}

/* Sets the coefficient Q_k = tau V_{k-1} / k of the position. V_k is set to 0, and computed later. */
#define ORDERS_SET_POSITION(V, S)                                                                                      \
    {                                                                                                                  \
        TVI_QUOTIENT(V, JET_AT(V, order, 0), tau *JET_OF(V, previous, n), divisor)                                     \
        JET_AT(V, order, n) = (V){0};                                                                                  \
    }

/* Sets right_side to tau [s^{k-1}] L_q / k - [s^k] L_v of component i, which is L_vv V_k. */
#define ORDERS_SET_RIGHT_SIDE(V, S)                                                                                    \
    {                                                                                                                  \
        V part;                                                                                                        \
        TVI_QUOTIENT(V, part, tau *JET_OF(V, previous, force), divisor)                                                \
        JET_AT(V, right_side, 0) = part - JET_OF(V, order, momentum);                                                  \
    }

static inline void orders_set_position_coefficients(const tvi_curve *curve, int k, int lanes, const double *previous,
                                                    double *order)
{
    const int n = curve_dimension(curve);
    const double tau = curve->time_unit, divisor = k;
    const size_t stride = (size_t)lanes;
    for (int i = 0; i < n; i++, previous += lanes, order += lanes) JET_BLOCKS(lanes, ORDERS_SET_POSITION, );
}

static inline void orders_compute_velocity_coefficients(const tvi_curve *curve, int k, int lanes,
                                                        const double *previous, double *order)
{
    const int n = curve_dimension(curve);
    const double tau = curve->time_unit, divisor = k;
    const size_t stride = (size_t)lanes;
    double *right_side = curve->velocity_right_sides;
    for (int i = 0; i < n; i++, right_side += lanes) {
        const int force = curve_field_output_slot(curve, i), momentum = curve_field_output_slot(curve, n + i);
        JET_BLOCKS(lanes, ORDERS_SET_RIGHT_SIDE, );
    }
    orders_solve_with_velocity_hessian(curve, lanes, curve->velocity_right_sides, order + n * lanes);
    if (k < curve_highest_order(curve)) orders_add_velocity_terms_to_slots(curve, lanes, order + n * lanes, order);
}

/* ---- The recurrence ---------------------------------------------------------------------------------------------- */

/* Computes order k of a Lagrangian's curve. Order 0 may return TVI_EDOMAIN or TVI_ESINGULAR. */
static inline tvi_status orders_expand_lagrangian_order(tvi_curve *curve, int k)
{
    const size_t slots = tvi_curve_order_stride(curve);
    double *order = curve->series_block + (size_t)k * slots;
    if (k == 0) return ORDERS_SERIES(curve, 0) ? orders_factor_velocity_hessian(curve) : TVI_EDOMAIN;
    orders_set_position_coefficients(curve, k, 1, order - slots, order);
    (void)ORDERS_SERIES(curve, k);
    orders_compute_velocity_coefficients(curve, k, 1, order - slots, order);
    return TVI_OK;
}

/* Computes order k of the tangents of a Lagrangian's curve. Their recurrence has the same matrix L_vv. */
static inline void orders_compute_lagrangian_tangents(tvi_curve *curve, const curve_tangent_block *block, int k)
{
    const int lanes = (int)block->lane_count;
    double *order = curve->tangent_block + (size_t)k * block->order_stride;
    if (k > 0) orders_set_position_coefficients(curve, k, lanes, order - block->order_stride, order);
    ORDERS_TANGENTS(curve, curve->tangent_block, k, lanes);
    if (k > 0) orders_compute_velocity_coefficients(curve, k, lanes, order - block->order_stride, order);
}

/* ---- The recurrence of separable systems and of Hamiltonians ----------------------------------------------------- */

/* ORDERS_SET_SEPARABLE sets Q_{k+2}, and ORDERS_SET_HAMILTONIAN sets Q_{k+1} and P_{k+1}. Both store whole vectors,
 * since the next orders load whole vectors: a load that covers several short stores has to wait for the cache. */
#define ORDERS_SET_SEPARABLE(V, S)                                                                                     \
    TVI_QUOTIENT(V, JET_AT(V, next, 0), JET_OF(V, kappa, 0) * JET_GATHER(V, field, output + here) * tau, divisor)
#define ORDERS_SET_HAMILTONIAN(V, S)                                                                                   \
    {                                                                                                                  \
        TVI_QUOTIENT(V, JET_AT(V, q, 0), JET_GATHER(V, field, output + n + here) * tau, divisor)                       \
        TVI_QUOTIENT(V, JET_AT(V, p, 0), JET_GATHER(V, field, output + here) * -tau, divisor)                          \
    }

/* The coefficients are divided by k, and not tau: tau / k would have the same roundoff in every step, and the energy
 * would drift (docs/method.md section 6). For this reason tau^2 / m is computed as kappa tau. */
static inline void orders_compute_separable_coefficients(const tvi_curve *curve, int k)
{
    enum { stride = 0 };
    const int n = curve_dimension(curve), *output = curve_field_output_slots(curve);
    const double divisor = (k + 1) * (k + 2), tau = curve->time_unit, *kappa = curve->momentum_scale_factor,
                 *field = tvi_curve_field_inputs_of_order(curve, k);
    double *next = tvi_curve_field_inputs_of_order(curve, k + 2);
    JET_BLOCKS(n, ORDERS_SET_SEPARABLE, );
}

static inline void orders_compute_hamiltonian_coefficients(const tvi_curve *curve, int k)
{
    enum { stride = 0 };
    const int n = curve_dimension(curve), *output = curve_field_output_slots(curve);
    const double divisor = k + 1, tau = curve->time_unit, *field = tvi_curve_field_inputs_of_order(curve, k);
    double *q = tvi_curve_field_inputs_of_order(curve, k + 1), *p = q + n;
    JET_BLOCKS(n, ORDERS_SET_HAMILTONIAN, );
}

/* Computes next = factor * field, of one component's tangents in `lanes` directions, in whole vectors, since the next
 * orders load vectors. Tangents only give small corrections, so that their factor may contain the rounded tau / k. */
#define ORDERS_SET_TANGENT(V, S) JET_AT(V, next, 0) = factor * JET_OF(V, field, 0);
static inline void orders_compute_tangent_row(int lanes, double factor, const double *field, double *next)
{
    enum { stride = 0 };
    JET_BLOCKS(lanes, ORDERS_SET_TANGENT, );
}

static inline void orders_compute_separable_tangents(const tvi_curve *curve, const curve_tangent_block *block, int k)
{
    const int lanes = (int)block->lane_count, *output = curve_field_output_slots(curve);
    const double factor = curve->time_unit / ((k + 1) * (k + 2)), *field = curve_tangent_row(curve, block, k, 0);
    double *next = curve_tangent_row(curve, block, k + 2, 0);
    for (int i = 0; i < curve_dimension(curve); i++)
        orders_compute_tangent_row(lanes, curve->momentum_scale_factor[i] * factor, field + output[i] * lanes,
                                   next + i * lanes);
}

static inline void orders_compute_hamiltonian_tangents(const tvi_curve *curve, const curve_tangent_block *block, int k)
{
    const int n = curve_dimension(curve), lanes = (int)block->lane_count, *output = curve_field_output_slots(curve);
    const double factor = curve->time_unit / (k + 1), *field = curve_tangent_row(curve, block, k, 0);
    double *next = curve_tangent_row(curve, block, k + 1, 0);
    for (int i = 0; i < n; i++) {
        orders_compute_tangent_row(lanes, factor, field + output[n + i] * lanes, next + i * lanes);
        orders_compute_tangent_row(lanes, -factor, field + output[i] * lanes, next + (n + i) * lanes);
    }
}

/* ---- Any form of system ------------------------------------------------------------------------------------------ */

/* Returns whether order k of the field is needed, because a coefficient of the curve follows from it. */
static inline bool curve_needs_field_order(const tvi_curve *curve, int k)
{
    return k + (curve_system_form(curve) == TVI_SEPARABLE ? 2 : 1) <= curve_highest_order(curve);
}

/* Evaluates order k of the field, and computes the coefficients of the curve that follow from it. After a failure the
 * expansion of a Lagrangian's curve ends; other systems continue, and the caller leaves the curve. */
static inline void curve_expand_order(tvi_curve *curve, int k, tvi_status *status)
{
    if (curve_system_form(curve) == TVI_LAGRANGIAN) {
        if (*status == TVI_OK) *status = orders_expand_lagrangian_order(curve, k);
    } else if (curve_needs_field_order(curve, k)) {
        if (!ORDERS_SERIES(curve, k)) *status = TVI_EDOMAIN;
        if (curve_system_form(curve) == TVI_SEPARABLE) orders_compute_separable_coefficients(curve, k);
        else orders_compute_hamiltonian_coefficients(curve, k);
    }
}

/* Expands the curve from its centre state. Returns TVI_EDOMAIN, TVI_ESINGULAR, or otherwise TVI_OK, even if
 * coefficients are not finite. */
static inline tvi_status curve_expand_series(tvi_curve *curve)
{
    tvi_status status = TVI_OK;
    for (int k = 0; k <= curve_highest_order(curve); k++) curve_expand_order(curve, k, &status);
    return status;
}

/* Computes order k of the tangents of a block of directions. */
static inline void curve_compute_tangents_of_order(tvi_curve *curve, const curve_tangent_block *block, int k)
{
    if (curve_system_form(curve) == TVI_LAGRANGIAN) {
        orders_compute_lagrangian_tangents(curve, block, k);
    } else if (curve_needs_field_order(curve, k)) {
        ORDERS_TANGENTS(curve, curve->tangent_block, k, (int)block->lane_count);
        if (curve_system_form(curve) == TVI_SEPARABLE) orders_compute_separable_tangents(curve, block, k);
        else orders_compute_hamiltonian_tangents(curve, block, k);
    }
}

/* Computes the tangents of the curve last expanded, in blocks of directions. */
static inline void curve_compute_jacobians(tvi_curve *curve)
{
    const int directions = 2 * curve_dimension(curve);
    for (int first = 0; first < directions; first += CURVE_TANGENT_DIRECTIONS) {
        const int left = directions - first, count = left < CURVE_TANGENT_DIRECTIONS ? left : CURVE_TANGENT_DIRECTIONS;
        const curve_tangent_block block = {(size_t)count, tvi_curve_order_stride(curve) * (size_t)count, first};
        curve_prepare_tangent_block(curve, &block);
        for (int k = 0; k <= curve_highest_order(curve); k++) curve_compute_tangents_of_order(curve, &block, k);
        curve_store_jacobians_from_tangents(curve, &block);
    }
}

#endif
