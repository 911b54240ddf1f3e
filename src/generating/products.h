/* products.h - solves the equations A^T x = D_z for the corrections of the curve's ends without forming Jacobians, for
 * separable systems of many coordinates. One tangent or adjoint sweep computes a product with a Jacobian, and
 * generalised conjugate residuals solve the equations (docs/method.md sections 2 and 5). closure.c calls it through
 * tvi_solver_by_products_*. Generated code includes this text (emit.c) with every size as a constant. */
#ifndef TVI_SRC_GENERATING_PRODUCTS_H
#define TVI_SRC_GENERATING_PRODUCTS_H

#include "generating/closure.h"
#include "generating/newton.h"

/* ---- Products with the Jacobians --------------------------------------------------------------------------------- */

#define PRODUCTS_AIM(V, S) JET_AT(V, next, 0) = factor * JET_OF(V, kappa, 0) * JET_GATHER(V, force, slot + here);

/* Computes the tangents dQ_k in the direction dz: dQ_{k+2} = tau^2 M^-1 dF_k / ((k+1)(k+2)). The tangents of inputs
 * other than coordinates, such as the time, stay 0. */
static inline void products_compute_tangents(tvi_curve *curve, const double dz[])
{
    enum { stride = 0 };
    const size_t n = (size_t)curve_dimension(curve), order = tvi_curve_order_stride(curve);
    const double *kappa = curve->kappa;
    const int *slot = curve_field_output_slots(curve);
    memcpy(curve->tangent_block, dz, n * sizeof *dz);
    memcpy(curve->tangent_block + order, dz + n, n * sizeof *dz);
    for (int k = 0; k + 2 <= curve_highest_order(curve); k++) {
        PRODUCTS_TANGENTS(curve->system->field_series, curve->series_block, curve->tangent_block, k, 1);
        const double factor = curve->tau / ((k + 1) * (k + 2)), *force = curve->tangent_block + (size_t)k * order;
        double *next = curve->tangent_block + (size_t)(k + 2) * order;
        JET_BLOCKS((int)n, PRODUCTS_AIM, );
    }
}

/* Computes out[n], the Jacobian of the combination's sum times the direction of the last call of
 * products_compute_tangents. */
static inline void products_multiply_jacobian_by_direction(const tvi_curve *curve, const tvi_combination *combination,
                                                           double out[])
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

/* The vectors that a product with transposed Jacobians adds up: the seeds seed_Q [highest_order + 1][n] are multiplied
 * by the transposed Jacobians of the coefficients Q_k; first_vector and second_vector [n], times factor, by those of
 * first_combination and second_combination. Seeds and combinations that are NULL are omitted. */
typedef struct {
    const double *seed_Q;
    double factor;
    const tvi_combination *first_combination, *second_combination;
    const double *first_vector, *second_vector;
} tvi_transposed_product_terms;

#define PRODUCTS_SEED(V, S)                                                                                            \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        if (terms->seed_Q) sum += JET_OF(V, terms->seed_Q + k * n, 0);                                                 \
        if (terms->first_combination)                                                                                  \
            sum += terms->factor * terms->first_combination->order_weight[k] * JET_OF(V, terms->first_vector, 0);      \
        if (terms->second_combination)                                                                                 \
            sum += terms->factor * terms->second_combination->order_weight[k] * JET_OF(V, terms->second_vector, 0);    \
        JET_AT(V, bar, 0) = sum;                                                                                       \
    }

/* Sets the adjoints of Q_k to the seeds, and all other adjoints to 0, since operations of an order may add to the
 * adjoints of all lower orders. The sweep does not use other adjoints of the last two orders, since no Q_k follows from
 * these orders of the field. */
static inline void products_set_adjoint_seeds(tvi_curve *curve, int last_order,
                                              const tvi_transposed_product_terms *terms)
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

/* Computes out[2n], the transposed Jacobians times the vectors of `terms`, by an adjoint sweep from high to low orders:
 * the adjoint of order k of the force is fbar_k = tau^2 / ((k+1)(k+2)) M^-1 qbar_{k+2}, with the adjoint qbar_k of Q_k;
 * then follow the adjoints of the operands. It uses the orders of the curve up to last_order, 1 <= last_order <=
 * highest_order; the cost grows as its square. */
