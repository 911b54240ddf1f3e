/* stepper.h - Declares a stepper, the table of functions that make the steps of a method: what a step gets (its
 * origin), what it makes (increments), and the functions. Integrators (src/integrator) call them. Adds increments to
 * states by compensated summation. Generated steps contain this text, but for the table. */
#ifndef TVI_SRC_METHOD_STEPPER_H
#define TVI_SRC_METHOD_STEPPER_H

#include "algebra/passes.h"
#include "emit.h"
#include "tvi.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* ---- Steps, and runs of steps ------------------------------------------------------------------------------------ */

/* The origin of a step: the state at its start, with the low-order parts of the compensated sums. The state is (t +
 * t_low, q + q_low, p + p_low). */
typedef struct {
    double t, t_low;
    const double *q, *q_low, *p, *p_low;
} tvi_step_origin;

/* A state between steps, for a system in which steps are made (tvi_system.stepped_system) with N degrees of freedom.
 * q[N] is the independent variable of the steps: the time, or s of a rescaled system. If the user's system has n < N
 * degrees of freedom, it is rescaled; q[n] is then the time, and p[n] is e = -H. The arrays q_low and p_low are the
 * low-order parts of the compensated sums. */
typedef struct {
    double *q, *q_low; /* [N + 1] coordinates and independent variable, and their low-order parts */
    double *p, *p_low; /* [N] the momenta, and their low-order parts */
} tvi_run_state;

/* The increments of a step, in two parts: dq + dq_low and dp + dp_low. The second parts are 0 if the method rounds
 * its increments to one number. */
typedef struct {
    /* The increments of N coordinates and of the time, dq [N + 1], and of N momenta, dp [N], and their low-order
     * parts, of which dq_low[N] is always 0. */
    double *dq, *dp, *dq_low, *dp_low;
} tvi_increments;

/* Limits of the tail of a step and of the number of its passes. A step within both limits is accepted without a check
 * of its energy. */
typedef struct {
    double max_tail;
    int max_passes;
} tvi_unchecked_step_limits;

/* A request to make several steps without checks between them: at most `max_steps` steps of size h, each within
 * `unchecked_limits`. In a rescaled system the time is the coordinate q[index_of_time_in_q]. It must move in the
 * direction of h and stay before t_end. In other systems index_of_time_in_q is -1. */
typedef struct {
    double h;
    long max_steps;
    tvi_unchecked_step_limits unchecked_limits;
    int index_of_time_in_q;
    double t_end;
    /* Where the steps write their increments. Each step overwrites those of the step before, so that the increments of
     * the last step are left. No stepper writes dq[N], the increment of the independent variable: the caller sets it to
     * h before the steps, and adding the increments to a state adds h to its time. */
    tvi_increments last_step_increments_out;
} tvi_run_request;

/* Returns the least change of the time in a step, which is the roundoff of its low-order part. With smaller changes
 * a run would never end. */
static inline double tvi_least_time_change(double t) { return DBL_EPSILON * DBL_EPSILON * fabs(t); }

/* Tells whether the time moves in the direction of h in a step from q, and stays before t_end. */
static inline bool tvi_step_ends_before_t_end(const tvi_run_request *request, const double q[])
{
    if (request->index_of_time_in_q < 0) return true;
    const double t = q[request->index_of_time_in_q], way = request->h > 0 ? 1 : -1,
                 dt = way * request->last_step_increments_out.dq[request->index_of_time_in_q];
    return dt > tvi_least_time_change(t) && dt < way * (request->t_end - t);
}

/* Adds (increment, increment_low) to (x, *low). Returns the new x, and updates *low. The error is of the size of the
 * roundoff of *low. */
static inline double tvi_add_compensated(double x, double *low, double increment, double increment_low)
{
    double rest;
    const double small = tvi_two_sum(*low, increment, &rest), sum = tvi_two_sum(x, small, low);
    *low += rest + increment_low;
    return sum;
}

