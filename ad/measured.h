/* measured.h - Defines the constants of ad/ and src/ that were found by measurement, each with its unit in brackets and
 * its meaning. The heading of a group names the command whose table, or the suite of tests whose bounds, show what its
 * constants do; an exception names its own. Files get this header with compiler.h, as does generated code. Constants
 * that follow from mathematics, sizes of tables and limits of memory stand where they are used. [1] is a number without
 * unit, [h] a part of the step, [eps] a multiple of DBL_EPSILON. */
#ifndef TVI_AD_MEASURED_H
#define TVI_AD_MEASURED_H

#include <float.h>

/* ---- Tapes: make devices ----------------------------------------------------------------------------------------- */

/* [operations] A run is padded to whole vectors of 8 if more than this many are in its last vector. */
#define TAPE_PAD_MAX_UNPADDED_REST 4
/* [operations] On tapes of values, scattered operands are copied if a subgroup has so many operations on average. */
#define TAPE_COPY_MIN_OPERATIONS 4
/* [1] Powers with exponents k/4 or k/2 up to this size are products and square roots, not calls of pow (suite
 * elementary of build/check/ad). */
#define TAPE_POWER_MAX_EXPONENT 8

/* ---- Generated code of tapes: make performance ONE=compiling (seconds to compile) and ONE=compiled --------------- */

/* [operations] On tapes of up to this size each sum is a run of its own. */
#define EMIT_MAX_SINGLE_SUMS 256
/* [operations] On tapes of up to this size, of which only values of whole vectors are requested, each operation is. */
#define EMIT_MAX_SINGLE_OPERATIONS 768
/* [operations] Values of tapes of up to this size are inlined, for any lanes and for those of one register. */
#define EMIT_MAX_INLINED             64
#define EMIT_MAX_INLINED_IN_REGISTER 256

/* ---- Blocks of members of an ensemble: make performance ONE=ensembles -------------------------------------------- */

/* [members] The least width of a block fills one vector of the widest instruction set; the greatest one of curves, and
 * of Stormer-Verlet, is a power of two times the least one. */
#define BATCH_MIN_WIDTH        8
#define BATCH_MAX_WIDTH        32
#define VERLET_BATCH_MAX_WIDTH 64
/* [bytes] The largest block of the tape of Stormer-Verlet, except for a block of the least width. */
#define VERLET_BATCH_MAX_BYTES (16 << 10)
/* [lanes] The most nodes times members of a block of Galerkin curves. */
#define GALERKIN_BATCH_MAX_LANES 256
/* [bytes] The largest block of the tape of Galerkin curves, which is partly in the second-level cache; and of a block
 * of the least width, except if whole steps are generated code, which is faster with one member. */
#define GALERKIN_BATCH_MAX_BYTES              (40 << 10)
#define GALERKIN_BATCH_MAX_BYTES_AT_MIN_WIDTH (128 << 10)
/* [bytes] The largest block of a series and its tangents along one direction, to stay in the first-level cache; and of
 * a block of the least width. */
#define CURVE_BATCH_MAX_BYTES              (32 << 10)
#define CURVE_BATCH_MAX_BYTES_AT_MIN_WIDTH (256 << 10)
/* [directions] The most of one sweep of tangents. More would not fit into the cache (make performance ONE=cost). */
#define CURVE_TANGENT_DIRECTIONS 8

/* ---- Matrices: suite linear of build/check/library --------------------------------------------------------------- */

/* [rows] Matrices of up to this size are factored by algebra/linear_small.h, larger ones by LAPACK: a call of it costs
 * more than the arithmetic of a small matrix. */
#define LINEAR_OWN_MAX_ROWS 16
/* [rows] OpenBLAS factors matrices of fewer rows with one thread (make blas-threads). */
#define LAPACK_THREADED_MIN_ROWS 100
/* [1] Rows have different units if their scales differ by this factor; solutions are refined then. */
#define LINEAR_UNIT_RATIO 8
/* [1] A pivot is neither smaller nor larger, by this factor, than the number on the diagonal before the elimination;
 * otherwise rows are exchanged. In a row in the units of its columns it is not smaller than this number itself. */
