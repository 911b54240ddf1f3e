/* run.h - runs an integrator: one step after another, and after each of them the times and the events in it are told,
 * then the step. What makes the next step, and chooses its size, depends on the way that the run goes. */
#ifndef TVI_SRC_RUN_RUN_H
#define TVI_SRC_RUN_RUN_H

#include "run/columns.h"
#include "run/locate.h"

/* Whom a run tells of its steps, times and events; each may be NULL. */
typedef struct {
    tvi_observer *at_step, *at_time;
    tvi_event_observer *on_event;
    void *ctx;
} tvi_audience;

/* How far a run goes. */
typedef enum { TVI_SO_MANY_STEPS, TVI_TO_A_TIME, TVI_THROUGH_TIMES, TVI_BY_TOLERANCE } tvi_run_way;

/* A run of one integrator. Of the plan's observers none is called but those of the audience. */
struct tvi_run_of_one {
    tvi_run_way way;
    const tvi_run_plan *plan; /* steps, sizes, ends, times, events */
    tvi_audience audience;
    tvi_columns columns;
    long steps_told; /* that a run in pieces has made before */
};

/* Its steps, as the way has them. */
typedef struct tvi_course tvi_course;
struct tvi_course {
    /* The next step; *is_last: the run ends with it. */
    tvi_status (*step)(tvi_integrator *it, const tvi_course *course, double *t, double q[], double p[], bool *is_last);
    const tvi_run_plan *plan;
    long steps, at_once; /* at most; how many are made as one of them */
    bool begins;         /* the integrator has to have the state before the first step */
    bool has_step;       /* the first times are in the step before the run */
    bool is_to_time;     /* the run ends at t_end, */
    double t_end;
};

/* TVI_ESTOPPED where an observer or an event ends the run, else the status of what failed, or of an argument that is
 * refused. */
TVI_NODISCARD tvi_status tvi_run_one(tvi_integrator *integrator, const tvi_run_of_one *run, double *t, double q[],
                                     double p[]);

/* Check the arguments of their ways, and set the course. Steps of size h that nobody is told of are made at once. */
TVI_NODISCARD tvi_status tvi_set_course_to_time(const tvi_integrator *integrator, const tvi_run_plan *plan, double t,
                                                bool is_told, tvi_course *course);
TVI_NODISCARD tvi_status tvi_set_course_by_tolerance(const tvi_integrator *integrator, const tvi_run_plan *plan,
                                                     double t, tvi_course *course);

/* Whether a run to a time goes on after its last step. TVI_ENOCONV where 2^16 steps in a row, which *slow counts, each
 * covered less than a 2^53rd of what was left: it would never end. */
TVI_NODISCARD tvi_status tvi_goes_on(const tvi_integrator *integrator, double t_end, int *slow);
/* A tolerance that double precision can serve, and an integrator that has steps by one; else TVI_EINVAL or
 * TVI_EUNSUPPORTED. */
TVI_NODISCARD tvi_status tvi_serves_tolerance(const tvi_integrator *integrator, double tolerance);

#endif
