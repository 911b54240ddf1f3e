/* scout.c - Explores an orbit with few large steps, for the suggestion of a step size (suggest.c). The tail of each
 * step (tvi_stats.tail) tells which step size just resolves the orbit there. Few steps find where the run is
 * hardest. */
#include "run/scout.h"
#include "algebra/sizes.h"
#include "run/integrator.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A step with a larger tail is undone. */
static const double MOST_TAIL = 0.03;
/* Factors of the step size: after a first step that fails, and after another one that fails; the largest factor after a
 * step that succeeds; and the bounds of the factor that its tail asks for. */
static const double FIRST_FAILS = 0.125, FAILS = 0.6, GROWS = 1.6, LEAST = 0.4, MOST = 8;
/* A later position is the hardest one only if its scale is smaller by this factor. */
static const double MUCH_HARDER = 0.9;
/* The relative change of the energy that the first step may make. */
static const double MOST_CHANGE = 0.1;
/* How far apart the ends of the first step and of its halves may be, relative to the largest coordinate or momentum. */
static const double MOST_APART = 0.25;
/* The error per step of a given size grows as the scale to the power -POWER. It counts as at least LEAST_WEIGHT of that
 * at the hardest position. */
static const double POWER = 4, LEAST_WEIGHT = 0.02;

void tvi_scout_orbit_set(tvi_scout_orbit *o, int n, const double *state)
{
    memcpy(o->q, state, (size_t)n * sizeof *o->q);
    memcpy(o->p, state + n, (size_t)n * sizeof *o->p);
    o->t = state[2 * n];
    tvi_integrator_reset(o->integrator);
}

static void measure_sizes(tvi_scout *s, const tvi_scout_orbit *o)
{
    for (int i = 0; i < s->n; i++) {
        s->size_q = fmax(s->size_q, fabs(o->q[i]));
        s->size_p = fmax(s->size_p, fabs(o->p[i]));
    }
}

static void keep_state(tvi_scout *s, const tvi_scout_orbit *o)
{
    const size_t n = (size_t)s->n;
    double *const x = s->states + (size_t)s->count * (2 * n + 1);
    memcpy(x, o->q, n * sizeof *x);
    memcpy(x + n, o->p, n * sizeof *x);
    x[2 * n] = o->t;
}

/* The step that just resolves the orbit at the last step, of size h. Tails grow with the power `degree` of the step. */
static double scale_of(const tvi_scout_orbit *o, double h)
{
    const double tail = tvi_integrator_stats(o->integrator)->tail, degree = fmax(1, o->integrator->options.degree);
    return h * (tail > 0 ? fmin(fmax(pow(TVI_SCOUT_TAIL / tail, 1 / degree), LEAST), MOST) : MOST);
}

/* Records a step of size h. The last step to the end of the run may be short, and then its own scale is not recorded.
 * Returns the next size. */
static double record_step(tvi_scout *s, const tvi_scout_orbit *o, double h, bool is_rest)
{
    const double scale = scale_of(o, h);
    s->position[s->count + 1] = s->position[s->count] + h;
    s->scale[s->count] = is_rest && s->count > 0 ? s->scale[s->count - 1] : scale;
    if (fabs(s->scale[s->count]) < MUCH_HARDER * fabs(s->scale[s->hardest])) s->hardest = s->count;
    s->count++;
    measure_sizes(s, o);
    return tvi_shorter(scale, GROWS * h);
}

/* Makes the next step, of size h or less. Returns the size of the one after it, or of another try. */
static double advance(tvi_scout *s, tvi_scout_orbit *o, double h, double left)
{
    const bool is_rest = !tvi_is_rescaled(o->integrator) && fabs(left) <= fabs(h);
    const double size = is_rest ? left : h;
    keep_state(s, o);
    s->steps_tried++;
    if (tvi_is_rescaled(o->integrator)) tvi_integrator_reset(o->integrator); /* to the energy of its state */
    s->status = tvi_step(o->integrator, size, &o->t, o->q, o->p);
    if (s->status != TVI_OK) return size * (s->count == 0 ? FIRST_FAILS : FAILS);
    const bool may_try = s->count > 0 || s->steps_tried < TVI_SCOUT_STEPS / 2;
    if (tvi_integrator_stats(o->integrator)->tail <= MOST_TAIL || !may_try) return record_step(s, o, size, is_rest);
    tvi_integrator_undo_step(o->integrator, &o->t, o->q, o->p);
    return scale_of(o, size);
}

