/* galerkin_dense.h - the polynomials l_j, 1 at node j of the Galerkin curve and 0 at the others, and their integrals:
 * what makes of the curve's nodes its other places. */
#ifndef TVI_SRC_GALERKIN_DENSE_H
#define TVI_SRC_GALERKIN_DENSE_H

#include "galerkin.h"
#include "stepper.h"

typedef struct {
    int points;
    const jet_sweeps *sweeps;
    double *shape;        /* [k][j] l_j(s) = sum_k shape_kj P_k(2 s - 1) */
    double *of_node;      /* [j][k] the same, [lanes][lanes] */
    double *once, *twice; /* [lanes][TVI_SAMPLES] integrals to the sample places */
    long double part[TVI_GALERKIN_MAX_LANES + 1], integral[TVI_GALERKIN_MAX_LANES + 1]; /* [k] k/(k+1), 1/(4k+2) */
} galerkin_dense;

void galerkin_dense_take(galerkin_dense *dense, tvi_arena *arena, int points, int lanes, const jet_sweeps *sweeps);
/* Gauss nodes and weights of [0, 1]. */
void galerkin_dense_prepare(galerkin_dense *dense, int lanes, const long double node[], const long double weight[]);
/* P[k][i] = P_k(2 s_i - 1), k < points, i < lanes. */
void galerkin_dense_legendre(const galerkin_dense *dense, int lanes, const double s[], double *P);
/* once[j] = int_0^s l_j and twice[j] = int_0^s (s - r) l_j(r) dr. */
void galerkin_dense_integrate(const galerkin_dense *dense, double s, double once[], double twice[]);

#endif
