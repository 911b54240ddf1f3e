/* loops.h - Declares the kernels of the Galerkin curve: loops over unknowns and nodes, which take all the time of a
 * step except that of the field. They are compiled once for each instruction set (ad/vector.h). Arrays of nodes have
 * lane_count elements. If there are more lanes than nodes, the last node is repeated, with weight 0. */
#ifndef TVI_SRC_GALERKIN_LOOPS_H
#define TVI_SRC_GALERKIN_LOOPS_H

#include "algebra/passes.h"
#include "algebra/subsystems.h"
#include "algebra/tail.h"
#include "method/origin.h"

#include <stdbool.h>
#include <stddef.h>

/* A table of kernels is compiled for each number of lanes: 1, 2, 4, 8 and TVI_GALERKIN_MAX_LANES. */
enum { TVI_GALERKIN_MAX_LANES = 12, GALERKIN_KERNEL_TABLE_COUNT = 5 };
/* The number of steps whose impulses are stored: the last two steps and the current step. */
enum { GALERKIN_RING_LENGTH = 3 };

/* Measures of how the passes of a step converged, from which the convergence of the next step is estimated. The
 * movement of a pass is the sum of the squares of the changes of the unknowns, relative to their sizes (kernel `move`).
 * A measure is 0 if it is unknown. */
typedef struct {
    /* the largest ratio of the movements of two successive passes */
    double largest_contraction_ratio;
    /* the movement of the first pass, which shows the error of the prediction */
    double first_movement_square;
} galerkin_convergence;

/* The impulses of earlier steps, and the tables of factors that predict the unknowns of a step from them. Usually both
 * of the last two steps are used, with two_step_extrapolation [2][j][i], whose second half belongs to the earlier step.
 * With uses_last_step_only it is the last step alone, with last_step_extrapolation [j][i]. */
typedef struct {
    const double *two_step_extrapolation, *last_step_extrapolation, *last_impulses, *impulses_before;
    /* true if no earlier step has the same size, or the prediction of the last step was rough */
    bool uses_last_step_only;
} galerkin_extrapolation;

/* The weights of the impulses in the sums over the nodes of a step (galerkin_impulse_sums), [lanes] each:
 * one_minus_abscissa is 1 - c_j, with the abscissa c_j of node j, and last_term_weight gives the last term of the
 * rate's Legendre series. */
typedef struct {
    double *one_minus_abscissa, *last_term_weight;
} galerkin_double_integral_and_tail_weights;

/* The sums of a step's impulses over its nodes, [unknowns] each. The impulse of node j is L_j = h b_j
 * F_j, with the step size h, the quadrature weight b_j and the rate F_j of the unknown. Each array has room for seven
 * more numbers, so that a vector can be stored at the last element. rate_integral = sum_j L_j is the quadrature of the
 * rate over the step; rate_double_integral = sum_j (1 - c_j) L_j, with the abscissa c_j of the node, is that of its
 * double integral, divided by h; last_term is the magnitude of the last term of the rate's Legendre series;
 * end_impulse_size is |L_j| of the first node plus that of the last node. */
typedef struct {
    double *rate_integral, *rate_double_integral, *last_term, *end_impulse_size, *rate_integral_low,
        *rate_double_integral_low;
} galerkin_impulse_sums;

/* The quantities from which the tail of a step is computed: the last term of the polynomial of the rates, relative to
 * the momentum or the movement (algebra/tail.h). */
typedef struct {
    int n;
    /* is_separable: the equations are Q'' = F. has_masses: the share of a component in the motion is computed from its
     * movement alone, without its momentum (tvi_system.has_tail_shares_without_momenta). */
    bool is_separable, has_masses;
    tvi_subsystems subsystems;
    galerkin_impulse_sums impulse_sums_over_nodes;
    /* The reciprocal of the quadrature weight b_j of the first and the last node. */
    double inverse_weight_of_end_nodes;
    /* [n] The factors by which the sums of impulses are multiplied in the equations of the unknowns (galerkin_nodes),
     * and the reciprocals of their magnitudes. */
    double *unknown_change_per_impulse, *inverse_unknown_change_per_impulse;
    /* [n] q and p at the start of the step, and the increment of p. */
    const double *start_q, *start_p, *momentum_increment;
    /* [n] Scratch space: the share of each component in the motion of its subsystem
     * (tvi_component_share_of_step_motion), and the ratio of its last term to its momentum or movement
     * (tvi_largest_relative_last_series_term). */
    double *component_share_of_subsystem_motion, *component_tail_ratio;
} galerkin_tail_inputs;

