/* suggest.c - Suggests the step size for a wanted error at the end of a run. It explores the orbit, and makes trials
 * where the orbit is hardest.
 *
 * The scout (scout.h) finds where the orbit is hardest, and which step just resolves it there. A trial (trial.h)
 * estimates the error of a run with its h. For another step h' the estimate is (h'/h)^order times as large. Trials
 * follow one another until an estimate is near the aim, or the cost is used up. A trial that does not reach the hardest
 * position says nothing of it. A trial of the whole run measures the error itself, and no other h is then extrapolated
 * from it.
 *
 * If the scout saw most of the run, a companion measures how the error grows over that part, and only the rest is
 * extrapolated: an unstable orbit makes the error much larger. If the growth in the second half of what the scout saw
 * exceeds 2^a, this excess is applied again for each further half of that length.
 *
 * A passage of a pericentre adds an error that depends on where in it the steps lie. The errors add up if each passage
 * is hit alike. An end where the motion is fast shows the error more than one where it is slow. Trials see one sample
 * of these errors. Samples differ more on orbits whose scales differ more, so h is divided by a logarithm of that
 * ratio. */
#include "run/suggest.h"
#include "algebra/sizes.h"
#include "run/integrator.h"
#include "run/trial.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The error that trials aim at, as a part of the wanted one. For a rescaled system it is AIM_LATER, since another
 * passage may be worse. */
static const double AIM = 0.08, AIM_LATER = 0.06;
/* Below FLOOR a trial cannot tell an error from roundoff. */
static const double FLOOR = 1e-13;
/* Errors below TINY may be roundoff. */
static const double TINY = 1e-10;
static const double GROWTH = 1.25, GROWTH_LATER = 1.1;
/* Factors of h: after a step that fails or a large error, and the same for a rescaled system, another passage of which
 * may be worse; at least elsewhere; for an error that has no order; and at the end, if no estimate was near the aim. */
static const double FAILS = 0.88, FAILS_LATER = 0.7, LEAST_FACTOR = 0.25, OF_NO_ORDER = 1e-3, UNKNOWN = 0.8;
/* The first h is chosen as follows. A step that just resolves the orbit makes the error RESOLVED times its tail to the
 * power order / degree, and a trial covers the part KNOWN of the run. No h is longer than a step with MOST_TAILS times
 * the scout's tail. */
static const double RESOLVED = 0.1, KNOWN = 0.05, MOST_TAILS = 40;
/* A trial of the whole run shows that h serves if its error is at most KEPT of the wanted one. h is about the longest
 * if the error is at least FULL of it, or if NEARLY times as long a step does not serve. */
static const double KEPT = 0.9, FULL = 0.02, NEARLY = 1.1;
/* The factor of the logarithm of the ratio of scales, and the largest ratio that counts. */
static const double DRAWS = 0.15, MOST_DRAWS = 30;
/* The roundoff of the time is measured if it may make the part DOUBT of the wanted error. It is measured with a shift
 * of the time by SHIFT of a step, or by SHIFTS times its roundoff, and counts TIMES as often. */
static const double DOUBT = 0.01, SHIFT = 1e-3, SHIFTS = 4, TIMES = 3;

typedef struct {
    tvi_trials trials;
    int order;
    double degree;
    double wanted, aim; /* errors */
    double limit;       /* the longest h */
    /* An h whose trial had a large error, and this error. No shorter h had an error below a third of it. */
    double high, error_of_high;
    double roundoff; /* the error that no shorter h reduces; 0: none */
    /* The longest h that a trial of the whole run shows to serve, and the shortest that one shows not to serve; 0:
     * none. */
    double best, worst;
    double error_of_best;
    /* h comes from a trial that passed the hardest position, with an estimate near the aim. */
    bool is_known;
} search;

/* ---- All trials -------------------------------------------------------------------------------------------------- */

static double within(double least, double x, double most) { return fmin(fmax(x, least), most); }
static double fails(const search *w) { return w->trials.pair.is_rescaled ? FAILS_LATER : FAILS; }

/* The factor of h that the trial asks for. */
static double correction(const search *w, const tvi_trial *r)
{
    if (r->status != TVI_OK) return fails(w);
    const double wrong = fmin(r->error / w->trials.aim, 1 / OF_NO_ORDER);
    return wrong > 0 ? within(LEAST_FACTOR, pow(wrong, -1.0 / w->order), 1 / LEAST_FACTOR) : 1 / LEAST_FACTOR;
}

