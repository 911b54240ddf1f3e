/* integrator.h - what an integrator holds between steps. */
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
/* Whether bytes from elsewhere are such a stop. */
static inline bool tvi_stop_is_sound(const void *bytes)
{
    tvi_stop stop;
    memcpy(&stop, bytes, sizeof stop);
    return stop.count >= 0 && stop.count <= TVI_STOP_TOLD;
}

struct tvi_integrator {
    const tvi_system *system;  /* the user's, of dimension n, */
    const tvi_system *stepped; /* and the one that steps are made of, with generated code where there is any */
    double *parameters;        /* [tvi_system_parameters] their values, in */
    const tvi_block *blocks;   /* all blocks of tapes */
    tvi_options options;       /* as resolved */
    tvi_stats stats;
    const tvi_stepper *stepper;
    void *work;
    char *history;                       /* [remembered] all that one step leaves to the next, */
    char *before;                        /* [marked] and its first part before the last one was tried */
    size_t remembered, marked, of_state; /* of_state: what comes before the stepper's part of what is marked */
    long *continues;                     /* in the history: `now` holds what the last successful step returned; */
    const long *continued;               /* before: the last step began with that of the one before it */
    tvi_run_state now, start;            /* in the history; where the last step started, in what was before it */
    tvi_stop *stop;                      /* the last one */
    long parameter_sets;                 /* how often the parameters were set */
    bool is_telling;                     /* an observer is called: no step may be made now */
    bool has_dense;                      /* the work holds the last step */
    double h, covered;                   /* its size, and the time that it covers */
    tvi_increments by;                   /* of the step that is made */
    tvi_energy_work energy;              /* its block is NULL where no step asks for it */
    tvi_energy_work transformed;         /* of a rescaled system: K */
    double *field;                       /* a block of the field's values at one point */
    double *end;                         /* [2 N + 1] q and p at the end of a step (guard.c) */
    double *begun;                       /* [2 n + 1] in the history: q, t and p where the run began */
    tvi_kept_energy *kept;               /* in the history */
    tvi_tangent *tangent;                /* NULL: never asked for; and what frees it */
    void (*free_tangent)(tvi_tangent *tangent);
};

/* Whether steps are made in another time than the user's. */
static inline bool tvi_is_rescaled(const tvi_integrator *integrator)
{
    return integrator->system->stepped != integrator->system;
}

/* Makes the state the integrator's own, as every step begins; nothing where it is what the last one returned. */
TVI_NODISCARD tvi_status tvi_integrator_begin(tvi_integrator *integrator, double t, const double q[], const double p[]);

/* Whether its own state is bitwise this one, also after a step that failed. */
bool tvi_integrator_has(const tvi_integrator *integrator, double t, const double q[], const double p[]);

/* Call an observer, while the integrator refuses to be stepped, and return what it does; 0 where it is NULL. */
int tvi_tell_step(tvi_integrator *integrator, tvi_observer *observer, long step, double t, const double q[],
                  const double p[], void *ctx);
int tvi_tell_event(tvi_integrator *integrator, tvi_event_observer *observer, int which, double t, const double q[],
                   const double p[], void *ctx);

/* Another one for the same system and options, which has made no step. */
TVI_NODISCARD tvi_status tvi_integrator_twin(tvi_integrator **out, const tvi_integrator *integrator);

/* Makes the values in `parameters` those that steps are made with. */
void tvi_integrator_apply_parameters(tvi_integrator *integrator);

/* The same with these values, the next one `stride` further on; a run goes on as if they had always been. */
void tvi_integrator_lend_parameters(tvi_integrator *integrator, const double value[], int stride);

/* The tangent's memory, for so many columns (tangent.c). */
TVI_NODISCARD tvi_status tvi_integrator_provide_tangent(tvi_integrator *integrator, int columns);

/* Where a run in the direction of h has no end. */
static inline double tvi_no_end(double h) { return copysign(INFINITY, h); }

/* tvi_step so often, or, after the first one, until the time is at t_end or behind it; t, q and p are written once,
 * after the last step or the one before the first that fails. */
TVI_NODISCARD tvi_status tvi_steps(tvi_integrator *integrator, long steps, double h, double t_end, double *t,
                                   double q[], double p[]);
/* tvi_step, with a tolerance > 0 of a size that serves it, of at most h (stepper.h); integrator->h is its size. */
TVI_NODISCARD tvi_status tvi_step_within(tvi_integrator *integrator, double tolerance, double h, double *t, double q[],
                                         double p[]);

/* The status of a step that has overflowed, from what was before it: it is too large, or what the user computes is not
 * finite where it starts. */
tvi_status tvi_step_overflow(const tvi_integrator *integrator);

/* What is left of the way to t_end, with the low-order part of the time. */
double tvi_time_left(const tvi_integrator *integrator, double t_end);
/* Where the time is t_end but for roundoff, that goes to its low-order part. */
void tvi_end_at(tvi_integrator *integrator, double t_end, double *t);

/* Undoes the last step, and gives the state that it started from. */
void tvi_integrator_take_back(tvi_integrator *integrator, double *t, double q[], double p[]);

/* Its own state, as the user has it. */
void tvi_state_now(const tvi_integrator *integrator, double *t, double q[], double p[]);

/* tvi_dense, and the time there. */
TVI_NODISCARD tvi_status tvi_state_at(tvi_integrator *integrator, double theta, double *t, double q[], double p[]);

/* The states at the sample places of the last step (stepper.h), as a tape with a lane for each wants them: q, p and t
 * in x [2n + 1][TVI_SAMPLES], of[0] of q, of[1] of p, and t; what else is there may be overwritten. The one at the end
 * is that of the step. They may not be finite. */
void tvi_sample(tvi_integrator *integrator, const tvi_range of[2], double *x);

#endif
