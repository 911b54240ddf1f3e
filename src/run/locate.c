/* locate.c - a run that looks for events.
 *
 * From the place of a root on the curve of the step (search.h) chords lead to the zero of g on the method's own
 * solution, steps of a part of h (between.h), so that the state of an event is as good as that of a step. */
#include "run/locate.h"
#include "run/between.h"
#include "run/search.h"
#include "system/rates.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Half the distance of the points that give the slopes of the curve and of g, and the least distance that gives a
 * chord. */
static const double CHORD = 1e-5;
enum { MOST_CHORDS = 12 };
/* A guess is good where the slope leads no further, in parts of the step and of the distance from its ends. */
static const double LEAST_WAY = 1e-6, NEAR = 1e-3;
/* How far the curve's slope leads from a state of the method without a step, and by how much more its error may be than
 * that of the curve, relative to the state. */
static const double REACH = 2e-9, STEEPER = 32;
/* The states of so many events of a step are kept until they are told; those of more are found again. */
enum { KEPT = 32 };

/* States are [2n + 1]: q, p, t. */
typedef struct tvi_locator {
    tvi_search seen;
    tvi_between between;
    tvi_rates rates;       /* of the field */
    int size;              /* of a state */
    double *base, base_at; /* the last step of a part of h, and where */
    double *rate, reach;   /* the slope that leads on from it, and how far */
    double *middle;        /* the state on the curve where it was taken: */
    bool is_inside;        /* clear of the ends of the step */
    double *trial, *kept;  /* kept: [KEPT + 1] */
} locator;

/* The slopes of the curve, s->rate, and of g along it, at theta, the middle of the chord, s->middle, and how far the
 * zero of g is ahead. */
static tvi_status set_slopes(locator *s, int which, double theta, double *slope, double *ahead)
{
    const double a = fmax(theta - CHORD, 0), b = fmin(theta + CHORD, 1);
    double ga = 0, gb = 0;
    tvi_status status = tvi_search_state(&s->seen, a, s->rate);
    if (status == TVI_OK) status = tvi_search_value(&s->seen, which, s->rate, &ga);
    if (status == TVI_OK) status = tvi_search_state(&s->seen, b, s->middle);
    if (status == TVI_OK) status = tvi_search_value(&s->seen, which, s->middle, &gb);
    *slope = (gb - ga) / (b - a);
    *ahead = -(ga + gb) / (2 * *slope);
    for (int i = 0; i < s->size; i++) {
        const double low = s->rate[i], high = s->middle[i];
        s->rate[i] = (high - low) / (b - a);
        s->middle[i] = (low + high) / 2;
    }
    s->is_inside = a > 0 && b < 1; /* the slope is that at theta to the square of the chord */
    return status;
}

/* Whether there is a guess inside, clear of the ends. */
static bool has_guess(const tvi_root *r) { return r->guess > r->a + CHORD && r->guess < r->b - CHORD; }

/* Whether the way from a place is short, also beside the distance from a and b: then it is good. */
static bool is_short(const tvi_root *r, double from, double way)
{
    return fabs(way) <= fmin(LEAST_WAY, NEAR * fmin(from + way - r->a, r->b - (from + way)));
}

/* The slopes at the root on the curve. */
static tvi_status find_on_curve(locator *s, const tvi_root *r, double *theta, double *slope)
{
    double ahead = 0;
    *theta = r->guess;
    if (has_guess(r)) {
        const tvi_status status = set_slopes(s, r->which, r->guess, slope, &ahead);
        if (status != TVI_OK) return status;
        *theta += ahead;
        for (int i = 0; i < s->size; i++) s->middle[i] += ahead * s->rate[i];
        if (is_short(r, r->guess, ahead)) return TVI_OK;
    }
    const tvi_status status = tvi_search_zero(&s->seen, r, theta);
    return status == TVI_OK ? set_slopes(s, r->which, *theta, slope, &ahead) : status;
}

/* The curve's distance from s->base, relative to the size of what is there. */
static double distance_of(const locator *s, int from, int count)
{
    double apart = 0, size = 0;
    for (int i = from; i < from + count; i++) {
        apart = fmax(apart, fabs(s->base[i] - s->middle[i]));
        size = fmax(size, fabs(s->base[i]));
    }
    return tvi_ratio(apart, size);
}

/* The same of the time, which may be 0. */
static double time_distance(const locator *s)
{
    const int t = s->size - 1;
    return tvi_ratio(fabs(s->base[t] - s->middle[t]), fabs(s->base[t]) + fabs(s->rate[t]));
}

/* The last state of s->between, at theta. */
static void copy_between(locator *s, double theta)
{
    const size_t n = (size_t)s->seen.it->system->n;
    memcpy(s->base, s->between.q, n * sizeof *s->base);
    memcpy(s->base + n, s->between.p, n * sizeof *s->base);
    s->base[2 * n] = s->between.t;
    s->base_at = theta;
}