#define LINEAR_MIN_PIVOT 0x1p-10
/* [1] The same limit for an inverse, which rounds more than a factorisation does. */
#define LINEAR_MIN_PIVOT_OF_INVERSE (1.0 / 16)

/* ---- The end of the passes of every iteration: suite convergence of build/check/generating ----------------------- */

/* [1] Nothing is expected of the next correction if this part, or more, of the last one is left. Newton's method,
 * which allows for a loss of contraction, trusts every contraction below 1. */
#define PASSES_MAX_CONTRACTION 0.5
/* [1] Newton's method, and products of Jacobians, are stuck if more than this part of a correction is left. */
#define PASSES_STALL_RATIO 0.5
/* [eps] Corrections that no longer shrink are roundoff if they are at most this many units of it. Near equilibria
 * (suite equilibria of build/check/stability) one in a hundred was larger, which costs a pass or a Jacobian. A
 * correction below the limit does no harm even if it is not roundoff. */
#define ROUNDOFF_MAX_UNITS 32.0
/* [1] A motion is small if the nodes are no farther from q at the start than |q| and so many times the way of its
 * velocity. */
#define ROUNDOFF_MAX_SPEED_GROWTH 4

/* ---- The Galerkin curve: make longrun, make stability ------------------------------------------------------------ */

/* [1] Passes end when the next one should move the unknowns by at most this part: galerkin/probe.c derives it. The
 * second one is for passes with second derivatives, which cost more. */
#define GALERKIN_GOAL         0x1p-80
#define GALERKIN_HESSIAN_GOAL 0x1p-72
/* [1] A movement of the unknowns by at most this part may be roundoff, and shows no contraction. */
#define GALERKIN_ROUNDOFF_LEVEL (32 * DBL_EPSILON)
/* [passes] After so many a step begins again without prediction, and after so many more it fails. */
#define GALERKIN_MAX_PASSES 100
/* [eps] A movement is roundoff if displacing the unknowns and the values of the field by so much moves them as far. */
#define GALERKIN_PROBE_UNITS 16
/* [1] A component smaller than this part of the largest one of its subsystem is measured by that part: its roundoff is
 * no smaller than that of the others. */
#define GALERKIN_MIN_SHARE 1e-3
/* [1] After a first movement of more than this part, root mean square, prediction is from one step only. */
#define GALERKIN_ROUGH_PREDICTION 1e-2
/* [1] The largest size of a step that is predicted from the last one, as a part of that one; and backwards. */
#define GALERKIN_PREDICTION_MAX_RATIO  1.5
#define GALERKIN_PREDICTION_BACK_RATIO (-2)
/* [h] A step follows the last one if its time is less than this from where the last one ended. */
#define GALERKIN_MAX_TIME_GAP 0.25
/* [numbers] Blocks of up to this size are local variables of a generated step, so that compilers know that nothing else
 * changes them (make performance ONE=compiled). */
#define GALERKIN_MAX_LOCAL 4096
/* [1] Inner iterations end when the square of the next movement is this many times that of the error of the expansion
 * to first order. Half of this bound takes more time, twice this bound takes more passes. */
#define GALERKIN_INNER_GOAL 4
/* [iterations] A pass has at most so many inner iterations. */
#define GALERKIN_MAX_INNER_ITERATIONS 32
/* [1] The next pass reuses second derivatives after a relative movement whose square is at most this. In the equations
 * of a Hamiltonian its error is the cube of that movement; for a Lagrangian make longrun SCENE=double_pendulum shows
 * it. */
