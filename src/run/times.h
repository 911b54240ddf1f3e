/* times.h - Reports the results at given times of a run. run.c calls it after each step. */
#ifndef TVI_SRC_RUN_TIMES_H
#define TVI_SRC_RUN_TIMES_H

#include "run/between.h"
#include "run/run.h"

typedef struct tvi_times {
    tvi_integrator *it;
    const tvi_run_of_one *run; /* its plan has the times */
    int next;                  /* the first time that is not reported */
    tvi_between between;
    bool is_stopped; /* by the observer */
} tvi_times;

/* Refuses times that are not finite, or not in the order of h from the state on. *has_step: the state is the end of the
 * integrator's last step, in which times may lie, too. */
TVI_NODISCARD tvi_status tvi_times_check(const tvi_integrator *integrator, const tvi_run_of_one *run, double t,
                                         const double q[], const double p[], bool *has_step);
/* Reports the times at the start of the run or in the step that ended there, and prepares for the steps. */
TVI_NODISCARD tvi_status tvi_times_open(tvi_times *times, tvi_integrator *integrator, const tvi_run_of_one *run,
                                        bool has_step, double t, const double q[], const double p[]);
void tvi_times_close(tvi_times *times);
/* Copies the parameters of the step that was just made. */
TVI_NODISCARD tvi_status tvi_times_set_parameters(tvi_times *times);
/* Reports the times of the last step up to `until`. After an observer has stopped the run, no other time is reported,
 * unless the run has events, whose states may follow. */
TVI_NODISCARD tvi_status tvi_times_report(tvi_times *times, double until);
/* Tells whether all times are reported. */
bool tvi_times_are_reported(const tvi_times *times);

#endif
