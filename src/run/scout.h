/* scout.h - Explores an orbit with few large steps (scout.c), to find where it needs the shortest steps. suggest.c and
 * trial.c call it. */
#ifndef TVI_SRC_RUN_SCOUT_H
#define TVI_SRC_RUN_SCOUT_H

#include "measured.h"
#include "tvi.h"

#include <stdbool.h>

/* An orbit that is being integrated: the integrator, and its current state (t, q[n], p[n]). */
typedef struct {
    tvi_integrator *integrator;
    double t, *q, *p;
} tvi_integrated_orbit;

/* Sets the orbit to the state [2n + 1], in the order q, p, t. */
void tvi_integrated_orbit_set_state(tvi_integrated_orbit *orbit, int n, const double *state);

/* The exploration of an orbit. The position of a state is the sum of the steps that lead to it from the start; it is in
 * the unit of the steps' variable, the time or the s of a rescaled system. */
typedef struct {
    int n; /* the number of coordinates of the orbit */
    /* [SCOUT_MAX_STEPS + 1][2n + 1] The state (q, p, t) at each position, in memory of the caller. */
    double *states;
    long tried_step_count; /* the number of tried steps, including those that failed or were undone */
    int step_count;        /* the number of steps that succeeded; step k leads from position k to position k + 1 */
    double positions[SCOUT_MAX_STEPS + 1];
    /* At each step, the estimated size of a step that resolves the orbit there: its tail would be
     * SCOUT_RESOLVING_TAIL. */
    double orbit_resolving_step_size_estimate[SCOUT_MAX_STEPS];
    int hardest_step_index;        /* index of the step with the least orbit_resolving_step_size_estimate */
    double explored_duration_part; /* the part of the duration of the run that the scout has covered, 0 to 1 */
    /* True if the degree of the curve of the method is at most 2. The tails of such curves are no estimate of an
     * error, so only one step is made. */
    bool is_degree_too_low_for_tail;
    double largest_q, largest_p; /* the largest |q_i| and the largest |p_i| along the orbit */
    tvi_status last_status;      /* the status of the last step */
} tvi_orbit_scout;
/* Returns the state [2n + 1] at the position with this index. */
static inline double *tvi_scout_state(const tvi_orbit_scout *scout, int position_index)
{
    return scout->states + (size_t)position_index * (size_t)(2 * scout->n + 1);
}

/* Explores the orbit from its current state by at most SCOUT_MAX_STEPS steps, or to the end of the run. It fails if no
 * step succeeds, with the status of the last step, or if memory is exhausted. */
TVI_NODISCARD tvi_status tvi_scout_explore_orbit(tvi_orbit_scout *scout, tvi_integrated_orbit *orbit, double duration);

/* Returns the distance between two positions, with each step of the scout weighted by the error that a run makes there:
 * the hardest steps count in full (weight 1), all other steps less. */
double tvi_scout_weighted_length(const tvi_orbit_scout *scout, double from_position, double to_position);

#endif