/* Returns the magnitudes of component i from which its tail is computed. coordinate_index and momentum_index are the
 * indices of its coordinate and its momentum in the arrays. */
static inline tvi_component_sizes_in_step galerkin_compute_component_sizes(const galerkin_tail_inputs *inputs, int i,
                                                                           size_t coordinate_index,
                                                                           size_t momentum_index)
{
    const double *last = inputs->impulse_sums_over_nodes.last_term,
                 *end_size = inputs->impulse_sums_over_nodes.end_impulse_size;
    tvi_component_sizes_in_step component = {.momentum_size =
                                                 fabs(inputs->start_p[coordinate_index]) +
                                                 (fabs(inputs->momentum_increment[coordinate_index]) +
                                                  end_size[momentum_index] * inputs->inverse_weight_of_end_nodes),
                                             .p_change_by_last_term = last[momentum_index],
                                             .q_change_by_last_term = inputs->is_separable ? 0 : last[coordinate_index],
                                             .coordinate_size = fabs(inputs->start_q[coordinate_index])};
    component.one_over_momentum_size = 1 / tvi_larger(component.momentum_size, TVI_LEAST_SIZE);
    component.q_change_size = inputs->is_separable
                                  ? fabs(inputs->unknown_change_per_impulse[i]) * component.momentum_size
                                  : end_size[coordinate_index] * inputs->inverse_weight_of_end_nodes;
    component.one_over_q_change_size =
        inputs->is_separable ? inputs->inverse_unknown_change_per_impulse[i] * component.one_over_momentum_size
                             : 1 / tvi_larger(component.q_change_size, TVI_LEAST_SIZE);
    return component;
}

/* Returns the increment of a coordinate of a separable system, drift + drift_low + scale (rate_double_integral +
 * rate_double_integral_low). Sets *low to the low-order part of the result. */
static inline double galerkin_compute_coordinate_increment(double drift, double drift_low, double scale,
                                                           double rate_double_integral, double rate_double_integral_low,
                                                           double *low)
{
    const double rise = scale * rate_double_integral;
    double rest;
    const double sum = tvi_two_sum(drift, rise, &rest);
    *low = rest + (fma(scale, rate_double_integral, -rise) + fma(scale, rate_double_integral_low, drift_low));
    return sum;
}

/* The unknowns of a step at its nodes. The rate F_j of an unknown at node j changes the unknowns only through the
 * impulse L_j = impulse_weight_j F_j. Each impulse is rounded once, and all sums use the rounded number, so that
 * conservation laws of these sums do not depend on the rounding. Unless noted otherwise, arrays are [unknowns][lanes]:
 * lanes after the last node repeat that node with weight 0. */
typedef struct {
    int lane_count, unknown_count;
    /* If moving_unknown_count = unknowns, a pass moves all of them. Otherwise the unknowns are coordinate_unknown_count
     * coordinates followed by as many momenta, and a pass moves only the first moving_unknown_count coordinates and the
     * first moving_unknown_count momenta. */
    int coordinate_unknown_count, moving_unknown_count;
    int node_count;
    double *values;
    double *start_values; /* [unknowns] the unknowns at the start of the step */
    /* The values that the unknowns would have without impulses, and their low-order parts. */
    double *drift_values, *drift_values_low;
    double *impulse_weight;             /* [lanes] the step times the quadrature weight, h b_j */
    double *impulses;                   /* the impulses L_j of the last movement, stored in the history */
    double *unknown_change_per_impulse; /* [unknowns] the factor of the impulses' sum in the change of an unknown */
    /* [unknowns] The reciprocal of each unknown's size, by which movements are measured. */
    double *inverse_unknown_size;
    /* [n] The momentum whose drift moves the coordinate by 1 in this step, or infinity if the mass is not known. */
    double *momentum_that_moves_coordinate_by_1_in_step;
    tvi_subsystems subsystems;
} galerkin_nodes;

/* Returns a copy of the nodes in which passes move all unknowns. */
static inline galerkin_nodes galerkin_copy_nodes_with_all_unknowns_moving(const galerkin_nodes *nodes)
{
    galerkin_nodes all = *nodes;
    all.moving_unknown_count = all.unknown_count;
    return all;
}

/* The inputs of the kernel `evaluate`, which computes components of the curve at several points: out[u][k] =
 * start_values[u] + (theta[k] drift[u] + change_per_impulse[u] sum_j table_jk impulses[u][j]) with u < component_count
 * and k < point_count. point_count is 1, the number of lanes or TVI_SAMPLES. */
