/* run.h - Runs an integrator step by step: makes a step, reports the given times and the events in it, and then reports
 * the step itself. The plan of the run (tvi_run_plan) decides how large the steps are and where the run ends. */
#ifndef TVI_SRC_RUN_RUN_H
#define TVI_SRC_RUN_RUN_H

#include "events/events.h"
#include "integrator/tangent.h"
#include "run/parallel_for.h"

#include <pthread.h>

/* Refuses a plan whose fields contradict one another, and a plan that the integrator's method cannot carry out
 * (plan.c). */
TVI_NODISCARD tvi_status tvi_plan_check(const tvi_integrator *integrator, const tvi_run_plan *plan);

/* The functions that a run calls after each step, at each given time, and at each event. Each may be NULL. */
typedef struct {
    tvi_observer *at_step, *at_time;
    tvi_event_observer *on_event;
    void *ctx; /* the user's data, which every observer gets as its last argument */
} tvi_observers;

/* Calls an observer of steps or of given times. During the call the integrator refuses steps. Returns the observer's
 * value, or 0 if the observer is NULL. */
int tvi_call_observer(tvi_integrator *integrator, tvi_observer *observer, long step, double t, const double q[],
                      const double p[], void *ctx);

/* The arguments of a run of one integrator: its plan, the observers that are called, and its tangent vectors. */
typedef struct {
    /* The step size, the end of the run, the given times and the events, which tvi_plan_check has accepted. The
     * observers of the plan are not used here. */
    const tvi_run_plan *plan;
    tvi_observers observers; /* the observers that the run calls; those of the plan are called by wrappers (run.c) */
    /* The tangent vectors that the run's steps propagate; elements = NULL if there are none. */
    tvi_tangent_columns columns;
    long step_count_before_segment; /* the number of steps in earlier segments of an ensemble's run */
} tvi_single_run;

/* Checks the plan, and runs the integrator by it with these observers in the place of the plan's. */
TVI_NODISCARD tvi_status tvi_run_observed(tvi_integrator *integrator, const tvi_run_plan *plan, tvi_observers observers,
                                          double *t, double q[], double p[]);

/* A run of one member by a plan. A single integrator counts as an ensemble of one member. */
typedef struct {
    const tvi_run_plan *plan;
    int member_index, member_count;
    /* An ensemble may run a plan in several segments. step_count_before_segment is the number of steps in earlier
     * segments, and plan->steps the number of steps in the present segment. */
    long step_count_before_segment;
    /* The observer that is called after plan->at_step; NULL if the ensemble itself calls the observer of the plan. */
    tvi_ensemble_observer *ensemble_observer;
    /* The threads of the ensemble's run, of which one at a time calls an observer and holds the lock; NULL for a single
     * integrator. */
    tvi_parallel_team *team;
    pthread_mutex_t *observer_lock;
} tvi_member_run;
/* Runs the member whose state the integrator holds (tvi_worker_load_member). */
TVI_NODISCARD tvi_status tvi_run_member(tvi_integrator *integrator, const tvi_member_run *member_run, double *t,
                                        double q[], double p[]);

#endif
