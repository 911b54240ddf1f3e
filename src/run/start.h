/* start.h - the sign that g has where a step begins. */
#ifndef TVI_SRC_RUN_START_H
#define TVI_SRC_RUN_START_H

#include "run/search.h"

/* Which state the run begins with, before its first step changes the integrator's. */
tvi_search_from tvi_start_of(const tvi_integrator *integrator, double t, const double q[], const double p[]);

/* Whether the event was told at the stop. */
bool tvi_start_is_among(const tvi_stop *stop, const tvi_event *event);

/* g[0] of all events at the start of the last step, which no step before it has told: 0 where it is on the event. */
TVI_NODISCARD tvi_status tvi_start_search(tvi_search *search);

/* g[0] is 0: the step leaves the event, and g[0] becomes a number of the sign that g has then (tvi_watch). */
TVI_NODISCARD tvi_status tvi_start_leave(tvi_search *search, int which);

/* How far g has come from 0 at theta, on the method's own solution, after a start on the event: the state is that of
 * search->between. *known: the sign is sure. */
TVI_NODISCARD tvi_status tvi_start_rise(tvi_search *search, int which, double theta, double *rise, bool *known);

/* Whether g stays within its roundoff over the whole step. */
TVI_NODISCARD tvi_status tvi_start_is_noise(tvi_search *search, int which, bool *is_noise);

#endif
