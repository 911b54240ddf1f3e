/* curve_loops.h - declares the loops of the corrected curves of several members at once (curve_batch.c), compiled once
 * for each instruction set. Arrays are [rows][width], the member fastest, so that no sum runs across lanes; the width
 * is a multiple of 8. */
#ifndef TVI_SRC_GENERATING_CURVE_LOOPS_H
#define TVI_SRC_GENERATING_CURVE_LOOPS_H

#include "method/descriptor.h"

/* These weigh sums of rows: sum number o has the weights weight[o * per_out + r * per_row] of rows r. */
typedef struct {
    double *weight;
    int outs, rows;
    size_t per_out, per_row;
} tvi_weights;

/* These are the data of one step: [2n][width] unless stated otherwise, first the coordinates, then the scaled
 * momenta. */
typedef struct {
    int n, width;
    const tvi_subsystems *parts;
    double *kappa;               /* [n] */
    double *z, *scale;           /* the data at the centre, and their natural sizes */
    double *D;                   /* D_z, then the solution of the generating function's equations */
    double *from, *rise;         /* the corrections of q and p at the start, and of their rise */
    double *correction;          /* the correction of z */
    double *least;               /* [width] the least pivot of all equations */
    double *relative, *of_group; /* [width] tvi_newton_size; NaN where a correction is no number */
} tvi_curve_members;

typedef struct {
    /* Computes out[o * out_stride ..] = sum_r weight x[r * stride ..], `width` numbers each, the last rows first; rows
     * without a weight are not read. */
    void (*combine)(const tvi_weights *weights, size_t stride, int width, const double *x, size_t out_stride,
                    double *out);
    /* Computes the same sums of |x|. */
    void (*combine_sizes)(const tvi_weights *weights, size_t stride, int width, const double *x, size_t out_stride,
                          double *out);
    /* Computes out[d] = sum_r seed[r] J[d][r], d < directions. */
    void (*pull)(int rows, int directions, int width, const double *seed, const double *J, double *out);
    /* Computes out[r] = sum_d J[d][r] dz[d]. */
    void (*push)(int rows, int directions, int width, const double *J, const double *dz, double *out);
    /* Computes A = L U in place of A [size][size][width], without exchanges. If a pivot is nearer to 0 than `least`,
     * `least` becomes the pivot that is nearest to 0. */
    void (*factor)(int size, int width, double *A, double *least);
    /* Computes x <- A^-1 x and x <- A^-T x. */
    void (*solve)(int size, int width, const double *lu, double *x);
    void (*solve_transposed)(int size, int width, const double *lu, double *x);
    /* Computes out = a field - b other, for `count` numbers. */
    void (*subtract)(int count, double a, const double *field, double b, const double *other, double *out);
    /* Computes the corrections of the ends from D. */
    void (*close)(const tvi_curve_members *members, const tvi_mean_closing *closing);
    /* Computes correction = -r, r = (q- + from_q - q0, kappa (p- + from_p - p0)), the small differences first.
     * Beforehand the correction holds (q- - Q_0, kappa p-), and Q0 the Q_0 of the curve. */
    void (*residual)(const tvi_curve_members *members, const double *Q0, const tvi_batch_origin *origin);
    /* Fills in scales as newton.c does: an unknown without a size gets the largest of its group, or 1. */
    void (*fill_scale)(const tvi_curve_members *members);
    void (*measure)(const tvi_curve_members *members);
    /* Adds the correction to z where the mask is set. */
    void (*move)(const tvi_curve_members *members, const long long *is_moving);
    /* Computes dq and dp from the curve's rise and its change by the last correction, [2n][width] each. */
    void (*end)(const tvi_curve_members *members, const double *curve, const double *change, double *dq, double *dp);
} tvi_curve_loops;

extern const tvi_curve_loops tvi_curve_loops_base, tvi_curve_loops_avx2, tvi_curve_loops_avx512;

#endif
