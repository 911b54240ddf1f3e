/* start.h - Determines the sign of each event function at the start of a step. search.c calls it. */
#ifndef TVI_SRC_RUN_START_H
#define TVI_SRC_RUN_START_H

#include "run/search.h"

/* The kind of state that the run begins with. It is asked before the first step changes the integrator's state. */
tvi_search_from tvi_start_of(const tvi_integrator *integrator, double t, const double q[], const double p[]);

/* Tells whether the event was reported at the stop. */
bool tvi_start_is_among(const tvi_stop *stop, const tvi_event *event);

/* Sets g[0] of all events at the start of the last step, if no step before it has sampled them. g[0] = 0 means that the
 * state is on the event. */
TVI_NODISCARD tvi_status tvi_start_search(tvi_search *search);

/* Sets g[0] of an event on which the step begins to a number with the sign that g has when it leaves 0 (tvi_watch). */
TVI_NODISCARD tvi_status tvi_start_leave(tvi_search *search, int which);

/* Sets *rise to the change of g from the start of the step, on an event, to theta on the method's own solution. The
 * state there is that of search->between. *known: the sign is certain. */
TVI_NODISCARD tvi_status tvi_start_rise(tvi_search *search, int which, double theta, double *rise, bool *known);

/* Tells whether g stays within its roundoff over the whole step. */
TVI_NODISCARD tvi_status tvi_start_is_noise(tvi_search *search, int which, bool *is_noise);

#endif
