/* integrator.h - what an integrator holds between steps: the state of one member, or those of a batch, whose members
 * are stepped at once. Arrays of members are [components][width], the member fastest. */
#ifndef TVI_SRC_RUN_INTEGRATOR_H
#define TVI_SRC_RUN_INTEGRATOR_H

#include "method/stepper.h"
#include "system/energy.h"

#include <math.h>
#include <string.h>

/* The energy of a run: its size where it began, and its value now. */
typedef struct {
    double scale, H;
    long has_scale, is_known; /* H */
} tvi_kept_energy;

/* What tvi_step_tangent needs, made when it is first called (tangent.c). */
typedef struct tvi_tangent tvi_tangent;

/* A state at which events have stopped a run, and the functions that were told there: as long as t and q are these,
 * whatever p was made, the run that goes on has left them. Beyond so many all others are judged by their roundoff. */
enum { TVI_STOP_TOLD = 32 };
typedef struct {
    int64_t is_set, count;
    uint64_t told[TVI_STOP_TOLD]; /* [count] tvi_event.hash */
    double state[];               /* [2n + 1] q, p, t */
} tvi_stop;
static inline size_t tvi_stop_bytes(int n) { return sizeof(tvi_stop) + (2 * (size_t)n + 1) * sizeof(double); }

struct tvi_integrator {
    int width;                 /* members; tvi_integrator_create makes an integrator of one */
    const tvi_system *system;  /* the user's, of dimension n, */
    const tvi_system *stepped; /* and the one that steps are made of, with generated code where there is any */
    double *parameters;        /* [tvi_system_parameters][width] their values, in */
    const tvi_block *blocks;   /* the blocks of the stepper's tapes, and in */
    const tvi_block *lone;     /* those of one lane, which have the parameters of one member at a time, */
    double *lent;              /* [tvi_system_parameters] these */
    tvi_options options;       /* as resolved */
    tvi_stats stats;           /* of all members together */
    const tvi_stepper *stepper;
    void *work;            /* the stepper's; of a batch that of stepper->batch */
    char *history;         /* [remembered] all that one step leaves to the next, */
    char *before;          /* [marked] and its first part before the last step was tried; a batch keeps none */
    size_t remembered;     /* bytes */
    size_t marked;         /* bytes */
    size_t of_state;       /* bytes of what comes before the stepper's part of what is marked */
    long *continues;       /* [width] in the history: `now` holds what the member's last successful step returned; */
    const long *continued; /* before: the last step began with that of the one before it */
    tvi_run_state now;     /* in the history */
    tvi_run_state start;   /* where the last step started, in what was before it */
    tvi_stop *stop;        /* the last one of one member */
    long parameter_sets;   /* how often the parameters were set */
    bool is_telling;       /* an observer is called: no step may be made now */
    bool has_dense;        /* the work holds the last step */
    double h, covered;     /* the size of the last step that was tried, and the time that it covers */
    tvi_increments by;     /* of the step that is made */
    tvi_status *status;    /* [width] a member with another one than TVI_OK is not stepped */
    bool *moves;           /* [width] the member is stepped now */
    double *tail;          /* [width] tvi_stats.tail of the member's last step */
    int *passes;           /* [width] of the member's last step */
    double *overflows;     /* [width] not 0: the new state is not finite */
    double *begun;         /* [2 n + 1][width] in the history: q, t and p where the runs began */
    tvi_kept_energy *kept; /* [width] in the history */
    double *change;        /* [width] the most that the stepper's step changes the energy by */
    bool *doubts;          /* [width] the energy is to be looked at */
    double *energy_before, *energy_after; /* [width] */
    tvi_run_state end;                    /* where the step ends, without low-order parts */
    tvi_run_state alone;                  /* of one member, without low-order parts */
    tvi_energy_work energy;               /* of one member; its block is NULL where no step asks for it */
    tvi_energy_work transformed;          /* of a rescaled system: K */
    tvi_energy_lanes energies;            /* of all members at once; its block is NULL where that cannot be */
    double *field;                        /* a block of the field's values at one point */
    tvi_tangent *tangent;                 /* NULL: never asked for; and what frees it */
    void (*free_tangent)(tvi_tangent *tangent);
};

/* Whether steps are made in another time than the user's. */
static inline bool tvi_is_rescaled(const tvi_integrator *integrator)
{
    return integrator->system->stepped != integrator->system;
}

/* The stepper's part of a batch; NULL where members are stepped one at a time. */
static inline const tvi_batch_stepper *tvi_batch_of(const tvi_integrator *integrator)
{
    return integrator->width > 1 ? integrator->stepper->batch : NULL;
}

/* ---- Members (member.c) ------------------------------------------------------------------------------------------ */

/* The user has component i of the state at q[i * stride] and p[i * stride]. */
typedef struct {
    const double *q, *p;
    size_t stride;
    double t;
} tvi_given_state;

