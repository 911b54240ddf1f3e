/* gauss_tableau.c - Computes the coefficients of Gauss collocation (gauss_tableau.h). */
#include "gauss_tableau.h"

#include <math.h>

/* P_s(x) and its derivative: (k + 1) P_{k+1} = (2 k + 1) x P_k - k P_{k-1}, (x^2 - 1) P_s' = s (x P_s - P_{s-1}). */
static long double legendre(int s, long double x, long double *slope)
{
    long double p = x, before = 1;
    for (int k = 1; k < s; k++) {
        const long double next = ((2 * k + 1) * x * p - k * before) / (k + 1);
        before = p;
        p = next;
    }
    *slope = s * (x * p - before) / (x * x - 1);
    return p;
}

/* The roots of P_s by Newton from cos(pi (i + 3/4) / (s + 1/2)), and the weights 2 / ((1 - x^2) P_s'(x)^2), on [0,
 * 1]. */
static void set_nodes(gauss_tableau *t)
{
    for (int i = 0; i < t->s; i++) {
        long double x = -cosl(acosl(-1) * (i + 0.75L) / (t->s + 0.5L)), slope;
        for (int pass = 0; pass < 6; pass++) x -= legendre(t->s, x, &slope) / slope;
        legendre(t->s, x, &slope);
        t->node[i] = (1 + x) / 2;
        t->weight[i] = 1 / ((1 - x * x) * slope * slope);
    }
}

/* l_j(x), the polynomial that is 1 at node j and 0 at the others. */
static long double lagrange(const gauss_tableau *t, int j, long double x)
{
    long double product = 1;
    for (int k = 0; k < t->s; k++)
        if (k != j) product *= (x - t->node[k]) / (t->node[j] - t->node[k]);
    return product;
}

/* A_ij = int_0^{c_i} l_j(t) dt by the rule itself on [0, c_i]: exact, as the integrand has degree s - 1. */
static long double integrated(const gauss_tableau *t, int i, int j)
{
    long double sum = 0;
    for (int k = 0; k < t->s; k++) sum += t->weight[k] * lagrange(t, j, t->node[i] * t->node[k]);
    return t->node[i] * sum;
}

/* A, and the product A A. It is not int_0^{c_i} (c_i - t) l_j(t) dt, which makes a method of the same order that is not
 * symplectic: the integral of l_j is no polynomial of degree s - 1. */
static void set_matrix(gauss_tableau *t)
{
    long double(*A)[GAUSS_STAGES_MAX] = t->first_order;
    for (int i = 0; i < t->s; i++)
        for (int j = 0; j < t->s; j++) A[i][j] = integrated(t, i, j);
    for (int i = 0; i < t->s; i++)
        for (int j = 0; j < t->s; j++) {
            t->matrix[i][j] = 0;
            for (int k = 0; k < t->s; k++) t->matrix[i][j] += A[i][k] * A[k][j];
        }
}

static void make(gauss_tableau *t)
{
    set_nodes(t);
    set_matrix(t);
    for (int j = 0; j < t->s; j++) {
        t->position_weight[j] = t->weight[j] * (1 - t->node[j]);
        for (int i = 0; i < t->s; i++) t->extrapolation[i][j] = lagrange(t, j, 1 + t->node[i]);
    }
}

const gauss_tableau *gauss_tableau_of(int s)
{
    static gauss_tableau tableaus[GAUSS_STAGES_MAX + 1];
    gauss_tableau *t = &tableaus[s];
    if (t->s == 0) {
        t->s = s;
        make(t);
    }
    return t;
}
