/* pair.c - two orbits beside one another: a trial and the same with steps of half the size; or a scout and a companion,
 * which began where the error of a trial puts it, and shows what the orbit makes of that. */
#include "run/pair.h"
#include "run/integrator.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The distance along the orbit is known where the motion is at least that part as fast as where it is fastest. */
static const double FAST = 1.0 / 30;
/* How far from the scout its companion begins: much more than roundoff, and little enough to be stretched. */
static const double BESIDE = 1e-7;

/* ---- Open and close ---------------------------------------------------------------------------------------------- */

tvi_status tvi_pair_open(tvi_pair *w, const tvi_system *system, const tvi_options *options)
{
    tvi_status status = tvi_integrator_create(&w->whole.steps, system, options);
    if (status == TVI_OK) status = tvi_integrator_create(&w->halves.steps, system, options);
    if (status != TVI_OK) return status;
    const size_t n = (size_t)system->n, state = 2 * n + 1;
    w->n = system->n;
    w->is_rescaled = tvi_is_rescaled(w->whole.steps);
    w->x = calloc((4 + TVI_SCOUT_STEPS + 1) * state, sizeof *w->x);
    if (!w->x) return jet_refuse_memory(TVI_ENOMEM);
    w->rate = w->x + state;
    w->whole.q = w->rate + state, w->whole.p = w->whole.q + n;
    w->halves.q = w->whole.q + state, w->halves.p = w->halves.q + n;
    w->states = w->halves.q + state;
    if (!w->is_rescaled) return TVI_OK;
    return jet_refuse_memory(tvi_rates_open(&w->rates, system, w->whole.steps->parameters));
}

void tvi_pair_close(tvi_pair *w)
{
    tvi_rates_close(&w->rates);
    free(w->x);
    tvi_integrator_free(w->halves.steps);
    tvi_integrator_free(w->whole.steps);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

void tvi_pair_begin(tvi_pair *w, const double *state)
{
    tvi_orbit_set(&w->whole, w->n, state);
    tvi_orbit_set(&w->halves, w->n, state);
}

/* q' and p': what the orbits of a rescaled system, which are not at the same time, differ by for each unit of it. */
static tvi_status find_rates(tvi_pair *w)
{
    const size_t n = (size_t)w->n;
    if (!w->is_rescaled) return TVI_OK;
    memcpy(w->x, w->whole.q, n * sizeof *w->x);
    memcpy(w->x + n, w->whole.p, n * sizeof *w->x);
    w->x[2 * n] = w->whole.t;
    return tvi_rates_at(&w->rates, w->x, w->rate);
}

static tvi_status step(tvi_pair *w, tvi_orbit *o, double h)
{
    w->made++;
    const tvi_status status = tvi_step(o->steps, h, &o->t, o->q, o->p);
    if (status == TVI_ENOMEM) w->lacks_memory = true;
    return status;
}

tvi_status tvi_pair_advance(tvi_pair *w, double h)
{
    tvi_status status = step(w, &w->whole, h);
    for (int half = 0; half < 2 && status == TVI_OK; half++) status = step(w, &w->halves, h / 2);
    return status == TVI_OK ? find_rates(w) : status;
}

/* ---- Distance ---------------------------------------------------------------------------------------------------- */

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

/* d.rate / rate.rate is how late the one orbit is after the other, at any place, and makes most of the distance where
 * the motion is fastest. */
double tvi_pair_distance(tvi_pair *w)
{
    const tvi_orbit *a = &w->whole, *b = &w->halves;
    const double lag = a->t - b->t;
    difference d = {0};
    compare(w->n, a->q, b->q, lag, w->rate, &w->size_q, &d);
    compare(w->n, a->p, b->p, lag, w->rate + w->n, &w->size_p, &d);
    w->apart = d.largest;
    w->fastest = fmax(w->fastest, d.fastest);
    const bool is_fast = d.fastest > FAST * w->fastest;
    return is_fast ? fmax(d.largest, fabs(d.along / d.square) * w->fastest) : d.largest;
}

tvi_status tvi_pair_shift(tvi_pair *w, const double *state, double h, double shift, double *apart)
{
    tvi_orbit *a = &w->whole, *b = &w->halves;
    *apart = 0;
    tvi_pair_begin(w, state);
    b->t += shift;
    if (step(w, a, h) == TVI_OK && step(w, b, h) == TVI_OK && find_rates(w) == TVI_OK) {
        b->t -= shift;
        *apart = tvi_pair_distance(w);
    }
    return w->lacks_memory ? TVI_ENOMEM : TVI_OK;
}

/* ---- Stretch ----------------------------------------------------------------------------------------------------- */

static const double *state_of(const tvi_scout *s, int place)
{
    return s->states + (size_t)place * (size_t)(2 * s->n + 1);
}

/* Moves b to state, and as far beside it as BESIDE, in the direction in which a is beside b. */
static void put_beside(tvi_pair *w, const double *state)
{
    const size_t n = (size_t)w->n;
    tvi_orbit *b = &w->halves;
    const double lag = w->whole.t - b->t, unit = BESIDE / w->apart;
    for (size_t i = 0; i < n; i++) {
        b->q[i] = state[i] + unit * (w->whole.q[i] - b->q[i] - lag * w->rate[i]);
        b->p[i] = state[n + i] + unit * (w->whole.p[i] - b->p[i] - lag * w->rate[n + i]);
    }
    b->t = state[2 * n];
    tvi_integrator_reset(b->steps);
}

/* Sends the companion along with the scout, from place first. Returns the last place that it reached; apart[k]: how far
 * it was from the scout at place k. */
static int follow(tvi_pair *w, const tvi_scout *s, int first, double apart[])
{
    put_beside(w, state_of(s, first));
    for (int k = first; true; k++) {
        tvi_orbit_set(&w->whole, w->n, state_of(s, k));
        if (find_rates(w) != TVI_OK) return k - 1;
        (void)tvi_pair_distance(w);
        apart[k] = w->apart;
        if (w->is_rescaled) tvi_integrator_reset(w->halves.steps); /* as the scout */
        if (k == s->count || step(w, &w->halves, s->place[k + 1] - s->place[k]) != TVI_OK) return k;
    }
}

/* How many times as far apart they were at most in the second half of the way as in the first. */
static double growth_of(const tvi_scout *s, int first, int last, const double apart[])
{
    const double middle = (s->place[first] + s->place[last]) / 2;
    double most[] = {0, 0};
    for (int k = first; k <= last; k++) {
        const bool is_later = fabs(s->place[k]) > fabs(middle);
        most[is_later] = fmax(most[is_later], apart[k]);
    }
    return most[1] / most[0];
}

double tvi_pair_stretch(tvi_pair *w, const tvi_scout *s, double from, double to, double *growth)
{
    int first = 0;
    double apart[TVI_SCOUT_STEPS + 1], sum = 0;
    while (s->place[first] != from) first++;
    do first++;
    while (first < s->count && fabs(s->place[first + 1] - to) < fabs(s->place[first] - to));
    const int last = first < s->count && w->apart > 0 ? follow(w, s, first, apart) : first;
    if (last <= first) return 0;
    for (int k = 1; k <= last; k++) {
        const int at = k > first ? k : first;
        const double before = at > first ? apart[at - 1] : 0, after = at < last ? apart[at + 1] : 0;
        sum += tvi_scout_weight(s, s->place[k - 1], s->place[k]) * apart[last] / fmax(apart[at], fmax(before, after));
    }
    *growth = growth_of(s, first, last, apart);
    return sum / tvi_scout_weight(s, from, to);
}
