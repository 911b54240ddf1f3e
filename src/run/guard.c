/* guard.c - steps that are too large for the orbit. The equations of a step have solutions that are not the problem's,
 * and passes may find one; or the polynomial of the step does not reach what the motion does. Two signs show it: the
 * last term of what drives the motion (tail.h), and the energy, where one is kept. The energy is computed where a step
 * may be wrong, or costs so much that this is nothing beside it. */
#include "run/guard.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>

/* With a tail below it, so few passes and no series, a step of the Galerkin curve was right in all runs of
 * docs/stability.md. Stormer-Verlet has no tail, and bounds the change of the energy by its forces. */
static const double SURE_TAIL = 1e-3;
enum { SURE_PASSES = 8 };
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

void tvi_guard_begin(tvi_integrator *it)
{
    double H;
    const int n = it->system->n;
    if (!keeps_energy(it)) return;
    if (tvi_energy_of(&it->energy, it->now.q[n], it->now.q, it->now.p, &H) != TVI_OK) return;
    *it->kept = (tvi_kept_energy){.scale = fabs(H), .H = H, .is_known = true};
}

/* p.dq/dt of the step: 2 T, where there is one. */
static double action_of(const tvi_integrator *it, const double p[])
{
    const int n = it->system->n;
    double action = 0;
    for (int i = 0; i < n; i++) action += (fabs(it->now.p[i]) + fabs(p[i])) * fabs(it->dq[i]);
    return action / (2 * fabs(it->dq[n]));
}

/* What the roundoff of q and p makes of the energy, H_p = dq/dt and -H_q = dp/dt: where terms cancel that are much
 * larger than their sum, as along an unstable direction. */
static double roundoff_of(const tvi_integrator *it)
{
    const int n = it->system->n;
    double sum = 0;
    for (int i = 0; i < n; i++) sum += fabs(it->now.q[i] * it->dp[i]) + fabs(it->now.p[i] * it->dq[i]);
    return ROUNDOFF * sum / fabs(it->dq[n]);
}

/* Whether the step changes the energy by what no step does, or overflows it. Outside of its domain, where the
 * next step says so, nothing is known. */
static bool loses_energy(tvi_integrator *it)
{
    const int n = it->system->n, dimension = it->stepped->n;
    double *q = it->end, *p = q + dimension + 1, after;
    tvi_kept_energy *kept = it->kept;
    for (int i = 0; i <= dimension; i++) q[i] = it->now.q[i] + it->dq[i];
    for (int i = 0; i < dimension; i++) p[i] = it->now.p[i] + it->dp[i];
    if (!kept->is_known && tvi_energy_of(&it->energy, it->now.q[n], it->now.q, it->now.p, &kept->H) != TVI_OK)
        return false;
    kept->is_known = false;
    const tvi_status status = tvi_energy_of(&it->energy, q[n], q, p, &after);
    if (status != TVI_OK) return status == TVI_ENONFINITE;
    const double action = action_of(it, p), of_e = dimension > n ? it->dp[n] : 0;
    const double size = kept->scale > NO_ENERGY * action ? fmax(kept->scale, fabs(kept->H)) : PART_OF_ACTION * action;
    const double change = fabs(after - kept->H + of_e);
    kept->H = after;
    kept->is_known = true;
    return change > MOST_CHANGE * size + roundoff_of(it);
}

/* Whether the energy need not be computed. */
static bool is_sure(const tvi_integrator *it, const tvi_stats *before)
{
    const tvi_stats *stats = &it->stats;
    if (it->stepper->most_change) return it->stepper->most_change(it->work) <= MOST_CHANGE * it->kept->scale;
    return stats->tail <= SURE_TAIL && stats->passes - before->passes <= SURE_PASSES &&
           stats->expansions == before->expansions;
}

tvi_status tvi_guard_step(tvi_integrator *it, const tvi_stats *before)
{
    const tvi_stats *stats = &it->stats;
    const double most = it->options.max_tail;
    if (stats->tail > stats->largest_tail) it->stats.largest_tail = stats->tail;
    if (most >= 0 && stats->tail > most)
        return jet_refuse(TVI_ETOOLARGE, "its tail %g is above max_tail = %g", stats->tail, most);
    if (keeps_energy(it) && !is_sure(it, before))
        return loses_energy(it) ? jet_refuse(TVI_ETOOLARGE, "it changes the energy by what no step does") : TVI_OK;
    it->kept->is_known = false;
    return TVI_OK;
}