/* The factor for the suggestion, if no other trial follows. */
static double extrapolation(const search *w, const tvi_trial *r)
{
    return fmin(correction(w, r), pow(TVI_TRIAL_BAND, 1.0 / w->order));
}

/* Records an error that is too large and yet tiny. It is roundoff if it stays as large with an h that should make it a
 * hundredth. */
static void detect_roundoff(search *w, const tvi_trial *r)
{
    if (!tvi_trial_error_is_high(&w->trials, r) || r->error == INFINITY || fmax(r->recent, r->previous) > TINY) return;
    if (w->high == 0 || r->error < w->error_of_high / 3) w->high = r->h, w->error_of_high = r->error;
    else if (pow(r->h / w->high, w->order) < 0.01) w->roundoff = fmin(r->error, w->error_of_high);
}

/* Updates the longest h that serves, and the shortest that does not. */
static void bracket(search *w, const tvi_trial *r)
{
    const bool is_too_long = r->is_over && tvi_trial_error_is_high(&w->trials, r);
    if (r->is_complete && r->error <= KEPT * w->wanted) {
        if (fabs(r->h) > fabs(w->best)) w->best = r->h, w->error_of_best = r->error;
    } else if (r->is_complete || is_too_long) {
        w->worst = w->worst == 0 ? r->h : tvi_shorter(w->worst, r->h);
    }
    if (r->error == INFINITY) w->limit = tvi_shorter(w->limit, fails(w) * r->h);
    else if (is_too_long) w->limit = tvi_shorter(w->limit, FAILS * r->h);
}

/* Tells whether a trial of the whole run may find a longer h than the best one. It uses *h, or an h between best and
 * worst. */
static bool may_find_longer(const search *w, double *h)
{
    const bool has_worst = w->worst != 0;
    if (has_worst && !(fabs(*h) > fabs(w->best) && fabs(*h) < fabs(w->worst)))
        *h = copysign(sqrt(w->best * w->worst), w->best);
    const bool is_found = w->error_of_best >= FULL * w->wanted || fabs(w->best) >= fabs(w->limit) ||
                          (has_worst && fabs(w->worst) < NEARLY * fabs(w->best));
    return !is_found && tvi_trials_allow(&w->trials, TVI_STEPS_OF_TRIAL * ceil(fabs(w->trials.way / *h)));
}

/* Tells whether the trial counts: it is near the aim and covers more of the run than others, or shows that its h is too
 * long. */
static bool is_informative(const search *w, const tvi_trial *r, bool *knows)
{
    const tvi_trials *trials = &w->trials;
    *knows = r->has_passed && !r->is_complete && !tvi_trial_error_is_high(trials, r);
    const bool is_long = r->has_passed && r->part >= TVI_EQUALLY_LONG * trials->longest;
    return is_long || r->is_complete || (r->is_over && tvi_trial_is_above(trials, r, trials->aim));
}

/* Updates the suggestion from a trial. Returns whether another one follows, with *h. */
static bool update(search *w, const tvi_trial *r, double *h, tvi_suggestion *out)
{
    tvi_trials *trials = &w->trials;
    const bool failed = r->error == INFINITY, is_low = tvi_trial_is_low(trials, r),
               is_high = tvi_trial_error_is_high(trials, r);
    bool knows;
    const bool is_new = is_informative(w, r, &knows);
    const double factor = is_new ? correction(w, r) : 1;
    if (is_new) out->h = r->h * extrapolation(w, r), w->is_known = knows;
    else if (!w->is_known) out->h = out->h == 0 ? r->h : tvi_shorter(out->h, r->h);
    if (!failed && (is_new || !w->is_known)) out->tried = r->h, out->reached = r->part, out->error = r->error;
    if (!failed) out->seen = fmax(out->seen, r->seen), trials->longest = fmax(trials->longest, r->part);
    detect_roundoff(w, r);
    bracket(w, r);
    if (!tvi_trials_allow_step(trials) && (is_low || is_high))
        trials->reserve = 0; /* leaves the steps to another trial */
    *h = tvi_shorter(r->h * factor, w->limit);
    trials->run *= r->h / *h;
    if (w->best != 0) return may_find_longer(w, h);
    const bool is_last = w->roundoff > 0 || !(failed || is_low || is_high || r->is_over);
    return !is_last && tvi_trials_allow_step(trials) && (!w->is_known || tvi_trials_allow_passage(trials, *h)) &&
           fabs(*h) > DBL_EPSILON * fabs(trials->duration);
}

