/* stepper.h - Declares a stepper: a table of functions that make the steps of a method, for one integrator and for
 * the members of an ensemble. Integrators (src/run/) call the functions. */
#ifndef TVI_SRC_METHOD_STEPPER_H
#define TVI_SRC_METHOD_STEPPER_H

#include "emit.h"
#include "method/origin.h"
#include "system/system.h"

/* A range of components, first .. end - 1. */
typedef struct {
    int first, end;
} tvi_component_range;

/* The tapes of a system that steps run, and the parts of each that generated code is to contain (src/compiled/). A
 * tape with the name NULL is not used. */
typedef struct {
    jet_emission_request series, values, bend, hessian;
    /* Writes the definition of tvi_loops after the sweeps of the tapes; `code_member` is the name of the pointer to
     * it in tvi_code (compiled/code.h). NULL: the method has no such code. */
    const char *code_member;
    void (*emit_loops)(jet_text *text, const tvi_system *system, const tvi_options *options);
} tvi_used_tapes;

/* The results of a step of several members. The stepper writes to nothing else except its own memory. */
typedef struct {
    tvi_increments increments; /* [components][width] each. */
    /* [width] Only lanes with TVI_OK are stepped. Nothing is written for other lanes. */
    tvi_status *status;
    double *tail; /* [width] The tail of each member's step (tvi_stats.tail). */
    int *passes;  /* [width] The number of passes of each member's step. */
} tvi_batch_results;

/* The functions that step several members of an ensemble at once. Lanes are independent: the bits of a member's
 * results depend neither on its lane nor on other members. Up to roundoff they are those of the stepper for single
 * integrators. */
typedef struct {
    /* Returns the number of members of a batch, a power of two; 1: this system is stepped faster one by one. */
    int (*width)(const tvi_system *system, const tvi_options *options);
    /* The next functions do what those of tvi_stepper with the same names do. The history is that of a batch, and
     * all zeros before a first step. */
    void *(*take)(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width);
    void (*prepare)(void *work);
    /* Makes a step. Lanes that are not stepped contain a finite state, inside the domain as far as is known. The
     * statistics count all lanes together. */
    void (*step)(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_results *end, tvi_stats *stats);
    /* Copy the history of a lane to that of the memory `scalar` of a single stepper, which is all zeros, and back.
     * NULL: steps leave no history. */
    void (*lane_to_scalar)(const void *work, int lane, void *scalar);
    void (*scalar_to_lane)(void *work, int lane, const void *scalar);
    /* Clears the history of a lane, as before a first step. NULL: steps leave no history. */
    void (*forget)(void *work, int lane);
    /* Does what tvi_stepper.is_sound does, for the histories of all lanes. */
    bool (*is_sound)(const void *work);
    /* Computes tvi_stepper.most_change of each lane, [width]. NULL: the stepper has no such bound. */
    void (*most_change)(const void *work, double change[]);
} tvi_batch_stepper;

/* The functions that step one integrator. */
typedef struct {
    /* Allocates the stepper's memory in the arena. Returns NULL as long as the arena only measures. Everything that
     * a step leaves to the next one is allocated in the arena's history. The history is restored after a step that
     * failed, and is all zeros before a step that continues no other. */
    void *(*take)(tvi_arena *arena, const tvi_system *system, const tvi_options *options);
    /* Sets the tables in memory that is allocated. NULL: there are no tables. */
    void (*prepare)(void *work);
    /* Computes the increments over the step h as sums of small quantities, never as the difference of the ends.
     * Their low-order parts are 0 beforehand. On failure the increments are undefined. */
    tvi_status (*step)(void *work, double h, const tvi_origin *origin, const tvi_increments *increments,
                       tvi_stats *stats);
    /* Makes several steps from `state`, which it updates, each with the result of `step`. Returns the number of
     * steps made; a step that needs a check is not begun. NULL: the stepper cannot do this. */
    long (*run)(void *work, const tvi_step_run *row, const tvi_run_state *state, tvi_stats *stats);
    /* Computes dq, dp [n]: the state at t0 + theta h inside the last step, minus the state at its start. */
    void (*dense)(void *work, double theta, double dq[], double dp[]);
    /* Computes the states at all tvi_sample_theta from the state at the start: q, p [n][TVI_SAMPLES], for the
     * components used[0] of q and used[1] of p. NULL: `dense` is called for each point. */
    void (*sample)(void *work, const tvi_component_range used[2], const double q_start[], const double p_start[],
                   double *q, double *p);
    /* The error of the end of a step, and of its derivative by the step size, is of the size of the tail squared, if
     * the degree is more than 1. */
    bool is_superconvergent;
    /* Makes a step of at most *h that meets a relative tolerance, and sets *h to its size, also on failure. NULL:
     * the method has no such step. */
    tvi_status (*step_within)(void *work, double tolerance, double *h, const tvi_origin *origin,
                              const tvi_increments *increments, tvi_stats *stats);
    /* Returns a bound of the change of the energy in the last step. It holds if the forces are monotonic along the
     * step and the terms of the series decrease. If it is NULL, and in rescaled systems, the tail decides whether
     * the energy is computed (run/guard.c). */
    double (*most_change)(const void *work);
    /* Tells whether all indices in the stepper's part of a loaded history are inside their arrays. NULL: the history
     * has no indices. */
    bool (*is_sound)(const void *work);
    tvi_used_tapes (*uses)(const tvi_system *system, const tvi_options *options);
    /* The functions for batches; NULL: members of an ensemble are stepped one by one. */
    const tvi_batch_stepper *batch;
} tvi_stepper;

extern const tvi_stepper tvi_stepper_curve, tvi_stepper_taylor, tvi_stepper_composed, tvi_stepper_galerkin;
extern const tvi_batch_stepper tvi_curve_batch, tvi_galerkin_batch;

#endif
