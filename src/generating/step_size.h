/* step_size.h - estimates the largest step for which a Taylor curve meets a tolerance, from its last coefficients, and
 * rescales the curve to it. The estimate is that of Jorba and Zou (A software package for the numerical integration of
 * ODEs by means of high-order Taylor methods, Experimental Mathematics 14 (2005), section 3): the step at which the
 * last term, of degree M, is tolerance / e^5 times the state. With M = 1 - ln(tolerance) / 2 it is e^(-3/M) times their
 * step, which is the radius of convergence over e^2. They take the state as one vector, use an absolute tolerance if
 * the state's size is below 1, and use the last two coefficients. Here q and p are measured separately, each by its
 * size or by its movement in the step, so that units have no effect and a body may start at rest or at 0.
 *
 * Other files call the functions of curve.h. */
#ifndef TVI_SRC_GENERATING_STEP_SIZE_H
#define TVI_SRC_GENERATING_STEP_SIZE_H

#include "generating/series.h"
#include "generating/taylor_sweep.h"

/* The estimate compares the last STEP_SIZE_LAST nonzero coefficients of a series, of which two in a row may happen
 * to be small, with its first STEP_SIZE_SIZED_BY nonzero ones, which show its size. STEP_SIZE_FIRST of the first
 * coefficients of q are found, since those of p in a separable system, p_k = (k + 1) q_{k+1}, follow from them. */
enum { STEP_SIZE_SIZED_BY = 2, STEP_SIZE_FIRST = STEP_SIZE_SIZED_BY + 1, STEP_SIZE_LAST = 3 };
/* The ratios of the last coefficients show the radius of convergence. Each coefficient is compared with the one
 * STEP_SIZE_APART orders before it, which has the same phase if a pair of singularities makes the coefficients swing.
 * The radius also limits the step if the state is so large that its coefficients, relative to it, would allow any step.
 */
enum { STEP_SIZE_APART = 4 };

/* A term of a series: its order k, and log_size = log max_i |x_k| over the components i, which is -INFINITY if there is
 * no such term. */
typedef struct {
    int order;
    double log_size;
} series_term_size;

/* The first and the last terms of a series that are not 0. */
typedef struct {
    series_term_size first_terms[STEP_SIZE_FIRST], last_terms[STEP_SIZE_LAST];
} series_first_and_last_terms;

/* Returns max_i of the absolute values of coefficient k of q, or of the scaled momentum kappa p, in which masses do not
 * show. */
static inline double step_size_find_largest_component(const tvi_curve *curve, bool of_momentum, int k)
{
    double size = 0;
    for (int i = 0; i < curve_dimension(curve); i++)
        size = tvi_larger(fabs(of_momentum ? tvi_curve_momentum_coefficient(curve, k, i)
                                           : tvi_curve_position_coefficients(curve, k)[i]),
                          size);
    return size;
}

/* Returns the first term that counts (TVI_LEAST_SIZE) among the orders k, k + step, ... before the order `end`. */
static inline series_term_size step_size_find_nonzero_term(const tvi_curve *curve, bool of_momentum, int k, int step,
                                                           int end)
{
    double size = 0;
    while (step * (end - k) > 0 && (size = step_size_find_largest_component(curve, of_momentum, k)) < TVI_LEAST_SIZE)
        k += step;
    return (series_term_size){k, size < TVI_LEAST_SIZE ? -INFINITY : log(size)};
}

static inline void step_size_find_first_and_last_terms(const tvi_curve *curve, bool of_momentum, int degree,
                                                       series_first_and_last_terms *terms)
{
    for (int i = 0, k = 0; i < STEP_SIZE_FIRST; i++, k++) {
        terms->first_terms[i] = step_size_find_nonzero_term(curve, of_momentum, k, 1, degree);
        k = terms->first_terms[i].order;
    }
    for (int i = 0, k = degree; i < STEP_SIZE_LAST; i++, k--) {
        terms->last_terms[i] = step_size_find_nonzero_term(curve, of_momentum, k, -1, 1);
        k = terms->last_terms[i].order;
    }
}

/* Returns the term of order q.order - 1 of the derivative of q, k |q_k|. If there is no term q, its log_size -INFINITY
 * is returned, and log_integer is not read, since q.order may be beyond its end. */
static inline series_term_size step_size_differentiate_term(const tvi_curve *curve, series_term_size q)
{
    const bool is_there = q.log_size > -INFINITY;
    return (series_term_size){q.order - 1, is_there ? q.log_size + curve->log_integer[q.order] : q.log_size};
}

