/* quadrature.h - Computes the nodes and weights of quadrature rules on [-1, 1]. The discrete actions of Taylor curves
 * and the Galerkin curve are computed by these rules. */
#ifndef TVI_SRC_ALGEBRA_QUADRATURE_H
#define TVI_SRC_ALGEBRA_QUADRATURE_H

#include "tvi.h"

/* The largest number of nodes, which suffices for every order of every rule. */
enum { TVI_MAX_POINTS = TVI_MAX_DEGREE + 2 };

/* Returns the only number of nodes that a trapezoid or rectangle rule can have. Returns 0 for Gauss and Lobatto, which
 * exist with any number of nodes. */
int tvi_quadrature_fixed_points(tvi_quadrature rule);

/* Returns the smallest number of nodes of the rule. */
int tvi_quadrature_least_points(tvi_quadrature rule);

/* Returns the order s: polynomials up to degree s - 1 are integrated exactly. */
int tvi_quadrature_order(tvi_quadrature rule, int point_count);

/* Returns the rule whose nodes are those of this rule with the opposite sign. */
tvi_quadrature tvi_quadrature_mirror(tvi_quadrature rule);

/* Computes the nodes in ascending order, and weights whose sum is 2. A node at an end is exactly -1 or 1. Symmetric
 * nodes and weights are equal bit for bit. */
void tvi_quadrature_compute_nodes(tvi_quadrature rule, int point_count, long double node[], long double weight[]);

#endif
