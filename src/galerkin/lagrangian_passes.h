/* lagrangian_passes.h - Makes the passes of a Lagrangian's Galerkin curve (lagrangian.c). The library calls kernels
 * through tables; in generated code kernels are inlined, and all sizes are constants. */
#ifndef TVI_SRC_GALERKIN_LAGRANGIAN_PASSES_H
#define TVI_SRC_GALERKIN_LAGRANGIAN_PASSES_H

#include "algebra/sizes.h"
#include "galerkin/blocks.h"
#include "galerkin/loops.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The data of the passes. The rows of nodes->values are Q, P, V, F and L_v, n rows each. */
typedef struct {
    const galerkin_kernels *kernels;
    const galerkin_nodes *nodes;
    /* V and F as unknowns of the predictor, whose values at the start are 0 */
    galerkin_nodes rate_nodes;
    /* [j][i] the factors of impulses in unknowns (coefficients.h) */
    const double *impulse_matrix;
    const int *rate_row;
    galerkin_tape_blocks tape_blocks;
    /* [2n] The slots of the gradient in values_block (index false) and in hessian_block (index true). */
    const int *gradient_slot[2];
    double *coordinate_displacement; /* [n][lanes] Q minus drift_values of the nodes */
    /* [n][lanes] The drift values minus the centres, which are the points where the gradient was evaluated: a number
     * and its low-order part. */
    double *centre_offset[2];
    double *centre_gradient; /* [2n][lanes] the gradient at the centres */
    /* The Taylor expansion of the gradient about the centres, to first order. */
    lanes_gradient_expansion gradient_expansion;
    lanes_matrix_inverse velocity_hessian_inverse; /* the inverse of L_vv at each node */
    /* Inverts L_vv if the kernel `invert` cannot (tvi_galerkin_invert_with_exchanges), with the tvi_lu_factor and in
     * the arrays of the library. */
    bool (*invert_with_exchanges)(const lanes_matrix_inverse *inverse, int lanes, void *lu_factor);
    const lanes_matrix_inverse *library_inverse;
    void *lu_factor;
    int inversion_count; /* the number of times that L_vv was inverted */
    /* The movement of the last pass, as the kernel `move` measures it, or infinity before the first pass of a step. */
    double last_movement;
} lagrangian_passes;

typedef enum {
    LAGRANGIAN_PASSED,
    LAGRANGIAN_OUTSIDE,
    LAGRANGIAN_NO_NUMBER,
    LAGRANGIAN_SINGULAR
} lagrangian_pass_result;

/* The square of a relative movement that is only roundoff. After it a pass makes no further iteration. */
#define LAGRANGIAN_NOTHING (0.25 * DBL_EPSILON * DBL_EPSILON)

static inline double *lagrangian_values_row(const galerkin_nodes *nodes, int i)
{
    return nodes->values + i * nodes->lanes;
}

static inline galerkin_nodes lagrangian_nodes_of_half(const galerkin_nodes *all_nodes, int first_unknown)
{
    galerkin_nodes nodes = *all_nodes;
    const int offset = first_unknown * nodes.lanes;
    nodes.unknowns /= 2;
    nodes.moving_unknowns = nodes.unknowns;
    nodes.values += offset;
    nodes.drift_values += offset;
    nodes.drift_values_low += offset;
    nodes.impulses += offset;
    nodes.start_values += first_unknown;
    nodes.impulse_scale += first_unknown;
    nodes.inverse_unknown_size += first_unknown;
    return nodes;
}

static inline double lagrangian_move_momenta(const lagrangian_passes *passes)
{
    const int n = passes->nodes->unknowns / 2;
    const galerkin_nodes momenta = lagrangian_nodes_of_half(passes->nodes, n);
    double moved;
    GALERKIN_KERNEL(passes->kernels, move, &momenta, passes->impulse_matrix, passes->nodes->values,
                    passes->rate_row + n, &moved);
    return moved;
}

static inline double lagrangian_move_coordinates(const lagrangian_passes *passes)
{
    const galerkin_nodes positions = lagrangian_nodes_of_half(passes->nodes, 0);
    return GALERKIN_KERNEL(passes->kernels, move_in_parts, &positions, passes->impulse_matrix, passes->nodes->values,
                           passes->rate_row, passes->coordinate_displacement);
}

