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
    jet_tape *series; /* the same, with what its Taylor coefficients need */
    uint64_t hash;    /* of the tape: equal functions have equal ones */
};

/* g at the state x [2n + 1], q, p and t; block is one of the event's tape. TVI_EDOMAIN, TVI_ENONFINITE. */
TVI_NODISCARD tvi_status tvi_event_value(const tvi_event *event, double *block, const double *x, double *g);
/* A tape of all of them, of one dimension: inputs q, p, t; outputs g, by event. */
/* used [2n + 1]: the inputs that they depend on. */
TVI_NODISCARD tvi_status tvi_event_join(jet_tape **out, const tvi_event *const events[], int count, bool used[]);

/* What is asked of g near one state. */
typedef struct {
    double *x;  /* [orders][slots] a block of the event's series, */
    double *dx; /* [slots][TVI_ROUNDOFF_SAMPLES] and its tangents */
} tvi_event_near;
TVI_NODISCARD tvi_status tvi_event_near_open(tvi_event_near *near, const tvi_event *event);
void tvi_event_near_close(tvi_event_near *near); /* NULL pointers are allowed */

/* The most that a unit of roundoff in each input, relative to size[2n + 1], makes of g at the state x [2n + 1], and
 * what one in each operation does. TVI_EDOMAIN. */
TVI_NODISCARD tvi_status tvi_event_roundoff(const tvi_event *event, const tvi_event_near *near, const double x[],
                                            const double size[], double *roundoff);
/* g(x + d) - g(x) by the Taylor polynomial of g along d [2n + 1], without the cancellation of a difference; *scale: the
 * sum of the sizes of its first-order terms. *is_exact: what the polynomial leaves out is roundoff. TVI_EDOMAIN. */
TVI_NODISCARD tvi_status tvi_event_rise(const tvi_event *event, const tvi_event_near *near, const double x[],
                                        const double d[], double *rise, double *scale, bool *is_exact);

#endif