static inline void products_multiply_by_transposed_jacobians(tvi_curve *curve, int last_order,
                                                             const tvi_transposed_product_terms *terms, double out[])
{
    enum { stride = 0 };
    products_set_adjoint_seeds(curve, last_order, terms);
    const size_t n = (size_t)curve_dimension(curve);
    const double *kappa = curve->kappa;
    const int *slot = curve_field_output_slots(curve);
    for (int k = last_order - 2; k >= 0; k--) {
        const double part = curve->tau / ((k + 1) * (k + 2)), *above = products_get_adjoint_of_Q(curve, k + 2);
        double *bar = products_get_adjoint_of_Q(curve, k);
        JET_BLOCKS((int)n, PRODUCTS_HAND_ON, );
        PRODUCTS_ADJOINTS(curve->system->field_series, curve->series_block, curve->adjoint_block, k, last_order - 2);
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
    double *residual; /* the residual D_z - A^T x, in all 2n rows */
    /* [PRODUCTS_MAX_ITERATIONS][2n] the search directions, and the image of each, A^T times the direction */
    double *search_direction, *direction_image;
    double squared_image_norm[PRODUCTS_MAX_ITERATIONS]; /* the squared norm of each direction_image */
    /* The reciprocal of each unknown's size, by which its error is measured. */
    double *inverse_unknown_size;
    double *scratch, *product; /* [2n] scratch vectors, the second for products of Jacobians with vectors */
    double *max_norm_of_Q;     /* [highest_order + 1] for each k the largest |component| of Q_k */
    bool has_initial_guess;
} tvi_conjugate_residuals;

static inline tvi_conjugate_residuals *products_get_conjugate_residuals(const tvi_closure *closure)
{
    return closure->solver_data;
}

static inline int products_get_padded_row_count(const tvi_closure *closure)
{
    return (2 * curve_dimension(&closure->curve) + PRODUCTS_VECTOR - 1) / PRODUCTS_VECTOR * PRODUCTS_VECTOR;
}

static inline void products_discard_guess(tvi_closure *closure)
{
    products_get_conjugate_residuals(closure)->has_initial_guess = false;
}

static inline int products_get_first_solved_row(const tvi_closure *closure, const tvi_correction_equations *equations)
{
    const bool is_last = !equations->second_combination && equations->jacobian_column_half == TVI_LAST_COLUMNS;
    return is_last ? curve_dimension(&closure->curve) : 0;
}

/* Returns the terms whose transposed product is factor * A^T vector, with the matrix A of the equations. */
static inline tvi_transposed_product_terms products_get_equation_matrix_terms(const tvi_closure *closure,
                                                                              const tvi_correction_equations *equations,
                                                                              double factor, const double vector[])
{
    return (tvi_transposed_product_terms){.factor = factor,
                                          .first_combination = equations->first_combination,
                                          .second_combination = equations->second_combination,
                                          .first_vector = vector + products_get_first_solved_row(closure, equations),
                                          .second_vector = vector + curve_dimension(&closure->curve)};
}

/* Computes out = A^T vector, in all 2n rows, from the orders of the curve up to last_order; A is from the equations. */
static inline void products_multiply_by_equation_matrix(tvi_closure *closure, int last_order,
                                                        const tvi_correction_equations *equations,
                                                        const double vector[], double out[])
{
    const tvi_transposed_product_terms product = products_get_equation_matrix_terms(closure, equations, 1, vector);
    products_multiply_by_transposed_jacobians(&closure->curve, last_order, &product, out);
}

/* Computes vector = P r with a diagonal preconditioner P, the reciprocals of the weights with which Q_0 and Q_1 enter
 * A. */
static inline void products_apply_diagonal_preconditioner(const tvi_closure *closure,
                                                          const tvi_correction_equations *equations, const double r[],
                                                          double vector[])
{
    const int n = curve_dimension(&closure->curve), place = products_get_first_solved_row(closure, equations);
    const double first = 1 / equations->first_combination->order_weight[place > 0],
                 second = equations->second_combination ? 1 / equations->second_combination->order_weight[1] : 0;
    for (int i = 0; i < n; i++) vector[place + i] = first * r[place + i];
    if (second == 0) return;
    for (int i = 0; i < n; i++) vector[n + i] = second * r[n + i];
}

/* Computes s = (2 P - P A^T P) r, an approximation of A^-T r. A is computed from the first PRODUCTS_NEAR_ORDER orders
 * only, which are exact for a force that is linear in q with a Jacobian that is linear in the time. */
static inline void products_apply_preconditioner(tvi_closure *closure, const tvi_correction_equations *equations,
                                                 const double r[], double s[])
{
    double *twice = products_get_conjugate_residuals(closure)->scratch,
           *v = products_get_conjugate_residuals(closure)->product;
    memset(s, 0, (size_t)products_get_padded_row_count(closure) * sizeof *s);
    products_apply_diagonal_preconditioner(closure, equations, r, s);
    products_multiply_by_equation_matrix(closure,
                                         curve_highest_order(&closure->curve) < PRODUCTS_NEAR_ORDER
                                             ? curve_highest_order(&closure->curve)
                                             : PRODUCTS_NEAR_ORDER,
                                         equations, s, v);
    for (int i = 0; i < 2 * curve_dimension(&closure->curve); i++) twice[i] = 2 * r[i] - v[i];
    products_apply_diagonal_preconditioner(closure, equations, twice, s);
}

/* Returns max_i |vector_i| / size_i, with the sizes of the unknowns. */
static inline double products_compute_scaled_max_norm(const tvi_closure *closure, const double vector[])
{
    const double *unit = products_get_conjugate_residuals(closure)->inverse_unknown_size;
    double most = 0;
    for (int i = 0; i < products_get_padded_row_count(closure); i++) most = tvi_larger(fabs(vector[i]) * unit[i], most);
    return most;
}

/* Returns sum_i vector_i y_i / size_i^2. */
static inline double products_compute_scaled_dot_product(const tvi_closure *closure, const double vector[],
                                                         const double y[])
{
    const double *unit = products_get_conjugate_residuals(closure)->inverse_unknown_size;
    double sum[PRODUCTS_VECTOR] = {0};
    for (int here = 0; here < products_get_padded_row_count(closure); here += PRODUCTS_VECTOR)
        for (int lane = 0; lane < PRODUCTS_VECTOR; lane++)
            sum[lane] += vector[here + lane] * unit[here + lane] * (y[here + lane] * unit[here + lane]);
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

static inline void products_add_multiple(const tvi_closure *closure, double factor, const double vector[],
                                         double *restrict y)
{
    for (int i = 0; i < products_get_padded_row_count(closure); i++) y[i] += factor * vector[i];
}

/* Makes the image of search direction direction_index orthogonal to the earlier images, and changes the direction with
 * it. Adds to the solution the multiple of the direction that makes the residual least. */
static inline void products_minimise_residual(tvi_closure *closure, int last_order,
                                              const tvi_correction_equations *equations, int direction_index)
{
    tvi_conjugate_residuals *iteration = products_get_conjugate_residuals(closure);
    double *s = iteration->search_direction + direction_index * products_get_padded_row_count(closure),
           *v = iteration->direction_image + direction_index * products_get_padded_row_count(closure);
    products_multiply_by_equation_matrix(closure, last_order, equations, s, v);
    for (int i = 0; i < direction_index; i++) {
        const double *v_before = iteration->direction_image + i * products_get_padded_row_count(closure);
        const double part = tvi_ratio_or_zero(products_compute_scaled_dot_product(closure, v, v_before),
                                              iteration->squared_image_norm[i]);
        products_add_multiple(closure, -part, v_before, v);
        products_add_multiple(closure, -part, iteration->search_direction + i * products_get_padded_row_count(closure),
                              s);
    }
    iteration->squared_image_norm[direction_index] = products_compute_scaled_dot_product(closure, v, v);
    const double part = tvi_ratio_or_zero(products_compute_scaled_dot_product(closure, iteration->residual, v),
                                          iteration->squared_image_norm[direction_index]);
    products_add_multiple(closure, part, s, iteration->solution);
    products_add_multiple(closure, -part, v, iteration->residual);
}

/* Returns the highest order of the curve that a product with a relative error of `relative_accuracy` needs: the first
 * order from which on |Q_k| is below relative_accuracy / PRODUCTS_TRUNCATION_SAFETY |Q_0|, or the highest order. */
static inline int products_choose_order_for_accuracy(const tvi_closure *closure, double relative_accuracy)
{
    const double *largest = products_get_conjugate_residuals(closure)->max_norm_of_Q,
                 bound = relative_accuracy / PRODUCTS_TRUNCATION_SAFETY * largest[0];
    int k = curve_highest_order(&closure->curve);
    while (k > 1 && !(largest[k - 1] > bound)) k--;
    return k;
}

/* Solves A^T x = D_z by generalised conjugate residuals, from the guess x of the pass before. Returns TVI_ENOCONV if
 * corrections do not shrink. */
static inline tvi_status products_solve_by_conjugate_residuals(tvi_closure *closure,
                                                               const tvi_correction_equations *equations)
{
    tvi_conjugate_residuals *iteration = products_get_conjugate_residuals(closure);
    double goal = CURVE_NEGLIGIBLE_ERROR;
    tvi_convergence_test passes;
    tvi_convergence_test_begin_iteration(&passes, 0);
    if (!iteration->has_initial_guess)
        memset(iteration->solution, 0, (size_t)products_get_padded_row_count(closure) * sizeof *iteration->solution);
    tvi_transposed_product_terms residual =
        products_get_equation_matrix_terms(closure, equations, -1, iteration->solution);
    residual.seed_Q = closure->action_gradient_by_coefficients_Q;
    products_multiply_by_transposed_jacobians(&closure->curve, curve_highest_order(&closure->curve), &residual,
                                              iteration->residual);
    for (int direction_index = 0; direction_index < PRODUCTS_MAX_ITERATIONS; direction_index++) {
        double *s = iteration->search_direction + direction_index * products_get_padded_row_count(closure);
        products_apply_preconditioner(closure, equations, iteration->residual, s);
        const double size = products_compute_scaled_max_norm(closure, s);
        if (!isfinite(size)) return TVI_ENONFINITE;
        if (direction_index == 0) goal = tvi_larger(CURVE_NEGLIGIBLE_ERROR, PRODUCTS_REDUCTION * size);
        const tvi_stopping_rule rule = {.correction_goal = goal,
                                        .max_trusted_contraction_ratio = PASSES_MAX_CONTRACTION,
                                        .stall_contraction_ratio = PASSES_STALL_RATIO,
                                        .stall_comparison_lag = 1};
        const tvi_passes_verdict verdict = tvi_convergence_test_add_pass(&passes, &rule, size);
        const bool may_end =
            verdict == TVI_PASSES_MAY_END ||
            (verdict == TVI_PASSES_STUCK &&
             size <= PRODUCTS_STALLED_CORRECTION * products_compute_scaled_max_norm(closure, iteration->solution));
        /* With a second combination all rows are solved for, and no residual is needed. */
        if (may_end && equations->second_combination) products_add_multiple(closure, 1, s, iteration->solution);
        else
            products_minimise_residual(closure,
                                       products_choose_order_for_accuracy(closure, goal < size ? goal / size : 1),
                                       equations, direction_index);
        iteration->has_initial_guess = may_end;
        if (may_end) return TVI_OK;
    }
    return TVI_ENOCONV;
}

/* Solves A^T x = D_z without forming A. gradient_then_solution becomes x in the rows that are solved for, and the
 * residual D_z - A^T x in all other rows. */
static inline tvi_status products_solve_correction_equations(tvi_closure *closure,
                                                             const tvi_correction_equations *equations)
{
    const tvi_conjugate_residuals *iteration = products_get_conjugate_residuals(closure);
    const int n = curve_dimension(&closure->curve), place = products_get_first_solved_row(closure, equations);
    if (!equations->second_combination)
        memset(iteration->inverse_unknown_size + n - place, 0, (size_t)n * sizeof *iteration->inverse_unknown_size);
    const tvi_status status = products_solve_by_conjugate_residuals(closure, equations);
    memcpy(closure->gradient_then_solution, iteration->residual,
           2 * (size_t)n * sizeof *closure->gradient_then_solution);
    memcpy(closure->gradient_then_solution + place, iteration->solution + place,
           (size_t)(equations->second_combination ? 2 * n : n) * sizeof *closure->gradient_then_solution);
    return status;
}

/* Computes J^-1 times the correction, with J = d(q-, u-)/dz. A curve is symplectic up to its truncation, J^T W J = W
 * with W = [0, 1/kappa; -1/kappa, 0] in (q, u); thus J^-1 = W^-1 J^T W. */
static inline void products_apply_inverse_flow_jacobian(tvi_closure *closure, double correction[])
{
    const int n = curve_dimension(&closure->curve),
              last_order = products_choose_order_for_accuracy(closure, PRODUCTS_REDUCTION);
    const double *kappa = closure->curve.kappa, *product = products_get_conjugate_residuals(closure)->product;
    double *of_q = products_get_conjugate_residuals(closure)->scratch, *of_u = of_q + n;
    for (int i = 0; i < n; i++) {
        of_q[i] = correction[n + i] / kappa[i];
        of_u[i] = -correction[i] / kappa[i];
    }
    const tvi_transposed_product_terms ends = {.factor = 1,
                                               .first_combination = &closure->q_at_start_weights,
                                               .second_combination = &closure->u_at_start_weights,
                                               .first_vector = of_q,
                                               .second_vector = of_u};
    products_multiply_by_transposed_jacobians(&closure->curve, last_order, &ends,
                                              products_get_conjugate_residuals(closure)->product);
    for (int i = 0; i < n; i++) {
        correction[i] = -kappa[i] * product[n + i];
        correction[n + i] = kappa[i] * product[i];
    }
}

/* ---- The corrections --------------------------------------------------------------------------------------------- */

/* Sets the size by which each unknown of a subsystem is measured, for the components `component[first .. end - 1]`. The
 * unknowns have the unit of momenta, and their size is momentum_term_abs_sum. A size of 0 is replaced by the largest
 * scaled momentum over |kappa|, and a much smaller size is raised to NEWTON_MIN_SCALE times that quotient. If all
 * momenta are 0, as at rest with degree 1, the sizes are those of the positions; if these are 0, they are 1. */
static inline void products_set_subsystem_unknown_sizes(const tvi_closure *closure, const int *component, int first,
                                                        int end)
{
    const int n = curve_dimension(&closure->curve);
    const double *kappa = closure->curve.kappa;
    double largest = 0, place = 0, *unit = products_get_conjugate_residuals(closure)->inverse_unknown_size;
    for (int k = first; k < end; k++)
        largest = tvi_larger(fabs(kappa[component[k]]) * closure->momentum_term_abs_sum[component[k]], largest);
    for (int order = 0; order <= curve_highest_order(&closure->curve) && largest == 0; order++)
        for (int k = first; k < end; k++)
            place = tvi_larger(fabs(tvi_curve_position_coefficients(&closure->curve, order)[component[k]]), place);
    const double least = largest > 0 ? NEWTON_MIN_SCALE * largest : place, none = largest > 0 ? largest : place;
    for (int k = first; k < end; k++) {
        const int i = component[k];
        const double per = none > 0 ? 1 / fabs(kappa[i]) : 1, size = closure->momentum_term_abs_sum[i];
        unit[i] = unit[n + i] = 1 / (size > 0 ? tvi_larger(size, least * per) : none > 0 ? none * per : 1);
    }
}

static inline void products_set_unknown_sizes(tvi_closure *closure)
{
    const tvi_subsystems *parts = &closure->curve.system->subsystems;
    closure_compute_momentum_term_abs_sums(closure);
    for (int k = 0; k <= curve_highest_order(&closure->curve); k++)
        products_get_conjugate_residuals(closure)->max_norm_of_Q[k] = tvi_largest_magnitude(
            curve_dimension(&closure->curve), tvi_curve_field_inputs_of_order(&closure->curve, k), 1);
    for (int k = 0, first = 0; k < parts->count; first = parts->end_in_component_list[k++])
        products_set_subsystem_unknown_sizes(closure, parts->component_list, first, parts->end_in_component_list[k]);
}

/* Computes the corrections of the ends of the step in one pass. The first pass of a step also computes
 * inverse_unknown_size, by which the unknowns are scaled in all passes of the step. */
static inline tvi_status products_compute_corrections(tvi_closure *closure, const double z[], const double scale[],
                                                      tvi_stats *stats)
{
    (void)z, (void)scale, (void)stats;
    if (!products_get_conjugate_residuals(closure)->has_initial_guess) products_set_unknown_sizes(closure);
    return closure->correct_ends(closure);
}

#endif
