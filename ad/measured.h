/* measured.h - Defines the constants of ad/ and src/ that were found by measurement. compiler.h includes this file, and
 * generated code begins with both. Each constant has its unit in brackets and its meaning: [1] is a number without
 * unit, [h] a fraction of the step size, [eps] a multiple of DBL_EPSILON. The heading of a group names a command or a
 * suite of tests, which shows by its table or its bounds what the constants of the group do; some constants name a
 * command of their own. Constants that follow from mathematics, sizes of tables and limits of memory stand in the files
 * that use them. */
#ifndef TVI_AD_MEASURED_H
#define TVI_AD_MEASURED_H

#include <float.h>

/* ---- Tapes: make devices ----------------------------------------------------------------------------------------- */

/* [1] Powers with exponents k/4 or k/2 up to this size are products and square roots, not calls of pow (suite
 * elementary of build/check/ad). */
#define TAPE_POWER_MAX_EXPONENT 8

/* ---- Generated code of tapes: make performance ONE=compiling (seconds to compile) and ONE=compiled --------------- */

/* [operations] On tapes of up to this size each sum is a run of its own. */
#define EMIT_MAX_SINGLE_SUMS 256
/* [operations] On tapes of up to this size each operation is a run of its own, if only values of whole vectors are
 * requested. */
#define EMIT_MAX_SINGLE_OPERATIONS 768
/* [operations] The largest tape whose value function is inlined. */
#define EMIT_MAX_INLINED             64 /* [operations] The largest inlined tape if the lanes fill several registers. */
#define EMIT_MAX_INLINED_IN_REGISTER 256 /* [operations] The largest inlined tape if the lanes fill one register. */

/* ---- Taylor curves ----------------------------------------------------------------------------------------------- */

/* [directions] One sweep of tangents has at most this many directions. A block of more would not fit into the cache
 * (make performance ONE=cost). */
#define CURVE_TANGENT_DIRECTIONS 8

/* ---- Matrices: suite linear of build/check/library --------------------------------------------------------------- */

/* [rows] Matrices of up to this size are factored by algebra/linear_small.h, larger ones by LAPACK: a call of LAPACK
 * costs more than the arithmetic of a small matrix. */
#define LINEAR_OWN_MAX_ROWS 16
/* [rows] OpenBLAS factors matrices of fewer rows with one thread (make blas-threads). */
#define LAPACK_THREADED_MIN_ROWS 100
/* [1] Rows have different units if their scales differ by this factor; solutions are refined then. */
#define LINEAR_UNIT_RATIO 8
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
/* [1] The motion in a step is small if no node is farther from q at the start than |q| plus this many times the
 * drift. */
#define ROUNDOFF_MAX_SPEED_GROWTH 4

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
/* [quarters] The second derivatives of K = g f, with f = H + e, save passes of large steps. They are used if the field
 * with them depends on at most HESSIAN_MAX_COST / 4 times as many nodes of the graph as the field alone. If they cost
 * more, the additional passes without them take as little time. */
#define HESSIAN_MAX_COST 14
/* [numbers] The whole matrix K'' is recorded if the nodes of the graph times the rows of K'' are at most this many
 * (make performance ONE=compiling). */
#define HESSIAN_WHOLE_MAX_NUMBERS 4096
/* [nodes] If the whole K'' is too costly, the simpler K'' at f = 0 is recorded for graphs of up to this many nodes. */
#define HESSIAN_SHORT_MAX_NODES 800

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

/* ---- Legendre transforms y = f(x): suites points and serves of build/check/generating ---------------------------- */

/* [1] A solution x has |y - f(x)| at most this part of |y|, or of |f(x)| at the start if that is larger. If the
 * iteration runs off to infinity, the residual is large. */
#define LEGENDRE_MAX_RESIDUAL        1e-6
#define LEGENDRE_MAX_ITERATIONS      100 /* [iterations] Newton's method for x in y = f(x) makes at most this many. */
#define LEGENDRE_MAX_HALVINGS        40  /* [halvings] A correction of x is halved at most this many times. */
#define LEGENDRE_MAX_GROWTH_HALVINGS 12  /* [halvings] From this many on, f(x) may be farther from y than before. */
/* [1] The matrix dy/dx is reused if the residual is below this part of the residual for which the matrix was
 * computed. */