static inline void step_size_find_derivative_terms(const tvi_curve *curve, const series_first_and_last_terms *q,
                                                   series_first_and_last_terms *p)
{
    const bool has_place = q->first_terms[0].order == 0;
    for (int i = 0; i < STEP_SIZE_SIZED_BY; i++)
        p->first_terms[i] = step_size_differentiate_term(curve, has_place ? q->first_terms[i + 1] : q->first_terms[i]);
    for (int i = 0; i < STEP_SIZE_LAST; i++) p->last_terms[i] = step_size_differentiate_term(curve, q->last_terms[i]);
}

/* Returns the logarithm of the largest s at which the term is at most a fraction of the size of the series: s^k |x_k|
 * <= fraction * max_j |x_j| s^j over the reference terms j, the first of the series, with the term's order k, its
 * coefficient x_k, and log_max_relative_size the logarithm of the fraction. It has no branches, since these would be
 * mispredicted. */
static inline double step_size_compute_log_max_s_of_small_term(const tvi_curve *curve,
                                                               const series_term_size reference_terms[],
                                                               series_term_size term, double log_max_relative_size)
{
    double farthest = -INFINITY;
    for (int i = 0; i < STEP_SIZE_SIZED_BY; i++) {
        const int apart = term.order - reference_terms[i].order;
        const double usable_s = apart > 0 ? (log_max_relative_size + reference_terms[i].log_size - term.log_size) *
                                                curve->reciprocal_integer[apart]
                                          : -INFINITY;
        farthest = tvi_larger(usable_s, farthest);
    }
    return farthest > -INFINITY ? farthest : INFINITY;
}

/* Returns the logarithm of the largest s at which each of the last terms is small enough. It is the least of the
 * logarithms that step_size_compute_log_max_s_of_small_term returns for these terms. */
static inline double step_size_log_max_scaled_time_by_last_terms(const tvi_curve *curve,
                                                                 const series_first_and_last_terms *terms, int degree,
                                                                 double log_max_ratio_to_first_terms)
{
    double least = INFINITY;
    for (int i = 0; i < STEP_SIZE_LAST; i++) {
        const series_term_size x = terms->last_terms[i];
        const double usable_s = x.order > 1
                                    ? step_size_compute_log_max_s_of_small_term(curve, terms->first_terms, x,
                                                                                log_max_ratio_to_first_terms * x.order *
                                                                                    curve->reciprocal_integer[degree])
                                    : INFINITY;
        least = tvi_smaller(usable_s, least);
    }
    return least;
}

/* Returns the ratio of the largest magnitude of a component of coefficient lower_order of the position to that of
 * coefficient `order`. The ratio is INFINITY, which bounds no radius, if lower_order is less than 2 or if one of the
 * two is 0: the series of a polynomial, or of a function that is flat to roundoff, may begin after lower_order. */
static inline double step_size_max_norm_ratio(const tvi_curve *curve, int lower_order, int order)
{
    const double last = lower_order > 1 ? step_size_find_largest_component(curve, false, order) : 0;
    const double lower = last > TVI_LEAST_SIZE ? step_size_find_largest_component(curve, false, lower_order) : 0;
    return lower > 0 ? lower / last : INFINITY;
}

/* Returns the usable step, or STEP_SIZE_MAX_PART_OF_RADIUS of the radius of convergence if that is less. The radius
 * follows from the second largest of the last three ratios of coefficients. */
static inline double step_size_limit_to_convergence_radius(const tvi_curve *curve, double usable_s)
{
    const int k = curve_q_degree(curve);
    const double part = usable_s / STEP_SIZE_MAX_PART_OF_RADIUS, fourth = (part * part) * (part * part);
    const double first = step_size_max_norm_ratio(curve, k - STEP_SIZE_APART, k),
                 second = step_size_max_norm_ratio(curve, k - 1 - STEP_SIZE_APART, k - 1);
    if (tvi_smaller(first, second) >= fourth) return usable_s;
    const double third = step_size_max_norm_ratio(curve, k - 2 - STEP_SIZE_APART, k - 2),
                 smaller = tvi_smaller(first, second);
    const double middle = tvi_larger(smaller, tvi_smaller(tvi_larger(first, second), third));
    return middle >= fourth ? usable_s : STEP_SIZE_MAX_PART_OF_RADIUS * sqrt(sqrt(middle));
}

