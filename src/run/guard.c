/* guard.c - steps that are too large for the orbit. The equations of a step have solutions that are not the problem's,
 * and passes may find one; or the polynomial of the step does not reach what the motion does. Two signs show it: the
 * last term of what drives the motion (tail.h), and the energy, where one is kept. The energy is computed where a step
 * may be wrong, or costs so much that this is nothing beside it. */
#include "run/guard.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>

/* With a tail below it and so few passes a step was right in all runs of docs/stability.md: of the Galerkin curve, and
 * of methods with series, whose passes contract faster. Plain Taylor steps bound the change of the energy by their last
 * terms, and Stormer-Verlet, which has no tail, by its forces. */
static const double SURE_TAIL = 1e-3, SURE_SERIES_TAIL = 1e-4;
enum { SURE_PASSES = 32, SURE_SERIES_PASSES = 4 };
/* The part of the energy that a step may change. Near a pericentre steps that are right to 1e-3 were seen to change it
 * by 4 %. */
static const double MOST_CHANGE = 0.05;
/* An energy that is a smaller part of p.dq/dt than this, as that of K = g (H + e), measures nothing; then another part
 * of p.dq/dt does. */
static const double ROUNDOFF = 64 * DBL_EPSILON, NO_ENERGY = 1e-6, PART_OF_ACTION = 1.0 / 64;

static bool keeps_energy(const tvi_integrator *it)
{
    const bool rescaled = tvi_is_rescaled(it); /* keeps K = g (H + e) */
    const bool is_kept = rescaled || !(it->system->uses_time || it->system->is_driven);
    return it->energy.block && it->options.max_tail >= 0 && is_kept;
}

static void find_scale(tvi_integrator *it)
{
    double H;
    const int n = it->system->n;
    const double *q = it->begun, *p = q + n + 1;
    const tvi_status status = tvi_energy_of(&it->energy, q[n], q, p, &H);
    tvi_guard_set_scale(it->kept, status == TVI_OK ? H : 0);
}

void tvi_guard_begin(tvi_integrator *it)
{
    const int n = it->system->n;
    for (int i = 0; i <= n; i++) it->begun[i] = it->now.q[i];
    for (int i = 0; i < n; i++) it->begun[n + 1 + i] = it->now.p[i];
    if (it->stepper->most_change && keeps_energy(it)) find_scale(it);
}

/* p.dq/dt of the step: 2 T, where there is one. */
static double action_of(const tvi_guarded *s)
{
    double action = 0;
    for (int k = 0; k < s->n * s->stride; k += s->stride)
        action += (fabs(s->p[k]) + fabs(s->p[k] + s->dp[k])) * fabs(s->dq[k]);
    return action / (2 * fabs(s->dq[s->n * s->stride]));
}

/* What the roundoff of q and p makes of the energy, H_p = dq/dt and -H_q = dp/dt: where terms cancel that are much
 * larger than their sum, as along an unstable direction. */
static double roundoff_of(const tvi_guarded *s)
{
    double sum = 0;
    for (int k = 0; k < s->n * s->stride; k += s->stride) sum += fabs(s->q[k] * s->dp[k]) + fabs(s->p[k] * s->dq[k]);
    return ROUNDOFF * sum / fabs(s->dq[s->n * s->stride]);
}

bool tvi_guard_loses(const tvi_guarded *s, tvi_kept_energy *kept, tvi_status status, double after)
{
    const double before = kept->H;
    kept->is_known = status == TVI_OK;
    if (status != TVI_OK) return status == TVI_ENONFINITE;
    kept->H = after;
    const double action = action_of(s), of_e = s->dimension > s->n ? s->dp[s->n * s->stride] : 0;
    const double size = kept->scale > NO_ENERGY * action ? fmax(kept->scale, fabs(before)) : PART_OF_ACTION * action;
    return fabs(after - before + of_e) > MOST_CHANGE * size + roundoff_of(s);
}

static bool knows_change(const tvi_integrator *it) { return it->stepper->most_change && !tvi_is_rescaled(it); }

/* Forces of one term, as those of a single node, have the tail 0, which shows nothing. */
static bool shows_tail(const tvi_integrator *it, bool took_series)
{
    return it->options.degree > (took_series ? 2 : 1);
}

/* Whether the energy need not be computed. */
static bool is_sure(const tvi_integrator *it, const tvi_signs *signs, const tvi_kept_energy *kept)
{
    if (knows_change(it)) return signs->most_change && *signs->most_change <= MOST_CHANGE * kept->scale;
    if (!shows_tail(it, signs->took_series)) return false;
    if (signs->took_series) return signs->tail <= SURE_SERIES_TAIL && signs->passes <= SURE_SERIES_PASSES;
    return signs->tail <= SURE_TAIL && signs->passes <= SURE_PASSES;
}

tvi_sure tvi_guard_sure(const tvi_integrator *it)
{
    const double most = it->options.max_tail;
    if (most < 0) return (tvi_sure){SURE_TAIL, SURE_PASSES};
    return (tvi_sure){shows_tail(it, false) ? tvi_smaller(most, SURE_TAIL) : -1, SURE_PASSES};
}

bool tvi_guard_asks(const tvi_integrator *it, const tvi_signs *signs, tvi_kept_energy *kept)
{
    if (!is_sure(it, signs, kept) && keeps_energy(it)) return true;
    kept->is_known = false;
    return false;
}

tvi_status tvi_guard_tail(const tvi_integrator *it, double tail)
{
    const double most = it->options.max_tail;
    return most >= 0 && tail > most ? jet_refuse(TVI_ETOOLARGE, "its tail %g is above max_tail = %g", tail, most)
                                    : TVI_OK;
}

/* The energies where the run began and where the step starts, if they are not known, and where it ends. */
static bool loses_energy(tvi_integrator *it)
{
    const int n = it->system->n, dimension = it->stepped->n;
    const tvi_guarded s = {n, dimension, 1, it->start.q, it->start.p, it->by.dq, it->by.dp};
    double *q = it->end, *p = q + dimension + 1, after = 0;
    tvi_kept_energy *kept = it->kept;
    for (int i = 0; i <= n; i++) q[i] = s.q[i] + s.dq[i];
    for (int i = 0; i < n; i++) p[i] = s.p[i] + s.dp[i];
    if (!kept->has_scale) find_scale(it);
    if (!kept->is_known && tvi_energy_of(&it->energy, s.q[n], s.q, s.p, &kept->H) != TVI_OK) return false;
    const tvi_status status = tvi_energy_of(&it->energy, q[n], q, p, &after);
    return tvi_guard_loses(&s, kept, status, after);
}

tvi_status tvi_guard_step(tvi_integrator *it, long passes, long expansions)
{
    tvi_stats *stats = &it->stats;
    const double change = knows_change(it) ? it->stepper->most_change(it->work) : 0;
    const tvi_signs signs = {stats->tail, stats->passes - passes, stats->expansions != expansions,
                             knows_change(it) ? &change : NULL};
    if (signs.tail > stats->largest_tail) stats->largest_tail = signs.tail;
    const tvi_status status = tvi_guard_tail(it, signs.tail);
    const bool is_lost = status == TVI_OK && tvi_guard_asks(it, &signs, it->kept) && loses_energy(it);
    return is_lost ? jet_refuse(TVI_ETOOLARGE, "it changes the energy by what no step does") : status;
}