#define LEGENDRE_REUSE_MAX_RATIO 1e-3
/* [1] Corrections that no longer shrink are roundoff if they are below this part of x (suite equilibria of
 * build/check/stability). */
#define LEGENDRE_STALLED_CORRECTION 1e-12
/* L_vv is regular if it is so at one random point. The pivots of a singular matrix are roundoff, which may not be
 * exactly 0. */
#define LEGENDRE_PROBES            8    /* [points] L_vv is tested for regularity at up to this many random points. */
#define LEGENDRE_REGULAR_MIN_PIVOT 1e-9 /* [1] L_vv is regular at a point if its least pivot is larger. */

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

/* ---- Tails and default options: make tails, make choose ---------------------------------------------------------- */

/* [1] A component with less than this part of the largest share in its subsystem counts in proportion to its share
 * (algebra/tail.h). Its motion is then less than a hundredth of the largest one, as a share is a product of two sizes.
 * An example is the end of a chain that a wave has not reached: its first motion has the highest power of t, however
 * small h is. */
#define TAIL_MIN_SHARE 1e-4
/* [1] The roundoff of a force, relative to the positions. */
#define TAIL_ROUNDOFF (32 * DBL_EPSILON)
/* [orders] A method has this order if the user chooses none. It has the least cost in all scenes (docs/choosing.md). */
#define DEFAULT_ORDER 16
/* With an automatic time scale, the largest tail of a step is 2^(AUTOMATIC_TAIL_FIRST_EXPONENT - order / 2). With a
 * smaller limit good steps would be refused (docs/adaptive.md). */
#define AUTOMATIC_TAIL_FIRST_EXPONENT 3  /* [1] The largest tail of a step is 2^(this - order / 2). */
#define AUTOMATIC_TAIL_LAST_ORDER     16 /* [orders] Higher orders have the largest tail of this order. */

/* ---- The guard: make guard; the reference level of the energy: suite zero of build/check/stability --------------- */

/* [1] A step may change the energy by this part. Steps near a pericentre that were right to 1e-3 changed it by 4 %. */
#define GUARD_MAX_ENERGY_CHANGE 0.05
/* [1], [passes] Steps with at most these tails and passes are accepted without a check of the energy. They were right
 * in all runs of docs/stability.md (make stability). The passes of methods with series contract faster. */
#define GUARD_UNCHECKED_TAIL          1e-3 /* The energy of Galerkin steps is unchecked up to this tail. */
#define GUARD_UNCHECKED_SERIES_TAIL   1e-4 /* The energy of steps with series is unchecked up to this tail. */
#define GUARD_UNCHECKED_PASSES        32   /* The energy of Galerkin steps is unchecked up to this many passes. */
#define GUARD_UNCHECKED_SERIES_PASSES 4    /* The energy of series' steps is unchecked up to this many passes. */
/* [1] A change of the energy is roundoff if it is below this part of |H| plus the sum of |q dp/dt| and |p dq/dt|. */
#define GUARD_ENERGY_ROUNDOFF (64 * DBL_EPSILON)
/* [1] The change of an energy that is nearly 0, such as K = g (H + e), is compared with p.dq/dt instead of the
 * energy. */
#define GUARD_MIN_PART_OF_ACTION 1e-6       /* An energy is nearly 0 if it is at most this part of p.dq/dt. */
#define GUARD_PART_OF_ACTION     (1.0 / 64) /* This part of p.dq/dt takes the place of an energy that is nearly 0. */
/* [1] Two energies count as equal if they differ by at most this part. The guard compares the energies H(c q, 0) at two
 * large c, to find whether they have a limit, and H(q, p) and H(q, -p), to find whether H is even in p. */
#define GUARD_LEVEL_MAX_DIFFERENCE 1e-9
/* [increments of the step] The lowest energy at rest, H(q, 0), is searched at points q of lines, at growing distances.
 * A step from rest that is too large may be a billion times as long as it should be. */
#define GUARD_LEVEL_MIN_DISTANCE 0x1p-30 /* The search for the lowest energy at rest begins this far from a state. */
#define GUARD_LEVEL_MAX_DISTANCE 0x1p12  /* The search for the lowest energy at rest ends this far from a state. */
#define GUARD_LEVEL_RATIO        2       /* [1] The distances of the search for this energy grow by this factor. */

