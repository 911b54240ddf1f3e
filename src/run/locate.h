/* locate.h - Locates the events in each step of a run, and reports them to the observer. run.c calls it after each
 * step. */
#ifndef TVI_SRC_RUN_LOCATE_H
#define TVI_SRC_RUN_LOCATE_H

#include "integrator/integrator.h"

typedef struct tvi_locator tvi_locator;
typedef struct tvi_times_progress tvi_times_progress;
typedef struct tvi_single_run tvi_single_run;

/* Tells whether all events were made for systems with as many coordinates as the integrator's system. If the result is
 * false, the text of tvi_last_error names the first event that was not. */
bool tvi_events_match_dimension(const tvi_integrator *integrator, const tvi_event *const events[], int event_count);
/* Creates a locator for the events of the run's plan. The run begins at the time t with q = start_state[0] and p =
 * start_state[1]. On failure *out is NULL. */
TVI_NODISCARD tvi_status tvi_locator_open(tvi_locator **out, tvi_integrator *integrator, const tvi_single_run *run,
                                          double t, const double *const start_state[2]);
void tvi_locator_close(tvi_locator *locator); /* frees the locator, unless it is NULL */
/* Reports the events of the last step in the order of time. Before each event it reports the given times of the run
 * that come first; `times` is NULL if the run has none. If an event ends the run, it returns TVI_ESTOPPED, and t, q,
 * p and the tangent columns become those at the event. */
TVI_NODISCARD tvi_status tvi_locator_report_events(tvi_locator *locator, tvi_times_progress *times, double *t,
                                                   double q[], double p[]);

#endif
