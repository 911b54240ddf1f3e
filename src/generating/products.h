/* products.h - solves the equations A^T x = D_z for the corrections of the curve's ends without forming Jacobians, for
 * separable systems of many coordinates. One tangent or adjoint sweep computes a product with a Jacobian, and
 * generalised conjugate residuals solve the equations (docs/method.md sections 2 and 5). corrected_curve.c calls it
 * through tvi_solver_by_products_*. */
#ifndef TVI_SRC_GENERATING_PRODUCTS_H
#define TVI_SRC_GENERATING_PRODUCTS_H

#include "generating/corrected_curve.h"
#include "generating/newton.h"

/* ---- Products with the Jacobians --------------------------------------------------------------------------------- */

#define PRODUCTS_AIM(V, S) JET_AT(V, next, 0) = factor * JET_OF(V, kappa, 0) * JET_GATHER(V, force, slot + here);

/* Computes the tangents dQ_k in the direction dz: dQ_{k+2} = tau^2 M^-1 dF_k / ((k+1)(k+2)). The tangents of inputs
 * other than coordinates, such as the time, stay 0. */
static inline void products_compute_tangents(tvi_curve *curve, const double dz[])
{
    enum { stride = 0 };
    const size_t n = (size_t)curve_dimension(curve), order = tvi_curve_order_stride(curve);
    const double *kappa = curve->momentum_scale_factor;
    const int *slot = curve_field_output_slots(curve);
    memcpy(curve->tangent_block, dz, n * sizeof *dz);
    memcpy(curve->tangent_block + order, dz + n, n * sizeof *dz);
    for (int k = 0; k + 2 <= curve_highest_order(curve); k++) {
        jet_sweep_tangents(curve->system->field_series, curve->series_block, curve->tangent_block, k, 1);
        const double factor = curve->time_unit / ((k + 1) * (k + 2)), *force = curve->tangent_block + (size_t)k * order;
        double *next = curve->tangent_block + (size_t)(k + 2) * order;
        JET_BLOCKS((int)n, PRODUCTS_AIM, );
    }
}

/* Computes out[n], the Jacobian of the combination's sum times the last direction of products_compute_tangents. */
static inline void products_differentiate_sum_along_set_dz(const tvi_curve *curve,
                                                           const tvi_coefficient_combination *combination, double out[])
{
    const size_t n = (size_t)curve_dimension(curve);
    memset(out, 0, n * sizeof *out);
    tvi_add_weighted_rows((size_t)curve_highest_order(curve) + 1, combination->order_weight,
                          tvi_curve_order_stride(curve), n, curve->tangent_block, out);
}

static inline double *products_get_adjoint_of_Q(const tvi_curve *curve, int k)
{
    return curve->adjoint_block + (size_t)k * tvi_curve_order_stride(curve);
}

/* The vectors of a product with transposed Jacobians, a sum: the seeds seed_Q [highest_order + 1][n] times those of the
 * coefficients Q_k, and the vectors for upper and lower rows [n], times vector_factor, by those of the sums of the two
 * combinations. Seeds and combinations that are NULL are omitted. */
typedef struct {
    const double *seed_Q;
    double vector_factor;
    const tvi_coefficient_combination *upper_jacobian_combination, *lower_jacobian_combination;
    const double *vector_for_upper_jacobian_rows, *vector_for_lower_jacobian_rows;
} tvi_transposed_jacobian_operands;

#define PRODUCTS_SEED(V, S)                                                                                            \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        if (operands->seed_Q) sum += JET_OF(V, operands->seed_Q + k * n, 0);                                           \
        if (operands->upper_jacobian_combination)                                                                      \
            sum += operands->vector_factor * operands->upper_jacobian_combination->order_weight[k] *                   \
                   JET_OF(V, operands->vector_for_upper_jacobian_rows, 0);                                             \
        if (operands->lower_jacobian_combination)                                                                      \
            sum += operands->vector_factor * operands->lower_jacobian_combination->order_weight[k] *                   \
                   JET_OF(V, operands->vector_for_lower_jacobian_rows, 0);                                             \
        JET_AT(V, bar, 0) = sum;                                                                                       \
    }

