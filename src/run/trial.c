/* trial.c - Makes a trial of a step size h: a short integration that estimates the error which a whole run with steps
 * of this size would have at its end. suggest.c, which searches the largest step size that meets a wanted error, calls
 * it.
 *
 * A trial integrates two orbits from the same state, one with steps of size h and one with steps of size h/2
 * (step_doubling.h). The state is the start of the run. But if the trial could not reach the run's hardest step from
 * there, the trial begins at the hardest step or some steps before it. This is the place where the orbit needs the
 * shortest steps, as a quick exploration with few steps has found (scout.h).
 *
 * The distance e of the two orbits is the largest difference of a coordinate at equal times, divided by the largest
 * coordinate, or of a momentum, divided by the largest momentum. For a method of order r it is the error of the orbit
 * with steps h, except for the error of the orbit with steps h/2, which is smaller by the factor 2^-r.
 *
 * From e at the end of the trial follows an estimate of the error at the end of the run. The exploration tells which
 * part x of the whole run's error, 0 < x <= 1, arises in the part of the orbit that the trial covers
 * (tvi_scout_weighted_length). If the error of a run grows with the time t as t^a, the estimate is e x^-a. The exponent
 * a (error_growth_exponent) is chosen as follows. The error of a symplectic method on a regular orbit (one that is not
 * chaotic) grows linearly, a = 1, and that of another method at most quadratically, a = 2. In between, a = 1.25 was
 * found to suit the benchmark's problems, and a = 1.1 those whose time is rescaled (docs/adaptive.md). In a driven
 * system (tvi_system_driven), in which forces may do work, such as friction, errors may also decay; there a is measured
 * from the growth of e during the trial, and limited to the range from 0 to 1.25.
 *
 * A trial ends at the end of the run, when the budget of steps of the exploration and all trials is spent, or when its
 * estimate is so far above or below the wanted error that further steps are not needed (can_trial_be_ended). */
#include "run/trial.h"
#include "algebra/sizes.h"
#include "run/integrator.h"

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* A larger distance of two orbits does not grow as a power of the step size. */
#define TRIAL_MAX_DISTANCE 0.05 /* found: make suggest */
/* [steps] In driven systems the growth of errors is measured from this step on. */
#define TRIAL_GROWTH_FIRST_STEP 8 /* found: make suggest */
/* [steps] In driven systems the growth of errors is measured once in this many steps. */
#define TRIAL_GROWTH_INTERVAL 4 /* found: make suggest */
/* [steps] A large estimate does not end a trial of fewer steps. */
#define TRIAL_MIN_STEPS 4 /* found: make suggest */
/* The hardest step comes before this part of the trial. */
#define TRIAL_MAX_HARDEST_PART 0.6 /* found: make suggest */
/* The companion orbit needs a scout that saw this part of the run. */
#define TRIAL_COMPANION_MIN_EXPLORED 0.5 /* found: make suggest */

static bool is_power_of_two(long k) { return (k & (k - 1)) == 0; }

/* Updates the error estimate after a step of the trial. `distance` is the distance of the two orbits at the end of the
 * step. */
static void update_error_estimate(tvi_trials *trials, tvi_step_size_trial *trial, long step_number, double distance)
{
    if (step_number > 1 && is_power_of_two(step_number - 1))
        trial->previous_orbit_distance = trial->recent_orbit_distance, trial->recent_orbit_distance = 0;
    trial->recent_orbit_distance = fmax(trial->recent_orbit_distance, distance);
    if (trials->is_driven && step_number >= TRIAL_GROWTH_FIRST_STEP && step_number % TRIAL_GROWTH_INTERVAL == 0 &&
        trial->previous_orbit_distance > 0)
        trials->error_growth_exponent =
            tvi_clamp(0, log2(trial->recent_orbit_distance / trial->previous_orbit_distance), TRIAL_GROWTH_EXPONENT);
    trial->estimated_error = distance < TRIAL_MAX_DISTANCE
                                 ? fmax(trial->recent_orbit_distance, trial->previous_orbit_distance) *
                                       pow(trial->run_error_fraction, -trials->error_growth_exponent)
                                 : INFINITY;
}

/* Returns the abscissa one resolving step size after the start of the hardest step, or that of the end of the run if
 * the run ends before. */
static double abscissa_after_hardest_step(const tvi_trials *trials)
{
    const tvi_orbit_scout *s = &trials->scout;
    return tvi_number_nearer_to_zero(s->state_abscissas[s->hardest_step_index] +
                                         s->resolving_step_size[s->hardest_step_index],
                                     trials->run_end_abscissa);
}

/* Tells whether the trial can be ended after step number step_number: its estimate is far above the aim, or far below
 * the aim although the trial has passed the hardest step. */
