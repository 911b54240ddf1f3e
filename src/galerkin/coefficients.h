/* coefficients.h - Computes the coefficients of Gauss collocation, as they act on impulses (docs/method.md section
 * 6). */
#ifndef TVI_SRC_GALERKIN_COEFFICIENTS_H
#define TVI_SRC_GALERKIN_COEFFICIENTS_H

#include "galerkin/dense.h"

typedef struct {
    int points, lanes;
    double *b, *c;    /* [lanes] */
    double inverse_b; /* of the first and the last node */
    double *matrix;   /* [j][i] factor of impulse j in an unknown at node i */
    galerkin_weights weights;
    long double exact_node[TVI_GALERKIN_MAX_LANES], exact_weight[TVI_GALERKIN_MAX_LANES];
} galerkin_coefficients;

void tvi_galerkin_coefficients_take(galerkin_coefficients *w, tvi_arena *arena, int points, int lanes);
/* Computes the coefficients for Q'' = F, or for Q' = V, P' = F. It also prepares the dense output, whose integrals they
 * use. */
void tvi_galerkin_coefficients_prepare(galerkin_coefficients *w, galerkin_dense *dense, bool is_second_order);
#endif
