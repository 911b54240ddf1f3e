/* measured.h - Defines the constants of src/galerkin and src/generating that were found by measurement, with those that
 * they share with other folders. All others stand beside their use (make constants). compiler.h includes this file, and
 * generated code begins with both. Each constant has its unit in brackets and its meaning: [1] is a number without
 * unit, [h] a fraction of the step size, [eps] a multiple of DBL_EPSILON. The heading of a group names a command or a
 * suite of tests, which shows by its table or its bounds what the constants of the group do; some constants name a
 * command of their own. Constants that follow from mathematics, sizes of tables and limits of memory stand in the files
 * that use them. */
#ifndef TVI_AD_MEASURED_H
#define TVI_AD_MEASURED_H

#include <float.h>

/* ---- Taylor curves ----------------------------------------------------------------------------------------------- */

/* [directions] One sweep of tangents has at most this many directions. A block of more would not fit into the cache
 * (make performance ONE=cost). */
#define CURVE_TANGENT_DIRECTIONS 8

/* ---- Curves and their equations: suites convergence and adjoints of build/check/generating ----------------------- */

#define NEWTON_MAX_PASSES    64 /* [passes] Newton's method fails after this many passes. */
#define NEWTON_MAX_REFRESHES 3  /* [Jacobians] The most that a step renews, after passes that did not contract. */
/* [1] The scales of unknowns are computed again after a correction larger than this part of one. A smaller correction
 * leaves at least half of each size. */
#define NEWTON_SAME_SCALE_MAX_CORRECTION 0.5
/* [1] An unknown smaller than this part of the largest of its group is measured as if it had this size. */
#define NEWTON_MIN_SCALE 1e-20
/* [1] Corrections that no longer shrink are roundoff if they are at most this part of the largest unknowns, or of the
 * numbers from which the residual is computed. */
#define NEWTON_STALLED_CORRECTION (256 * DBL_EPSILON)
/* [1] Larger corrections are no roundoff. They show by which factor the contraction ratio, that of a correction to the
 * one before it, grows from pass to pass. */
#define NEWTON_GROWTH_MIN_CORRECTION 1e-13
/* [1] An extra pass confirms that the unknowns were converged if its correction is at most this. */
#define NEWTON_CHECK_MAX_CORRECTION (8 * DBL_EPSILON)
/* [1] The expected size of a correction allows for growth of the contraction ratio by at most this factor. */
#define NEWTON_MAX_RATIO_GROWTH 1e6
/* [1] An old Jacobian leaves at most this relative error in the state, and so does a last correction that is computed
 * from products of the Jacobian with vectors. The roundoff of a step is much larger. */
#define CURVE_NEGLIGIBLE_ERROR (DBL_EPSILON / 16)
/* [1] The corrector's Jacobian serves until z has moved by this part: passes then contract by about this factor. */
#define MATRICES_MAX_MOVEMENT 1e-4
/* [coordinates] Separable systems with at least this many coordinates use products of Jacobians with vectors instead of
 * matrices. Products cost less from 6 coordinates or so on, but stiff systems of few bodies at large steps do better
 * with matrices, which can be made anew by differences (make performance ONE=cost). */
#define PRODUCTS_MIN_COORDINATES 8
/* [iterations] Generalised conjugate residuals make at most this many iterations, each with one search direction. */
#define PRODUCTS_MAX_ITERATIONS 40
/* [orders] The preconditioner includes only the orders of the curve up to this one. */
#define PRODUCTS_NEAR_ORDER 3
/* [1] A pass need not reduce the residual by more than this factor, since the next pass computes the residual anew. */
#define PRODUCTS_REDUCTION 1e-6
/* [1] Corrections of conjugate residuals that no longer shrink are roundoff if they are this part of the solution. */
#define PRODUCTS_STALLED_CORRECTION 1e-12
/* [1] A product of the Jacobian with a vector, to the relative accuracy r, leaves out the last coefficients of the
 * curve, with |Q_k| below r / PRODUCTS_TRUNCATION_SAFETY |Q_0|. */
#define PRODUCTS_TRUNCATION_SAFETY 10
/* [iterations] Newton's method for the momenta of the nodes, H_p = v, fails after this many (suite statements of
 * build/check/generating). */
#define MOMENTA_MAX_ITERATIONS 50
/* [1] Corrections of the momenta of the nodes that no longer shrink are roundoff if they are this part of the largest
 * momentum. */
#define MOMENTA_STALLED_CORRECTION 1e-13
/* [1] H_pp is reused as long as each correction is less than this part of the one before. */
#define MOMENTA_REUSE_MAX_RATIO 1e-3

/* ---- "taylor" to a tolerance: make adaptive; suites tolerance of build/check/events ------------------------------ */

/* [1] The last term of the series is e to minus this, times the tolerance. The paper (generating/taylor.c) has e to
 * minus 2; the other 3 allow for the growth of errors in tens of revolutions. */
#define STEP_SIZE_SAFETY 5.0
/* [1] A step is at most this part of the radius of convergence. */
#define STEP_SIZE_MAX_PART_OF_RADIUS 0.7
/* [1] A curve serves for a step if the size of the step and the tau of the curve differ by at most this factor, a power
 * of 2. */
#define STEP_SIZE_MAX_TAU_RATIO 16.0
/* [expansions] At most this many curves, each with another tau, are tried for a step. */
#define STEP_SIZE_MAX_EXPANSIONS 64
/* [1] The size of a step, divided by that of the step before. */
#define STEP_SIZE_MAX_GROWTH     4.0 /* A step is at most this many times as long as the step before. */
#define STEP_SIZE_CHECKED_GROWTH 1.5 /* If a step grows by more, or is the first, the force at its end is checked. */
/* [1] For smaller tolerances generating/refine.c reduces the roundoff of a step; for larger ones errors exceed it. */
#define REFINE_MAX_TOLERANCE 1e-13
/* [1] The omitted terms of a curve change the energy by at most this many times as much as the last two terms (make
 * guard). */
#define CURVE_ENERGY_BOUND_FACTOR 8

#endif
