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

/* g at the state x [2n + 1], q, p and t; block is one of the event's tape. TVI_EDOMAIN, TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_event_value(const tvi_event *event, double *block, const double *x, double *g);
/* The same in lanes at the states x [2n + 1][TVI_SAMPLES] (tvi_sample); x may be the inputs of the block. */
TVI_NODISCARD tvi_status tvi_event_samples(const tvi_event *event, double *block, const double *x, double g[]);

#endif
