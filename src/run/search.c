/* search.c - Searches the curve of a step for sign changes of all events together, at the sample points. */
#include "run/search.h"
#include "run/dip.h"
#include "run/start.h"
#include "algebra/sizes.h"
#include "vector.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The distance to a point beside a sample. Two roots that are closer than this are one. */
static const double EDGE = 0x1p-20;
/* A dip of |g| may lie next to an end of the step if the slope there is below this part of the mean slope. */
static const double FLAT = 0.1;
/* g is not smooth if a high difference is larger than this part of the largest first one. */
static const double KINKED = 0.05;
/* The most roots of one event in a step; each dip has two. */
enum { MOST_ROOTS = 4 * TVI_SAMPLES + 4 };
/* The secant method ends at this distance, in parts of the step. */
static const double LEAST_SECANT = 1e-4;
enum { MOST_SECANTS = 6 };

static int sign_of(double g) { return (g > 0) - (g < 0); }

static bool have_one_sign(double a, double b) { return a > 0 ? b > 0 : a < 0 && b < 0; }

tvi_status tvi_search_state(tvi_search *s, double theta, double x[])
{
    const int n = s->it->system->n;
    return tvi_state_at(s->it, theta, &x[2 * n], x, x + n);
}

static tvi_status refuse_event(int which, tvi_status status)
{
    return status == TVI_OK ? status : jet_refuse(status, "events[%d]: %s", which, jet_refusal());
}

tvi_status tvi_search_value(tvi_search *s, int which, const double x[], double *g)
{
    return refuse_event(which, tvi_event_value(s->watch[which].event, s->watch[which].block, x, g));
}

static tvi_status on_curve(tvi_search *s, int which, double theta, double *g)
{
    const tvi_status status = tvi_search_state(s, theta, s->state);
    return status == TVI_OK ? tvi_search_value(s, which, s->state, g) : status;
}

/* A zero between a and b of the polynomial through the samples of g, by the secant method. The polynomial has Newton's
 * form, with differences divided by factorials. */
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

typedef struct {
    tvi_search *search;
    int which;
} one_event;

static tvi_status of_one(void *ctx, double theta, double *g)
{
    const one_event *one = ctx;
    return on_curve(one->search, one->which, theta, g);
}

tvi_status tvi_search_zero(tvi_search *s, const tvi_root *r, double *theta)
{
    tvi_bracket z = {r->a, r->ga, r->b, r->gb};
    const tvi_status status = tvi_narrow(&z, DBL_EPSILON / 2, of_one, &(one_event){s, r->which});
    *theta = z.ga == 0 ? z.a : z.b;
    return status;
}

/* Adds a root between a and b with the sign `after` behind it, if this direction is wanted. */
static tvi_root *add_root(tvi_search *s, int which, int after, tvi_dip_point a, tvi_dip_point b)
{
    const tvi_direction direction = s->watch[which].event->direction;
    if (direction != TVI_EITHER && (int)direction != after) return NULL;
    tvi_root *added = &s->roots[s->found];
    *added = (tvi_root){.which = which,
                        .number = s->found,
                        .sign_after = after,
                        .a = a.at,
                        .ga = a.g,
                        .b = b.at,
                        .gb = b.g,
                        .is_return = a.at == 0 && s->watch[which].leaves,
                        .guess = NAN};
    s->found++;
    return added;
}

/* Sets *near to the point beside a sample with g = 0, at the distance `way`. */
static tvi_status beside(tvi_search *s, int which, double at, double way, tvi_dip_point *near)
{
    near->at = at + way;
    return on_curve(s, which, near->at, &near->g);
}

/* Adds the roots beside a point where g has another sign than at a and b, or is 0. If g is 0 there, it may have the
 * other sign before the point or after it, or only touch 0. */
static tvi_status add_pair(tvi_search *s, int which, tvi_dip_point a, tvi_dip_point at, tvi_dip_point b)
{
    const int sign = sign_of(a.g);
    tvi_dip_point near = at;
    tvi_status status = TVI_OK;
    if (at.g == 0) status = beside(s, which, at.at, -fmin(EDGE, (at.at - a.at) / 2), &near);
    if (at.g == 0 && sign_of(near.g) != -sign && status == TVI_OK)
        status = beside(s, which, at.at, fmin(EDGE, (b.at - at.at) / 2), &near);
    if (status != TVI_OK) return status;
    const bool crosses = sign_of(near.g) == -sign;
    (void)add_root(s, which, -sign, a, crosses ? near : at);
    if (crosses) (void)add_root(s, which, sign, near, b);
    return TVI_OK;
}

