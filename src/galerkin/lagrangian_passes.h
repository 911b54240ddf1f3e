/* lagrangian_passes.h - Makes passes, the iterations that solve the equations of a Galerkin step, for a Lagrangian
 * L(q, v). A pass evaluates the gradient (L_q, L_v) at the nodes of the step and corrects the coordinates, velocities
 * and momenta there (docs/method.md section 5). lagrangian.c calls this file; generated code contains its text. */
#ifndef TVI_SRC_GALERKIN_LAGRANGIAN_PASSES_H
#define TVI_SRC_GALERKIN_LAGRANGIAN_PASSES_H

#include "algebra/sizes.h"
#include "galerkin/blocks.h"
#include "galerkin/loops.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The context of passes: their kernels, nodes, tables and memory. The rows of nodes->values are positions Q, momenta P,
 * velocities V, forces F = L_q, and the change of L_v that the kernel `linearise` computes, n rows each. */
typedef struct {
    const galerkin_kernels *kernels;
    const galerkin_nodes *nodes;
    /* The nodes with other unknowns: the rates V and F, which are the velocities and the forces at the nodes. With them
     * the kernel `predict` extrapolates the rates from the impulses of earlier steps. An impulse is the step size h
     * times a quadrature weight times a rate. To turn sums of impulses into rates, unknown_change_per_impulse is 1/h,
     * and the drift values, to which `predict` adds these sums, are 0. */
    galerkin_nodes nodes_with_rates_as_unknowns;
    /* [j][i] the factor of the impulse of node j in an unknown at node i (coefficients.h) */
    const double *node_impulse_to_node_unknown_matrix;
    const int *rate_row_of_unknown;
    galerkin_derivative_tapes derivative_tapes;
    /* [2n] The slots of the gradient: tape_slot_of_gradient_component[false] is for gradient_block,
     * tape_slot_of_gradient_component[true] for hessian_block. */
    const int *tape_slot_of_gradient_component[2];
    double *q_minus_start_q; /* [n][lanes] Q minus drift_values of the nodes, which are q at the start of the step */
    /* [n][lanes] q at the start of the step (drift_values of the nodes) minus Q at the centres, the points about which
     * the gradient is expanded, since it was evaluated there: a number and its low-order part. */
    double *start_q_minus_expansion_point[2];
    double *gradient_at_centre; /* [2n][lanes] the gradient at the centres */
    /* The Taylor expansion of the gradient about the centres, to first order. */
    lanes_linearised_gradient gradient_linearised_in_q_and_v;
    lanes_matrix_inverse velocity_hessian_inverse; /* the inverse of L_vv at each node */
    /* The function tvi_galerkin_invert_with_row_exchanges, which inverts L_vv if the kernel `invert` fails. Generated
     * code, too, calls it with arrays that the library allocated, velocity_hessian_inverse_with_row_exchanges and
     * velocity_hessian_lu_factor, and not with local arrays. */
    bool (*invert_with_row_exchanges)(const lanes_matrix_inverse *inverse, int lanes, void *lu_factor);
    const lanes_matrix_inverse *velocity_hessian_inverse_with_row_exchanges;
    /* The tvi_lu_factor in which invert_with_row_exchanges factors L_vv of one node after the other. */
    void *velocity_hessian_lu_factor;
    int velocity_hessian_inversions_made; /* the number of times that L_vv was inverted at all nodes */
    /* The movement of the last pass: the sum of the squares of the relative changes of the unknowns. It is infinity
     * before the first pass of a step. */
    double last_pass_movement_square;
} lagrangian_pass_context;

typedef enum {
    LAGRANGIAN_PASSED,
    LAGRANGIAN_OUTSIDE_DOMAIN,
    LAGRANGIAN_NONFINITE,
    LAGRANGIAN_SINGULAR
} lagrangian_pass_result;

/* The square of a relative movement that is only roundoff. A pass makes at least LAGRANGIAN_MIN_ITERATIONS iterations,
 * and ends when an iteration moves the unknowns by no more than this number. */
#define LAGRANGIAN_ROUNDOFF_MOVEMENT_SQUARE (0.25 * DBL_EPSILON * DBL_EPSILON)

static inline double *lagrangian_find_values_row(const galerkin_nodes *nodes, int row)
{
    return nodes->values + row * nodes->lane_count;
}

static inline galerkin_nodes lagrangian_select_half_of_unknowns(const galerkin_nodes *all_nodes, int first_unknown)
{
    galerkin_nodes nodes = *all_nodes;
    const int offset = first_unknown * nodes.lane_count;
    nodes.unknown_count /= 2;
    nodes.moving_unknown_count = nodes.unknown_count;
    nodes.values += offset;
    nodes.drift_values += offset;
    nodes.drift_values_low += offset;
    nodes.impulses += offset;
    nodes.start_values += first_unknown;
    nodes.unknown_change_per_impulse += first_unknown;
    nodes.inverse_unknown_size += first_unknown;
    return nodes;
}

