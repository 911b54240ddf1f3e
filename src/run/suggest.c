/* suggest.c - the step for a wanted error at the end of a run, by trials of its first part.
 *
 * A trial is two orbits from the start, one of steps h and one of steps h/2. Their distance e, relative to the largest
 * coordinate and the largest momentum, is the error of the first one but for a part 2^-order. With the part x of the
 * run behind it, the error at the end is said to be e x^-a, and with another step h' to be (h'/h)^order times as large.
 * The error of a symplectic method on a regular orbit grows linearly, a = 1, that of another method at most by the
 * square; a = 5/4 suits the scenes of the bench. With a drive, under which errors may die out, a is measured, and at
 * most that.
 *
 * A trial goes on while it says about what is aimed at, and while the cost allows; else another h is tried. */
#include "run/suggest.h"
#include "run/integrator.h"
#include "system/rates.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A trial step is a step and two of half its size. So many steps are made, or the part of the run that stays below 5 %
 * where the run turns out shorter than it was said to be. */
enum { STEPS_OF_TRIAL = 3, LEAST_STEPS = 20 * STEPS_OF_TRIAL };
static const double PART_OF_RUN = 0.04;
/* What is aimed at, as a part of the wanted error; and a trial goes on while it says that within this factor. */
static const double AIM = 0.08, BAND = 30;
/* Errors of a trial below the first are roundoff, and those above the second of no order. */
static const double FLOOR = 1e-13, CEILING = 0.05;
static const double GROWTH = 1.25;
enum { GROWTH_STEPS = 8 }; /* before it is measured */
/* A trial of this part of the longest one knows as much; its step where the orbit still speeds up knows less. */
static const double AS_LONG = 0.8, SPEEDS_UP = 1.2;
/* What h is multiplied by where the first step fails, and at least elsewhere; where another one does; and where an
 * error is of no order. */
static const double FIRST_FAILS = 0.25, FAILS = 0.85, OF_NO_ORDER = 1e-3;

typedef struct {
    tvi_integrator *steps;
    double t, *q, *p;
} orbit;

typedef struct {
    int n, order;
    bool is_rescaled, is_driven;
    double t, duration, aim;
    const double *q, *p;
    orbit whole, halves;
    double size_q, size_p; /* the largest coordinate and momentum */
    tvi_rates rates;       /* of a rescaled system, with */
    double *x, *rate;      /* [2n + 1], [2n] */
    double growth;
    long made;    /* steps of all trials */
    double run;   /* steps of the run, with the h at hand */
    double limit; /* of h */
    double longest;
} trials;

typedef struct {
    double h, part; /* of the run, by the longest of its steps */
    double longest_step;
    double now, before; /* the largest distances in the last two octaves of its steps, k = 2^i + 1 ... 2^(i+1) */
    double error;       /* said of the end of the run; INFINITY: of no order, or the trial failed */
    bool is_complete;
    tvi_status status;
} trial;

/* ---- Two orbits -------------------------------------------------------------------------------------------------- */

static void begin(const trials *w, orbit *o)
{
    o->t = w->t;
    memcpy(o->q, w->q, (size_t)w->n * sizeof *o->q);
    memcpy(o->p, w->p, (size_t)w->n * sizeof *o->p);
    tvi_integrator_reset(o->steps);
}

static tvi_status step(trials *w, orbit *o, double h)
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

/* The largest |a - b - lag rate|, relative to the largest |b| so far. */
static double distance(int n, const double a[], const double b[], double lag, const double rate[], double *size)
{
    double largest = 0;
    for (int i = 0; i < n; i++) {
        largest = fmax(largest, fabs(a[i] - b[i] - lag * rate[i]));
        *size = fmax(*size, fabs(b[i]));
    }
    return largest > 0 ? largest / *size : 0;
}

static double distance_of_orbits(trials *w)
{
    const orbit *a = &w->whole, *b = &w->halves;
    const double lag = a->t - b->t;
    return fmax(distance(w->n, a->q, b->q, lag, w->rate, &w->size_q),
                distance(w->n, a->p, b->p, lag, w->rate + w->n, &w->size_p));
}

/* ---- A trial ----------------------------------------------------------------------------------------------------- */

static double shorter(double a, double b) { return fabs(a) < fabs(b) ? a : b; }
static double within(double least, double x, double most) { return fmin(fmax(x, least), most); }
static bool is_power_of_two(long k) { return (k & (k - 1)) == 0; }

static bool may_go_on(const trials *w)
{
    return (double)(w->made + STEPS_OF_TRIAL) <= fmax(LEAST_STEPS, PART_OF_RUN * w->run);
}

static bool is_low(const trials *w, const trial *r) { return r->error < w->aim / BAND; }

/* Roundoff at the beginning of a long run says nothing. */
static bool is_above(const trial *r, double error)
{
    return r->error > error && (r->error == INFINITY || fmax(r->now, r->before) >= FLOOR);
}

static bool is_high(const trials *w, const trial *r) { return is_above(r, w->aim * BAND); }

