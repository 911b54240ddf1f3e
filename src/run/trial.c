/* trial.c - Makes a trial of a step size for suggest.c, by two orbits with steps h and h/2 (step_doubling.h). They
 * start where the run does, or at the hardest position if that comes late. Their distance e, relative to the largest
 * coordinate and the largest momentum, is the error of the first orbit up to a part 2^-order. If the trial covers the
 * part x of the run's error, the estimate at the end is e x^-a. The error of a symplectic method on a regular orbit
 * grows linearly, a = 1, and that of another method at most quadratically. a = 5/4 suits the scenes of the bench, 1.1
 * rescaled ones. With a drive, under which errors may decay, a is measured, and at most 5/4.
 *
 * A trial goes on as long as its estimate is near the aim, and the cost allows. */
#include "run/trial.h"
#include "algebra/sizes.h"
#include "run/integrator.h"

/* Errors of a trial above CEILING have no order. */
static const double CEILING = 0.05;
static const double GROWTH = 1.25;
/* The number of steps before the growth is measured, and how often it is. */
enum { GROWTH_STEPS = 8, GROWTH_EVERY = 4 };
/* Before this number of steps a trial is not ended for a large estimate. */
enum { EARLY_STEPS = 4 };
/* A trial begins at the start of the run if less than this part of its steps leads past the hardest position. */
static const double EARLY_PART = 0.6;
/* The scout saw most of a run if it saw this part of it. */
static const double SEEN = 0.5;

static double within(double least, double x, double most) { return fmin(fmax(x, least), most); }
static bool is_power_of_two(long k) { return (k & (k - 1)) == 0; }

/* Updates the estimate by the distance e after the k-th step. */
static void record_distance(tvi_trials *w, tvi_trial *r, long k, double e)
{
    if (k > 1 && is_power_of_two(k - 1)) r->previous = r->recent, r->recent = 0;
    r->recent = fmax(r->recent, e);
    if (w->is_driven && k >= GROWTH_STEPS && k % GROWTH_EVERY == 0 && r->previous > 0)
        w->growth = within(0, log2(r->recent / r->previous), GROWTH);
    r->error = e < CEILING ? fmax(r->recent, r->previous) * pow(r->part, -w->growth) : INFINITY;
}

/* The position just after the hardest one. */
static double passage_end(const tvi_trials *w)
{
    const tvi_scout *s = &w->scout;
    return tvi_shorter(s->position[s->hardest] + s->scale[s->hardest], w->way);
}

/* Tells whether the trial is finished after k steps. */
static bool is_over(const tvi_trials *w, const tvi_trial *r, long k)
{
    const bool is_early = k < EARLY_STEPS && fmax(r->recent, r->previous) < TVI_TRIAL_BAND * w->aim;
    if (r->error == INFINITY || (tvi_trial_error_is_high(w, r) && !is_early)) return true;
    return tvi_trial_is_low(w, r) && r->has_passed && is_power_of_two(k) && r->part > w->longest;
}

/* Makes the k-th step of the trial. Returns whether the trial goes on. */
static bool make_trial_step(tvi_trials *w, tvi_trial *r, long k)
{
    const tvi_scout_orbit *whole = &w->pair.full;
    r->status = tvi_step_doubling_advance(
        &w->pair, w->pair.is_rescaled ? r->h : tvi_shorter(r->h, w->t + w->duration - whole->t));
    r->error = INFINITY;
    r->is_over = true;
    if (r->status != TVI_OK) return false;
    w->run = fabs(w->way / r->h);
    r->end_position = w->start_position + (double)k * r->h;
    r->seen = (whole->t - w->t) / w->duration;
    r->part = fmin(tvi_scout_weight(&w->scout, w->start_position, r->end_position) / w->weight, 1);
    r->has_passed = fabs(r->end_position) >= fabs(passage_end(w));
    record_distance(w, r, k, tvi_step_doubling_distance(&w->pair));
    const bool is_at_end = r->seen >= 1 - 1e-9;
    r->is_complete = is_at_end && w->start_position == 0;
    r->is_over = is_at_end || is_over(w, r, k);
    return !r->is_over;
}

/* Releases the companion's steps to the trial, if it is too short to count without them. Returns whether it may go
 * on. */
static bool release_reserve(tvi_trials *w, const tvi_trial *r)
{
    const bool takes = w->reserve > 0 && r->part < TVI_EQUALLY_LONG * w->longest;
    if (takes) w->reserve = 0;
    return takes && tvi_trials_allow_step(w);
}

/* Chooses where the trial begins: at the start, or at the hardest position if that is late. It begins earlier if it
 * would reach the end of the run, as long as it passes the hardest position. */
static void choose_start(tvi_trials *w, double h)
{
    const tvi_scout *s = &w->scout;
    const double end = passage_end(w), steps = (tvi_trials_most(w) - (double)w->pair.steps_tried) / TVI_STEPS_OF_TRIAL;
    const double early = EARLY_PART * steps * fabs(h);
    int first = fabs(end) > early ? s->hardest : 0;
    while (first > 0 && fabs(w->way - s->position[first]) < steps * fabs(h) &&
           fabs(end - s->position[first - 1]) <= early)
        first--;
    w->start_position = s->position[first];
    w->state = s->states + (size_t)first * (size_t)(2 * s->n + 1);
    w->reserve = s->part >= SEEN ? s->count - first - 1 : 0;
}

tvi_trial tvi_trial_make(tvi_trials *w, double h)
{
    tvi_trial r = {.h = h, .error = INFINITY};
    choose_start(w, h);
    tvi_step_doubling_begin(&w->pair, w->state);
    for (long k = 1; (tvi_trials_allow_step(w) || release_reserve(w, &r)) && make_trial_step(w, &r, k); k++) continue;
    return r;
}

bool tvi_trials_allow_passage(const tvi_trials *w, double h)
{
    const tvi_scout *s = &w->scout;
    const double way = tvi_shorter(passage_end(w), s->scale[s->hardest]);
    return tvi_trials_allow(w, TVI_STEPS_OF_TRIAL * ceil(fabs(way / h)));
}
