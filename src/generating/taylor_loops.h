/* taylor_loops.h - declares the loops of the Taylor curves of several members at once (taylor_batch.c), compiled once
 * for each instruction set: the members are the fastest lanes, so that no sum runs across lanes. */
#ifndef TVI_SRC_GENERATING_TAYLOR_LOOPS_H
#define TVI_SRC_GENERATING_TAYLOR_LOOPS_H

#include "generating/taylor_sweep.h"
#include "system/system.h"

/* This describes the block of the series: order k of row i of member m stands at x[k * stride + i * width + m]. */
typedef struct {
    int n, width, top;
    size_t stride;
    double tau;
    const double *kappa; /* [n] */
    const int *output;   /* the slots of the field's outputs */
    double *x;
    bool has_masses; /* a separable system */
    const tvi_system *system;
} tvi_taylor_lanes;

typedef struct {
    /* Computes the curve's coefficients that order k of the field gives (docs/method.md section 2). */
    void (*advance)(const tvi_taylor_lanes *curve, int k);
    /* Computes the sums of sizes that the tail is made of, for P and Q to these degrees, as curve_measure of series.h
     * does. */
    void (*measure)(const tvi_taylor_lanes *curve, int q_degree, int p_degree, const tvi_taylor_sums *sums);
    /* Computes tvi_stats.tail of each member from these sums; share, ratio [n][width]: scratch. */
    void (*tail)(const tvi_taylor_lanes *curve, int q_degree, int p_degree, const tvi_taylor_sums *sums, double *share,
                 double *ratio, double *tail);
    /* Computes x_k *= power[k], and the sums of these x_k, the small terms first. */
    void (*sweep)(const tvi_taylor_rows *rows, const double *power, double *x, const tvi_taylor_sums *sums);
} tvi_taylor_loops;

/* Expands all orders from order 0; returns false if a value of the field is outside its domain. */
static inline bool tvi_taylor_expand(const tvi_taylor_loops *loops, const tvi_taylor_lanes *curve, const jet_tape *tape)
{
    const int first = curve->has_masses ? 2 : 1;
    bool inside = true;
    for (int k = 0; k + first <= curve->top; k++) {
        inside &= tape->sweeps->series(tape, curve->x, k, curve->width);
        loops->advance(curve, k);
    }
    return inside;
}

const tvi_taylor_loops *tvi_taylor_loops_of(const tvi_system *system);
extern const tvi_taylor_loops tvi_taylor_loops_base, tvi_taylor_loops_avx2, tvi_taylor_loops_avx512;

#endif
