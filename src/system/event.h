/* event.h - Declares the user's event functions g(q, p, t): their recording, their values, and their Taylor
 * expansion near a state. The search for events (events/search.c) calls it. */
#ifndef TVI_SRC_SYSTEM_EVENT_H
#define TVI_SRC_SYSTEM_EVENT_H

#include "tape.h"
#include "tvi.h"

/* An event function and its recording. */
struct tvi_event {
    int n;
    tvi_direction direction;
    bool is_terminal;
    jet_graph *graph; /* The recording of g, to which nothing is added any more. */
    jet output;       /* The value of g in the graph. */
    jet_tape *tape;   /* Computes the value of the event function g from q, p, t. */
    jet_tape *series; /* Computes the Taylor series of the event function g. */
    /* The hash of the tape. Equal functions have equal hashes, also if their events have different directions. */
    uint64_t hash;
};

/* Tells whether the event reports a root after which g has the sign g_sign_after (+1, -1, or 0 if the sign is not
 * known). */
static inline bool tvi_event_reports_sign_change(const tvi_event *event, int g_sign_after)
{
    return event->direction == TVI_EITHER || (int)event->direction == g_sign_after;
}
/* Tells whether the event leaves the roots of one direction unreported. */
static inline bool tvi_event_skips_a_direction(const tvi_event *event) { return event->direction != TVI_EITHER; }

/* Tells whether all events were made for systems with n coordinates. If the result is false, the text of tvi_last_error
 * names the first event that was not. */
bool tvi_events_match_dimension(int n, const tvi_event *const events[], int event_count);

/* Computes g at x [2n + 1] = (q, p, t), in a block of the event's tape. Returns TVI_EDOMAIN or TVI_ENONFINITE if g
 * has no finite value. */
TVI_NODISCARD tvi_status tvi_event_evaluate(const tvi_event *event, double *block, const double *x, double *g);
/* Creates one tape for several events with the same n. Its inputs are q, p, t, and its outputs the values g of the
 * events. Sets used[i] for i < 2n + 1, which tells whether one of the events depends on input i. */
TVI_NODISCARD tvi_status tvi_event_create_joint_tape(jet_tape **out, const tvi_event *const events[], int count,
                                                     bool used[]);

/* Creates the tape of the derivatives of g by q, p, t and then by the parameters, whose inputs are q, p, t. */
TVI_NODISCARD tvi_status tvi_event_create_gradient_tape(jet_tape **out, const tvi_event *event, int parameter_count);

/* The memory in which g is expanded near one state. */
typedef struct {
    double *series_block; /* [orders][slots] The Taylor coefficients of all slots of event->series. */
    /* [slots][TVI_ROUNDOFF_SAMPLES] The first-order changes of all slots. Each column belongs to one change of the
     * inputs (q, p, t). */
    double *first_order_slot_changes;
} tvi_event_expansion;
/* Allocates the memory. Returns TVI_ENOMEM if memory is lacking; the caller closes the expansion in this case, too. */
TVI_NODISCARD tvi_status tvi_event_expansion_open(tvi_event_expansion *expansion, const tvi_event *event);
void tvi_event_expansion_close(tvi_event_expansion *expansion); /* Frees the memory. Its pointers may be NULL. */

/* Estimates the roundoff of g at the state x [2n + 1], if each input and each operation has an error of one unit of
 * roundoff. The unit of input i is DBL_EPSILON times input_sizes[i], i < 2n + 1. Returns TVI_EDOMAIN if g has no value
 * at x. */
TVI_NODISCARD tvi_status tvi_event_estimate_roundoff(const tvi_event *event, const tvi_event_expansion *expansion,
                                                     const double x[], const double input_sizes[], double *roundoff);
/* Computes the change g(x + displacement) - g(x) by the Taylor polynomial of g, without the cancellation of a
 * difference. *first_order_magnitude becomes sum_i |dg/dx_i displacement_i|. *is_exact tells whether the last term of
 * the polynomial is below the roundoff of the change. Returns TVI_EDOMAIN if g has no value at x. */
TVI_NODISCARD tvi_status tvi_event_compute_change(const tvi_event *event, const tvi_event_expansion *expansion,
                                                  const double x[], const double displacement[], double *change,
                                                  double *first_order_magnitude, bool *is_exact);

#endif
