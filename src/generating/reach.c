/* reach.c - how far a Taylor curve serves, by its last coefficients (Jorba and Zou, A software package for the
 * numerical integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14 (2005), section 3):
 * the step whose last term, of degree M, is a part tolerance / e^5 of the state. With M = 1 - ln(tolerance) / 2 that is
 * their step, the radius of convergence over e^2, times e^(-3/M). Their state is one
 * vector, their tolerance absolute where that is below 1, and their coefficients the last two. Here q and p are
 * measured apart, each by its size or by its movement in the step, so that no unit shows and a body may start at rest
 * or at 0. */
#include "generating/curve.h"
#include "algebra/sizes.h"

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

/* The first coefficients that are not 0: the size of x along the curve is that of the largest of their terms. */
typedef struct {
    int count, k[SIZED_BY];
    double log[SIZED_BY]; /* |x_k| */
} start;

static start start_of(const series *x, int degree)
{
    start first = {.count = 0};
    for (int k = 0; k < degree && first.count < SIZED_BY; k++) {
        const double at_k = size_of(x, k);
        if (at_k == 0) continue;
        first.k[first.count] = k;
        first.log[first.count++] = log(at_k);
    }
    return first;
}

/* log of the largest s with s^k |x_k| <= part max |x_j| s^j. */
static double reach_of_term(const start *first, int k, double log_k, double log_part)
{
    double reach = -INFINITY;
    for (int i = 0; i < first->count && first->k[i] < k; i++)
        reach = tvi_larger((log_part + first->log[i] - log_k) / (k - first->k[i]), reach);
    return isfinite(reach) ? reach : INFINITY;
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

void tvi_curve_rescale(tvi_curve *curve, double factor)
{
    const int n = curve->n;
    const tvi_form form = curve->system->form;
    const int *momentum = curve->system->field_series->output + n;
    double power = 1;
    curve->tau *= factor;
    for (int i = 0; i < n && form == TVI_SEPARABLE; i++) curve->kappa[i] *= factor;
    for (int k = 1; k <= curve->top; k++) {
        double *x = tvi_curve_input(curve, k);
        power *= factor;
        for (int i = 0; i < n; i++) x[i] *= power;
        for (int i = 0; i < n && form == TVI_HAMILTONIAN; i++) x[n + i] *= power;
        for (int i = 0; i < n && form == TVI_LAGRANGIAN; i++) x[momentum[i]] *= power;
    }
}
