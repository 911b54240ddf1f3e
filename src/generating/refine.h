/* refine.h - declares the increments of a Taylor curve beyond its roundoff, for tolerances near roundoff. */
#ifndef TVI_SRC_GENERATING_REFINE_H
#define TVI_SRC_GENERATING_REFINE_H

#include "generating/curve.h"

/* These count the sums over the coefficients x_k: X and its rate, Q'' or X', at two nodes, and the increments. */
enum { TVI_REFINE_LOW = 4, TVI_REFINE_SUMS = 6 };

typedef struct {
    int first;                                            /* the coefficients are summed from this order on; below */
    long double *start, *drift;                           /* [inputs] are x_0, and x_1 of a separable system */
    long double low[TVI_REFINE_SUMS][TVI_REFINE_LOW + 1]; /* weights, of the low orders */
    double *high, *rest;                                  /* [sums][top + 1] of the others, and their sum [inputs] */
    long double *sum, *defect;                            /* [inputs] */
    long double *once, *twice;                            /* [inputs] the integrals of the defect */
    long double *y;                                       /* [slots] the field */
    double *block;                                        /* the block of the constants of the field */
} tvi_refinement;

void tvi_refinement_take(tvi_refinement *refinement, tvi_arena *arena, const tvi_curve *curve);
void tvi_refinement_prepare(tvi_refinement *refinement, const tvi_curve *curve);

/* Returns whether the increments to this tolerance are computed in this way. */
bool tvi_refines(const tvi_system *system, double tolerance);

/* Computes the increments of the curve's step of size h = tau from the origin. */
void tvi_refine(const tvi_refinement *refinement, const tvi_curve *curve, double h, const tvi_origin *origin,
                const tvi_increments *increments);

#endif
