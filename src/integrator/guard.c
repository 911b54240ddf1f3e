/* guard.c - Refuses steps that are too large for the orbit. The equations of such a step also have solutions that do
 * not approximate the motion, and the corrector, which solves them by iteration (passes), may converge to one of them;
 * or the polynomial of the step does not follow the motion. The guard judges a step by its tail, the relative size of
 * the last term of the polynomial of the forces (algebra/tail.h), and by the change of the energy H(q, p) if the system
 * conserves one. The change is compared with H less its zero level, which is an energy without momentum, H(q, 0), so
 * that a constant in the potential does not count. The energy is not computed if a small tail and a small number of
 * passes, or a bound of the energy change that the stepper computes, show that the step approximates the motion. */
#include "integrator/guard.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <math.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* [1] A step may change the energy by this part. Steps near a pericentre that were right to 1e-3 changed it by 4 %. */
#define GUARD_MAX_ENERGY_CHANGE 0.05 /* found: make guard */
/* [1], [passes] Steps with at most these tails and passes are accepted without a check of the energy. They were right
 * in all runs of docs/stability.md. The passes of methods with series contract faster. The energy of Galerkin steps is
 * unchecked up to this tail. */
#define GUARD_UNCHECKED_TAIL 1e-3 /* found: make stability */
/* The energy of steps with series is unchecked up to this tail. */
#define GUARD_UNCHECKED_SERIES_TAIL 1e-4 /* found: make stability */
/* The energy of Galerkin steps is unchecked up to this many passes. */
#define GUARD_UNCHECKED_PASSES 32 /* found: make stability */
/* The energy of series' steps is unchecked up to this many passes. */
#define GUARD_UNCHECKED_SERIES_PASSES 4 /* found: make stability */
/* [1] A step of bodies may have this defect. Of 160,000 steps of a planet of one star of a pair, up to half a period,
 * those that are right to 1e-3 of its distance have at most 0.22, and those that are wrong by a third at least 0.36. */
#define GUARD_MAX_DEFECT 0.28 /* found: make check-thorough, suite defect */
/* [nodes] Fewer nodes than this show no defect: their polynomial is no estimate of the forces at the ends. */
#define GUARD_DEFECT_MIN_NODES 4 /* found: make check-bodies, suite defect */
/* [1] A change of the energy is roundoff if it is below this part of |H| plus the sum of |q dp/dt| and |p dq/dt|. */
#define GUARD_ENERGY_ROUNDOFF (64 * DBL_EPSILON) /* found: make guard */
/* [1] The change of an energy that is nearly 0, such as K = g (H + e), is compared with p.dq/dt instead of the energy.
 * An energy is nearly 0 if it is at most this part of p.dq/dt. */
#define GUARD_MIN_PART_OF_ACTION 1e-6 /* found: make guard */
/* This part of p.dq/dt takes the place of an energy that is nearly 0. */
#define GUARD_PART_OF_ACTION (1.0 / 64) /* found: make guard */
/* [1] Two energies count as equal if they differ by at most this part. The guard compares the energies H(c q, 0) at two
 * large c, to find whether they have a limit, and H(q, p) and H(q, -p), to find whether H is even in p. */
#define GUARD_LEVEL_MAX_DIFFERENCE 1e-9 /* found: make check-stability, suite zero */
/* [increments of the step] The lowest energy at rest, H(q, 0), is searched at points q of lines, at growing distances.
 * A step from rest that is too large may be a billion times as long as it should be. The search for the lowest energy
 * at rest begins this far from a state. */
#define GUARD_LEVEL_MIN_DISTANCE 0x1p-30 /* found: make check-stability, suite zero */
/* The search for the lowest energy at rest ends this far from a state. */
#define GUARD_LEVEL_MAX_DISTANCE 0x1p12 /* found: make check-stability, suite zero */
/* [1] The distances of the search for this energy grow by this factor. */
#define GUARD_LEVEL_RATIO 2 /* found: make check-stability, suite zero */

/* Tells whether the system has a conserved energy, and the user has not switched off the guard (max_tail < 0). */
static bool has_conserved_energy_to_check(const tvi_integrator *it)
{
    const bool is_conserved =
        tvi_steps_K(it) || !(it->system->uses_time || it->system->is_driven || tvi_constraints_use_time(it->system));
    return it->guard.energy_work.tape_block && it->options.max_tail >= 0 && is_conserved;
}

