/* trial.c - a trial: two orbits from the start, or from the hardest place where that comes late, one of steps h and one
 * of steps h/2 (pair.h). Their distance e, relative to the largest coordinate and the largest momentum, is the error of
 * the first one but for a part 2^-order. Where the part x of the run's error is made behind it, the error at the end is
 * said to be e x^-a. The error of a symplectic method on a regular orbit grows linearly, a = 1, that of another method
 * at most by the square; a = 5/4 suits the scenes of the bench, 1.1 those that are rescaled. With a drive, under which
 * errors may die out, a is measured, and at most that.
 *
 * A trial goes on while it says about what is aimed at, and while the cost allows. */
#include "run/trial.h"
#include "algebra/sizes.h"
#include "run/integrator.h"

/* Errors of a trial above it are of no order. */
static const double CEILING = 0.05;
static const double GROWTH = 1.25;
enum { GROWTH_STEPS = 8, GROWTH_EVERY = 4 }; /* before it is measured, and where */
/* So few steps of a trial, and they say too much, too early. */
enum { EARLY_STEPS = 4 };
/* Where less than this part of the trial steps that are left leads past the hardest place, they begin at the start. */
static const double EARLY_PART = 0.6;
/* The scout saw most of a run where it saw this part of it. */
static const double SEEN = 0.5;

static double within(double least, double x, double most) { return fmin(fmax(x, least), most); }
static bool is_power_of_two(long k) { return (k & (k - 1)) == 0; }

/* What the k-th distance says. */
static void hear(tvi_trials *w, tvi_trial *r, long k, double e)
{
    if (k > 1 && is_power_of_two(k - 1)) r->before = r->now, r->now = 0;
    r->now = fmax(r->now, e);
    if (w->is_driven && k >= GROWTH_STEPS && k % GROWTH_EVERY == 0 && r->before > 0)
        w->growth = within(0, log2(r->now / r->before), GROWTH);
    r->error = e < CEILING ? fmax(r->now, r->before) * pow(r->part, -w->growth) : INFINITY;
}

/* The place behind the hardest one. */
static double passed(const tvi_trials *w)
{
    const tvi_scout *s = &w->scout;
    return tvi_shorter(s->place[s->hardest] + s->scale[s->hardest], w->way);
}

/* Whether the trial has nothing more to say after k steps. */
static bool is_over(const tvi_trials *w, const tvi_trial *r, long k)
{
    const bool is_early = k < EARLY_STEPS && fmax(r->now, r->before) < TVI_TRIAL_BAND * w->aim;
    if (r->error == INFINITY || (tvi_trial_is_high(w, r) && !is_early)) return true;
    return tvi_trial_is_low(w, r) && r->has_passed && is_power_of_two(k) && r->part > w->longest;
}

/* The k-th step of it. */
static bool go_on(tvi_trials *w, tvi_trial *r, long k)
{
    const tvi_orbit *whole = &w->pair.whole;
    r->status =
        tvi_pair_advance(&w->pair, w->pair.is_rescaled ? r->h : tvi_shorter(r->h, w->t + w->duration - whole->t));
    r->error = INFINITY;
    r->is_over = true;
    if (r->status != TVI_OK) return false;
    w->run = fabs(w->way / r->h);
    r->place = w->from + (double)k * r->h;
    r->seen = (whole->t - w->t) / w->duration;
    r->part = fmin(tvi_scout_weight(&w->scout, w->from, r->place) / w->weight, 1);
    r->has_passed = fabs(r->place) >= fabs(passed(w));
    hear(w, r, k, tvi_pair_distance(&w->pair));
    const bool is_at_end = r->seen >= 1 - 1e-9;
    r->is_complete = is_at_end && w->from == 0;
    r->is_over = is_at_end || is_over(w, r, k);
    return !r->is_over;
}

/* Where a trial is too short to count without it. */
static bool takes_what_is_kept(tvi_trials *w, const tvi_trial *r)
{
    const bool takes = w->kept > 0 && r->part < TVI_AS_LONG * w->longest;
    if (takes) w->kept = 0;
    return takes && tvi_trials_may_go_on(w);
}

/* Where it begins: at the start, or at the hardest place where that is late; earlier where it would come to the end of
 * the run, as long as it passes the hardest place. */
static void choose_start(tvi_trials *w, double h)
{
    const tvi_scout *s = &w->scout;
    const double end = passed(w), steps = (tvi_trials_most(w) - (double)w->pair.made) / TVI_STEPS_OF_TRIAL;
    const double early = EARLY_PART * steps * fabs(h);
    int first = fabs(end) > early ? s->hardest : 0;
    while (first > 0 && fabs(w->way - s->place[first]) < steps * fabs(h) && fabs(end - s->place[first - 1]) <= early)
        first--;
    w->from = s->place[first];
    w->state = s->states + (size_t)first * (size_t)(2 * s->n + 1);
    w->kept = s->part >= SEEN ? s->count - first - 1 : 0;
}

tvi_trial tvi_trial_make(tvi_trials *w, double h)
{
    tvi_trial r = {.h = h, .error = INFINITY};
    choose_start(w, h);
    tvi_pair_begin(&w->pair, w->state);
    for (long k = 1; (tvi_trials_may_go_on(w) || takes_what_is_kept(w, &r)) && go_on(w, &r, k); k++) continue;
    return r;
}

bool tvi_trials_may_pass(const tvi_trials *w, double h)
{
    const tvi_scout *s = &w->scout;
    const double way = tvi_shorter(passed(w), s->scale[s->hardest]);
    return tvi_trials_may_make(w, TVI_STEPS_OF_TRIAL * ceil(fabs(way / h)));
}
