/* reference_energy.c - Finds the zero from which the guard counts the energy of a member (reference_energy.h).
 *
 * The zero is an energy of the system at rest, H(q, 0):
 *   - the limit of H(c q, 0) for large c, if there is one, as for bodies that attract each other. q is the position at
 *     the end of the step; the start is not used, since q = 0 would give a constant H(c q, 0).
 *   - Without a limit it is the lowest energy at rest along straight lines from the state, up to the point from which
 *     the energy rises. This is about the energy of an equilibrium. The zero is lowered later if the energy of the
 *     member at rest is found to be lower.
 * A constant added to H is added to the zero, too. An H that is not even in p, as in a magnetic field, has no energy at
 * rest; its zero is 0, and its scale is |H| at the start of the run. */
#include "run/reference_energy.h"

#include <math.h>

/* The factors of q are powers of 2 with these exponents. At the last two the forces of bodies are negligible, and H may
 * differ by this part of the energy. */
static const int FACTORS[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 60, 90};
static const double MOST_DIFFERENCE = 1e-9;
/* The lines are searched from NEAREST increments of the step to FARTHEST, by factors of RATIO. A step from rest that is
 * too large may be a billion times as long as it should be. */
static const double NEAREST = 0x1p-30, FARTHEST = 0x1p12, RATIO = 2;

/* Lines from the start of a step: forward or back along its increment of q, or DOWNHILL, where each coordinate moves by
 * the size of its increment in the direction of its force. */
typedef enum { FORWARD, BACK, DOWNHILL, LINES } search_line;

/* Returns one component of the line's direction, for the step's increments dq and dp of this component. `time` has the
 * sign of the step. */
static double line_direction_component(search_line line, double dq, double dp, double time)
{
    return line == FORWARD ? dq : line == BACK ? -dq : copysign(dq, dp * time);
}

double tvi_member_energy_value(tvi_integrator *it, int member, const double *q, const double *p)
{
    double H;
    const tvi_status status = tvi_member_compute_energy(it, member, q, p, &H);
    return status == TVI_OK ? H : status == TVI_ENONFINITE ? INFINITY : NAN;
}

/* Returns H(q_factor q + distance d, 0), where q is the position at the start of the member's step, and d the direction
 * of the line. */
static double energy_at_rest_on_line(tvi_integrator *it, int m, double q_factor, double distance, search_line line)
{
    const int width = it->width, end = it->system->n * width;
    const double *dq = it->increments.dq, *dp = it->increments.dp;
    for (int k = m; k < end; k += width) {
        it->end.q[k] = q_factor * it->state.q[k] + distance * line_direction_component(line, dq[k], dp[k], dq[end + m]);
        it->end.p[k] = 0;
    }
    it->end.q[end + m] = it->state.q[end + m];
    return tvi_member_energy_value(it, m, it->end.q, it->end.p);
}

static double energy_at_rest_at_step_start(tvi_integrator *it, int m)
{
    return energy_at_rest_on_line(it, m, 1, 0, FORWARD);
}

/* Tells whether H(q, -p) = H(q, p) to roundoff at the end of the step. The start is not tested, since p may be 0
 * there. */
static bool is_energy_even_in_p(tvi_integrator *it, int m)
{
    const int width = it->width, end = it->system->n * width;
    double H[2];
    for (int sign = 0; sign < 2; sign++) {
        for (int k = m; k < end; k += width) {
            const double p = it->state.p[k] + it->increments.dp[k];
            it->end.q[k] = it->state.q[k] + it->increments.dq[k];
            it->end.p[k] = sign ? -p : p;
        }
        it->end.q[end + m] = it->state.q[end + m];
        H[sign] = tvi_member_energy_value(it, m, it->end.q, it->end.p);
    }
    return fabs(H[1] - H[0]) <= MOST_DIFFERENCE * fabs(H[0]);
}

/* Returns the limit of H(c q, 0) for large c. It is NAN if there is no limit, or if H(c q, 0) is not monotonic in c: a
 * pole then lies on the way, and the limit is no measure of the motion before the pole. */
static double energy_limit_far_away(tvi_integrator *it, int m, double H, double roundoff)
{
    double last = energy_at_rest_on_line(it, m, 1, 1, FORWARD), difference = INFINITY;
    bool rises = true, falls = true;
    for (size_t k = 0; k < sizeof FACTORS / sizeof *FACTORS; k++) {
        const double factor = ldexp(1, FACTORS[k]), next = energy_at_rest_on_line(it, m, factor, factor, FORWARD);
        difference = next - last;
        rises = rises && difference >= -roundoff;
        falls = falls && difference <= roundoff;
        last = next;
    }
    return (rises || falls) && fabs(difference) <= MOST_DIFFERENCE * fabs(H - last) ? last : NAN;
}

/* Returns the lowest energy at rest along the line, from its start, where the energy is energy_at_start, to the point
 * from which the energy rises. */
static double lowest_energy_on_line(tvi_integrator *it, int m, search_line line, double energy_at_start,
                                    double roundoff)
{
    double lowest = energy_at_start;
    for (double distance = NEAREST; distance <= FARTHEST; distance *= RATIO) {
        const double next = energy_at_rest_on_line(it, m, 1, distance, line);
        if (!(next <= lowest + roundoff)) break;
        lowest = fmin(next, lowest);
    }
    return lowest;
}

static double lowest_energy_nearby(tvi_integrator *it, int m, double roundoff)
{
    const double here = energy_at_rest_at_step_start(it, m);
    double lowest = here;
    for (search_line line = 0; line < LINES; line++)
        lowest = fmin(lowest, lowest_energy_on_line(it, m, line, here, roundoff));
    return lowest;
}

/* Returns |H| at the start of the member's run. */
static double energy_size_at_run_start(tvi_integrator *it, int m)
{
    const double *q = it->run_start, *p = q + (it->system->n + 1) * it->width;
    return fabs(tvi_member_energy_value(it, m, q, p));
}

void tvi_reference_energy_find(tvi_integrator *it, int member, double H, double roundoff)
{
    tvi_reference_energy *reference = &it->reference[member];
    const double limit = energy_limit_far_away(it, member, H, roundoff);
    const bool has_rest = is_energy_even_in_p(it, member), has_limit = has_rest && !isnan(limit);
    reference->zero = has_limit ? limit : has_rest ? lowest_energy_nearby(it, member, roundoff) : 0;
    reference->scale = has_rest ? fabs(H - reference->zero) : energy_size_at_run_start(it, member);
    reference->was_searched = true;
    reference->has_scale = reference->scale > roundoff && isfinite(reference->scale);
    reference->may_be_lowered = reference->has_scale && has_rest && !has_limit;
    if (!reference->has_scale) reference->zero = reference->scale = 0; /* H at the start of the run may be NAN */
}

void tvi_reference_energy_lower(tvi_integrator *it, int member)
{
    tvi_reference_energy *reference = &it->reference[member];
    if (!reference->may_be_lowered) return;
    const double fall = reference->zero - energy_at_rest_at_step_start(it, member);
    if (!(fall > 0) || !isfinite(fall)) return;
    reference->zero -= fall;
    reference->scale += fall;
}