typedef struct {
    int lane_count, point_count, component_count;
    const double *theta, *start_values, *drift, *change_per_impulse;
} galerkin_curve_at_points_inputs;

/* An n x n matrix A at each node, whose inverse the kernel `invert` computes. */
typedef struct {
    int n;
    double *matrix, *inverse; /* [n][n][lanes] A and its inverse */
    double *scratch_column;   /* [n][lanes] scratch space for one column */
} lanes_matrix_inverse;

/* A nonzero element of a row of the Hessian: its column, and the slot of the tape's block that contains it. */
typedef struct {
    int column, slot;
} lanes_hessian_element;

/* The Taylor expansion to first order of the gradient of L(q, v), at each node, about the point where the gradient
 * was evaluated (the centre). */
typedef struct {
    int n, lane_count;
    double *displacement;             /* [2n][lanes] the displacement of (q, v) from the centre */
    const double *gradient_at_centre; /* [2n][lanes] the gradient at the centre */
    const double *hessian_block;      /* the tape's block that contains the second derivatives */
    /* The elements of the Hessian that are not 0, row after row. */
    const lanes_hessian_element *hessian_element;
    const int *row_end; /* [2n] the index in hessian_element at which each row ends */
} lanes_linearised_gradient;

/* The data of the inner iterations of a Newton pass (hamiltonian.c, kernel_inner.h), for the matrix of second
 * derivatives at each node. Its rows are the unknowns whose rates depend on any unknown. Its columns are those of them
 * on which some rate depends; they are also the first rows. Rows are stored in groups of LANES_ROWS_PER_GROUP rows,
 * whose sums are computed in parallel; the last group may have fewer. */
enum { LANES_ROWS_PER_GROUP = 4 };
typedef struct {
    int hessian_column_count, hessian_row_count;
    const int *unknown_of_row; /* [hessian_row_count] the unknown of each row of the matrix */
    /* [hessian_column_count][rows of the group] for each group of rows: the index of each matrix element in
     * hessian_block. */
    const int *index_in_hessian_block;
    /* The block of the tape that computes second derivatives. A row of zeros follows, for second derivatives that are 0
     * by construction. */
    const double *hessian_block;
    /* [lanes][lanes] The factor of the impulse of one node in an unknown at another:
     * galerkin_coefficients.node_impulse_to_node_unknown_matrix, in single precision. */
    float *impulse_to_unknown_change_matrix;
    /* [hessian_column_count][rows of the group][lanes] for each group of rows: the matrix elements, in single
     * precision. */
    float *packed_hessian;
    /* [hessian_row_count] The size of each unknown in this step, and its reciprocal. */
    double *unknown_size, *inverse_unknown_size;
    /* [hessian_row_count][lanes] The change of the unknowns in the last inner iteration, and the sum of all its
     * changes. */
    float *last_unknown_change, *total_unknown_change;
    /* [hessian_row_count][lanes] The changes of the impulses that last_unknown_change and total_unknown_change
     * cause. */
    float *last_impulse_change, *total_impulse_change;
} lanes_inner_iterations;

/* Returns the number of rows in the group that begins with row `first_row`. Their sums are computed in parallel. */
static inline int lanes_count_rows_summed_in_parallel(const lanes_inner_iterations *inner, int first_row)
{
    return inner->hessian_row_count - first_row < LANES_ROWS_PER_GROUP ? inner->hessian_row_count - first_row
                                                                       : LANES_ROWS_PER_GROUP;
}

