/* locate.c - a run that looks for events.
 *
 * An event is found where g changes sign along the curve of the step (tvi_dense), which tells its place to the accuracy
 * of the curve. From there chords lead to the zero of g on the method's own solution, steps of a part of h (between.h),
 * so that the state of an event is as good as that of a step. */
#include "between.h"
#include "event.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Samples of g: the ends of CELLS equal parts of the step, and points close to its ends, which tell a least |g| just
 * inside from one that lies in the next step. */
enum { CELLS = 8, SAMPLES = CELLS + 3, MOST_ROOTS = 2 * SAMPLES };
static const double EDGE = 1.0 / (1024 * CELLS);
/* A run starts on an event where |g| is below this part of what it is at the first sample. */
static const double AT_START = 1e-6;
/* Golden sections end here, in parts of the step. */
static const double LEAST_SECTION = 1e-8;
/* Half the distance of the points that give the slope of the curve's g, and the least distance that gives a chord. */
static const double CHORD = 1e-5;
enum { MOST_CHORDS = 12 };

typedef struct {
    int which;
    double theta;
} root;

typedef struct {
    tvi_integrator *it;
    tvi_between between;
    const tvi_event *const *events;
    int count;
    double **x;       /* [count] the blocks of their tapes */
    bool has_started; /* a step has been searched */
    double *q, *p;    /* [n] on the curve */
    root *roots;      /* [count MOST_ROOTS] of the step at hand */
    int found;
} search;

static int sign_of(double g) { return (g > 0) - (g < 0); }

/* ---- Along the curve -------------------------------------------------------------------------------------------- */

static tvi_status on_curve(search *s, int which, double theta, double *g)
{
    const tvi_integrator *it = s->it;
    const tvi_status status = tvi_dense(s->it, theta, s->q, s->p);
    if (status != TVI_OK) return status;
    const double t = theta == 1 ? it->last->t : it->t_start + (it->t_start_low + theta * it->h);
    return tvi_event_value(s->events[which], s->x[which], t, s->q, s->p, g);
}

/* A zero of g in [a, b], g(a) g(b) <= 0, by interpolation, truncation and projection (Oliveira and Takahashi, "An
 * enhancement of the bisection method average performance preserving minmax optimality", 2020): as fast as the secant,
 * never slower than bisection by more than one evaluation. */
static tvi_status find_zero(search *s, int which, double a, double ga, double b, double gb, double *theta)
{
    const double width = b - a, least = DBL_EPSILON / 2;
    const int most = (int)ceil(log2(width / least)) + 1;
    for (int k = 0; k < most && b - a > 2 * least && ga != 0 && gb != 0; k++) {
        const double middle = (a + b) / 2, secant = (a * gb - b * ga) / (gb - ga), way = middle - secant;
        const double truncation = 0.2 / width * (b - a) * (b - a), reach = ldexp(least, most - k) - (b - a) / 2;
        double at = truncation <= fabs(way) ? secant + copysign(truncation, way) : middle, g;
        if (fabs(at - middle) > reach) at = middle - copysign(fmax(reach, 0), way);
        at = fmin(fmax(at, a), b);
        const tvi_status status = on_curve(s, which, at, &g);
        if (status != TVI_OK) return status;
        if (sign_of(g) == sign_of(ga)) a = at, ga = g;
        else b = at, gb = g;
    }
    *theta = ga == 0 ? a : b;
    return TVI_OK;
}

/* A root where the sign becomes `after`, if that is wanted. */
static tvi_status add_root(search *s, int which, int after, double a, double ga, double b, double gb)
{
    const tvi_direction direction = s->events[which]->direction;
    if (direction != TVI_EITHER && (int)direction != after) return TVI_OK;
    root *added = &s->roots[s->found];
    added->which = which;
    const tvi_status status = find_zero(s, which, a, ga, b, gb, &added->theta);
    if (status == TVI_OK) s->found++;
    return status;
}

