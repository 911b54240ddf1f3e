/* times.h - Reports the states at the times that the user has given for a run. run.c calls it after each step. */
#ifndef TVI_SRC_RUN_TIMES_H
#define TVI_SRC_RUN_TIMES_H

#include "integrator/inside_step.h"
#include "run/run.h"

/* The progress of a run along the times that the user has given: which of them have been reported. */
typedef struct tvi_times_progress {
    tvi_integrator *integrator;
    const tvi_single_run *run;     /* the run, whose plan (run->plan->times) lists the given times */
    int next_time_index;           /* index of the first time that has not been reported */
    tvi_partial_step partial_step; /* computes the states at times inside the last step */
    bool is_stopped_by_observer;
} tvi_times_progress;

/* Refuses times that are not finite, or that do not follow the state and one another in the direction of h. Sets
 * *continues_last_step if the state is the end of the integrator's last step; then times may also lie in that step. */
TVI_NODISCARD tvi_status tvi_times_check(const tvi_integrator *integrator, const tvi_single_run *run, double t,
                                         const double q[], const double p[], bool *continues_last_step);
/* Prepares `times_progress` for the steps of a run. It reports the times that equal the start of the run, or with
 * continues_last_step the times in the step that ended there. The caller closes times_progress->partial_step. */
TVI_NODISCARD tvi_status tvi_times_open(tvi_times_progress *times_progress, tvi_integrator *integrator,
                                        const tvi_single_run *run, bool continues_last_step, double t, const double q[],
                                        const double p[]);
/* Reports the times of the last step up to `last_time`. After an observer has stopped the run, it reports no further
 * time, except in a run with events, where an event may come later in the same step. */
TVI_NODISCARD tvi_status tvi_times_report_until(tvi_times_progress *times_progress, double last_time);
/* Tells whether all given times have been reported. */
bool tvi_times_are_all_reported(const tvi_times_progress *times_progress);

#endif
