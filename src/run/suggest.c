/* suggest.c - the step for a wanted error at the end of a run, by a look along it and trials where it is hardest.
 *
 * The scout (scout.h) tells where the orbit is hardest, and what step just resolves it there. A trial (trial.h) says
 * what error a run with its h has at its end; with another step h' it is said to be (h'/h)^order times as large. Trials
 * follow one another until one says what is aimed at, or the cost is used up. One that does not come to the hardest
 * place says nothing of it. One of the whole run shows the error, and nothing is said of another h then.
 *
 * Where the scout saw most of the run, a companion of it shows what becomes of the error until there, and the rest
 * alone is said: an unstable orbit makes it much larger. What the second half of what it saw made more of it than 2^a,
 * the rest makes again for each half that it is long.
 *
 * What a passage of a pericentre adds to the error depends on where in it the steps lie, and adds up where each
 * passage is hit alike; an end where the motion is fast shows the error more than an end where it is slow. Trials see
 * one draw of that, and the more the lengths that just resolve the orbit differ along it, the more draws differ: h is
 * made shorter by their logarithm. */
#include "run/suggest.h"
#include "algebra/sizes.h"
#include "run/integrator.h"
#include "run/trial.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What is aimed at, as a part of the wanted error, and of that of a rescaled system, of which another passage may be
 * worse. */
static const double AIM = 0.08, AIM_LATER = 0.06;
static const double FLOOR = 1e-13; /* of what a trial can tell from roundoff, */
static const double TINY = 1e-10;  /* and errors that may be roundoff */
static const double GROWTH = 1.25, GROWTH_LATER = 1.1;
/* What h is multiplied by where a step fails or makes too much; and of a rescaled system, where another passage may be
 * worse; at least elsewhere; where an error is of no order; and in the end, where no trial said what is aimed at. */
static const double FAILS = 0.88, FAILS_LATER = 0.7, LEAST_FACTOR = 0.25, OF_NO_ORDER = 1e-3, UNKNOWN = 0.8;
/* The first h: a step that just resolves the orbit makes this error, times its tail to the power order / degree; and a
 * trial knows this part of the run. No h is longer than a step with a tail of this many times the scout's. */
static const double RESOLVED = 0.1, KNOWN = 0.05, MOST_TAILS = 40;
/* A trial of the whole run shows that h keeps the wanted error with the first part of it, and that it is about the
 * longest with the second one, or where one that is so many times as long does not keep it. */
static const double KEPT = 0.9, FULL = 0.02, NEARLY = 1.1;
/* Draws: what the logarithm of how much the lengths differ counts, and the most that they do. */
static const double DRAWS = 0.15, MOST_DRAWS = 30;
/* The roundoff of the time is looked at where it may make this part of the wanted error, is found with a shift of the
 * time by this part of a step, or so many times its roundoff, and counts so often. */
static const double DOUBT = 0.01, SHIFT = 1e-3, SHIFTS = 4, TIMES = 3;

typedef struct {
    tvi_trials with;
    int order;
    double degree;
    double wanted, aim;         /* errors */
    double limit;               /* of h */
    double high, error_of_high; /* an h whose trial said too much, and what: no shorter one said less than a third */
    double roundoff;            /* the error that no h is seen to make smaller; 0: none */
    double best, worst; /* the longest h of which a trial of the whole run shows that it keeps the error, and the
                         * shortest of which one shows that it does not; 0: none */
    double error_of_best;
    bool is_known; /* h, from a trial that passed the hardest place and said about what is aimed at */
} search;

/* ---- All trials -------------------------------------------------------------------------------------------------- */

static double within(double least, double x, double most) { return fmin(fmax(x, least), most); }
static double fails(const search *w) { return w->with.pair.is_rescaled ? FAILS_LATER : FAILS; }

/* What h is to be multiplied by. */
static double correction(const search *w, const tvi_trial *r)
{
    if (r->status != TVI_OK) return fails(w);
    const double wrong = fmin(r->error / w->with.aim, 1 / OF_NO_ORDER);
    return wrong > 0 ? within(LEAST_FACTOR, pow(wrong, -1.0 / w->order), 1 / LEAST_FACTOR) : 1 / LEAST_FACTOR;
}

/* The same without another trial to say so. */
static double extrapolation(const search *w, const tvi_trial *r)
{
    return fmin(correction(w, r), pow(TVI_TRIAL_BAND, 1.0 / w->order));
}

/* Where an error is too large and yet tiny, and stays so until an h that should make it a hundredth, it is roundoff. */
static void look_for_roundoff(search *w, const tvi_trial *r)
{
    if (!tvi_trial_is_high(&w->with, r) || r->error == INFINITY || fmax(r->now, r->before) > TINY) return;
    if (w->high == 0 || r->error < w->error_of_high / 3) w->high = r->h, w->error_of_high = r->error;
    else if (pow(r->h / w->high, w->order) < 0.01) w->roundoff = fmin(r->error, w->error_of_high);
}