#define HAMILTONIAN_HESSIAN_MAX_MOVEMENT 0x1p-50
#define LAGRANGIAN_HESSIAN_MAX_MOVEMENT  1e-8
/* [iterations] The most and the fewest of a pass of a Lagrangian. More would cost more than they save. After a single
 * one F would not follow V, and the energy would drift by the error of the last pass in V. */
#define LAGRANGIAN_MAX_ITERATIONS 3
#define LAGRANGIAN_MIN_ITERATIONS 2
/* [bits] The points where the gradient of a Lagrangian is evaluated are rounded by so many last bits. */
#define LAGRANGIAN_ROUNDED_BITS 6
/* [quarters] The second derivatives of K = g f save passes of large steps. The field with them has at most this
 * many quarters of the operations of the field alone; otherwise more passes without them take as little time. */
#define HESSIAN_MAX_COST 13
/* [numbers] All of K'' is recorded up to so many nodes of the graph times rows, and its shorter form up to so many
 * nodes (make performance ONE=compiling). */
#define HESSIAN_WHOLE_MAX_NUMBERS 4096
#define HESSIAN_SHORT_MAX_NODES   800

/* ---- Curves and their equations: suites convergence and adjoints of build/check/generating ----------------------- */

/* [passes] The most of Newton's method; and the most fresh Jacobians, after passes that did not contract. */
#define NEWTON_MAX_PASSES    64
#define NEWTON_MAX_REFRESHES 3
/* [1] An unknown smaller than this part of the largest of its group is measured as if it had this size. */
#define NEWTON_MIN_SCALE 1e-20
/* [1] Corrections that no longer shrink are roundoff if they are this small against the largest unknowns, or against
 * the numbers that the residual is computed from. */
#define NEWTON_STALLED_CORRECTION (256 * DBL_EPSILON)
/* [1] Corrections above this are no roundoff, and show the loss of contraction of the passes after the first one. */
#define NEWTON_LOSS_MIN_CORRECTION 1e-13
/* [1] A pass that checks an expectation moves no more than this. */
#define NEWTON_CHECK_MAX_CORRECTION (8 * DBL_EPSILON)
/* [1] The largest loss of contraction that is allowed for. */
#define NEWTON_MAX_LOSS 1e6
/* [1] The error that old Jacobians, or the last correction by products, may leave in the state, relative to it. It is
 * well below the roundoff of a step. */
#define CURVE_NEGLIGIBLE_ERROR (DBL_EPSILON / 16)
/* [1] The corrector's Jacobian serves until z has moved by this part: passes then contract by about this factor. */
#define MATRICES_MAX_MOVEMENT 1e-4
/* [coordinates] Separable systems have products of Jacobians from here on. Products cost less from 6 or so on, but
 * stiff systems of few bodies at large steps do better with matrices, which can be made anew by differences (make
 * performance ONE=cost). */
#define PRODUCTS_MIN_COORDINATES 8
/* [iterations] The most directions of generalised conjugate residuals. */
#define PRODUCTS_MAX_ITERATIONS 40
/* [orders] The preconditioner includes only the orders of the curve up to this one. */
#define PRODUCTS_NEAR_ORDER 3
/* [1] Each pass computes the residual anew and exactly, and need not reduce it by more than this factor. */
#define PRODUCTS_REDUCTION 1e-6
/* [1] Corrections by products that no longer shrink are roundoff if they are this part of the solution. */
#define PRODUCTS_STALLED_CORRECTION 1e-12
/* [1] A product of a given relative accuracy leaves out orders of the curve below that accuracy
 * divided by this. */
#define PRODUCTS_TRUNCATION_SAFETY 10
/* [iterations] The most for the momenta of the nodes, H_p = v (suite statements of build/check/generating). */
#define MOMENTA_MAX_ITERATIONS 50
/* [1] Their corrections that no longer shrink are roundoff if they are this part of the largest momentum. */
#define MOMENTA_STALLED_CORRECTION 1e-13
/* [1] H_pp is reused as long as each correction is less than this part of the one before. */
#define MOMENTA_REUSE_MAX_RATIO 1e-3
/* [1], [corrections] The last correction of the velocity of a Lagrangian, as nearly as predictors need it. */
#define VELOCITY_MAX_CORRECTION  1e-8
#define VELOCITY_MAX_CORRECTIONS 4