/* Adds the increments of all components by compensated summation, as tvi_add_compensated does. Returns 0 if all sums
 * are finite, and otherwise another number. */
static inline uint64_t tvi_add_all_compensated(int count, double *restrict x, double *restrict low,
                                               const double *restrict increment, const double *restrict increment_low)
{
    uint64_t any = 0;
    for (int i = 0; i < count; i++) {
        const double sum = tvi_add_compensated(x[i], &low[i], increment[i], increment_low[i]);
        any |= tvi_nonzero_if_nonfinite(sum);
        x[i] = sum;
    }
    return any;
}

/* The number of points at which a search for events samples a step. */
enum { TVI_SAMPLES = 8 };
/* The positions theta = k / 8 of the points, 1 .. 8: t0 + theta h is the time (integrator/inside_step.c). */
extern const double tvi_sample_theta[TVI_SAMPLES];

#ifndef JET_EMITTED
/* ---- The table of functions. Generated steps, which call none of them, do not contain it. ------------------------ */

typedef struct tvi_arena tvi_arena; /* algebra/arena.h */

/* Returns the rule that decides when the passes of a step end, with the limits of passes from the options. A tolerance
 * other than 0 replaces rule->correction_goal, and is measured as the corrections are, absolutely or relatively. */
static inline tvi_stopping_rule tvi_passes_rule_with_options(const tvi_stopping_rule *rule, const tvi_options *options,
                                                             double tolerance)
{
    tvi_stopping_rule requested = *rule;
    if (options->max_passes > 0) requested.max_passes = options->max_passes;
    if (options->passes > 0) requested.max_passes = requested.exact_passes = options->passes;
    if (tolerance > 0) {
        requested.correction_goal = tolerance;
        requested.max_trusted_ratio = 0;
    }
    return requested;
}

/* A range of components, first .. end - 1. */
typedef struct {
    int first, end;
} tvi_component_range;

/* The tapes of a system that the steps of a method run, and the parts of each that generated code is to contain
 * (src/compiled/). A tape with the name NULL is not used. */
typedef struct {
    /* Requests for the code of six tapes: the series of the field, its values, the gradient of r.H_p for a vector r
     * (Hamiltonian), and the second derivatives; the constraints, and their curvature. */
    jet_emission_request series_tape_emission, value_tape_emission, r_dot_Hp_tape_emission, hessian_tape_emission,
        constraint_tape_emission, curvature_tape_emission;
    /* Writes the generated steps of a method after the sweeps of the tapes: the text defines the structure
     * tvi_generated_steps (galerkin/steps.h). "galerkin" has emit_steps of galerkin/galerkin.c; NULL: the method has no
     * generated steps. */
    void (*emit_steps)(jet_text *text, const tvi_system *system, const tvi_options *options);
} tvi_tapes_of_steps;

enum { TVI_FORCE_POINTS = 2 + TVI_MAX_NODES, TVI_MOST_POINTS = 16 };

/* The functions that make the steps of one integrator. tvi_choose_stepper of method.c chooses the table by the method's
 * descriptor (descriptor.h). Each table stands at the end of its file:
 *     tvi_stepper_galerkin                       galerkin/galerkin.c
 *     tvi_stepper_constrained                    galerkin/constrained.c
 *     tvi_stepper_curve, tvi_stepper_taylor      generating/step.c
 *     tvi_stepper_both_ends                      generating/both_ends.c
 *     tvi_stepper_composed                       method/composed.c
 * "stormer-verlet" has a table of its own in method/verlet.c. */
