/* step_doubling.h - Integrates two orbits from one state, with steps h and h/2, and measures their distance, which
 * is an estimate of the error. trial.c and suggest.c call it. */
#ifndef TVI_SRC_RUN_STEP_DOUBLING_H
#define TVI_SRC_RUN_STEP_DOUBLING_H

#include "run/scout.h"
#include "system/rates.h"

#include <stdbool.h>

/* The two orbits, and the measures of their distance. */
typedef struct {
    int n; /* the number of coordinates of an orbit */
    bool is_rescaled;
    tvi_integrated_orbit full_step_orbit, half_step_orbit; /* the orbits with steps h and h/2 */
    double largest_q, largest_p;         /* the largest |q_i| and |p_i| so far, by which differences are divided */
    tvi_rates_evaluator rates_evaluator; /* evaluates dq/dt and dp/dt of a rescaled system; unused otherwise */
    /* A state [2n + 1] of full_step_orbit, and its time derivatives [2n]. */
    double *rates_input, *rates_output;
    double *memory_of_scout_states; /* memory for tvi_orbit_scout.explored_states */
    /* The largest |dq_i/dt| / largest_q or |dp_i/dt| / largest_p so far. */
    double largest_relative_rate;
    double orbit_distance;     /* the relative distance of the two orbits when it was last measured */
    long tried_step_count;     /* the number of steps that both orbits have tried */
    bool has_exhausted_memory; /* true if a step has failed for lack of memory */
} tvi_step_doubling;

/* Creates the integrators of both orbits. `doubling` must be zeros before; it is to be closed also after a failure. */
TVI_NODISCARD tvi_status tvi_step_doubling_open(tvi_step_doubling *doubling, const tvi_system *system,
                                                const tvi_options *options);
void tvi_step_doubling_close(tvi_step_doubling *doubling);

/* Sets both orbits to the state [2n + 1], in the order q, p, t. */
void tvi_step_doubling_set_state(tvi_step_doubling *doubling, const double *state);

/* Makes one step of size h on the first orbit, and two of size h/2 on the second. */
TVI_NODISCARD tvi_status tvi_step_doubling_make_step(tvi_step_doubling *doubling, double h);

/* Measures how a shift of the time changes a step: makes a step of size h from the state, and one from the same q and p
 * at the time t + start_time_shift. *step_end_state_distance is the distance between the ends of the two steps; it is 0
 * if a step fails. Returns TVI_ENOMEM or TVI_OK. */
TVI_NODISCARD tvi_status tvi_measure_time_shift_distance(tvi_step_doubling *doubling, const double *start_state,
                                                         double h, double start_time_shift,
                                                         double *step_end_state_distance);

/* Measures orbit_distance, the largest difference of a component of q or p between the orbits, divided by largest_q or
 * largest_p. In a rescaled system one orbit may lag behind the other, which causes a large distance only where the
 * motion is fast. Returns the distance, or the distance that the present lag would cause where the motion is fastest,
 * if that is larger. */
double tvi_step_doubling_distance(tvi_step_doubling *doubling);

/* Returns the error of the part of the run that the scout has explored, divided by the error of a trial between two
 * abscissas (tvi_orbit_scout). The error of the explored part is a sum over the scout's steps: the error that a step
 * adds, times the growth of this error to the end. The growth is measured by a companion, a perturbed orbit that starts
 * near the scout's orbit at the end of the trial, displaced in the direction of the trial's error. trial_start_abscissa
 * must be one of the scout's abscissas. The result is 0 if no companion could be integrated. *growth_ratio is the
 * largest distance of the companion in the second half of its way divided by that in the first half. */
double tvi_step_doubling_error_ratio(tvi_step_doubling *doubling, const tvi_orbit_scout *scout,
                                     double trial_start_abscissa, double trial_end_abscissa, double *growth_ratio);

#endif
