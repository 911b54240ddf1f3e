/* search.h - Finds roots of events along the curve of the last step (tvi_dense), to the accuracy of that curve.
 * locate.c calls it after each step. */
#ifndef TVI_SRC_RUN_SEARCH_H
#define TVI_SRC_RUN_SEARCH_H

#include "system/event.h"
#include "run/between.h"
#include "run/narrow.h"

/* A sign change of an event. */
typedef struct {
    int which;           /* index of the event */
    int number;          /* in the order in which roots were found, from 0 */
    int sign_after;      /* the sign of g after the root */
    double a, ga, b, gb; /* the bracket; g has the sign `sign_after`, or 0, at b */
    double guess;        /* an estimate of the root, or NAN */
    /* The step begins on the event, and g has left 0 at a with the sign of ga (start.h). */
    bool is_return;
    bool is_none; /* the method's own solution does not have it (finder.h) */
    double theta; /* the abscissa that the finder sets */
} tvi_root;

/* An event, and its samples in the step. */
typedef struct {
    const tvi_event *event;
    double *block; /* of the event's tape */
    tvi_event_near near;
    double g[1 + TVI_SAMPLES]; /* at the start of the step, and at the samples */
    /* The event was reported at the stop that the run goes on from. */
    bool was_reported;
    /* The step begins on the event. g[0] then has the sign with which g leaves 0, and no meaningful size. */
    bool leaves;
    double left_at; /* theta from which on g has the sign with which it leaves 0 */
} tvi_watch;

/* The state that a run begins with: the integrator's own, that of its last stop except for p, or any other. */
typedef enum { TVI_FROM_OWN, TVI_FROM_STOP, TVI_FROM_ANY } tvi_search_from;

/* The work of a search. */
typedef struct {
    tvi_integrator *it;
    tvi_between *between;
    int count;
    tvi_watch *watch; /* [count] */
    /* The state that the next search begins with. */
    tvi_search_from start_kind;
    bool has_new_momentum; /* the run begins at a stop, with another p */
    bool rests;            /* g returns to 0 before the time moves */
    long step;             /* number of the last step searched; 0: none */
    jet_tape *tape;        /* of all events */
    /* The block of `tape`, which begins with the inputs [2n + 1][TVI_SAMPLES]. */
    double *samples;
    tvi_range used[2];    /* the components of q and of p that `tape` uses */
    double *state, *move; /* [2n + 1] each */
    tvi_root *roots;      /* [found] of the current step */
    int found;
} tvi_search;

/* Opens a search for a run that begins at time t with state[2], q and p. */
TVI_NODISCARD tvi_status tvi_search_open(tvi_search *search, tvi_between *between, const tvi_event *const events[],
                                         int count, double t, const double *const state[2]);
void tvi_search_close(tvi_search *search); /* may also be called if tvi_search_open failed */
/* Sets the events' parameters to the integrator's. */
void tvi_search_set_parameters(tvi_search *search);

/* Finds the roots of all events in the last step, event by event. TVI_ENOCONV: an event returns before the time
 * moves. */
TVI_NODISCARD tvi_status tvi_search_step(tvi_search *search);
/* Compute the state x [2n + 1] of q, p and t on the curve, and g of an event at such a state. */
TVI_NODISCARD tvi_status tvi_search_state(tvi_search *search, double theta, double x[]);
TVI_NODISCARD tvi_status tvi_search_value(tvi_search *search, int which, const double x[], double *g);

/* Finds the root on the curve to roundoff. */
TVI_NODISCARD tvi_status tvi_search_zero(tvi_search *search, const tvi_root *root, double *theta);

#endif