/* ---- Legendre transforms y = f(x): suites points and serves of build/check/generating ---------------------------- */

/* [1] A solution has |y - f(x)| at most this part of the larger of |y| and of |f(x)| at the start. If the iteration
 * runs off to infinity, the residual is large. */
#define LEGENDRE_MAX_RESIDUAL 1e-6
/* [iterations] The most of Newton's method, and [halvings] of a correction; after the last so many f(x) need not be
 * nearer to y. */
#define LEGENDRE_MAX_ITERATIONS      100
#define LEGENDRE_MAX_HALVINGS        40
#define LEGENDRE_MAX_GROWTH_HALVINGS 12
/* [1] dy/dx is reused if the residual is below this part of the residual for which it was computed. */
#define LEGENDRE_REUSE_MAX_RATIO 1e-3
/* [1] Corrections that no longer shrink are roundoff if they are below this part of x (suite equilibria of
 * build/check/stability). */
#define LEGENDRE_STALLED_CORRECTION 1e-12
/* [points], [1] L_vv is regular if its least pivot is above a limit at one of so many random points: the pivots of a
 * singular matrix are roundoff, which may not be exactly 0. */
#define LEGENDRE_PROBES            8
#define LEGENDRE_REGULAR_MIN_PIVOT 1e-9

/* ---- "taylor" to a tolerance: make adaptive; suites tolerance of build/check/events ------------------------------ */

/* [1] The last term is e to minus this, times the tolerance: 2 of it is that of the paper, and 3 allows for the growth
 * of errors in tens of revolutions. */
#define STEP_SIZE_SAFETY 5.0
/* [1] A step is at most this part of the radius of convergence. */
#define STEP_SIZE_MAX_PART_OF_RADIUS 0.7
/* [1], [expansions] A step's size is accepted from a curve whose tau is within this factor of it, a power of two; the
 * most curves that are tried. */
#define STEP_SIZE_MAX_TAU_RATIO  16.0
#define STEP_SIZE_MAX_EXPANSIONS 64
/* [1] A step is at most so many times as large as the one before it. If its coefficients allow the second factor, or in
 * a first step, it must show that it is right at its end. */
#define STEP_SIZE_MAX_GROWTH     4.0
#define STEP_SIZE_CHECKED_GROWTH 1.5
/* [1] Increments are refined for tolerances below this. Larger tolerances leave errors that exceed roundoff. */
#define REFINE_MAX_TOLERANCE 1e-13
/* [1] The change of the energy is taken as at most so many times that of the last two terms (make guard). */
#define CURVE_ENERGY_BOUND_FACTOR 8

/* ---- Tails and default options: make tails, make choose ---------------------------------------------------------- */

/* [1] A component with less than this part of the largest share in its subsystem counts in proportion to its share:
 * less than a hundredth of the motion, as a share is a product of two. An example is the end of a chain that a wave has
 * not reached: its first motion has the highest power of t, however small h is. */
#define TAIL_MIN_SHARE 1e-4
/* [1] The roundoff of a force, relative to the positions. */
#define TAIL_ROUNDOFF (32 * DBL_EPSILON)
/* [orders] The default: the one with the least cost in all scenes (docs/choosing.md). */
#define DEFAULT_ORDER 16
/* [1], [orders] With an automatic time scale the largest tail is 2^(first - order / 2), until the last order. With
 * smaller tails good steps would be refused (docs/adaptive.md). */
#define AUTOMATIC_TAIL_FIRST_EXPONENT 3
#define AUTOMATIC_TAIL_LAST_ORDER     16

