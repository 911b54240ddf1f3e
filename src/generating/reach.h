/* reach.h - estimates the largest step for which a Taylor curve meets a tolerance, from its last coefficients (Jorba
 * and Zou, A software package for the numerical integration of ODEs by means of high-order Taylor methods, Experimental
 * Mathematics 14 (2005), section 3): the step whose last term, of degree M, is a part tolerance / e^5 of the state.
 * With M = 1 - ln(tolerance) / 2 this is their step, the radius of convergence over e^2, times e^(-3/M). Their state is
 * one vector, their tolerance is absolute if that is below 1, and they use the last two coefficients. Here q and p are
 * measured apart, each by its size or by its movement in the step, so that no unit shows and a body may start at rest
 * or at 0.
 *
 * This file is part of the text of generated code (emit.c), where every size is a constant. Other files call the
 * functions of curve.h. */
#ifndef TVI_SRC_GENERATING_REACH_H
#define TVI_SRC_GENERATING_REACH_H

#include "generating/series.h"
#include "generating/taylor_sweep.h"

/* The last term is e^-REACH_SAFETY of the tolerance: 2 of the exponent is that of the paper, and 3 allows for the
 * growth of errors in tens of revolutions. */
static const double REACH_SAFETY = 5;
/* The numbers of coefficients that are used: of the first ones, and of the last ones, of which two in a row may
 * happen to be small. One more of the first coefficients of q is used, since p_k = (k + 1) q_{k+1} in a separable
 * system. */
enum { REACH_SIZED_BY = 2, REACH_FIRST = REACH_SIZED_BY + 1, REACH_LAST = 3 };
/* A step is at most this part of the radius of convergence, which the ratios of the last coefficients show: each to the
 * one REACH_APART orders before it, which has the same phase if a pair of singularities makes the coefficients swing.
 * Beside a state that is large the coefficients may be so small that they would allow any step. */
static const double REACH_PART_OF_RADIUS = 0.7;
enum { REACH_APART = 4 };

/* A term of a series: its order k, and log max_i |x_k|, which is -INFINITY if the term is missing. */
typedef struct {
    int order;
    double log_size;
} reach_term;

/* The first and the last terms of a series that are not 0. */
typedef struct {
    reach_term first[REACH_FIRST], last[REACH_LAST];
} reach_end_terms;

/* Returns the size of coefficient k of q, or of p in the unit of kappa p, so that masses do not show. */
static inline double reach_coefficient_size(const tvi_curve *curve, bool of_momentum, int k)
{
    double size = 0;
    for (int i = 0; i < curve_dimension(curve); i++)
        size = tvi_larger(fabs(of_momentum ? tvi_curve_momentum_coefficient(curve, k, i)
                                           : tvi_curve_position_coefficients(curve, k)[i]),
                          size);
    return size;
}

/* A coefficient below this has lost digits to underflow, and counts as 0. */
static const double REACH_LEAST = 1e-280;

/* Returns the first term that is not 0, from order k on in steps of `step`, before the order `end`. */
static inline reach_term reach_find_nonzero_term(const tvi_curve *curve, bool of_momentum, int k, int step, int end)
{
    double size = 0;
    while (step * (end - k) > 0 && (size = reach_coefficient_size(curve, of_momentum, k)) < REACH_LEAST) k += step;
    return (reach_term){k, size < REACH_LEAST ? -INFINITY : log(size)};
}

static inline void reach_find_end_terms(const tvi_curve *curve, bool of_momentum, int degree, reach_end_terms *ends)
{
    for (int i = 0, k = 0; i < REACH_FIRST; i++, k++) {
        ends->first[i] = reach_find_nonzero_term(curve, of_momentum, k, 1, degree);
        k = ends->first[i].order;
    }
    for (int i = 0, k = degree; i < REACH_LAST; i++, k--) {
        ends->last[i] = reach_find_nonzero_term(curve, of_momentum, k, -1, 1);
        k = ends->last[i].order;
    }
}

/* Returns the term of order k = q.order - 1 of the derivative, |(k + 1) q_{k+1}|. If q is missing, its order may be
 * beyond the table of logarithms. */
static inline reach_term reach_derivative_of_term(const tvi_curve *curve, reach_term q)
{
    const bool is_there = q.log_size > -INFINITY;
    return (reach_term){q.order - 1, is_there ? q.log_size + curve->log_integer[q.order] : q.log_size};
}

static inline void reach_find_derivative_terms(const tvi_curve *curve, const reach_end_terms *q, reach_end_terms *p)
{
    const bool has_place = q->first[0].order == 0;
    for (int i = 0; i < REACH_SIZED_BY; i++)
        p->first[i] = reach_derivative_of_term(curve, has_place ? q->first[i + 1] : q->first[i]);
    for (int i = 0; i < REACH_LAST; i++) p->last[i] = reach_derivative_of_term(curve, q->last[i]);
}

/* Returns the logarithm of the largest s with s^k |x_k| <= part max |x_j| s^j over the first x_j: the size of x
 * along the curve is that of the largest of these terms. There are no branches, since the larger of two terms
 * changes from step to step. */
static inline double reach_log_step_by_term(const tvi_curve *curve, const reach_term first[], reach_term x,
                                            double log_part)
{
    double farthest = -INFINITY;
    for (int i = 0; i < REACH_SIZED_BY; i++) {
        const int apart = x.order - first[i].order;
        const double reach =
            apart > 0 ? (log_part + first[i].log_size - x.log_size) * curve->reciprocal[apart] : -INFINITY;
        farthest = tvi_larger(reach, farthest);
    }
    return farthest > -INFINITY ? farthest : INFINITY;
}

