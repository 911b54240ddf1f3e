/* plan.h - Checks a plan of a run (tvi_run_plan), and runs one integrator by it. tvi_run and the members of an ensemble
 * (ensemble_run.c) call it. */
#ifndef TVI_SRC_RUN_PLAN_H
#define TVI_SRC_RUN_PLAN_H

#include "run/parallel_for.h"
#include "run/run.h"

#include <pthread.h>

/* Refuses a plan whose fields contradict one another, and a plan that the integrator's method cannot carry out. */
TVI_NODISCARD tvi_status tvi_plan_check(const tvi_integrator *integrator, const tvi_run_plan *plan);

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
