/* suggest.c - the step for a wanted error at the end of a run, by a look along it and trials where it is hardest.
 *
 * The scout (scout.h) tells where the orbit is hardest, and what step just resolves it there. A trial is two orbits
 * from the start, or from the hardest place where that comes late: one of steps h and one of steps h/2. Their distance
 * e, relative to the largest coordinate and the largest momentum, is the error of the first one but for a part
 * 2^-order. Where the part x of the run's error is made behind it, the error at the end is said to be e x^-a, and with
 * another step h' to be (h'/h)^order times as large. The error of a symplectic method on a regular orbit grows
 * linearly, a = 1, that of another method at most by the square; a = 5/4 suits the scenes of the bench. With a drive,
 * under which errors may die out, a is measured, and at most that.
 *
 * A trial goes on while it says about what is aimed at, and while the cost allows; else another h is tried. */
#include "run/suggest.h"
#include "algebra/sizes.h"
#include "run/integrator.h"
#include "run/scout.h"
#include "system/rates.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A trial step is a step and two of half its size. So many steps are made, the scout's included, or the part of the run
 * that stays below 5 % where the run turns out shorter than it was said to be, and at most MOST_STEPS. */
enum { STEPS_OF_TRIAL = 3, LEAST_STEPS = 20 * STEPS_OF_TRIAL, MOST_STEPS = 6000 };
static const double PART_OF_RUN = 0.04;
/* What is aimed at, as a part of the wanted error; and a trial goes on while it says that within this factor. */
static const double AIM = 0.08, BAND = 30;
/* Errors of a trial below the first are roundoff, those below the second may be, and those above the last are of no
 * order. */
static const double FLOOR = 1e-13, TINY = 1e-10, CEILING = 0.05;
static const double GROWTH = 1.25;
enum { GROWTH_STEPS = 8, GROWTH_EVERY = 4 }; /* before it is measured, and where */
/* So few steps of a trial, and they say too much, too early. */
enum { EARLY_STEPS = 4 };
/* A trial of this part of the longest one knows as much. */
static const double AS_LONG = 0.8;
/* What h is multiplied by where a step fails; and of a rescaled system, of which another passage may be worse; at least
 * elsewhere; and where an error is of no order. */
static const double FAILS = 0.88, FAILS_LATER = 0.8, LEAST_FACTOR = 0.25, OF_NO_ORDER = 1e-3;
/* The first h: a step that just resolves the orbit makes this error, times its tail to the power order / degree; and a
 * trial knows this part of the run. No h is longer than a step with a tail of this many times the scout's. */
static const double RESOLVED = 0.1, KNOWN = 0.05, MOST_TAILS = 40;
/* Where less than this part of the trial steps that are left leads past the hardest place, they begin at the start. */
static const double EARLY_PART = 0.6;
/* The distance along the orbit is known where the motion is at least that part as fast as where it is fastest. */
static const double FAST = 1.0 / 30;

typedef struct {
    int n, order;
    double degree;
    bool is_rescaled, is_driven;
    double t, duration, aim;
    tvi_orbit whole, halves;
    tvi_scout scout;
    double way, weight;    /* of the run: how long it is as the scout counts it, and its weight */
    double from;           /* the place where trials begin, and */
    const double *state;   /* [2n + 1] its q, p and t */
    double size_q, size_p; /* the largest coordinate and momentum */
    tvi_rates rates;       /* of a rescaled system, with */
    double *x, *rate;      /* [2n + 1], [2n] */
    double fastest;        /* of its rates, relative to the sizes */
    double growth;
    long made;    /* steps of the scout and of all trials */
    double run;   /* steps of the run, with the h at hand */
    double limit; /* of h */
    double longest;
    double high, error_of_high; /* the least h whose trial said too much, and what */
    double roundoff;            /* the error that no h is seen to make smaller; 0: none */
} trials;

