/* event.h - a recorded event function. */
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
};

/* g at the state x [2n + 1], q, p and t; block is one of the event's tape. TVI_EDOMAIN, TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_event_value(const tvi_event *event, double *block, const double *x, double *g);
/* A tape of all of them, of one dimension: inputs q, p, t; outputs g, by event. */
/* used [2n + 1]: the inputs that they depend on. */
TVI_NODISCARD tvi_status tvi_event_join(jet_tape **out, const tvi_event *const events[], int count, bool used[]);

#endif
