/* suggest.c - Suggests the step size with which a run ends with the error that the user wants (tvi_suggest_step).
 *
 * The scout (scout.h) explores the orbit with few large steps. It finds the hardest step, where the orbit needs the
 * smallest steps, and the resolving step size there, with which a step has a given small tail (tvi_stats.tail). A trial
 * (trial.h) integrates a part of the run, with the hardest step if possible, and estimates the error of a run with its
 * step size h. The estimate for another step size h' is (h'/h)^order times as large. Trials are made until an estimate
 * is near the error that is aimed at, or until their budget of steps is used up. A trial of the whole run measures the
 * error itself, and no other step size is extrapolated from it.
 *
 * If the scout has explored most of the run, a companion orbit (step_doubling.h) measures how the error grows over that
 * part, since an unstable orbit makes the error much larger. Only the rest of the run is extrapolated. Errors usually
 * grow as t^a with the time t. If the growth in the second half of the explored part exceeds 2^a, this excess is
 * applied again for each further half of that length.
 *
 * Each passage of a pericentre adds an error that depends on where in the passage the steps lie. A trial sees one
 * sample of these errors. The samples differ more on orbits that need more different step sizes. Therefore the
 * suggested step size is divided by 1 + a multiple of log(r), with r the ratio of the largest to the smallest resolving
 * step size. */
#include "run/suggest.h"
#include "algebra/sizes.h"
#include "run/integrator.h"
#include "run/trial.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* In a rescaled system trials aim lower, since another passage of a pericentre may be worse than that in the trial.
 * Trials aim at this part of the wanted error. */
#define SUGGEST_AIM 0.08 /* found: make suggest */
/* Trials of rescaled systems aim at this part of the wanted error. */
#define SUGGEST_AIM_RESCALED 0.06 /* found: make suggest */
/* The factor of a trial is its step size divided by that of the trial before. The factor of the suggestion is the
 * suggested step size divided by that of the last trial. A trial after a failed one, or after one with a large error,
 * has this factor. */
#define SUGGEST_FAILED_FACTOR 0.88 /* found: make suggest */
/* A trial after a failed one has this factor in a rescaled system. */
#define SUGGEST_FAILED_FACTOR_RESCALED 0.7 /* found: make suggest */
/* The factor of the suggestion if no trial came near the aim. */
#define SUGGEST_UNKNOWN_FACTOR 0.8 /* found: make suggest */
/* The least factor of a trial; the largest is 1 / SUGGEST_MIN_FACTOR. */
#define SUGGEST_MIN_FACTOR 0.25 /* found: make suggest */
/* The aim divided by the error of a trial counts as at least this. */
#define SUGGEST_MIN_AIM_PER_ERROR 1e-3 /* found: make suggest */
/* The error of a trial is roundoff if SUGGEST_ROUNDOFF_DOUBT is above the distance of its orbits, and if a step size
 * that should reduce the error to the part SUGGEST_EXPECTED_DECREASE does not reduce it by the factor
 * SUGGEST_ROUNDOFF_DECREASE. A smaller distance of two orbits may be roundoff alone. */
#define SUGGEST_ROUNDOFF 1e-13 /* found: make suggest */
/* An error may be roundoff if the orbits' distance is below this. */
#define SUGGEST_ROUNDOFF_DOUBT 1e-10 /* found: make suggest */
/* An error that falls by less than this factor may be roundoff alone. */
#define SUGGEST_ROUNDOFF_DECREASE 3 /* found: make suggest */
/* A shorter step tests for roundoff if it should reduce errors to this part. */
#define SUGGEST_EXPECTED_DECREASE 0.01 /* found: make suggest */
/* The first trial supposes that a step that just resolves the orbit has the error SUGGEST_RESOLVED_ERROR tail^a, with a
 * = order / degree. */
