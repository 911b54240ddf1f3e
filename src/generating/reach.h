/* reach.h - how far a Taylor curve serves, by its last coefficients (Jorba and Zou, A software package for the
 * numerical integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14 (2005), section 3):
 * the step whose last term, of degree M, is a part tolerance / e^5 of the state. With M = 1 - ln(tolerance) / 2 that is
 * their step, the radius of convergence over e^2, times e^(-3/M). Their state is one vector, their tolerance absolute
 * where that is below 1, and their coefficients the last two. Here q and p are measured apart, each by its size or by
 * its movement in the step, so that no unit shows and a body may start at rest or at 0.
 *
 * Part of the text of generated code (emit.c), where every size is a constant. All others call the functions of
 * curve.h. */
#ifndef TVI_SRC_GENERATING_REACH_H
#define TVI_SRC_GENERATING_REACH_H

#include "generating/series.h"
#include "generating/taylor_sweep.h"

/* -log of the last term's part of a tolerance: 2 of theirs, and 3 for what errors gain in tens of revolutions. */
static const double REACH_SAFETY = 5;
/* The coefficients looked at, at the start, and at the end, where two in a row may happen to be small. */
enum { REACH_SIZED_BY = 2, REACH_LAST = 3 };

/* Coefficients that are not 0, in the order in which they are found: log max_i |x_k|. */
typedef struct {
    int count, k[REACH_LAST];
    double log[REACH_LAST];
} reach_list;

static inline void reach_add(reach_list *list, int k, double size)
{
    if (size == 0) return;
    list->k[list->count] = k;
    list->log[list->count++] = log(size);
}

/* Of q, or of p in the unit of kappa p, so that masses do not show. */
static inline double reach_size(const tvi_curve *curve, bool of_momentum, int k)
{
    if (!of_momentum) return tvi_largest(curve_n(curve), tvi_curve_Q(curve, k), 1);
    double size = 0;
    for (int i = 0; i < curve_n(curve); i++) size = tvi_larger(fabs(tvi_curve_U(curve, k, i)), size);
    return size;
}

/* The first ones and the last ones; of Q one more at the start, for p_k = (k + 1) q_{k+1} of a separable system. */
typedef struct {
    reach_list first, last;
} reach_ends;

static inline reach_ends reach_ends_of(const tvi_curve *curve, bool of_momentum, int degree)
{
    reach_ends ends = {{.count = 0}, {.count = 0}};
    const int firsts = REACH_SIZED_BY + (curve_form(curve) == TVI_SEPARABLE);
    for (int k = 0; k < degree && ends.first.count < firsts; k++)
        reach_add(&ends.first, k, reach_size(curve, of_momentum, k));
    for (int k = degree; k > 1 && ends.last.count < REACH_LAST; k--)
        reach_add(&ends.last, k, reach_size(curve, of_momentum, k));
    return ends;
}

/* log |(k + 1) q_{k+1}|. */
static inline reach_list reach_slope(const tvi_curve *curve, const reach_list *of_q)
{
    reach_list list = {.count = 0};
    for (int i = 0; i < of_q->count; i++) {
        const int k = of_q->k[i];
        if (k == 0) continue;
        list.k[list.count] = k - 1;
        list.log[list.count++] = of_q->log[i] + curve->log_of[k];
    }
    return list;
}

/* log of the largest s with s^k |x_k| <= part max |x_j| s^j, of the first x_j: the size of x along the curve is that of
 * the largest of their terms. No branches: which of two is the larger changes from step to step. */
static inline double reach_of_term(const tvi_curve *curve, const reach_list *first, int k, double log_k,
                                   double log_part)
{
    double reach[REACH_SIZED_BY];
    for (int i = 0; i < REACH_SIZED_BY; i++) {
        const bool is_before = i < first->count && first->k[i] < k;
        const int apart = is_before ? k - first->k[i] : 1;
        reach[i] = is_before ? (log_part + first->log[i] - log_k) * curve->per[apart] : -INFINITY;
    }
    const double farthest = tvi_larger(reach[0], reach[1]);
    return isfinite(farthest) ? farthest : INFINITY;
}

