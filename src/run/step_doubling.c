/* step_doubling.c - Integrates two orbits with steps h and h/2, and measures their distance (step_doubling.h). It also
 * integrates a companion, an orbit near that of the scout (scout.h), to measure by which factor the motion stretches
 * small errors. */
#include "run/step_doubling.h"
#include "run/integrator.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The lag of two orbits counts above this part of the top speed. */
#define DOUBLING_MIN_SPEED (1.0 / 30) /* found: make suggest */
/* The companion orbit's first distance from the scout's orbit. */
#define DOUBLING_START_DISTANCE 1e-7 /* found: make suggest */

/* ---- Open and close ---------------------------------------------------------------------------------------------- */

tvi_status tvi_step_doubling_open(tvi_step_doubling *doubling, const tvi_system *system, const tvi_options *options)
{
    tvi_status status = tvi_integrator_create(&doubling->full_step_orbit.integrator, system, options);
    if (status == TVI_OK) status = tvi_integrator_create(&doubling->half_step_orbit.integrator, system, options);
    if (status != TVI_OK) return status;
    const size_t n = (size_t)system->n, state = 2 * n + 1;
    doubling->n = system->n;
    doubling->is_rescaled = tvi_is_rescaled(doubling->full_step_orbit.integrator);
    doubling->rates_input = calloc((4 + SCOUT_MAX_STEPS + 1) * state, sizeof *doubling->rates_input);
    if (!doubling->rates_input) return jet_explain_out_of_memory(TVI_ENOMEM);
    doubling->rates_output = doubling->rates_input + state;
    doubling->full_step_orbit.q = doubling->rates_output + state,
    doubling->full_step_orbit.p = doubling->full_step_orbit.q + n;
    doubling->half_step_orbit.q = doubling->full_step_orbit.q + state,
    doubling->half_step_orbit.p = doubling->half_step_orbit.q + n;
    doubling->memory_of_scout_states = doubling->half_step_orbit.q + state;
    if (!doubling->is_rescaled) return TVI_OK;
    return jet_explain_out_of_memory(
        tvi_state_rates_open(&doubling->rates_evaluator, system, doubling->full_step_orbit.integrator->parameters));
}