static inline double lagrangian_move_momenta(const lagrangian_pass_context *context)
{
    const int n = context->nodes->unknown_count / 2;
    const galerkin_nodes momenta = lagrangian_select_half_of_unknowns(context->nodes, n);
    return GALERKIN_KERNEL(context->kernels, move, &momenta, context->node_impulse_to_node_unknown_matrix,
                           context->nodes->values, context->rate_row_of_unknown + n);
}

static inline double lagrangian_move_coordinates(const lagrangian_pass_context *context)
{
    const galerkin_nodes positions = lagrangian_select_half_of_unknowns(context->nodes, 0);
    return GALERKIN_KERNEL(context->kernels, move_in_parts, &positions, context->node_impulse_to_node_unknown_matrix,
                           context->nodes->values, context->rate_row_of_unknown, context->q_minus_start_q);
}

/* Moves Q and P by the current rates V and F. */
static inline void lagrangian_move_q_and_p(lagrangian_pass_context *context)
{
    (void)lagrangian_move_momenta(context);
    (void)lagrangian_move_coordinates(context);
    context->last_pass_movement_square = INFINITY;
}

/* Predicts the unknowns from the impulses of earlier steps. `work` is a pointer to lagrangian_pass_context. */
static inline void lagrangian_predict_unknowns(void *work, const galerkin_nodes *nodes,
                                               const galerkin_extrapolation *extrapolation)
{
    lagrangian_pass_context *context = work;
    (void)nodes;
    GALERKIN_KERNEL(context->kernels, predict, &context->nodes_with_rates_as_unknowns, extrapolation);
    lagrangian_move_q_and_p(context);
}

/* The centres, where the gradient is evaluated, are the nodes with their last LAGRANGIAN_ROUNDED_BITS bits rounded
 * away, so that the last passes of a step use the same centres. If the gradient were evaluated at the nodes
 * themselves, its roundoff would change with their last bits. The iteration would stop where that roundoff happens
 * to be small, more often on the side from which the nodes come, and the energy would drift. */
static inline void lagrangian_round_last_bits(int count, const double *values, double *rounded_values)
{
    const uint64_t unit = UINT64_C(1) << LAGRANGIAN_ROUNDED_BITS;
    for (int i = 0; i < count; i++) {
        const uint64_t bits = (tvi_double_bits(values[i]) + unit / 2) & ~(unit - 1);
        memcpy(&rounded_values[i], &bits, sizeof bits);
    }
}

static inline bool lagrangian_evaluate_gradient(lagrangian_pass_context *context, galerkin_sweep *sweep,
                                                bool with_hessian)
{
    const galerkin_nodes *nodes = context->nodes;
    const int lanes = nodes->lane_count, half = nodes->unknown_count / 2 * lanes,
              *output = context->tape_slot_of_gradient_component[with_hessian];
    lagrangian_round_last_bits(half, nodes->values, context->derivative_tapes.gradient_block);
    lagrangian_round_last_bits(half, lagrangian_find_values_row(nodes, nodes->unknown_count),
                               context->derivative_tapes.gradient_block + half);
    const double *x = galerkin_evaluate_gradient(&context->derivative_tapes, sweep, with_hessian);
    if (!x) return false;
    for (int i = 0; i < nodes->unknown_count; i++)
        memcpy(context->gradient_at_centre + i * lanes, x + output[i] * lanes, (size_t)lanes * sizeof *x);
    return true;
}

/* Inverts L_vv at each node, from the second derivatives in hessian_block. */
static inline lagrangian_pass_result lagrangian_invert_velocity_hessian(lagrangian_pass_context *context)
{
    const lanes_linearised_gradient *expansion = &context->gradient_linearised_in_q_and_v;
    const int n = expansion->n, lanes = expansion->lane_count;
    double *a = context->velocity_hessian_inverse.matrix;
    const size_t bytes = (size_t)(n * n * lanes) * sizeof *a;
    memset(a, 0, bytes);
    for (int i = n; i < 2 * n; i++)
        for (int k = expansion->row_end[i - 1]; k < expansion->row_end[i]; k++) {
            const lanes_hessian_element *term = &expansion->hessian_element[k];
            double *element = a + ((i - n) * n + term->column - n) * lanes;
            if (term->column >= n)
                memcpy(element, context->derivative_tapes.hessian_block + term->slot * lanes,
                       (size_t)lanes * sizeof *a);
        }
    context->velocity_hessian_inversions_made++;
    if (GALERKIN_KERNEL(context->kernels, invert, &context->velocity_hessian_inverse)) return LAGRANGIAN_PASSED;
    /* The called function must not get the address of a local array of generated code. Otherwise a compiler would have
     * to assume that other pointers may point to the array, too. */
    memmove(context->velocity_hessian_inverse_with_row_exchanges->matrix, a, bytes);
    if (context->invert_with_row_exchanges(context->velocity_hessian_inverse_with_row_exchanges, lanes,
                                           context->velocity_hessian_lu_factor)) {
        memmove(context->velocity_hessian_inverse.inverse,
                context->velocity_hessian_inverse_with_row_exchanges->inverse, bytes);
        return LAGRANGIAN_PASSED;
    }
    for (int k = expansion->row_end[n - 1]; k < expansion->row_end[2 * n - 1]; k++)
        if (!tvi_all_finite(lanes,
                            context->derivative_tapes.hessian_block + expansion->hessian_element[k].slot * lanes))
            return LAGRANGIAN_NONFINITE;
    return LAGRANGIAN_SINGULAR;
}

