/* stepper.h - Declares a stepper: a table of functions that make the steps of a method. Integrators (src/run/) call
 * them. */
#ifndef TVI_SRC_METHOD_STEPPER_H
#define TVI_SRC_METHOD_STEPPER_H

#include "algebra/passes.h"
#include "emit.h"
#include "method/origin.h"
#include "system/system.h"

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
    /* Requests for the code of four tapes: the series of the field, its values, the gradient of r.H_p for a vector r
     * (Hamiltonian), and the second derivatives. */
    jet_emission_request series_tape_emission, value_tape_emission, r_dot_Hp_tape_emission, hessian_tape_emission;
    /* Writes the definition of the generated steps of "galerkin", which has the name tvi_loops, after the sweeps of the
     * tapes. NULL: the method has none. */
    void (*emit_loops)(jet_text *text, const tvi_system *system, const tvi_options *options);
} tvi_tapes_of_steps;

/* The functions that step one integrator. */
typedef struct {
    /* Allocates the stepper's memory, the `work` of the functions below, in the arena. Returns NULL as long as the
     * arena only measures. Everything that a step leaves to the next one is allocated in the arena's history. The
     * history is restored after a step that failed, and is all zeros before a step that continues no other. */
    void *(*allocate)(tvi_arena *arena, const tvi_system *system, const tvi_options *options);
    /* Sets the tables in the stepper's memory, after the memory of the arena is obtained. NULL: there are no
     * tables. */
    void (*set_tables)(void *work);
    /* Computes the increments over the step h as sums of small quantities, never as the difference of the ends.
     * Their low-order parts are 0 beforehand. On failure the increments are undefined. */
    tvi_status (*step)(void *work, double h, const tvi_step_origin *origin, const tvi_increments *increments,
                       tvi_stats *stats);
    /* Makes several steps from `state`, and updates it. Each step has the same result as `step`. The function ends
     * before a step that needs a check, and returns the number of steps that it made. NULL: the stepper only makes
     * single steps. */
    long (*run)(void *work, const tvi_run_request *request, const tvi_run_state *state, tvi_stats *stats);
    /* Computes dq, dp [n]: the state at t0 + theta h inside the last step, minus the state at its start. */
    void (*interpolate)(void *work, double theta, double dq[], double dp[]);
    /* Computes the states q, p [n][TVI_SAMPLES] at the TVI_SAMPLES times t0 + theta h of tvi_sample_theta (origin.h)
     * from the state at the start, for the components used[0] of q and used[1] of p. NULL: `interpolate` is called for
     * each time. */
    void (*sample)(void *work, const tvi_component_range used[2], const double q_start[], const double p_start[],
                   double *q, double *p);
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
    /* Tells whether all indices in the stepper's part of a loaded history are inside their arrays. NULL: the history
     * has no indices. */
    bool (*is_history_valid)(const void *work);
    /* Returns the tapes that steps run with these options. */
    tvi_tapes_of_steps (*list_tapes)(const tvi_system *system, const tvi_options *options);
} tvi_stepper;

extern const tvi_stepper tvi_stepper_curve, tvi_stepper_both_ends, tvi_stepper_taylor, tvi_stepper_composed,
    tvi_stepper_galerkin;

#endif
