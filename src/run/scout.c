/* scout.c - Explores an orbit with few large steps (scout.h), for the suggestion of a step size (suggest.c). The tail
 * of a step (tvi_stats.tail) estimates how well its polynomial resolves the forces. A step size resolves the orbit at a
 * point if a step of that size would have the tail SCOUT_RESOLVING_TAIL there. This resolving step size is extrapolated
 * from the tail of the step that was made. The hardest step of the orbit is the step with the smallest resolving step
 * size. */
#include "run/scout.h"
#include "algebra/sizes.h"
#include "run/integrator.h"

#include <math.h>
#include <string.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* A step with a larger tail is undone and repeated. */
#define SCOUT_MAX_TAIL 0.03 /* found: make suggest */
/* The scout estimates the resolving step size of a position, whose tail would be SCOUT_RESOLVING_TAIL, from the tail of
 * its last step there. The other factors are the size of the scout's next step, divided by that of the last one. The
 * scout's next step is this part of a first step that fails. */
#define SCOUT_FIRST_FAILED_FACTOR 0.125 /* found: make suggest */
/* The scout's next step is this part of a later step that fails. */
#define SCOUT_FAILED_FACTOR 0.6 /* found: make suggest */
/* The scout's next step is at most this many times the last one. */
#define SCOUT_MAX_GROWTH 1.6 /* found: make suggest */
/* The step size that is estimated to resolve the motion is at least this part of the last step. */
#define SCOUT_MIN_RESOLVING_FACTOR 0.4 /* found: make suggest */
/* The estimated resolving step size is at most this many times the last. */
#define SCOUT_MAX_RESOLVING_FACTOR 8.0 /* found: make suggest */
/* A position counts as harder than all before if the step size that resolves the motion there is below this part of the
 * least one so far. */
#define SCOUT_HARDER_FACTOR 0.9 /* found: make suggest */
/* The scout's first step may change the energy by this part. */
#define SCOUT_MAX_ENERGY_CHANGE 0.1 /* found: make suggest */
/* The scout's first step and two half steps may differ by this part. */
#define SCOUT_MAX_DISTANCE 0.25 /* found: make suggest */
/* A step's weight: its resolving step size to minus this power. */
#define SCOUT_ERROR_POWER 4.0 /* found: make suggest */
/* The least weight of a step, in weights of the hardest step. */
#define SCOUT_MIN_WEIGHT 0.02 /* found: make suggest */

void tvi_integrated_orbit_set_state(tvi_integrated_orbit *orbit, int n, const double *state)
{
    memcpy(orbit->q, state, (size_t)n * sizeof *orbit->q);
    memcpy(orbit->p, state + n, (size_t)n * sizeof *orbit->p);
    orbit->t = state[2 * n];
    tvi_integrator_reset(orbit->integrator);
}

static void update_largest_q_and_p(tvi_orbit_scout *scout, const tvi_integrated_orbit *orbit)
{
    for (int i = 0; i < scout->n; i++) {
        scout->largest_q = fmax(scout->largest_q, fabs(orbit->q[i]));
        scout->largest_p = fmax(scout->largest_p, fabs(orbit->p[i]));
    }
}

static void store_current_state(tvi_orbit_scout *scout, const tvi_integrated_orbit *orbit)
{
    const size_t n = (size_t)scout->n;
    double *const x = tvi_scout_state(scout, scout->step_count);
    memcpy(x, orbit->q, n * sizeof *x);
    memcpy(x + n, orbit->p, n * sizeof *x);
    x[2 * n] = orbit->t;
}

/* Returns the resolving step size at the last step, which had the size h: the one whose tail would be
 * SCOUT_RESOLVING_TAIL. The tail of a step is taken as proportional to the power `degree` of its size. */
static double estimate_resolving_step_size(const tvi_integrated_orbit *orbit, double h)
{
    const double tail = tvi_integrator_stats(orbit->integrator)->tail,
                 degree = fmax(1, orbit->integrator->options.degree);
    return h * (tail > 0 ? fmin(fmax(pow(SCOUT_RESOLVING_TAIL / tail, 1 / degree), SCOUT_MIN_RESOLVING_FACTOR),
                                SCOUT_MAX_RESOLVING_FACTOR)
                         : SCOUT_MAX_RESOLVING_FACTOR);
}

