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

/* ---- Matrices: suite linear of build/check/library --------------------------------------------------------------- */

/* [1] Rows would have to be exchanged if a pivot is smaller, or larger, by this factor than the number on the diagonal
 * before the elimination (galerkin/lagrangian_pass.h). */
#define LINEAR_MIN_PIVOT_OF_INVERSE (1.0 / 16)

/* ---- The end of the passes of every iteration: suite convergence of build/check/generating ----------------------- */

/* [1] If a correction is at least this part of the one before, the next one is expected to be as large. Newton's method
 * trusts any decrease of corrections, but allows for a slower one (NEWTON_MAX_RATIO_GROWTH). */
#define PASSES_MAX_CONTRACTION 0.5
/* [1] Newton's method, and generalised conjugate residuals, are stuck if a correction is more than this part of the one
 * before. */
#define PASSES_STALL_RATIO 0.5
/* [1] Corrections that no longer shrink are roundoff if they are at most this many times the estimated roundoff. Near
 * equilibria (suite equilibria of build/check/stability) one in a hundred was larger, which costs a pass or a Jacobian.
 * A correction below the limit does no harm even if it is not roundoff. */
#define ROUNDOFF_MAX_UNITS 32.0

/* ---- The Galerkin curve: make longrun, make stability ------------------------------------------------------------ */

/* [1] Passes end when the next pass is expected to move the unknowns, relative to their sizes, by at most 2^-80 or
 * 2^-72. This is far below roundoff, since what is left has the same sign in each step (galerkin/probe.c). */
#define GALERKIN_GOAL         0x1p-80 /* Passes without second derivatives end if the next should move less. */
#define GALERKIN_HESSIAN_GOAL 0x1p-72 /* Passes with second derivatives, which cost more, end at this movement. */
/* [1] A movement of the unknowns by at most this part may be roundoff, and shows no contraction. */
#define GALERKIN_ROUNDOFF_LEVEL (32 * DBL_EPSILON)
/* [passes] A step begins again without prediction after this many passes, and fails after this many further ones. */
#define GALERKIN_MAX_PASSES 100
/* [eps] The roundoff of a pass is measured by a pass from displaced unknowns and displaced values of the field. The
 * displacements have this many units of roundoff. */
#define GALERKIN_PROBE_UNITS 16
/* [1] A movement is measured relative to the size of its component plus this part of the largest component of the
 * subsystem: the roundoff of a small component is no smaller than that of a large one. */
#define GALERKIN_MIN_SHARE 1e-3
/* [1] After a step whose first pass moved the unknowns by more than this part, root mean square, the next step is
 * predicted from the last one alone. */
#define GALERKIN_ROUGH_PREDICTION 1e-2
/* [1] A step is predicted from the last one if its size, divided by that of the last step, is in this range. A step in
 * the opposite direction has a negative quotient. */
#define GALERKIN_PREDICTION_MAX_RATIO  1.5  /* A predicted step is at most this many times as long as the last one. */
#define GALERKIN_PREDICTION_BACK_RATIO (-2) /* The least quotient; if negative, the step goes back. */
/* [h] A step follows the last one if it begins less than this from where the last one ended. */
#define GALERKIN_MAX_TIME_GAP 0.25
/* [numbers] Blocks of up to this size are local variables of a generated step, so that compilers know that nothing else
 * changes them (make performance ONE=compiled). */
#define GALERKIN_MAX_LOCAL 4096
/* [1] Inner iterations end when the square of the next movement is expected to be at most this many times the square of
 * the error of the expansion to first order. With half of this number steps take more time, with twice this number more
 * passes. */
#define GALERKIN_INNER_GOAL 4
/* [iterations] A pass has at most this many inner iterations. */
#define GALERKIN_MAX_INNER_ITERATIONS 32
/* A pass that reuses the second derivatives of the pass before has, for a Hamiltonian, the cube of the movement as its
 * error. For a Lagrangian make longrun SCENE=double_pendulum shows the error. */
#define HAMILTONIAN_HESSIAN_MAX_MOVEMENT 0x1p-50 /* [1] H'' is reused if (relative movement)^2 is at most this. */
#define LAGRANGIAN_HESSIAN_MAX_MOVEMENT  1e-8    /* [1] L'' is reused if (relative movement)^2 is at most this. */
/* [iterations] A pass for a Lagrangian has at most, and at least, this many inner iterations. More would cost more than
 * they save. After a single iteration F would not follow V, and the energy would drift by the error of V in the last
 * pass. */
#define LAGRANGIAN_MAX_ITERATIONS 3
#define LAGRANGIAN_MIN_ITERATIONS 2
/* [bits] A Lagrangian's gradient is evaluated at coordinates and velocities with this many last bits rounded off. */
#define LAGRANGIAN_ROUNDED_BITS 6

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

/* [1] The last term of the series is e to minus this, times the tolerance. The paper (generating/step_size.h) has e to
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