/* ---- Runs: suites times and plans of build/check/events ---------------------------------------------------------- */

#define RUN_STEPS_BETWEEN_CHECKS 64 /* [steps] A run checks once in this many steps that its time moves. */
/* [steps] A run fails after this many consecutive steps that hardly move its time (build/check/rescaled). */
#define RUN_MAX_SLOW_STEPS           (1 << 16)
#define PARTIAL_STEP_MAX_CORRECTIONS 12 /* [corrections] The size of a partial step is corrected at most this often. */
/* [h] Partial steps whose sizes differ by less have nearly the same nodes and can use each other's history. */
#define PARTIAL_STEP_NEAR 1e-3

/* ---- Events: suites roots, search, starts and cuts of build/check/events ----------------------------------------- */

/* [eps] A change of g by fewer units of roundoff of its terms has no certain sign, and ends the search of a dip. */
#define EVENT_ROUNDOFF_UNITS 64.0
/* [eps] A state after a step, or on the curve, is a sum. Its roundoff is this many units of its components. */
#define EVENT_STATE_ROUNDOFF_UNITS 4.0
#define EVENT_SAME_TIME            (2 * DBL_EPSILON)  /* [1] Times are the same if they differ by at most this part. */
#define EVENT_SAME_STOP            (32 * DBL_EPSILON) /* [1] Two stops are one if their times differ by less. */
#define EVENT_NEAR_STOP            1e-6    /* [h] A root this near to a stop may be that stop, by the roundoff of g. */
#define EVENT_SAME_ROOT            1e-12   /* [h] Two roots of an event this near, in one direction, are one root. */
#define EVENT_EDGE                 0x1p-20 /* [h] Extra samples of g are this far from step ends and zeros of g. */
#define EVENT_FLAT_SLOPE           0.1     /* [mean slope of |g|] Below this slope at a step end, a dip may be near. */
/* [1] g has a kink if a 4th or 8th difference of its samples is above this part of their largest first difference. */
#define EVENT_KINK 0.05
/* [h] If g is 0 at the start of a step, the sign of g just after the start is found at growing theta. */
#define EVENT_FIRST_THETA          0x1p-200 /* [h] If g is 0 at a step's start, its sign is taken here first. */
#define EVENT_FIRST_RESCALED_THETA 0x1p-60  /* [h] If g is 0 at a rescaled step's start, its sign is taken here. */
#define EVENT_RETURN_MIN_THETA     0x1p-52  /* [h] The least theta at which a g that left 0 is checked to be off 0. */
#define EVENT_RETURN_THETA_GROWTH  16.0     /* [1] An unsure sign of g is taken again at this many times theta. */
#define EVENT_DIP_MIN_WIDTH        1e-8     /* [h] The search of a dip ends when its three samples span no more. */
#define EVENT_DIP_MAX_SAMPLES      120      /* [samples] The search of a dip ends after this many. */
#define EVENT_SECANT_MIN_CHANGE    1e-4     /* [h] The secant method ends when theta changes by no more. */
#define EVENT_MAX_SECANTS          6        /* [secants] The secant method ends after this many. */
#define EVENT_ITP_TRUNCATION       0.2      /* [1 / first width] The constant kappa_1 of the ITP root finder. */
#define EVENT_LINE_DEGREE          8        /* [orders] The degree of the Taylor polynomial of g along a line. */
#define EVENT_MAX_LINES            5        /* [lines] A root is searched on at most this many lines. */
#define EVENT_LINE_MAX_LENGTH      2e-9     /* [h] A straight line replaces the solution up to this distance. */
#define EVENT_CHORD                1e-5     /* [h] Half the distance of the two points of a difference quotient. */
#define EVENT_SLOPE_ERROR          32.0     /* [1] The slope of a line has this many times the curve's error. */
/* A correction of theta is short if it is at most EVENT_SHORT_CORRECTION, and at most EVENT_SHORT_CORRECTION_PART of
 * the distance from the corrected theta to the nearer end of the bracket. */
