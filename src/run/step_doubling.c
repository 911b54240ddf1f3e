/* step_doubling.c - Steps two orbits side by side, with steps h and h/2, to estimate the error of a trial (trial.c). It
 * also follows a companion beside the orbit of the scout, to measure how the orbit stretches errors. */
#include "run/step_doubling.h"
#include "run/integrator.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The lag along the orbit can be measured if the speed is at least this part of the largest one. */
static const double FAST = 1.0 / 30;
/* The distance at which the companion starts from the scout. It is much larger than roundoff, and small enough to
 * grow. */
static const double START_DISTANCE = 1e-7;

/* ---- Open and close ---------------------------------------------------------------------------------------------- */

tvi_status tvi_step_doubling_open(tvi_step_doubling *w, const tvi_system *system, const tvi_options *options)
{
    tvi_status status = tvi_integrator_create(&w->full.integrator, system, options);
    if (status == TVI_OK) status = tvi_integrator_create(&w->halved.integrator, system, options);
    if (status != TVI_OK) return status;
    const size_t n = (size_t)system->n, state = 2 * n + 1;
    w->n = system->n;
    w->is_rescaled = tvi_is_rescaled(w->full.integrator);
    w->x = calloc((4 + TVI_SCOUT_STEPS + 1) * state, sizeof *w->x);
    if (!w->x) return jet_refuse_memory(TVI_ENOMEM);
    w->rate = w->x + state;
    w->full.q = w->rate + state, w->full.p = w->full.q + n;
    w->halved.q = w->full.q + state, w->halved.p = w->halved.q + n;
    w->states = w->halved.q + state;
    if (!w->is_rescaled) return TVI_OK;
    return jet_refuse_memory(tvi_rates_open(&w->rates, system, w->full.integrator->parameters));
}

