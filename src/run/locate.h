/* locate.h - the events of each step of a run. */
#ifndef TVI_SRC_RUN_LOCATE_H
#define TVI_SRC_RUN_LOCATE_H

#include "run/integrator.h"

typedef struct tvi_locator tvi_locator;

/* Whether they are events of the integrator's system. */
bool tvi_events_fit(const tvi_integrator *integrator, const tvi_event *const events[], int count);
/* For a run that begins at the time and state[2], q and p. *out is NULL on failure. */
TVI_NODISCARD tvi_status tvi_locator_open(tvi_locator **out, tvi_integrator *integrator,
                                          const tvi_event *const events[], int count, double t,
                                          const double *const state[2]);
void tvi_locator_close(tvi_locator *locator); /* NULL is allowed */
/* Tells the events of the last step; where one ends the run (TVI_ESTOPPED), t, q, p are its state. */
TVI_NODISCARD tvi_status tvi_locator_tell(tvi_locator *locator, double *t, double q[], double p[],
                                          tvi_event_observer *on_event, void *ctx);

#endif
