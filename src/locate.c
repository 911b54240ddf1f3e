/* locate.c - a run that looks for events.
 *
 * An event is found where g changes sign along the curve of the step (tvi_dense), which tells its place to the accuracy
 * of the curve. All events are looked at together, at the sample places of the step. From the place on the curve chords
 * lead to the zero of g on the method's own solution, steps of a part of h (between.h), so that the state of an event
 * is as good as that of a step. */
#include "between.h"
#include "event.h"
#include "sizes.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of an event, in a step. */
enum { MOST_ROOTS = 2 * (TVI_SAMPLES + 1) };
/* Close to the ends of a step. A run starts on an event where |g| is below a part of what it is there. */
static const double EDGE = 1.0 / 8192, AT_START = 1e-6;
/* |g| may have a least value next to an end of the step where its slope there is below this part of the mean one. */
static const double FLAT = 0.1;
/* A least |g| that is where a parabola has it, but for this part of it, is no zero. */
static const double SURE = 0.1;
/* Golden sections end here, and zeros on the curve are found to here, in parts of the step: chords do the rest. */
static const double LEAST_SECTION = 1e-8, LEAST_WAY = 1e-6, NEAR = 1e-3, LEAST_SECANT = 1e-4;
/* Half the distance of the points that give the slopes of the curve and of g, and the least distance that gives a
 * chord. */
static const double CHORD = 1e-5;
enum { MOST_CHORDS = 12, MOST_SECANTS = 6 };
/* How far the curve's slope leads from a state of the method without a step, and by how much more its error may be than
 * that of the curve, relative to the state. */
static const double REACH = 2e-9, STEEPER = 32;
/* The states of so many events of a step are kept until they are told; those of more are found again. */
enum { KEPT = 32 };

typedef struct {
    int which, kept;     /* kept: its state, from 0; KEPT and more: not */
    double a, ga, b, gb; /* g has different signs there, */
    double guess;        /* and perhaps a zero here */
    double theta;
} root;

typedef struct {
    const tvi_event *event;
    double *one, *many;        /* blocks of its tape, for a state and for all samples */
    double g[1 + TVI_SAMPLES]; /* at the start of the step, and the samples */
} watch;

/* States are [2n + 1]: q, p, t. */
typedef struct {
    tvi_integrator *it;
    tvi_between between;
    int count, size;  /* size: of a state */
    watch *of;        /* [count] */
    bool has_started; /* a step has been searched */
    double *samples;  /* [2n + 1][TVI_SAMPLES] of the last one */
    double *state, *trial;
    double *base, base_at; /* of the last step of a part of h, */
    double *rate, reach;   /* and what leads on from it, and how far */
    bool is_inside;
    root *roots; /* [count MOST_ROOTS] of the step at hand */
    int found;
    double *kept; /* [KEPT + 1] */
} search;

static int sign_of(double g) { return (g > 0) - (g < 0); }

/* ---- Along the curve -------------------------------------------------------------------------------------------- */

static tvi_status state_on_curve(search *s, double theta, double x[])
{
    const int n = s->it->system->n;
    x[2 * n] = tvi_time_at(s->it, theta);
    return tvi_dense(s->it, theta, x, x + n);
}

static tvi_status value_at(search *s, int which, const double x[], double *g)
{
    return tvi_event_value(s->of[which].event, s->of[which].one, x, g);
}

static tvi_status on_curve(search *s, int which, double theta, double *g)
{
    const tvi_status status = state_on_curve(s, theta, s->state);
    return status == TVI_OK ? value_at(s, which, s->state, g) : status;
}

/* Where the polynomial through the samples of g is 0 between a and b, by secants: Newton's form, with the differences
 * divided by factorials. */
