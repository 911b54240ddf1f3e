/* reach.h - computes how far a Taylor curve serves, by its last coefficients (Jorba and Zou, A software package for the
 * numerical integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14 (2005), section 3):
 * the step whose last term, of degree M, is a part tolerance / e^5 of the state. With M = 1 - ln(tolerance) / 2 this is
 * their step, the radius of convergence over e^2, times e^(-3/M). Their state is one vector, their tolerance is
 * absolute if that is below 1, and they use the last two coefficients. Here q and p are measured apart, each by its
 * size or by its movement in the step, so that no unit shows and a body may start at rest or at 0.
 *
 * This file is part of the text of generated code (emit.c), where every size is a constant. Other files call the
 * functions of curve.h. */
#ifndef TVI_SRC_GENERATING_REACH_H
#define TVI_SRC_GENERATING_REACH_H

#include "generating/series.h"
#include "generating/taylor_sweep.h"

/* This is -log of the last term's part of a tolerance: 2 as in that paper, and 3 for the growth of errors in tens of
 * revolutions. */
static const double REACH_SAFETY = 5;
/* These count the coefficients that are looked at, at the start, and at the end, where two in a row may happen to be
 * small. At the start one more coefficient of q is looked at, since p_k = (k + 1) q_{k+1} in a separable system. */
enum { REACH_SIZED_BY = 2, REACH_FIRST = REACH_SIZED_BY + 1, REACH_LAST = 3 };
/* A step is at most this part of the radius of convergence, which the ratios of the last coefficients show: each to the
 * one REACH_APART orders before it, which has the same phase if a pair of singularities makes the coefficients swing.
 * Beside a state that is large the coefficients may be so small that they would allow any step. */
static const double REACH_PART_OF_RADIUS = 0.7;
enum { REACH_APART = 4 };

/* A term holds log max_i |x_k|, or -INFINITY if there is none. */
typedef struct {
    int k;
    double log;
} reach_term;

/* The ends are the coefficients that are not 0, from the first and from the last one on. */
typedef struct {
    reach_term first[REACH_FIRST], last[REACH_LAST];
} reach_ends;

/* Returns the size of coefficient k of q, or of p in the unit of kappa p, so that masses do not show. */
static inline double reach_size(const tvi_curve *curve, bool of_momentum, int k)
{
    double size = 0;
    for (int i = 0; i < curve_n(curve); i++)
        size = tvi_larger(fabs(of_momentum ? tvi_curve_U(curve, k, i) : tvi_curve_Q(curve, k)[i]), size);
    JET_ALONE(size);
    return size;
}

/* A smaller coefficient has lost digits when it was formed, and tells no more than 0. */
static const double REACH_LEAST = 1e-280;

/* Returns the first coefficient that is not 0 from order k on, before `end`. */
static inline reach_term reach_find(const tvi_curve *curve, bool of_momentum, int k, int step, int end)
{
    double size = 0;
    while (step * (end - k) > 0 && (size = reach_size(curve, of_momentum, k)) < REACH_LEAST) k += step;
    return (reach_term){k, size < REACH_LEAST ? -INFINITY : log(size)};
}

static inline void reach_find_ends(const tvi_curve *curve, bool of_momentum, int degree, reach_ends *ends)
{
    for (int i = 0, k = 0; i < REACH_FIRST; i++, k++) {
        ends->first[i] = reach_find(curve, of_momentum, k, 1, degree);
        k = ends->first[i].k;
    }
    for (int i = 0, k = degree; i < REACH_LAST; i++, k--) {
        ends->last[i] = reach_find(curve, of_momentum, k, -1, 1);
        k = ends->last[i].k;
    }
}

/* Returns log |(k + 1) q_{k+1}|; if there is none, its order may be beyond the table. */
static inline reach_term reach_slope(const tvi_curve *curve, reach_term q)
{
    const bool is_there = q.log > -INFINITY;
    return (reach_term){q.k - 1, is_there ? q.log + curve->log_of[q.k] : q.log};
}

static inline void reach_find_slopes(const tvi_curve *curve, const reach_ends *q, reach_ends *p)
{
    const bool has_place = q->first[0].k == 0;
    for (int i = 0; i < REACH_SIZED_BY; i++)
        p->first[i] = reach_slope(curve, has_place ? q->first[i + 1] : q->first[i]);
    for (int i = 0; i < REACH_LAST; i++) p->last[i] = reach_slope(curve, q->last[i]);
}

/* Returns log of the largest s with s^k |x_k| <= part max |x_j| s^j, over the first x_j: the size of x along the curve
 * is that of the largest of their terms. It has no branches, since the larger of two terms changes from step to
 * step. */
static inline double reach_of_term(const tvi_curve *curve, const reach_term first[], reach_term x, double log_part)
{
    double farthest = -INFINITY;
    for (int i = 0; i < REACH_SIZED_BY; i++) {
        const int apart = x.k - first[i].k;
        double reach = apart > 0 ? (log_part + first[i].log - x.log) * curve->per[apart] : -INFINITY;
        JET_ALONE(reach);
        farthest = tvi_larger(reach, farthest);
    }
    return farthest > -INFINITY ? farthest : INFINITY;
}

