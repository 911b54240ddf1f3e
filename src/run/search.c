/* search.c - where g changes sign along the curve of a step. All events are looked at together, at the sample places.
 */
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

/* Beside a place that is looked at: closer roots than this are one. */
static const double EDGE = 0x1p-20;
/* |g| may have a least value next to an end of the step where its slope there is below this part of the mean one. */
static const double FLAT = 0.1;
/* g is not smooth where a high difference is a larger part of the largest first one. */
static const double KINKED = 0.05;
/* Of an event in a step: a least |g| has two. */
enum { MOST_ROOTS = 4 * TVI_SAMPLES + 4 };
/* Secants end here, in parts of the step. */
static const double LEAST_SECANT = 1e-4;
enum { MOST_SECANTS = 6 };

static int sign_of(double g) { return (g > 0) - (g < 0); }

static bool have_one_sign(double a, double b) { return a > 0 ? b > 0 : a < 0 && b < 0; }

tvi_status tvi_search_state(tvi_search *s, double theta, double x[])
{
    const int n = s->it->system->n;
    return tvi_state_at(s->it, theta, &x[2 * n], x, x + n);
}

static tvi_status of_event(int which, tvi_status status)
{
    return status == TVI_OK ? status : jet_refuse(status, "events[%d]: %s", which, jet_refusal());
}

tvi_status tvi_search_value(tvi_search *s, int which, const double x[], double *g)
{
    return of_event(which, tvi_event_value(s->of[which].event, s->of[which].block, x, g));
}

