/* search.h - the roots of events along the curve of the last step (tvi_dense), which tells their places to its
 * accuracy. */
#ifndef TVI_SRC_RUN_SEARCH_H
#define TVI_SRC_RUN_SEARCH_H

#include "system/event.h"
#include "run/between.h"
#include "run/narrow.h"

typedef struct {
    int which;           /* of the events */
    int number;          /* in the order in which they were found, from 0 */
    int after;           /* the sign that g has behind it, */
    double a, ga, b, gb; /* and at b, or 0; another one at a */
    double guess;        /* and perhaps a zero here; or a NAN */
    bool is_return;      /* a is where g has left 0 in the direction that ga has (start.h) */
    bool is_none;        /* the method's own solution does not have it (finder.h) */
    double theta;        /* of the caller */
} tvi_root;

typedef struct {
    const tvi_event *event;
    double *block; /* of its tape */
    tvi_event_near near;
    double g[1 + TVI_SAMPLES]; /* at the start of the step, and the samples */
    bool was_told;             /* at the stop that the run goes on from */
    bool leaves;               /* the step begins on the event; g[0] has the sign that g has then, and no size */
    double left_at;            /* theta, from which on it has that sign */
} tvi_watch;

/* The state that a search begins with. */
typedef enum { TVI_FROM_OWN, TVI_FROM_STOP, TVI_FROM_ANY } tvi_search_from;

typedef struct {
    tvi_integrator *it;
    tvi_between *between;
    int count;
    tvi_watch *of;         /* [count] */
    tvi_search_from from;  /* the integrator's own, that of its last stop but for p, or another one */
    bool has_turned;       /* from a stop, with another p */
    bool rests;            /* g comes back before the time moves */
    long step;             /* of the integrator, the last one searched; 0: none */
    jet_tape *tape;        /* of all events, */
    double *samples;       /* and its block: it begins with the inputs [2n + 1][TVI_SAMPLES], */
    tvi_range of_state[2]; /* of which those of q and of p are used */
    double *state, *move;  /* [2n + 1] each */
    tvi_root *roots;       /* of the step at hand */
    int found;
} tvi_search;

/* The run begins at the time and state[2], q and p. */
TVI_NODISCARD tvi_status tvi_search_open(tvi_search *search, tvi_between *between, const tvi_event *const events[],
                                         int count, double t, const double *const state[2]);
void tvi_search_close(tvi_search *search); /* also where it was not opened with success */
/* The events' parameters become those that the integrator has. */
void tvi_search_set_parameters(tvi_search *search);

/* The roots of all events in the last step, by event. TVI_ENOCONV where one is a return before the time moves. */
TVI_NODISCARD tvi_status tvi_search_step(tvi_search *search);
/* The state x [2n + 1] of q, p and t on the curve, and g of an event at such a state. */
TVI_NODISCARD tvi_status tvi_search_state(tvi_search *search, double theta, double x[]);
TVI_NODISCARD tvi_status tvi_search_value(tvi_search *search, int which, const double x[], double *g);

/* The root on the curve, to roundoff. */
TVI_NODISCARD tvi_status tvi_search_zero(tvi_search *search, const tvi_root *root, double *theta);

#endif