static double guess_zero(const double g[], double a, double ga, double b, double gb)
{
    static const double part[] = {0, 1, 1. / 2, 1. / 3, 1. / 4, 1. / 5, 1. / 6, 1. / 7, 1. / 8};
    double c[TVI_SAMPLES + 1], now = ga, before = gb, at = a, last = b;
    memcpy(c, g, sizeof c);
    for (int k = 1; k <= TVI_SAMPLES; k++)
        for (int i = TVI_SAMPLES; i >= k; i--) c[i] = (c[i] - c[i - 1]) * part[k];
    for (int k = 0; k < MOST_SECANTS && now != before && fabs(at - last) > LEAST_SECANT; k++) {
        const double next = fmin(fmax(at - now * (at - last) / (now - before), a), b), x = TVI_SAMPLES * next;
        double p = c[TVI_SAMPLES];
        for (int i = TVI_SAMPLES; i-- > 0;) p = c[i] + (x - i) * p;
        last = at, before = now;
        at = next, now = p;
    }
    return at;
}

/* Where to look next for the zero, with so many looks left. */
static double next_place(double a, double ga, double b, double gb, double width, int left)
{
    const double middle = (a + b) / 2, secant = (a * gb - b * ga) / (gb - ga), way = middle - secant;
    const double truncation = 0.2 / width * (b - a) * (b - a);
    const double reach = ldexp(DBL_EPSILON / 2, left) - (b - a) / 2;
    double at = truncation <= fabs(way) ? secant + copysign(truncation, way) : middle;
    if (fabs(at - middle) > reach) at = middle - copysign(fmax(reach, 0), way);
    return fmin(fmax(at, a), b);
}

/* A zero of g in [a, b], g(a) g(b) <= 0, by interpolation, truncation and projection (Oliveira and Takahashi, "An
 * enhancement of the bisection method average performance preserving minmax optimality", 2020): as fast as the secant,
 * never slower than bisection by more than one evaluation. */
static tvi_status find_zero(search *s, const root *r, double *theta)
{
    const double width = r->b - r->a, least = DBL_EPSILON / 2;
    const int most = (int)ceil(log2(width / least)) + 1;
    double a = r->a, ga = r->ga, b = r->b, gb = r->gb, g;
    for (int k = 0; k < most && b - a > 2 * least && ga != 0 && gb != 0; k++) {
        const double at = next_place(a, ga, b, gb, width, most - k);
        const tvi_status status = on_curve(s, r->which, at, &g);
        if (status != TVI_OK) return status;
        if (sign_of(g) == sign_of(ga)) a = at, ga = g;
        else b = at, gb = g;
    }
    *theta = ga == 0 ? a : b;
    return TVI_OK;
}

/* A root between a and b where the sign becomes `after`, if that is wanted. */
static root *add_root(search *s, int which, int after, double a, double ga, double b, double gb)
{
    const tvi_direction direction = s->of[which].event->direction;
    if (direction != TVI_EITHER && (int)direction != after) return NULL;
    root *added = &s->roots[s->found];
    *added = (root){.which = which, .kept = s->found, .a = a, .ga = ga, .b = b, .gb = gb, .guess = NAN};
    s->found++;
    return added;
}

/* The roots beside a place where g is 0 or has another sign than at a and b. */
static void add_pair(search *s, int which, double a, double ga, double at, double g, double b, double gb)
{
    const int sign = sign_of(ga);
    (void)add_root(s, which, -sign, a, ga, at, g);
    if (g != 0) (void)add_root(s, which, sign, at, g, b, gb);
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
    if (status == TVI_OK && sign_of(g[fresh]) != sign) add_pair(s, which, a, ga, at[fresh], g[fresh], b, gb);
    return status;
}

/* Whether |g| has a least value between the samples beside g. */
static bool is_dip(const double g[]) { return (fabs(g[0]) < fabs(g[-1])) & (fabs(g[0]) <= fabs(g[1])); }

/* The same between the samples beside one, at and g. The parabola through the three knows the least value, unless g is
 * not what it says where that is. */
static tvi_status look_into_dip(search *s, int which, const double at[], const double g[])
{
    const double left = at[0] - at[-1], right = at[1] - at[0];
    const double rise = (g[1] - g[0]) / right, fall = (g[0] - g[-1]) / left, bend = (rise - fall) / (left + right);
    const double way = -(fall + bend * left) / (2 * bend), expected = g[0] - bend * way * way;
    double there;
    if (!(way > -left && way < right)) return follow_dip(s, which, at[-1], g[-1], at[1], g[1]);
    const tvi_status status = on_curve(s, which, at[0] + way, &there);
    if (status != TVI_OK) return status;
    if (sign_of(there) != sign_of(g[0])) add_pair(s, which, at[-1], g[-1], at[0] + way, there, at[1], g[1]);
    else if (fabs(there - expected) > SURE * fabs(there)) return follow_dip(s, which, at[-1], g[-1], at[1], g[1]);
    return TVI_OK;
}

