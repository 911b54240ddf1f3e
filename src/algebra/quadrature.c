/* quadrature.c - Computes Gauss, Lobatto, trapezoid and rectangle rules for any number of nodes (quadrature.h). */
#include "algebra/quadrature.h"

#include <math.h>

int tvi_quadrature_only_point_count(tvi_quadrature rule)
{
    switch (rule) {
    case TVI_TRAPEZOID: return 2;
    case TVI_RECTANGLE_START:
    case TVI_RECTANGLE_END: return 1;
    default: return 0;
    }
}

int tvi_quadrature_least_point_count(tvi_quadrature rule)
{
    const int fixed = tvi_quadrature_only_point_count(rule);
    return fixed ? fixed : rule == TVI_LOBATTO ? 2 : 1;
}

int tvi_quadrature_order(tvi_quadrature rule, int points)
{
    switch (rule) {
    case TVI_LOBATTO: return 2 * points - 2;
    case TVI_TRAPEZOID: return 2;
    case TVI_RECTANGLE_START:
    case TVI_RECTANGLE_END: return 1;
    default: return 2 * points;
    }
}

tvi_quadrature tvi_quadrature_mirror(tvi_quadrature rule)
{
    switch (rule) {
    case TVI_RECTANGLE_START: return TVI_RECTANGLE_END;
    case TVI_RECTANGLE_END: return TVI_RECTANGLE_START;
    default: return rule;
    }
}

/* Computes P_n(x) and P_{n-1}(x) by (k+1) P_{k+1} = (2k+1) x P_k - k P_{k-1}. */
static void evaluate_legendre_polynomials(int n, long double x, long double *P, long double *P_before)
{
    long double now = 1, before = 0;
    for (int k = 0; k < n; k++) {
        const long double next = ((2 * k + 1) * x * now - k * before) / (k + 1);
        before = now;
        now = next;
    }
    *P = now;
    *P_before = before;
}

enum { NEWTON_STEPS = 60 }; /* Never reached, since the iteration stops at roundoff. */

/* Finds the root of P_n near x by Newton's method, with (1 - x^2) P_n' = n (P_{n-1} - x P_n). Its weight is 2 / ((1
 * - x^2) P_n'^2). */
static long double refine_gauss_node(int n, long double x, long double *weight)
{
    long double P, before, slope = 1;
    for (int step = 0; step < NEWTON_STEPS; step++) {
        evaluate_legendre_polynomials(n, x, &P, &before);
        slope = n * (before - x * P) / (1 - x * x);
        const long double correction = P / slope;
        x -= correction;
        if (fabsl(correction) <= 1e-18L) break;
    }
    evaluate_legendre_polynomials(n, x, &P, &before);
    slope = n * (before - x * P) / (1 - x * x);
    *weight = 2 / ((1 - x * x) * slope * slope);
    return x;
}

/* Finds the root of P_n' near x, n = points - 1, by Newton's method, with (1 - x^2) P_n'' = 2 x P_n' - n (n+1) P_n.
 * Its weight is 2 / (n (n+1) P_n^2). */
static long double refine_lobatto_node(int n, long double x, long double *weight)
{
    long double P, before;
    for (int step = 0; step < NEWTON_STEPS; step++) {
        evaluate_legendre_polynomials(n, x, &P, &before);
        const long double slope = n * (before - x * P) / (1 - x * x);
        const long double curvature = (2 * x * slope - n * (n + 1) * P) / (1 - x * x);
        const long double correction = slope / curvature;
        x -= correction;
        if (fabsl(correction) <= 1e-18L) break;
    }
    evaluate_legendre_polynomials(n, x, &P, &before);
    *weight = 2 / (n * (n + 1) * P * P);
    return x;
}

/* Computes one half of the nodes by Newton's method, and the other half by symmetry. */
static void compute_symmetric_nodes(tvi_quadrature rule, int points, long double node[], long double weight[])
{
    const long double pi = 3.141592653589793238462643383279502884L;
    for (int i = 0; i < (points + 1) / 2; i++) {
        const int mirror = points - 1 - i;
        long double x;
        if (rule == TVI_LOBATTO && i == 0) {
            x = -1;
            weight[i] = 2 / ((long double)points * (points - 1));
        } else if (i == mirror) {
            x = 0;
            if (rule == TVI_LOBATTO) (void)refine_lobatto_node(points - 1, 0, &weight[i]);
            else (void)refine_gauss_node(points, 0, &weight[i]);
        } else if (rule == TVI_LOBATTO) {
            x = refine_lobatto_node(points - 1, -cosl(pi * i / (points - 1)), &weight[i]);
        } else {
            x = refine_gauss_node(points, -cosl(pi * (i + 0.75L) / (points + 0.5L)), &weight[i]);
        }
        node[i] = x;
        node[mirror] = -x;
        weight[mirror] = weight[i];
    }
}

void tvi_quadrature_compute_nodes(tvi_quadrature rule, int points, long double node[], long double weight[])
{
    switch (rule) {
    case TVI_TRAPEZOID:
        node[0] = -1, node[1] = 1;
        weight[0] = weight[1] = 1;
        break;
    case TVI_RECTANGLE_START: node[0] = -1, weight[0] = 2; break;
    case TVI_RECTANGLE_END: node[0] = 1, weight[0] = 2; break;
    default: compute_symmetric_nodes(rule, points, node, weight);
    }
}