typedef struct {
    double h, part;            /* of the run's error */
    double now, before;        /* the largest distances in the last two octaves of its steps, 2^i + 1 ... 2^(i+1) */
    double error;              /* said of the end of the run; INFINITY: of no order, or the trial failed */
    bool is_over, is_complete; /* it has nothing more to say; it is the whole run */
    tvi_status status;
} trial;

/* ---- Two orbits -------------------------------------------------------------------------------------------------- */

static void begin(const trials *w, tvi_orbit *o)
{
    const size_t n = (size_t)w->n;
    memcpy(o->q, w->state, n * sizeof *o->q);
    memcpy(o->p, w->state + n, n * sizeof *o->p);
    o->t = w->state[2 * n];
    tvi_integrator_reset(o->steps);
}

static tvi_status step(trials *w, tvi_orbit *o, double h)
{
    w->made++;
    return tvi_step(o->steps, h, &o->t, o->q, o->p);
}

/* q' and p': what the orbits of a rescaled system, which are not at the same time, differ by for each unit of it. */
static tvi_status find_rates(trials *w)
{
    const size_t n = (size_t)w->n;
    if (!w->is_rescaled) return TVI_OK;
    memcpy(w->x, w->whole.q, n * sizeof *w->x);
    memcpy(w->x + n, w->whole.p, n * sizeof *w->x);
    w->x[2 * n] = w->whole.t;
    return tvi_rates_at(&w->rates, w->x, w->rate);
}

static tvi_status advance(trials *w, double h)
{
    tvi_status status = step(w, &w->whole, h);
    for (int half = 0; half < 2 && status == TVI_OK; half++) status = step(w, &w->halves, h / 2);
    return status == TVI_OK ? find_rates(w) : status;
}

/* Of the difference d = a - b - lag rate of two orbits at one time, relative to size, |b| at most: the largest |d|; and
 * what its part along the orbit needs, d.rate, rate.rate and the largest |rate|. */
typedef struct {
    double largest, along, square, fastest;
} difference;

static void compare(int n, const double a[], const double b[], double lag, const double rate[], double *size,
                    difference *out)
{
    for (int i = 0; i < n; i++) *size = fmax(*size, fabs(b[i]));
    const double unit = *size > 0 ? *size : 1;
    for (int i = 0; i < n; i++) {
        const double d = (a[i] - b[i] - lag * rate[i]) / unit, r = rate[i] / unit;
        out->largest = fmax(out->largest, fabs(d));
        out->fastest = fmax(out->fastest, fabs(r));
        out->along += d * r, out->square += r * r;
    }
}

/* An orbit that is rescaled is fast at some places, where steps may miss what is along it: d.rate / rate.rate is how
 * late the one is after the other, at any place, and makes most of the distance where the motion is fastest. */
static double distance_of_orbits(trials *w)
{
    const tvi_orbit *a = &w->whole, *b = &w->halves;
    const double lag = a->t - b->t;
    difference d = {0};
    compare(w->n, a->q, b->q, lag, w->rate, &w->size_q, &d);
    compare(w->n, a->p, b->p, lag, w->rate + w->n, &w->size_p, &d);
    w->fastest = fmax(w->fastest, d.fastest);
    const bool is_fast = d.fastest > FAST * w->fastest;
    return is_fast ? fmax(d.largest, fabs(d.along / d.square) * w->fastest) : d.largest;
}

/* ---- A trial ----------------------------------------------------------------------------------------------------- */

static double within(double least, double x, double most) { return fmin(fmax(x, least), most); }
static bool is_power_of_two(long k) { return (k & (k - 1)) == 0; }

static bool may_go_on(const trials *w)
{
    return (double)(w->made + STEPS_OF_TRIAL) <= fmin(fmax(LEAST_STEPS, PART_OF_RUN * w->run), MOST_STEPS);
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
    const double left = w->t + w->duration - w->whole.t;
    r->status = advance(w, w->is_rescaled ? r->h : tvi_shorter(r->h, left));
    r->error = INFINITY;
    r->is_over = true;
    if (r->status != TVI_OK) return false;
    w->run = fabs(w->way / r->h);
    r->part = fmin(tvi_scout_weight(&w->scout, w->from, w->from + (double)k * r->h) / w->weight, 1);
    hear(w, r, k, distance_of_orbits(w));
    const bool is_at_end = fabs(w->whole.t - w->t) >= fabs(w->duration) * (1 - 1e-9);
    r->is_complete = is_at_end && w->from == 0;
    r->is_over = is_at_end || is_over(w, r, k);
    return !r->is_over;
}

