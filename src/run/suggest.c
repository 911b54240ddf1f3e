/* suggest.c - the step for a wanted error at the end of a run, by a look along it and trials where it is hardest.
 *
 * The scout (scout.h) tells where the orbit is hardest, and what step just resolves it there. A trial is two orbits
 * from the start, or from the hardest place where that comes late: one of steps h and one of steps h/2 (pair.h). Their
 * distance e, relative to the largest coordinate and the largest momentum, is the error of the first one but for a part
 * 2^-order. Where the part x of the run's error is made behind it, the error at the end is said to be e x^-a, and with
 * another step h' to be (h'/h)^order times as large. The error of a symplectic method on a regular orbit grows
 * linearly, a = 1, that of another method at most by the square; a = 5/4 suits the scenes of the bench, 1.1 those
 * that are rescaled. With a drive, under which errors may die out, a is measured, and at most that. Where the scout saw
 * most of the run, a companion of it shows what becomes of e until there, and the rest alone is said so: an unstable
 * orbit makes it much larger. What the second half of what it saw made more of it than 2^a, the rest makes again for
 * each half that it is long.
 *
 * A trial goes on while it says about what is aimed at, and while the cost allows; else another h is tried. */
#include "run/suggest.h"
#include "algebra/sizes.h"
#include "run/integrator.h"
#include "run/pair.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A trial step is a step and two of half its size. So many steps are made, the scout's included, or the part of the run
 * that stays below 5 % where the run turns out shorter than it was said to be, and at most MOST_STEPS. */
enum { STEPS_OF_TRIAL = 3, LEAST_STEPS = 20 * STEPS_OF_TRIAL, MOST_STEPS = 6000 };
static const double PART_OF_RUN = 0.04;
/* What is aimed at, as a part of the wanted error, and of that of a rescaled system, of which another passage may be
 * worse; and a trial goes on while it says that within this factor. */
static const double AIM = 0.08, AIM_LATER = 0.06, BAND = 30;
/* Errors of a trial below the first are roundoff, those below the second may be, and those above the last are of no
 * order. */
static const double FLOOR = 1e-13, TINY = 1e-10, CEILING = 0.05;
static const double GROWTH = 1.25, GROWTH_LATER = 1.1;
enum { GROWTH_STEPS = 8, GROWTH_EVERY = 4 }; /* before it is measured, and where */
/* So few steps of a trial, and they say too much, too early. */
enum { EARLY_STEPS = 4 };
/* A trial of this part of the longest one knows as much. */
static const double AS_LONG = 0.8;
/* What h is multiplied by where a step fails; and of a rescaled system, for the same reason; at least elsewhere; and
 * where an error is of no order. */
static const double FAILS = 0.88, FAILS_LATER = 0.7, LEAST_FACTOR = 0.25, OF_NO_ORDER = 1e-3;
/* The first h: a step that just resolves the orbit makes this error, times its tail to the power order / degree; and a
 * trial knows this part of the run. No h is longer than a step with a tail of this many times the scout's. */
static const double RESOLVED = 0.1, KNOWN = 0.05, MOST_TAILS = 40;
/* Where less than this part of the trial steps that are left leads past the hardest place, they begin at the start. */
static const double EARLY_PART = 0.6;
/* The scout saw most of a run where it saw this part of it. */
static const double SEEN = 0.5;

typedef struct {
    int order;
    double degree;
    bool is_driven;
    double t, duration, aim;
    tvi_pair pair;
    tvi_scout scout;
    double way, weight;  /* of the run: how long it is as the scout counts it, and its weight */
    double from;         /* the place where trials begin, and */
    const double *state; /* [2n + 1] its q, p and t */
    double growth;
    long kept;    /* steps, for the companion */
    double run;   /* steps of the run, with the h at hand */
    double limit; /* of h */
    double longest;
    double high, error_of_high; /* an h whose trial said too much, and what: no shorter one said less than a third */
    double roundoff;            /* the error that no h is seen to make smaller; 0: none */
} trials;

