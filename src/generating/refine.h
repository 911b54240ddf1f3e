/* refine.h - declares the increments of a Taylor step in long double, which steps of adapted size use for tolerances
 * near roundoff (curve_stepper.c). */
#ifndef TVI_SRC_GENERATING_REFINE_H
#define TVI_SRC_GENERATING_REFINE_H

#include "generating/curve.h"

/* Weights of coefficients up to order TVI_REFINE_LOW are in long double. There are TVI_REFINE_SUMS sums over the
 * coefficients: X and its rate, Q'' or X', at two nodes, and the two increments. */
enum { TVI_REFINE_LOW = 4, TVI_REFINE_SUMS = 6 };

typedef struct {
    /* The lowest order in the sums; lower orders are in start_values and drift. */
    int lowest_order;
    long double *start_values, *drift; /* [inputs] the terms of order 0, and of order 1 in a separable system */
    /* The weights of the low orders in each sum. */
    long double low_order_weight[TVI_REFINE_SUMS][TVI_REFINE_LOW + 1];
    /* The weights of the other orders, [sums][top + 1], and the sum of these orders, [inputs]. */
    double *high_order_weight, *high_order_sum;
    /* [inputs] The sum of all orders, and the defect at a node. */
    long double *coefficient_sum, *defect;
    /* [inputs] The integral of the defect d, and that of (1 - s) d. */
    long double *single_integral, *double_integral;
    long double *field_slots; /* [slots] the slots of the field's tape in long double */
    double *constants_block;  /* the block of the field's tape, which contains its constants */
} tvi_refinement;

void tvi_allocate_refinement(tvi_refinement *refinement, tvi_arena *arena, const tvi_curve *curve);
void tvi_prepare_refinement(tvi_refinement *refinement, const tvi_curve *curve);

/* Returns whether increments are refined for a step with this tolerance. */
bool tvi_needs_refinement(const tvi_system *system, double tolerance);

/* Computes the increments of the curve's step of size h = tau from the origin. */
void tvi_compute_refined_increments(const tvi_refinement *refinement, const tvi_curve *curve, double h,
                                    const tvi_step_origin *origin, const tvi_increments *increments);

#endif
