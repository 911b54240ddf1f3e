/* event.h - Records and evaluates event functions. The search for events (run/search.c) calls it. */
#ifndef TVI_SRC_SYSTEM_EVENT_H
#define TVI_SRC_SYSTEM_EVENT_H

#include "tape.h"
#include "tvi.h"

struct tvi_event {
    int n;
    tvi_direction direction;
    bool terminal;
    jet_graph *graph; /* closed */
    jet output;       /* g */
    jet_tape *tape;   /* inputs q, p, t; one output */
    /* A tape of the same function, for Taylor coefficients. */
    jet_tape *series;
    uint64_t hash; /* of the tape; equal functions have equal hashes */
};

/* Evaluates g at the state x [2n + 1] of q, p and t, in a block of the event's tape. TVI_EDOMAIN, TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_event_value(const tvi_event *event, double *block, const double *x, double *g);
/* Creates the tape of several events with the same n: its inputs are q, p, t, its outputs the g of each event. Sets
 * used [2n + 1]: whether an event depends on the input. */
TVI_NODISCARD tvi_status tvi_event_join(jet_tape **out, const tvi_event *const events[], int count, bool used[]);

/* The work for questions about g near one state. */
typedef struct {
    double *x;  /* [orders][slots] block of the event's series */
    double *dx; /* [slots][TVI_ROUNDOFF_SAMPLES] its tangents */
} tvi_event_near;
TVI_NODISCARD tvi_status tvi_event_near_open(tvi_event_near *near, const tvi_event *event);
void tvi_event_near_close(tvi_event_near *near); /* pointers may be NULL */

/* Estimates the roundoff of g at the state x [2n + 1]: the effect of a unit of roundoff in each input, relative to
 * size[2n + 1], and in each operation. TVI_EDOMAIN. */
TVI_NODISCARD tvi_status tvi_event_roundoff(const tvi_event *event, const tvi_event_near *near, const double x[],
                                            const double size[], double *roundoff);
/* Computes g(x + d) - g(x) by the Taylor polynomial of g along d [2n + 1], without the cancellation of a difference.
 * *scale is the sum of the sizes of its first-order terms. *is_exact: the rest of the series is below roundoff.
 * TVI_EDOMAIN. */
TVI_NODISCARD tvi_status tvi_event_rise(const tvi_event *event, const tvi_event_near *near, const double x[],
                                        const double d[], double *rise, double *scale, bool *is_exact);

#endif