#define SUGGEST_RESOLVED_ERROR 0.1 /* found: make suggest */
/* The first trial covers this part of the run. */
#define SUGGEST_COVERED_PART 0.05 /* found: make suggest */
/* The tail of a step is at most this many times SCOUT_RESOLVING_TAIL. */
#define SUGGEST_MAX_TAIL_RATIO 40.0 /* found: make suggest */
/* A step size is accepted if the error of the whole run is at most SUGGEST_MAX_ERROR times the wanted error. It is the
 * longest one if that error is at least SUGGEST_FULL_ERROR times the wanted one, or if a step that is
 * SUGGEST_LONGER_FACTOR times as long is not accepted. */
#define SUGGEST_MAX_ERROR     0.9  /* found: make suggest */
#define SUGGEST_FULL_ERROR    0.02 /* found: make suggest */
#define SUGGEST_LONGER_FACTOR 1.1  /* found: make suggest */
/* The suggested step size is divided by 1 + SUGGEST_SPREAD_WEIGHT log(r). r is the ratio of the largest to the smallest
 * resolving step size, but at most SUGGEST_MAX_SPREAD. */
#define SUGGEST_SPREAD_WEIGHT 0.15 /* found: make suggest */
#define SUGGEST_MAX_SPREAD    30.0 /* found: make suggest */
/* The roundoff of the time t of a run causes an error. To measure it, tvi_suggest_step compares a step from t with one
 * from t + shift. In a run this roundoff adds up to SUGGEST_TIME_BIAS sqrt(steps) units, of DBL_EPSILON t each. */
#define SUGGEST_TIME_BIAS 3.0 /* found: make suggest */
/* The error by the roundoff of t is measured if it may be more than this part of the wanted error. */
#define SUGGEST_TIME_DOUBT 0.01 /* found: make suggest */
/* [h] The shift of t, as a part of the duration of the step. */
#define SUGGEST_TIME_SHIFT 1e-3 /* found: make suggest */
/* [eps] The shift of t is at least this many times DBL_EPSILON t. */
#define SUGGEST_TIME_SHIFT_UNITS 4.0 /* found: make suggest */

/* The search for a step size: the trials so far, and what they show. */
typedef struct {
    tvi_trials trials;
    int order; /* the order of the method */
    /* The degree of the method's curve, at least 1; a double, since exponents are divided by it. */
    double curve_degree;
    double wanted_error, aimed_error; /* the error that the user wants, and the smaller one that trials aim at */
    double longest_allowed_step_size; /* no step size longer than this is tried or suggested */
    /* A step size whose trial had a large error, and this error. No trial of a shorter step has had an error below a
     * third of possible_roundoff_error. */
    double possible_roundoff_step_size, possible_roundoff_error;
    double roundoff_error; /* the error that shorter steps do not reduce; 0 if none was found */
    /* The longest step size with which a trial of the whole run had an error that is small enough
     * (SUGGEST_MAX_ERROR), and the shortest one with which a trial had a larger error; 0 if there is none. */
    double longest_good_step_size, shortest_bad_step_size;
    double error_of_longest_good_step_size; /* the error of the trial with longest_good_step_size */
    /* True if the suggestion rests on a trial that has passed the hardest step with an estimate near the aim. */
    bool is_suggestion_reliable;
} suggestion_search;

/* ---- All trials -------------------------------------------------------------------------------------------------- */

static double step_size_factor_after_failure(const suggestion_search *search)
{
    return search->trials.step_doubling.is_rescaled ? SUGGEST_FAILED_FACTOR_RESCALED : SUGGEST_FAILED_FACTOR;
}

/* Returns the step size of the next trial divided by the step size of the given trial. */
static double next_trial_step_size_factor(const suggestion_search *search, const tvi_step_size_trial *trial)
{
    if (trial->status != TVI_OK) return step_size_factor_after_failure(search);
    const double wrong = fmin(trial->estimated_error / search->trials.aimed_error, 1 / SUGGEST_MIN_AIM_PER_ERROR);
    return wrong > 0 ? tvi_clamp(SUGGEST_MIN_FACTOR, pow(wrong, -1.0 / search->order), 1 / SUGGEST_MIN_FACTOR)
                     : 1 / SUGGEST_MIN_FACTOR;
}

