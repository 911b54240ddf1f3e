/* predictor.c - Predicts the unknowns of a step from earlier steps (step.h). */
#include "galerkin/step.h"

#include <math.h>

enum { MAX_LANES = TVI_GALERKIN_MAX_LANES };

void tvi_galerkin_allocate_predictor(galerkin_predictor *predictor, tvi_arena *arena,
                                     const galerkin_equations *equations)
{
    const int unknowns = equations->nodes.unknown_count, lanes = equations->nodes.lane_count;
    const size_t count = (size_t)unknowns, width = (size_t)lanes;
    predictor->history = tvi_arena_allocate_restored_if_step_fails(arena, sizeof *predictor->history);
    predictor->two_step_prediction_max_first_movement =
        unknowns * lanes * (GALERKIN_ROUGH_PREDICTION * GALERKIN_ROUGH_PREDICTION);
    for (int i = 0; i < GALERKIN_RING_LENGTH; i++)
        predictor->impulse_ring[i] = tvi_arena_allocate_kept_even_if_step_fails(arena, count * width * sizeof(double));
    predictor->two_step_extrapolation = tvi_arena_allocate_doubles(arena, 2 * width * width);
    predictor->last_step_extrapolation = tvi_arena_allocate_doubles(arena, width * width);
    predictor->resized_step_extrapolation = tvi_arena_allocate_doubles(arena, width * width);
    predictor->extrapolated_rates = tvi_arena_allocate_doubles(arena, count * width);
    predictor->zeros = tvi_arena_allocate_doubles(arena, count + width);
    predictor->ones = tvi_arena_allocate_doubles(arena, count + width);
}

/* ---- Tables ------------------------------------------------------------------------------------------------------ */

/* Computes basis[k][i]: polynomials of degree k at 3 m points, orthonormal on the first fitted_point_count of these
 * points. The points are the nodes of the last step, of the step before it, and of the next one. */
static void set_orthonormal_polynomials(const galerkin_coefficients *coefficients, int fitted_point_count, int degree,
                                        long double basis[][3 * MAX_LANES])
{
    const int m = coefficients->node_count;
    for (int k = 0; k <= degree; k++) {
        long double *now = basis[k];
        for (int i = 0; i < 3 * m; i++) {
            const long double s = coefficients->long_double_node_abscissa[i % m] + (i < m ? 0 : i < 2 * m ? -1 : 1);
            now[i] = k > 0 ? s * basis[k - 1][i] : 1;
        }
        /* If before == k, the product is the square of the norm of basis[k]. */
        for (int before = 0; before <= k; before++) {
            long double product = 0;
            /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): m >= 1 */
            for (int i = 0; i < fitted_point_count; i++) product += now[i] * basis[before][i];
            for (int i = 0; i < 3 * m && before < k; i++) now[i] -= product * basis[before][i];
            for (int i = 0; i < 3 * m && before == k; i++) now[i] /= sqrtl(product);
        }
    }
}

/* Computes factors[point][next]: the factor of the rate at `point` of the earlier steps in the predicted rate at node
 * `next` of the next step. The prediction is a least-squares fit by polynomials, so that the factor is sum_k pi_k(1 +
 * c_next) pi_k(s_point), with the polynomials pi_k of set_orthonormal_polynomials. s_point is the time of the point
 * from the start of the last step, in units of the step. */
static void fit_extrapolation_factors(const galerkin_coefficients *coefficients, int step_count, int degree,
                                      long double factors[][MAX_LANES])
{
    long double basis[2 * MAX_LANES][3 * MAX_LANES];
    const int m = coefficients->node_count;
    set_orthonormal_polynomials(coefficients, step_count * m, degree, basis);
    for (int point = 0; point < step_count * m; point++)
        for (int next = 0; next < m; next++) {
            factors[point][next] = 0;
            for (int k = 0; k <= degree; k++) factors[point][next] += basis[k][2 * m + next] * basis[k][point];
        }
}

static void set_extrapolation_table(const galerkin_coefficients *coefficients, const galerkin_equations *equations,
                                    int step_count, int degree, double *table)
{
    long double factors[2 * MAX_LANES][MAX_LANES];
    const int m = coefficients->node_count, lanes = coefficients->lane_count;
    fit_extrapolation_factors(coefficients, step_count, degree, factors);
    for (int point = 0; point < step_count * m; point++)
        for (int next = 0; next < m; next++) {
            double *column = table + (point / m * lanes + point % m) * lanes;
            const double impulse_factor = (double)(factors[point][next] * coefficients->long_double_weight[next] /
                                                   coefficients->long_double_weight[point % m]);
            for (int i = 0; i < lanes; i++)
                column[i] += impulse_factor * equations->impulse_to_predicted_unknown_or_rate_matrix[next * lanes + i];
        }
}

