/* integrator.h - Declares what an integrator holds between steps, and the functions on its members that runs share. It
 * holds the state of one member, or those of a batch, whose members are stepped at once. Arrays of members are
 * [components][width], the member fastest. */
#ifndef TVI_SRC_RUN_INTEGRATOR_H
#define TVI_SRC_RUN_INTEGRATOR_H

#include "method/stepper.h"
#include "system/energy.h"

#include <math.h>
#include <string.h>

/* The energy that the guard compares with (energy_zero.h). */
typedef struct {
    double zero;     /* the energy from which it is counted */
    double scale;    /* its size, where it was first asked for */
    double H;        /* its value at the current state */
    long has_scale;  /* zero and scale are set */
    long is_lowered; /* the zero is an estimate, which may be lowered */
    long is_known;   /* H is set */
} tvi_reference_energy;

/* The memory of tvi_step_tangent, which is made when that is first called (tangent.c). */
typedef struct tvi_tangent tvi_tangent;

/* A state at which events have stopped a run, and the events that were reported there. As long as t and q are the same,
 * whatever p is, a run that goes on has left these events. Events beyond TVI_STOP_EVENTS are judged by their
 * roundoff. */
enum { TVI_STOP_EVENTS = 32 };
typedef struct {
    int64_t is_set, count;
    uint64_t events[TVI_STOP_EVENTS]; /* [count] tvi_event.hash */
    double state[];                   /* [2n + 1] q, p, t */
} tvi_stop;
static inline size_t tvi_size_of_stop_in_bytes(int n)
{
    return sizeof(tvi_stop) + (2 * (size_t)n + 1) * sizeof(double);
}

struct tvi_integrator {
    int width;                /* members; 1 for tvi_integrator_create */
    const tvi_system *system; /* the user's, of dimension n */
    /* The system that steps are made of, with generated code if there is any. */
    const tvi_system *stepped;
    /* [tvi_system_parameters][width] values of the parameters, which the blocks get. */
    double *parameters;
    const tvi_block *blocks; /* of the stepper's tapes */
    /* The blocks of one lane, which have the parameters of one member at a time. */
    const tvi_block *one_lane_blocks;
    /* [tvi_system_parameters] the values in `one_lane_blocks`. */
    double *one_lane_parameters;
    tvi_options options; /* resolved */
    tvi_stats stats;     /* counts of all members together */
    const tvi_stepper *stepper;
    void *work;    /* the stepper's; of a batch that of stepper->batch */
    char *history; /* [history_bytes] all that one step leaves to the next */
    /* [marked_bytes] the first part of the history, as it was before the last step was tried. A batch keeps
     * none. */
    char *history_before;
    size_t history_bytes; /* bytes */
    size_t marked_bytes;  /* bytes */
    /* Bytes of the marked history that belong to the state; the stepper's follow. */
    size_t state_bytes;
    /* [width] in the history: `state` holds what the member's last successful step returned. */
    long *continues;
    /* The value of `continues` before the last step: that step began with the result of the one before it. */
    const long *continued;
    tvi_run_state state;                  /* in the history */
    tvi_run_state start;                  /* of the last step, in history_before */
    tvi_stop *stop;                       /* the last stop of one member */
    long parameter_version;               /* how often the parameters were set */
    bool is_in_observer;                  /* an observer is being called: steps are refused */
    bool has_dense;                       /* the work holds the last step */
    double h, covered;                    /* size of the last step that was tried, and the time that it covers */
    tvi_increments increments;            /* of the current step */
    tvi_status *status;                   /* [width] only members with TVI_OK are stepped */
    bool *is_stepped;                     /* [width] the member is being stepped */
    double *tail;                         /* [width] tvi_stats.tail of the last step */
    int *passes;                          /* [width] of the last step */
    double *overflows;                    /* [width] not 0: the new state is not finite */
    double *run_start;                    /* [2 n + 1][width] in the history: q, t, p where the runs began */
    tvi_reference_energy *reference;      /* [width] in the history */
    double *energy_change;                /* [width] a bound of the change by the stepper's step */
    bool *needs_energy;                   /* [width] the energy has to be computed */
    double *energy_before, *energy_after; /* [width] */
    tvi_run_state end;                    /* where the step ends, without low-order parts */
    tvi_run_state member_state;           /* of one member, without low-order parts */
    tvi_energy_work energy;               /* of one member; its block is NULL if no step asks for it */
    tvi_energy_work transformed;          /* of a rescaled system: K */
    tvi_energy_lanes energies;            /* of all members at once; its block is NULL if there is none */
    double *field;                        /* block of the field's values at one point */
    tvi_tangent *tangent;                 /* NULL: not used so far */
    void (*free_tangent)(tvi_tangent *tangent);
};

/* Tells whether the steps' variable is not the user's time. */
static inline bool tvi_is_rescaled(const tvi_integrator *integrator)
{
    return integrator->system->stepped != integrator->system;
}

/* The stepper's functions for a batch; NULL if members are stepped one at a time. */
static inline const tvi_batch_stepper *tvi_batch_stepper_of(const tvi_integrator *integrator)
{
    return integrator->width > 1 ? integrator->stepper->batch : NULL;
}

/* ---- Members (member.c) ------------------------------------------------------------------------------------------ */

/* A state of the user, whose component i stands at q[i * stride] and p[i * stride]. */
typedef struct {
    const double *q, *p;
    size_t stride;
    double t;
} tvi_user_state;

/* Loads the given state into the member, as every step begins. Does nothing if it is what the member's last step
 * returned. */