/* ---- The guard: make guard; the reference level of the energy: suite zero of build/check/stability --------------- */

/* [1] The relative change of the energy that a step may make. Steps near a pericentre right to 1e-3 changed it by 4 %.
 * */
#define GUARD_MAX_ENERGY_CHANGE 0.05
/* [1], [passes] Up to these tails and passes a step was right in all runs of docs/stability.md (make stability): of the
 * Galerkin curve, and of methods with series, whose passes contract faster. */
#define GUARD_UNCHECKED_MAX_TAIL          1e-3
#define GUARD_UNCHECKED_MAX_SERIES_TAIL   1e-4
#define GUARD_UNCHECKED_MAX_PASSES        32
#define GUARD_UNCHECKED_MAX_SERIES_PASSES 4
/* [1] A change of the energy below this part of it is roundoff. */
#define GUARD_ENERGY_ROUNDOFF (64 * DBL_EPSILON)
/* [1] An energy below the first part of p.dq/dt measures nothing, as that of K = g (H + e); the second replaces it. */
#define GUARD_MIN_PART_OF_ACTION 1e-6
#define GUARD_PART_OF_ACTION     (1.0 / 64)
/* [1] Energies that differ by at most this part are the same: of bodies at rest, far apart, at two distances, and
 * H(q, p) and H(q, -p) of an H that is even in p. */
#define GUARD_LEVEL_MAX_DIFFERENCE 1e-9
/* [increments of the step] The reference level is searched on lines between these distances, by factors [1]. A step
 * from rest that is too large may be a billion times as long as it should be. */
#define GUARD_LEVEL_MIN_DISTANCE 0x1p-30
#define GUARD_LEVEL_MAX_DISTANCE 0x1p12
#define GUARD_LEVEL_RATIO        2

/* ---- Runs: suites times and plans of build/check/events ---------------------------------------------------------- */

#define RUN_STEPS_BETWEEN_CHECKS     64        /* [steps] A run then checks again whether its time moves. */
#define RUN_MAX_SLOW_STEPS           (1 << 16) /* [steps] It fails after these in turn (build/check/rescaled). */
#define PARTIAL_STEP_MAX_CORRECTIONS 12        /* [corrections] The most until its time is the given one. */
/* [h] Partial steps whose sizes differ by less have nearly the same nodes, so that one's history serves the other. */
#define PARTIAL_STEP_NEAR 1e-3

/* ---- Events: suites roots, search, starts and cuts of build/check/events ----------------------------------------- */

/* [eps] A change of g by fewer units of roundoff of its terms has no certain sign, and ends the search of a dip. */
#define EVENT_ROUNDOFF_UNITS 64.0
/* [eps] The roundoff of a state after a step, or on the curve, in units of its components: such a state is a sum. */
#define EVENT_STATE_ROUNDOFF_UNITS 4.0
/* [1] The largest relative differences of times that are the same, and of stops at events that count as one. */
#define EVENT_SAME_TIME  (2 * DBL_EPSILON)
#define EVENT_SAME_STOP  (32 * DBL_EPSILON)
#define EVENT_NEAR_STOP  1e-6    /* [h] A root so near to a stop may be the same point up to the roundoff of g. */
#define EVENT_SAME_ROOT  1e-12   /* [h] Nearer roots of one event in the same direction are one. */
#define EVENT_EDGE       0x1p-20 /* [h] An additional sample is so far from a sample with g = 0, or from an end. */
#define EVENT_FLAT_SLOPE 0.1     /* [mean slope of |g|] A dip may be beside an end of the step with a lower slope. */
#define EVENT_KINK       0.05    /* [largest difference of g] g is not smooth if the fourth or eighth is larger. */
/* [h] The sign of g just after the start is tested at growing theta: the first one in steps in time, and in rescaled
 * systems, where the time must move; then the least one from which an event may return to 0, and its multiples [1]. */
