/* galerkin.h - the loops of the Galerkin curve in which all time but that of the field goes, compiled once for each
 * instruction set (ad/vector.h). Arrays of nodes are [lanes]; where lanes are more than nodes, the last node is
 * repeated, with weight 0. */
#ifndef TVI_SRC_GALERKIN_H
#define TVI_SRC_GALERKIN_H

#include "lagrangian_loops.h"

/* The numbers of lanes that there are: 1, 2, 4, 8 and MAX_LANES. */
enum { TVI_GALERKIN_MAX_LANES = 12 };

/* The sums over the nodes: b_j and b_j (1 - c_j), each in two parts, of which the first is short. What a rounded weight
 * lacks is the same in every step, and the energy would drift by it; of two doubles the second would be lost when the
 * sums are added. They are as many as lanes of the widest vector; the last ones stay 0. */
enum { SUM_B, SUM_B_REST, SUM_BC, SUM_BC_REST, SUM_TAIL, SUMS = 8 };

/* Unknown u of node i stands at x[u][i]. What drives it is F_j = drives[slot[u]][j]. */
typedef struct {
    int lanes, unknowns;
    double *x;
    double *start;        /* [unknowns] the unknowns at the start of the step */
    double *base;         /* [unknowns][lanes] what they rise by without F */
    double *scale;        /* [unknowns] what multiplies the sums of F */
    double *inverse_size; /* [unknowns] */
} galerkin_nodes;

/* out[u][k] = start[u] + (theta[k] drift[u] + scale[u] sum_j table_jk drives[u][j]), u < count, k < places: 1, all
 * lanes or TVI_SAMPLES; table [lanes][places]. */
typedef struct {
    int lanes, places, count;
    const double *theta, *start, *drift, *scale;
} galerkin_places;

typedef struct {
    /* x = start + (base + scale sum_j matrix_ji F_j). Returns the sum of the squares of (change of x) inverse_size, a
     * NaN where there is one. */
    double (*move)(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[]);
    /* The same with what drove the unknowns in earlier steps: drives[step][u][j], matrix [steps][j][i]. */
    void (*predict)(const galerkin_nodes *nodes, int steps, const double *matrix, const double *const drives[]);
    /* sum[u][k] = sum_j weight_jk F_j, F of nodes->x; last[u][j] = F_j. */
    void (*integrate)(const galerkin_nodes *nodes, const double *weight, const int slot[], double *sum, double *last);
    /* base_i = c_i drift, c in two parts, for the first `count` unknowns. */
    void (*set_base)(const galerkin_nodes *nodes, int count, const double *c, const double *c_rest,
                     const double *drift);
    void (*place)(const galerkin_places *places, const double *table, const double *drives, double *out);
    const lagrangian_loops *lagrangian;
} galerkin_loops;

extern const galerkin_loops galerkin_loops_base, galerkin_loops_avx2, galerkin_loops_avx512;

#endif