/* Searches a dip of |g| in the middle of the five points for another sign of g, until g has it, or cannot have it. */
static tvi_status search_dip(tvi_search *s, int which, const tvi_dip_point from[TVI_DIP])
{
    tvi_dip_point x[TVI_DIP], new;
    memcpy(x, from, sizeof x);
    for (int looks = 0; tvi_dip_next(x, looks, &new.at); looks++) {
        const tvi_status status = on_curve(s, which, new.at, &new.g);
        if (status != TVI_OK) return status;
        if (sign_of(new.g) != sign_of(x[2].g)) return add_pair(s, which, from[1], new, from[3]);
        tvi_dip_insert(x, new);
    }
    return TVI_OK;
}

/* Tells whether |g| has a dip at the sample g[0]. */
static bool is_dip(const double g[]) { return (fabs(g[0]) < fabs(g[-1])) & (fabs(g[0]) <= fabs(g[1])); }

/* Tells whether |g| falls or is flat at the start of the step, by the slope of the polynomial through five samples.
 * With stride -1 the samples are read from the end of the step. */
static bool falls(const double g[], int stride, double rise)
{
    const double slope = -25 * g[0] + 48 * g[stride] - 36 * g[2 * stride] + 16 * g[3 * stride] - 3 * g[4 * stride];
    return (g[0] > 0 ? slope : -slope) <= 12 * FLAT * rise;
}

/* The largest change from a sample to the next one. */
static double largest_change(const double g[])
{
    double change = 0;
    for (int j = 0; j < TVI_SAMPLES; j++) change = tvi_larger(fabs(g[j + 1] - g[j]), change);
    return change;
}

/* Tells whether |g| has a kink or a peak near the start of the step, or with stride -1 near the end. Such a g may
 * change its sign there, unseen by the polynomial. Its fourth difference there, or its eighth, is large. */
static bool is_kinked(const double g[], int stride)
{
    const double fourth = g[0] - 4 * g[stride] + 6 * g[2 * stride] - 4 * g[3 * stride] + g[4 * stride];
    const double *first = stride > 0 ? g : g - TVI_SAMPLES, noise = 256 * DBL_EPSILON * fabs(g[0]);
    const double eighth = (first[0] + first[8]) - 8 * (first[1] + first[7]) + 28 * (first[2] + first[6]) -
                          56 * (first[3] + first[5]) + 70 * first[4];
    const double size = tvi_larger(fabs(fourth), fabs(eighth));
    return (size > noise) & ((size >= KINKED * largest_change(first)) | (size >= fabs(g[0])));
}

/* Tells whether |g| may have a dip in the first part of the step, or with stride -1 in the last one. */
static bool may_dip_at_end(const double g[], int stride)
{
    const double rise = fabs(g[stride]) - fabs(g[0]);
    const bool rises = stride > 0 ? rise >= 0 : rise > 0; /* equal values at the end are a dip there */
    return have_one_sign(g[0], g[stride]) && rises && (falls(g, stride, rise) || is_kinked(g, stride));
}

/* The result of comparing two jet_v2. */
typedef long long long_v2 JET_VECTOR(long long, 2);

/* Tells whether g has no root: it is finite, of one sign, without a dip. Most steps end here, so the samples are
 * compared in pairs and without branches. */
static bool has_no_root(const double g[])
{
    double size[TVI_SAMPLES + 2];
    for (int j = 0; j <= TVI_SAMPLES; j++) size[j] = fabs(g[j]);
    size[TVI_SAMPLES + 1] = -1; /* none at the end */
    long_v2 found = {0, 0};
    for (int j = 0; j < TVI_SAMPLES; j += 2) {
        const jet_v2 now = *(const jet_v2 *)(size + j), next = *(const jet_v2 *)(size + j + 1);
        const jet_v2 after = *(const jet_v2 *)(size + j + 2), signs = *(const jet_v2 *)(g + j);
        found |= ~(signs * *(const jet_v2 *)(g + j + 1) > 0) | ~(next <= DBL_MAX);
        found |= (next < now) & (next <= after);
    }
    return !(found[0] | found[1] || may_dip_at_end(g, 1) || may_dip_at_end(g + TVI_SAMPLES, -1));
}

/* Searches a dip in the first or the last part of the step. The value next to the end distinguishes a dip inside from
 * one in the next step. */
