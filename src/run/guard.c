/* guard.c - steps that are too large for the orbit. The equations of a step have solutions that are not the problem's,
 * and passes may find one; or the polynomial of the step does not reach what the motion does. Two signs show it: the
 * last term of what drives the motion (tail.h), and the energy, where one is kept. The energy is computed where a step
 * may be wrong, or costs so much that this is nothing beside it. */
#include "run/guard.h"
#include "algebra/sizes.h"
#include "system/refuse.h"
#include "vector.h"

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

/* ---- Energies ---------------------------------------------------------------------------------------------------- */

/* That of the member at (q, p), rows as those of a tvi_run_state; infinite where it overflows, NAN where it has no
 * value. */
static double energy_of(tvi_integrator *it, int m, const double *q, const double *p)
{
    double H;
    const tvi_status status = tvi_member_energy(it, m, q, p, &H);
    return status == TVI_OK ? H : status == TVI_ENONFINITE ? INFINITY : NAN;
}

/* H[width] of the members that are in doubt. */
static void find_energies(tvi_integrator *it, const double *q, const double *p, double H[])
{
    if (it->energies.block) {
        tvi_energy_in_lanes(&it->energies, q + it->system->n * it->width, q, p, H);
        return;
    }
    for (int m = 0; m < it->width; m++)
        if (it->doubts[m]) H[m] = energy_of(it, m, q, p);
}

/* Where the runs began; 0: it is not known. */
static void set_scale(tvi_kept_energy *kept, double H)
{
    kept->scale = isfinite(H) ? fabs(H) : 0;
    kept->has_scale = true;
}

static void find_scales(tvi_integrator *it)
{
    const double *q = it->begun, *p = q + (it->system->n + 1) * it->width;
    find_energies(it, q, p, it->energy_before);
    for (int m = 0; m < it->width; m++)
        if (it->doubts[m] && !it->kept[m].has_scale) set_scale(&it->kept[m], it->energy_before[m]);
}

void tvi_guard_begin(tvi_integrator *it, int m)
{
    const double *q = it->begun, *p = q + (it->system->n + 1) * it->width;
    if (it->stepper->most_change && keeps_energy(it)) set_scale(&it->kept[m], energy_of(it, m, q, p));
}

/* ---- What a step changes ----------------------------------------------------------------------------------------- */

/* p.dq/dt of the step: 2 T, where there is one. */
static double action_of(const tvi_integrator *it, int m)
{
    const int width = it->width, end = it->system->n * width;
    const double *p = it->now.p, *dp = it->by.dp, *dq = it->by.dq;
    double action = 0;
    for (int k = m; k < end; k += width) action += (fabs(p[k]) + fabs(p[k] + dp[k])) * fabs(dq[k]);
    return action / (2 * fabs(dq[end + m]));
}

/* What the roundoff of q and p makes of the energy, H_p = dq/dt and -H_q = dp/dt: where terms cancel that are much
 * larger than their sum, as along an unstable direction. */
static double roundoff_of(const tvi_integrator *it, int m)
{
    const int width = it->width, end = it->system->n * width;
    const double *q = it->now.q, *p = it->now.p, *dp = it->by.dp, *dq = it->by.dq;
    double sum = 0;
    for (int k = m; k < end; k += width) sum += fabs(q[k] * dp[k]) + fabs(p[k] * dq[k]);
    return ROUNDOFF * sum / fabs(dq[end + m]);
}

/* Whether the energy becomes `after`, by what no step does. Where it has no value nothing is known, and the next step
 * says so. */
static bool loses_energy(tvi_integrator *it, int m, double after)
{
    tvi_kept_energy *kept = &it->kept[m];
    const double before = kept->H;
    kept->is_known = isfinite(before) && isfinite(after);
    if (!kept->is_known) return isfinite(before) && isinf(after);
    kept->H = after;
    const double action = action_of(it, m), of_e = tvi_is_rescaled(it) ? it->by.dp[it->system->n * it->width + m] : 0;
    const double size = kept->scale > NO_ENERGY * action ? fmax(kept->scale, fabs(before)) : PART_OF_ACTION * action;
    return fabs(after - before + of_e) > MOST_CHANGE * size + roundoff_of(it, m);
}