/* Returns the suggested step size divided by the step size of the given trial, if no other trial follows. */
static double final_step_size_factor(const suggestion_search *search, const tvi_step_size_trial *trial)
{
    return fmin(next_trial_step_size_factor(search, trial), pow(TRIAL_ERROR_BAND, 1.0 / search->order));
}

/* Records a trial whose error is above the aim although the distance of its orbits is so small that it may be
 * roundoff. The error is taken as roundoff if a step size that should reduce it to a hundredth does not reduce it. */
static void detect_roundoff_error(suggestion_search *search, const tvi_step_size_trial *trial)
{
    if (!tvi_trial_error_is_far_above_aim(&search->trials, trial) || trial->estimated_error == INFINITY ||
        fmax(trial->recent_orbit_distance, trial->previous_orbit_distance) > SUGGEST_ROUNDOFF_DOUBT)
        return;
    if (search->possible_roundoff_step_size == 0 ||
        trial->estimated_error < search->possible_roundoff_error / SUGGEST_ROUNDOFF_DECREASE)
        search->possible_roundoff_step_size = trial->h, search->possible_roundoff_error = trial->estimated_error;
    else if (pow(trial->h / search->possible_roundoff_step_size, search->order) < SUGGEST_EXPECTED_DECREASE)
        search->roundoff_error = fmin(trial->estimated_error, search->possible_roundoff_error);
}

/* Updates longest_good_step_size, shortest_bad_step_size and longest_allowed_step_size after a trial. */
static void update_step_size_bracket(suggestion_search *search, const tvi_step_size_trial *trial)
{
    const bool is_too_long = trial->is_finished && tvi_trial_error_is_far_above_aim(&search->trials, trial);
    if (trial->covers_whole_run && trial->estimated_error <= SUGGEST_MAX_ERROR * search->wanted_error) {
        if (fabs(trial->h) > fabs(search->longest_good_step_size))
            search->longest_good_step_size = trial->h, search->error_of_longest_good_step_size = trial->estimated_error;
    } else if (trial->covers_whole_run || is_too_long) {
        search->shortest_bad_step_size = search->shortest_bad_step_size == 0
                                             ? trial->h
                                             : tvi_number_nearer_to_zero(search->shortest_bad_step_size, trial->h);
    }
    if (trial->estimated_error == INFINITY)
        search->longest_allowed_step_size = tvi_number_nearer_to_zero(
            search->longest_allowed_step_size, step_size_factor_after_failure(search) * trial->h);
    else if (is_too_long)
        search->longest_allowed_step_size =
            tvi_number_nearer_to_zero(search->longest_allowed_step_size, SUGGEST_FAILED_FACTOR * trial->h);
}

/* Tells whether a trial of the whole run may find a longer step size than longest_good_step_size, and whether the
 * budget of steps allows the trial. *h is the step size to try; if it does not lie between longest_good_step_size and
 * shortest_bad_step_size, it is replaced by a value between them. */
static bool may_trial_find_longer_step(const suggestion_search *search, double *h)
{
    const bool has_worst = search->shortest_bad_step_size != 0;
    if (has_worst &&
        !(fabs(*h) > fabs(search->longest_good_step_size) && fabs(*h) < fabs(search->shortest_bad_step_size)))
        *h = copysign(sqrt(search->longest_good_step_size * search->shortest_bad_step_size),
                      search->longest_good_step_size);
    const bool is_found = search->error_of_longest_good_step_size >= SUGGEST_FULL_ERROR * search->wanted_error ||
                          fabs(search->longest_good_step_size) >= fabs(search->longest_allowed_step_size) ||
                          (has_worst && fabs(search->shortest_bad_step_size) <
                                            SUGGEST_LONGER_FACTOR * fabs(search->longest_good_step_size));
    return !is_found && tvi_trials_have_budget_for_steps(
                            &search->trials, TVI_STEPS_OF_TRIAL * ceil(fabs(search->trials.run_end_abscissa / *h)));
}