typedef struct {
    double h, part;            /* of the run's error */
    double place;              /* where it ends */
    double now, before;        /* the largest distances in the last two octaves of its steps, 2^i + 1 ... 2^(i+1) */
    double error;              /* said of the end of the run; INFINITY: of no order, or the trial failed */
    bool is_over, is_complete; /* it has nothing more to say; it is the whole run */
    tvi_status status;
} trial;

/* ---- A trial ----------------------------------------------------------------------------------------------------- */

static double within(double least, double x, double most) { return fmin(fmax(x, least), most); }
static bool is_power_of_two(long k) { return (k & (k - 1)) == 0; }

static bool may_go_on(const trials *w)
{
    return (double)(w->pair.made + w->kept + STEPS_OF_TRIAL) <=
           fmin(fmax(LEAST_STEPS, PART_OF_RUN * w->run), MOST_STEPS);
}

static bool is_low(const trials *w, const trial *r) { return r->error < w->aim / BAND; }

/* Roundoff at the beginning of a long run says nothing. */
static bool is_above(const trial *r, double error)
{
    return r->error > error && (r->error == INFINITY || fmax(r->now, r->before) >= FLOOR);
}

static bool is_high(const trials *w, const trial *r) { return is_above(r, BAND * w->aim); }

/* What the k-th distance says. */
static void hear(trials *w, trial *r, long k, double e)
{
    if (k > 1 && is_power_of_two(k - 1)) r->before = r->now, r->now = 0;
    r->now = fmax(r->now, e);
    if (w->is_driven && k >= GROWTH_STEPS && k % GROWTH_EVERY == 0 && r->before > 0)
        w->growth = within(0, log2(r->now / r->before), GROWTH);
    r->error = e < CEILING ? fmax(r->now, r->before) * pow(r->part, -w->growth) : INFINITY;
}

/* Whether the trial has nothing more to say after k steps. */
static bool is_over(const trials *w, const trial *r, long k)
{
    const tvi_scout *s = &w->scout;
    const bool has_passed = fabs(w->from + (double)k * r->h) >= fabs(s->place[s->hardest] + s->scale[s->hardest]);
    const bool is_early = k < EARLY_STEPS && fmax(r->now, r->before) < BAND * w->aim;
    if (r->error == INFINITY || (is_high(w, r) && !is_early)) return true;
    return is_low(w, r) && has_passed && is_power_of_two(k) && r->part > w->longest;
}

/* The k-th step of it. */
static bool go_on(trials *w, trial *r, long k)
{
    const double left = w->t + w->duration - w->pair.whole.t;
    r->status = tvi_pair_advance(&w->pair, w->pair.is_rescaled ? r->h : tvi_shorter(r->h, left));
    r->error = INFINITY;
    r->is_over = true;
    if (r->status != TVI_OK) return false;
    w->run = fabs(w->way / r->h);
    r->place = w->from + (double)k * r->h;
    r->part = fmin(tvi_scout_weight(&w->scout, w->from, r->place) / w->weight, 1);
    hear(w, r, k, tvi_pair_distance(&w->pair));
    const bool is_at_end = fabs(w->pair.whole.t - w->t) >= fabs(w->duration) * (1 - 1e-9);
    r->is_complete = is_at_end && w->from == 0;
    r->is_over = is_at_end || is_over(w, r, k);
    return !r->is_over;
}

/* Where a trial is too short to count without it. */
static bool takes_what_is_kept(trials *w, const trial *r)
{
    const bool takes = w->kept > 0 && r->part < AS_LONG * w->longest;
    if (takes) w->kept = 0;
    return takes && may_go_on(w);
}

static trial try_steps(trials *w, double h)
{
    trial r = {.h = h, .error = INFINITY};
    tvi_pair_begin(&w->pair, w->state);
    for (long k = 1; (may_go_on(w) || takes_what_is_kept(w, &r)) && go_on(w, &r, k); k++) continue;
    return r;
}

/* ---- All trials -------------------------------------------------------------------------------------------------- */

static double fails(const trials *w) { return w->pair.is_rescaled ? FAILS_LATER : FAILS; }

/* What h is to be multiplied by. */
static double correction(const trials *w, const trial *r)
{
    if (r->status != TVI_OK) return fails(w);
    const double wrong = fmin(r->error / w->aim, 1 / OF_NO_ORDER);
    return wrong > 0 ? within(LEAST_FACTOR, pow(wrong, -1.0 / w->order), 1 / LEAST_FACTOR) : 1 / LEAST_FACTOR;
}