/* Tells whether the stepper computes a bound of the change of the energy in a step. With a bound, the energy is
 * computed only if the bound exceeds the allowed change. */
static bool has_energy_change_bound(const tvi_integrator *it)
{
    return it->stepper->bound_energy_change && !tvi_is_rescaled(it);
}

/* ---- The reference energy ---------------------------------------------------------------------------------------- */

/* A potential has an arbitrary constant, so |H| is no measure of the size of a motion. The guard measures the energy of
 * an orbit from a zero level (tvi_reference_energy), which is an energy without momentum, H(q, 0):
 *   - the limit of H(c q, 0) for large c, if there is one, as for bodies that attract each other. q are the coordinates
 *     at the end of the step; the start is not used, since q = 0 would give a constant H(c q, 0).
 *   - Without a limit the level is the lowest H(q, 0) along straight lines from the state, up to the point from which
 *     H(q, 0) rises. This is about the energy of an equilibrium. The level is lowered later if a lower H(q, 0) is found
 *     on the orbit.
 * A constant added to H is added to the level, too. If H is not even in p, as in a magnetic field, H(q, 0) is not the
 * least energy at q; the level is then 0, and the scale of the energy is |H| at the start of the run. */

/* limit_of_H_at_zero_p computes H(c q, 0) for the factors c = 2^k with these exponents k. At the last two factors the
 * forces between bodies that attract each other are negligible. If H(c q, 0) has a limit, its values at these two
 * factors therefore differ little. */
static const int FAR_Q_EXPONENTS[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 60, 90};

/* The straight lines from the coordinates at the start of a step on which the lowest H(q, 0) is searched. FORWARD and
 * BACK follow the increment of q in the step and its opposite; DOWNHILL moves each coordinate by the size of its
 * increment in the direction of its force. */
typedef enum { FORWARD, BACK, DOWNHILL, LINE_COUNT } search_line;

/* Returns one component of the direction of a straight line through the start of the step, for the step's increments dq
 * and dp of this component. time_direction has the sign of the step. */
static double search_line_direction_component(search_line line, double dq, double dp, double time_direction)
{
    return line == FORWARD ? dq : line == BACK ? -dq : copysign(dq, dp * time_direction);
}

/* Returns the energy at q and p, arrays as in a tvi_run_state. It is INFINITY if the energy overflows, and NAN if it is
 * undefined. */
static double energy_or_nonfinite(tvi_integrator *it, const double *q, const double *p)
{
    double H;
    const tvi_status status = tvi_energy_compute(&it->guard.energy_work, q[it->system->n], q, p, &H);
    return status == TVI_OK ? H : status == TVI_ENONFINITE ? INFINITY : NAN;
}

/* Returns H(factor_of_step_start_q q + distance d, 0), where q are the coordinates at the start of the step, and d is
 * the direction of the line. */
static double H_at_zero_p_on_line(tvi_integrator *it, double factor_of_step_start_q, double distance, search_line line)
{
    const int n = it->system->n;
    const double *dq = it->last_step.increments.dq, *dp = it->last_step.increments.dp;
    for (int i = 0; i < n; i++) {
        it->guard.end.q[i] = factor_of_step_start_q * it->state.q[i] +
                             distance * search_line_direction_component(line, dq[i], dp[i], dq[n]);
        it->guard.end.p[i] = 0;
    }
    it->guard.end.q[n] = it->state.q[n];
    return energy_or_nonfinite(it, it->guard.end.q, it->guard.end.p);
}

static double H_at_zero_p_at_step_start(tvi_integrator *it) { return H_at_zero_p_on_line(it, 1, 0, FORWARD); }

void tvi_set_step_end(tvi_integrator *it)
{
    const int n = it->stepped->n;
    for (int i = 0; i < n; i++) {
        it->guard.end.q[i] = it->state.q[i] + it->last_step.increments.dq[i];
        it->guard.end.p[i] = it->state.p[i] + it->last_step.increments.dp[i];
    }
    it->guard.end.q[n] = it->state.q[n] + it->last_step.increments.dq[n];
}

/* Tells whether H(q, -p) and H(q, p) agree at the end of the step, up to the relative difference
 * GUARD_LEVEL_MAX_DIFFERENCE. The start is not tested, since p may be 0 there. */