/* The state at theta, by a step of a part of h; or from the one that such a step led to, where the curve's slope leads
 * on without an error that shows. */
static tvi_status near_solution(locator *s, double theta, double x[])
{
    const int n = s->seen.it->system->n;
    if (fabs(theta - s->base_at) > s->reach) {
        const tvi_status status = tvi_between_state(&s->between, theta == 1 ? s->seen.it->h : theta * s->seen.it->h);
        if (status != TVI_OK) return status;
        copy_between(s, theta);
        const double apart = fmax(fmax(distance_of(s, 0, n), distance_of(s, n, n)), time_distance(s));
        s->reach = s->is_inside ? fmin(REACH, DBL_EPSILON / (8 * STEEPER) / apart) : 0;
    }
    for (int i = 0; i < s->size; i++) x[i] = s->base[i] + (theta - s->base_at) * s->rate[i];
    return TVI_OK;
}

/* Chords from the place on the curve until |g| shrinks no more; x: the state there. The first slope is the curve's. */
static tvi_status polish(locator *s, tvi_root *r, double x[])
{
    double g, slope, theta, theta_before = 0, g_before = INFINITY;
    tvi_status status = find_on_curve(s, r, &theta, &slope);
    s->reach = -1;
    for (int k = 0; k < MOST_CHORDS && status == TVI_OK; k++) {
        status = near_solution(s, theta, s->trial);
        if (status == TVI_OK) status = tvi_search_value(&s->seen, r->which, s->trial, &g);
        if (status != TVI_OK || !(fabs(g) < fabs(g_before))) return status;
        if (k > 0 && fabs(theta - theta_before) > CHORD) slope = (g - g_before) / (theta - theta_before);
        r->theta = theta_before = theta;
        g_before = g;
        memcpy(x, s->trial, (size_t)s->size * sizeof *x);
        theta = fmin(fmax(theta - g / slope, 0), 1);
        if (slope == 0 || fabs(theta - r->theta) <= DBL_EPSILON) return TVI_OK;
    }
    return status;
}

/* ---- By rates ---------------------------------------------------------------------------------------------------- */

/* s->rate, by the part of the step, at a state. */
static tvi_status rates_at(locator *s, const double x[])
{
    const int last = s->size - 1;
    const double h = s->seen.it->h;
    const tvi_status status = tvi_rates_at(&s->rates, x, s->rate);
    for (int i = 0; i < last; i++) s->rate[i] *= h;
    s->rate[last] = h;
    return status;
}

/* x [2n + 1] = s->base + way s->rate, and g there. */
static tvi_status value_ahead(locator *s, int which, double way, double x[], double *g)
{
    for (int i = 0; i < s->size; i++) x[i] = s->base[i] + way * s->rate[i];
    return tvi_search_value(&s->seen, which, x, g);
}

/* From s->base, a state of the method, to the zero of g, by a way that its rates tell, and again: the second one is
 * roundoff of the first. Where the way is not nothing, the rates are those of its middle. */
static tvi_status follow_rates(locator *s, tvi_root *r, double way, double slope, double x[])
{
    double g, last;
    tvi_status status = TVI_OK;
    if (fabs(way) > REACH) {
        for (int i = 0; i < s->size; i++) s->trial[i] = s->base[i] + way / 2 * s->rate[i];
        status = rates_at(s, s->trial);
    }
    if (status == TVI_OK) status = value_ahead(s, r->which, way, x, &g);
    if (status != TVI_OK) return status;
    r->theta = s->base_at + way;
    way -= g / slope;
    status = value_ahead(s, r->which, way, s->trial, &last);
    if (status != TVI_OK || !(fabs(last) < fabs(g))) return status;
    r->theta = s->base_at + way;
    memcpy(x, s->trial, (size_t)s->size * sizeof *x);
    return TVI_OK;
}

/* The event at a guess that is good (find_on_curve), where the method's rates are good enough for the way from there:
 * one step of a part of h. */
static tvi_status polish_by_rates(locator *s, tvi_root *r, double x[], bool *is_done)
{
    double g = 0, before = 0, after = 0;
    const double h = s->seen.it->h;
    tvi_status status = tvi_between_state(&s->between, r->guess * h);
    if (status != TVI_OK) return status;
    copy_between(s, r->guess);
    status = rates_at(s, s->base);
    if (status == TVI_OK) status = tvi_search_value(&s->seen, r->which, s->base, &g);
    if (status == TVI_OK) status = value_ahead(s, r->which, -CHORD, s->trial, &before);
    if (status == TVI_OK) status = value_ahead(s, r->which, CHORD, s->trial, &after);
    const double slope = (after - before) / (2 * CHORD), way = -g / slope;
    const double tail = fmax(s->seen.it->stats.tail, s->between.partial->stats.tail), error = tail * tail;
    *is_done = status == TVI_OK && fabs(way) * error <= DBL_EPSILON / 8 && is_short(r, r->guess, way);
    if (!*is_done) return status;
    status = follow_rates(s, r, way, slope, x);
    *is_done = tvi_all_finite(s->size, x); /* else a step of a part of h says why */
    return status;
}

