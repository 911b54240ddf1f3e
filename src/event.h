/* event.h - a recorded event function. */
#ifndef TVI_SRC_EVENT_H
#define TVI_SRC_EVENT_H

#include "tape.h"
#include "tvi.h"

struct tvi_event {
    int n;
    tvi_direction direction;
    bool terminal;
    jet_graph *graph; /* closed */
    jet_tape *tape;   /* inputs q, p, t; one output */
    int *used, uses;  /* [uses] the inputs that are operands */
};

/* g [lanes] at the states x [2n + 1][lanes] of q, p, t; block is one of the event's tape with as many lanes, and
 * x may be its inputs.
 * TVI_EDOMAIN, TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_event_values(const tvi_event *event, double *block, int lanes, const double *x,
                                          double g[]);

#endif