static inline double curve_estimate_largest_usable_s(const tvi_curve *curve, double log_tolerance)
{
    const int q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    const double log_relative_size = log_tolerance - STEP_SIZE_SAFETY;
    series_first_and_last_terms q, p;
    step_size_find_first_and_last_terms(curve, false, q_degree, &q);
    if (curve_system_form(curve) == TVI_SEPARABLE) step_size_find_derivative_terms(curve, &q, &p);
    else step_size_find_first_and_last_terms(curve, true, p_degree, &p);
    const double usable_s =
        exp(tvi_smaller(step_size_log_max_scaled_time_by_last_terms(curve, &q, q_degree, log_relative_size),
                        step_size_log_max_scaled_time_by_last_terms(curve, &p, p_degree, log_relative_size)));
    return step_size_limit_to_convergence_radius(curve, usable_s);
}

/* ---- The end of the step ----------------------------------------------------------------------------------------- */

/* Multiplies the coefficients x_k of all orders by power[k]. Computes value_sum and size_sum (tvi_taylor_sums) from the
 * orders up to `degree`. */
static inline void step_size_rescale_and_sum_rows(const tvi_curve *curve, int components, int degree,
                                                  const double power[], double *x, double *value_sum, double *size_sum)
{
    const tvi_taylor_rows rows = {components, 1, degree, tvi_curve_order_stride(curve)};
    const tvi_taylor_sums sums = {value_sum, size_sum, NULL, NULL};
    for (int k = degree + 1; k <= curve_highest_order(curve); k++)
        for (int i = 0; i < components; i++) x[(size_t)k * rows.order_stride + (size_t)i] *= power[k];
    taylor_rescale_and_sum(&rows, power, x, &sums, false);
}

/* Rescales and sums the rows of a separable system, all of which are coefficients of Q. du is the increment of kappa p,
 * which U_0 = Q_1 does not enter. */
static inline void step_size_rescale_and_sum_separable(const tvi_curve *curve, const double power[], double dq[],
                                                       double du[])
{
    const tvi_taylor_rows rows = {curve_dimension(curve), 2, curve_highest_order(curve), tvi_curve_order_stride(curve)};
    const tvi_taylor_sums sums = {dq, curve->displacement_size, du, curve->momentum_size};
    taylor_rescale_and_sum(&rows, power, curve->series_block, &sums, true);
    for (int i = 0; i < curve_dimension(curve); i++) curve->momentum_scale_factor[i] *= power[1];
}

/* Computes power[k] = factor^k, k = 0 .. highest_order and up to 3 more, in chains that do not wait for each other. */
enum { STEP_SIZE_CHAINS = 4 };
static inline void step_size_compute_powers(double factor, int highest_order, double power[])
{
    const double second = factor * factor, fourth = second * second;
    double next[STEP_SIZE_CHAINS] = {1, factor, second, second * factor};
    for (int k = 0; k <= highest_order; k += STEP_SIZE_CHAINS)
        for (int i = 0; i < STEP_SIZE_CHAINS; i++) {
            power[k + i] = next[i];
            next[i] *= fourth;
        }
}

static inline void curve_rescale_and_sum(tvi_curve *curve, double factor, double dq[], double du[])
{
    const int n = curve_dimension(curve), q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    const int numbers = curve_dimension(curve);
    const tvi_form form = curve_system_form(curve);
    double power[TVI_MAX_DEGREE + 1 + STEP_SIZE_CHAINS];
    step_size_compute_powers(factor, curve_highest_order(curve), power);
    curve->time_unit *= factor;
    if (form == TVI_SEPARABLE) {
        step_size_rescale_and_sum_separable(curve, power, dq, du);
        return;
    }
    step_size_rescale_and_sum_rows(curve, numbers, q_degree, power, curve->series_block, dq, curve->displacement_size);
    if (form == TVI_HAMILTONIAN)
        step_size_rescale_and_sum_rows(curve, numbers, p_degree, power, curve->series_block + numbers, du,
                                       curve->momentum_size);
    for (int i = 0; i < n && form == TVI_LAGRANGIAN; i++)
        step_size_rescale_and_sum_rows(curve, 1, p_degree, power,
                                       curve->series_block + curve_field_output_slot(curve, n + i), du + i,
                                       curve->momentum_size + i);
    for (int i = 0; i < numbers; i++) curve->momentum_size[i] += fabs(tvi_curve_momentum_coefficient(curve, 0, i));
}

#endif
