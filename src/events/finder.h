/* finder.h - Finds the time and the state of an event to roundoff, from a root that the search (search.h) has bracketed
 * on the curve of the step. locate.c calls it. */
#ifndef TVI_EVENTS_FINDER_H
#define TVI_EVENTS_FINDER_H

#include "events/search.h"
#include "system/rates.h"

/* The memory of a finder. It represents the solution near an event by a line x(theta) = line_origin + (theta -
 * line_origin_theta) line_direction. States x are vectors [2n + 1], in the order q, p, t. */
typedef struct {
    tvi_event_search *search;
    tvi_rates_evaluator rates_evaluator;    /* evaluates dq/dt and dp/dt at a state */
    int state_size;                         /* 2n + 1, the number of components of a state */
    double *line_origin, line_origin_theta; /* the state after the last partial step, and its theta */
    /* The slope of the line, dx/dtheta of the solution, and the distance in theta from line_origin_theta up to which
     * the line is accurate to roundoff. */
    double *line_direction, accurate_distance;
    /* The midpoint of the chord of the curve whose slope is line_direction. */
    double *chord_midpoint;
    bool is_chord_inside_step; /* true if both ends of this chord lie inside the step */
    bool has_root_on_line;     /* true if the event function changes its sign on the current line */
    double *scratch_state;     /* scratch memory for one state */
} tvi_event_finder;

/* Allocates the memory of a finder for the events of a search. */
TVI_NODISCARD tvi_status tvi_finder_open(tvi_event_finder *finder, tvi_event_search *search);
void tvi_finder_close(tvi_event_finder *finder);

/* Computes root->theta and state [2n + 1] of an event in the last step, to roundoff. If g changes its sign only on the
 * less accurate curve, since it nearly touches 0 there, root->is_absent_from_accurate_solution is set instead. */
TVI_NODISCARD tvi_status tvi_finder_find_event(tvi_event_finder *finder, tvi_event_root *root, double state[]);

/* Tells whether the value g has the sign that the event function has just after the root, or is 0. */
static inline bool tvi_has_sign_after_root(const tvi_event_root *root, double g)
{
    return root->g_sign_after > 0 ? g >= 0 : g <= 0;
}

#endif