void tvi_step_doubling_close(tvi_step_doubling *doubling)
{
    tvi_state_rates_close(&doubling->rates_evaluator);
    free(doubling->rates_input);
    tvi_integrator_free(doubling->half_step_orbit.integrator);
    tvi_integrator_free(doubling->full_step_orbit.integrator);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

void tvi_step_doubling_set_state(tvi_step_doubling *doubling, const double *state)
{
    tvi_integrated_orbit_set_state(&doubling->full_step_orbit, doubling->n, state);
    tvi_integrated_orbit_set_state(&doubling->half_step_orbit, doubling->n, state);
}

/* Computes the time derivatives q' and p' of full_step_orbit in a rescaled system. There the two orbits are at
 * different times; their distance is corrected by the derivatives times the difference of the times. */
static tvi_status compute_rates_of_full_step_orbit(tvi_step_doubling *doubling)
{
    const size_t n = (size_t)doubling->n;
    if (!doubling->is_rescaled) return TVI_OK;
    memcpy(doubling->rates_input, doubling->full_step_orbit.q, n * sizeof *doubling->rates_input);
    memcpy(doubling->rates_input + n, doubling->full_step_orbit.p, n * sizeof *doubling->rates_input);
    doubling->rates_input[2 * n] = doubling->full_step_orbit.t;
    return tvi_state_rates_compute(&doubling->rates_evaluator, doubling->rates_input, doubling->rates_output);
}

static tvi_status make_step_of_orbit(tvi_step_doubling *doubling, tvi_integrated_orbit *orbit, double h)
{
    doubling->tried_step_count++;
    const tvi_status status = tvi_step(orbit->integrator, h, &orbit->t, orbit->q, orbit->p);
    if (status == TVI_ENOMEM) doubling->has_exhausted_memory = true;
    return status;
}

tvi_status tvi_step_doubling_make_step(tvi_step_doubling *doubling, double h)
{
    tvi_status status = make_step_of_orbit(doubling, &doubling->full_step_orbit, h);
    for (int half = 0; half < 2 && status == TVI_OK; half++)
        status = make_step_of_orbit(doubling, &doubling->half_step_orbit, h / 2);
    return status == TVI_OK ? compute_rates_of_full_step_orbit(doubling) : status;
}

/* ---- Distance ---------------------------------------------------------------------------------------------------- */

/* Measures of the difference of two orbits with the states a and b, where a is later than b by the time `lag`. At equal
 * times the difference of the states is d = a - b - lag rate_a, with the time derivative rate_a of a. Both d and rate_a
 * are divided by the largest component of b so far, separately for coordinates and momenta. */
typedef struct {
    double largest_difference;    /* the largest component of |a - b| at equal times, relative to that of |b| */
    double difference_dot_rate;   /* the scalar product d.rate_a */
    double rate_squared;          /* the scalar product rate_a.rate_a */
    double largest_relative_rate; /* the largest component of |rate_a| */
} orbit_difference;

/* Updates the measures by the n components of q or of p; *largest_component is the largest |b_i| so far. */
static void accumulate_orbit_difference(int n, const double state_a[], const double state_b[], double lag,
                                        const double rate_a[], double *largest_component, orbit_difference *measures)
{
    for (int i = 0; i < n; i++) *largest_component = fmax(*largest_component, fabs(state_b[i]));
    const double unit = *largest_component > 0 ? *largest_component : 1;
    for (int i = 0; i < n; i++) {
        const double d = (state_a[i] - state_b[i] - lag * rate_a[i]) / unit, r = rate_a[i] / unit;
        measures->largest_difference = fmax(measures->largest_difference, fabs(d));
        measures->largest_relative_rate = fmax(measures->largest_relative_rate, fabs(r));
        measures->difference_dot_rate += d * r, measures->rate_squared += r * r;
    }
}

/* The lag of one orbit behind the other is the time d.rate_a / rate_a.rate_a, where d is the difference of the two
 * orbits, and rate_a the time derivative of the first one (orbit_difference). A lag causes the largest distance where
 * the motion is fastest. */
double tvi_step_doubling_distance(tvi_step_doubling *doubling)
{
    const tvi_integrated_orbit *a = &doubling->full_step_orbit, *b = &doubling->half_step_orbit;
    const double lag = a->t - b->t;
    orbit_difference d = {0};
    accumulate_orbit_difference(doubling->n, a->q, b->q, lag, doubling->rates_output, &doubling->largest_q, &d);
    accumulate_orbit_difference(doubling->n, a->p, b->p, lag, doubling->rates_output + doubling->n,
                                &doubling->largest_p, &d);
    doubling->orbit_distance = d.largest_difference;
    doubling->largest_relative_rate = fmax(doubling->largest_relative_rate, d.largest_relative_rate);
    const bool is_fast = d.largest_relative_rate > DOUBLING_MIN_SPEED * doubling->largest_relative_rate;
    return is_fast ? fmax(d.largest_difference,
                          fabs(d.difference_dot_rate / d.rate_squared) * doubling->largest_relative_rate)
                   : d.largest_difference;
}

tvi_status tvi_measure_time_shift_distance(tvi_step_doubling *doubling, const double *start_state, double h,
                                           double start_time_shift, double *step_end_state_distance)
{
    tvi_integrated_orbit *a = &doubling->full_step_orbit, *b = &doubling->half_step_orbit;
    *step_end_state_distance = 0;
    tvi_step_doubling_set_state(doubling, start_state);
    b->t += start_time_shift;
    if (make_step_of_orbit(doubling, a, h) == TVI_OK && make_step_of_orbit(doubling, b, h) == TVI_OK &&
        compute_rates_of_full_step_orbit(doubling) == TVI_OK) {
        b->t -= start_time_shift;
        *step_end_state_distance = tvi_step_doubling_distance(doubling);
    }
    return doubling->has_exhausted_memory ? TVI_ENOMEM : TVI_OK;
}

/* ---- Growth of errors -------------------------------------------------------------------------------------------- */

/* Sets half_step_orbit to the given state, displaced by DOUBLING_START_DISTANCE in the direction of the present
 * difference of the two orbits. */
static void start_perturbed_orbit_near_state(tvi_step_doubling *doubling, const double *state)
{
    const size_t n = (size_t)doubling->n;
    tvi_integrated_orbit *b = &doubling->half_step_orbit;
    const double lag = doubling->full_step_orbit.t - b->t, unit = DOUBLING_START_DISTANCE / doubling->orbit_distance;
    for (size_t i = 0; i < n; i++) {
        b->q[i] = state[i] + unit * (doubling->full_step_orbit.q[i] - b->q[i] - lag * doubling->rates_output[i]);
        b->p[i] =
            state[n + i] + unit * (doubling->full_step_orbit.p[i] - b->p[i] - lag * doubling->rates_output[n + i]);
    }
    b->t = state[2 * n];
    tvi_integrator_reset(b->integrator);
}

/* Integrates the companion beside the scout's orbit, from state number first_state_index of the scout on. Sets
 * distances[k] to the distance of both orbits at state k, and returns the index of the last state that the companion
 * has reached. */
static int integrate_perturbed_orbit(tvi_step_doubling *doubling, const tvi_orbit_scout *scout, int first_state_index,
                                     double distances[])
{
    start_perturbed_orbit_near_state(doubling, tvi_scout_state(scout, first_state_index));
    for (int k = first_state_index; true; k++) {
        tvi_integrated_orbit_set_state(&doubling->full_step_orbit, doubling->n, tvi_scout_state(scout, k));
        if (compute_rates_of_full_step_orbit(doubling) != TVI_OK) return k - 1;
        (void)tvi_step_doubling_distance(doubling);
        distances[k] = doubling->orbit_distance;
        /* A rescaled system has a momentum e, which is -H at the start of a run. After the reset the next step computes
         * e anew from its own start, as each step of the scout does. */
        if (doubling->is_rescaled) tvi_integrator_reset(doubling->half_step_orbit.integrator);
        if (k == scout->step_count ||
            make_step_of_orbit(doubling, &doubling->half_step_orbit,
                               scout->state_abscissas[k + 1] - scout->state_abscissas[k]) != TVI_OK)
            return k;
    }
}

/* Returns the largest distance in the second half of the way between two states of the scout, divided by the largest
 * distance in the first half. */
static double compute_growth_ratio(const tvi_orbit_scout *scout, int first_state_index, int last_state_index,
                                   const double perturbed_orbit_distances[])
{
    const double middle = (scout->state_abscissas[first_state_index] + scout->state_abscissas[last_state_index]) / 2;
    double most[] = {0, 0};
    for (int k = first_state_index; k <= last_state_index; k++) {
        const bool is_later = fabs(scout->state_abscissas[k]) > fabs(middle);
        most[is_later] = fmax(most[is_later], perturbed_orbit_distances[k]);
    }
    return most[1] / most[0];
}

double tvi_step_doubling_error_ratio(tvi_step_doubling *doubling, const tvi_orbit_scout *scout,
                                     double trial_start_abscissa, double trial_end_abscissa, double *growth_ratio)
{
    int first = 0;
    double distances[SCOUT_MAX_STEPS + 1], sum = 0;
    while (scout->state_abscissas[first] != trial_start_abscissa) first++;
    do first++;
    while (first < scout->step_count && fabs(scout->state_abscissas[first + 1] - trial_end_abscissa) <
                                            fabs(scout->state_abscissas[first] - trial_end_abscissa));
    const int last = first < scout->step_count && doubling->orbit_distance > 0
                         ? integrate_perturbed_orbit(doubling, scout, first, distances)
                         : first;
    if (last <= first) return 0;
    for (int k = 1; k <= last; k++) {
        const int at = k > first ? k : first;
        const double before = at > first ? distances[at - 1] : 0, after = at < last ? distances[at + 1] : 0;
        sum += tvi_scout_weighted_length(scout, scout->state_abscissas[k - 1], scout->state_abscissas[k]) *
               distances[last] / fmax(distances[at], fmax(before, after));
    }
    *growth_ratio = compute_growth_ratio(scout, first, last, distances);
    return sum / tvi_scout_weighted_length(scout, trial_start_abscissa, trial_end_abscissa);
}