static tvi_status on_curve(tvi_search *s, int which, double theta, double *g)
{
    const tvi_status status = tvi_search_state(s, theta, s->state);
    return status == TVI_OK ? tvi_search_value(s, which, s->state, g) : status;
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

/* A root between a and b where the sign becomes `after`, if that is wanted. */
static tvi_root *add_root(tvi_search *s, int which, int after, tvi_place a, tvi_place b)
{
    const tvi_direction direction = s->of[which].event->direction;
    if (direction != TVI_EITHER && (int)direction != after) return NULL;
    tvi_root *added = &s->roots[s->found];
    *added = (tvi_root){.which = which,
                        .number = s->found,
                        .after = after,
                        .a = a.at,
                        .ga = a.g,
                        .b = b.at,
                        .gb = b.g,
                        .is_return = a.at == 0 && s->of[which].leaves,
                        .guess = NAN};
    s->found++;
    return added;
}

/* The place beside a sample where g is 0, towards the next one or the one before. */
static tvi_status beside(tvi_search *s, int which, double at, double way, tvi_place *near)
{
    near->at = at + way;
    return on_curve(s, which, near->at, &near->g);
}

/* The roots beside a place where g has another sign than at a and b, or is 0: then it may have the other one before or
 * behind it, or only touch 0. */
static tvi_status add_pair(tvi_search *s, int which, tvi_place a, tvi_place at, tvi_place b)
{
    const int sign = sign_of(a.g);
    tvi_place near = at;
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

/* |g| has a least value in the middle, where g may have another sign: looked for until it is found to have, or not. */
static tvi_status look_into_dip(tvi_search *s, int which, const tvi_place from[TVI_DIP])
{
    tvi_place x[TVI_DIP], new;
    memcpy(x, from, sizeof x);
    for (int looks = 0; tvi_dip_next(x, looks, &new.at); looks++) {
        const tvi_status status = on_curve(s, which, new.at, &new.g);
        if (status != TVI_OK) return status;
        if (sign_of(new.g) != sign_of(x[2].g)) return add_pair(s, which, from[1], new, from[3]);
        tvi_dip_take(x, new);
    }
    return TVI_OK;
}

/* Whether |g| has a least value between the samples beside g. */
static bool is_dip(const double g[]) { return (fabs(g[0]) < fabs(g[-1])) & (fabs(g[0]) <= fabs(g[1])); }

/* Whether |g| falls as it begins, or, stride -1, ends, looked at from the end of the step, or is flat: by the slope of
 * the polynomial through five samples. */
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

/* How |g| begins, or, stride -1, ends, is not known to the polynomial through the samples: g may have a kink there, at
 * which it changes sign, or a peak. Its fourth difference there or its eighth is large. */
static bool is_kinked(const double g[], int stride)
{
    const double fourth = g[0] - 4 * g[stride] + 6 * g[2 * stride] - 4 * g[3 * stride] + g[4 * stride];
    const double *first = stride > 0 ? g : g - TVI_SAMPLES, noise = 256 * DBL_EPSILON * fabs(g[0]);
    const double eighth = (first[0] + first[8]) - 8 * (first[1] + first[7]) + 28 * (first[2] + first[6]) -
                          56 * (first[3] + first[5]) + 70 * first[4];
    const double size = tvi_larger(fabs(fourth), fabs(eighth));
    return (size > noise) & ((size >= KINKED * largest_change(first)) | (size >= fabs(g[0])));
}

/* Whether |g| may have a least value in the first part; or, stride -1, in the last one. */
static bool may_dip_at_end(const double g[], int stride)
{
    const double rise = fabs(g[stride]) - fabs(g[0]);
    const bool rises = stride > 0 ? rise >= 0 : rise > 0; /* equal ones at the end are a dip there */
    return have_one_sign(g[0], g[stride]) && rises && (falls(g, stride, rise) || is_kinked(g, stride));
}

/* What comparisons of a jet_v2 give. */
typedef long long long_v2 JET_VECTOR(long long, 2);

/* Whether g has no root: finite, of one sign, without a least value. In pairs of samples and without branches, since
 * most steps end here. */
static bool is_quiet(const double g[])
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

/* A least |g| in the first or the last part: the value next to the end tells one just inside from one that lies in the
 * next step. */
static tvi_status look_at_end(tvi_search *s, int which, bool is_last)
{
    const double *g = s->of[which].g, part = 1.0 / TVI_SAMPLES;
    const tvi_place nowhere = {NAN, NAN};
    tvi_place x[TVI_DIP] = {nowhere, {0, g[0]}, {EDGE, 0}, {part, g[1]}, {2 * part, g[2]}};
    const tvi_place last[TVI_DIP] = {{1 - 2 * part, g[6]}, {1 - part, g[7]}, {1 - EDGE, 0}, {1, g[8]}, nowhere};
    if (is_last) memcpy(x, last, sizeof x);
    const tvi_status status = on_curve(s, which, x[2].at, &x[2].g);
    if (status != TVI_OK) return status;
    if (sign_of(x[2].g) != sign_of(x[1].g)) return add_pair(s, which, x[1], x[2], x[3]);
    if (fabs(x[2].g) < fabs(x[is_last ? 3 : 1].g)) return look_into_dip(s, which, x);
    return TVI_OK;
}

/* The roots between the samples a and b where the sign says so, b included. Where g is 0 at one of them, the sign is
 * that beside it: another root may be hidden there. */
static tvi_status look_between(tvi_search *s, int which, tvi_place a, tvi_place b, bool has_neighbours)
{
    const tvi_place at_b = b;
    tvi_status status = TVI_OK;
    if (a.g == 0) status = beside(s, which, a.at, EDGE, &a);
    if (status == TVI_OK && b.g == 0) status = beside(s, which, b.at, -EDGE, &b);
    if (status != TVI_OK) return status;
    if (a.g != 0 && b.g != 0 && sign_of(a.g) != sign_of(b.g)) {
        tvi_root *r = add_root(s, which, sign_of(b.g), a, b);
        if (r && has_neighbours && !r->is_return) r->guess = guess_zero(s->of[which].g, r->a, r->ga, r->b, r->gb);
    }
    const tvi_place before = b.g != 0 ? b : a;
    if (at_b.g == 0 && before.g != 0) (void)add_root(s, which, -sign_of(before.g), before, at_b);
    return TVI_OK;
}

/* Roots of a g that changes from sample to sample by as much as it is are no events where it is only roundoff. */
static tvi_status drop_noise(tvi_search *s, int which, int before)
{
    const double *g = s->of[which].g;
    bool is_noise = false;
    if (2 * largest_change(g) < tvi_largest(TVI_SAMPLES, g + 1, 1)) return TVI_OK;
    const tvi_status status = tvi_start_is_noise(s, which, &is_noise);
    if (is_noise) s->found = before;
    return status;
}

/* All places of the step where g ceases to have the sign that it had: becomes 0 or has the other one. */
static tvi_status search_event(tvi_search *s, int which)
{
    const double *g = s->of[which].g;
    const int before = s->found;
    if (is_quiet(g)) return TVI_OK;
    if (!tvi_all_finite(TVI_SAMPLES, g + 1)) return of_event(which, tvi_refuse_as("event function", TVI_ENONFINITE));
    tvi_place all[1 + TVI_SAMPLES + 2] = {{NAN, NAN}, {0, g[0]}}, *const x = all + 1; /* one more beyond each end */
    for (int j = 1; j <= TVI_SAMPLES; j++) x[j] = (tvi_place){tvi_sample_place[j - 1], g[j]};
    x[TVI_SAMPLES + 1] = all[0];
    const bool may_return = !s->of[which].leaves && may_dip_at_end(g, 1);
    tvi_status status = may_return ? look_at_end(s, which, false) : TVI_OK;
    for (int j = 1; j <= TVI_SAMPLES && status == TVI_OK; j++) {
        if (!have_one_sign(g[j - 1], g[j])) status = look_between(s, which, x[j - 1], x[j], g[j - 1] != 0 && g[j] != 0);
        else if (j < TVI_SAMPLES && have_one_sign(g[j], g[j + 1]) && is_dip(g + j))
            status = look_into_dip(s, which, x + j - 2);
    }
    if (status == TVI_OK && may_dip_at_end(g + TVI_SAMPLES, -1)) status = look_at_end(s, which, true);
    return status == TVI_OK && s->found > before ? drop_noise(s, which, before) : status;
}

/* The tape of all events has failed at a sample: which of them, and at which operation of its own recording. */
static tvi_status refuse_samples(tvi_search *s)
{
    double g;
    for (int which = 0; which < s->count; which++)
        for (int j = 0; j < TVI_SAMPLES; j++)
            if (on_curve(s, which, tvi_sample_place[j], &g) == TVI_EDOMAIN) return TVI_EDOMAIN;
    return tvi_refuse_as("event function", TVI_EDOMAIN);
}

/* g of all events at the samples; where the step leads on from the last one searched, the end of that is the start of
 * this one. */
static tvi_status sample_events(tvi_search *s)
{
    const long step = s->it->stats.steps;
    const bool continues = s->step > 0 && *s->it->continued && step == s->step + 1;
    for (int which = 0; which < s->count; which++) s->of[which].g[0] = s->of[which].g[TVI_SAMPLES];
    tvi_status status = continues ? TVI_OK : tvi_start_search(s);
    if (status != TVI_OK) return status;
    tvi_sample(s->it, s->of_state, s->samples);
    if (!jet_sweep_values(s->tape, s->samples, TVI_SAMPLES)) status = refuse_samples(s);
    for (int which = 0; which < s->count && status == TVI_OK; which++) {
        tvi_watch *w = &s->of[which];
        memcpy(w->g + 1, s->samples + (size_t)s->tape->output[which] * TVI_SAMPLES, TVI_SAMPLES * sizeof *w->g);
        w->leaves = false;
        if (w->g[0] == 0) status = tvi_start_leave(s, which);
        w->was_told = false;
    }
    s->from = TVI_FROM_ANY; /* where an observer changes something */
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

/* The block of a tape, ready for its inputs. */
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
        const tvi_watch *w = &s->of[which];
        jet_tape_place_parameters(w->event->tape, w->block, 1, count, 1, value);
        jet_tape_place_parameters(w->event->series, w->near.x, 1, count, 1, value);
    }
    jet_tape_place_parameters(s->tape, s->samples, TVI_SAMPLES, count, 1, value);
}

/* From the first component that is used to the last one. */
static tvi_range used_range(const bool used[], int n)
{
    tvi_range range = {0, n};
    while (range.end > 0 && !used[range.end - 1]) range.end--;
    while (range.first < range.end && !used[range.first]) range.first++;
    return range;
}

/* The tape of all events, and what it uses of the state. */
static tvi_status join_events(tvi_search *s, const tvi_event *const events[])
{
    bool used[2 * TVI_MAX_DIMENSION + 1];
    const int n = s->it->system->n;
    const tvi_status status = tvi_event_join(&s->tape, events, s->count, used);
    if (status != TVI_OK) return status;
    s->of_state[0] = used_range(used, n);
    s->of_state[1] = used_range(used + n, n);
    return TVI_OK;
}

tvi_status tvi_search_open(tvi_search *s, tvi_between *between, const tvi_event *const events[], int count, double t,
                           const double *const state[2])
{
    const size_t some = (size_t)count;
    tvi_integrator *it = between->steps;
    const size_t size = 2 * (size_t)it->system->n + 1;
    *s = (tvi_search){.it = it, .between = between, .count = count, .from = tvi_start_of(it, t, state[0], state[1])};
    s->of = calloc(some, sizeof *s->of);
    s->roots = calloc(some * MOST_ROOTS, sizeof *s->roots);
    s->state = calloc(2 * size, sizeof *s->state);
    if (!s->of || !s->roots || !s->state) return TVI_ENOMEM;
    s->move = s->state + size;
    for (int which = 0; which < count; which++) {
        tvi_watch *w = &s->of[which];
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
    for (int which = 0; s->of && which < s->count; which++) {
        free(s->of[which].block);
        tvi_event_near_close(&s->of[which].near);
    }
    free(s->of);
    free(s->samples);
    jet_tape_free(s->tape);
    free(s->roots);
    free(s->state);
}