/* What the k-th distance says. */
static void hear(trials *w, trial *r, long k, double e)
{
    if (k > 1 && is_power_of_two(k - 1)) r->before = r->now, r->now = 0;
    r->now = fmax(r->now, e);
    if (w->is_driven && k >= GROWTH_STEPS && is_power_of_two(k) && r->before > 0)
        w->growth = within(0, log2(r->now / r->before), GROWTH);
    r->error = e < CEILING ? fmax(r->now, r->before) * pow(r->part, -w->growth) : INFINITY;
}

/* Whether the trial has nothing more to say. */
static bool is_over(const trials *w, trial *r, long k, bool speeds_up)
{
    r->is_complete = fabs(w->whole.t - w->t) >= fabs(w->duration) * (1 - 1e-9);
    if (r->is_complete || r->error == INFINITY) return true;
    return (is_low(w, r) && is_power_of_two(k) && r->part > w->longest) || (is_high(w, r) && !speeds_up);
}

/* The k-th step of it. */
static bool go_on(trials *w, trial *r, long k)
{
    const double t = w->whole.t, left = w->t + w->duration - t, known = r->longest_step;
    r->status = advance(w, w->is_rescaled ? r->h : shorter(r->h, left));
    if (r->status != TVI_OK) r->error = INFINITY;
    if (r->status != TVI_OK) return false;
    r->longest_step = fmax(known, fabs(w->whole.t - t));
    w->run = fabs(w->duration) / r->longest_step;
    r->part = fmin((double)k / w->run, 1);
    hear(w, r, k, distance_of_orbits(w));
    return !is_over(w, r, k, w->is_rescaled && r->longest_step > SPEEDS_UP * known);
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

/* What h is to be multiplied by. */
static double correction(const trials *w, const trial *r)
{
    const double power = 1.0 / w->order;
    if (r->part == 0) return FIRST_FAILS;
    if (r->status != TVI_OK) return FAILS;
    const double wrong = fmin(r->error / w->aim, 1 / OF_NO_ORDER);
    return wrong > 0 ? within(FIRST_FAILS, pow(wrong, -power), 1 / FIRST_FAILS) : 1 / FIRST_FAILS;
}

/* Learns from a trial. Returns whether another one is to follow, with *h. */
static bool learn(trials *w, const trial *r, double *h, tvi_suggestion *out)
{
    const bool counts = r->part >= AS_LONG * w->longest || is_above(r, w->aim);
    const bool is_found = r->is_complete && !is_high(w, r) && (!is_low(w, r) || *h == w->limit);
    if (r->error == INFINITY) w->limit = shorter(w->limit, FAILS * *h);
    if (counts && r->error < INFINITY) out->tried = r->h, out->reached = r->part, out->error = r->error;
    const double factor = counts ? correction(w, r) : 1;
    if (counts) out->h = r->h * fmin(factor, pow(BAND, 1.0 / w->order)); /* farther, another trial is to say so */
    *h = shorter(*h * factor, w->limit);
    w->run *= r->h / *h;
    w->longest = fmax(w->longest, r->part);
    return !is_found && may_go_on(w) && fabs(*h) > DBL_EPSILON * fabs(w->duration);
}

static tvi_status find(trials *w, double error, tvi_suggestion *out)
{
    trial r;
    double h = w->limit = w->duration;
    w->run = 1;
    w->aim = fmax(AIM * error, FLOOR * pow(STEPS_OF_TRIAL / PART_OF_RUN, w->growth));
    do r = try_steps(w, h);
    while (learn(w, &r, &h, out));
    out->steps = w->made;
    out->h = shorter(out->h * pow(AIM * error / w->aim, 1.0 / w->order), w->limit);
    if (out->tried != 0) return TVI_OK;
    return r.status != TVI_OK ? r.status : jet_refuse(TVI_ENOCONV, "no step was found that is right");
}

/* ---- The function ------------------------------------------------------------------------------------------------ */

static tvi_status open(trials *w, const tvi_system *system, const tvi_options *options)
{
    tvi_status status = tvi_integrator_create(&w->whole.steps, system, options);
    if (status == TVI_OK) status = tvi_integrator_create(&w->halves.steps, system, options);
    if (status != TVI_OK) return status;
    const size_t n = (size_t)system->n;
    w->n = system->n;
    w->order = w->whole.steps->options.order;
    w->is_rescaled = tvi_is_rescaled(w->whole.steps);
    w->is_driven = system->is_driven;
    w->growth = GROWTH;
    w->x = calloc(8 * n + 1, sizeof *w->x);
    if (!w->x) return jet_refuse_memory(TVI_ENOMEM);
    w->rate = w->x + 2 * n + 1;
    w->whole.q = w->rate + 2 * n, w->whole.p = w->whole.q + n;
    w->halves.q = w->whole.p + n, w->halves.p = w->halves.q + n;
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
    trials w = {.t = t, .q = q, .p = p, .duration = duration};
    *out = (tvi_suggestion){0};
    tvi_status status = open(&w, system, options);
    if (status == TVI_OK) status = tvi_refuse_state(w.n, t, q, "p", p);
    if (status == TVI_OK) status = find(&w, error, out);
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
    if (!(error >= DBL_EPSILON && error < 1))
        return jet_refuse(TVI_EINVAL, "error = %g is below DBL_EPSILON or not below 1", error);
    const tvi_status status = tvi_suggest(system, options, t, q, p, duration, error, &found);
    if (status == TVI_OK) *h = found.h;
    return status;
}