static tvi_status search_end(tvi_search *s, int which, bool is_last)
{
    const double *g = s->watch[which].g, part = 1.0 / TVI_SAMPLES;
    const tvi_dip_point nowhere = {NAN, NAN};
    tvi_dip_point x[TVI_DIP] = {nowhere, {0, g[0]}, {EDGE, 0}, {part, g[1]}, {2 * part, g[2]}};
    const tvi_dip_point last[TVI_DIP] = {{1 - 2 * part, g[6]}, {1 - part, g[7]}, {1 - EDGE, 0}, {1, g[8]}, nowhere};
    if (is_last) memcpy(x, last, sizeof x);
    const tvi_status status = on_curve(s, which, x[2].at, &x[2].g);
    if (status != TVI_OK) return status;
    if (sign_of(x[2].g) != sign_of(x[1].g)) return add_pair(s, which, x[1], x[2], x[3]);
    if (fabs(x[2].g) < fabs(x[is_last ? 3 : 1].g)) return search_dip(s, which, x);
    return TVI_OK;
}

/* Adds the roots between the samples a and b that the signs show, b included. If g is 0 at a sample, its sign is taken
 * beside it: another root may be hidden there. */
static tvi_status search_between(tvi_search *s, int which, tvi_dip_point a, tvi_dip_point b, bool has_neighbours)
{
    const tvi_dip_point at_b = b;
    tvi_status status = TVI_OK;
    if (a.g == 0) status = beside(s, which, a.at, EDGE, &a);
    if (status == TVI_OK && b.g == 0) status = beside(s, which, b.at, -EDGE, &b);
    if (status != TVI_OK) return status;
    if (a.g != 0 && b.g != 0 && sign_of(a.g) != sign_of(b.g)) {
        tvi_root *r = add_root(s, which, sign_of(b.g), a, b);
        if (r && has_neighbours && !r->is_return) r->guess = guess_zero(s->watch[which].g, r->a, r->ga, r->b, r->gb);
    }
    const tvi_dip_point before = b.g != 0 ? b : a;
    if (at_b.g == 0 && before.g != 0) (void)add_root(s, which, -sign_of(before.g), before, at_b);
    return TVI_OK;
}

/* Drops the roots of an event whose g is only roundoff. g is tested if it changes from sample to sample by as much as
 * its size. */
static tvi_status drop_noise(tvi_search *s, int which, int before)
{
    const double *g = s->watch[which].g;
    bool is_noise = false;
    if (2 * largest_change(g) < tvi_largest(TVI_SAMPLES, g + 1, 1)) return TVI_OK;
    const tvi_status status = tvi_start_is_noise(s, which, &is_noise);
    if (is_noise) s->found = before;
    return status;
}

/* Adds all roots of one event in the step: the points where g loses its sign. */
static tvi_status search_event(tvi_search *s, int which)
{
    const double *g = s->watch[which].g;
    const int before = s->found;
    if (has_no_root(g)) return TVI_OK;
    if (!tvi_all_finite(TVI_SAMPLES, g + 1))
        return refuse_event(which, tvi_refuse_as("event function", TVI_ENONFINITE));
    tvi_dip_point all[1 + TVI_SAMPLES + 2] = {{NAN, NAN}, {0, g[0]}}, *const x = all + 1; /* one more beyond each end */
    for (int j = 1; j <= TVI_SAMPLES; j++) x[j] = (tvi_dip_point){tvi_sample_theta[j - 1], g[j]};
    x[TVI_SAMPLES + 1] = all[0];
    const bool may_return = !s->watch[which].leaves && may_dip_at_end(g, 1);
    tvi_status status = may_return ? search_end(s, which, false) : TVI_OK;
    for (int j = 1; j <= TVI_SAMPLES && status == TVI_OK; j++) {
        if (!have_one_sign(g[j - 1], g[j]))
            status = search_between(s, which, x[j - 1], x[j], g[j - 1] != 0 && g[j] != 0);
        else if (j < TVI_SAMPLES && have_one_sign(g[j], g[j + 1]) && is_dip(g + j))
            status = search_dip(s, which, x + j - 2);
    }
    if (status == TVI_OK && may_dip_at_end(g + TVI_SAMPLES, -1)) status = search_end(s, which, true);
    return status == TVI_OK && s->found > before ? drop_noise(s, which, before) : status;
}

/* Finds the event, and the operation in its own recording, that made the tape of all events fail at a sample. */
static tvi_status refuse_samples(tvi_search *s)
{
    double g;
    for (int which = 0; which < s->count; which++)
        for (int j = 0; j < TVI_SAMPLES; j++)
            if (on_curve(s, which, tvi_sample_theta[j], &g) == TVI_EDOMAIN) return TVI_EDOMAIN;
    return tvi_refuse_as("event function", TVI_EDOMAIN);
}

/* Samples g of all events. If the step continues the last one that was searched, its first sample is the last one of
 * that step. */