/* log of the least reach of the last coefficients. */
static inline double reach_of(const tvi_curve *curve, const reach_ends *ends, int degree, double log_part)
{
    double reach = INFINITY;
    for (int i = 0; i < ends->last.count; i++) {
        const int k = ends->last.k[i];
        if (k <= 1) continue;
        const double part = log_part * k * curve->per[degree];
        reach = tvi_smaller(reach_of_term(curve, &ends->first, k, ends->last.log[i], part), reach);
    }
    return reach;
}

static inline double curve_reach(const tvi_curve *curve, double tolerance)
{
    const int q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    const double log_part = log(tolerance) - REACH_SAFETY;
    const reach_ends q = reach_ends_of(curve, false, q_degree);
    reach_ends p;
    if (curve_form(curve) == TVI_SEPARABLE) p = (reach_ends){reach_slope(curve, &q.first), reach_slope(curve, &q.last)};
    else p = reach_ends_of(curve, true, p_degree);
    return exp(tvi_smaller(reach_of(curve, &q, q_degree, log_part), reach_of(curve, &p, p_degree, log_part)));
}

/* ---- The end of the step ----------------------------------------------------------------------------------------- */

#ifdef JET_EMITTED
#define REACH_SWEEP(curve, ...) taylor_sweep(__VA_ARGS__)
#else
#define REACH_SWEEP(curve, ...) tvi_taylor_loops_of((curve)->system)->sweep(__VA_ARGS__)
#endif

/* The rows of x, scaled, and their sums, to this degree; x_k above it are scaled too. */
static inline void reach_sweep_rows(const tvi_curve *curve, int components, int degree, const double power[], double *x,
                                    double *rise, double *size)
{
    const tvi_taylor_rows rows = {components, 1, degree, tvi_curve_slots(curve), false};
    const tvi_taylor_sums sums = {rise, size, NULL, NULL};
    for (int k = degree + 1; k <= curve_top(curve); k++)
        for (int i = 0; i < components; i++) x[(size_t)k * rows.stride + (size_t)i] *= power[k];
    REACH_SWEEP(curve, &rows, power, x, &sums);
}

/* Of a separable system all sums are of Q, and U_0 = Q_1 is no part of what kappa p rises by. */
static inline void reach_sweep_separable(const tvi_curve *curve, const double power[], double q[], double u[])
{
    const tvi_taylor_rows rows = {curve_n(curve), 2, curve_top(curve), tvi_curve_slots(curve), true};
    const tvi_taylor_sums sums = {q, curve->movement, u, curve->momentum};
    double *x1 = tvi_curve_input(curve, 1);
    REACH_SWEEP(curve, &rows, power, curve->x, &sums);
    for (int i = 0; i < curve_n(curve); i++) {
        curve->kappa[i] *= power[1];
        x1[i] *= power[1];
        q[i] += x1[i];
        curve->movement[i] += fabs(x1[i]);
        curve->momentum[i] += fabs(x1[i]);
    }
}

static inline void curve_end_at(tvi_curve *curve, double factor, double q[], double u[])
{
    const int n = curve_n(curve), q_degree = curve_q_degree(curve), p_degree = curve_p_degree(curve);
    const tvi_form form = curve_form(curve);
    double power[TVI_MAX_DEGREE + 2];
    power[0] = 1;
    power[1] = factor;
    for (int k = 2; k <= curve_top(curve); k++) power[k] = power[k / 2] * power[k - k / 2];
    curve->tau *= factor;
    if (form == TVI_SEPARABLE) {
        reach_sweep_separable(curve, power, q, u);
        return;
    }
    reach_sweep_rows(curve, n, q_degree, power, curve->x, q, curve->movement);
    if (form == TVI_HAMILTONIAN) reach_sweep_rows(curve, n, p_degree, power, curve->x + n, u, curve->momentum);
    for (int i = 0; i < n && form == TVI_LAGRANGIAN; i++)
        reach_sweep_rows(curve, 1, p_degree, power, curve->x + curve_slot(curve, n + i), u + i, curve->momentum + i);
    for (int i = 0; i < n; i++) curve->momentum[i] += fabs(tvi_curve_U(curve, 0, i));
}

#endif