TVI_NODISCARD tvi_status tvi_member_begin_step(tvi_integrator *integrator, int member, const tvi_user_state *given);
/* Tells whether the member's state is bitwise this one. It remains so after a step that failed. */
bool tvi_member_has_state(const tvi_integrator *integrator, int member, const tvi_user_state *given);
/* Copies the member's state to the user's arrays. */
void tvi_member_copy_state(const tvi_integrator *integrator, int member, double *t, double q[], double p[],
                           size_t stride);
/* Copies the state and the history of a member to a member of another integrator for the same system and options. One
 * of the two integrators has width 1. The rest of what a batch keeps is cleared. */
void tvi_member_copy_between_integrators(tvi_integrator *to, int member_to, const tvi_integrator *from,
                                         int member_from);
/* Copies the parameters of the member to the blocks of one lane. */
void tvi_member_load_parameters(tvi_integrator *integrator, int member);
/* Computes the member's energy at (q, p), whose rows are those of a tvi_run_state. */
TVI_NODISCARD tvi_status tvi_member_compute_energy(tvi_integrator *integrator, int member, const double *q,
                                                   const double *p, double *H);

/* The three functions above for an integrator of one member. */
TVI_NODISCARD static inline tvi_status tvi_integrator_begin_step(tvi_integrator *integrator, double t, const double q[],
                                                                 const double p[])
{
    return tvi_member_begin_step(integrator, 0, &(tvi_user_state){q, p, 1, t});
}
static inline bool tvi_integrator_has_state(const tvi_integrator *integrator, double t, const double q[],
                                            const double p[])
{
    return tvi_member_has_state(integrator, 0, &(tvi_user_state){q, p, 1, t});
}
static inline void tvi_integrator_copy_state(const tvi_integrator *integrator, double *t, double q[], double p[])
{
    tvi_member_copy_state(integrator, 0, t, q, p, 1);
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

/* Call an observer, while the integrator refuses steps, and return its value; 0 if the observer is NULL. */
int tvi_call_observer(tvi_integrator *integrator, tvi_observer *observer, long step, double t, const double q[],
                      const double p[], void *ctx);
int tvi_call_event_observer(tvi_integrator *integrator, tvi_event_observer *observer, int which, double t,
                            const double q[], const double p[], void *ctx);

/* Creates an integrator of `width` members for the same system and options, which has made no step. */
TVI_NODISCARD tvi_status tvi_integrator_create_like(tvi_integrator **out, const tvi_integrator *integrator, int width);
/* The number of members at once that serves the system best; 1: one after the other. */
int tvi_integrator_best_batch_width(const tvi_integrator *integrator);

/* Copies the values in `parameters` to the blocks that steps use. */
void tvi_integrator_apply_parameters(tvi_integrator *integrator);

/* Sets the parameters of the first `count` members to value[tvi_system_parameters][stride], and those of the others to
 * the first member's. The run goes on as if they had always had these values. */
void tvi_integrator_load_parameters(tvi_integrator *integrator, const double value[], size_t stride, int count);

/* Provides the tangent's memory for this number of columns (tangent.c). */
TVI_NODISCARD tvi_status tvi_integrator_allocate_tangent(tvi_integrator *integrator, int columns);

/* Tells whether the status says that the member itself has failed. Other statuses tell of the run, or of the call. */
static inline bool tvi_is_failure_of_member(tvi_status status)
{
    return status == TVI_ENONFINITE || status == TVI_EDOMAIN || status == TVI_ENOCONV || status == TVI_ESINGULAR ||
           status == TVI_ETOOLARGE;
}

/* The end time of a run that goes in the direction of h for ever. */
static inline double tvi_infinite_end_time(double h) { return copysign(INFINITY, h); }

/* Makes `steps` steps, or, after the first one, steps until the time reaches t_end. t, q and p are written once, after
 * the last step or after the one before the first failure. */
TVI_NODISCARD tvi_status tvi_make_steps(tvi_integrator *integrator, long steps, double h, double t_end, double *t,
                                        double q[], double p[]);
/* Makes up to `steps` steps of size h of the members that are TVI_OK, as long as there is one. */
void tvi_step_batch(tvi_integrator *integrator, long steps, double h);
/* Makes a step as tvi_step does. With a tolerance > 0 its size is chosen to serve it, at most h (stepper.h), and is
 * returned in integrator->h. */
TVI_NODISCARD tvi_status tvi_step_by_tolerance(tvi_integrator *integrator, double tolerance, double h, double *t,
                                               double q[], double p[]);

/* The time from the state to t_end, with the low-order part of the time. */
double tvi_remaining_time(const tvi_integrator *integrator, double t_end);
/* Sets the time to t_end if it differs by roundoff alone, which goes to its low-order part. */
void tvi_set_time_to_end(tvi_integrator *integrator, double t_end, double *t);

/* Undoes the last step, and writes the state that the step started from. */
void tvi_integrator_undo_step(tvi_integrator *integrator, double *t, double q[], double p[]);

/* Computes the state of tvi_dense, and its time. */
TVI_NODISCARD tvi_status tvi_compute_dense_state(tvi_integrator *integrator, double theta, double *t, double q[],
                                                 double p[]);

/* Computes the states at the sample points of the last step (stepper.h), in the layout of a tape with a lane for each:
 * q, p and t in x [2n + 1][TVI_SAMPLES]. Only the components used[0] of q and used[1] of p, and t, are set; the others
 * may be overwritten. The last sample is the step's own end. The states may not be finite. */
void tvi_sample_dense_output(tvi_integrator *integrator, const tvi_range used[2], double *x);

#endif
