/* reach.c - how far a Taylor curve serves, by its last coefficients (Jorba and Zou, A software package for the
 * numerical integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14 (2005), section 3):
 * the step whose last term, of degree M, is a part tolerance / e^5 of the state. With M = 1 - ln(tolerance) / 2 that is
 * their step, the radius of convergence over e^2, times e^(-3/M). Their state is one
 * vector, their tolerance absolute where that is below 1, and their coefficients the last two. Here q and p are
 * measured apart, each by its size or by its movement in the step, so that no unit shows and a body may start at rest
 * or at 0. */
#include "generating/curve.h"
#include "algebra/sizes.h"
#include "generating/taylor_loops.h"

#include <math.h>

/* -log of the last term's part of a tolerance: 2 of theirs, and 3 for what errors gain in tens of revolutions. */
static const double SAFETY = 5;
/* The coefficients looked at, at the end, where two in a row may happen to be small, and at the start. */
enum { LAST = 3, SIZED_BY = 2 };

/* Of the coefficients x_k of q or of p. */
typedef struct {
    const tvi_curve *curve;
    bool of_momentum;
} series;

/* max_i |x_k|, of p in the unit of kappa p, so that masses do not show. */
static double size_of(const series *x, int k)
{
    const tvi_curve *curve = x->curve;
    if (!x->of_momentum) return tvi_largest(curve->n, tvi_curve_Q(curve, k), 1);
    if (curve->system->form == TVI_SEPARABLE) return (k + 1) * tvi_largest(curve->n, tvi_curve_Q(curve, k + 1), 1);
    double size = 0;
    for (int i = 0; i < curve->n; i++) size = tvi_larger(fabs(tvi_curve_U(curve, k, i)), size);
    return size;
}

/* The first coefficients that are not 0: the size of x along the curve is that of the largest of their terms. Those
 * that there are not have log |x_k| = -INFINITY. */
typedef struct {
    int k[SIZED_BY];
    double log[SIZED_BY]; /* |x_k| */
} start;

static start start_of(const series *x, int degree)
{
    start first = {{0, 0}, {-INFINITY, -INFINITY}};
    for (int k = 0, count = 0; k < degree && count < SIZED_BY; k++) {
        const double at_k = size_of(x, k);
        if (at_k == 0) continue;
        first.k[count] = k;
        first.log[count++] = log(at_k);
    }
    return first;
}

/* log of the largest s with s^k |x_k| <= part max |x_j| s^j. No branches: which of two is the larger changes from step
 * to step. */
static double reach_of_term(const start *first, int k, double log_k, double log_part)
{
    double reach[SIZED_BY];
    for (int i = 0; i < SIZED_BY; i++)
        reach[i] = first->k[i] < k ? (log_part + first->log[i] - log_k) / (k - first->k[i]) : -INFINITY;
    const double farthest = tvi_larger(reach[0], reach[1]);
    return isfinite(farthest) ? farthest : INFINITY;
}

/* log of the least reach of the last coefficients that are not 0. */
static double reach_of(const series *x, int degree, double log_part)
{
    const start first = start_of(x, degree);
    double reach = INFINITY;
    for (int k = degree, seen = 0; k > 1 && seen < LAST; k--) {
        const double at_k = size_of(x, k);
        if (at_k == 0) continue;
        reach = tvi_smaller(reach_of_term(&first, k, log(at_k), log_part * k / degree), reach);
        seen++;
    }
    return reach;
}

double tvi_curve_reach(const tvi_curve *curve, int q_degree, int p_degree, double tolerance)
{
    const series q = {curve, false}, p = {curve, true};
    const double log_part = log(tolerance) - SAFETY;
    return exp(tvi_smaller(reach_of(&q, q_degree, log_part), reach_of(&p, p_degree, log_part)));
}

/* The rows of x, scaled, and their sums, to this degree; x_k above it are scaled too. */
static void sweep_rows(const tvi_curve *curve, int components, int degree, const double power[], double *x,
                       double *rise, double *size)
{
    const tvi_taylor_rows rows = {components, 1, degree, tvi_curve_slots(curve), false};
    const tvi_taylor_sums sums = {rise, size, NULL, NULL};
    for (int k = degree + 1; k <= curve->top; k++)
        for (int i = 0; i < components; i++) x[(size_t)k * rows.stride + (size_t)i] *= power[k];
    tvi_taylor_loops_of(curve->system)->sweep(&rows, power, x, &sums);
}

/* Of a separable system all sums are of Q, and U_0 = Q_1 is no part of what kappa p rises by. */
static void sweep_separable(const tvi_curve *curve, const double power[], double q[], double u[])
{
    const tvi_taylor_rows rows = {curve->n, 2, curve->top, tvi_curve_slots(curve), true};
    const tvi_taylor_sums sums = {q, curve->movement, u, curve->momentum};
    double *x1 = tvi_curve_input(curve, 1);
    tvi_taylor_loops_of(curve->system)->sweep(&rows, power, curve->x, &sums);
    for (int i = 0; i < curve->n; i++) {
        curve->kappa[i] *= power[1];
        x1[i] *= power[1];
        q[i] += x1[i];
        curve->movement[i] += fabs(x1[i]);
        curve->momentum[i] += fabs(x1[i]);
    }
}

void tvi_curve_end_at(tvi_curve *curve, double factor, double q[], double u[])
{
    const int n = curve->n, *momentum = curve->system->field_series->output + n;
    const tvi_form form = curve->system->form;
    double power[TVI_MAX_DEGREE + 2];
    power[0] = 1;
    power[1] = factor;
    for (int k = 2; k <= curve->top; k++) power[k] = power[k / 2] * power[k - k / 2];
    curve->tau *= factor;
    if (form == TVI_SEPARABLE) {
        sweep_separable(curve, power, q, u);
        return;
    }
    sweep_rows(curve, n, curve->q_degree, power, curve->x, q, curve->movement);
    if (form == TVI_HAMILTONIAN) sweep_rows(curve, n, curve->p_degree, power, curve->x + n, u, curve->momentum);
    for (int i = 0; i < n && form == TVI_LAGRANGIAN; i++)
        sweep_rows(curve, 1, curve->p_degree, power, curve->x + momentum[i], u + i, curve->momentum + i);
    for (int i = 0; i < n; i++) curve->momentum[i] += fabs(tvi_curve_U(curve, 0, i));
}