/* How |g| begins in the first part, by the slope of the polynomial through five samples; or, stride -1, ends in the
 * last one, looked at from the end of the step. */
static bool falls_first(const double g[], int stride)
{
    const double slope = -25 * g[0] + 48 * g[stride] - 36 * g[2 * stride] + 16 * g[3 * stride] - 3 * g[4 * stride];
    const double sign = g[0] > 0 ? 1 : -1, rise = fabs(g[stride]) - fabs(g[0]);
    return g[0] * g[stride] > 0 && rise >= 0 && sign * slope <= 12 * FLAT * rise;
}

/* Whether g has no root: one sign and no least value. Without branches, since most steps end here. */
static bool is_quiet(const double g[])
{
    int found = falls_first(g, 1) | falls_first(g + TVI_SAMPLES, -1);
    for (int j = 1; j <= TVI_SAMPLES; j++) found |= !(g[j - 1] * g[j] > 0);
    for (int j = 1; j < TVI_SAMPLES; j++) found |= is_dip(g + j);
    return !found;
}

/* A least |g| in the first or the last part: the sample next to the end tells one just inside from one that lies in the
 * next step. */
static tvi_status look_at_end(search *s, int which, bool is_last)
{
    const double *g = s->of[which].g;
    const double edge = is_last ? 1 - EDGE : EDGE;
    const double part = 1.0 / TVI_SAMPLES, at[] = {is_last ? 1 - part : 0, edge, is_last ? 1 : part};
    double near[] = {g[is_last ? TVI_SAMPLES - 1 : 0], 0, g[is_last ? TVI_SAMPLES : 1]};
    const tvi_status status = on_curve(s, which, edge, &near[1]);
    if (status != TVI_OK) return status;
    if (sign_of(near[1]) != sign_of(near[0])) add_pair(s, which, at[0], near[0], at[1], near[1], at[2], near[2]);
    else if (is_dip(near + 1)) return look_into_dip(s, which, at + 1, near + 1);
    return TVI_OK;
}

/* All places of the step where g ceases to have the sign that it had: becomes 0 or has the other one. */
static tvi_status search_event(search *s, int which)
{
    const double *g = s->of[which].g;
    double at[1 + TVI_SAMPLES] = {0};
    tvi_status status = TVI_OK;
    if (is_quiet(g)) return TVI_OK;
    memcpy(at + 1, tvi_sample_place, sizeof tvi_sample_place);
    if (falls_first(g, 1)) status = look_at_end(s, which, false);
    for (int j = 1; j <= TVI_SAMPLES && status == TVI_OK; j++) {
        const int before = sign_of(g[j - 1]), now = sign_of(g[j]);
        if (before != 0 && now != before) {
            root *r = add_root(s, which, -before, at[j - 1], g[j - 1], at[j], g[j]);
            if (r) r->guess = guess_zero(g, r->a, r->ga, r->b, r->gb);
        } else if (now != 0 && before == now && j < TVI_SAMPLES && is_dip(g + j) && sign_of(g[j + 1]) == now) {
            status = look_into_dip(s, which, at + j, g + j);
        }
    }
    if (status == TVI_OK && falls_first(g + TVI_SAMPLES, -1)) status = look_at_end(s, which, true);
    return status;
}

/* Whether the step began, but for the sign of a zero, where the last one that was sampled ended. */
static bool is_continued(const search *s)
{
    const tvi_integrator *it = s->it;
    const int n = it->system->n;
    const double *end = s->samples + TVI_SAMPLES - 1;
    bool same = s->has_started & (it->t_start == end[2 * n * TVI_SAMPLES]);
    for (int i = 0; i < n; i++)
        same &= (it->q_start[i] == end[i * TVI_SAMPLES]) & (it->p_start[i] == end[(n + i) * TVI_SAMPLES]);
    return same;
}