/* Returns log of the least reach of the last coefficients. */
static inline double reach_of(const tvi_curve *curve, const reach_ends *ends, int degree, double log_part)
{
    double least = INFINITY;
    for (int i = 0; i < REACH_LAST; i++) {
        const reach_term x = ends->last[i];
        double reach = x.k > 1 ? reach_of_term(curve, ends->first, x, log_part * x.k * curve->per[degree]) : INFINITY;
        JET_ALONE(reach);
        least = tvi_smaller(reach, least);
    }
    return least;
}

/* Returns x_{k-4} / x_k of one coefficient of q, or INFINITY if there is none. */
static inline double reach_ratio(const tvi_curve *curve, int k)
{
    const double last = k > REACH_APART + 1 ? reach_size(curve, false, k) : 0;
    return last > REACH_LEAST ? reach_size(curve, false, k - REACH_APART) / last : INFINITY;
}

/* Returns the reach, or less if the coefficients do not become smaller so far out: two of the last three decide. */
static inline double reach_converging(const tvi_curve *curve, double reach)
{
    const int k = curve_q_degree(curve);
    const double part = reach / REACH_PART_OF_RADIUS, fourth = (part * part) * (part * part);
    const double first = reach_ratio(curve, k), second = reach_ratio(curve, k - 1);
    if (tvi_smaller(first, second) >= fourth) return reach;
    const double third = reach_ratio(curve, k - 2), smaller = tvi_smaller(first, second);
    const double middle = tvi_larger(smaller, tvi_smaller(tvi_larger(first, second), third));
    return middle >= fourth ? reach : REACH_PART_OF_RADIUS * sqrt(sqrt(middle));
}

static inline double curve_reach(const tvi_curve *curve, double log_tolerance)
{
    const int q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    const double log_part = log_tolerance - REACH_SAFETY;
    reach_ends q, p;
    reach_find_ends(curve, false, q_degree, &q);
    if (curve_form(curve) == TVI_SEPARABLE) reach_find_slopes(curve, &q, &p);
    else reach_find_ends(curve, true, p_degree, &p);
    const double reach =
        exp(tvi_smaller(reach_of(curve, &q, q_degree, log_part), reach_of(curve, &p, p_degree, log_part)));
    return reach_converging(curve, reach);
}

/* ---- The end of the step ----------------------------------------------------------------------------------------- */

/* Scales and sums the rows of x to this degree; x_k above it are scaled too. */
static inline void reach_sweep_rows(const tvi_curve *curve, int components, int degree, const double power[], double *x,
                                    double *rise, double *size)
{
    const tvi_taylor_rows rows = {components, 1, degree, tvi_curve_slots(curve), false};
    const tvi_taylor_sums sums = {rise, size, NULL, NULL};
    for (int k = degree + 1; k <= curve_top(curve); k++)
        for (int i = 0; i < components; i++) x[(size_t)k * rows.stride + (size_t)i] *= power[k];
    taylor_sweep(&rows, power, x, &sums);
}

/* Sums the rows of a separable system, where all sums are of Q; U_0 = Q_1 is no part of the rise of kappa p. */
static inline void reach_sweep_separable(const tvi_curve *curve, const double power[], double q[], double u[])
{
    const tvi_taylor_rows rows = {curve_numbers(curve), 2, curve_top(curve), tvi_curve_slots(curve), true};
    const tvi_taylor_sums sums = {q, curve->movement, u, curve->momentum};
    taylor_sweep(&rows, power, curve->x, &sums);
    for (int i = 0; i < curve_n(curve); i++) curve->kappa[i] *= power[1];
}

/* Computes power[k] = factor^k, k = 0 .. top and up to 3 more, in chains that do not wait for each other. */
enum { REACH_CHAINS = 4 };
static inline void reach_powers(double factor, int top, double power[])
{
    const double second = factor * factor, fourth = second * second;
    double next[REACH_CHAINS] = {1, factor, second, second * factor};
    for (int k = 0; k <= top; k += REACH_CHAINS)
        for (int i = 0; i < REACH_CHAINS; i++) {
            power[k + i] = next[i];
            next[i] *= fourth;
        }
}

static inline void curve_end_at(tvi_curve *curve, double factor, double q[], double u[])
{
    const int n = curve_n(curve), q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    const int numbers = curve_numbers(curve);
    const tvi_form form = curve_form(curve);
    double power[TVI_MAX_DEGREE + 1 + REACH_CHAINS];
    reach_powers(factor, curve_top(curve), power);
    curve->tau *= factor;
    if (form == TVI_SEPARABLE) {
        reach_sweep_separable(curve, power, q, u);
        return;
    }
    reach_sweep_rows(curve, numbers, q_degree, power, curve->x, q, curve->movement);
    if (form == TVI_HAMILTONIAN)
        reach_sweep_rows(curve, numbers, p_degree, power, curve->x + numbers, u, curve->momentum);
    for (int i = 0; i < n && form == TVI_LAGRANGIAN; i++)
        reach_sweep_rows(curve, 1, p_degree, power, curve->x + curve_slot(curve, n + i), u + i, curve->momentum + i);
    for (int i = 0; i < numbers; i++) curve->momentum[i] += fabs(tvi_curve_U(curve, 0, i));
}

#endif