/* Tells whether the suggestion should follow this trial: the trial covers about as much of the run as the longest
 * trial, or it shows that its step size is too large. *is_near_aim is set if the trial's estimate is near the aim or
 * below. */
static bool is_trial_informative(const suggestion_search *search, const tvi_step_size_trial *trial, bool *is_near_aim)
{
    const tvi_trials *trials = &search->trials;
    *is_near_aim =
        trial->has_passed_hardest_step && !trial->covers_whole_run && !tvi_trial_error_is_far_above_aim(trials, trial);
    const bool is_long = trial->has_passed_hardest_step &&
                         trial->run_error_fraction >= TRIAL_EQUAL_LENGTH * trials->largest_error_fraction;
    return is_long || trial->covers_whole_run ||
           (trial->is_finished && tvi_trial_error_is_above(trials, trial, trials->aimed_error));
}

/* Updates the suggestion after a trial. Returns true if another trial is to follow, and sets *h to the step size of
 * that trial. */
static bool update_suggestion(suggestion_search *search, const tvi_step_size_trial *trial, double *h,
                              tvi_step_suggestion *suggestion)
{
    tvi_trials *trials = &search->trials;
    const bool failed = trial->estimated_error == INFINITY, is_low = tvi_trial_error_is_far_below_aim(trials, trial),
               is_high = tvi_trial_error_is_far_above_aim(trials, trial);
    bool is_near_aim;
    const bool is_new = is_trial_informative(search, trial, &is_near_aim);
    const double factor = is_new ? next_trial_step_size_factor(search, trial) : 1;
    if (is_new)
        suggestion->h = trial->h * final_step_size_factor(search, trial), search->is_suggestion_reliable = is_near_aim;
    else if (!search->is_suggestion_reliable)
        suggestion->h = suggestion->h == 0 ? trial->h : tvi_number_nearer_to_zero(suggestion->h, trial->h);
    if (!failed && (is_new || !search->is_suggestion_reliable))
        suggestion->trial_step_size = trial->h, suggestion->run_error_fraction = trial->run_error_fraction,
        suggestion->estimated_error = trial->estimated_error;
    if (!failed)
        suggestion->explored_fraction = fmax(suggestion->explored_fraction, trial->duration_fraction_done),
        trials->largest_error_fraction = fmax(trials->largest_error_fraction, trial->run_error_fraction);
    detect_roundoff_error(search, trial);
    update_step_size_bracket(search, trial);
    /* If the budget is used up, the steps that are reserved for the companion are released for another trial. */
    if (!tvi_trials_can_continue_trial(trials) && (is_low || is_high)) trials->reserved_step_count = 0;
    *h = tvi_number_nearer_to_zero(trial->h * factor, search->longest_allowed_step_size);
    trials->run_length_in_steps *= trial->h / *h;
    if (search->longest_good_step_size != 0) return may_trial_find_longer_step(search, h);
    const bool is_last = search->roundoff_error > 0 || !(failed || is_low || is_high || trial->is_finished);
    return !is_last && tvi_trials_can_continue_trial(trials) &&
           (!search->is_suggestion_reliable || tvi_trials_can_pass_hardest_step(trials, *h)) &&
           fabs(*h) > DBL_EPSILON * fabs(trials->duration);
}

/* Corrects the error estimate of the last trial by the growth of errors that the companion measures
 * (step_doubling.h). */
