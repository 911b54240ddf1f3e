/* galerkin_dense.h - integrals of the polynomials l_j, 1 at node j of the Galerkin curve and 0 at the others: what
 * makes of what drives the curve its places between the ends of the step. */
#ifndef TVI_SRC_GALERKIN_DENSE_H
#define TVI_SRC_GALERKIN_DENSE_H

#include "arena.h"

typedef struct {
    int points;
    double *shape;        /* [k][j] l_j(s) = sum_k shape_kj P_k(2 s - 1) */
    double *once, *twice; /* [j][TVI_SAMPLES] integrals to the sample places */
} galerkin_dense;

void galerkin_dense_take(galerkin_dense *dense, tvi_arena *arena, int points);
/* Gauss nodes and weights of [0, 1]. */
void galerkin_dense_prepare(galerkin_dense *dense, const long double node[], const long double weight[]);
/* once[j] = int_0^s l_j and twice[j] = int_0^s (s - r) l_j(r) dr, j * stride standing for j. */
void galerkin_dense_integrate(const galerkin_dense *dense, double s, int stride, double once[], double twice[]);

#endif
