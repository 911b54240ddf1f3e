/* dense.h - Computes the polynomials l_j / b_j and their integrals, with l_j 1 at node j of the Galerkin curve and 0 at
 * the others. The impulses at the nodes, h b_j F_j, times these give the curve at other points. */
#ifndef TVI_SRC_GALERKIN_DENSE_H
#define TVI_SRC_GALERKIN_DENSE_H

#include "galerkin/loops.h"
#include "method/stepper.h"

typedef struct {
    int points;
    const jet_sweeps *sweeps;
    double *shape;                                    /* [k][j] l_j(s) / b_j = sum_k shape_kj P_k(2 s - 1) */
    long double inverse[TVI_GALERKIN_MAX_LANES + 2];  /* [k] 1 / k */
    long double integral[TVI_GALERKIN_MAX_LANES + 1]; /* [k] 1 / (4 k + 2) */
    double *of_node;                                  /* [j][lanes] the same */
    double *once, *twice;                             /* [lanes][TVI_SAMPLES] integrals up to the sample points */
} galerkin_dense;

void tvi_galerkin_dense_take(galerkin_dense *dense, tvi_arena *arena, int points, int lanes, const jet_sweeps *sweeps);
/* Prepares the tables for the Gauss nodes of [0, 1]. */
void tvi_galerkin_dense_prepare(galerkin_dense *dense, int lanes, const long double node[]);
/* Computes P[k][i] = P_k(2 s_i - 1), k < points, i < lanes. */
void tvi_galerkin_dense_legendre(const galerkin_dense *dense, int lanes, const double s[], double *P);
/* Computes once[j] = int_0^s l_j / b_j, from the Gauss nodes. */
void tvi_galerkin_dense_once(const galerkin_dense *dense, long double s, const long double node[], long double once[]);
/* Computes once[j] = int_0^s l_j / b_j and twice[j] = int_0^s (s - r) l_j(r) / b_j dr. */
void tvi_galerkin_dense_integrate(const galerkin_dense *dense, double s, double once[], double twice[]);

#endif