static void scale_error_by_growth(suggestion_search *search, tvi_step_size_trial *trial,
                                  tvi_step_suggestion *suggestion)
{
    tvi_trials *trials = &search->trials;
    if (trials->reserved_step_count == 0 || suggestion->trial_step_size != trial->h ||
        trial->estimated_error == INFINITY)
        return;
    double growth;
    const double trial_distance = trials->step_doubling.orbit_distance, part = trials->scout.explored_fraction;
    const double error_ratio = tvi_step_doubling_error_ratio(&trials->step_doubling, &trials->scout,
                                                             trials->start_abscissa, trial->end_abscissa, &growth);
    if (error_ratio == 0) return;
    /* `growth` compares the second half of the explored part with its first half; `halves` is the number of further
     * halves in the unexplored rest. */
    const double more = fmax(growth / pow(2, trials->error_growth_exponent), 1), halves = 2 * (1 / part - 1);
    suggestion->estimated_error = trial->estimated_error =
        trial_distance * error_ratio * pow(part, -trials->error_growth_exponent) * pow(more, halves);
    suggestion->h = trial->h * final_step_size_factor(search, trial);
}

/* ---- Before and after the trials --------------------------------------------------------------------------------- */

/* Sets the numbers that all trials share (tvi_trials) from the results of the scout. Returns the step size of the first
 * trial. */
static double prepare_trials(suggestion_search *search)
{
    tvi_trials *trials = &search->trials;
    const tvi_orbit_scout *s = &trials->scout;
    const double scale = s->resolving_step_size[s->hardest_step_index], end = s->state_abscissas[s->step_count];
    const double resolved_error =
        SUGGEST_RESOLVED_ERROR * pow(SCOUT_RESOLVING_TAIL, search->order / search->curve_degree);
    trials->step_doubling.tried_step_count = s->tried_step_count;
    trials->step_doubling.largest_q = s->largest_q, trials->step_doubling.largest_p = s->largest_p;
    trials->run_end_abscissa = end / s->explored_fraction;
    trials->run_weighted_length = tvi_scout_weighted_length(s, 0, end) / s->explored_fraction;
    search->longest_allowed_step_size = scale * pow(SUGGEST_MAX_TAIL_RATIO, 1 / search->curve_degree);
    if (!trials->step_doubling.is_rescaled)
        search->longest_allowed_step_size =
            tvi_number_nearer_to_zero(search->longest_allowed_step_size, trials->duration);
    const double part = pow(SUGGEST_COVERED_PART, trials->error_growth_exponent);
    const double h =
        tvi_number_nearer_to_zero(scale * pow(trials->aimed_error * part / resolved_error, 1.0 / (search->order + 1)),
                                  search->longest_allowed_step_size);
    trials->run_length_in_steps = fabs(trials->run_end_abscissa / h);
    return h;
}

/* Estimates the error that the roundoff of the time causes, in a system whose equations depend on the time. Each step
 * rounds the time anew, and the effects add up at random. If these effects may be large, one step at a shifted time
 * measures them. */
static tvi_status measure_error_by_time_roundoff(suggestion_search *search)
{
    tvi_trials *trials = &search->trials;
    const tvi_orbit_scout *s = &trials->scout;
    const double *const state = tvi_scout_state(s, s->hardest_step_index);
    const double *const next = state + 2 * s->n + 1;
    const double dt = fabs(next[2 * s->n] - state[2 * s->n]),
                 h = s->state_abscissas[s->hardest_step_index + 1] - s->state_abscissas[s->hardest_step_index];
    const double last = fmax(fabs(trials->start_time), fabs(trials->start_time + trials->duration)),
                 ulp = DBL_EPSILON * last;
    const double often = SUGGEST_TIME_BIAS * sqrt(fmax(fabs(trials->run_end_abscissa / h), 1)),
                 shift = fmax(SUGGEST_TIME_SHIFT * dt, SUGGEST_TIME_SHIFT_UNITS * ulp);
    double apart;
    if (!trials->step_doubling.full_step_orbit.integrator->system->uses_time ||
        often * ulp < SUGGEST_TIME_DOUBT * search->wanted_error * dt)
        return TVI_OK;
    const tvi_status status = tvi_measure_time_shift_distance(&trials->step_doubling, state, h, shift, &apart);
    if (status != TVI_OK) return status;
    const double time_roundoff_error = often * apart / shift * ulp / 2;
    if (time_roundoff_error > search->wanted_error)
        return jet_refuse(TVI_EINVAL, "error = %g is below what the roundoff of t = %g makes of such a run, about %.0e",
                          search->wanted_error, last, time_roundoff_error);
    trials->aimed_error = fmax(trials->aimed_error, time_roundoff_error);
    trials->largest_roundoff_distance = fmax(trials->largest_roundoff_distance, apart / shift * ulp);
    return TVI_OK;
}