/* Records a step of size h, and returns the size of the next one. The last step before the end of the run may be short.
 * For this step the resolving step size of the step before is recorded. */
static double record_scout_step(tvi_orbit_scout *scout, const tvi_integrated_orbit *orbit, double h, bool is_last_step)
{
    const double scale = estimate_resolving_step_size(orbit, h);
    scout->state_abscissas[scout->step_count + 1] = scout->state_abscissas[scout->step_count] + h;
    scout->resolving_step_size[scout->step_count] =
        is_last_step && scout->step_count > 0 ? scout->resolving_step_size[scout->step_count - 1] : scale;
    if (fabs(scout->resolving_step_size[scout->step_count]) <
        SCOUT_HARDER_FACTOR * fabs(scout->resolving_step_size[scout->hardest_step_index]))
        scout->hardest_step_index = scout->step_count;
    scout->step_count++;
    update_largest_q_and_p(scout, orbit);
    return tvi_number_nearer_to_zero(scale, SCOUT_MAX_GROWTH * h);
}

/* Tries a step of size h, or of remaining_time if that is shorter. Returns the size of the next step, or of another try
 * if this one has failed or has been undone. */
static double try_scout_step(tvi_orbit_scout *scout, tvi_integrated_orbit *orbit, double h, double remaining_time)
{
    const bool is_last_step = !tvi_is_rescaled(orbit->integrator) && fabs(remaining_time) <= fabs(h);
    const double size = is_last_step ? remaining_time : h;
    store_current_state(scout, orbit);
    scout->tried_step_count++;
    /* Without the reset the step would keep e = -H of the state at which the run started. After the reset e is computed
     * from the step's own start. */
    if (tvi_is_rescaled(orbit->integrator)) tvi_integrator_reset(orbit->integrator);
    scout->last_status = tvi_step(orbit->integrator, size, &orbit->t, orbit->q, orbit->p);
    if (scout->last_status != TVI_OK)
        return size * (scout->step_count == 0 ? SCOUT_FIRST_FAILED_FACTOR : SCOUT_FAILED_FACTOR);
    const bool may_try = scout->step_count > 0 || scout->tried_step_count < SCOUT_MAX_STEPS / 2;
    if (tvi_integrator_stats(orbit->integrator)->tail <= SCOUT_MAX_TAIL || !may_try)
        return record_scout_step(scout, orbit, size, is_last_step);
    tvi_integrator_undo_step(orbit->integrator, &orbit->t, orbit->q, orbit->p);
    return estimate_resolving_step_size(orbit, size);
}

/* Tells whether two steps of half the size of the first step end near the end of the first step. */
static bool do_half_steps_agree(tvi_orbit_scout *scout, tvi_integrated_orbit *orbit)
{
    const int n = scout->n;
    const double *const end = tvi_scout_state(scout, 1);
    double size[2] = {0, 0}, apart[2] = {0, 0};
    store_current_state(scout, orbit);
    tvi_integrated_orbit_set_state(orbit, n, scout->explored_states);
    for (int half = 0; half < 2 && scout->last_status == TVI_OK; half++) {
        scout->tried_step_count++;
        scout->last_status = tvi_step(orbit->integrator, scout->state_abscissas[1] / 2, &orbit->t, orbit->q, orbit->p);
    }
    for (int i = 0; i < 2 * n; i++) {
        const double x = i < n ? orbit->q[i] : orbit->p[i - n];
        apart[i / n] = fmax(apart[i / n], fabs(x - end[i]));
        size[i / n] = fmax(size[i / n], fmax(fabs(x), fabs(scout->explored_states[i])));
    }
    tvi_integrated_orbit_set_state(orbit, n, end);
    return scout->last_status == TVI_OK && apart[0] <= SCOUT_MAX_DISTANCE * size[0] &&
           apart[1] <= SCOUT_MAX_DISTANCE * size[1];
}

/* Tells whether the first step conserves the energy. A step that is much too large may have a small tail: all its nodes
 * may be far away, where no force acts. Systems that do not conserve the energy are judged by two half steps. If the
 * energy is nearly 0, its change is compared with p.dq/dt, about twice the kinetic energy; p is taken from both ends,
 * since the motion may be at rest at one end. */
