/* coefficients.h - Computes the coefficients of Gauss collocation, as they act on impulses (docs/method.md section
 * 6). */
#ifndef TVI_SRC_GALERKIN_COEFFICIENTS_H
#define TVI_SRC_GALERKIN_COEFFICIENTS_H

#include "galerkin/dense.h"

typedef struct {
    int node_count, lanes;
    double *node_weight, *node_abscissa; /* [lanes] */
    /* The reciprocal of the weight of the first and of the last node. */
    double inverse_end_weight;
    /* [j][i] The factor of the impulse of node j in an unknown at node i. */
    double *impulse_matrix;
    galerkin_end_weights end_weights;
    long double long_abscissa[TVI_GALERKIN_MAX_LANES], long_weight[TVI_GALERKIN_MAX_LANES];
} galerkin_coefficients;

void tvi_galerkin_allocate_coefficients(galerkin_coefficients *coefficients, tvi_arena *arena, int node_count,
                                        int lanes);
/* Computes the coefficients for Q'' = F if is_second_order is set, and for Q' = V, P' = F otherwise. It also
 * prepares the polynomials, whose integrals the coefficients use. */
void tvi_galerkin_compute_coefficients(galerkin_coefficients *coefficients, galerkin_node_polynomials *polynomials,
                                       bool is_second_order);
#endif
