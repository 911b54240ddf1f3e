/* quadrature.c - Computes Gauss, Lobatto, trapezoid and rectangle rules for any number of nodes (quadrature.h). */
#include "algebra/quadrature.h"

#include <math.h>
#include <stdbool.h>

/* The properties of a rule. With as many nodes as `point_count`, its order is order_slope point_count +
 * order_offset. */
static const struct {
    int only_valid_point_count; /* The only number of nodes that the rule can have; 0: any number is possible. */
    int least_point_count, order_slope, order_offset;
    tvi_quadrature mirror; /* The rule whose nodes are those of this rule with the opposite sign. */
} rules[] = {
    [TVI_GAUSS] = {0, 1, 2, 0, TVI_GAUSS},
    [TVI_LOBATTO] = {0, 2, 2, -2, TVI_LOBATTO},
    [TVI_TRAPEZOID] = {2, 2, 0, 2, TVI_TRAPEZOID},
    [TVI_RECTANGLE_START] = {1, 1, 0, 1, TVI_RECTANGLE_END},
    [TVI_RECTANGLE_END] = {1, 1, 0, 1, TVI_RECTANGLE_START},
};

int tvi_quadrature_fixed_points(tvi_quadrature rule) { return rules[rule].only_valid_point_count; }

int tvi_quadrature_least_points(tvi_quadrature rule) { return rules[rule].least_point_count; }

int tvi_quadrature_order(tvi_quadrature rule, int point_count)
{
    return rules[rule].order_slope * point_count + rules[rule].order_offset;
}

tvi_quadrature tvi_quadrature_mirror(tvi_quadrature rule) { return rules[rule].mirror; }

/* Computes the Legendre polynomial P_n and its derivative P_n' at x by (k+1) P_{k+1} = (2k+1) x P_k - k P_{k-1} and (1
 * - x^2) P_n' = n (P_{n-1} - x P_n). */
static void evaluate_legendre_polynomial(int n, long double x, long double *P, long double *slope)
{
    long double before = 0;
    *P = 1;
    for (int k = 0; k < n; k++) {
        const long double next = ((2 * k + 1) * x * *P - k * before) / (k + 1);
        before = *P;
        *P = next;
    }
    *slope = n * (before - x * *P) / (1 - x * x);
}

enum { NEWTON_STEPS = 60 }; /* The limit of the iteration, which is never reached, since it stops at roundoff. */

/* Finds a node near x by Newton's method, and its weight. A Gauss node is a root of P_n, with the weight 2 / ((1 - x^2)
 * P_n'^2). An inner Lobatto node is a root of P_n', with (1 - x^2) P_n'' = 2 x P_n' - n (n+1) P_n and the weight 2 / (n
 * (n+1) P_n^2). */
static long double compute_node_and_weight(bool is_lobatto, int n, long double x, long double *weight)
{
    long double P, slope;
    for (int step = 0; step < NEWTON_STEPS; step++) {
        evaluate_legendre_polynomial(n, x, &P, &slope);
        const long double curvature = (2 * x * slope - n * (n + 1) * P) / (1 - x * x);
        const long double correction = is_lobatto ? slope / curvature : P / slope;
        x -= correction;
        if (fabsl(correction) <= 1e-18L) break;
    }
    evaluate_legendre_polynomial(n, x, &P, &slope);
    *weight = is_lobatto ? 2 / (n * (n + 1) * P * P) : 2 / ((1 - x * x) * slope * slope);
    return x;
}

/* Computes one half of the nodes by Newton's method, and the other half by symmetry. The end nodes of Lobatto are
 * known. */
static void compute_symmetric_nodes(bool is_lobatto, int point_count, long double node[], long double weight[])
{
    const long double pi = 3.141592653589793238462643383279502884L;
    for (int i = 0; i < (point_count + 1) / 2; i++) {
        const int mirror = point_count - 1 - i;
        const long double angle = is_lobatto ? pi * i / (point_count - 1) : pi * (i + 0.75L) / (point_count + 0.5L);
        if (is_lobatto && i == 0) {
            node[i] = -1;
            weight[i] = 2 / ((long double)point_count * (point_count - 1));
        } else {
            node[i] = compute_node_and_weight(is_lobatto, point_count - is_lobatto, i == mirror ? 0 : -cosl(angle),
                                              &weight[i]);
        }
        node[mirror] = -node[i];
        weight[mirror] = weight[i];
    }
}

void tvi_quadrature_compute_nodes(tvi_quadrature rule, int point_count, long double node[], long double weight[])
{
    switch (rule) {
    case TVI_TRAPEZOID:
        node[0] = -1, node[1] = 1;
        weight[0] = weight[1] = 1;
        break;
    case TVI_RECTANGLE_START: node[0] = -1, weight[0] = 2; break;
    case TVI_RECTANGLE_END: node[0] = 1, weight[0] = 2; break;
    default: compute_symmetric_nodes(rule == TVI_LOBATTO, point_count, node, weight);
    }
}