static bool can_trial_be_ended(const tvi_trials *trials, const tvi_step_size_trial *trial, long step_number)
{
    const bool is_early =
        step_number < TRIAL_MIN_STEPS &&
        fmax(trial->recent_orbit_distance, trial->previous_orbit_distance) < TRIAL_ERROR_BAND * trials->aimed_error;
    if (trial->estimated_error == INFINITY || (tvi_trial_error_is_far_above_aim(trials, trial) && !is_early))
        return true;
    return tvi_trial_error_is_far_below_aim(trials, trial) && trial->has_passed_hardest_step &&
           is_power_of_two(step_number) && trial->run_error_fraction > trials->largest_error_fraction;
}

/* Makes step number step_number of the trial, and updates the trial. Returns true if the trial needs further steps. */
static bool make_trial_step(tvi_trials *trials, tvi_step_size_trial *trial, long step_number)
{
    const tvi_integrated_orbit *whole = &trials->step_doubling.full_step_orbit;
    trial->status = tvi_step_doubling_make_step(
        &trials->step_doubling,
        trials->step_doubling.is_rescaled
            ? trial->h
            : tvi_number_nearer_to_zero(trial->h, trials->start_time + trials->duration - whole->t));
    trial->estimated_error = INFINITY;
    trial->is_finished = true;
    if (trial->status != TVI_OK) return false;
    trials->run_length_in_steps = fabs(trials->run_end_abscissa / trial->h);
    trial->end_abscissa = trials->start_abscissa + (double)step_number * trial->h;
    trial->duration_fraction_done = (whole->t - trials->start_time) / trials->duration;
    trial->run_error_fraction =
        fmin(tvi_scout_weighted_length(&trials->scout, trials->start_abscissa, trial->end_abscissa) /
                 trials->run_weighted_length,
             1);
    trial->has_passed_hardest_step = fabs(trial->end_abscissa) >= fabs(abscissa_after_hardest_step(trials));
    update_error_estimate(trials, trial, step_number, tvi_step_doubling_distance(&trials->step_doubling));
    const bool is_at_end = trial->duration_fraction_done >= 1 - TRIAL_END;
    trial->covers_whole_run = is_at_end && trials->start_abscissa == 0;
    trial->is_finished = is_at_end || can_trial_be_ended(trials, trial, step_number);
    return !trial->is_finished;
}

/* Lets a trial go on with the steps that were kept for the perturbed orbit, if the part of the run that it has made so
 * far is responsible for much less of the run's error than the part that an earlier trial made. Returns whether it does
 * so. */
static bool release_reserved_steps(tvi_trials *trials, const tvi_step_size_trial *trial)
{
    const bool takes = trials->reserved_step_count > 0 &&
                       trial->run_error_fraction < TRIAL_EQUAL_LENGTH * trials->largest_error_fraction;
    if (takes) trials->reserved_step_count = 0;
    return takes && tvi_trials_can_continue_trial(trials);
}

/* Chooses the state at which the trial begins: the start of the run, or the start of the hardest step if the trial
 * could not pass the hardest step from the start of the run. From the hardest step the start of the trial moves back by
 * steps of the scout, as long as the budget of steps suffices from there to the end of the run, and the hardest step is
 * passed within the part TRIAL_MAX_HARDEST_PART of the budget. */
static void choose_start_of_trial(tvi_trials *trials, double h)
{
    const tvi_orbit_scout *s = &trials->scout;
    const double end = abscissa_after_hardest_step(trials),
                 steps = (tvi_trials_step_budget(trials) - (double)trials->step_doubling.tried_step_count) /
                         TVI_STEPS_OF_TRIAL;
    const double early = TRIAL_MAX_HARDEST_PART * steps * fabs(h);
    int first = fabs(end) > early ? s->hardest_step_index : 0;
    while (first > 0 && fabs(trials->run_end_abscissa - s->state_abscissas[first]) < steps * fabs(h) &&
           fabs(end - s->state_abscissas[first - 1]) <= early)
        first--;
    trials->start_abscissa = s->state_abscissas[first];
    trials->start_state = tvi_scout_state(s, first);
    trials->reserved_step_count = s->explored_fraction >= TRIAL_COMPANION_MIN_EXPLORED ? s->step_count - first - 1 : 0;
}

tvi_step_size_trial tvi_make_step_size_trial(tvi_trials *trials, double h)
{
    tvi_step_size_trial trial = {.h = h, .estimated_error = INFINITY};
    choose_start_of_trial(trials, h);
    tvi_step_doubling_set_state(&trials->step_doubling, trials->start_state);
    for (long step_number = 1; (tvi_trials_can_continue_trial(trials) || release_reserved_steps(trials, &trial)) &&
                               make_trial_step(trials, &trial, step_number);
         step_number++)
        continue;
    return trial;
}

bool tvi_trials_can_pass_hardest_step(const tvi_trials *trials, double trial_step_size)
{
    const tvi_orbit_scout *s = &trials->scout;
    const double way =
        tvi_number_nearer_to_zero(abscissa_after_hardest_step(trials), s->resolving_step_size[s->hardest_step_index]);
    return tvi_trials_have_budget_for_steps(trials, TVI_STEPS_OF_TRIAL * ceil(fabs(way / trial_step_size)));
}