/* What a trial of the whole run shows, and one that says that its h is too long. */
static void bracket(search *w, const tvi_trial *r)
{
    const bool is_too_long = r->is_over && tvi_trial_is_high(&w->with, r);
    if (r->is_complete && r->error <= KEPT * w->wanted) {
        if (fabs(r->h) > fabs(w->best)) w->best = r->h, w->error_of_best = r->error;
    } else if (r->is_complete || is_too_long) {
        w->worst = w->worst == 0 ? r->h : tvi_shorter(w->worst, r->h);
    }
    if (r->error == INFINITY) w->limit = tvi_shorter(w->limit, fails(w) * r->h);
    else if (is_too_long) w->limit = tvi_shorter(w->limit, FAILS * r->h);
}

/* Whether a trial of the whole run may find a longer h than the best one: *h, or between that and the worst. */
static bool may_find_longer(const search *w, double *h)
{
    const bool has_worst = w->worst != 0;
    if (has_worst && !(fabs(*h) > fabs(w->best) && fabs(*h) < fabs(w->worst)))
        *h = copysign(sqrt(w->best * w->worst), w->best);
    const bool is_found = w->error_of_best >= FULL * w->wanted || fabs(w->best) >= fabs(w->limit) ||
                          (has_worst && fabs(w->worst) < NEARLY * fabs(w->best));
    return !is_found && tvi_trials_may_make(&w->with, TVI_STEPS_OF_TRIAL * ceil(fabs(w->with.way / *h)));
}

/* Whether a trial says about what is aimed at, from more of the run than the others, or that its h is too long. */
static bool counts(const search *w, const tvi_trial *r, bool *knows)
{
    const tvi_trials *with = &w->with;
    *knows = r->has_passed && !r->is_complete && !tvi_trial_is_high(with, r);
    const bool is_long = r->has_passed && r->part >= TVI_AS_LONG * with->longest;
    return is_long || r->is_complete || (r->is_over && tvi_trial_is_above(with, r, with->aim));
}

/* Learns from a trial. Returns whether another one is to follow, with *h. */
static bool learn(search *w, const tvi_trial *r, double *h, tvi_suggestion *out)
{
    tvi_trials *with = &w->with;
    const bool failed = r->error == INFINITY, is_low = tvi_trial_is_low(with, r), is_high = tvi_trial_is_high(with, r);
    bool knows;
    const bool is_news = counts(w, r, &knows);
    const double factor = is_news ? correction(w, r) : 1;
    if (is_news) out->h = r->h * extrapolation(w, r), w->is_known = knows;
    else if (!w->is_known) out->h = out->h == 0 ? r->h : tvi_shorter(out->h, r->h);
    if (!failed && (is_news || !w->is_known)) out->tried = r->h, out->reached = r->part, out->error = r->error;
    if (!failed) out->seen = fmax(out->seen, r->seen), with->longest = fmax(with->longest, r->part);
    look_for_roundoff(w, r);
    bracket(w, r);
    if (!tvi_trials_may_go_on(with) && (is_low || is_high)) with->kept = 0; /* for another trial */
    *h = tvi_shorter(r->h * factor, w->limit);
    with->run *= r->h / *h;
    if (w->best != 0) return may_find_longer(w, h);
    const bool is_last = w->roundoff > 0 || !(failed || is_low || is_high || r->is_over);
    return !is_last && tvi_trials_may_go_on(with) && (!w->is_known || tvi_trials_may_pass(with, *h)) &&
           fabs(*h) > DBL_EPSILON * fabs(with->duration);
}

/* Corrects what the last trial said by what the orbit makes of it later. */
static void correct(search *w, tvi_trial *r, tvi_suggestion *out)
{
    tvi_trials *with = &w->with;
    if (with->kept == 0 || out->tried != r->h || r->error == INFINITY) return;
    double growth;
    const double error = with->pair.apart, part = with->scout.part;
    const double stretch = tvi_pair_stretch(&with->pair, &with->scout, with->from, r->place, &growth);
    if (stretch == 0) return;
    const double more = fmax(growth / pow(2, with->growth), 1), halves = 2 * (1 / part - 1); /* what was seen has two */
    out->error = r->error = error * stretch * pow(part, -with->growth) * pow(more, halves);
    out->h = r->h * extrapolation(w, r);
}

/* ---- Before and after them --------------------------------------------------------------------------------------- */

/* What the scout says. Returns the first h. */
static double prepare(search *w)
{
    tvi_trials *with = &w->with;
    const tvi_scout *s = &with->scout;
    const double scale = s->scale[s->hardest], end = s->place[s->count];
    const double error = RESOLVED * pow(TVI_SCOUT_TAIL, w->order / w->degree);
    with->pair.made = s->made;
    with->pair.size_q = s->size_q, with->pair.size_p = s->size_p;
    with->way = end / s->part;
    with->weight = tvi_scout_weight(s, 0, end) / s->part;
    w->limit = scale * pow(MOST_TAILS, 1 / w->degree);
    if (!with->pair.is_rescaled) w->limit = tvi_shorter(w->limit, with->duration);
    const double part = pow(KNOWN, with->growth);
    const double h = tvi_shorter(scale * pow(with->aim * part / error, 1.0 / (w->order + 1)), w->limit);
    with->run = fabs(with->way / h);
    return h;
}