/* Moves Q and P by the current rates V and F. */
static inline void lagrangian_move_q_and_p(lagrangian_passes *passes)
{
    (void)lagrangian_move_momenta(passes);
    (void)lagrangian_move_coordinates(passes);
    passes->last_movement = INFINITY;
}

/* Predicts the unknowns, as galerkin_pass_functions.predict. `work` is a lagrangian_passes. */
static inline void lagrangian_predict_unknowns(void *work, const galerkin_nodes *nodes,
                                               const galerkin_extrapolation *extrapolation)
{
    lagrangian_passes *passes = work;
    (void)nodes;
    galerkin_predict_rates(passes->kernels, &passes->rate_nodes, extrapolation);
    lagrangian_move_q_and_p(passes);
}

/* The centres, where the gradient is evaluated, are the nodes with their last LAGRANGIAN_ROUNDED_BITS bits rounded
 * away, so that the last passes of a step use the same centres. If the gradient were evaluated at the nodes
 * themselves, its roundoff would change with their last bits. The iteration would stop where that roundoff happens
 * to be small, more often on the side from which the nodes come, and the energy would drift. */
static inline void lagrangian_round_last_bits(int count, const double *nodes, double *rounded_values)
{
    const uint64_t unit = UINT64_C(1) << LAGRANGIAN_ROUNDED_BITS;
    for (int i = 0; i < count; i++) {
        const uint64_t bits = (tvi_double_bits(nodes[i]) + unit / 2) & ~(unit - 1);
        memcpy(&rounded_values[i], &bits, sizeof bits);
    }
}

static inline bool lagrangian_evaluate_gradient(lagrangian_passes *passes, galerkin_sweep *sweep, bool with_hessian)
{
    const galerkin_nodes *nodes = passes->nodes;
    const int lanes = nodes->lanes, half = nodes->unknowns / 2 * lanes, *output = passes->gradient_slot[with_hessian];
    lagrangian_round_last_bits(half, nodes->values, passes->tape_blocks.values_block);
    lagrangian_round_last_bits(half, lagrangian_values_row(nodes, nodes->unknowns),
                               passes->tape_blocks.values_block + half);
    const double *x = galerkin_evaluate_gradient(&passes->tape_blocks, sweep, with_hessian);
    if (!x) return false;
    for (int i = 0; i < nodes->unknowns; i++)
        memcpy(passes->centre_gradient + i * lanes, x + output[i] * lanes, (size_t)lanes * sizeof *x);
    return true;
}

/* Inverts L_vv at each node, from the second derivatives in hessian_block. */
static inline lagrangian_pass_result lagrangian_invert_velocity_hessian(lagrangian_passes *passes)
{
    const lanes_gradient_expansion *expansion = &passes->gradient_expansion;
    const int n = expansion->n, lanes = expansion->lanes;
    double *a = passes->velocity_hessian_inverse.matrix;
    const size_t bytes = (size_t)(n * n * lanes) * sizeof *a;
    memset(a, 0, bytes);
    for (int i = n; i < 2 * n; i++)
        for (int k = expansion->row_end[i - 1]; k < expansion->row_end[i]; k++) {
            const lanes_hessian_element *term = &expansion->hessian_element[k];
            double *element = a + ((i - n) * n + term->column - n) * lanes;
            if (term->column >= n)
                memcpy(element, passes->tape_blocks.hessian_block + term->slot * lanes, (size_t)lanes * sizeof *a);
        }
    passes->inversion_count++;
    if (GALERKIN_KERNEL(passes->kernels, invert, &passes->velocity_hessian_inverse)) return LAGRANGIAN_PASSED;
    /* The called function gets no address of a local array of generated code: compilers would no longer know that other
     * pointers do not point to it. */
    memmove(passes->library_inverse->matrix, a, bytes);
    if (passes->invert_with_exchanges(passes->library_inverse, lanes, passes->lu_factor)) {
        memmove(passes->velocity_hessian_inverse.inverse, passes->library_inverse->inverse, bytes);
        return LAGRANGIAN_PASSED;
    }
    for (int k = expansion->row_end[n - 1]; k < expansion->row_end[2 * n - 1]; k++)
        if (!tvi_all_finite(lanes, passes->tape_blocks.hessian_block + expansion->hessian_element[k].slot * lanes))
            return LAGRANGIAN_NO_NUMBER;
    return LAGRANGIAN_SINGULAR;
}