/* Corrects the estimate of the last trial by the growth of errors that the companion measures. */
static void correct(search *w, tvi_trial *r, tvi_suggestion *out)
{
    tvi_trials *trials = &w->trials;
    if (trials->reserve == 0 || out->tried != r->h || r->error == INFINITY) return;
    double growth;
    const double error = trials->pair.distance, part = trials->scout.part;
    const double growth_factor =
        tvi_step_doubling_growth(&trials->pair, &trials->scout, trials->start_position, r->end_position, &growth);
    if (growth_factor == 0) return;
    /* the scout saw two halves */
    const double more = fmax(growth / pow(2, trials->growth), 1), halves = 2 * (1 / part - 1);
    out->error = r->error = error * growth_factor * pow(part, -trials->growth) * pow(more, halves);
    out->h = r->h * extrapolation(w, r);
}

/* ---- Before and after them --------------------------------------------------------------------------------------- */

/* Sets up the trials from what the scout saw. Returns the first h. */
static double prepare(search *w)
{
    tvi_trials *trials = &w->trials;
    const tvi_scout *s = &trials->scout;
    const double scale = s->scale[s->hardest], end = s->position[s->count];
    const double error = RESOLVED * pow(TVI_SCOUT_TAIL, w->order / w->degree);
    trials->pair.steps_tried = s->steps_tried;
    trials->pair.size_q = s->size_q, trials->pair.size_p = s->size_p;
    trials->way = end / s->part;
    trials->weight = tvi_scout_weight(s, 0, end) / s->part;
    w->limit = scale * pow(MOST_TAILS, 1 / w->degree);
    if (!trials->pair.is_rescaled) w->limit = tvi_shorter(w->limit, trials->duration);
    const double part = pow(KNOWN, trials->growth);
    const double h = tvi_shorter(scale * pow(trials->aim * part / error, 1.0 / (w->order + 1)), w->limit);
    trials->run = fabs(trials->way / h);
    return h;
}

/* Estimates the error from the roundoff of the time, in equations that depend on it. Each step rounds the time anew,
 * and the errors add up at random. If they may be large, one step at a shifted time measures them. */
static tvi_status measure_time_roundoff(search *w)
{
    tvi_trials *trials = &w->trials;
    const tvi_scout *s = &trials->scout;
    const double *const state = s->states + (size_t)s->hardest * (size_t)(2 * s->n + 1), *const next =
                                                                                             state + 2 * s->n + 1;
    const double dt = fabs(next[2 * s->n] - state[2 * s->n]), h = s->position[s->hardest + 1] - s->position[s->hardest];
    const double last = fmax(fabs(trials->t), fabs(trials->t + trials->duration)), ulp = DBL_EPSILON * last;
    const double often = TIMES * sqrt(fmax(fabs(trials->way / h), 1)), shift = fmax(SHIFT * dt, SHIFTS * ulp);
    double apart;
    if (!trials->pair.full.integrator->system->uses_time || often * ulp < DOUBT * w->wanted * dt) return TVI_OK;
    const tvi_status status = tvi_step_doubling_shift(&trials->pair, state, h, shift, &apart);
    if (status != TVI_OK) return status;
    const double error = often * apart / shift * ulp / 2;
    if (error > w->wanted)
        return jet_refuse(TVI_EINVAL, "error = %g is below what the roundoff of t = %g makes of such a run, about %.0e",
                          w->wanted, last, error);
    trials->aim = fmax(trials->aim, error);
    trials->floor = fmax(trials->floor, apart / shift * ulp);
    return TVI_OK;
}

static double sample_factor(const search *w)
{
    const tvi_scout *s = &w->trials.scout;
    double shortest = INFINITY, longest = 0;
    for (int k = 0; k < s->count; k++)
        shortest = fmin(shortest, fabs(s->scale[k])), longest = fmax(longest, fabs(s->scale[k]));
    return 1 + DRAWS * log(fmin(longest / shortest, MOST_DRAWS));
}

/* Completes the suggestion. */
static void finish(search *w, tvi_suggestion *out)
{
    const double of_aim = pow(w->aim / w->trials.aim, 1.0 / w->order), unknown = w->is_known ? 1 : UNKNOWN;
    out->h = tvi_shorter(out->h * of_aim, w->limit) * unknown / sample_factor(w);
    if (w->best != 0) out->h = out->tried = w->best, out->reached = 1, out->error = w->error_of_best;
    if (out->seen > 1 - 1e-9) out->seen = 1;
}