/* Sets the adjoints of Q_k to the seeds, and all other adjoints to 0, since operations of an order may add to the
 * adjoints of all lower orders. The sweep does not use other adjoints of the last two orders, since no Q_k follows from
 * these orders of the field. */
static inline void products_set_adjoint_seeds(tvi_curve *curve, int last_order,
                                              const tvi_transposed_jacobian_operands *operands)
{
    enum { stride = 0 };
    const int n = curve_dimension(curve);
    for (int k = 0; k <= last_order; k++) {
        double *bar = products_get_adjoint_of_Q(curve, k);
        JET_BLOCKS(n, PRODUCTS_SEED, );
        if (k + 2 <= last_order) memset(bar + n, 0, (tvi_curve_order_stride(curve) - (size_t)n) * sizeof *bar);
    }
}

#define PRODUCTS_HAND_ON(V, S)                                                                                         \
    if (JET_IN_A_ROW(V, slot + here)) {                                                                                \
        *(V *)(bar + slot[here]) += part * JET_OF(V, kappa, 0) * JET_OF(V, above, 0);                                  \
    } else {                                                                                                           \
        for (int i = here; i < here + (int)(sizeof(V) / sizeof(double)); i++)                                          \
            bar[slot[i]] += part * kappa[i] * above[i];                                                                \
    }

/* Computes out[2n], the transposed Jacobians times the vectors of `operands`, by an adjoint sweep from high to low
 * orders: the adjoint of order k of the force is fbar_k = tau^2 / ((k+1)(k+2)) M^-1 qbar_{k+2}, with the adjoint qbar_k
 * of Q_k; then follow the adjoints of the operands. It uses the orders of the curve up to last_order, 1 <= last_order
 * <= highest_order; the cost grows as its square. */
static inline void products_multiply_by_transposed_jacobians(tvi_curve *curve, int last_order,
                                                             const tvi_transposed_jacobian_operands *operands,
                                                             double out[])
{
    enum { stride = 0 };
    products_set_adjoint_seeds(curve, last_order, operands);
    const size_t n = (size_t)curve_dimension(curve);
    const double *kappa = curve->momentum_scale_factor;
    const int *slot = curve_field_output_slots(curve);
    for (int k = last_order - 2; k >= 0; k--) {
        const double part = curve->time_unit / ((k + 1) * (k + 2)), *above = products_get_adjoint_of_Q(curve, k + 2);
        double *bar = products_get_adjoint_of_Q(curve, k);
        JET_BLOCKS((int)n, PRODUCTS_HAND_ON, );
        jet_sweep_adjoints(curve->system->field_series, curve->series_block, curve->adjoint_block, k, last_order - 2);
    }
    memcpy(out, products_get_adjoint_of_Q(curve, 0), n * sizeof *out);
    memcpy(out + n, products_get_adjoint_of_Q(curve, 1), n * sizeof *out);
}

/* ---- The equations ----------------------------------------------------------------------------------------------- */

/* The memory of the generalised conjugate residuals that solve A^T x = D_z. Arrays of 2n rows are padded with zeros to
 * whole vectors. Rows that are not solved for are 0, and have an inverse_unknown_size of 0. */
enum { PRODUCTS_VECTOR = 8 };
typedef struct {
    double *solution; /* the solution x, which is the initial guess of the next pass */
    double *residual; /* [2n] D_z - A^T x: the action's gradient D_z, less the matrix A^T of the equations times x */
    /* [PRODUCTS_MAX_ITERATIONS][2n] the search directions, and the image of each, A^T times the direction */
    double *search_direction, *direction_image;
    double squared_image_norm[PRODUCTS_MAX_ITERATIONS]; /* the squared norm of each direction_image */
    double *inverse_unknown_size; /* the reciprocal of each unknown's size, by which its error is measured */
    double *scratch, *product;    /* [2n] scratch vectors, the second for products of Jacobians with vectors */
    double *max_norm_of_coefficient_Q_by_order; /* [highest_order + 1] for each k the largest |component| of Q_k */
    bool has_initial_guess;
} tvi_conjugate_residuals;

