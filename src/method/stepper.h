/* stepper.h - Declares a stepper: the functions that make a step of a method, for one member and for a batch. */
#ifndef TVI_SRC_METHOD_STEPPER_H
#define TVI_SRC_METHOD_STEPPER_H

#include "emit.h"
#include "method/origin.h"
#include "system/system.h"

/* Components first .. end - 1 of a vector. */
typedef struct {
    int first, end;
} tvi_range;

/* The parts of a system's tapes that steps run, for generated code (compiled/). Parts with the name NULL are not
 * used. */
typedef struct {
    jet_emission series, values, bend, hessian;
    /* Defines tvi_loops, to which `member` of the code points (compiled/code.h), after the sweeps of the tapes; NULL:
     * there is no such thing. */
    const char *member;
    void (*emit_loops)(jet_text *text, const tvi_system *system, const tvi_options *options);
} tvi_used_tapes;

/* The results of a step of several members. The stepper writes nothing else but its own work. */
typedef struct {
    tvi_increments increments; /* [components][width] each */
    /* [width] Only lanes with TVI_OK are stepped; nothing of the others is written. */
    tvi_status *status;
    double *tail; /* [width] tvi_stats.tail */
    int *passes;  /* [width] of this step */
} tvi_batch_end;

/* Functions that step several members at once. Lanes are independent: the bits of a member depend neither on its lane
 * nor on the other members. Up to roundoff they are those of the stepper's own step. */
typedef struct {
    /* The number of members of a batch, a power of two; 1: single members serve the system better. */
    int (*width)(const tvi_system *system, const tvi_options *options);
    /* These do what the stepper's functions of the same names do. The history is that of one batch, and all zeros
     * before a first step. */
    void *(*take)(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width);
    void (*prepare)(void *work);
    /* Makes a step. Lanes that are not stepped hold a finite state, in the domain as far as is known. The stats count
     * all lanes together. */
    void (*step)(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_end *end, tvi_stats *stats);
    /* Copy the history of a lane to the history of the stepper's own work `one`, which is all zeros, and back. NULL:
     * steps leave no history. */
    void (*lane_to_scalar)(const void *work, int lane, void *scalar);
    void (*scalar_to_lane)(void *work, int lane, const void *scalar);
    /* Clears the history of a lane, as before a first step. NULL: steps leave none. */
    void (*forget)(void *work, int lane);
    /* Does what tvi_stepper.is_sound does, for the history of all lanes. */
    bool (*is_sound)(const void *work);
    /* Computes tvi_stepper.most_change of each lane, [width]. NULL: the stepper has no such bound. */
    void (*most_change)(const void *work, double change[]);
} tvi_batch_stepper;

typedef struct {
    /* Lays out the stepper's work in the arena; NULL as long as the arena only measures. All that a step leaves to the
     * next one is taken from the arena's history. The history is restored after a step that failed, and is all zeros
     * before a step that continues no other. */
    void *(*take)(tvi_arena *arena, const tvi_system *system, const tvi_options *options);
    /* Fills the tables of the work, in memory that is there. NULL: there are none. */
    void (*prepare)(void *work);
    /* Computes the increments over the step h from small quantities, never as end minus start. Their second parts are
     * zeros beforehand. On failure they are undefined. */
    tvi_status (*step)(void *work, double h, const tvi_origin *origin, const tvi_increments *increments,
                       tvi_stats *stats);
    /* Makes several steps from `state`, which it updates, each with the result of `step`. Returns how many: a step that
     * needs a check is not begun. NULL: the stepper has none. */
    long (*run)(void *work, const tvi_step_run *row, const tvi_run_state *state, tvi_stats *stats);
    /* Computes dq, dp [n]: the state at t0 + theta h of the last step, less the one at its start. */
    void (*dense)(void *work, double theta, double dq[], double dp[]);
    /* Computes the states at all tvi_sample_theta from the state at the start: q, p [n][TVI_SAMPLES], components
     * used[0] of q and used[1] of p. NULL: `dense` is called for each. */
    void (*sample)(void *work, const tvi_range used[2], const double q_start[], const double p_start[], double *q,
                   double *p);
    /* The end of a step, and its derivative by the step's size, differ from the solution by the square of the tail if
     * the degree is more than 1. */
    bool is_superconvergent;
    /* Makes a step that serves a relative tolerance, of at most *h, and sets *h to its size, also if it fails. NULL:
     * the method has no such step. */
    tvi_status (*step_within)(void *work, double tolerance, double *h, const tvi_origin *origin,
                              const tvi_increments *increments, tvi_stats *stats);
    /* A bound of the change of the energy in the last step. It holds if the forces are monotonic along the step, and
     * the terms of the series decrease. NULL, and in s: the tail decides whether the energy is computed (guard.c). */
    double (*most_change)(const void *work);
    /* Tells whether the work's part of a loaded history has its indices within their arrays. NULL: it has none. */
    bool (*is_sound)(const void *work);
    tvi_used_tapes (*uses)(const tvi_system *system, const tvi_options *options);
    const tvi_batch_stepper *batch; /* NULL: members of an ensemble are stepped one by one */
} tvi_stepper;

extern const tvi_stepper tvi_stepper_curve, tvi_stepper_taylor, tvi_stepper_composed, tvi_stepper_galerkin;
extern const tvi_batch_stepper tvi_curve_batch, tvi_galerkin_batch;

#endif
