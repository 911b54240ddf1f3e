/* scout.h - Explores an orbit with few large steps (scout.c), to find where it needs the shortest steps. suggest.c and
 * trial.c call it. */
#ifndef TVI_SRC_RUN_SCOUT_H
#define TVI_SRC_RUN_SCOUT_H

#include "tvi.h"

#include <stdbool.h>

/* [steps] The scout tries at most this many. */
#define SCOUT_MAX_STEPS 24 /* found: make suggest */
/* A step just resolves the orbit if its tail (tvi_stats.tail) is this. The tail is the last term of the polynomial of
 * the forces, divided by the momentum. */
#define SCOUT_RESOLVING_TAIL 0.003 /* found: make suggest */

/* An orbit that is being integrated: the integrator, and its current state (t, q[n], p[n]). */
typedef struct {
    tvi_integrator *integrator;
    double t, *q, *p;
} tvi_integrated_orbit;

/* Sets the orbit to the state [2n + 1], in the order q, p, t. */
void tvi_integrated_orbit_set_state(tvi_integrated_orbit *orbit, int n, const double *state);

/* The exploration of an orbit by a sequence of steps. The abscissa of a state on the orbit is the sum of the step sizes
 * from the start of the run to the state: a difference of times, or of the s of a rescaled system. */
typedef struct {
    int n; /* the number of coordinates of the orbit */
    /* [SCOUT_MAX_STEPS + 1][2n + 1] The states (q, p, t) between the steps, in memory of the caller. */
    double *explored_states;
    long tried_step_count; /* the number of tried steps, including those that failed or were undone */
    int step_count;        /* the number of steps that succeeded; step k leads from state k to state k + 1 */
    double state_abscissas[SCOUT_MAX_STEPS + 1]; /* the abscissas of the states */
    /* At each step, the estimated size of a step that resolves the orbit there: its tail would be
     * SCOUT_RESOLVING_TAIL. */
    double resolving_step_size[SCOUT_MAX_STEPS];
    /* The index of the hardest step, the one with the least resolving_step_size. */
    int hardest_step_index;
    double explored_fraction; /* the part of the duration of the run that the scout has covered, 0 to 1 */
    /* True if the degree of the curve of the method is at most 2. The tails of such curves are no estimate of an
     * error, so only one step is made. */
    bool is_degree_too_low_for_tail;
    double largest_q, largest_p; /* the largest |q_i| and the largest |p_i| along the orbit */
    tvi_status last_status;      /* the status of the last step */
} tvi_orbit_scout;
/* Returns the state [2n + 1] after state_index steps of the scout. */
static inline double *tvi_scout_state(const tvi_orbit_scout *scout, int state_index)
{
    return scout->explored_states + (size_t)state_index * (size_t)(2 * scout->n + 1);
}

/* Explores the orbit from its current state by at most SCOUT_MAX_STEPS steps, or to the end of the run. It fails if no
 * step succeeds, with the status of the last step, or if memory is exhausted. */
TVI_NODISCARD tvi_status tvi_scout_explore_orbit(tvi_orbit_scout *scout, tvi_integrated_orbit *orbit, double duration);

/* Returns the distance between two abscissas, in which each step of the scout is weighted by the error that a run makes
 * there. The weight of the hardest step is 1, and that of every other step at most 1. */
double tvi_scout_weighted_length(const tvi_orbit_scout *scout, double from_abscissa, double to_abscissa);

#endif