/* Farther, another trial is to say so. */
static double most_factor(const trials *w) { return pow(BAND, 1.0 / w->order); }

/* Whether no trial may say more: where this one is about right, and all of the run or all that the cost allows. */
static bool is_last(const trials *w, const trial *r)
{
    const bool is_right = r->error < INFINITY && !is_low(w, r) && !is_high(w, r);
    return (is_right && (r->is_complete || !r->is_over)) || (r->is_complete && is_low(w, r) && r->h == w->limit);
}

/* Where an error is too large and yet tiny, and stays so until an h that should make it a hundredth, it is roundoff. */
static void look_for_roundoff(trials *w, const trial *r)
{
    if (!is_high(w, r) || r->error == INFINITY || fmax(r->now, r->before) > TINY) return;
    if (w->high == 0 || r->error < w->error_of_high / 3) w->high = r->h, w->error_of_high = r->error;
    else if (pow(r->h / w->high, w->order) < 0.01) w->roundoff = fmin(r->error, w->error_of_high);
}

/* Learns from a trial. Returns whether another one is to follow, with *h. */
static bool learn(trials *w, const trial *r, double *h, tvi_suggestion *out)
{
    const bool failed = r->error == INFINITY;
    const bool counts = r->part >= AS_LONG * w->longest || (r->is_over && is_above(r, w->aim));
    const double factor = counts ? correction(w, r) : 1;
    if (failed) w->limit = tvi_shorter(w->limit, fails(w) * r->h);
    else if (counts) out->tried = r->h, out->reached = r->part, out->error = r->error;
    if (counts) out->h = r->h * fmin(factor, most_factor(w));
    look_for_roundoff(w, r);
    const bool last = is_last(w, r) || w->roundoff > 0;
    if (!failed) w->longest = fmax(w->longest, r->part);
    if (!may_go_on(w) && (is_low(w, r) || is_high(w, r))) w->kept = 0; /* for another trial */
    *h = tvi_shorter(r->h * factor, w->limit);
    w->run *= r->h / *h;
    return !last && may_go_on(w) && fabs(*h) > DBL_EPSILON * fabs(w->duration);
}

/* Corrects what the last trial said by what the orbit makes of it later. */
static void correct(trials *w, trial *r, tvi_suggestion *out)
{
    if (w->kept == 0 || out->tried != r->h || r->error == INFINITY) return;
    double growth;
    const double error = w->pair.apart, part = w->scout.part;
    const double stretch = tvi_pair_stretch(&w->pair, &w->scout, w->from, r->place, &growth);
    if (stretch == 0) return;
    const double more = fmax(growth / pow(2, w->growth), 1), halves = 2 * (1 / part - 1); /* as what was seen has two */
    out->error = r->error = error * stretch * pow(part, -w->growth) * pow(more, halves);
    out->h = r->h * fmin(correction(w, r), most_factor(w));
}

/* Where trials begin: at the start, or at the hardest place where that is late, but not at the end of the run. */
static void choose_start(trials *w, double h)
{
    const tvi_scout *s = &w->scout;
    const double steps = (double)(LEAST_STEPS - w->pair.made) / STEPS_OF_TRIAL;
    const double passed = (s->place[s->hardest] + s->scale[s->hardest]) / h;
    int first = passed > EARLY_PART * steps ? s->hardest : 0;
    while (first > 0 && fabs(w->way - s->place[first]) < fabs(steps * h)) first--;
    w->from = s->place[first];
    w->state = s->states + (size_t)first * (size_t)(2 * s->n + 1);
    w->kept = s->part >= SEEN ? s->count - first - 1 : 0;
}

