/* stepper.h - the frame of a step: what every stepper is given and returns. */
#ifndef TVI_SRC_METHOD_STEPPER_H
#define TVI_SRC_METHOD_STEPPER_H

#include "emit.h"
#include "method/origin.h"
#include "system/system.h"

/* Components first .. end - 1 of a vector. */
typedef struct {
    int first, end;
} tvi_range;

/* What steps run of the tapes of a system, for generated code to have it (compiled/). A name NULL: nothing of one. */
typedef struct {
    jet_emission series, values, bend, second;
    /* Defines tvi_loops, to which `member` of the code points (compiled/code.h), after the sweeps of the tapes; NULL:
     * there is no such thing. */
    const char *member;
    void (*emit_loops)(jet_text *text, const tvi_system *system, const tvi_options *options);
} tvi_uses;

/* What a step made of the members: all that the stepper writes, but its own work. */
typedef struct {
    tvi_increments by;  /* [components][width] each */
    tvi_status *status; /* [width] a lane with another one than TVI_OK is left alone: nothing of it is written */
    double *tail;       /* [width] tvi_stats.tail of the lane */
    int *passes;        /* [width] of this step */
} tvi_batch_end;

/* Steps of several members at once. Lanes do not know of each other: the bits of a member depend neither on its lane
 * nor on what the others do, and to roundoff they are those of the stepper's own step. */
typedef struct {
    /* The members of a block, a power of two; 1: one after the other serves the system better. */
    int (*width)(const tvi_system *system, const tvi_options *options);
    /* As those of the stepper. The history is of one block; all zeros before a first step. */
    void *(*take)(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width);
    void (*prepare)(void *work);
    /* Lanes that are left alone hold a state that is finite, in the domain as far as is known. The counts of the stats
     * are those of all lanes together. */
    void (*step)(void *work, double h, const tvi_batch_origin *origin, const tvi_batch_end *end, tvi_stats *stats);
    /* What steps have left to the next one: from the history of the lane to that of the stepper's own work `one`, which
     * is all zeros, and the reverse. NULL: they leave nothing. */
    void (*get)(const void *work, int lane, void *one);
    void (*put)(void *work, int lane, const void *one);
    /* The lane is as before a first step. NULL: steps leave nothing. */
    void (*forget)(void *work, int lane);
    /* tvi_stepper.is_sound for the history of all lanes. */
    bool (*is_sound)(const void *work);
    /* tvi_stepper.most_change of each lane, [width]; NULL: it has none. */
    void (*most_change)(const void *work, double change[]);
} tvi_batch_stepper;

typedef struct {
    /* Lays out the stepper's work in the arena; NULL while the arena only measures. What a step leaves to the next one
     * is taken from the arena's history, which is as it was again after a step that failed, and all zeros before a
     * step that continues no other. */
    void *(*take)(tvi_arena *arena, const tvi_system *system, const tvi_options *options);
    /* Fills the tables of the work, once the memory is there. NULL: it has none. */
    void (*prepare)(void *work);
    /* The increments over the step h, formed from small quantities, never as end minus start; their second parts are
     * zeros beforehand. On failure they are undefined. */
    tvi_status (*step)(void *work, double h, const tvi_origin *origin, const tvi_increments *by, tvi_stats *stats);
    /* Steps from `now`, which moves on, each as `step` makes it; how many: one that is not to be made so is not begun.
     * NULL: there are none. */
    long (*run)(void *work, const tvi_row *row, const tvi_run_state *now, tvi_stats *stats);
    /* The state at t0 + theta h of the last step, less the one at its start: dq, dp [n]. */
    void (*dense)(void *work, double theta, double dq[], double dp[]);
    /* The states at all tvi_sample_place, from the one at the start: q, p [n][TVI_SAMPLES], of[0] of q and of[1] of p.
     * NULL: by dense, one after the other. */
    void (*sample)(void *work, const tvi_range of[2], const double q_start[], const double p_start[], double *q,
                   double *p);
    /* The end of a step, and its derivative by the step's size, are those of the solution but for parts of the size of
     * the square of the tail, where the degree is more than 1. */
    bool is_superconvergent;
    /* The same of a step whose error serves the relative tolerance, of at most *h, which becomes its size; or the one
     * that failed. NULL: the method has no such step. */
    tvi_status (*step_within)(void *work, double tolerance, double *h, const tvi_origin *origin,
                              const tvi_increments *by, tvi_stats *stats);
    /* More than the last step changes the energy by, where the forces grow or shrink all along it, and terms that are
     * left out become smaller. NULL, and in s: the tail says whether the energy is looked at (guard.c). */
    double (*most_change)(const void *work);
    /* Whether the work's part of a history that came from elsewhere has its indices within their arrays. NULL: it has
     * none. */
    bool (*is_sound)(const void *work);
    tvi_uses (*uses)(const tvi_system *system, const tvi_options *options);
    const tvi_batch_stepper *batch; /* NULL: members of an ensemble go one after the other */
} tvi_stepper;

extern const tvi_stepper tvi_stepper_curve, tvi_stepper_taylor, tvi_stepper_composed, tvi_stepper_galerkin;
extern const tvi_batch_stepper tvi_curve_batch, tvi_taylor_batch, tvi_galerkin_batch;

#endif