/* Makes one iteration: it moves P, V and Q by the current gradient. Returns the movement of P and Q. */
static inline double lagrangian_iterate_once(lagrangian_passes *passes)
{
    const galerkin_nodes *nodes = passes->nodes;
    const int n = nodes->unknowns / 2, half = n * nodes->lanes;
    const double moved = lagrangian_move_momenta(passes);
    GALERKIN_KERNEL(passes->kernels, correct, &passes->velocity_hessian_inverse, lagrangian_values_row(nodes, n),
                    passes->centre_gradient + half, lagrangian_values_row(nodes, 4 * n),
                    passes->tape_blocks.values_block + half, lagrangian_values_row(nodes, 2 * n));
    return moved + lagrangian_move_coordinates(passes);
}

/* Sets centre_offset to the drift values minus the centres, in two parts. */
static inline void lagrangian_set_centre_offsets(lagrangian_passes *passes)
{
    const int half = passes->nodes->unknowns / 2 * passes->nodes->lanes;
    const double *high = passes->nodes->drift_values, *from = passes->tape_blocks.values_block;
    for (int i = 0; i < half; i++) {
        const double rise = high[i] - from[i], less = high[i] - rise;
        passes->centre_offset[0][i] = rise;
        passes->centre_offset[1][i] = (high[i] - (rise + less)) + (less - from[i]);
    }
}

/* Computes the gradient to first order at Q and V. The displacement of Q from the centre is computed from Q before
 * it was rounded. */
static inline void lagrangian_expand_gradient(lagrangian_passes *passes)
{
    const galerkin_nodes *nodes = passes->nodes;
    const int half = nodes->unknowns / 2 * nodes->lanes;
    const double *V = nodes->values + 2 * half, *from = passes->tape_blocks.values_block;
    double *moved = passes->gradient_expansion.displacement;
    for (int i = 0; i < half; i++)
        moved[i] = (passes->centre_offset[0][i] + passes->coordinate_displacement[i]) + passes->centre_offset[1][i];
    for (int i = 0; i < half; i++) moved[half + i] = V[i] - from[half + i];
    GALERKIN_KERNEL(passes->kernels, linearise, &passes->gradient_expansion, nodes->values + 3 * half);
}

/* Makes a pass. It evaluates new second derivatives unless the last movement was small enough to reuse the old ones. */
static inline lagrangian_pass_result lagrangian_make_pass(lagrangian_passes *passes, galerkin_sweep *sweep)
{
    const galerkin_nodes *nodes = passes->nodes;
    const int numbers = nodes->unknowns * nodes->lanes;
    if (passes->last_movement <= LAGRANGIAN_HESSIAN_MAX_MOVEMENT * numbers) {
        if (!lagrangian_evaluate_gradient(passes, sweep, false)) return LAGRANGIAN_OUTSIDE;
    } else {
        if (!lagrangian_evaluate_gradient(passes, sweep, true)) return LAGRANGIAN_OUTSIDE;
        const lagrangian_pass_result inverted = lagrangian_invert_velocity_hessian(passes);
        if (inverted != LAGRANGIAN_PASSED) return inverted;
    }
    double moved = passes->last_movement = 0;
    lagrangian_set_centre_offsets(passes);
    for (int i = 0; i < LAGRANGIAN_MAX_ITERATIONS; i++) {
        if (i >= LAGRANGIAN_MIN_ITERATIONS && moved <= LAGRANGIAN_NOTHING * numbers) break;
        lagrangian_expand_gradient(passes);
        passes->last_movement += moved = lagrangian_iterate_once(passes);
    }
    return LAGRANGIAN_PASSED;
}

#endif