/* |g| has a least value in [a, b] where g may have another sign: golden sections until it is found to have, or not. */
static tvi_status follow_dip(search *s, int which, double a, double ga, double b, double gb)
{
    const double golden = 0.3819660112501051;
    const int sign = sign_of(ga);
    double low = a, high = b, at[2], g[2];
    int fresh = 0;
    at[0] = low + golden * (high - low);
    tvi_status status = on_curve(s, which, at[0], &g[0]);
    at[1] = high - golden * (high - low);
    if (status == TVI_OK && sign_of(g[0]) == sign) status = on_curve(s, which, at[1], &g[1]), fresh = 1;
    while (status == TVI_OK && high - low > LEAST_SECTION && sign_of(g[fresh]) == sign) {
        fresh = fabs(g[0]) > fabs(g[1]); /* the new point is on the side of the smaller value */
        if (fresh) low = at[0], at[0] = at[1], g[0] = g[1];
        else high = at[1], at[1] = at[0], g[1] = g[0];
        at[fresh] = fresh ? high - golden * (high - low) : low + golden * (high - low);
        status = on_curve(s, which, at[fresh], &g[fresh]);
    }
    if (status != TVI_OK || sign_of(g[fresh]) == sign) return status;
    status = add_root(s, which, -sign, a, ga, at[fresh], g[fresh]);
    return status == TVI_OK && g[fresh] != 0 ? add_root(s, which, sign, at[fresh], g[fresh], b, gb) : status;
}

static double sample_place(int j)
{
    return j == 0 ? 0 : j == 1 ? EDGE : j == SAMPLES - 1 ? 1 : j == SAMPLES - 2 ? 1 - EDGE : (j - 1) / (double)CELLS;
}

/* All places of the step where g ceases to have the sign that it had: becomes 0 or has the other one. */
static tvi_status search_event(search *s, int which)
{
    double at[SAMPLES], g[SAMPLES];
    for (int j = 0; j < SAMPLES; j++) {
        at[j] = sample_place(j);
        const tvi_status status = on_curve(s, which, at[j], &g[j]);
        if (status != TVI_OK) return status;
    }
    if (!s->has_started && fabs(g[0]) <= AT_START * fabs(g[1])) g[0] = 0;
    for (int j = 1; j < SAMPLES; j++) {
        const int before = sign_of(g[j - 1]), now = sign_of(g[j]);
        tvi_status status = TVI_OK;
        if (before != 0 && now != before) status = add_root(s, which, -before, at[j - 1], g[j - 1], at[j], g[j]);
        else if (now != 0 && j < SAMPLES - 1 && before == now && sign_of(g[j + 1]) == now &&
                 fabs(g[j]) < fabs(g[j - 1]) && fabs(g[j]) <= fabs(g[j + 1]))
            status = follow_dip(s, which, at[j - 1], g[j - 1], at[j + 1], g[j + 1]);
        if (status != TVI_OK) return status;
    }
    return TVI_OK;
}

/* ---- On the method's own solution ------------------------------------------------------------------------------- */

static tvi_status at_part(search *s, int which, double theta, double *g)
{
    const tvi_status status = tvi_between_state(&s->between, theta == 1 ? s->it->h : theta * s->it->h);
    if (status != TVI_OK) return status;
    return tvi_event_value(s->events[which], s->x[which], s->between.t, s->between.q, s->between.p, g);
}

/* Chords from the place on the curve until |g| shrinks no more. The first slope is the curve's. */
static tvi_status polish(search *s, root *r)
{
    const double a = fmax(r->theta - CHORD, 0), b = fmin(r->theta + CHORD, 1);
    double ga, gb, g, theta = r->theta, theta_before = 0, g_before = INFINITY;
    tvi_status status = on_curve(s, r->which, a, &ga);
    if (status == TVI_OK) status = on_curve(s, r->which, b, &gb);
    if (status != TVI_OK) return status;
    double slope = (gb - ga) / (b - a);
    for (int k = 0; k < MOST_CHORDS; k++) {
        status = at_part(s, r->which, theta, &g);
        if (status != TVI_OK) return status;
        if (!(fabs(g) < fabs(g_before))) return TVI_OK;
        if (k > 0 && fabs(theta - theta_before) > CHORD) slope = (g - g_before) / (theta - theta_before);
        r->theta = theta_before = theta;
        g_before = g;
        theta = fmin(fmax(theta - g / slope, 0), 1);
        if (slope == 0 || fabs(theta - r->theta) <= DBL_EPSILON) return TVI_OK;
    }
    return TVI_OK;
}