void tvi_step_doubling_close(tvi_step_doubling *w)
{
    tvi_rates_close(&w->rates);
    free(w->x);
    tvi_integrator_free(w->halved.integrator);
    tvi_integrator_free(w->full.integrator);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

void tvi_step_doubling_begin(tvi_step_doubling *w, const double *state)
{
    tvi_scout_orbit_set(&w->full, w->n, state);
    tvi_scout_orbit_set(&w->halved, w->n, state);
}

/* Sets w->rate to q' and p'. The two orbits of a rescaled system are at different times, and their distance is
 * corrected by the rate times the difference of times. */
static tvi_status find_rates(tvi_step_doubling *w)
{
    const size_t n = (size_t)w->n;
    if (!w->is_rescaled) return TVI_OK;
    memcpy(w->x, w->full.q, n * sizeof *w->x);
    memcpy(w->x + n, w->full.p, n * sizeof *w->x);
    w->x[2 * n] = w->full.t;
    return tvi_rates_at(&w->rates, w->x, w->rate);
}

static tvi_status step(tvi_step_doubling *w, tvi_scout_orbit *o, double h)
{
    w->steps_tried++;
    const tvi_status status = tvi_step(o->integrator, h, &o->t, o->q, o->p);
    if (status == TVI_ENOMEM) w->lacks_memory = true;
    return status;
}

tvi_status tvi_step_doubling_advance(tvi_step_doubling *w, double h)
{
    tvi_status status = step(w, &w->full, h);
    for (int half = 0; half < 2 && status == TVI_OK; half++) status = step(w, &w->halved, h / 2);
    return status == TVI_OK ? find_rates(w) : status;
}

/* ---- Distance ---------------------------------------------------------------------------------------------------- */

/* The measures of d = a - b - lag rate, for two orbits a and b, relative to the largest |b|: the largest |d|, the sums
 * d.rate and rate.rate, and the largest |rate|. */
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

/* d.rate / rate.rate is the lag of one orbit behind the other. This lag makes most of their distance where the motion
 * is fastest. */
double tvi_step_doubling_distance(tvi_step_doubling *w)
{
    const tvi_scout_orbit *a = &w->full, *b = &w->halved;
    const double lag = a->t - b->t;
    difference d = {0};
    compare(w->n, a->q, b->q, lag, w->rate, &w->size_q, &d);
    compare(w->n, a->p, b->p, lag, w->rate + w->n, &w->size_p, &d);
    w->distance = d.largest;
    w->fastest = fmax(w->fastest, d.fastest);
    const bool is_fast = d.fastest > FAST * w->fastest;
    return is_fast ? fmax(d.largest, fabs(d.along / d.square) * w->fastest) : d.largest;
}

tvi_status tvi_step_doubling_shift(tvi_step_doubling *w, const double *state, double h, double shift, double *apart)
{
    tvi_scout_orbit *a = &w->full, *b = &w->halved;
    *apart = 0;
    tvi_step_doubling_begin(w, state);
    b->t += shift;
    if (step(w, a, h) == TVI_OK && step(w, b, h) == TVI_OK && find_rates(w) == TVI_OK) {
        b->t -= shift;
        *apart = tvi_step_doubling_distance(w);
    }
    return w->lacks_memory ? TVI_ENOMEM : TVI_OK;
}

/* ---- Stretch ----------------------------------------------------------------------------------------------------- */

static const double *state_of(const tvi_scout *s, int position)
{
    return s->states + (size_t)position * (size_t)(2 * s->n + 1);
}

/* Sets b to the given state, displaced by START_DISTANCE in the direction of a - b. */
static void set_companion(tvi_step_doubling *w, const double *state)
{
    const size_t n = (size_t)w->n;
    tvi_scout_orbit *b = &w->halved;
    const double lag = w->full.t - b->t, unit = START_DISTANCE / w->distance;
    for (size_t i = 0; i < n; i++) {
        b->q[i] = state[i] + unit * (w->full.q[i] - b->q[i] - lag * w->rate[i]);
        b->p[i] = state[n + i] + unit * (w->full.p[i] - b->p[i] - lag * w->rate[n + i]);
    }
    b->t = state[2 * n];
    tvi_integrator_reset(b->integrator);
}

/* Steps the companion along with the scout, from position number `first`. Returns the last position that it reached,
 * and sets apart[k] to its distance from the scout at position k. */
static int follow_companion(tvi_step_doubling *w, const tvi_scout *s, int first, double apart[])
{
    set_companion(w, state_of(s, first));
    for (int k = first; true; k++) {
        tvi_scout_orbit_set(&w->full, w->n, state_of(s, k));
        if (find_rates(w) != TVI_OK) return k - 1;
        (void)tvi_step_doubling_distance(w);
        apart[k] = w->distance;
        /* to the energy of its state, as the scout's orbit */
        if (w->is_rescaled) tvi_integrator_reset(w->halved.integrator);
        if (k == s->count || step(w, &w->halved, s->position[k + 1] - s->position[k]) != TVI_OK) return k;
    }
}

/* The ratio of the largest distances in the second and in the first half of the way. */
static double growth_ratio(const tvi_scout *s, int first, int last, const double apart[])
{
    const double middle = (s->position[first] + s->position[last]) / 2;
    double most[] = {0, 0};
    for (int k = first; k <= last; k++) {
        const bool is_later = fabs(s->position[k]) > fabs(middle);
        most[is_later] = fmax(most[is_later], apart[k]);
    }
    return most[1] / most[0];
}

double tvi_step_doubling_growth(tvi_step_doubling *w, const tvi_scout *s, double from, double to, double *growth)
{
    int first = 0;
    double apart[TVI_SCOUT_STEPS + 1], sum = 0;
    while (s->position[first] != from) first++;
    do first++;
    while (first < s->count && fabs(s->position[first + 1] - to) < fabs(s->position[first] - to));
    const int last = first < s->count && w->distance > 0 ? follow_companion(w, s, first, apart) : first;
    if (last <= first) return 0;
    for (int k = 1; k <= last; k++) {
        const int at = k > first ? k : first;
        const double before = at > first ? apart[at - 1] : 0, after = at < last ? apart[at + 1] : 0;
        sum += tvi_scout_weight(s, s->position[k - 1], s->position[k]) * apart[last] /
               fmax(apart[at], fmax(before, after));
    }
    *growth = growth_ratio(s, first, last, apart);
    return sum / tvi_scout_weight(s, from, to);
}
