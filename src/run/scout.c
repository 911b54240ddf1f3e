/* scout.c - a first look along an orbit. Each step is as large as just resolves it, which its tail (tvi_stats.tail)
 * tells, so that few steps see much of the run: where it is hardest, and what step would do there. */
#include "run/scout.h"
#include "algebra/sizes.h"
#include "run/integrator.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A step with a larger tail is taken back. */
static const double MOST_TAIL = 0.03;
/* What a step is multiplied by: where it fails, the first one and others; after one that did not, at most; and what its
 * tail is believed to say, at least and at most. */
static const double FIRST_FAILS = 0.125, FAILS = 0.6, GROWS = 1.6, LEAST = 0.4, MOST = 8;
/* Passages that are nearly as hard count as the first of them. */
static const double MUCH_HARDER = 0.9;
/* The part of the energy that the first one may change. */
static const double MOST_CHANGE = 0.1;
/* How far apart its halves may end, as a part of the largest coordinate or momentum. */
static const double MOST_APART = 0.25;
/* The error that a step of given size makes, as a power of the scale; and at least, relative to the hardest place. */
static const double POWER = 4, LEAST_WEIGHT = 0.02;

void tvi_orbit_set(tvi_orbit *o, int n, const double *state)
{
    memcpy(o->q, state, (size_t)n * sizeof *o->q);
    memcpy(o->p, state + n, (size_t)n * sizeof *o->p);
    o->t = state[2 * n];
    tvi_integrator_reset(o->steps);
}

static void take_sizes(tvi_scout *s, const tvi_orbit *o)
{
    for (int i = 0; i < s->n; i++) {
        s->size_q = fmax(s->size_q, fabs(o->q[i]));
        s->size_p = fmax(s->size_p, fabs(o->p[i]));
    }
}

static void keep_state(tvi_scout *s, const tvi_orbit *o)
{
    const size_t n = (size_t)s->n;
    double *const x = s->states + (size_t)s->count * (2 * n + 1);
    memcpy(x, o->q, n * sizeof *x);
    memcpy(x + n, o->p, n * sizeof *x);
    x[2 * n] = o->t;
}

/* The step that just resolves the orbit where the last one, of size h, is: tails grow by the power degree of it. */
static double scale_of(const tvi_orbit *o, double h)
{
    const double tail = tvi_integrator_stats(o->steps)->tail, degree = fmax(1, o->steps->options.degree);
    return h * (tail > 0 ? fmin(fmax(pow(TVI_SCOUT_TAIL / tail, 1 / degree), LEAST), MOST) : MOST);
}

/* What a step of size h has shown. The rest of the way to the end of the run shows little, as it is short. Returns the
 * next size. */
static double learn(tvi_scout *s, const tvi_orbit *o, double h, bool is_rest)
{
    const double scale = scale_of(o, h);
    s->place[s->count + 1] = s->place[s->count] + h;
    s->scale[s->count] = is_rest && s->count > 0 ? s->scale[s->count - 1] : scale;
    if (fabs(s->scale[s->count]) < MUCH_HARDER * fabs(s->scale[s->hardest])) s->hardest = s->count;
    s->count++;
    take_sizes(s, o);
    return tvi_shorter(scale, GROWS * h);
}

/* The next step, of size h or less. Returns the size of the one after it, or of another trial. */
static double advance(tvi_scout *s, tvi_orbit *o, double h, double left)
{
    const bool is_rest = !tvi_is_rescaled(o->steps) && fabs(left) <= fabs(h);
    const double size = is_rest ? left : h;
    keep_state(s, o);
    s->made++;
    if (tvi_is_rescaled(o->steps)) tvi_integrator_reset(o->steps); /* to the energy that its state has */
    s->status = tvi_step(o->steps, size, &o->t, o->q, o->p);
    if (s->status != TVI_OK) return size * (s->count == 0 ? FIRST_FAILS : FAILS);
    const bool may_try = s->count > 0 || s->made < TVI_SCOUT_STEPS / 2;
    if (tvi_integrator_stats(o->steps)->tail <= MOST_TAIL || !may_try) return learn(s, o, size, is_rest);
    tvi_integrator_take_back(o->steps, &o->t, o->q, o->p);
    return scale_of(o, size);
}

