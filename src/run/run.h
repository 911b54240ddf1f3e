/* run.h - Runs an integrator step by step. After each step it reports the times and the events in it, and then the
 * step. The mode of the run decides how the next step is made, and how large it is. */
#ifndef TVI_SRC_RUN_RUN_H
#define TVI_SRC_RUN_RUN_H

#include "run/columns.h"
#include "run/locate.h"

/* The observers of a run's steps, times and events. Each may be NULL. */
typedef struct {
    tvi_observer *at_step, *at_time;
    tvi_event_observer *on_event;
    void *ctx;
} tvi_observers;

/* The modes of a run: a number of steps, to a time, at given times, or by a tolerance. */
typedef enum { TVI_RUN_STEPS, TVI_RUN_TO_TIME, TVI_RUN_AT_TIMES, TVI_RUN_TO_TOLERANCE } tvi_run_mode;

/* A run of one integrator. Only these observers are called, not those of the plan. */
struct tvi_single_run {
    tvi_run_mode mode;
    const tvi_run_plan *plan; /* steps, sizes, ends, times, events */
    tvi_observers observers;
    tvi_tangent_columns columns;
    long steps_reported; /* in earlier pieces of the run */
};

/* The steps of a run, as its mode schedules them. */
typedef struct tvi_schedule tvi_schedule;
struct tvi_schedule {
    /* Makes the next step. *is_last: the run ends with it. */
    tvi_status (*step)(tvi_integrator *it, const tvi_schedule *schedule, double *t, double q[], double p[],
                       bool *is_last);
    const tvi_run_plan *plan;
    /* The number of calls of `step` at most, and how many steps each call makes. */
    long steps, at_once;
    bool begins;     /* the state is loaded before the first step */
    bool has_step;   /* the first times are in the step before the run */
    bool is_to_time; /* the run ends at t_end */
    double t_end;
};

/* Runs the integrator. Returns TVI_ESTOPPED if an observer or an event ends the run, otherwise the status of the
 * failure or of the argument that is refused. */
TVI_NODISCARD tvi_status tvi_run_one(tvi_integrator *integrator, const tvi_single_run *run, double *t, double q[],
                                     double p[]);

/* Check the arguments of their modes, and set the schedule. Steps of size h that no observer sees are made at once. */
TVI_NODISCARD tvi_status tvi_schedule_to_time(const tvi_integrator *integrator, const tvi_run_plan *plan, double t,
                                              bool is_observed, tvi_schedule *schedule);
TVI_NODISCARD tvi_status tvi_schedule_to_tolerance(const tvi_integrator *integrator, const tvi_run_plan *plan, double t,
                                                   tvi_schedule *schedule);

/* Tells whether a run to a time goes on after the last step. Returns TVI_ENOCONV after 2^16 steps in a row, which *slow
 * counts, that each covered less than a 2^53rd of what was left. */
TVI_NODISCARD tvi_status tvi_run_goes_on(const tvi_integrator *integrator, double t_end, int *slow);
/* Checks that the tolerance is one for double precision, and that the integrator's method chooses steps by a tolerance.
 * Otherwise TVI_EINVAL or TVI_EUNSUPPORTED. */
TVI_NODISCARD tvi_status tvi_check_tolerance(const tvi_integrator *integrator, double tolerance);

#endif