static bool is_energy_conserved(tvi_orbit_scout *scout, tvi_integrated_orbit *orbit)
{
    const tvi_system *system = orbit->integrator->system;
    const double *const q = scout->explored_states, *const p = q + scout->n, t = q[2 * scout->n];
    double before, after, action = 0;
    if (system->uses_time || system->is_driven) return do_half_steps_agree(scout, orbit);
    const tvi_status first = tvi_energy(system, t, q, p, &before);
    scout->last_status = first == TVI_OK ? tvi_energy(system, orbit->t, orbit->q, orbit->p, &after) : first;
    if (scout->last_status == TVI_ENOMEM) return true;
    if (first != TVI_OK) return do_half_steps_agree(scout, orbit);
    if (scout->last_status != TVI_OK) return false;
    for (int i = 0; i < scout->n; i++) action += (fabs(p[i]) + fabs(orbit->p[i])) * fabs(orbit->q[i] - q[i]);
    return fabs(after - before) <= SCOUT_MAX_ENERGY_CHANGE * fmax(fabs(before), action / fabs(orbit->t - t));
}

/* Tells whether the first step was too large although its tail was small: the following steps are much shorter, or the
 * step did not conserve the energy. */
static bool is_first_step_too_large(tvi_orbit_scout *scout, tvi_integrated_orbit *orbit, double next_step_size)
{
    return scout->step_count == 1 &&
           (fabs(next_step_size) < SCOUT_FIRST_FAILED_FACTOR * fabs(scout->state_abscissas[1]) ||
            !is_energy_conserved(scout, orbit));
}

/* Restores the state at the start of the run, and returns a shorter size for the first step. */
static double restart_with_shorter_step(tvi_orbit_scout *scout, tvi_integrated_orbit *orbit)
{
    tvi_integrated_orbit_set_state(orbit, scout->n, scout->explored_states);
    scout->step_count = scout->hardest_step_index = 0;
    scout->largest_q = scout->largest_p = 0;
    update_largest_q_and_p(scout, orbit);
    return SCOUT_FIRST_FAILED_FACTOR * scout->state_abscissas[1];
}

tvi_status tvi_scout_explore_orbit(tvi_orbit_scout *scout, tvi_integrated_orbit *orbit, double duration)
{
    const double start = orbit->t, end = start + duration;
    double h = duration;
    update_largest_q_and_p(scout, orbit);
    while (scout->tried_step_count < SCOUT_MAX_STEPS && scout->explored_fraction < 1 &&
           !scout->is_degree_too_low_for_tail && scout->last_status != TVI_ENOMEM) {
        h = try_scout_step(scout, orbit, h, end - orbit->t);
        if (is_first_step_too_large(scout, orbit, h)) h = restart_with_shorter_step(scout, orbit);
        scout->explored_fraction = fmin((orbit->t - start) / duration, 1);
        scout->is_degree_too_low_for_tail = scout->step_count == 1 && orbit->integrator->options.degree <= 2;
    }
    store_current_state(scout, orbit);
    return scout->step_count > 0 && scout->last_status != TVI_ENOMEM ? TVI_OK : scout->last_status;
}

double tvi_scout_weighted_length(const tvi_orbit_scout *scout, double from_abscissa, double to_abscissa)
{
    const double end = scout->state_abscissas[scout->step_count],
                 hardest = scout->resolving_step_size[scout->hardest_step_index];
    double sum = 0, all = 0;
    for (int k = 0; k < scout->step_count; k++) {
        const double weight = fmax(pow(hardest / scout->resolving_step_size[k], SCOUT_ERROR_POWER), SCOUT_MIN_WEIGHT);
        const double way = fmin(fabs(to_abscissa), fabs(scout->state_abscissas[k + 1])) -
                           fmax(fabs(from_abscissa), fabs(scout->state_abscissas[k]));
        sum += fmax(way, 0) * weight;
        all += fabs(scout->state_abscissas[k + 1] - scout->state_abscissas[k]) * weight;
    }
    return sum + fmax(fabs(to_abscissa) - fabs(end), 0) * all / fabs(end);
}
