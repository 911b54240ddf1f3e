/* refine.h - declares the computation of the increments of a Taylor step in long double, which steps of adapted size
 * use for tolerances near roundoff (curve_stepper.c). */
#ifndef TVI_SRC_GENERATING_REFINE_H
#define TVI_SRC_GENERATING_REFINE_H

#include "generating/curve.h"

/* A sum over the coefficients adds the orders up to TVI_REFINE_LOW in long double, and the higher orders in double.
 * There are TVI_REFINE_SUMS sums: the state X and its derivative (X', or Q'' of a separable system) at each of two
 * nodes, and the increments of position and of momentum. */
enum { TVI_REFINE_LOW = 4, TVI_REFINE_SUMS = 6 };

typedef struct {
    /* The lowest order in the sums; the terms of lower orders are in order_zero_terms and order_one_terms. */
    int lowest_summed_order;
    /* [inputs] The terms of order 0, and of order 1 in a separable system. */
    long double *order_zero_terms, *order_one_terms;
    /* The weights of the orders up to TVI_REFINE_LOW in each sum. */
    long double low_order_weight[TVI_REFINE_SUMS][TVI_REFINE_LOW + 1];
    /* The weights of the orders above TVI_REFINE_LOW, [sums][highest_order + 1], and the sum of their terms, [inputs].
     */
    double *high_order_weight, *high_order_sum;
    /* [inputs] The sum of all orders, and at a node the residual d of the differential equation (refine.c). */
    long double *weighted_series_sum, *ode_residual;
    /* [inputs] The integral of the residual d over the step, and that of (1 - s) d. */
    long double *ode_residual_integral, *ode_residual_double_integral;
    long double *field_slots;      /* [slots] the slots of the field's tape in long double */
    double *field_constants_block; /* the block of the field's tape, which contains its constants */
} tvi_increment_refinement;

void tvi_allocate_increment_refinement(tvi_increment_refinement *refinement, tvi_arena *arena, const tvi_curve *curve);
void tvi_prepare_increment_refinement(tvi_increment_refinement *refinement, const tvi_curve *curve);

/* Returns whether increments are refined for a step with this tolerance. */
bool tvi_needs_refined_increments(const tvi_system *system, double tolerance);

/* Computes the increments of the curve's step of size h = tau from the origin. */
void tvi_compute_refined_increments(const tvi_increment_refinement *refinement, const tvi_curve *curve, double h,
                                    const tvi_step_origin *origin, const tvi_increments *increments);

#endif