static bool is_energy_even_in_p(tvi_integrator *it)
{
    tvi_set_step_end(it);
    const double H = energy_or_nonfinite(it, it->guard.end.q, it->guard.end.p);
    for (int i = 0; i < it->system->n; i++) it->guard.end.p[i] = -it->guard.end.p[i];
    return fabs(energy_or_nonfinite(it, it->guard.end.q, it->guard.end.p) - H) <= GUARD_LEVEL_MAX_DIFFERENCE * fabs(H);
}

/* Returns the limit of H(c q, 0) for large c, or NAN if there is none. The value at the largest c counts as the limit
 * if the value before it differs from it by at most the part GUARD_LEVEL_MAX_DIFFERENCE of |energy_at_start - limit|.
 * The result is also NAN if H(c q, 0) is not monotonic in c up to roundoff_of_energy: a pole then lies on the way, and
 * the limit is no measure of the motion before the pole. */
static double limit_of_H_at_zero_p(tvi_integrator *it, double energy_at_start, double roundoff_of_energy)
{
    double last = H_at_zero_p_on_line(it, 1, 1, FORWARD), difference = INFINITY;
    bool rises = true, falls = true;
    for (size_t k = 0; k < sizeof FAR_Q_EXPONENTS / sizeof *FAR_Q_EXPONENTS; k++) {
        const double factor = ldexp(1, FAR_Q_EXPONENTS[k]), next = H_at_zero_p_on_line(it, factor, factor, FORWARD);
        difference = next - last;
        rises = rises && difference >= -roundoff_of_energy;
        falls = falls && difference <= roundoff_of_energy;
        last = next;
    }
    return (rises || falls) && fabs(difference) <= GUARD_LEVEL_MAX_DIFFERENCE * fabs(energy_at_start - last) ? last
                                                                                                             : NAN;
}

/* Returns the lowest H(q, 0) along the line, from its start, where H(q, 0) is energy_at_start, to the point from which
 * H(q, 0) rises. */
static double lowest_H_at_zero_p_on_line(tvi_integrator *it, search_line line, double energy_at_start, double roundoff)
{
    double lowest = energy_at_start;
    for (double distance = GUARD_LEVEL_MIN_DISTANCE; distance <= GUARD_LEVEL_MAX_DISTANCE;
         distance *= GUARD_LEVEL_RATIO) {
        const double next = H_at_zero_p_on_line(it, 1, distance, line);
        if (!(next <= lowest + roundoff)) break;
        lowest = fmin(next, lowest);
    }
    return lowest;
}

static double lowest_H_at_zero_p(tvi_integrator *it, double roundoff)
{
    const double here = H_at_zero_p_at_step_start(it);
    double lowest = here;
    for (search_line line = 0; line < LINE_COUNT; line++)
        lowest = fmin(lowest, lowest_H_at_zero_p_on_line(it, line, here, roundoff));
    return lowest;
}

/* Returns |H| at the start of the run. */
static double energy_magnitude_at_run_start(tvi_integrator *it)
{
    const double *q = it->run_start;
    return fabs(energy_or_nonfinite(it, q, q + it->system->n + 1));
}

/* Sets zero_level and energy_scale (tvi_reference_energy) from the state at the start of the step. The energy of this
 * state is H, with the roundoff `roundoff`. */
static void set_zero_level_and_scale(tvi_integrator *it, double H, double roundoff)
{
    tvi_reference_energy *reference = it->guard.reference_energy;
    const double limit = limit_of_H_at_zero_p(it, H, roundoff);
    const bool is_even_in_p = is_energy_even_in_p(it), has_limit = is_even_in_p && !isnan(limit);
    reference->zero_level = has_limit ? limit : is_even_in_p ? lowest_H_at_zero_p(it, roundoff) : 0;
    reference->energy_scale = is_even_in_p ? fabs(H - reference->zero_level) : energy_magnitude_at_run_start(it);
    reference->was_zero_level_searched = true;
    reference->has_energy_scale = reference->energy_scale > roundoff && isfinite(reference->energy_scale);
    reference->can_zero_level_be_lowered = reference->has_energy_scale && is_even_in_p && !has_limit;
    if (!reference->has_energy_scale)
        reference->zero_level = reference->energy_scale = 0; /* not NAN, as H at the start may be: states are finite */
}

