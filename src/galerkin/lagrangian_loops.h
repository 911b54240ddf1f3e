/* lagrangian_loops.h - the algebra of the second derivatives of a Lagrangian at the nodes of a Galerkin curve, compiled
 * once for each instruction set. Numbers of a node are a lane: x[i] of node k stands at x[i * lanes + k]. */
#ifndef TVI_SRC_LAGRANGIAN_LOOPS_H
#define TVI_SRC_LAGRANGIAN_LOOPS_H

#include <stdbool.h>

/* A matrix A of n rows at each node. */
typedef struct {
    int n, lanes;
    double *lu;                       /* [n][n][lanes] A: fill it, then invert, which may leave its factors there */
    double *inverse;                  /* [n][n][lanes] */
    double *row_scale, *column_scale; /* [n][lanes] */
    int *pivot;                       /* [n][lanes] */
    bool exchanges;                   /* there is a row that is not its own pivot */
    double *x;                        /* [n][lanes] scratch */
} lanes_inverse;

/* Element (i, column) of a matrix, in a slot of a block. */
typedef struct {
    int column, slot;
} lanes_term;

/* The gradient of L(q, v) to first order about where it was evaluated, at each node. */
typedef struct {
    int n, lanes;
    double *moved;          /* [2n][lanes] how far from where it was evaluated; */
    const double *gradient; /* [2n][lanes] there */
    const double *second;   /* the block of the second derivatives, */
    const lanes_term *term; /* those that are not 0, row after row, */
    const int *end;         /* [2n] and where the row ends */
} lanes_model;

/* Second derivatives at each node: what drives unknowns, the rows, by the movement of those that move and that
 * something else depends on, the columns. The rows are those of the columns, then those that nothing depends on: both
 * in groups of LANES_ROWS, whose sums do not wait for each other, then of half as many, and so on. */
enum { LANES_ROWS = 4 };
static inline int lanes_group(int rows) { return rows >= LANES_ROWS ? LANES_ROWS : rows >= 2 ? 2 : 1; }
typedef struct {
    int count, moving, rows; /* columns, their rows, all rows */
    const int *unknown;      /* [rows] */
    const int *place;        /* group by group [count][group] in the block of the second derivatives: */
    const double *second;    /* it has zeros, too */
    float *matrix;           /* of a movement, [lanes][lanes] */
    float *packed;           /* the same, [count][group][lanes] */
    double *size, *per_size; /* [rows] of the unknowns, in this step */
    float *change, *total;   /* [rows][lanes] the last round's, and all with the movement, */
    float *impulse, *all;    /* [rows][lanes] and the impulses by both */
} lanes_rounds;

typedef struct {
    /* In every lane. Returns the smallest pivot, relative to rows and columns of size 1, or 1 where all pivots are as
     * large as what stood on the diagonal, or nearly; 0 where there is a NaN. */
    double (*invert)(lanes_inverse *of);
    /* V = from + A^-1 ((P - p) - change), [n][lanes] each. */
    void (*correct)(const lanes_inverse *of, const double *P, const double *p, const double *change, const double *from,
                    double *V);
    /* out = L_q after the movement, [n][lanes], and what that of q alone changes in L_v. */
    void (*linearise)(const lanes_model *model, double *out);
} lagrangian_loops;

extern const lagrangian_loops tvi_lagrangian_loops_base, tvi_lagrangian_loops_avx2, tvi_lagrangian_loops_avx512;

#endif
