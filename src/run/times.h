/* times.h - tells the results at given times of a run. */
#ifndef TVI_SRC_RUN_TIMES_H
#define TVI_SRC_RUN_TIMES_H

#include "run/between.h"
#include "run/run.h"

typedef struct tvi_times {
    tvi_integrator *it;
    const tvi_run_of_one *run; /* the times are those of its plan */
    int next;                  /* the first time that was not told */
    tvi_between between;
    bool is_stopped; /* by the observer */
} tvi_times;

/* Refuses times that are not finite, or not in the order of h from the state on; *has_step: this state is the end of
 * the integrator's last step, in which times may be, too. */
TVI_NODISCARD tvi_status tvi_times_check(const tvi_integrator *integrator, const tvi_run_of_one *run, double t,
                                         const double q[], const double p[], bool *has_step);
/* Tells the times at the start of the run or in the step that ended there, and prepares the steps. */
TVI_NODISCARD tvi_status tvi_times_open(tvi_times *times, tvi_integrator *integrator, const tvi_run_of_one *run,
                                        bool has_step, double t, const double q[], const double p[]);
void tvi_times_close(tvi_times *times);
/* Takes the parameters of the step that was just made. */
TVI_NODISCARD tvi_status tvi_times_set_parameters(tvi_times *times);
/* Tells the times of the last step that are not after this one. An observer that stops the run is told no other of
 * them, but where the run has events, whose states may follow. */
TVI_NODISCARD tvi_status tvi_times_tell(tvi_times *times, double until);
/* Whether all are told. */
bool tvi_times_are_told(const tvi_times *times);

#endif