/* The kernels of a step; kernel.h defines them. */
typedef struct galerkin_kernels {
    /* `set_constant_drift_values` sets drift_values to the state at the start of the step, for equations of first
     * order. `set_linear_drift_values` is for a separable system, whose positions drift with the momentum: it sets
     * drift_values to q + q_low + c_i (drift + drift_low) at the abscissa c_i of node i. This kernel also sets drift +
     * drift_low = unknown_change_per_impulse (p + p_low), the drift over the step in two parts. */
    void (*set_constant_drift_values)(const galerkin_nodes *nodes, int n, const tvi_step_origin *origin);
    void (*set_linear_drift_values)(const galerkin_nodes *nodes, const double *node_abscissa,
                                    const tvi_step_origin *origin, double *drift, double *drift_low);
    void (*predict)(const galerkin_nodes *nodes, const galerkin_extrapolation *extrapolation);
    void (*set_sizes)(const galerkin_nodes *nodes, int n);
    /* Sets the impulses L_j from the rates, and moves the unknowns x to drift_values + (drift_values_low +
     * unknown_change_per_impulse sum_j matrix_ji L_j), with the impulse matrix. Returns the movement, the
     * sum of the squares of (change of x) inverse_unknown_size; it is a NaN if any change is a NaN. */
    double (*move)(const galerkin_nodes *nodes, const double *matrix, const double *rates, const int slot[]);
    /* Computes the sums of the impulses of the last movement, from which the increments and the tail of the step
     * follow. */
    void (*sum_impulses)(const galerkin_nodes *nodes, const galerkin_double_integral_and_tail_weights *weights,
                         const galerkin_impulse_sums *sums);
    /* `compute_drifting_increments` is for a separable system, and computes the increments dq = drift + drift_low +
     * scale rate_double_integral and dp = rate_integral from the sums of the impulses. `compute_increments` is for any
     * other system: dq and dp are scale rate_integral. */
    void (*compute_drifting_increments)(const galerkin_nodes *nodes, const galerkin_impulse_sums *sums,
                                        const double *drift, const double *drift_low, const tvi_increments *increments);
    void (*compute_increments)(const galerkin_nodes *nodes, const galerkin_impulse_sums *sums, int n,
                               const tvi_increments *increments);
    double (*compute_tail)(const galerkin_tail_inputs *inputs);

    /* `move_in_parts` does what `move` does, and also sets
     * displacements [unknowns][lanes]: the moved values are drift_values + displacements, rounded. */
    double (*move_in_parts)(const galerkin_nodes *nodes, const double *matrix, const double *rates, const int slot[],
                            double *displacements);
    /* move_with_changes does what `move` does, with the impulses L_j = impulse_weight_j F_j + changes[u][j], which
     * are rounded once. */
    double (*move_with_changes)(const galerkin_nodes *nodes, const double *matrix, const double *rates,
                                const double *changes, const int slot[]);
    /* Makes the inner iterations of a pass (hamiltonian.c). From the last changes of the unknowns, an iteration
     * computes the changes of the impulses to first order, and from these changes the next changes of the unknowns.
     * `changes` [unknowns][lanes] is the sum of the changes of the impulses, or 0 if the changes of the unknowns do not
     * shrink. The iterations end when the square of the next change is expected to be at most the larger of
     * smallest_goal and GALERKIN_INNER_GOAL times the square of the error of the expansion to first order. If the
     * second derivatives are reused (is_hessian_new is false), last_movement is the movement of the last pass. It shows
     * how far the unknowns are from the point of these derivatives. */
    void (*run_inner_iterations)(const galerkin_nodes *nodes, const lanes_inner_iterations *inner, const double *rates,
                                 const int slot[], bool is_hessian_new, double last_movement, double smallest_goal,
                                 double *changes);
    void (*evaluate)(const galerkin_curve_at_points_inputs *inputs, const double *integral_table,
                     const double *impulses, double *out);

    /* Inverts the matrix of each lane by elimination without row exchanges. Returns false, with `inverse` undefined, if
     * some pivot is much smaller or larger than the diagonal element in its place, or if there is a NaN. */
    bool (*invert)(const lanes_matrix_inverse *inverse);
    /* Computes the velocities at which L_v is equal to `momenta` to first order: centre_velocities + A^-1 ((momenta -
     * centre_momenta) - momentum_change), [n][lanes] each. At the centre L_v is centre_momenta; momentum_change is the
     * change of L_v by the displacement of q. `inverse` contains A^-1, with A = L_vv. */
    void (*correct_velocities)(const lanes_matrix_inverse *inverse, const double *momenta, const double *centre_momenta,
                               const double *momentum_change, const double *centre_velocities, double *velocities);
    /* Sets the first n rows of `out` [2n][lanes] to L_q at the displaced point, to first order: its value at the centre
     * plus its change by the displacements of q and v. Sets the last n rows to the change of L_v, to first order, by
     * the displacement of q alone, which is momentum_change of `correct_velocities`. */
    void (*linearise)(const lanes_linearised_gradient *expansion, double *out);
} galerkin_kernels;

/* The kernels, one table for each number of lanes, for each instruction set. */
extern const galerkin_kernels *const tvi_galerkin_kernels_base[GALERKIN_KERNEL_TABLE_COUNT],
    *const tvi_galerkin_kernels_avx2[GALERKIN_KERNEL_TABLE_COUNT],
        *const tvi_galerkin_kernels_avx512[GALERKIN_KERNEL_TABLE_COUNT];

#endif