static trial try_steps(trials *w, double h)
{
    trial r = {.h = h, .error = INFINITY};
    begin(w, &w->whole);
    begin(w, &w->halves);
    for (long k = 1; may_go_on(w) && go_on(w, &r, k); k++) continue;
    return r;
}

/* ---- All trials -------------------------------------------------------------------------------------------------- */

static double fails(const trials *w) { return w->is_rescaled ? FAILS_LATER : FAILS; }

/* What h is to be multiplied by. */
static double correction(const trials *w, const trial *r)
{
    if (r->status != TVI_OK) return fails(w);
    const double wrong = fmin(r->error / w->aim, 1 / OF_NO_ORDER);
    return wrong > 0 ? within(LEAST_FACTOR, pow(wrong, -1.0 / w->order), 1 / LEAST_FACTOR) : 1 / LEAST_FACTOR;
}

/* Whether no trial may say more: where this one is about right, and all of the run or all that the cost allows. */
static bool is_last(const trials *w, const trial *r)
{
    const bool is_right = r->error < INFINITY && !is_low(w, r) && !is_high(w, r);
    return (is_right && (r->is_complete || !r->is_over)) || (r->is_complete && is_low(w, r) && r->h == w->limit);
}

/* Where an error is too large and yet tiny, and stays so with an h that should make it a hundredth, it is roundoff. */
static void look_for_roundoff(trials *w, const trial *r)
{
    if (!is_high(w, r) || r->error == INFINITY || fmax(r->now, r->before) > TINY) return;
    const bool is_less = w->high != 0 && pow(r->h / w->high, w->order) < 0.01;
    if (is_less && r->error > w->error_of_high / 3) w->roundoff = fmin(r->error, w->error_of_high);
    w->high = r->h, w->error_of_high = r->error;
}

/* Learns from a trial. Returns whether another one is to follow, with *h. */
static bool learn(trials *w, const trial *r, double *h, tvi_suggestion *out)
{
    const bool failed = r->error == INFINITY;
    const bool counts = r->part >= AS_LONG * w->longest || (r->is_over && is_above(r, w->aim));
    const double factor = counts ? correction(w, r) : 1;
    const double most = pow(BAND, 1.0 / w->order); /* farther, another trial is to say so */
    if (failed) w->limit = tvi_shorter(w->limit, fails(w) * r->h);
    else if (counts) out->tried = r->h, out->reached = r->part, out->error = r->error;
    if (counts) out->h = r->h * fmin(factor, most);
    look_for_roundoff(w, r);
    const bool last = is_last(w, r) || w->roundoff > 0;
    if (!failed) w->longest = fmax(w->longest, r->part);
    *h = tvi_shorter(r->h * factor, w->limit);
    w->run *= r->h / *h;
    return !last && may_go_on(w) && fabs(*h) > DBL_EPSILON * fabs(w->duration);
}

/* Where trials begin: at the start, or at the hardest place where that is late, but not at the end of the run. */
static void choose_start(trials *w, double h)
{
    const tvi_scout *s = &w->scout;
    const double steps = (double)(LEAST_STEPS - w->made) / STEPS_OF_TRIAL;
    const double passed = (s->place[s->hardest] + s->scale[s->hardest]) / h;
    int first = passed > EARLY_PART * steps ? s->hardest : 0;
    while (first > 0 && fabs(w->way - s->place[first]) < fabs(steps * h)) first--;
    w->from = s->place[first];
    w->state = s->states + (size_t)first * (size_t)(2 * w->n + 1);
}

