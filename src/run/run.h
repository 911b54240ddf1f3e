/* run.h - Runs an integrator step by step: makes a step, reports the given times and the events in it, and then reports
 * the step itself. The plan of the run decides how large the steps are and where the run ends. */
#ifndef TVI_SRC_RUN_RUN_H
#define TVI_SRC_RUN_RUN_H

#include "events/events.h"
#include "integrator/tangent.h"

/* The functions that a run calls after each step, at each given time, and at each event. Each may be NULL. */
typedef struct {
    tvi_observer *at_step, *at_time;
    tvi_event_observer *on_event;
    void *ctx; /* the user's data, which every observer gets as its last argument */
} tvi_observers;

/* The arguments of a run of one integrator: its plan, the observers that are called, and its tangent vectors. */
typedef struct {
    /* The step size, the end of the run, the given times and the events, which tvi_plan_check has accepted. The
     * observers of the plan are not used here. */
    const tvi_run_plan *plan;
    tvi_observers observers; /* the observers that the run calls instead of those of the plan */
    /* The tangent vectors that the run's steps propagate; elements = NULL if there are none. */
    tvi_tangent_columns columns;
    long step_count_before_segment; /* the number of steps in earlier segments of an ensemble's run */
} tvi_single_run;

/* Runs the integrator. It returns TVI_ESTOPPED if an observer or an event ends the run, and otherwise the status of the
 * step that fails or of the argument that is refused. */
TVI_NODISCARD tvi_status tvi_run_integrator(tvi_integrator *integrator, const tvi_single_run *run, double *t,
                                            double q[], double p[]);

/* Checks the plan, and runs the integrator by it with these observers in the place of the plan's. */
TVI_NODISCARD tvi_status tvi_run_observed(tvi_integrator *integrator, const tvi_run_plan *plan, tvi_observers observers,
                                          double *t, double q[], double p[]);

#endif