/* Refuses the doubtful members whose energy says that the step is too large. */
static void look_at_energies(tvi_integrator *it)
{
    const int width = it->width, n = it->system->n;
    bool has_scales = true, knows_all = true;
    for (int m = 0; m < width; m++) {
        has_scales = has_scales && (it->kept[m].has_scale || !it->doubts[m]);
        knows_all = knows_all && (it->kept[m].is_known || !it->doubts[m]);
    }
    if (!has_scales) find_scales(it);
    if (!knows_all) find_energies(it, it->now.q, it->now.p, it->energy_before);
    for (int k = 0; k < (n + 1) * width; k++) it->end.q[k] = it->now.q[k] + it->by.dq[k];
    for (int k = 0; k < n * width; k++) it->end.p[k] = it->now.p[k] + it->by.dp[k];
    find_energies(it, it->end.q, it->end.p, it->energy_after);
    for (int m = 0; m < width; m++) {
        if (!it->doubts[m]) continue;
        if (!it->kept[m].is_known) it->kept[m].H = it->energy_before[m];
        if (loses_energy(it, m, it->energy_after[m]))
            it->status[m] = jet_refuse(TVI_ETOOLARGE, "it changes the energy by what no step does");
    }
}

/* ---- Which steps are in doubt ------------------------------------------------------------------------------------ */

static bool knows_change(const tvi_integrator *it) { return it->stepper->most_change && !tvi_is_rescaled(it); }

/* The most that the step changes the energy of each member by, as the stepper knows it; else more than it can be. */
static void find_changes(tvi_integrator *it)
{
    const tvi_batch_stepper *batch = tvi_batch_of(it);
    if (!batch) it->change[0] = it->stepper->most_change(it->work);
    else if (batch->most_change) batch->most_change(it->work, it->change);
    else
        for (int m = 0; m < it->width; m++) it->change[m] = INFINITY;
}

/* Forces of one term, as those of a single node, have the tail 0, which shows nothing. */
static bool shows_tail(const tvi_integrator *it, bool took_series)
{
    return it->options.degree > (took_series ? 2 : 1);
}

/* Whether the energy need not be computed. */
static bool is_sure(const tvi_integrator *it, int m, bool took_series)
{
    if (knows_change(it)) return it->change[m] <= MOST_CHANGE * it->kept[m].scale;
    if (!shows_tail(it, took_series)) return false;
    if (took_series) return it->tail[m] <= SURE_SERIES_TAIL && it->passes[m] <= SURE_SERIES_PASSES;
    return it->tail[m] <= SURE_TAIL && it->passes[m] <= SURE_PASSES;
}

tvi_sure tvi_guard_sure(const tvi_integrator *it)
{
    const double most = it->options.max_tail;
    if (most < 0) return (tvi_sure){SURE_TAIL, SURE_PASSES};
    return (tvi_sure){shows_tail(it, false) ? tvi_smaller(most, SURE_TAIL) : -1, SURE_PASSES};
}

static bool has_small_tail(const tvi_integrator *it, double tail)
{
    const double most = it->options.max_tail;
    return most < 0 || !(tail > most);
}

JET_INLINE void guard_members(tvi_integrator *it, int width, bool took_series)
{
    const bool keeps = keeps_energy(it);
    double *largest = &it->stats.largest_tail;
    bool any = false;
    if (knows_change(it)) find_changes(it);
    for (int m = 0; m < width; m++) {
        const double tail = it->tail[m];
        it->doubts[m] = false;
        if (it->status[m] != TVI_OK) continue;
        if (tail > *largest) *largest = tail;
        if (!has_small_tail(it, tail)) {
            it->status[m] = jet_refuse(
                TVI_ETOOLARGE, "its tail %g is above max_tail = %g%s", tail, it->options.max_tail,
                it->stepped->is_automatic ? ": the automatic g is too large here (give a g of your own)" : "");
            continue;
        }
        it->doubts[m] = keeps && !is_sure(it, m, took_series);
        any = any || it->doubts[m];
        if (!it->doubts[m]) it->kept[m].is_known = false;
    }
    if (any) look_at_energies(it);
}

void tvi_guard_step(tvi_integrator *it, bool took_series)
{
    if (it->width == 1) guard_members(it, 1, took_series);
    else guard_members(it, it->width, took_series);
}