/* Where the run starts on an event, |g| is nothing beside what it is soon. */
static tvi_status leave_start(search *s, int which)
{
    double *g = s->of[which].g, soon;
    const tvi_status status = on_curve(s, which, EDGE, &soon);
    if (status == TVI_OK && fabs(g[0]) <= AT_START * fabs(soon)) g[0] = 0;
    return status;
}

/* g of all events at the samples. Where one step leads on from the other, its end is the start of this one. */
static tvi_status sample_events(search *s)
{
    const bool continues = is_continued(s);
    tvi_status status = TVI_OK;
    tvi_sample(s->it, s->samples);
    for (int which = 0; which < s->count && status == TVI_OK; which++) {
        watch *w = &s->of[which];
        w->g[0] = w->g[TVI_SAMPLES];
        if (!continues) status = on_curve(s, which, 0, &w->g[0]);
        if (status == TVI_OK) status = tvi_event_samples(w->event, w->many, s->samples, w->g + 1);
        if (status == TVI_OK && !s->has_started) status = leave_start(s, which);
    }
    return status;
}

/* ---- On the method's own solution ------------------------------------------------------------------------------- */

/* The slopes of the curve, s->rate, and of g along it, at theta, the middle of the chord, s->state, and how far the
 * zero of g is ahead. */
static tvi_status set_slopes(search *s, int which, double theta, double *slope, double *ahead)
{
    const double a = fmax(theta - CHORD, 0), b = fmin(theta + CHORD, 1);
    double ga = 0, gb = 0;
    tvi_status status = state_on_curve(s, a, s->rate);
    if (status == TVI_OK) status = value_at(s, which, s->rate, &ga);
    if (status == TVI_OK) status = state_on_curve(s, b, s->state);
    if (status == TVI_OK) status = value_at(s, which, s->state, &gb);
    *slope = (gb - ga) / (b - a);
    *ahead = -(ga + gb) / (2 * *slope);
    for (int i = 0; i < s->size; i++) {
        const double low = s->rate[i], high = s->state[i];
        s->rate[i] = (high - low) / (b - a);
        s->state[i] = (low + high) / 2;
    }
    s->is_inside = a > 0 && b < 1; /* the slope is that at theta to the square of the chord */
    return status;
}

/* The slopes at the root on the curve. Its guess is good where the slope leads no further than a short way, short also
 * beside the distance from a and b. */
static tvi_status find_on_curve(search *s, const root *r, double *theta, double *slope)
{
    double ahead = 0;
    *theta = r->guess;
    if (r->guess > r->a + CHORD && r->guess < r->b - CHORD) {
        const tvi_status status = set_slopes(s, r->which, r->guess, slope, &ahead);
        if (status != TVI_OK) return status;
        *theta += ahead;
        for (int i = 0; i < s->size; i++) s->state[i] += ahead * s->rate[i];
        if (fabs(ahead) <= fmin(LEAST_WAY, NEAR * fmin(*theta - r->a, r->b - *theta))) return TVI_OK;
    }
    const tvi_status status = find_zero(s, r, theta);
    return status == TVI_OK ? set_slopes(s, r->which, *theta, slope, &ahead) : status;
}

/* The curve's distance from s->base, relative to the size of what is there. */
static double distance_of(const search *s, int from, int count)
{
    double apart = 0, size = 0;
    for (int i = from; i < from + count; i++) {
        apart = fmax(apart, fabs(s->base[i] - s->state[i]));
        size = fmax(size, fabs(s->base[i]));
    }
    return tvi_ratio(apart, size);
}

/* The state at theta, by a step of a part of h; or from the one that such a step led to, where the curve's slope leads
 * on without an error that shows. */
static tvi_status near_solution(search *s, double theta, double x[])
{
    const int n = s->it->system->n;
    const size_t bytes = (size_t)n * sizeof *x;
    if (fabs(theta - s->base_at) > s->reach) {
        const tvi_status status = tvi_between_state(&s->between, theta == 1 ? s->it->h : theta * s->it->h);
        if (status != TVI_OK) return status;
        memcpy(s->base, s->between.q, bytes);
        memcpy(s->base + n, s->between.p, bytes);
        const double apart = fmax(distance_of(s, 0, n), distance_of(s, n, n));
        s->base_at = theta;
        s->reach = s->is_inside ? fmin(REACH, DBL_EPSILON / (8 * STEEPER) / apart) : 0;
    }
    for (int i = 0; i < 2 * n; i++) x[i] = s->base[i] + (theta - s->base_at) * s->rate[i];
    x[2 * n] = tvi_time_at(s->it, theta);
    return TVI_OK;
}