/* Makes the state that of the member, as every step begins; nothing where it is what its last step returned. */
TVI_NODISCARD tvi_status tvi_member_begin(tvi_integrator *integrator, int member, const tvi_given_state *given);
/* Whether the member's state is bitwise this one, also after a step that failed. */
bool tvi_member_has(const tvi_integrator *integrator, int member, const tvi_given_state *given);
/* The member's state, as the user has it. */
void tvi_member_give(const tvi_integrator *integrator, int member, double *t, double q[], double p[], size_t stride);
/* All that the member's steps have left, to a member of another integrator for the same system and options, one of
 * them of width 1; what a batch keeps beyond that is forgotten. */
void tvi_member_copy(tvi_integrator *to, int member_to, const tvi_integrator *from, int member_from);
/* Makes the parameters of the member those of the blocks of one lane. */
void tvi_member_lend_parameters(tvi_integrator *integrator, int member);
/* Its energy at (q, p), rows as those of a tvi_run_state. */
TVI_NODISCARD tvi_status tvi_member_energy(tvi_integrator *integrator, int member, const double *q, const double *p,
                                           double *H);

/* The same of the one member of an integrator. */
TVI_NODISCARD static inline tvi_status tvi_integrator_begin(tvi_integrator *integrator, double t, const double q[],
                                                            const double p[])
{
    return tvi_member_begin(integrator, 0, &(tvi_given_state){q, p, 1, t});
}
static inline bool tvi_integrator_has(const tvi_integrator *integrator, double t, const double q[], const double p[])
{
    return tvi_member_has(integrator, 0, &(tvi_given_state){q, p, 1, t});
}
static inline void tvi_state_now(const tvi_integrator *integrator, double *t, double q[], double p[])
{
    tvi_member_give(integrator, 0, t, q, p, 1);
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

/* Call an observer, while the integrator refuses to be stepped, and return what it does; 0 where it is NULL. */
int tvi_tell_step(tvi_integrator *integrator, tvi_observer *observer, long step, double t, const double q[],
                  const double p[], void *ctx);
int tvi_tell_event(tvi_integrator *integrator, tvi_event_observer *observer, int which, double t, const double q[],
                   const double p[], void *ctx);

/* Another one of so many members for the same system and options, which has made no step. */
TVI_NODISCARD tvi_status tvi_integrator_twin(tvi_integrator **out, const tvi_integrator *integrator, int width);
/* So many members at once serve the system best; 1: one after the other. */
int tvi_integrator_width(const tvi_integrator *integrator);

/* Makes the values in `parameters` those that steps are made with. */
void tvi_integrator_apply_parameters(tvi_integrator *integrator);

/* The same with value[tvi_system_parameters][stride], of the first count members; the others have those of the first
 * one. A run goes on as if they had always been. */
void tvi_integrator_lend_parameters(tvi_integrator *integrator, const double value[], size_t stride, int count);

/* The tangent's memory, for so many columns (tangent.c). */
TVI_NODISCARD tvi_status tvi_integrator_provide_tangent(tvi_integrator *integrator, int columns);

/* Whether it says that the member itself has failed: others tell of the run, or of this call. */
static inline bool tvi_status_is_of_member(tvi_status status)
{
    return status == TVI_ENONFINITE || status == TVI_EDOMAIN || status == TVI_ENOCONV || status == TVI_ESINGULAR ||
           status == TVI_ETOOLARGE;
}

/* Where a run in the direction of h has no end. */
static inline double tvi_no_end(double h) { return copysign(INFINITY, h); }

/* tvi_step so often, or, after the first one, until the time is at t_end or behind it; t, q and p are written once,
 * after the last step or the one before the first that fails. */
TVI_NODISCARD tvi_status tvi_steps(tvi_integrator *integrator, long steps, double h, double t_end, double *t,
                                   double q[], double p[]);
/* So many steps of size h of the members that are TVI_OK, until none of them is. */
void tvi_members_step(tvi_integrator *integrator, long steps, double h);
/* tvi_step, with a tolerance > 0 of a size that serves it, of at most h (stepper.h); integrator->h is its size. */
TVI_NODISCARD tvi_status tvi_step_within(tvi_integrator *integrator, double tolerance, double h, double *t, double q[],
                                         double p[]);

/* What is left of the way to t_end, with the low-order part of the time. */
double tvi_time_left(const tvi_integrator *integrator, double t_end);
/* Where the time is t_end but for roundoff, that goes to its low-order part. */
void tvi_end_at(tvi_integrator *integrator, double t_end, double *t);

/* Undoes the last step, and gives the state that it started from. */
void tvi_integrator_take_back(tvi_integrator *integrator, double *t, double q[], double p[]);

/* tvi_dense, and the time there. */
TVI_NODISCARD tvi_status tvi_state_at(tvi_integrator *integrator, double theta, double *t, double q[], double p[]);

/* The states at the sample places of the last step (stepper.h), as a tape with a lane for each wants them: q, p and t
 * in x [2n + 1][TVI_SAMPLES], of[0] of q, of[1] of p, and t; what else is there may be overwritten. The one at the end
 * is that of the step. They may not be finite. */
void tvi_sample(tvi_integrator *integrator, const tvi_range of[2], double *x);

#endif
