/* events.h - Declares the search for the events of a run, and what its three files call of each other. src/run/run.c
 * calls the functions of events.c after each step, and reports the events.
 *
 * theta is the part of the step, from 0 at its start to 1 at its end. A state is a vector [2n + 1], in the order q, p,
 * t. */
#ifndef TVI_EVENTS_EVENTS_H
#define TVI_EVENTS_EVENTS_H

#include "algebra/narrow.h"
#include "integrator/inside_step.h"
#include "system/event.h"

typedef struct tvi_event_search tvi_event_search;
typedef struct tvi_watched_event tvi_watched_event;

/* A root of an event function g: a point of a step where g reaches 0 or changes its sign. */
typedef struct {
    tvi_watched_event *watched; /* the event of which this is a root */
    int g_sign_after;           /* the sign of g just after the root: +1 or -1 */
    tvi_sign_bracket bracket;   /* an interval of theta that contains the root; at `right` g has g_sign_after or is 0 */
    /* The root and the slope dg/dtheta of the polynomial through the samples of g; NAN if there are none. */
    double theta_guess, slope_guess;
    double theta;  /* the theta of the root to roundoff, which finish.c sets; NAN if only the curve has the root */
    double *state; /* [2n + 1] the state at the root, which finish.c sets */
} tvi_event_root;

/* A state that a partial step has computed, and the value of g there. */
typedef struct {
    double theta, g, *x;
    bool is_by_curve; /* computed from the state of a partial step and the change of the curve from there */
} tvi_accurate_state;

/* The line on which finish.c looks for a root: through two states, of which `last` was computed after `before`. Their
 * theta are NAN if there are none in this step. */
typedef struct {
    tvi_accurate_state before, last;
} tvi_event_line;

/* An event function that a search watches, and its values in the current step. */
struct tvi_watched_event {
    tvi_event_search *search;
    int index; /* index of the event among those of the run */
    const tvi_event *event;
    double *tape_block;                /* memory in which the tape of the event is evaluated */
    tvi_event_expansion local_series;  /* memory for the Taylor series of g near one state */
    double g_samples[1 + TVI_SAMPLES]; /* values of g: at the start of the step, then at k / 8 */
    /* True if the run goes on from a state where it was stopped, and this event was reported at that stop. */
    bool was_reported_at_stop;
    bool is_unreported_at_stop; /* true if this event lies at the stop that ends the run, and was not reported */
    /* True if the step begins on the event (g = 0). g_samples[0] then is a tiny number with the sign that g has just
     * after the start, and has for certain at theta_after_leaving_zero. */
    bool is_zero_at_step_start;
    double theta_after_leaving_zero;
    int change_sign; /* the sign that tvi_watched_evaluate_change has found */
};

/* The kinds of state from which a run starts: the end of the integrator's last step (TVI_FROM_LAST_STEP), the state
 * of its last stop with any momentum p (TVI_FROM_STOP), or any other state (TVI_FROM_ANY). */
typedef enum { TVI_FROM_LAST_STEP, TVI_FROM_STOP, TVI_FROM_ANY } tvi_start_state_source;

struct tvi_event_search {
    tvi_integrator *integrator;    /* the integrator whose last step is searched */
    tvi_partial_step partial_step; /* computes states inside the last step by the method, not on the curve */
    int state_size;                /* 2n + 1 */
    int event_count;
    tvi_watched_event *watched_events;         /* [event_count] the events of the run */
    tvi_start_state_source start_state_source; /* the kind of state from which the next step to be searched starts */
    /* True if an event at which the run was stopped comes again before the time changes by more than its roundoff,
     * as for a ball at rest on the floor. */
    bool repeats_stop;
    long last_searched_step_number; /* the number of the last step that was searched; 0 if there is none */
    jet_tape *joint_tape;           /* a tape that evaluates the functions of all events together */
    /* Memory in which joint_tape is evaluated at TVI_SAMPLES states at once. It begins with the tape's inputs, the
     * states [2n + 1][TVI_SAMPLES]. */
    double *joint_tape_block;
    tvi_component_range used_components[2]; /* the components of q and of p that joint_tape depends on */
    double *scratch_state, *scratch_sizes;  /* [2n + 1] each */
    tvi_event_line line;
    const tvi_event_root *sought; /* the root that finish.c looks for on the line */
    tvi_event_root *roots;        /* [root_count] the roots in the current step */
    int root_count;
    double *root_states; /* [root_capacity][2n + 1] the states of the step's roots */
    int root_capacity;
};

