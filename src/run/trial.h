/* trial.h - Makes trials of a step size: short integrations that estimate the error at the end of a run (trial.c).
 * suggest.c calls it. */
#ifndef TVI_SRC_RUN_TRIAL_H
#define TVI_SRC_RUN_TRIAL_H

#include "run/step_doubling.h"

#include <math.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* The scout and all trials together make at most the part TRIALS_PART_OF_RUN of the steps of the run. */
#define TRIALS_PART_OF_RUN 0.04 /* found: make suggest */
/* [steps] The scout and all trials may make at least this many steps together. */
#define TRIALS_MIN_STEPS 60 /* found: make suggest */
/* [steps] The scout and all trials make at most this many steps together. */
#define TRIALS_MAX_STEPS 6000 /* found: make suggest */
/* A trial ends if its estimate and the aim differ by more than this factor. */
#define TRIAL_ERROR_BAND 30.0 /* found: make suggest */
/* A trial counts as much as the longest one if it covers this part of it. */
#define TRIAL_EQUAL_LENGTH 0.8 /* found: make suggest */
/* A trial that leaves out a smaller part of the run covers the whole run. */
#define TRIAL_END 1e-9 /* found: make suggest */
/* Errors grow as t^a with the time t of a run. This is the exponent a; in driven systems it is the largest one. */
#define TRIAL_GROWTH_EXPONENT 1.25 /* found: make suggest */
/* This is the exponent a in rescaled systems. */
#define TRIAL_GROWTH_EXPONENT_RESCALED 1.1 /* found: make suggest */

/* A step of a trial costs three steps of the integrator: one of size h, and two of half that size. The steps of all
 * trials and of the scout together are limited to TRIALS_PART_OF_RUN of the steps of the run, but this limit is at
 * least TRIALS_MIN_STEPS and at most TRIALS_MAX_STEPS. */
enum { TVI_STEPS_OF_TRIAL = 3 };

/* The data that all trials for one suggestion share. */
typedef struct {
    double start_time, duration; /* the start and the duration of the run */
    double aimed_error;          /* the error at the end of the run that the trials aim at */
    bool is_driven;              /* true if the system is driven (tvi_system_driven), so that errors may decay */
    /* The exponent a of the growth of errors: the error of a run of the duration t is proportional to t^a. */
    double error_growth_exponent;
    /* Distances of the two orbits below this value may be roundoff. */
    double largest_roundoff_distance;
    tvi_step_doubling step_doubling;
    tvi_orbit_scout scout;
    /* The abscissa (tvi_orbit_scout) of the end of the run, which is the sum of all step sizes of the run; and the sum
     * over the whole run of the step sizes, each times the error that a run makes there, relative to that at the
     * hardest step (tvi_scout_weighted_length). */
    double run_end_abscissa, run_weighted_length;
    double start_abscissa;     /* the abscissa (tvi_orbit_scout) at which the last trial began */
    const double *start_state; /* [2n + 1] q, p and t at start_abscissa */
    /* Steps of the budget that are kept for the companion, a perturbed orbit (step_doubling.h). */
    long reserved_step_count;
    double run_length_in_steps; /* run_end_abscissa divided by the current step size */
    /* The largest share, 0 to 1, of the run's expected error that arises in the part of the orbit of one of the trials
     * so far. */
    double largest_error_fraction;
} tvi_trials;

/* A trial of one step size, and the error that it estimates. */
typedef struct {
    /* The step size; and the share, 0 to 1, of the run's expected error that arises in the part of the orbit that the
     * trial has integrated (tvi_scout_weighted_length). */
    double h, run_error_fraction;
    /* The abscissa at which the trial ends: the sum of the step sizes from the start of the run (tvi_orbit_scout). */
    double end_abscissa;
    double duration_fraction_done; /* the part of the run's duration up to the end of the trial, 0 to 1 */
    /* The steps of a trial form groups, of which group i has the steps 2^i + 1 to 2^(i+1). The largest distance of the
     * two orbits (step_doubling.h) in the last group, and that in the group before. */
    double recent_orbit_distance, previous_orbit_distance;
    /* The estimated error at the end of the run. It is INFINITY if a step has failed, or if the distance of the
     * orbits is too large for an extrapolation. */
    double estimated_error;
    bool has_passed_hardest_step;       /* true if the trial has passed the scout's hardest step */
    bool is_finished, covers_whole_run; /* true if the trial has ended; true if it went through the whole run */
    tvi_status status;                  /* the status of the last step of the trial */
} tvi_step_size_trial;

/* Makes a trial with steps of size h. */
tvi_step_size_trial tvi_make_step_size_trial(tvi_trials *trials, double h);

/* Returns the number of steps that the scout and all trials may make together. */
static inline double tvi_trials_step_budget(const tvi_trials *trials)
{
    return fmin(fmax(TRIALS_MIN_STEPS, TRIALS_PART_OF_RUN * trials->run_length_in_steps), TRIALS_MAX_STEPS);
}
/* Tells whether the budget of steps allows `steps` further steps of the integrator. */
static inline bool tvi_trials_have_budget_for_steps(const tvi_trials *trials, double steps)
{
    return (double)trials->step_doubling.tried_step_count + steps <= tvi_trials_step_budget(trials);
}
/* Tells whether the budget allows one more step of a trial, in addition to the reserved steps. */
static inline bool tvi_trials_can_continue_trial(const tvi_trials *trials)
{
    return tvi_trials_have_budget_for_steps(trials, (double)(trials->reserved_step_count + TVI_STEPS_OF_TRIAL));
}
/* Tells whether the budget of steps allows a trial with steps of this size that passes the hardest step. */
bool tvi_trials_can_pass_hardest_step(const tvi_trials *trials, double trial_step_size);

/* Tells whether the trial's estimate is above the given error, and not only by roundoff. */
static inline bool tvi_trial_error_is_above(const tvi_trials *trials, const tvi_step_size_trial *trial, double error)
{
    return trial->estimated_error > error &&
           (trial->estimated_error == INFINITY ||
            fmax(trial->recent_orbit_distance, trial->previous_orbit_distance) >= trials->largest_roundoff_distance);
}
/* Tells whether the estimate is below the aim by more than the factor TRIAL_ERROR_BAND. */
static inline bool tvi_trial_error_is_far_below_aim(const tvi_trials *trials, const tvi_step_size_trial *trial)
{
    return trial->estimated_error < trials->aimed_error / TRIAL_ERROR_BAND;
}
/* Tells whether the estimate is above the aim by more than the factor TRIAL_ERROR_BAND. */
static inline bool tvi_trial_error_is_far_above_aim(const tvi_trials *trials, const tvi_step_size_trial *trial)
{
    return tvi_trial_error_is_above(trials, trial, TRIAL_ERROR_BAND * trials->aimed_error);
}

#endif