#define EVENT_FIRST_THETA          0x1p-200
#define EVENT_FIRST_RESCALED_THETA 0x1p-60
#define EVENT_RETURN_MIN_THETA     0x1p-52
#define EVENT_RETURN_THETA_GROWTH  16.0
/* [h], [samples] The search of a dip ends when its middle samples are so near, or after so many. */
#define EVENT_DIP_MIN_WIDTH   1e-8
#define EVENT_DIP_MAX_SAMPLES 120
/* [h], [secants] The secant method ends when theta changes by less, or after so many. */
#define EVENT_SECANT_MIN_CHANGE 1e-4
#define EVENT_MAX_SECANTS       6
#define EVENT_ITP_TRUNCATION    0.2  /* [1 / width of the first bracket] The ITP method truncates its steps by this. */
#define EVENT_LINE_DEGREE       8    /* [orders] The degree of the Taylor polynomial of g along a line. */
#define EVENT_MAX_LINES         5    /* [lines] A root is found on so many lines at most. */
#define EVENT_LINE_MAX_LENGTH   2e-9 /* [h] A line from a state of the method is used up to here. */
#define EVENT_CHORD             1e-5 /* [h] Slopes are difference quotients between theta -+ this. */
#define EVENT_SLOPE_ERROR       32.0 /* [1] The curve's slope has at most so many times its relative error. */
/* [h] A correction is short up to the first, and up to the second part [1] of the distance to the bracket's ends. */
#define EVENT_SHORT_CORRECTION      1e-6
#define EVENT_SHORT_CORRECTION_PART 1e-3
/* [h] A sign change within this distance of an estimated root is the event; the bracket else grows by factors [1]. */
#define EVENT_SURE_DISTANCE  0x1p-50
#define EVENT_BRACKET_GROWTH 16.0
#define EVENT_BRACKET_MAX    (1.0 / 16)

/* ---- The suggested step (tvi_suggest_step): make suggest. All are [1] but for what says otherwise ---------------- */

/* Trials aim at this part of the wanted error; in a rescaled system at the second, since another passage of a
 * pericentre may be worse than the one that a trial sees. */
#define SUGGEST_AIM          0.08
#define SUGGEST_AIM_RESCALED 0.06
/* The step size is multiplied by these after a failed step or a large error, and at the end if no estimate was near the
 * aim. Otherwise the factor is at least the least, and the aim over a trial's error counts as at least the last. */
#define SUGGEST_FAILED_FACTOR          0.88
#define SUGGEST_FAILED_FACTOR_RESCALED 0.7
#define SUGGEST_UNKNOWN_FACTOR         0.8
#define SUGGEST_MIN_FACTOR             0.25
#define SUGGEST_MIN_AIM_PER_ERROR      1e-3
/* Orbits that differ by less than the first may differ by roundoff alone; below the second they are tested. They do if
 * the error is no less by the third factor with a step size that should make it less by the fourth. */
#define SUGGEST_ROUNDOFF          1e-13
#define SUGGEST_ROUNDOFF_DOUBT    1e-10
#define SUGGEST_ROUNDOFF_DECREASE 3
#define SUGGEST_EXPECTED_DECREASE 0.01
/* For the first size: a step that just resolves the orbit makes this error times tail^(order / degree), a trial covers
 * this part of the run, and no step may have a tail above the ratio times the scout's. */
#define SUGGEST_RESOLVED_ERROR 0.1
#define SUGGEST_COVERED_PART   0.05
#define SUGGEST_MAX_TAIL_RATIO 40.0
/* A step size is accepted if the error of the whole run is at most SUGGEST_MAX_ERROR times the wanted error. It is the
 * longest one if that error is at least SUGGEST_FULL_ERROR times the wanted one, or if a step that is
 * SUGGEST_LONGER_FACTOR times as long is not accepted. */
