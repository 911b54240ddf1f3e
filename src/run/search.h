/* search.h - the roots of events along the curve of the last step (tvi_dense), which tells their places to its
 * accuracy. */
#ifndef TVI_SRC_RUN_SEARCH_H
#define TVI_SRC_RUN_SEARCH_H

#include "system/event.h"
#include "run/integrator.h"

typedef struct {
    int which;           /* of the events */
    int number;          /* in the order in which they were found, from 0 */
    double a, ga, b, gb; /* g has different signs there, */
    double guess;        /* and perhaps a zero here; or a NAN */
    double theta;        /* of the caller */
} tvi_root;

typedef struct {
    const tvi_event *event;
    double *block;             /* of its tape */
    double g[1 + TVI_SAMPLES]; /* at the start of the step, and the samples */
} tvi_watch;

typedef struct {
    tvi_integrator *it;
    int count;
    tvi_watch *of;         /* [count] */
    long step;             /* of the integrator, the last one searched; 0: none */
    jet_tape *tape;        /* of all events, */
    double *samples;       /* and its block: it begins with the inputs [2n + 1][TVI_SAMPLES], */
    tvi_range of_state[2]; /* of which those of q and of p are used */
    double *state;         /* [2n + 1] */
    tvi_root *roots;       /* of the step at hand */
    int found;
} tvi_search;

TVI_NODISCARD tvi_status tvi_search_open(tvi_search *search, tvi_integrator *it, const tvi_event *const events[],
                                         int count);
void tvi_search_close(tvi_search *search); /* also where it was not opened with success */

/* The roots of all events in the last step, by event. */
TVI_NODISCARD tvi_status tvi_search_step(tvi_search *search);
/* The state x [2n + 1] of q, p and t on the curve, and g of an event at such a state. */
TVI_NODISCARD tvi_status tvi_search_state(tvi_search *search, double theta, double x[]);
TVI_NODISCARD tvi_status tvi_search_value(tvi_search *search, int which, const double x[], double *g);
/* The root on the curve, to roundoff. */
TVI_NODISCARD tvi_status tvi_search_zero(tvi_search *search, const tvi_root *root, double *theta);

#endif