/* Lowers the zero level to H(q, 0) at the start of the step, if H(q, 0) is lower. A level that is the limit
 * for large q is kept. */
static void lower_zero_level(tvi_integrator *it)
{
    tvi_reference_energy *reference = it->guard.reference_energy;
    if (!reference->can_zero_level_be_lowered) return;
    const double fall = reference->zero_level - H_at_zero_p_at_step_start(it);
    if (!(fall > 0) || !isfinite(fall)) return;
    reference->zero_level -= fall;
    reference->energy_scale += fall;
}

/* ---- The change of the energy ------------------------------------------------------------------------------------ */

/* Returns p.dq/dt, which is about twice the kinetic energy if H has one: the sum over the components of |q1 - q0| / h
 * times the mean of |p| at both ends of the step. q0 and q1 are the coordinates at the ends, and h is the time between
 * them. */
static double mean_p_dot_velocity(const tvi_integrator *it)
{
    const int n = it->system->n;
    const double *p = it->state.p, *dp = it->last_step.increments.dp, *dq = it->last_step.increments.dq;
    double p_dot_velocity = 0;
    for (int i = 0; i < n; i++) p_dot_velocity += (fabs(p[i]) + fabs(p[i] + dp[i])) * fabs(dq[i]);
    return p_dot_velocity / (2 * fabs(dq[n]));
}

/* Returns the roundoff of the energy H: that of its value, and that caused by the roundoff of q and p, which changes H
 * by H_q dq + H_p dp with H_p = dq/dt and H_q = -dp/dt. The roundoff is large if the terms of the energy cancel, as
 * along an unstable direction. */
static double energy_roundoff(const tvi_integrator *it, double H)
{
    const int n = it->system->n;
    const double *q = it->state.q, *p = it->state.p, *dp = it->last_step.increments.dp,
                 *dq = it->last_step.increments.dq;
    double sum = 0;
    for (int i = 0; i < n; i++) sum += fabs(q[i] * dp[i]) + fabs(p[i] * dq[i]);
    return GUARD_ENERGY_ROUNDOFF * (sum / fabs(dq[n]) + fabs(H));
}

/* Returns the energy with which the change of the energy is compared: the energy above the zero level, or a part of
 * p.dq/dt (p_dot_velocity) if that energy is nearly 0. */
static double energy_change_scale(const tvi_reference_energy *reference, double energy_before, double p_dot_velocity)
{
    if (reference->energy_scale <= GUARD_MIN_PART_OF_ACTION * p_dot_velocity)
        return GUARD_PART_OF_ACTION * p_dot_velocity;
    return fmax(reference->energy_scale, fabs(energy_before - reference->zero_level));
}

/* Returns the change of the energy in the step beyond its roundoff, relative to its scale: INFINITY if the energy
 * overflows, 0 if it is NAN; the next step then fails. It is also 0 for a first step from rest by a method of order 1,
 * which changes p only, so that p.dq/dt = 0. */
static double relative_energy_change(tvi_integrator *it, double energy_after)
{
    tvi_reference_energy *reference = it->guard.reference_energy;
    const double before = reference->H;
    reference->is_H_known = isfinite(before) && isfinite(energy_after);
    if (!reference->is_H_known) return isfinite(before) && isinf(energy_after) ? INFINITY : 0;
    reference->H = energy_after;
    const double p_dot_velocity = mean_p_dot_velocity(it), roundoff = energy_roundoff(it, before),
                 change_of_e = tvi_steps_K(it) ? it->last_step.increments.dp[it->system->n] : 0,
                 change = fabs(energy_after - before + change_of_e);
    const bool needs_scale = change > roundoff || (has_energy_change_bound(it) && !reference->was_zero_level_searched);
    if (!reference->has_energy_scale && needs_scale) set_zero_level_and_scale(it, before, roundoff);
    if (change <= roundoff) return 0;
    if (!reference->has_energy_scale && p_dot_velocity == 0) return 0;
    if (change > GUARD_MAX_ENERGY_CHANGE * energy_change_scale(reference, before, p_dot_velocity) + roundoff)
        lower_zero_level(it);
    return (change - roundoff) / energy_change_scale(reference, before, p_dot_velocity);
}

/* Refuses a step that changes the energy too much. An explicit method has a single solution; its steps may change the
 * energy by much and come back, as long as they are stable and the change is not larger than the energy itself. */