static inline tvi_conjugate_residuals *products_get_conjugate_residuals(const tvi_corrected_curve *corrected)
{
    return corrected->solver_data;
}

static inline int products_get_padded_row_count(const tvi_corrected_curve *corrected)
{
    return (2 * curve_dimension(&corrected->curve) + PRODUCTS_VECTOR - 1) / PRODUCTS_VECTOR * PRODUCTS_VECTOR;
}

static inline void products_discard_guess(tvi_corrected_curve *corrected)
{
    products_get_conjugate_residuals(corrected)->has_initial_guess = false;
}

static inline int products_get_first_equation_row(const tvi_corrected_curve *corrected)
{
    const bool is_last = corrected->definition->equations.has_last_columns;
    return is_last ? curve_dimension(&corrected->curve) : 0;
}

/* Returns the second combination of the equations, or NULL. */
static inline const tvi_coefficient_combination *products_get_lower_combination(const tvi_corrected_curve *corrected)
{
    const tvi_end_sum lower = corrected->definition->equations.lower;
    return lower ? &corrected->ends[lower] : NULL;
}

/* Returns the operands of the product factor * A^T vector, with the matrix A of the equations. */
static inline tvi_transposed_jacobian_operands products_collect_operands(const tvi_corrected_curve *corrected,
                                                                         double factor, const double vector[])
{
    return (tvi_transposed_jacobian_operands){NULL,
                                              factor,
                                              &corrected->ends[corrected->definition->equations.upper],
                                              products_get_lower_combination(corrected),
                                              vector + products_get_first_equation_row(corrected),
                                              vector + curve_dimension(&corrected->curve)};
}

/* Computes out = A^T vector [2n], with the equations' matrix A, from the orders of the series up to last_order. */
static inline void products_multiply_by_equation_matrix(tvi_corrected_curve *corrected, int last_order,
                                                        const double vector[], double out[])
{
    const tvi_transposed_jacobian_operands product = products_collect_operands(corrected, 1, vector);
    products_multiply_by_transposed_jacobians(&corrected->curve, last_order, &product, out);
}

/* Computes vector = P r with the diagonal preconditioner P, the reciprocals of the weights of Q_0 and Q_1 in A. */
static inline void products_apply_diagonal_preconditioner(const tvi_corrected_curve *corrected, const double r[],
                                                          double vector[])
{
    const int n = curve_dimension(&corrected->curve), place = products_get_first_equation_row(corrected);
    const tvi_coefficient_combination *lower = products_get_lower_combination(corrected);
    const double first = 1 / corrected->ends[corrected->definition->equations.upper].order_weight[place > 0],
                 second = lower ? 1 / lower->order_weight[1] : 0;
    for (int i = 0; i < n; i++) vector[place + i] = first * r[place + i];
    if (second == 0) return;
    for (int i = 0; i < n; i++) vector[n + i] = second * r[n + i];
}

/* Computes s = (2 P - P A^T P) r, an approximation of A^-T r. A is computed from the first PRODUCTS_NEAR_ORDER orders
 * only, which are exact for a force that is linear in q with a Jacobian that is linear in the time. */
static inline void products_apply_preconditioner(tvi_corrected_curve *corrected, const double r[], double s[])
{
    double *twice = products_get_conjugate_residuals(corrected)->scratch,
           *v = products_get_conjugate_residuals(corrected)->product;
    memset(s, 0, (size_t)products_get_padded_row_count(corrected) * sizeof *s);
    products_apply_diagonal_preconditioner(corrected, r, s);
    const int highest_order = curve_highest_order(&corrected->curve),
              last_order = highest_order < PRODUCTS_NEAR_ORDER ? highest_order : PRODUCTS_NEAR_ORDER;
    products_multiply_by_equation_matrix(corrected, last_order, s, v);
    for (int i = 0; i < 2 * curve_dimension(&corrected->curve); i++) twice[i] = 2 * r[i] - v[i];
    products_apply_diagonal_preconditioner(corrected, twice, s);
}