#define SUGGEST_MAX_ERROR     0.9
#define SUGGEST_FULL_ERROR    0.02
#define SUGGEST_LONGER_FACTOR 1.1
/* The final size is divided by 1 + this log(r), r the largest over the smallest resolving step size, at most the
 * second. */
#define SUGGEST_SPREAD_WEIGHT 0.15
#define SUGGEST_MAX_SPREAD    30.0
/* The time's roundoff is measured if it may be more than this part of the wanted error: by a shift of the time by a
 * part of the step [h], or by units of its roundoff [eps] if that is more. A run rounds it bias * sqrt(steps) times one
 * way. */
#define SUGGEST_TIME_DOUBT       0.01
#define SUGGEST_TIME_SHIFT       1e-3
#define SUGGEST_TIME_SHIFT_UNITS 4.0
#define SUGGEST_TIME_BIAS        3.0
/* [steps] The budget of the scout and all trials together is a part [1] of the steps of the run, within these limits.
 * */
#define TRIALS_PART_OF_RUN 0.04
#define TRIALS_MIN_STEPS   60
#define TRIALS_MAX_STEPS   6000
#define TRIAL_ERROR_BAND   30.0 /* A trial goes on while its estimate is within this factor of the aim. */
#define TRIAL_EQUAL_LENGTH 0.8  /* A trial that covers this part of the longest one counts as much. */
#define TRIAL_MAX_DISTANCE 0.05 /* Orbits that differ by more do not differ by a power of the step size. */
#define TRIAL_END          1e-9 /* A trial that leaves less of the run covers the whole run. */
/* Errors grow as t^a with this a, or in a rescaled system the second. With a drive it is measured after so many steps,
 * and then at every so many [steps]. */
#define TRIAL_GROWTH_EXPONENT          1.25
#define TRIAL_GROWTH_EXPONENT_RESCALED 1.1
#define TRIAL_GROWTH_FIRST_STEP        8
#define TRIAL_GROWTH_INTERVAL          4
#define TRIAL_MIN_STEPS                4          /* [steps] A large estimate ends no trial before these. */
#define TRIAL_MAX_HARDEST_PART         0.6        /* A trial begins at the start if the hardest part comes sooner. */
#define TRIAL_COMPANION_MIN_EXPLORED   0.5        /* The companion is used if the scout saw this part of the run. */
#define DOUBLING_MIN_SPEED             (1.0 / 30) /* Lags are measured from this part of the largest speed on. */
#define DOUBLING_START_DISTANCE        1e-7       /* The companion starts so far from the scout's orbit. */
#define SCOUT_MAX_STEPS                24         /* [steps] The scout tries no more. */
#define SCOUT_RESOLVING_TAIL           0.003      /* The tail of a step that just resolves the orbit. */
#define SCOUT_MAX_TAIL                 0.03       /* A step with a larger tail is undone and repeated. */
/* Factors of the scout's step: after a first step that fails, after a later one, after a success at most, and from the
 * least to the largest for the step that just resolves the orbit. */
#define SCOUT_FIRST_FAILED_FACTOR  0.125
#define SCOUT_FAILED_FACTOR        0.6
#define SCOUT_MAX_GROWTH           1.6
#define SCOUT_MIN_RESOLVING_FACTOR 0.4
#define SCOUT_MAX_RESOLVING_FACTOR 8.0
#define SCOUT_HARDER_FACTOR        0.9  /* A later position is harder if its resolving step is smaller by this. */
#define SCOUT_MAX_ENERGY_CHANGE    0.1  /* The largest relative change of the energy in the first step. */
#define SCOUT_MAX_DISTANCE         0.25 /* The largest relative distance of the first step from two half steps. */
#define SCOUT_ERROR_POWER          4.0  /* The weight of a position is its resolving step size to the power -this. */
#define SCOUT_MIN_WEIGHT           0.02 /* The weight is at least this part of that at the hardest position. */

#endif