/* Whether the method follows the field, but for the square of the tail. */
static bool knows_rates(const locator *s)
{
    const tvi_integrator *it = s->seen.it;
    return s->rates.block && !tvi_is_rescaled(it) && it->stepper->is_superconvergent && it->options.degree > 1;
}

/* An event of the step, and x, its state. */
static tvi_status find_event(locator *s, tvi_root *r, double x[])
{
    bool is_done = false;
    tvi_status status = TVI_OK;
    if (has_guess(r) && knows_rates(s)) status = polish_by_rates(s, r, x, &is_done);
    return is_done || status != TVI_OK ? status : polish(s, r, x);
}

/* ---- The run ---------------------------------------------------------------------------------------------------- */

/* In the order of time, and of the events where that is equal. */
static void sort_roots(locator *s)
{
    for (int i = 1; i < s->seen.found; i++)
        for (int j = i; j > 0 && s->seen.roots[j].theta < s->seen.roots[j - 1].theta; j--) {
            const tvi_root later = s->seen.roots[j - 1];
            s->seen.roots[j - 1] = s->seen.roots[j];
            s->seen.roots[j] = later;
        }
}

static double *kept_state(locator *s, int kept)
{
    return s->kept + (size_t)(kept < KEPT ? kept : KEPT) * (size_t)s->size;
}

/* Finds the events of the last step, in order. */
static tvi_status locate_events(locator *s)
{
    tvi_status status = tvi_search_step(&s->seen);
    for (int i = 0; i < s->seen.found && status == TVI_OK; i++)
        status = find_event(s, &s->seen.roots[i], kept_state(s, s->seen.roots[i].number));
    sort_roots(s);
    return status;
}

tvi_status tvi_locator_tell(locator *s, double *t, double q[], double p[], tvi_event_observer *on_event, void *ctx)
{
    tvi_status status = locate_events(s);
    const int n = s->seen.it->system->n;
    for (int i = 0; i < s->seen.found && status == TVI_OK; i++) {
        tvi_root *r = &s->seen.roots[i];
        double *x = kept_state(s, r->number);
        if (r->number >= KEPT) status = find_event(s, r, x);
        if (status != TVI_OK) return status;
        const bool ends = on_event && on_event(r->which, x[2 * n], x, x + n, ctx) != 0;
        if (!ends && !s->seen.of[r->which].event->terminal) continue;
        *t = x[2 * n];
        memcpy(q, x, (size_t)n * sizeof *q);
        memcpy(p, x + n, (size_t)n * sizeof *p);
        tvi_integrator_reset(s->seen.it);
        return TVI_ESTOPPED;
    }
    return status;
}

void tvi_locator_close(locator *s)
{
    if (!s) return;
    tvi_search_close(&s->seen);
    tvi_rates_close(&s->rates);
    free(s->base);
    if (s->between.partial) tvi_between_close(&s->between);
    free(s);
}

static tvi_status open_locator(locator *s, tvi_integrator *it, const tvi_event *const events[], int count)
{
    const int size = 2 * it->system->n + 1;
    *s = (locator){.size = size};
    tvi_status status = tvi_search_open(&s->seen, it, events, count);
    if (status == TVI_OK) status = tvi_rates_open(&s->rates, it->system, it->parameters);
    if (status != TVI_OK) return status;
    s->base = calloc((size_t)size * (4 + KEPT + 1), sizeof *s->base);
    if (!s->base) return TVI_ENOMEM;
    double **const states[] = {&s->middle, &s->rate, &s->trial, &s->kept};
    for (int i = 0; i < 4; i++) *states[i] = s->base + size * (i + 1);
    return tvi_between_open(&s->between, it, true);
}

tvi_status tvi_locator_open(locator **out, tvi_integrator *it, const tvi_event *const events[], int count)
{
    *out = malloc(sizeof **out);
    if (!*out) return jet_refuse_memory(TVI_ENOMEM);
    const tvi_status status = open_locator(*out, it, events, count);
    if (status == TVI_OK) return status;
    tvi_locator_close(*out);
    *out = NULL;
    return jet_refuse_memory(status);
}

bool tvi_events_fit(const tvi_integrator *it, const tvi_event *const events[], int count)
{
    if (count >= 0 && (count == 0 || events)) {
        int which = 0;
        while (which < count && events[which] && events[which]->n == it->system->n) which++;
        if (which == count) return true;
        (void)jet_refuse(TVI_EINVAL, "events[%d] is %s", which, events[which] ? "of another dimension" : "NULL");
    } else {
        (void)jet_refuse(TVI_EINVAL, count < 0 ? "count = %d is negative" : "events is NULL", count);
    }
    return false;
}
