/* lagrangian_loops.h - the algebra of second derivatives at all nodes of a Galerkin curve, compiled once for each
 * instruction set. Numbers of one node are a lane: x[i] of node k stands at x[i * lanes + k]. */
#ifndef TVI_SRC_LAGRANGIAN_LOOPS_H
#define TVI_SRC_LAGRANGIAN_LOOPS_H

#include "system.h"

/* A matrix of n rows at each node. */
typedef struct {
    int n, lanes;
    double *lu;                       /* [n][n][lanes] fill it, then factor; the factor replaces it */
    double *row_scale, *column_scale; /* [n][lanes] */
    int *pivot;                       /* [n][lanes] */
} tvi_lanes_factor;

typedef struct {
    /* P L U of every lane. Returns the smallest pivot, relative to rows and columns of size 1: 0 where a matrix
     * has a NaN. */
    double (*factor)(const tvi_lanes_factor *factor);
    /* x <- A^-1 x, [n][lanes]. */
    void (*solve)(const tvi_lanes_factor *factor, double *x);
    /* out += S d, [2n][lanes], S symmetric: its element k, at (row, column) and (column, row), is the slot output[k] of
     * the block x. */
    void (*multiply)(int lanes, int count, const tvi_second *second, const int output[], const double *x,
                     const double *d, double *out);
} lagrangian_loops;

extern const lagrangian_loops lagrangian_loops_base, lagrangian_loops_avx2, lagrangian_loops_avx512;

#endif