#define EVENT_SHORT_CORRECTION      1e-6 /* [h] A short correction of theta is at most this. */
#define EVENT_SHORT_CORRECTION_PART 1e-3 /* [1] A short correction is at most this part of the way to a bracket end. */
/* Near an event the solution is replaced by a straight line through one of its states, the origin of the line
 * (finder.h). An estimated root of g on the line lies in a small bracket, whose ends move outwards until g changes its
 * sign. */
#define EVENT_SURE_DISTANCE        0x1p-50    /* [h] A bracket's ends are first this far from the estimated root. */
#define EVENT_BRACKET_GROWTH       16.0       /* [1] Each next move of a bracket's end is this many times as long. */
#define EVENT_BRACKET_MAX_DISTANCE (1.0 / 16) /* [h] An end of a bracket is at most this far from the line's origin. */

/* ---- The suggested step (tvi_suggest_step): make suggest. A constant without a unit is [1] ----------------------- */

/* In a rescaled system trials aim lower, since another passage of a pericentre may be worse than that in the trial. */
#define SUGGEST_AIM          0.08 /* Trials aim at this part of the wanted error. */
#define SUGGEST_AIM_RESCALED 0.06 /* Trials of rescaled systems aim at this part of the wanted error. */
/* The factor of a trial is its step size divided by that of the trial before. The factor of the suggestion is the
 * suggested step size divided by that of the last trial. */
#define SUGGEST_FAILED_FACTOR          0.88 /* The factor of a trial after a failed one, or one with a large error. */
#define SUGGEST_FAILED_FACTOR_RESCALED 0.7  /* The factor of a trial after a failed one, in a rescaled system. */
#define SUGGEST_UNKNOWN_FACTOR         0.8  /* The factor of the suggestion if no trial came near the aim. */
#define SUGGEST_MIN_FACTOR             0.25 /* The least factor of a trial; the largest is 1 / SUGGEST_MIN_FACTOR. */
#define SUGGEST_MIN_AIM_PER_ERROR      1e-3 /* The aim divided by the error of a trial counts as at least this. */
/* The error of a trial is roundoff if SUGGEST_ROUNDOFF_DOUBT is above the distance of its orbits, and if a step size
 * that should reduce the error to the part SUGGEST_EXPECTED_DECREASE does not reduce it by the factor
 * SUGGEST_ROUNDOFF_DECREASE. */
#define SUGGEST_ROUNDOFF          1e-13 /* A smaller distance of two orbits may be roundoff alone. */
#define SUGGEST_ROUNDOFF_DOUBT    1e-10 /* An error may be roundoff if the orbits' distance is below this. */
#define SUGGEST_ROUNDOFF_DECREASE 3     /* An error that falls by less than this factor may be roundoff alone. */
#define SUGGEST_EXPECTED_DECREASE 0.01  /* A shorter step tests for roundoff if it should reduce errors to this part. */
/* The first trial supposes that a step that just resolves the orbit has the error SUGGEST_RESOLVED_ERROR tail^a, with a
 * = order / degree. */
#define SUGGEST_RESOLVED_ERROR 0.1
#define SUGGEST_COVERED_PART   0.05 /* The first trial covers this part of the run. */
#define SUGGEST_MAX_TAIL_RATIO 40.0 /* The tail of a step is at most this many times SCOUT_RESOLVING_TAIL. */
/* A step size is accepted if the error of the whole run is at most SUGGEST_MAX_ERROR times the wanted error. It is the
 * longest one if that error is at least SUGGEST_FULL_ERROR times the wanted one, or if a step that is
 * SUGGEST_LONGER_FACTOR times as long is not accepted. */
#define SUGGEST_MAX_ERROR     0.9
#define SUGGEST_FULL_ERROR    0.02
#define SUGGEST_LONGER_FACTOR 1.1
/* The suggested step size is divided by 1 + SUGGEST_SPREAD_WEIGHT log(r). r is the ratio of the largest to the smallest
 * resolving step size, but at most SUGGEST_MAX_SPREAD. */
#define SUGGEST_SPREAD_WEIGHT 0.15
#define SUGGEST_MAX_SPREAD    30.0
/* The roundoff of the time t of a run causes an error. To measure it, tvi_suggest_step compares a step from t with one
 * from t + shift. In a run this roundoff adds up to SUGGEST_TIME_BIAS sqrt(steps) units, of DBL_EPSILON t each. */