/* Equations that depend on the time get it rounded to a double, anew in each step. What that makes of a run adds up as
 * its steps are many, at random; where it may be much, one step shows what the time does, with another time. */
static tvi_status look_at_time(search *w)
{
    tvi_trials *with = &w->with;
    const tvi_scout *s = &with->scout;
    const double *const state = s->states + (size_t)s->hardest * (size_t)(2 * s->n + 1), *const next =
                                                                                             state + 2 * s->n + 1;
    const double dt = fabs(next[2 * s->n] - state[2 * s->n]), h = s->place[s->hardest + 1] - s->place[s->hardest];
    const double last = fmax(fabs(with->t), fabs(with->t + with->duration)), ulp = DBL_EPSILON * last;
    const double often = TIMES * sqrt(fmax(fabs(with->way / h), 1)), shift = fmax(SHIFT * dt, SHIFTS * ulp);
    double apart;
    if (!with->pair.whole.steps->system->uses_time || often * ulp < DOUBT * w->wanted * dt) return TVI_OK;
    const tvi_status status = tvi_pair_shift(&with->pair, state, h, shift, &apart);
    if (status != TVI_OK) return status;
    const double error = often * apart / shift * ulp / 2;
    if (error > w->wanted)
        return jet_refuse(TVI_EINVAL, "error = %g is below what the roundoff of t = %g makes of such a run, about %.0e",
                          w->wanted, last, error);
    with->aim = fmax(with->aim, error);
    with->floor = fmax(with->floor, apart / shift * ulp);
    return TVI_OK;
}

static double draws(const search *w)
{
    const tvi_scout *s = &w->with.scout;
    double shortest = INFINITY, longest = 0;
    for (int k = 0; k < s->count; k++)
        shortest = fmin(shortest, fabs(s->scale[k])), longest = fmax(longest, fabs(s->scale[k]));
    return 1 + DRAWS * log(fmin(longest / shortest, MOST_DRAWS));
}

/* What is suggested after all. */
static void finish(search *w, tvi_suggestion *out)
{
    const double of_aim = pow(w->aim / w->with.aim, 1.0 / w->order), unknown = w->is_known ? 1 : UNKNOWN;
    out->h = tvi_shorter(out->h * of_aim, w->limit) * unknown / draws(w);
    if (w->best != 0) out->h = out->tried = w->best, out->reached = 1, out->error = w->error_of_best;
    if (out->seen > 1 - 1e-9) out->seen = 1;
}

static tvi_status find(search *w, tvi_suggestion *out)
{
    tvi_trials *with = &w->with;
    tvi_trial r;
    tvi_status status = tvi_scout_look(&with->scout, &with->pair.whole, with->duration);
    if (status != TVI_OK) return status;
    double h = prepare(w);
    status = look_at_time(w);
    if (status != TVI_OK) return status;
    out->seen = with->scout.is_blind ? 0 : with->scout.part;
    do r = tvi_trial_make(with, h);
    while (r.status != TVI_ENOMEM && learn(w, &r, &h, out));
    correct(w, &r, out);
    out->steps = with->pair.made;
    if (r.status == TVI_ENOMEM || with->pair.lacks_memory) return jet_refuse_memory(TVI_ENOMEM);
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
    tvi_trials *with = &w->with;
    const tvi_status status = tvi_pair_open(&with->pair, system, options);
    if (status != TVI_OK) return status;
    const tvi_options *resolved = &with->pair.whole.steps->options;
    w->order = resolved->order;
    w->degree = fmax(1, resolved->degree);
    w->aim = (with->pair.is_rescaled ? AIM_LATER : AIM) * w->wanted;
    with->is_driven = system->is_driven;
    with->growth = with->pair.is_rescaled ? GROWTH_LATER : GROWTH;
    with->floor = FLOOR;
    with->aim = fmax(w->aim, FLOOR * pow(TVI_STEPS_OF_TRIAL / TVI_PART_OF_RUN, with->growth));
    with->scout = (tvi_scout){.n = system->n, .states = with->pair.states};
    return TVI_OK;
}

tvi_status tvi_suggest(const tvi_system *system, const tvi_options *options, double t, const double q[],
                       const double p[], double duration, double error, tvi_suggestion *out)
{
    search w = {.with = {.t = t, .duration = duration}, .wanted = error};
    tvi_pair *pair = &w.with.pair;
    *out = (tvi_suggestion){0};
    tvi_status status = open(&w, system, options);
    if (status == TVI_OK) status = tvi_refuse_state(system->n, t, q, "p", p);
    if (status == TVI_OK) {
        pair->whole.t = t;
        memcpy(pair->whole.q, q, (size_t)system->n * sizeof *q);
        memcpy(pair->whole.p, p, (size_t)system->n * sizeof *p);
        status = find(&w, out);
    }
    tvi_pair_close(pair);
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