static tvi_status sample_events(tvi_search *s)
{
    const long step = s->it->stats.steps;
    const bool continues = s->step > 0 && *s->it->continued && step == s->step + 1;
    for (int which = 0; which < s->count; which++) s->watch[which].g[0] = s->watch[which].g[TVI_SAMPLES];
    tvi_status status = continues ? TVI_OK : tvi_start_search(s);
    if (status != TVI_OK) return status;
    tvi_sample(s->it, s->used, s->samples);
    if (!jet_sweep_values(s->tape, s->samples, TVI_SAMPLES)) status = refuse_samples(s);
    for (int which = 0; which < s->count && status == TVI_OK; which++) {
        tvi_watch *w = &s->watch[which];
        memcpy(w->g + 1, s->samples + (size_t)s->tape->output[which] * TVI_SAMPLES, TVI_SAMPLES * sizeof *w->g);
        w->leaves = false;
        if (w->g[0] == 0) status = tvi_start_leave(s, which);
        w->was_reported = false;
    }
    s->start_kind = TVI_FROM_ANY; /* an observer may change the state */
    s->step = step;
    return status;
}

tvi_status tvi_search_step(tvi_search *s)
{
    tvi_status status = sample_events(s);
    s->found = 0;
    for (int which = 0; which < s->count && status == TVI_OK; which++) status = search_event(s, which);
    return status;
}

/* Allocates the block of a tape, prepared for its inputs. */
static double *make_block(const jet_tape *tape, int lanes)
{
    double *block = malloc((size_t)tape->slots * (size_t)lanes * sizeof *block);
    if (block) jet_tape_prepare(tape, block, 1, lanes);
    return block;
}

void tvi_search_set_parameters(tvi_search *s)
{
    const int count = tvi_system_parameters(s->it->system);
    const double *value = s->it->parameters;
    for (int which = 0; which < s->count; which++) {
        const tvi_watch *w = &s->watch[which];
        jet_tape_set_parameters(w->event->tape, w->block, 1, count, 1, value);
        jet_tape_set_parameters(w->event->series, w->near.x, 1, count, 1, value);
    }
    jet_tape_set_parameters(s->tape, s->samples, TVI_SAMPLES, count, 1, value);
}

/* The range from the first component that is used to the last one. */
static tvi_range used_range(const bool used[], int n)
{
    tvi_range range = {0, n};
    while (range.end > 0 && !used[range.end - 1]) range.end--;
    while (range.first < range.end && !used[range.first]) range.first++;
    return range;
}

/* Creates the tape of all events, and finds the components of the state that it uses. */
static tvi_status join_events(tvi_search *s, const tvi_event *const events[])
{
    bool used[2 * TVI_MAX_DIMENSION + 1];
    const int n = s->it->system->n;
    const tvi_status status = tvi_event_join(&s->tape, events, s->count, used);
    if (status != TVI_OK) return status;
    s->used[0] = used_range(used, n);
    s->used[1] = used_range(used + n, n);
    return TVI_OK;
}

tvi_status tvi_search_open(tvi_search *s, tvi_between *between, const tvi_event *const events[], int count, double t,
                           const double *const state[2])
{
    const size_t some = (size_t)count;
    tvi_integrator *it = between->integrator;
    const size_t size = 2 * (size_t)it->system->n + 1;
    *s = (tvi_search){
        .it = it, .between = between, .count = count, .start_kind = tvi_start_of(it, t, state[0], state[1])};
    s->watch = calloc(some, sizeof *s->watch);
    s->roots = calloc(some * MOST_ROOTS, sizeof *s->roots);
    s->state = calloc(2 * size, sizeof *s->state);
    if (!s->watch || !s->roots || !s->state) return TVI_ENOMEM;
    s->move = s->state + size;
    for (int which = 0; which < count; which++) {
        tvi_watch *w = &s->watch[which];
        *w = (tvi_watch){.event = events[which], .block = make_block(events[which]->tape, 1)};
        if (!w->block || tvi_event_near_open(&w->near, w->event) != TVI_OK) return TVI_ENOMEM;
    }
    const tvi_status status = join_events(s, events);
    if (status != TVI_OK) return status;
    s->samples = make_block(s->tape, TVI_SAMPLES);
    if (!s->samples) return TVI_ENOMEM;
    tvi_search_set_parameters(s);
    return TVI_OK;
}

void tvi_search_close(tvi_search *s)
{
    for (int which = 0; s->watch && which < s->count; which++) {
        free(s->watch[which].block);
        tvi_event_near_close(&s->watch[which].near);
    }
    free(s->watch);
    free(s->samples);
    jet_tape_free(s->tape);
    free(s->roots);
    free(s->state);
}