static double step_size_spread_divisor(const suggestion_search *search)
{
    const tvi_orbit_scout *s = &search->trials.scout;
    double shortest = INFINITY, longest = 0;
    for (int k = 0; k < s->step_count; k++)
        shortest = fmin(shortest, fabs(s->resolving_step_size[k])),
        longest = fmax(longest, fabs(s->resolving_step_size[k]));
    return 1 + SUGGEST_SPREAD_WEIGHT * log(fmin(longest / shortest, SUGGEST_MAX_SPREAD));
}

/* Computes the final step size from the results of all trials. */
static void complete_suggestion(suggestion_search *search, tvi_step_suggestion *suggestion)
{
    const double of_aim = pow(search->aimed_error / search->trials.aimed_error, 1.0 / search->order),
                 unknown = search->is_suggestion_reliable ? 1 : SUGGEST_UNKNOWN_FACTOR;
    suggestion->h = tvi_number_nearer_to_zero(suggestion->h * of_aim, search->longest_allowed_step_size) * unknown /
                    step_size_spread_divisor(search);
    if (search->longest_good_step_size != 0)
        suggestion->h = suggestion->trial_step_size = search->longest_good_step_size,
        suggestion->run_error_fraction = 1, suggestion->estimated_error = search->error_of_longest_good_step_size;
    if (suggestion->explored_fraction > 1 - TRIAL_END) suggestion->explored_fraction = 1;
}

static tvi_status search_step_size(suggestion_search *search, tvi_step_suggestion *suggestion)
{
    tvi_trials *trials = &search->trials;
    tvi_step_size_trial trial;
    tvi_status status =
        tvi_scout_explore_orbit(&trials->scout, &trials->step_doubling.full_step_orbit, trials->duration);
    if (status != TVI_OK) return status;
    double h = prepare_trials(search);
    status = measure_error_by_time_roundoff(search);
    if (status != TVI_OK) return status;
    suggestion->explored_fraction = trials->scout.is_degree_too_low_for_tail ? 0 : trials->scout.explored_fraction;
    do trial = tvi_make_step_size_trial(trials, h);
    while (trial.status != TVI_ENOMEM && update_suggestion(search, &trial, &h, suggestion));
    scale_error_by_growth(search, &trial, suggestion);
    suggestion->step_count_spent_on_search = trials->step_doubling.tried_step_count;
    if (trial.status == TVI_ENOMEM || trials->step_doubling.has_exhausted_memory)
        return jet_explain_out_of_memory(TVI_ENOMEM);
    if (search->roundoff_error > 0)
        return jet_refuse(TVI_EINVAL, "error = %g is below roundoff, which makes about %.0e of such a run",
                          search->wanted_error, search->roundoff_error);
    complete_suggestion(search, suggestion);
    if (suggestion->trial_step_size != 0) return TVI_OK;
    return trial.status != TVI_OK ? trial.status : jet_refuse(TVI_ENOCONV, "no step was found that is right");
}

/* ---- The functions ----------------------------------------------------------------------------------------------- */

