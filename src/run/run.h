/* run.h - a run: one step after another, of which the events and then the observer are told. What makes the next step,
 * and chooses its size, is the plan's. */
#ifndef TVI_SRC_RUN_RUN_H
#define TVI_SRC_RUN_RUN_H

#include "run/locate.h"

typedef struct tvi_plan tvi_plan;
struct tvi_plan {
    /* The next step; *is_last: the run ends with it. */
    tvi_status (*step)(tvi_integrator *it, const tvi_plan *plan, double *t, double q[], double p[], bool *is_last);
    long steps, at_once;        /* at most; how many are made as one of them */
    double h, tolerance, t_end; /* as the plan's step reads them */
    bool to_time;               /* the run ends at t_end */
};

/* Who is told of a step. */
typedef struct {
    const tvi_event *const *events; /* [count], which fit */
    int count;
    tvi_event_observer *on_event;
    tvi_observer *observer; /* each may be NULL */
    void *ctx;
} tvi_audience;

/* Whether a run to a time goes on after its last step. TVI_ENOCONV where 2^16 steps in a row, which *slow counts, each
 * covered less than a 2^53rd of what was left: it would never end. */
TVI_NODISCARD tvi_status tvi_goes_on(const tvi_integrator *integrator, double t_end, int *slow);
/* TVI_ESTOPPED where the observer or an event ends the run, else the status of the step that failed. */
TVI_NODISCARD tvi_status tvi_run(tvi_integrator *integrator, const tvi_plan *plan, const tvi_audience *audience,
                                 double *t, double q[], double p[]);
/* A tolerance that double precision can serve, and an integrator that has steps by one; else TVI_EINVAL or
 * TVI_EUNSUPPORTED. */
TVI_NODISCARD tvi_status tvi_serves_tolerance(const tvi_integrator *integrator, double tolerance);
/* tvi_integrate_to, with events. */
TVI_NODISCARD tvi_status tvi_run_to(tvi_integrator *integrator, double h, double t_end, const tvi_audience *audience,
                                    double *t, double q[], double p[]);

#endif