static tvi_status find(search *w, tvi_suggestion *out)
{
    tvi_trials *trials = &w->trials;
    tvi_trial r;
    tvi_status status = tvi_scout_run(&trials->scout, &trials->pair.full, trials->duration);
    if (status != TVI_OK) return status;
    double h = prepare(w);
    status = measure_time_roundoff(w);
    if (status != TVI_OK) return status;
    out->seen = trials->scout.has_no_tail ? 0 : trials->scout.part;
    do r = tvi_trial_make(trials, h);
    while (r.status != TVI_ENOMEM && update(w, &r, &h, out));
    correct(w, &r, out);
    out->steps = trials->pair.steps_tried;
    if (r.status == TVI_ENOMEM || trials->pair.lacks_memory) return jet_refuse_memory(TVI_ENOMEM);
    if (w->roundoff > 0)
        return jet_refuse(TVI_EINVAL, "error = %g is below roundoff, which makes about %.0e of such a run", w->wanted,
                          w->roundoff);
    finish(w, out);
    if (out->tried != 0) return TVI_OK;
    return r.status != TVI_OK ? r.status : jet_refuse(TVI_ENOCONV, "no step was found that is right");
}

/* ---- The functions ----------------------------------------------------------------------------------------------- */

static tvi_status open(search *w, const tvi_system *system, const tvi_options *options)
{
    tvi_trials *trials = &w->trials;
    const tvi_status status = tvi_step_doubling_open(&trials->pair, system, options);
    if (status != TVI_OK) return status;
    const tvi_options *resolved = &trials->pair.full.integrator->options;
    w->order = resolved->order;
    w->degree = fmax(1, resolved->degree);
    w->aim = (trials->pair.is_rescaled ? AIM_LATER : AIM) * w->wanted;
    trials->is_driven = system->is_driven;
    trials->growth = trials->pair.is_rescaled ? GROWTH_LATER : GROWTH;
    trials->floor = FLOOR;
    trials->aim = fmax(w->aim, FLOOR * pow(TVI_STEPS_OF_TRIAL / TVI_PART_OF_RUN, trials->growth));
    trials->scout = (tvi_scout){.n = system->n, .states = trials->pair.states};
    return TVI_OK;
}

tvi_status tvi_suggest(const tvi_system *system, const tvi_options *options, double t, const double q[],
                       const double p[], double duration, double error, tvi_suggestion *out)
{
    search w = {.trials = {.t = t, .duration = duration}, .wanted = error};
    tvi_step_doubling *pair = &w.trials.pair;
    *out = (tvi_suggestion){0};
    tvi_status status = open(&w, system, options);
    if (status == TVI_OK) status = tvi_refuse_state(system->n, t, q, "p", p);
    if (status == TVI_OK) {
        pair->full.t = t;
        memcpy(pair->full.q, q, (size_t)system->n * sizeof *q);
        memcpy(pair->full.p, p, (size_t)system->n * sizeof *p);
        status = find(&w, out);
    }
    tvi_step_doubling_close(pair);
    return status;
}

tvi_status tvi_suggest_step_seen(const tvi_system *system, const tvi_options *options, double t, const double q[],
                                 const double p[], double duration, double error, double *h, double *seen)
{
    static const char *const name[] = {"system", "q", "p", "h", "seen"};
    const void *const pointer[] = {system, q, p, h, seen};
    tvi_suggestion found;
    if (!system || !q || !p || !h || !seen) return tvi_refuse_null(5, pointer, name);
    if (duration == 0 || !isfinite(duration))
        return jet_refuse(TVI_EINVAL, "duration = %g is 0 or not finite", duration);
    if (isfinite(t) && !(fabs(duration) > TVI_LEAST_STEPS * DBL_EPSILON * fabs(t)))
        return jet_refuse(TVI_EINVAL, "duration = %g is roundoff of t = %g", duration, t);
    if (!(error >= DBL_EPSILON && error < 1))
        return jet_refuse(TVI_EINVAL, "error = %g is below DBL_EPSILON or not below 1", error);
    const tvi_status status = tvi_suggest(system, options, t, q, p, duration, error, &found);
    if (status == TVI_OK) *h = found.h, *seen = found.seen;
    return status;
}

tvi_status tvi_suggest_step(const tvi_system *system, const tvi_options *options, double t, const double q[],
                            const double p[], double duration, double error, double *h)
{
    double seen;
    return tvi_suggest_step_seen(system, options, t, q, p, duration, error, h, &seen);
}
