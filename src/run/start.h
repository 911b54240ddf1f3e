/* start.h - Determines the sign of each event function at the start of a step, also where the step begins exactly on
 * the event. search.c calls it. */
#ifndef TVI_SRC_RUN_START_H
#define TVI_SRC_RUN_START_H

#include "run/search.h"

/* Tells which kind of state the run begins with. It must be called before the first step changes the integrator. */
tvi_run_start_kind tvi_classify_run_start(const tvi_integrator *integrator, double t, const double q[],
                                          const double p[]);

/* Tells whether the event was reported at the given stop of a run. */
bool tvi_stop_has_event(const tvi_event_stop *stop, const tvi_event *event);

/* Evaluates all events at the start of the last step, unless the search of the step before has done so. Sets
 * g_samples[0] of each event; it is set to 0 if the state lies on the event up to roundoff. */
TVI_NODISCARD tvi_status tvi_start_evaluate_events(tvi_event_search *search);

/* Sets g_samples[0] of an event on which the step begins to a tiny number with the sign that g has when it leaves 0
 * (see tvi_watched_event). */
TVI_NODISCARD tvi_status tvi_start_find_leaving_sign(tvi_event_search *search, int event_index);

/* Sets *rise to g(x(theta)) - g(x(0)) for a step that begins on the event. x(theta) is the state after a partial
 * step of the method, which search->partial_step then holds. *is_sign_certain tells whether *rise is larger than its
 * roundoff. */
TVI_NODISCARD tvi_status tvi_start_compute_rise(tvi_event_search *search, int event_index, double theta, double *rise,
                                                bool *is_sign_certain);

/* Tells whether |g| stays below the roundoff of g over the whole step. */
TVI_NODISCARD tvi_status tvi_start_is_g_roundoff(tvi_event_search *search, int event_index, bool *is_roundoff);

#endif