/* Makes one iteration within a pass: moves P, V and Q by the current gradient. Returns the movement: the sum of the
 * squares of the relative changes of P and Q. */
static inline double lagrangian_make_inner_iteration(lagrangian_pass_context *context)
{
    const galerkin_nodes *nodes = context->nodes;
    const int n = nodes->unknown_count / 2, half = n * nodes->lane_count;
    const double moved = lagrangian_move_momenta(context);
    GALERKIN_KERNEL(context->kernels, correct_velocities, &context->velocity_hessian_inverse,
                    lagrangian_find_values_row(nodes, n), context->gradient_at_centre + half,
                    lagrangian_find_values_row(nodes, 4 * n), context->derivative_tapes.gradient_block + half,
                    lagrangian_find_values_row(nodes, 2 * n));
    return moved + lagrangian_move_coordinates(context);
}

/* Sets start_q_minus_expansion_point to the exact difference of q at the start and Q at the centres: a number and its
 * low-order part. */
static inline void lagrangian_set_start_q_minus_expansion_point(lagrangian_pass_context *context)
{
    const int half = context->nodes->unknown_count / 2 * context->nodes->lane_count;
    const double *high = context->nodes->drift_values, *from = context->derivative_tapes.gradient_block;
    for (int i = 0; i < half; i++) {
        const double rise = high[i] - from[i], less = high[i] - rise;
        context->start_q_minus_expansion_point[0][i] = rise;
        context->start_q_minus_expansion_point[1][i] = (high[i] - (rise + less)) + (less - from[i]);
    }
}

/* Sets the rows F to L_q at Q and V, and the last n rows to the change of L_v by the displacement of Q, both to first
 * order about the centres (kernel `linearise`). The displacement of Q is a sum of differences, which do not contain the
 * rounding of Q. */
static inline void lagrangian_set_linearised_gradient(lagrangian_pass_context *context)
{
    const galerkin_nodes *nodes = context->nodes;
    const int half = nodes->unknown_count / 2 * nodes->lane_count;
    const double *V = nodes->values + 2 * half, *from = context->derivative_tapes.gradient_block;
    double *moved = context->gradient_linearised_in_q_and_v.displacement;
    for (int i = 0; i < half; i++)
        moved[i] = (context->start_q_minus_expansion_point[0][i] + context->q_minus_start_q[i]) +
                   context->start_q_minus_expansion_point[1][i];
    for (int i = 0; i < half; i++) moved[half + i] = V[i] - from[half + i];
    GALERKIN_KERNEL(context->kernels, linearise, &context->gradient_linearised_in_q_and_v, nodes->values + 3 * half);
}

/* Makes a pass. Evaluates new second derivatives unless the last movement was small enough to reuse the old ones. */
static inline lagrangian_pass_result lagrangian_make_pass(lagrangian_pass_context *context, galerkin_sweep *sweep)
{
    const galerkin_nodes *nodes = context->nodes;
    const int numbers = nodes->unknown_count * nodes->lane_count;
    if (context->last_pass_movement_square <= LAGRANGIAN_HESSIAN_MAX_MOVEMENT * numbers) {
        if (!lagrangian_evaluate_gradient(context, sweep, false)) return LAGRANGIAN_OUTSIDE_DOMAIN;
    } else {
        if (!lagrangian_evaluate_gradient(context, sweep, true)) return LAGRANGIAN_OUTSIDE_DOMAIN;
        const lagrangian_pass_result inverted = lagrangian_invert_velocity_hessian(context);
        if (inverted != LAGRANGIAN_PASSED) return inverted;
    }
    double moved = context->last_pass_movement_square = 0;
    lagrangian_set_start_q_minus_expansion_point(context);
    for (int i = 0; i < LAGRANGIAN_MAX_ITERATIONS; i++) {
        if (i >= LAGRANGIAN_MIN_ITERATIONS && moved <= LAGRANGIAN_ROUNDOFF_MOVEMENT_SQUARE * numbers) break;
        lagrangian_set_linearised_gradient(context);
        context->last_pass_movement_square += moved = lagrangian_make_inner_iteration(context);
    }
    return LAGRANGIAN_PASSED;
}

#endif
