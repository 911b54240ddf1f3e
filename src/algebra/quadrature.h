/* quadrature.h - Computes nodes and weights of quadratures on [-1, 1]. */
#ifndef TVI_SRC_ALGEBRA_QUADRATURE_H
#define TVI_SRC_ALGEBRA_QUADRATURE_H

#include "tvi.h"

enum { TVI_MAX_POINTS = TVI_MAX_DEGREE + 2 }; /* enough for every order of every rule */

/* The number of nodes of a rule that has only one size; 0 for Gauss and Lobatto, which take any. */
int tvi_quadrature_fixed_points(tvi_quadrature rule);

/* The fewest nodes of the rule. */
int tvi_quadrature_least_points(tvi_quadrature rule);

/* The order s: polynomials up to degree s - 1 are integrated exactly. */
int tvi_quadrature_order(tvi_quadrature rule, int points);

/* The rule whose nodes are those of this one with their signs changed. */
tvi_quadrature tvi_quadrature_mirrored(tvi_quadrature rule);

/* Computes nodes in ascending order, and weights with the sum 2. A node at an end is exactly -1 or 1; symmetric nodes
 * and weights are equal bit for bit. */
void tvi_quadrature_nodes(tvi_quadrature rule, int points, long double node[], long double weight[]);

#endif