static tvi_status open_suggestion_search(suggestion_search *search, const tvi_system *system,
                                         const tvi_options *options)
{
    tvi_trials *trials = &search->trials;
    const tvi_status status = tvi_step_doubling_open(&trials->step_doubling, system, options);
    if (status != TVI_OK) return status;
    const tvi_options *resolved = &trials->step_doubling.full_step_orbit.integrator->options;
    search->order = resolved->order;
    search->curve_degree = fmax(1, resolved->degree);
    search->aimed_error =
        (trials->step_doubling.is_rescaled ? SUGGEST_AIM_RESCALED : SUGGEST_AIM) * search->wanted_error;
    trials->is_driven = system->is_driven;
    trials->error_growth_exponent =
        trials->step_doubling.is_rescaled ? TRIAL_GROWTH_EXPONENT_RESCALED : TRIAL_GROWTH_EXPONENT;
    trials->largest_roundoff_distance = SUGGEST_ROUNDOFF;
    trials->aimed_error = fmax(search->aimed_error, SUGGEST_ROUNDOFF * pow(TVI_STEPS_OF_TRIAL / TRIALS_PART_OF_RUN,
                                                                           trials->error_growth_exponent));
    trials->scout = (tvi_orbit_scout){.n = system->n, .explored_states = trials->step_doubling.memory_of_scout_states};
    return TVI_OK;
}

tvi_status tvi_compute_step_suggestion(const tvi_system *system, const tvi_options *options, double t, const double q[],
                                       const double p[], double duration, double wanted_error,
                                       tvi_step_suggestion *suggestion)
{
    suggestion_search search = {.trials = {.start_time = t, .duration = duration}, .wanted_error = wanted_error};
    tvi_step_doubling *pair = &search.trials.step_doubling;
    *suggestion = (tvi_step_suggestion){0};
    tvi_status status = open_suggestion_search(&search, system, options);
    if (status == TVI_OK) status = tvi_refuse_nonfinite_state(system->n, t, q, "p", p);
    if (status == TVI_OK) {
        pair->full_step_orbit.t = t;
        memcpy(pair->full_step_orbit.q, q, (size_t)system->n * sizeof *q);
        memcpy(pair->full_step_orbit.p, p, (size_t)system->n * sizeof *p);
        status = search_step_size(&search, suggestion);
    }
    tvi_step_doubling_close(pair);
    return status;
}

tvi_status tvi_suggest_step_seen(const tvi_system *system, const tvi_options *options, double t, const double q[],
                                 const double p[], double duration, double wanted_error, double *h, double *seen)
{
    static const char *const name[] = {"system", "q", "p", "h", "seen"};
    const void *const pointer[] = {system, q, p, h, seen};
    tvi_step_suggestion found;
    if (!system || !q || !p || !h || !seen) return tvi_refuse_first_null_pointer(5, pointer, name);
    if (duration == 0 || !isfinite(duration))
        return jet_refuse(TVI_EINVAL, "duration = %g is 0 or not finite", duration);
    if (isfinite(t) && !(fabs(duration) > TRIALS_MIN_STEPS * DBL_EPSILON * fabs(t)))
        return jet_refuse(TVI_EINVAL, "duration = %g is roundoff of t = %g", duration, t);
    if (!(wanted_error >= DBL_EPSILON && wanted_error < 1))
        return jet_refuse(TVI_EINVAL, "error = %g is below DBL_EPSILON or not below 1", wanted_error);
    const tvi_status status = tvi_compute_step_suggestion(system, options, t, q, p, duration, wanted_error, &found);
    if (status == TVI_OK) *h = found.h, *seen = found.explored_fraction;
    return status;
}

tvi_status tvi_suggest_step(const tvi_system *system, const tvi_options *options, double t, const double q[],
                            const double p[], double duration, double wanted_error, double *h)
{
    double seen;
    return tvi_suggest_step_seen(system, options, t, q, p, duration, wanted_error, h, &seen);
}