/* Tells whether two halves of the first step end near the end of the whole one, relative to the state. */
static bool halves_agree(tvi_scout *s, tvi_scout_orbit *o)
{
    const int n = s->n;
    const double *const end = s->states + 2 * n + 1;
    double size[2] = {0, 0}, apart[2] = {0, 0};
    keep_state(s, o);
    tvi_scout_orbit_set(o, n, s->states);
    for (int half = 0; half < 2 && s->status == TVI_OK; half++) {
        s->steps_tried++;
        s->status = tvi_step(o->integrator, s->position[1] / 2, &o->t, o->q, o->p);
    }
    for (int i = 0; i < 2 * n; i++) {
        const double x = i < n ? o->q[i] : o->p[i - n];
        apart[i / n] = fmax(apart[i / n], fabs(x - end[i]));
        size[i / n] = fmax(size[i / n], fmax(fabs(x), fabs(s->states[i])));
    }
    tvi_scout_orbit_set(o, n, end);
    return s->status == TVI_OK && apart[0] <= MOST_APART * size[0] && apart[1] <= MOST_APART * size[1];
}

/* Tells whether the first step conserves the energy, if the run does. A step that is so large that all its nodes are
 * far away, where no force acts, has no tail, nor have its halves. If the energy is about 0, its change is relative to
 * p.dq/dt, with p from both ends, as one end may be at rest. */
static bool keeps_energy(tvi_scout *s, tvi_scout_orbit *o)
{
    const tvi_system *system = o->integrator->system;
    const double *const q = s->states, *const p = q + s->n, t = q[2 * s->n];
    double before, after, action = 0;
    if (system->uses_time || system->is_driven) return halves_agree(s, o);
    const tvi_status first = tvi_energy(system, t, q, p, &before);
    s->status = first == TVI_OK ? tvi_energy(system, o->t, o->q, o->p, &after) : first;
    if (s->status == TVI_ENOMEM) return true;
    if (first != TVI_OK) return halves_agree(s, o);
    if (s->status != TVI_OK) return false;
    for (int i = 0; i < s->n; i++) action += (fabs(p[i]) + fabs(o->p[i])) * fabs(o->q[i] - q[i]);
    return fabs(after - before) <= MOST_CHANGE * fmax(fabs(before), action / fabs(o->t - t));
}

/* Tells whether the first step is too large without a large tail: much shorter steps follow it, or its energy
 * differs. */
static bool is_astray(tvi_scout *s, tvi_scout_orbit *o, double next)
{
    return s->count == 1 && (fabs(next) < FIRST_FAILS * fabs(s->position[1]) || !keeps_energy(s, o));
}

/* Undoes the first step, and returns a shorter one. */
static double start_over(tvi_scout *s, tvi_scout_orbit *o)
{
    tvi_scout_orbit_set(o, s->n, s->states);
    s->count = s->hardest = 0;
    s->size_q = s->size_p = 0;
    measure_sizes(s, o);
    return FIRST_FAILS * s->position[1];
}

tvi_status tvi_scout_run(tvi_scout *s, tvi_scout_orbit *o, double duration)
{
    const double start = o->t, end = start + duration;
    double h = duration;
    measure_sizes(s, o);
    while (s->steps_tried < TVI_SCOUT_STEPS && s->part < 1 && !s->has_no_tail && s->status != TVI_ENOMEM) {
        h = advance(s, o, h, end - o->t);
        if (is_astray(s, o, h)) h = start_over(s, o);
        s->part = fmin((o->t - start) / duration, 1);
        s->has_no_tail = s->count == 1 && o->integrator->options.degree <= 2;
    }
    keep_state(s, o);
    return s->count > 0 && s->status != TVI_ENOMEM ? TVI_OK : s->status;
}

double tvi_scout_weight(const tvi_scout *s, double from, double to)
{
    const double end = s->position[s->count], hardest = s->scale[s->hardest];
    double sum = 0, all = 0;
    for (int k = 0; k < s->count; k++) {
        const double weight = fmax(pow(hardest / s->scale[k], POWER), LEAST_WEIGHT);
        const double way = fmin(fabs(to), fabs(s->position[k + 1])) - fmax(fabs(from), fabs(s->position[k]));
        sum += fmax(way, 0) * weight;
        all += fabs(s->position[k + 1] - s->position[k]) * weight;
    }
    return sum + fmax(fabs(to) - fabs(end), 0) * all / fabs(end);
}