/* Chords from the place on the curve until |g| shrinks no more; x: the state there. The first slope is the curve's. */
static tvi_status polish(search *s, root *r, double x[])
{
    double g, slope, theta, theta_before = 0, g_before = INFINITY;
    tvi_status status = find_on_curve(s, r, &theta, &slope);
    s->reach = -1;
    for (int k = 0; k < MOST_CHORDS && status == TVI_OK; k++) {
        status = near_solution(s, theta, s->trial);
        if (status == TVI_OK) status = value_at(s, r->which, s->trial, &g);
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

static double *kept_state(search *s, int kept)
{
    return s->kept + (size_t)(kept < KEPT ? kept : KEPT) * (size_t)s->size;
}

static tvi_status search_step(search *s)
{
    tvi_status status = sample_events(s);
    s->found = 0;
    for (int which = 0; which < s->count && status == TVI_OK; which++) status = search_event(s, which);
    s->has_started = true;
    for (int i = 0; i < s->found && status == TVI_OK; i++)
        status = polish(s, &s->roots[i], kept_state(s, s->roots[i].kept));
    sort_roots(s);
    return status;
}

/* Tells the events of the last step; where one ends the run, t, q, p are its state. */
static tvi_status tell_events(search *s, double *t, double q[], double p[], tvi_event_observer *on_event, void *ctx)
{
    tvi_status status = search_step(s);
    const int n = s->it->system->n;
    for (int i = 0; i < s->found && status == TVI_OK; i++) {
        root *r = &s->roots[i];
        double *x = kept_state(s, r->kept);
        if (r->kept >= KEPT) status = polish(s, r, x);
        if (status != TVI_OK) return status;
        const bool ends = on_event && on_event(r->which, x[2 * n], x, x + n, ctx) != 0;
        if (!ends && !s->of[r->which].event->terminal) continue;
        *t = x[2 * n];
        memcpy(q, x, (size_t)n * sizeof *q);
        memcpy(p, x + n, (size_t)n * sizeof *p);
        tvi_integrator_reset(s->it);
        return TVI_ESTOPPED;
    }
    return status;
}

static void close_search(search *s)
{
    for (int which = 0; s->of && which < s->count; which++) free(s->of[which].one);
    free(s->of);
    free(s->roots);
    free(s->state);
    if (s->between.partial) tvi_between_close(&s->between);
}

static tvi_status open_watch(watch *w, const tvi_event *event)
{
    const size_t slots = (size_t)event->tape->slots;
    w->event = event;
    w->one = malloc(slots * (1 + TVI_SAMPLES) * sizeof *w->one);
    if (!w->one) return TVI_ENOMEM;
    w->many = w->one + slots;
    jet_tape_prepare(event->tape, w->one, 1, 1);
    jet_tape_prepare(event->tape, w->many, 1, TVI_SAMPLES);
    return TVI_OK;
}

static tvi_status open_search(search *s, tvi_integrator *it, const tvi_event *const events[], int count)
{
    const int size = 2 * it->system->n + 1;
    const size_t some = (size_t)count;
    *s = (search){.it = it, .count = count, .size = size};
    s->of = calloc(some, sizeof *s->of);
    s->roots = calloc(some * MOST_ROOTS, sizeof *s->roots);
    s->state = calloc((size_t)size * (4 + KEPT + 1), sizeof *s->state);
    if (!s->of || !s->roots || !s->state) return TVI_ENOMEM;
    double **const states[] = {&s->base, &s->rate, &s->trial, &s->kept};
    for (int i = 0; i < 4; i++) *states[i] = s->state + size * (i + 1);
    tvi_status status = TVI_OK;
    for (int which = 0; which < count && status == TVI_OK; which++) status = open_watch(&s->of[which], events[which]);
    if (status == TVI_OK) status = tvi_between_open(&s->between, it, true);
    s->samples = s->of[0].many;
    return status;
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
