/* locate.h - Finds the events in each step of a run, and reports them. run.c calls it after each step. */
#ifndef TVI_SRC_RUN_LOCATE_H
#define TVI_SRC_RUN_LOCATE_H

#include "run/integrator.h"

typedef struct tvi_locator tvi_locator;
typedef struct tvi_times tvi_times;
typedef struct tvi_run_of_one tvi_run_of_one;

/* Tells whether these are events of the integrator's system. If not, it sets the error text. */
bool tvi_events_fit(const tvi_integrator *integrator, const tvi_event *const events[], int count);
/* Opens a locator for a run that begins at time t with state[2], q and p, and has the events of its plan. *out is NULL
 * on failure. */
TVI_NODISCARD tvi_status tvi_locator_open(tvi_locator **out, tvi_integrator *integrator, const tvi_run_of_one *run,
                                          double t, const double *const state[2]);
void tvi_locator_close(tvi_locator *locator); /* NULL is allowed */
/* Reports the events of the last step, and before each of them the times that come first; times may be NULL. If an
 * event ends the run (TVI_ESTOPPED), t, q, p and the columns become those at the event. */
TVI_NODISCARD tvi_status tvi_locator_report(tvi_locator *locator, tvi_times *times, double *t, double q[], double p[]);

#endif