static tvi_status refuse_by_energy_change(tvi_integrator *it)
{
    tvi_reference_energy *reference = it->guard.reference_energy;
    const tvi_stepper *stepper = it->stepper;
    if (!reference->is_H_known) reference->H = energy_or_nonfinite(it, it->state.q, it->state.p);
    tvi_set_step_end(it);
    const double change = relative_energy_change(it, energy_or_nonfinite(it, it->guard.end.q, it->guard.end.p));
    if (!(change > GUARD_MAX_ENERGY_CHANGE)) return TVI_OK;
    if (!stepper->compute_phase)
        return jet_refuse(TVI_ETOOLARGE, "it changes the energy by more than 5 %% (max_tail < 0 accepts it)");
    if (change > 1)
        return jet_refuse(TVI_ETOOLARGE, "it changes the energy by more than all of it (max_tail < 0 accepts it)");
    const double phase = stepper->compute_phase(it->work);
    return phase <= stepper->stable_phase
               ? TVI_OK
               : jet_refuse(TVI_ETOOLARGE,
                            "it changes the energy by more than 5 %%, and h w = %.3g, of a frequency or rate w on its "
                            "way, is above %g, where it is unstable (max_tail < 0 accepts it)",
                            phase, stepper->stable_phase);
}

/* ---- Steps whose energy is checked ------------------------------------------------------------------------------- */

/* Tells whether the tail is an estimate of an error. A polynomial of the forces with a single coefficient, as at a
 * single node, has the tail 0, which is no estimate. */
static bool is_tail_an_error_estimate(const tvi_integrator *it, bool step_used_series)
{
    return it->options.degree > (step_used_series ? 2 : 1);
}

/* Tells whether the step is accepted without computing its defect and its energy. */
static bool may_skip_energy_check(const tvi_integrator *it, bool step_used_series, long passes)
{
    const double tail = it->stats.tail;
    if (has_energy_change_bound(it))
        return it->stepper->bound_energy_change(it->work) <=
               GUARD_MAX_ENERGY_CHANGE * it->guard.reference_energy->energy_scale;
    if (!is_tail_an_error_estimate(it, step_used_series)) return false;
    return step_used_series ? tail <= GUARD_UNCHECKED_SERIES_TAIL && passes <= GUARD_UNCHECKED_SERIES_PASSES
                            : tail <= GUARD_UNCHECKED_TAIL && passes <= GUARD_UNCHECKED_PASSES;
}

tvi_unchecked_step_limits tvi_guard_unchecked_limits(const tvi_integrator *it)
{
    const double most = it->options.max_tail;
    if (most < 0) return (tvi_unchecked_step_limits){GUARD_UNCHECKED_TAIL, GUARD_UNCHECKED_PASSES};
    const double max_tail = is_tail_an_error_estimate(it, false) ? tvi_smaller(most, GUARD_UNCHECKED_TAIL) : -1;
    return (tvi_unchecked_step_limits){max_tail, GUARD_UNCHECKED_PASSES};
}

tvi_status tvi_refuse_too_large_step(tvi_integrator *it, bool step_used_series, long passes)
{
    const double tail = it->stats.tail;
    if (tail > it->stats.largest_tail) it->stats.largest_tail = tail;
    if (it->options.max_tail >= 0 && tail > it->options.max_tail)
        return jet_refuse(
            TVI_ETOOLARGE, "its tail %g is above max_tail = %g%s", tail, it->options.max_tail,
            it->stepped->tail.has_automatic_scale ? ": the automatic g is too large here (give a g of your own)" : "");
    const bool has_defect = it->guard.curve_forces && it->options.degree >= GUARD_DEFECT_MIN_NODES;
    if (has_defect && !may_skip_energy_check(it, step_used_series, passes)) {
        const double defect = tvi_defect_of_bodies(it);
        if (defect > it->stats.largest_defect) it->stats.largest_defect = defect;
        if (defect > GUARD_MAX_DEFECT)
            return jet_refuse(TVI_ETOOLARGE, "its curve misses the forces on a body at its ends by %.2g of the largest",
                              defect);
    }
    if (has_conserved_energy_to_check(it) && !may_skip_energy_check(it, step_used_series, passes))
        return refuse_by_energy_change(it);
    it->guard.reference_energy->is_H_known = false;
    return TVI_OK;
}