/* Returns the logarithm of the smallest step that any of the last terms allows. */
static inline double reach_log_step_by_last_terms(const tvi_curve *curve, const reach_end_terms *ends, int degree,
                                                  double log_part)
{
    double least = INFINITY;
    for (int i = 0; i < REACH_LAST; i++) {
        const reach_term x = ends->last[i];
        const double reach =
            x.order > 1 ? reach_log_step_by_term(curve, ends->first, x, log_part * x.order * curve->reciprocal[degree])
                        : INFINITY;
        least = tvi_smaller(reach, least);
    }
    return least;
}

/* Returns x_{k-4} / x_k of one coefficient of q, or INFINITY if there is none. */
static inline double reach_coefficient_ratio(const tvi_curve *curve, int k)
{
    const double last = k > REACH_APART + 1 ? reach_coefficient_size(curve, false, k) : 0;
    return last > REACH_LEAST ? reach_coefficient_size(curve, false, k - REACH_APART) / last : INFINITY;
}

/* Returns the step, or a smaller one if it is too near the radius of convergence. Two of the last three ratios of
 * coefficients decide. */
static inline double reach_limit_to_convergence_radius(const tvi_curve *curve, double reach)
{
    const int k = curve_q_degree(curve);
    const double part = reach / REACH_PART_OF_RADIUS, fourth = (part * part) * (part * part);
    const double first = reach_coefficient_ratio(curve, k), second = reach_coefficient_ratio(curve, k - 1);
    if (tvi_smaller(first, second) >= fourth) return reach;
    const double third = reach_coefficient_ratio(curve, k - 2), smaller = tvi_smaller(first, second);
    const double middle = tvi_larger(smaller, tvi_smaller(tvi_larger(first, second), third));
    return middle >= fourth ? reach : REACH_PART_OF_RADIUS * sqrt(sqrt(middle));
}

static inline double curve_estimate_usable_step(const tvi_curve *curve, double log_tolerance)
{
    const int q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    const double log_part = log_tolerance - REACH_SAFETY;
    reach_end_terms q, p;
    reach_find_end_terms(curve, false, q_degree, &q);
    if (curve_form(curve) == TVI_SEPARABLE) reach_find_derivative_terms(curve, &q, &p);
    else reach_find_end_terms(curve, true, p_degree, &p);
    const double reach = exp(tvi_smaller(reach_log_step_by_last_terms(curve, &q, q_degree, log_part),
                                         reach_log_step_by_last_terms(curve, &p, p_degree, log_part)));
    return reach_limit_to_convergence_radius(curve, reach);
}

/* ---- The end of the step ----------------------------------------------------------------------------------------- */

/* Rescales and sums the rows of x up to this degree. The rows x_k above it are rescaled only. */
static inline void reach_rescale_rows(const tvi_curve *curve, int components, int degree, const double power[],
                                      double *x, double *rise, double *size)
{
    const tvi_taylor_rows rows = {components, 1, degree, tvi_curve_slot_count(curve), false};
    const tvi_taylor_sums sums = {rise, size, NULL, NULL};
    for (int k = degree + 1; k <= curve_highest_order(curve); k++)
        for (int i = 0; i < components; i++) x[(size_t)k * rows.order_stride + (size_t)i] *= power[k];
    taylor_rescale_and_sum(&rows, power, x, &sums);
}

/* Rescales and sums the rows of a separable system, all of which are coefficients of Q. U_0 = Q_1 is not part of the
 * increment of kappa p. */
static inline void reach_rescale_separable(const tvi_curve *curve, const double power[], double q[], double u[])
{
    const tvi_taylor_rows rows = {curve_numbers(curve), 2, curve_highest_order(curve), tvi_curve_slot_count(curve),
                                  true};
    const tvi_taylor_sums sums = {q, curve->movement_size, u, curve->momentum_size};
    taylor_rescale_and_sum(&rows, power, curve->series_block, &sums);
    for (int i = 0; i < curve_dimension(curve); i++) curve->kappa[i] *= power[1];
}

/* Computes power[k] = factor^k, k = 0 .. top and up to 3 more, in chains that do not wait for each other. */
enum { REACH_CHAINS = 4 };
static inline void reach_compute_powers(double factor, int top, double power[])
{
    const double second = factor * factor, fourth = second * second;
    double next[REACH_CHAINS] = {1, factor, second, second * factor};
    for (int k = 0; k <= top; k += REACH_CHAINS)
        for (int i = 0; i < REACH_CHAINS; i++) {
            power[k + i] = next[i];
            next[i] *= fourth;
        }
}

static inline void curve_rescale_and_sum(tvi_curve *curve, double factor, double q[], double u[])
{
    const int n = curve_dimension(curve), q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    const int numbers = curve_numbers(curve);
    const tvi_form form = curve_form(curve);
    double power[TVI_MAX_DEGREE + 1 + REACH_CHAINS];
    reach_compute_powers(factor, curve_highest_order(curve), power);
    curve->tau *= factor;
    if (form == TVI_SEPARABLE) {
        reach_rescale_separable(curve, power, q, u);
        return;
    }
    reach_rescale_rows(curve, numbers, q_degree, power, curve->series_block, q, curve->movement_size);
    if (form == TVI_HAMILTONIAN)
        reach_rescale_rows(curve, numbers, p_degree, power, curve->series_block + numbers, u, curve->momentum_size);
    for (int i = 0; i < n && form == TVI_LAGRANGIAN; i++)
        reach_rescale_rows(curve, 1, p_degree, power, curve->series_block + curve_output_slot(curve, n + i), u + i,
                           curve->momentum_size + i);
    for (int i = 0; i < numbers; i++) curve->momentum_size[i] += fabs(tvi_curve_momentum_coefficient(curve, 0, i));
}

#endif
