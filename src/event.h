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
};

/* g at (t, q, p); x is the block of the event's tape. TVI_EDOMAIN, TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_event_value(const tvi_event *event, double *x, double t, const double q[],
                                         const double p[], double *g);

#endif