/* What the scout says. Returns the first h. */
static double prepare(trials *w)
{
    const tvi_scout *s = &w->scout;
    const double scale = s->scale[s->hardest], end = s->place[s->count];
    const double error = RESOLVED * pow(TVI_SCOUT_TAIL, w->order / w->degree);
    w->pair.made = s->made;
    w->pair.size_q = s->size_q, w->pair.size_p = s->size_p;
    w->way = end / s->part;
    w->weight = tvi_scout_weight(s, 0, end) / s->part;
    w->limit = scale * pow(MOST_TAILS, 1 / w->degree);
    if (!w->pair.is_rescaled) w->limit = tvi_shorter(w->limit, w->duration);
    const double h = tvi_shorter(scale * pow(w->aim * pow(KNOWN, w->growth) / error, 1.0 / (w->order + 1)), w->limit);
    w->run = fabs(w->way / h);
    choose_start(w, h);
    return h;
}

static tvi_status find(trials *w, double error, tvi_suggestion *out)
{
    trial r;
    const double aim = (w->pair.is_rescaled ? AIM_LATER : AIM) * error;
    w->aim = fmax(aim, FLOOR * pow(STEPS_OF_TRIAL / PART_OF_RUN, w->growth));
    const tvi_status status = tvi_scout_look(&w->scout, &w->pair.whole, w->duration);
    if (status != TVI_OK) return status;
    double h = prepare(w);
    do r = try_steps(w, h);
    while (learn(w, &r, &h, out));
    correct(w, &r, out);
    out->steps = w->pair.made;
    if (w->roundoff > 0)
        return jet_refuse(TVI_EINVAL, "error = %g is below roundoff, which makes about %.0e of such a run", error,
                          w->roundoff);
    out->h = tvi_shorter(out->h * pow(aim / w->aim, 1.0 / w->order), w->limit);
    if (out->tried != 0) return TVI_OK;
    return r.status != TVI_OK ? r.status : jet_refuse(TVI_ENOCONV, "no step was found that is right");
}

/* ---- The function ------------------------------------------------------------------------------------------------ */

static tvi_status open(trials *w, const tvi_system *system, const tvi_options *options)
{
    const tvi_status status = tvi_pair_open(&w->pair, system, options);
    if (status != TVI_OK) return status;
    const tvi_options *resolved = &w->pair.whole.steps->options;
    w->order = resolved->order;
    w->degree = fmax(1, resolved->degree);
    w->is_driven = system->is_driven;
    w->growth = w->pair.is_rescaled ? GROWTH_LATER : GROWTH;
    w->scout = (tvi_scout){.n = system->n, .states = w->pair.states};
    return TVI_OK;
}

tvi_status tvi_suggest(const tvi_system *system, const tvi_options *options, double t, const double q[],
                       const double p[], double duration, double error, tvi_suggestion *out)
{
    trials w = {.t = t, .duration = duration};
    *out = (tvi_suggestion){0};
    tvi_status status = open(&w, system, options);
    if (status == TVI_OK) status = tvi_refuse_state(system->n, t, q, "p", p);
    if (status == TVI_OK) {
        w.pair.whole.t = t;
        memcpy(w.pair.whole.q, q, (size_t)system->n * sizeof *q);
        memcpy(w.pair.whole.p, p, (size_t)system->n * sizeof *p);
        status = find(&w, error, out);
    }
    tvi_pair_close(&w.pair);
    return status;
}

tvi_status tvi_suggest_step(const tvi_system *system, const tvi_options *options, double t, const double q[],
                            const double p[], double duration, double error, double *h)
{
    static const char *const name[] = {"system", "q", "p", "h"};
    const void *const pointer[] = {system, q, p, h};
    tvi_suggestion found;
    if (!system || !q || !p || !h) return tvi_refuse_null(4, pointer, name);
    if (duration == 0 || !isfinite(duration))
        return jet_refuse(TVI_EINVAL, "duration = %g is 0 or not finite", duration);
    if (isfinite(t) && !(fabs(duration) > LEAST_STEPS * DBL_EPSILON * fabs(t)))
        return jet_refuse(TVI_EINVAL, "duration = %g is roundoff of t = %g", duration, t);
    if (!(error >= DBL_EPSILON && error < 1))
        return jet_refuse(TVI_EINVAL, "error = %g is below DBL_EPSILON or not below 1", error);
    const tvi_status status = tvi_suggest(system, options, t, q, p, duration, error, &found);
    if (status == TVI_OK) *h = found.h;
    return status;
}