typedef struct {
    /* Allocates the stepper's memory, the `work` of the functions below, in the arena. Returns NULL as long as the
     * arena only measures. Everything that a step leaves to the next one is allocated in the arena's history. The
     * history is restored after a step that failed, and is all zeros before a step that continues no other. */
    void *(*allocate)(tvi_arena *arena, const tvi_system *system, const tvi_options *options);
    /* Sets the tables in the stepper's memory, after the memory of the arena is obtained. NULL: there are no
     * tables. */
    void (*set_tables)(void *work);
    /* Computes the increments of q and p over the step h as sums of small quantities, never as the difference of the
     * ends. Their low-order parts are 0 beforehand. On failure the increments are undefined. The caller adds them to
     * the state, and h to the time. */
    tvi_status (*step)(void *work, double h, const tvi_step_origin *origin, const tvi_increments *increments,
                       tvi_stats *stats);
    /* Makes several steps from `state`, and updates it. Each step has the same result as `step`. The function ends
     * before a step that needs a check, and returns the number of steps that it made. NULL: the stepper only makes
     * single steps. */
    long (*run)(void *work, const tvi_run_request *request, const tvi_run_state *state, tvi_stats *stats);
    /* Computes dq, dp [n]: the state at t0 + theta h inside the last step, minus the state at its start. */
    void (*interpolate)(void *work, double theta, double dq[], double dp[]);
    /* Computes the states q, p [n][TVI_SAMPLES] at the TVI_SAMPLES times t0 + theta h of tvi_sample_theta
     * from the state at the start, for the components used[0] of q and used[1] of p. NULL: `interpolate` is called for
     * each time. */
    void (*sample)(void *work, const tvi_component_range used[2], const double q_start[], const double p_start[],
                   double *q, double *p);
    /* Computes forces [n][TVI_FORCE_POINTS], the derivatives p' of the last step's curve by the variable of the steps:
     * at its start, at its end, and then at its nodes. Returns the number of points. NULL: the stepper has no nodes. */
    int (*compute_curve_forces)(const void *work, double *forces);
    /* The method's own quadrature: integrals of the adjoint system by it are exact derivatives of a step
     * (system/adjoint.h). `quadrature` sets the nodes theta [TVI_MOST_POINTS], as fractions of a step, and the weights
     * b, which are 0 for copies of the last node, and returns their number. `at_nodes` computes the coordinates q and,
     * unless the system is separable, the momenta p of the last step there, [n][nodes], from the state at its start.
     * NULL: the steps of the adjoint system are not the derivatives of the steps. */
    int (*quadrature)(const void *work, double theta[], double b[]);
    void (*at_nodes)(void *work, const double q_start[], const double p_start[], double *q, double *p);
    /* If the degree is more than 1, the errors of the state at the end of a step, and of its derivative by the step
     * size, are of the size of the squared tail. */
    bool is_superconvergent;
    /* Makes a step that meets a relative tolerance, of the size *h or smaller, and sets *h to the size of the step,
     * also on failure. NULL: the method cannot choose the size of a step. */
    tvi_status (*step_within_tolerance)(void *work, double tolerance, double *h, const tvi_step_origin *origin,
                                        const tvi_increments *increments, tvi_stats *stats);
    /* Returns a bound of the change of the energy in the last step. The bound holds if the forces are monotonic along
     * the step and the terms of the series decrease. The tail decides whether the energy is computed if this function
     * is NULL, and in rescaled systems (integrator/guard.c). */
    double (*bound_energy_change)(const void *work);
    /* Returns h w of the last step, where w^2 is the change of the forces over that of the coordinates, in units of the
     * masses: w is a frequency, or the rate of a motion away from an unstable point. NULL: the energy alone decides
     * whether a step is too large. */
    double (*compute_phase)(const void *work);
    /* From this h w on a step of an oscillator of frequency w is unstable. */
    double stable_phase;
    /* Tells whether all indices in the stepper's part of a loaded history are inside their arrays. NULL: the history
     * has no indices. */
    bool (*is_history_valid)(const void *work);
    /* Returns the tapes that steps run with these options. */
    tvi_tapes_of_steps (*list_tapes)(const tvi_system *system, const tvi_options *options);
} tvi_stepper;

extern const tvi_stepper tvi_stepper_curve, tvi_stepper_both_ends, tvi_stepper_taylor, tvi_stepper_composed,
    tvi_stepper_galerkin, tvi_stepper_constrained;

#endif
#endif