/* ---- The run ---------------------------------------------------------------------------------------------------- */

/* In the order of time, and of the events where that is equal. */
static void sort_roots(search *s)
{
    for (int i = 1; i < s->found; i++)
        for (int j = i; j > 0 && s->roots[j].theta < s->roots[j - 1].theta; j--) {
            const root later = s->roots[j - 1];
            s->roots[j - 1] = s->roots[j];
            s->roots[j] = later;
        }
}

static tvi_status search_step(search *s)
{
    tvi_status status = TVI_OK;
    s->found = 0;
    for (int which = 0; which < s->count && status == TVI_OK; which++) status = search_event(s, which);
    s->has_started = true;
    for (int i = 0; i < s->found && status == TVI_OK; i++) status = polish(s, &s->roots[i]);
    sort_roots(s);
    return status;
}

/* Tells the events of the last step; where one ends the run, t, q, p are its state. */
static tvi_status tell_events(search *s, double *t, double q[], double p[], tvi_event_observer *on_event, void *ctx)
{
    tvi_status status = search_step(s);
    const tvi_between *at = &s->between;
    for (int i = 0; i < s->found && status == TVI_OK; i++) {
        const root *r = &s->roots[i];
        status = tvi_between_state(&s->between, r->theta == 1 ? s->it->h : r->theta * s->it->h);
        if (status != TVI_OK) return status;
        const bool ends = on_event && on_event(r->which, at->t, at->q, at->p, ctx) != 0;
        if (!ends && !s->events[r->which]->terminal) continue;
        *t = at->t;
        memcpy(q, at->q, (size_t)s->it->system->n * sizeof *q);
        memcpy(p, at->p, (size_t)s->it->system->n * sizeof *p);
        tvi_integrator_reset(s->it);
        return TVI_ESTOPPED;
    }
    return status;
}

static void close_search(search *s)
{
    for (int which = 0; s->x && which < s->count; which++) free(s->x[which]);
    free(s->x);
    free(s->roots);
    free(s->q);
    if (s->between.partial) tvi_between_close(&s->between);
}

static tvi_status open_search(search *s, tvi_integrator *it, const tvi_event *const events[], int count)
{
    const size_t n = (size_t)it->system->n, some = (size_t)count;
    *s = (search){.it = it, .events = events, .count = count};
    s->x = calloc(some, sizeof *s->x);
    s->roots = calloc(some * MOST_ROOTS, sizeof *s->roots);
    s->q = calloc(2 * n, sizeof *s->q);
    if (!s->x || !s->roots || !s->q) return TVI_ENOMEM;
    s->p = s->q + n;
    for (int which = 0; which < count; which++) {
        s->x[which] = malloc((size_t)events[which]->tape->slots * sizeof **s->x);
        if (!s->x[which]) return TVI_ENOMEM;
        jet_tape_prepare(events[which]->tape, s->x[which], 1, 1);
    }
    return tvi_between_open(&s->between, it);
}

tvi_status tvi_integrate_events(tvi_integrator *it, double h, long steps, const tvi_event *const events[], int count,
                                double *t, double q[], double p[], tvi_observer *observer, tvi_event_observer *on_event,
                                void *ctx)
{
    if (!it || !t || !q || !p || h == 0 || !isfinite(h) || steps < 0 || count < 0 || (count > 0 && !events))
        return TVI_EINVAL;
    for (int which = 0; which < count; which++)
        if (!events[which] || events[which]->n != it->system->n) return TVI_EINVAL;
    if (count == 0) return tvi_integrate(it, h, steps, t, q, p, observer, ctx);
    search s;
    tvi_status status = open_search(&s, it, events, count);
    for (long step = 1; step <= steps && status == TVI_OK; step++) {
        status = tvi_step(it, h, t, q, p);
        if (status == TVI_OK) status = tell_events(&s, t, q, p, on_event, ctx);
        if (status == TVI_OK && observer && observer(step, *t, q, p, ctx) != 0) status = TVI_ESTOPPED;
    }
    close_search(&s);
    return status;
}