/* ---- search.c ---------------------------------------------------------------------------------------------------- */

/* Finds the roots of all events on the curve of the last step, one event after the other. Returns TVI_ENOCONV if
 * search->repeats_stop becomes true. */
TVI_NODISCARD tvi_status tvi_search_last_step(tvi_event_search *search);
/* Computes the value *g of an event function at a state. */
TVI_NODISCARD tvi_status tvi_watched_evaluate(tvi_watched_event *watched, const double state[], double *g);
/* Computes the value *g of an event function, ctx is the tvi_watched_event, on the curve of the last step at theta. */
TVI_NODISCARD tvi_status tvi_watched_evaluate_on_curve(void *ctx, double theta, double *g);
/* Sets *g_per_theta to (g(x(theta)) - g(x(0))) / theta for a step that begins on the event ctx, where x(theta) is the
 * state after a partial step of the method. This quotient is nearly linear in theta if theta is small. The
 * tvi_watched_event's change_sign becomes its sign, or 0 if it is below its roundoff. theta < 1. */
TVI_NODISCARD tvi_status tvi_watched_evaluate_change(void *ctx, double theta, double *g_per_theta);
/* A sample of an event function: the value g at the abscissa theta. */
typedef struct {
    double theta, g;
} tvi_event_sample;
/* A dip, that is a local minimum of |g|, is described by an array of five samples, in the order of theta. At dip[1],
 * dip[2] and dip[3] g has one sign, and |g| is smallest at dip[2]. The outer samples dip[0] and dip[4] may be missing;
 * their g is NAN then. */
enum { TVI_DIP_SAMPLES = 5 };
/* Tells whether the search needs another sample of g after sample_count samples, and sets *theta to the abscissa of
 * that sample. The result is false if the search ends: g has no zero between dip[1] and dip[3], or only one that
 * roundoff would hide. */
bool tvi_dip_needs_another_sample(const tvi_event_sample dip[TVI_DIP_SAMPLES], int sample_count, double *theta);
/* Inserts a new sample, whose g has the sign of dip[2].g. It becomes dip[2] or one of its neighbours. */
void tvi_dip_insert_sample(tvi_event_sample dip[TVI_DIP_SAMPLES], tvi_event_sample sample);

/* ---- finish.c ---------------------------------------------------------------------------------------------------- */

/* Computes root->theta and root->state of a root that the curve has, to roundoff. root->theta becomes NAN if the more
 * accurate partial steps lack the root, as g nearly touches 0 there. */
TVI_NODISCARD tvi_status tvi_finish_root(tvi_event_search *search, tvi_event_root *root);
/* Tells whether the value g has the sign that the event function has just after the root, or is 0. */
static inline bool tvi_has_sign_after_root(const tvi_event_root *root, double g)
{
    return root->g_sign_after > 0 ? g >= 0 : g <= 0;
}

/* ---- events.c ---------------------------------------------------------------------------------------------------- */

/* Opens a search for the events of a run that begins at the time t with q = start_state[0] and p = start_state[1]. On
 * failure *out is NULL. */
TVI_NODISCARD tvi_status tvi_events_open(tvi_event_search **out, tvi_integrator *integrator,
                                         const tvi_event *const events[], int event_count, double t,
                                         const double *const start_state[2]);
void tvi_events_close(tvi_event_search *search); /* frees the search, unless it is NULL */
/* Finds all events of the last step, search->roots [search->root_count], in the order of time. The status is
 * TVI_ENOCONV if search->repeats_stop becomes true. */
TVI_NODISCARD tvi_status tvi_events_find(tvi_event_search *search);
/* Ends the run at a root of the last step: the integrator's tvi_event_stop stores its state and all events there, so
 * that a run that goes on from this state does not report them again. Those that were not reported before have
 * is_unreported_at_stop. */
TVI_NODISCARD tvi_status tvi_events_stop_run(tvi_event_search *search, const tvi_event_root *root);
/* Tells whether g, the value of an event function at a state, is at most its roundoff there. */
TVI_NODISCARD tvi_status tvi_watched_is_zero(tvi_watched_event *watched, double g, const double state[], bool *is_zero);
/* Tells whether the event was reported at the given stop of a run. */
bool tvi_stop_has_event(const tvi_event_stop *stop, const tvi_event *event);

#endif
