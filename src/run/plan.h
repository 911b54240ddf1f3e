/* plan.h - Runs one member by a plan. tvi_run and the members of an ensemble call it. */
#ifndef TVI_SRC_RUN_PLAN_H
#define TVI_SRC_RUN_PLAN_H

#include "run/run.h"

#include <pthread.h>

/* Refuses a plan that contradicts itself, or that the integrator cannot serve. */
TVI_NODISCARD tvi_status tvi_plan_check(const tvi_integrator *integrator, const tvi_run_plan *plan);
/* The mode of a plan that was checked. */
tvi_run_mode tvi_plan_mode(const tvi_run_plan *plan);

/* A member that runs by a plan. */
typedef struct {
    const tvi_run_plan *plan;
    tvi_run_mode mode;
    int member, members;
    /* Steps before this piece of the run; plan->steps are those of the piece. */
    long steps_reported;
    /* The observer that is called after at_step; NULL if the ensemble itself calls the plan's. */
    tvi_ensemble_observer *observer;
    pthread_mutex_t *lock; /* held while an observer is called; NULL if there is one thread */
} tvi_member_run;
/* Runs a member whose state the integrator holds (tvi_worker_load_member). */
TVI_NODISCARD tvi_status tvi_run_member(tvi_integrator *integrator, const tvi_member_run *member, double *t, double q[],
                                        double p[]);

#endif
