/* search.c - where g changes sign along the curve of a step. All events are looked at together, at the sample places.
 */
#include "run/search.h"
#include "algebra/sizes.h"
#include "vector.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Close to the ends of a step. A run starts on an event where |g| is below a part of what it is there. */
static const double EDGE = 1.0 / 8192, AT_START = 1e-6;
/* |g| may have a least value next to an end of the step where its slope there is below this part of the mean one. */
static const double FLAT = 0.1;
/* A least |g| that is where a parabola has it, but for this part of it, is no zero. */
static const double SURE = 0.1;
/* Of an event in a step: a least |g| has two. */
enum { MOST_ROOTS = 2 * TVI_SAMPLES + 4 };
/* Golden sections and secants end here, in parts of the step. */
static const double LEAST_SECTION = 1e-8, LEAST_SECANT = 1e-4;
enum { MOST_SECANTS = 6 };

static int sign_of(double g) { return (g > 0) - (g < 0); }

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
tvi_status tvi_search_zero(tvi_search *s, const tvi_root *r, double *theta)
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
static tvi_root *add_root(tvi_search *s, int which, int after, double a, double ga, double b, double gb)
{
    const tvi_direction direction = s->of[which].event->direction;
    if (direction != TVI_EITHER && (int)direction != after) return NULL;
    tvi_root *added = &s->roots[s->found];
    *added = (tvi_root){.which = which, .number = s->found, .a = a, .ga = ga, .b = b, .gb = gb, .guess = NAN};
    s->found++;
    return added;
}

/* The roots beside a place where g is 0 or has another sign than at a and b. */
static void add_pair(tvi_search *s, int which, double a, double ga, double at, double g, double b, double gb)
{
    const int sign = sign_of(ga);
    (void)add_root(s, which, -sign, a, ga, at, g);
    if (g != 0) (void)add_root(s, which, sign, at, g, b, gb);
}

/* |g| has a least value in [a, b] where g may have another sign: golden sections until it is found to have, or not. */
static tvi_status follow_dip(tvi_search *s, int which, double a, double ga, double b, double gb)
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
static tvi_status look_into_dip(tvi_search *s, int which, const double at[], const double g[])
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
    return (g[0] * g[stride] > 0) & (rise >= 0) & (sign * slope <= 12 * FLAT * rise);
}

/* What comparisons of a jet_v2 give. */
typedef long long long_v2 __attribute__((vector_size(16)));

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
    return !(found[0] | found[1] | falls_first(g, 1) | falls_first(g + TVI_SAMPLES, -1));
}

/* A least |g| in the first or the last part: the sample next to the end tells one just inside from one that lies in the
 * next step. */
static tvi_status look_at_end(tvi_search *s, int which, bool is_last)
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
static tvi_status search_event(tvi_search *s, int which)
{
    double at[1 + TVI_SAMPLES] = {0}, *g = s->of[which].g;
    tvi_status status = TVI_OK;
    if (is_quiet(g)) return TVI_OK;
    if (!tvi_all_finite(TVI_SAMPLES, g + 1)) return of_event(which, tvi_refuse_as("event function", TVI_ENONFINITE));
    memcpy(at + 1, tvi_sample_place, sizeof tvi_sample_place);
    if (g[0] == 0) status = on_curve(s, which, at[0] = EDGE, &g[0]);
    else if (falls_first(g, 1)) status = look_at_end(s, which, false);
    for (int j = 1; j <= TVI_SAMPLES && status == TVI_OK; j++) {
        const int before = sign_of(g[j - 1]), now = sign_of(g[j]);
        if (before != 0 && now != before) {
            tvi_root *r = add_root(s, which, -before, at[j - 1], g[j - 1], at[j], g[j]);
            if (r) r->guess = guess_zero(g, r->a, r->ga, r->b, r->gb);
        } else if (now != 0 && before == now && j < TVI_SAMPLES && is_dip(g + j) && sign_of(g[j + 1]) == now) {
            status = look_into_dip(s, which, at + j, g + j);
        }
    }
    if (status == TVI_OK && falls_first(g + TVI_SAMPLES, -1)) status = look_at_end(s, which, true);
    return status;
}

/* Where the run starts on an event, |g| is nothing beside what it is soon. */
static tvi_status leave_start(tvi_search *s, int which)
{
    double *g = s->of[which].g, soon;
    const tvi_status status = on_curve(s, which, EDGE, &soon);
    if (status == TVI_OK && fabs(g[0]) <= AT_START * fabs(soon)) g[0] = 0;
    return status;
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
    tvi_sample(s->it, s->of_state, s->samples);
    const bool inside = jet_sweep_values(s->tape, s->samples, TVI_SAMPLES);
    tvi_status status = inside ? TVI_OK : refuse_samples(s);
    for (int which = 0; which < s->count && status == TVI_OK; which++) {
        double *g = s->of[which].g;
        g[0] = g[TVI_SAMPLES];
        memcpy(g + 1, s->samples + (size_t)s->tape->output[which] * TVI_SAMPLES, TVI_SAMPLES * sizeof *g);
        if (!continues) status = on_curve(s, which, 0, &g[0]);
        if (status == TVI_OK && s->step == 0) status = leave_start(s, which);
    }
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

/* The block of a tape, ready for its inputs; where it has parameters of the system, they are the integrator's. */
static double *make_block(const tvi_integrator *it, const jet_tape *tape, int lanes)
{
    double *block = malloc((size_t)tape->slots * (size_t)lanes * sizeof *block);
    if (!block) return NULL;
    jet_tape_prepare(tape, block, 1, lanes);
    jet_tape_place_parameters(tape, block, lanes, tvi_system_parameters(it->system), 1, it->parameters);
    return block;
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

tvi_status tvi_search_open(tvi_search *s, tvi_integrator *it, const tvi_event *const events[], int count)
{
    const size_t some = (size_t)count;
    *s = (tvi_search){.it = it, .count = count};
    s->of = calloc(some, sizeof *s->of);
    s->roots = calloc(some * MOST_ROOTS, sizeof *s->roots);
    s->state = calloc(2 * (size_t)it->system->n + 1, sizeof *s->state);
    if (!s->of || !s->roots || !s->state) return TVI_ENOMEM;
    for (int which = 0; which < count; which++) {
        s->of[which] = (tvi_watch){.event = events[which], .block = make_block(it, events[which]->tape, 1)};
        if (!s->of[which].block) return TVI_ENOMEM;
    }
    const tvi_status status = join_events(s, events);
    if (status == TVI_OK) s->samples = make_block(it, s->tape, TVI_SAMPLES);
    return status == TVI_OK && !s->samples ? TVI_ENOMEM : status;
}

void tvi_search_close(tvi_search *s)
{
    if (s->of)
        for (int which = 0; which < s->count; which++) free(s->of[which].block);
    free(s->of);
    free(s->samples);
    jet_tape_free(s->tape);
    free(s->roots);
    free(s->state);
}