/* Whether two halves of the first step end about where it does: relative to where they are. */
static bool keeps_to_halves(tvi_scout *s, tvi_orbit *o)
{
    const int n = s->n;
    const double *const end = s->states + 2 * n + 1;
    double size[2] = {0, 0}, apart[2] = {0, 0};
    keep_state(s, o);
    tvi_orbit_set(o, n, s->states);
    for (int half = 0; half < 2 && s->status == TVI_OK; half++) {
        s->made++;
        s->status = tvi_step(o->steps, s->place[1] / 2, &o->t, o->q, o->p);
    }
    for (int i = 0; i < 2 * n; i++) {
        const double x = i < n ? o->q[i] : o->p[i - n];
        apart[i / n] = fmax(apart[i / n], fabs(x - end[i]));
        size[i / n] = fmax(size[i / n], fmax(fabs(x), fabs(s->states[i])));
    }
    tvi_orbit_set(o, n, end);
    return s->status == TVI_OK && apart[0] <= MOST_APART * size[0] && apart[1] <= MOST_APART * size[1];
}

/* Whether the first step keeps the energy, if the run does: one that is so large that its nodes are all far away, where
 * no force is, has no tail, nor have its halves. Relative to p.dq/dt where the energy is about 0; p from both ends, as
 * one may be at rest. */
static bool keeps_energy(tvi_scout *s, tvi_orbit *o)
{
    const tvi_system *system = o->steps->system;
    const double *const q = s->states, *const p = q + s->n, t = q[2 * s->n];
    double before, after, action = 0;
    if (system->uses_time || system->is_driven) return keeps_to_halves(s, o);
    const tvi_status first = tvi_energy(system, t, q, p, &before);
    s->status = first == TVI_OK ? tvi_energy(system, o->t, o->q, o->p, &after) : first;
    if (s->status == TVI_ENOMEM) return true;
    if (first != TVI_OK) return keeps_to_halves(s, o);
    if (s->status != TVI_OK) return false;
    for (int i = 0; i < s->n; i++) action += (fabs(p[i]) + fabs(o->p[i])) * fabs(o->q[i] - q[i]);
    return fabs(after - before) <= MOST_CHANGE * fmax(fabs(before), action / fabs(o->t - t));
}

/* A first step that is too large may not show it by its tail, but leads astray, where only much shorter ones are right,
 * or where the energy is another one. */
static bool is_astray(tvi_scout *s, tvi_orbit *o, double next)
{
    return s->count == 1 && (fabs(next) < FIRST_FAILS * fabs(s->place[1]) || !keeps_energy(s, o));
}

/* Returns a shorter first step. */
static double start_over(tvi_scout *s, tvi_orbit *o)
{
    tvi_orbit_set(o, s->n, s->states);
    s->count = s->hardest = 0;
    s->size_q = s->size_p = 0;
    take_sizes(s, o);
    return FIRST_FAILS * s->place[1];
}

tvi_status tvi_scout_look(tvi_scout *s, tvi_orbit *o, double duration)
{
    const double start = o->t, end = start + duration;
    double h = duration;
    take_sizes(s, o);
    while (s->made < TVI_SCOUT_STEPS && s->part < 1 && !s->is_blind && s->status != TVI_ENOMEM) {
        h = advance(s, o, h, end - o->t);
        if (is_astray(s, o, h)) h = start_over(s, o);
        s->part = fmin((o->t - start) / duration, 1);
        s->is_blind = s->count == 1 && o->steps->options.degree <= 2;
    }
    keep_state(s, o);
    return s->count > 0 && s->status != TVI_ENOMEM ? TVI_OK : s->status;
}

double tvi_scout_weight(const tvi_scout *s, double from, double to)
{
    const double end = s->place[s->count], hardest = s->scale[s->hardest];
    double sum = 0, all = 0;
    for (int k = 0; k < s->count; k++) {
        const double weight = fmax(pow(hardest / s->scale[k], POWER), LEAST_WEIGHT);
        const double way = fmin(fabs(to), fabs(s->place[k + 1])) - fmax(fabs(from), fabs(s->place[k]));
        sum += fmax(way, 0) * weight;
        all += fabs(s->place[k + 1] - s->place[k]) * weight;
    }
    return sum + fmax(fabs(to) - fabs(end), 0) * all / fabs(end);
}