/* What the scout says. Returns the first h. */
static double prepare(trials *w)
{
    const tvi_scout *s = &w->scout;
    const double scale = s->scale[s->hardest], end = s->place[s->count];
    const double error = RESOLVED * pow(TVI_SCOUT_TAIL, w->order / w->degree);
    w->made = s->made;
    w->size_q = s->size_q, w->size_p = s->size_p;
    w->way = end / s->part;
    w->weight = tvi_scout_weight(s, 0, end) / s->part;
    w->limit = scale * pow(MOST_TAILS, 1 / w->degree);
    if (!w->is_rescaled) w->limit = tvi_shorter(w->limit, w->duration);
    const double h = tvi_shorter(scale * pow(w->aim * pow(KNOWN, w->growth) / error, 1.0 / (w->order + 1)), w->limit);
    w->run = fabs(w->way / h);
    choose_start(w, h);
    return h;
}

static tvi_status find(trials *w, double error, tvi_suggestion *out)
{
    trial r;
    w->aim = fmax(AIM * error, FLOOR * pow(STEPS_OF_TRIAL / PART_OF_RUN, w->growth));
    const tvi_status status = tvi_scout_look(&w->scout, &w->whole, w->duration);
    if (status != TVI_OK) return status;
    double h = prepare(w);
    do r = try_steps(w, h);
    while (learn(w, &r, &h, out));
    out->steps = w->made;
    if (w->roundoff > 0)
        return jet_refuse(TVI_EINVAL, "error = %g is below roundoff, which makes about %.0e of such a run", error,
                          w->roundoff);
    out->h = tvi_shorter(out->h * pow(AIM * error / w->aim, 1.0 / w->order), w->limit);
    if (out->tried != 0) return TVI_OK;
    return r.status != TVI_OK ? r.status : jet_refuse(TVI_ENOCONV, "no step was found that is right");
}

/* ---- The function ------------------------------------------------------------------------------------------------ */

static tvi_status open(trials *w, const tvi_system *system, const tvi_options *options)
{
    tvi_status status = tvi_integrator_create(&w->whole.steps, system, options);
    if (status == TVI_OK) status = tvi_integrator_create(&w->halves.steps, system, options);
    if (status != TVI_OK) return status;
    const size_t n = (size_t)system->n, state = 2 * n + 1;
    w->n = system->n;
    w->order = w->whole.steps->options.order;
    w->degree = fmax(1, w->whole.steps->options.degree);
    w->is_rescaled = tvi_is_rescaled(w->whole.steps);
    w->is_driven = system->is_driven;
    w->growth = GROWTH;
    w->x = calloc((4 + TVI_SCOUT_STEPS) * state, sizeof *w->x);
    if (!w->x) return jet_refuse_memory(TVI_ENOMEM);
    w->rate = w->x + state;
    w->whole.q = w->rate + state, w->whole.p = w->whole.q + n;
    w->halves.q = w->whole.q + state, w->halves.p = w->halves.q + n;
    w->scout = (tvi_scout){.n = w->n, .states = w->halves.q + state};
    if (!w->is_rescaled) return TVI_OK;
    return jet_refuse_memory(tvi_rates_open(&w->rates, system, w->whole.steps->parameters));
}

static void close(trials *w)
{
    tvi_rates_close(&w->rates);
    free(w->x);
    tvi_integrator_free(w->halves.steps);
    tvi_integrator_free(w->whole.steps);
}

tvi_status tvi_suggest(const tvi_system *system, const tvi_options *options, double t, const double q[],
                       const double p[], double duration, double error, tvi_suggestion *out)
{
    trials w = {.t = t, .duration = duration};
    *out = (tvi_suggestion){0};
    tvi_status status = open(&w, system, options);
    if (status == TVI_OK) status = tvi_refuse_state(w.n, t, q, "p", p);
    if (status == TVI_OK) {
        w.whole.t = t;
        memcpy(w.whole.q, q, (size_t)w.n * sizeof *q);
        memcpy(w.whole.p, p, (size_t)w.n * sizeof *p);
        status = find(&w, error, out);
    }
    close(&w);
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
