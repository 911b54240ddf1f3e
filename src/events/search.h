/* search.h - Finds the roots of event functions g(q, p, t) along the curve of the last step (tvi_dense), to the
 * accuracy of that curve. locate.c calls it after each step of a run with events. theta is the part of the step, from 0
 * at its start to 1 at its end. */
#ifndef TVI_EVENTS_SEARCH_H
#define TVI_EVENTS_SEARCH_H

#include "system/event.h"
#include "integrator/partial_step.h"
#include "algebra/narrow.h"

/* A root of an event function g: a point of a step where g reaches 0 or changes its sign. */
typedef struct {
    int event_index;          /* index of the event among those of the run */
    int index_in_order_found; /* number of the root in the order in which the search found them, from 0 */
    int g_sign_after;         /* the sign of g just after the root: +1 or -1 */
    tvi_sign_bracket bracket; /* an interval of theta that contains the root; at `right` g has g_sign_after or is 0 */
    double theta_guess;       /* an estimate of the root's theta; NAN if there is none */
    /* True if g = 0 at the start of the step, and this root is the next zero of g. Between both zeros g has the sign of
     * bracket.g_left. */
    bool is_return_to_zero;
    /* True if only the curve has the root; the more accurate partial steps (finder.c) lack it. */
    bool is_absent_from_accurate_solution;
    double theta; /* the theta of the root to roundoff, which finder.c sets */
} tvi_event_root;

/* An event function that a search watches, and its values in the current step. */
typedef struct {
    const tvi_event *event;
    double *tape_block;                /* memory in which the tape of the event is evaluated */
    tvi_event_expansion local_series;  /* memory for the Taylor series of g near one state */
    double g_samples[1 + TVI_SAMPLES]; /* values of g: at the start of the step, then at tvi_sample_theta */
    /* True if the run goes on from a state where it was stopped, and this event was reported at that stop. */
    bool was_reported_at_stop;
    /* True if the step begins on the event (g = 0). g_samples[0] then is a tiny number with the sign that g has just
     * after the start. */
    bool is_zero_at_step_start;
    /* A theta at which g certainly has the sign of g_samples[0], if is_zero_at_step_start is true. */
    double theta_after_leaving_zero;
} tvi_watched_event;

/* The kinds of state from which a run starts: the end of the integrator's last step (TVI_FROM_LAST_STEP), the state
 * of its last stop with any momentum p (TVI_FROM_STOP), or any other state (TVI_FROM_ANY). */
typedef enum { TVI_FROM_LAST_STEP, TVI_FROM_STOP, TVI_FROM_ANY } tvi_start_state_source;

/* A search for roots of event functions on the curve of the integrator's last step. */
typedef struct {
    tvi_integrator *integrator;     /* the integrator whose last step is searched */
    tvi_partial_step *partial_step; /* computes states inside the last step by the method, not on the curve */
    int event_count;
    tvi_watched_event *watched_events; /* [event_count] the events of the run */
    /* The kind of state from which the next step to be searched starts. */
    tvi_start_state_source start_state_source;
    bool is_momentum_changed_at_stop; /* true if the run begins at its last stop with another momentum p */
    /* True if an event that stopped the run comes again before the time changes by more than its roundoff, as for a
     * ball at rest on the floor. */
    bool repeats_stop_at_same_time;
    long last_searched_step_number; /* the number of the last step that was searched; 0 if there is none */
    jet_tape *joint_tape;           /* a tape that evaluates the functions of all events together */
    /* Memory in which joint_tape is evaluated at TVI_SAMPLES states at once. It begins with the tape's inputs, the
     * states [2n + 1][TVI_SAMPLES]. */
    double *joint_tape_block;
    tvi_component_range used_components[2];    /* the components of q and of p that joint_tape depends on */
    double *scratch_state, *scratch_increment; /* [2n + 1] each, in the order q, p, t */
    tvi_event_root *roots;                     /* [root_count] the roots in the current step */
    int root_count;
} tvi_event_search;

/* Opens a search for a run that begins at the time t with q = start_state[0] and p = start_state[1]. */
TVI_NODISCARD tvi_status tvi_search_open(tvi_event_search *search, tvi_partial_step *partial_step,
                                         const tvi_event *const events[], int event_count, double t,
                                         const double *const start_state[2]);
/* Frees the memory of the search, also after tvi_search_open has failed. */
void tvi_search_close(tvi_event_search *search);
/* Copies the integrator's parameters to the tapes of all events. */
void tvi_search_set_parameters(tvi_event_search *search);

/* Finds the roots of all events in the last step, one event after the other. Returns TVI_ENOCONV if
 * search->repeats_stop_at_same_time becomes true. */
TVI_NODISCARD tvi_status tvi_search_last_step_for_roots(tvi_event_search *search);
/* Computes the state [2n + 1], in the order q, p, t, on the curve of the last step at theta. */
TVI_NODISCARD tvi_status tvi_search_compute_curve_state(tvi_event_search *search, double theta, double state[]);
/* Computes the value *g of one event function at the state [2n + 1]. */
TVI_NODISCARD tvi_status tvi_search_evaluate_event(tvi_event_search *search, int event_index, const double state[],
                                                   double *g);

/* Computes the theta of a root on the curve to roundoff, from its bracket. */
TVI_NODISCARD tvi_status tvi_search_find_curve_root(tvi_event_search *search, const tvi_event_root *root,
                                                    double *theta);

/* ---- The start of a step (start.c) ------------------------------------------------------------------------------- */

/* Tells which kind of state the run begins with. It must be called before the first step changes the integrator. */
tvi_start_state_source tvi_find_start_state_source(const tvi_integrator *integrator, double t, const double q[],
                                                   const double p[]);

/* Tells whether the event was reported at the given stop of a run. */
bool tvi_stop_has_event(const tvi_event_stop *stop, const tvi_event *event);

/* Evaluates the functions g of all events at the start of the last step, and sets their g_samples[0]: to 0 if the start
 * lies on the event up to roundoff. The search calls this function if it has no values of g from the end of the step
 * before. */
TVI_NODISCARD tvi_status tvi_evaluate_events_at_start(tvi_event_search *search);

/* Sets g_samples[0] of an event on which the step begins (g = 0) to a tiny number with the sign that g has just
 * after the start of the step. Also sets is_zero_at_step_start and theta_after_leaving_zero (tvi_watched_event). */
TVI_NODISCARD tvi_status tvi_find_sign_leaving_zero(tvi_event_search *search, int event_index);

/* Sets *g_change to g(x(theta)) - g(x(0)) for a step that begins on the event. x(theta) is the state after a partial
 * step of the method, which search->partial_step then holds. *is_sign_certain tells whether |*g_change| is larger
 * than its roundoff. */
TVI_NODISCARD tvi_status tvi_compute_g_change_from_start(tvi_event_search *search, int event_index, double theta,
                                                         double *g_change, bool *is_sign_certain);

/* Sets *is_roundoff: true if |g| stays below its roundoff over the whole step. */
TVI_NODISCARD tvi_status tvi_search_is_g_roundoff(tvi_event_search *search, int event_index, bool *is_roundoff);

#endif