/* Computes the tables that extrapolate two steps and one. For two steps a polynomial of degree 3m/2 needs the fewest
 * passes, with m nodes: a higher degree raises the roundoff of the prediction more than it lowers its truncation
 * error. */
void tvi_galerkin_set_predictor_tables(galerkin_predictor *predictor, const galerkin_coefficients *coefficients,
                                       const galerkin_equations *equations)
{
    const int degree = coefficients->node_count > 1 ? 3 * coefficients->node_count / 2 : 1;
    set_extrapolation_table(coefficients, equations, 2, degree, predictor->two_step_extrapolation);
    set_extrapolation_table(coefficients, equations, 1, coefficients->node_count - 1,
                            predictor->last_step_extrapolation);
    for (int i = 0; i < equations->nodes.unknown_count + coefficients->lane_count; i++) predictor->ones[i] = 1;
}

/* Computes resized_step_extrapolation for a step that is step_ratio times as large as the last one and begins at
 * elapsed_fraction of it. In units of the last step the nodes of the new step are at elapsed_fraction + step_ratio
 * c_i. */
static void set_resized_step_extrapolation(galerkin_predictor *predictor, const galerkin_coefficients *coefficients,
                                           const galerkin_node_polynomials *polynomials,
                                           const galerkin_kernels *kernels, double step_ratio, double elapsed_fraction)
{
    if (step_ratio == predictor->new_to_last_step_size_ratio &&
        elapsed_fraction == predictor->resized_step_elapsed_fraction)
        return;
    predictor->new_to_last_step_size_ratio = step_ratio;
    predictor->resized_step_elapsed_fraction = elapsed_fraction;
    const int lanes = coefficients->lane_count;
    const galerkin_curve_at_points_inputs at_nodes = {lanes,
                                                      lanes,
                                                      coefficients->node_count,
                                                      coefficients->node_abscissa,
                                                      predictor->zeros,
                                                      predictor->zeros,
                                                      predictor->ones};
    double place[MAX_LANES] = {0}, P[MAX_LANES * MAX_LANES] = {0};
    for (int i = 0; i < lanes; i++) place[i] = elapsed_fraction + step_ratio * coefficients->node_abscissa[i];
    tvi_galerkin_evaluate_legendre_polynomials(polynomials, lanes, place, P);
    kernels->evaluate(&at_nodes, P, polynomials->transposed_legendre_coefficient,
                      predictor->resized_step_extrapolation);
    for (int j = 0; j < coefficients->node_count; j++)
        for (int i = 0; i < lanes; i++)
            predictor->resized_step_extrapolation[j * lanes + i] *= step_ratio * coefficients->node_weight[i];
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

bool tvi_galerkin_can_predict_from_last_step(const galerkin_predictor *predictor, const galerkin_equations *equations,
                                             double t, double *elapsed_fraction)
{
    const galerkin_history *history = predictor->history;
    if (history->last_step_size == 0) return false;
    const double ratio =
        equations->step_size == history->last_step_size ? 1 : equations->step_size / history->last_step_size;
    const bool is_next = galerkin_follows_last_step(history, equations->step_size, t);
    *elapsed_fraction = is_next ? 1 : 0;
    return ratio <= GALERKIN_PREDICTION_MAX_RATIO &&
           (is_next ? ratio >= GALERKIN_PREDICTION_BACK_RATIO : t == history->last_step_start_time && ratio > 0);
}

void tvi_galerkin_predict_from_last_step(galerkin_predictor *predictor, const galerkin_coefficients *coefficients,
                                         const galerkin_node_polynomials *polynomials, galerkin_equations *equations,
                                         double elapsed_fraction)
{
    const galerkin_curve_at_points_inputs to = {coefficients->lane_count,
                                                coefficients->lane_count,
                                                equations->nodes.unknown_count,
                                                coefficients->node_abscissa,
                                                predictor->zeros,
                                                predictor->zeros,
                                                predictor->ones};
    set_resized_step_extrapolation(predictor, coefficients, polynomials, equations->kernels,
                                   equations->step_size / predictor->history->last_step_size, elapsed_fraction);
    equations->kernels->evaluate(&to, predictor->resized_step_extrapolation,
                                 galerkin_find_impulses_of_step(predictor, 0), predictor->extrapolated_rates);
    galerkin_predict_unknowns(
        equations, &(galerkin_extrapolation){equations->impulse_to_predicted_unknown_or_rate_matrix,
                                             equations->impulse_to_predicted_unknown_or_rate_matrix,
                                             predictor->extrapolated_rates, predictor->extrapolated_rates, true});
}