#define SUGGEST_TIME_DOUBT       0.01 /* The error is measured if it may be more than this part of the wanted error. */
#define SUGGEST_TIME_SHIFT       1e-3 /* [h] The shift of t, as a part of the duration of the step. */
#define SUGGEST_TIME_SHIFT_UNITS 4.0  /* [eps] The shift of t is at least this many times DBL_EPSILON t. */
#define SUGGEST_TIME_BIAS        3.0
/* The scout and all trials together make at most the part TRIALS_PART_OF_RUN of the steps of the run. */
#define TRIALS_PART_OF_RUN 0.04
#define TRIALS_MIN_STEPS   60   /* [steps] The scout and all trials may make at least this many steps together. */
#define TRIALS_MAX_STEPS   6000 /* [steps] The scout and all trials make at most this many steps together. */
#define TRIAL_ERROR_BAND   30.0 /* A trial ends if its estimate and the aim differ by more than this factor. */
#define TRIAL_EQUAL_LENGTH 0.8  /* A trial counts as much as the longest one if it covers this part of it. */
#define TRIAL_MAX_DISTANCE 0.05 /* A larger distance of two orbits does not grow as a power of the step size. */
#define TRIAL_END          1e-9 /* A trial that leaves out a smaller part of the run covers the whole run. */
/* Errors grow as t^a with the time t of a run. */
#define TRIAL_GROWTH_EXPONENT          1.25       /* The exponent a; in driven systems its upper limit. */
#define TRIAL_GROWTH_EXPONENT_RESCALED 1.1        /* The exponent a in rescaled systems. */
#define TRIAL_GROWTH_FIRST_STEP        8          /* [steps] Driven systems: errors' growth is measured from here on. */
#define TRIAL_GROWTH_INTERVAL          4          /* [steps] Driven systems: errors' growth is measured this often. */
#define TRIAL_MIN_STEPS                4          /* [steps] A large estimate does not end a trial of fewer steps. */
#define TRIAL_MAX_HARDEST_PART         0.6        /* The hardest step comes before this part of the trial. */
#define TRIAL_COMPANION_MIN_EXPLORED   0.5        /* The companion orbit needs a scout that saw this part of the run. */
#define DOUBLING_MIN_SPEED             (1.0 / 30) /* The lag of two orbits counts above this part of the top speed. */
#define DOUBLING_START_DISTANCE        1e-7       /* The companion orbit's first distance from the scout's orbit. */
#define SCOUT_MAX_STEPS                24         /* [steps] The scout tries at most this many. */
/* A step just resolves the orbit if its tail (tvi_stats.tail) is this. The tail is the last term of the polynomial of
 * the forces, divided by the momentum. */
#define SCOUT_RESOLVING_TAIL 0.003
#define SCOUT_MAX_TAIL       0.03 /* A step with a larger tail is undone and repeated. */
/* The scout estimates the resolving step size of a position, whose tail would be SCOUT_RESOLVING_TAIL, from the tail of
 * its last step there. The other factors are the size of the scout's next step, divided by that of the last one. */
#define SCOUT_FIRST_FAILED_FACTOR  0.125 /* The scout's next step is this part of a first step that fails. */
#define SCOUT_FAILED_FACTOR        0.6   /* The scout's next step is this part of a later step that fails. */
#define SCOUT_MAX_GROWTH           1.6   /* The scout's next step is at most this many times the last one. */
#define SCOUT_MIN_RESOLVING_FACTOR 0.4   /* The estimated resolving step size is at least this part of the last step. */
#define SCOUT_MAX_RESOLVING_FACTOR 8.0   /* The estimated resolving step size is at most this many times the last. */
#define SCOUT_HARDER_FACTOR        0.9   /* A harder position has a resolving step below this part of the least. */
#define SCOUT_MAX_ENERGY_CHANGE    0.1   /* The scout's first step may change the energy by this part. */
#define SCOUT_MAX_DISTANCE         0.25  /* The scout's first step and two half steps may differ by this part. */
#define SCOUT_ERROR_POWER          4.0   /* A step's weight: its resolving step size to minus this power. */
#define SCOUT_MIN_WEIGHT           0.02  /* The least weight of a step, in weights of the hardest step. */

#endif
