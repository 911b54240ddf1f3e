/* plan.h - runs one member by a plan, which an integrator and the members of an ensemble share. */
#ifndef TVI_SRC_RUN_PLAN_H
#define TVI_SRC_RUN_PLAN_H

#include "run/run.h"

#include <pthread.h>

/* Refuses a plan that contradicts itself, and one that does not serve the integrator. */
TVI_NODISCARD tvi_status tvi_plan_check(const tvi_integrator *integrator, const tvi_run_plan *plan);
/* The way that a plan goes that was checked. */
tvi_run_way tvi_plan_way(const tvi_run_plan *plan);

/* A member that runs by a plan. */
typedef struct {
    const tvi_run_plan *plan;
    tvi_run_way way;
    int member, members;
    long steps_told; /* before this piece of a run in steps; `steps` of the plan are those of the piece */
    tvi_ensemble_observer *observer; /* called after at_step; NULL where the ensemble itself calls that of the plan */
    pthread_mutex_t *lock;           /* held while an observer is called; NULL: there is one thread */
} tvi_member_run;
/* The integrator has what the member has (tvi_worker_enter). */
TVI_NODISCARD tvi_status tvi_run_member(tvi_integrator *integrator, const tvi_member_run *member, double *t, double q[],
                                        double p[]);

#endif