/* Returns max_i |vector_i| / size_i, with the sizes of the unknowns. */
static inline double products_compute_scaled_max_norm(const tvi_corrected_curve *corrected, const double vector[])
{
    const double *unit = products_get_conjugate_residuals(corrected)->inverse_unknown_size;
    double most = 0;
    for (int i = 0; i < products_get_padded_row_count(corrected); i++)
        most = tvi_larger(fabs(vector[i]) * unit[i], most);
    return most;
}

/* Returns sum_i vector_i y_i / size_i^2. */
static inline double products_compute_scaled_dot_product(const tvi_corrected_curve *corrected, const double vector[],
                                                         const double y[])
{
    const double *unit = products_get_conjugate_residuals(corrected)->inverse_unknown_size;
    double sum[PRODUCTS_VECTOR] = {0};
    for (int here = 0; here < products_get_padded_row_count(corrected); here += PRODUCTS_VECTOR)
        for (int lane = 0; lane < PRODUCTS_VECTOR; lane++)
            sum[lane] += vector[here + lane] * unit[here + lane] * (y[here + lane] * unit[here + lane]);
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

static inline void products_add_multiple(const tvi_corrected_curve *corrected, double factor, const double vector[],
                                         double *restrict y)
{
    for (int i = 0; i < products_get_padded_row_count(corrected); i++) y[i] += factor * vector[i];
}

/* Makes the image of search direction direction_index orthogonal to the earlier images, and changes the direction with
 * it. Adds to the solution the multiple of the direction that makes the residual least. */
static inline void products_minimise_residual(tvi_corrected_curve *corrected, int last_order, int direction_index)
{
    tvi_conjugate_residuals *iteration = products_get_conjugate_residuals(corrected);
    double *s = iteration->search_direction + direction_index * products_get_padded_row_count(corrected),
           *v = iteration->direction_image + direction_index * products_get_padded_row_count(corrected);
    products_multiply_by_equation_matrix(corrected, last_order, s, v);
    for (int i = 0; i < direction_index; i++) {
        const double *v_before = iteration->direction_image + i * products_get_padded_row_count(corrected);
        const double part = tvi_ratio_or_zero(products_compute_scaled_dot_product(corrected, v, v_before),
                                              iteration->squared_image_norm[i]);
        products_add_multiple(corrected, -part, v_before, v);
        products_add_multiple(corrected, -part,
                              iteration->search_direction + i * products_get_padded_row_count(corrected), s);
    }
    iteration->squared_image_norm[direction_index] = products_compute_scaled_dot_product(corrected, v, v);
    const double part = tvi_ratio_or_zero(products_compute_scaled_dot_product(corrected, iteration->residual, v),
                                          iteration->squared_image_norm[direction_index]);
    products_add_multiple(corrected, part, s, iteration->solution);
    products_add_multiple(corrected, -part, v, iteration->residual);
}

/* Returns the highest order of the curve that a product with a relative error of `relative_accuracy` needs: the first
 * order from which on |Q_k| is below relative_accuracy / PRODUCTS_TRUNCATION_SAFETY |Q_0|, or the highest order. */
static inline int products_choose_order_for_accuracy(const tvi_corrected_curve *corrected, double relative_accuracy)
{
    const double *largest = products_get_conjugate_residuals(corrected)->max_norm_of_coefficient_Q_by_order,
                 bound = relative_accuracy / PRODUCTS_TRUNCATION_SAFETY * largest[0];
    int k = curve_highest_order(&corrected->curve);
    while (k > 1 && !(largest[k - 1] > bound)) k--;
    return k;
}

/* Solves A^T x = D_z by generalised conjugate residuals from the last pass's x. Fails if corrections do not shrink. */
static inline tvi_status products_solve_by_conjugate_residuals(tvi_corrected_curve *corrected)
{
    tvi_conjugate_residuals *iteration = products_get_conjugate_residuals(corrected);
    double goal = CURVE_NEGLIGIBLE_ERROR;
    tvi_convergence_test passes;
    tvi_convergence_begin(&passes, 0);
    if (!iteration->has_initial_guess)
        memset(iteration->solution, 0, (size_t)products_get_padded_row_count(corrected) * sizeof *iteration->solution);
    tvi_transposed_jacobian_operands residual = products_collect_operands(corrected, -1, iteration->solution);
    residual.seed_Q = corrected->action_gradient_by_coefficients_Q;
    products_multiply_by_transposed_jacobians(&corrected->curve, curve_highest_order(&corrected->curve), &residual,
                                              iteration->residual);
    for (int direction_index = 0; direction_index < PRODUCTS_MAX_ITERATIONS; direction_index++) {
        double *s = iteration->search_direction + direction_index * products_get_padded_row_count(corrected);
        products_apply_preconditioner(corrected, iteration->residual, s);
        const double size = products_compute_scaled_max_norm(corrected, s);
        if (!isfinite(size)) return TVI_ENONFINITE;
        if (direction_index == 0) goal = tvi_larger(CURVE_NEGLIGIBLE_ERROR, PRODUCTS_REDUCTION * size);
        const tvi_stopping_rule rule = {.correction_goal = goal,
                                        .max_trusted_ratio = PASSES_MAX_CONTRACTION,
                                        .stall_ratio = PASSES_STALL_RATIO,
                                        .stall_comparison_lag = 1};
        const tvi_passes_verdict verdict = tvi_convergence_add_pass(&passes, &rule, size);
        const bool may_end =
            verdict == TVI_PASSES_MAY_END ||
            (verdict == TVI_PASSES_STUCK &&
             size <= PRODUCTS_STALLED_CORRECTION * products_compute_scaled_max_norm(corrected, iteration->solution));
        /* With a second combination all rows are solved for, and no residual is needed. */
        if (may_end && corrected->definition->equations.lower)
            products_add_multiple(corrected, 1, s, iteration->solution);
        else
            products_minimise_residual(corrected,
                                       products_choose_order_for_accuracy(corrected, goal < size ? goal / size : 1),
                                       direction_index);
        iteration->has_initial_guess = may_end;
        if (may_end) return TVI_OK;
    }
    return TVI_ENOCONV;
}

/* Computes J^-1 times the correction, with J = d(q-, u-)/dz. A curve is symplectic up to its truncation, J^T W J = W
 * with W = [0, 1/kappa; -1/kappa, 0] in (q, u); thus J^-1 = W^-1 J^T W. */
static inline void products_apply_inverse_flow_jacobian(tvi_corrected_curve *corrected, double correction[])
{
    const int n = curve_dimension(&corrected->curve),
              last_order = products_choose_order_for_accuracy(corrected, PRODUCTS_REDUCTION);
    const tvi_conjugate_residuals *iteration = products_get_conjugate_residuals(corrected);
    const double *kappa = corrected->curve.momentum_scale_factor, *product = iteration->product;
    double *of_q = iteration->scratch, *of_u = of_q + n;
    for (int i = 0; i < n; i++) {
        of_q[i] = correction[n + i] / kappa[i];
        of_u[i] = -correction[i] / kappa[i];
    }
    const tvi_transposed_jacobian_operands ends = {
        NULL, 1, &corrected->ends[TVI_Q_START], &corrected->ends[TVI_U_START], of_q, of_u};
    products_multiply_by_transposed_jacobians(&corrected->curve, last_order, &ends, iteration->product);
    for (int i = 0; i < n; i++) {
        correction[i] = -kappa[i] * product[n + i];
        correction[n + i] = kappa[i] * product[i];
    }
}

/* ---- The corrections --------------------------------------------------------------------------------------------- */

/* Sets the sizes relative to which the unknowns of a subsystem, its components `component[first .. end - 1]`, are
 * measured. The size of a component is the sum of the magnitudes of all terms of its momentum. A size that is 0 or much
 * smaller than the largest one is raised, to NEWTON_MIN_SCALE times it or more. If all momenta are 0, the sizes are
 * those of the positions; if these are 0, too, they are 1. */
static inline void products_set_subsystem_unknown_sizes(const tvi_corrected_curve *corrected, const int *component,
                                                        int first, int end)
{
    const int n = curve_dimension(&corrected->curve);
    const double *kappa = corrected->curve.momentum_scale_factor;
    double largest = 0, place = 0, *unit = products_get_conjugate_residuals(corrected)->inverse_unknown_size;
    for (int k = first; k < end; k++)
        largest = tvi_larger(fabs(kappa[component[k]]) * corrected->momentum_term_abs_sum[component[k]], largest);
    for (int order = 0; order <= curve_highest_order(&corrected->curve) && largest == 0; order++)
        for (int k = first; k < end; k++)
            place = tvi_larger(fabs(tvi_curve_position_coefficients(&corrected->curve, order)[component[k]]), place);
    const double least = largest > 0 ? NEWTON_MIN_SCALE * largest : place, none = largest > 0 ? largest : place;
    for (int k = first; k < end; k++) {
        const int i = component[k];
        const double per = none > 0 ? 1 / fabs(kappa[i]) : 1, size = corrected->momentum_term_abs_sum[i];
        const double counted = size > 0 ? tvi_larger(size, least * per) : none > 0 ? none * per : 1;
        unit[i] = unit[n + i] = 1 / tvi_larger(counted, DBL_MIN);
    }
}

static inline void products_set_unknown_sizes(tvi_corrected_curve *corrected)
{
    const tvi_subsystems *parts = &corrected->curve.system->subsystems;
    ends_compute_momentum_term_abs_sums(corrected);
    for (int k = 0; k <= curve_highest_order(&corrected->curve); k++)
        products_get_conjugate_residuals(corrected)->max_norm_of_coefficient_Q_by_order[k] = tvi_largest_magnitude(
            curve_dimension(&corrected->curve), tvi_curve_field_inputs_of_order(&corrected->curve, k), 1);
    for (int k = 0, first = 0; k < parts->count; first = parts->end_in_component_list[k++])
        products_set_subsystem_unknown_sizes(corrected, parts->component_list, first, parts->end_in_component_list[k]);
}

/* Solves A^T x = D_z without forming A. gradient_then_solution becomes x in solved rows, and D_z - A^T x in others. The
 * first pass of a step also computes inverse_unknown_size, by which the unknowns are scaled in all passes of the
 * step. */
static inline tvi_status products_solve_correction_equations(tvi_corrected_curve *corrected, const double z[],
                                                             const double scale[], tvi_stats *stats)
{
    const tvi_conjugate_residuals *iteration = products_get_conjugate_residuals(corrected);
    const int n = curve_dimension(&corrected->curve), place = products_get_first_equation_row(corrected);
    (void)z, (void)scale, (void)stats;
    if (!iteration->has_initial_guess) products_set_unknown_sizes(corrected);
    if (!corrected->definition->equations.lower)
        memset(iteration->inverse_unknown_size + n - place, 0, (size_t)n * sizeof *iteration->inverse_unknown_size);
    const tvi_status status = products_solve_by_conjugate_residuals(corrected);
    memcpy(corrected->gradient_then_solution, iteration->residual,
           2 * (size_t)n * sizeof *corrected->gradient_then_solution);
    memcpy(corrected->gradient_then_solution + place, iteration->solution + place,
           (size_t)(corrected->definition->equations.lower ? 2 * n : n) * sizeof *corrected->gradient_then_solution);
    return status;
}

#endif
