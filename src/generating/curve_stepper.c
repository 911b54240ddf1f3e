/* curve_stepper.c - makes the steps of every method that expands one Taylor curve: it predicts the state at the curve's
 * centre, runs the passes of the corrector and computes the increments. The integrator calls it through
 * tvi_stepper_curve and tvi_stepper_taylor. A method's descriptor (method/descriptor.h) says where the curve is
 * expanded and how its ends are corrected. A method without passes has no corrections. If such a method expands its
 * curve at the start, it is the plain Taylor method. */
#include "generating/curve.h"
#include "generating/curve_stepper.h"
#include "method/method.h"

#include <math.h>
#include <string.h>

typedef tvi_curve_workspace work;

/* The step that the stepper tries to make. tvi_equations.self points to this structure. */
typedef struct {
    work *work;
    const tvi_step_origin *origin;
    double time_unit;
    tvi_stats *stats;
} step_attempt;

/* ---- The parts of a step ----------------------------------------------------------------------------------------- */

/* Computes z, the state at the centre, as the value of the curve that was expanded at the start of the step. */
static void step_compute_state_at_centre(const work *w, double z[])
{
    const tvi_corrected_curve *corrected = &w->corrected_curve;
    tvi_curve_sum_combination(&corrected->curve, &w->q_at_centre_weights, z);
    tvi_curve_sum_combination(&corrected->curve, &w->velocity_at_centre_weights,
                              z + curve_dimension(&corrected->curve));
}

/* Computes the natural sizes of the unknowns, by which their corrections are measured. A curve of degree 0 or 1 from a
 * state of rest has size 0. For these degrees the sizes of the last corrections of the ends are added. The sizes of a
 * Lagrangian's unknowns stay unchanged, since these corrections have another unit. */
static void step_compute_unknown_scales(const tvi_corrected_curve *corrected, double scale[])
{
    const tvi_curve *curve = &corrected->curve;
    const int numbers = curve_dimension(curve);
    tvi_curve_compute_centre_state_sizes(curve, scale);
    if (curve_highest_order(curve) > 1 || curve_system_form(&corrected->curve) == TVI_LAGRANGIAN) return;
    for (int i = 0; i < numbers; i++) {
        const double kappa = fabs(corrected->curve.momentum_scale_factor[i]);
        scale[i] += fabs(corrected->start_correction_q[i]) + fabs(corrected->increment_correction_q[i]);
        scale[numbers + i] +=
            kappa * (fabs(corrected->start_correction_p[i]) + fabs(corrected->increment_correction_p[i]));
    }
}

/* Computes the residual r = (q- + start_correction_q - q0, kappa (p- + start_correction_p - p0)) of the corrector, the
 * difference between the corrected start of the curve and the state (q0, p0). Small differences are added first. */
static void step_compute_residual(const work *w, const tvi_step_origin *origin, double *restrict r)
{
    const tvi_corrected_curve *corrected = &w->corrected_curve;
    const int n = curve_dimension(&corrected->curve);
    const double *Q0 = tvi_curve_position_coefficients(&corrected->curve, 0);
    tvi_curve_sum_combination(&corrected->curve, &w->q_start_minus_centre_weights, r);
    tvi_curve_sum_combination(&corrected->curve, &corrected->ends[TVI_U_START], r + n);
    for (int i = 0; i < n; i++) {
        const double kappa = corrected->curve.momentum_scale_factor[i];
        r[i] += (Q0[i] - origin->q[i]) + (corrected->start_correction_q[i] - origin->q_low[i]);
        r[n + i] = (r[n + i] - kappa * origin->p[i]) + kappa * (corrected->start_correction_p[i] - origin->p_low[i]);
    }
}

/* Computes out, the sum of the combination at the centre state z + dz to first order in dz, with dz the last correction
 * of the passes, which has not been added to z. */
static void step_sum_combination_to_first_order_in_dz(const work *w, const tvi_coefficient_combination *combination,
                                                      double out[])
{
    tvi_curve_sum_combination(&w->corrected_curve.curve, combination, out);
    if (!w->has_symplectic_end_corrections) return;
    tvi_curve_differentiate_sum_along_set_dz(&w->corrected_curve.curve, combination, w->scratch);
    for (int i = 0; i < curve_dimension(&w->corrected_curve.curve); i++) out[i] += w->scratch[i];
}

/* Computes the increments dq = (q+ - q-) + increment_correction_q and dp = (p+ - p-) + increment_correction_p. For
 * increments to a point within the step (dense output), q_increment_weights and scaled_p_increment_weights end there,
 * and correction_fraction of the corrections is added. */
static void step_compute_increments(const work *w, const tvi_coefficient_combination *q_increment_weights,
                                    const tvi_coefficient_combination *scaled_p_increment_weights,
                                    double correction_fraction, double dq[], double dp[])
{
    const tvi_corrected_curve *corrected = &w->corrected_curve;
    step_sum_combination_to_first_order_in_dz(w, q_increment_weights, dq);
    step_sum_combination_to_first_order_in_dz(w, scaled_p_increment_weights, dp);
    for (int i = 0; i < curve_dimension(&corrected->curve); i++) {
        dp[i] /= corrected->curve.momentum_scale_factor[i];
        if (!w->has_symplectic_end_corrections) continue;
        dq[i] += correction_fraction * corrected->increment_correction_q[i];
        dp[i] += correction_fraction * corrected->increment_correction_p[i];
    }
}

/* Stores the velocity at the end of a Lagrangian's curve, from which the next step searches its initial velocity. */
static void step_store_end_velocity(const work *w)
{
    const tvi_curve *curve = &w->corrected_curve.curve;
    if (curve_system_form(curve) != TVI_LAGRANGIAN) return;
    tvi_curve_sum_combination(curve, &w->scaled_end_velocity_weights, w->velocity_guess);
    for (int i = 0; i < curve_dimension(curve); i++) w->velocity_guess[i] /= curve->time_unit;
}

/* Computes the increments of the step, and stores a Lagrangian's velocity at the end. Returns the tail. */
static double step_compute_increments_and_tail(const work *w, double dq[], double dp[])
{
    const tvi_curve *curve = &w->corrected_curve.curve;
    step_compute_increments(w, &w->corrected_curve.ends[TVI_Q_STEP], &w->corrected_curve.ends[TVI_U_STEP], 1, dq, dp);
    step_store_end_velocity(w);
    tvi_curve_compute_displacement_sizes(curve);
    return tvi_curve_compute_tail(curve);
}

/* ---- The predictor ----------------------------------------------------------------------------------------------- */

static tvi_status expand_curve(const step_attempt *attempt, const double z[], double centre)
{
    tvi_curve *curve = &attempt->work->corrected_curve.curve;
    attempt->stats->expansions++;
    curve_set_time_unit(curve, attempt->time_unit);
    curve_set_centre_state(curve, z);
    return tvi_curve_expand(curve, centre);
}

/* Predicts z at the centre, by the curve that starts at (q0, p0). */
static tvi_status predict_centre_state(const step_attempt *attempt)
{
    work *w = attempt->work;
    const tvi_step_origin *origin = attempt->origin;
    tvi_status status =
        tvi_legendre_compute_start(&w->legendre_transform, w->corrected_curve.system, attempt->time_unit, origin->t,
                                   origin->q, origin->p, w->velocity_guess, w->predicted_state);
    if (status != TVI_OK || w->corrected_curve.span.start_s == 0) return status;
    status = expand_curve(attempt, w->predicted_state, origin->t + origin->t_low);
    step_compute_state_at_centre(w, w->predicted_state);
    return status;
}

static double compute_centre_time(const step_attempt *attempt)
{
    return attempt->origin->t +
           (attempt->origin->t_low + -attempt->work->corrected_curve.span.start_s * attempt->time_unit);
}

/* ---- The residual ------------------------------------------------------------------------------------------------ */

static void compute_unknown_scales(void *self, double scale[])
{
    step_compute_unknown_scales(&((const step_attempt *)self)->work->corrected_curve, scale);
}

static tvi_status compute_residual(void *self, const double z[], double r[])
{
    const step_attempt *attempt = self;
    work *w = attempt->work;
    tvi_corrected_curve *c = &w->corrected_curve;
    tvi_status status = expand_curve(attempt, z, compute_centre_time(attempt));
    if (status != TVI_OK) return status;
    attempt->stats->force_evaluations += w->options->quadrature_points;
    status = tvi_compute_action_seeds(&w->action, &c->curve, c->action_gradient_by_coefficients_Q,
                                      c->action_gradient_by_coefficients_U);
    if (status != TVI_OK) return status;
    status = c->solver->solve(c, z, w->newton.scale, attempt->stats);
    if (status != TVI_OK) return status;
    ends_compute_corrections_from_solution(c);
    step_compute_residual(w, attempt->origin, r);
    return TVI_OK;
}

/* Computes d(q-, kappa p-)/dz, the Jacobian of the residual without the derivatives of the small corrections. */
static bool compute_jacobian(void *self, double matrix[])
{
    tvi_corrected_curve *c = &((step_attempt *)self)->work->corrected_curve;
    return c->solver->jacobian(c, matrix);
}

/* Computes the roundoff of (q-, kappa p-) from that of the field at the nodes. */
static void estimate_residual_roundoff(void *self, double r[])
{
    const step_attempt *attempt = self;
    const tvi_corrected_curve *c = &attempt->work->corrected_curve;
    const double h = (c->span.end_s - c->span.start_s) * attempt->time_unit;
    attempt->stats->force_evaluations += tvi_estimate_end_state_roundoff(
        &attempt->work->action, &c->curve, h, attempt->origin->q, attempt->origin->p, r, r + c->n);
    for (int i = 0; i < c->n; i++) r[c->n + i] *= fabs(c->curve.momentum_scale_factor[i]);
}

/* Multiplies the correction by the approximate inverse of the residual's Jacobian. */
static void apply_inverse_jacobian(void *self, double correction[])
{
    tvi_corrected_curve *c = &((step_attempt *)self)->work->corrected_curve;
    c->solver->correct(c, correction);
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

static tvi_status run_corrector(step_attempt *attempt)
{
    work *w = attempt->work;
    /* If the step starts at s = 0, (q-, kappa p-) is z, and its Jacobian is the identity. A Lagrangian is an exception:
     * its z has v in place of p. */
    const bool is_identity = w->corrected_curve.span.start_s == 0 && w->corrected_curve.system->form != TVI_LAGRANGIAN;
    const tvi_end_correction_solver *solver = w->corrected_curve.solver;
    const tvi_equations equations = {.self = attempt,
                                     .residual = compute_residual,
                                     .scale = compute_unknown_scales,
                                     .jacobian = is_identity || !solver->jacobian ? NULL : compute_jacobian,
                                     .solve = is_identity || !solver->correct ? NULL : apply_inverse_jacobian,
                                     .roundoff = estimate_residual_roundoff};
    solver->begin(&w->corrected_curve);
    memcpy(w->newton.x, w->predicted_state, 2 * (size_t)w->corrected_curve.n * sizeof *w->predicted_state);
    const tvi_status status = tvi_newton_solve(&w->newton, &equations, attempt->stats);
    if (status == TVI_OK) tvi_curve_set_product_direction(&w->corrected_curve.curve, w->newton.correction);
    return status;
}

/* Rescales the curve of the plain Taylor method to tau = h, and computes the increments of its step. */
static void compute_plain_taylor_increments(work *w, double h, const tvi_increments *increments)
{
    tvi_curve *curve = &w->corrected_curve.curve;
    tvi_curve_rescale_and_sum(curve, h / curve->time_unit, increments->dq, increments->dp);
    for (int i = 0; i < curve->n; i++) increments->dp[i] /= curve->momentum_scale_factor[i];
}

/* Returns whether the step is that of the plain Taylor method: the curve is expanded at the start of the step, all of
 * its orders are summed, and its ends are not corrected. */
static bool is_step_plain_taylor_curve(const work *w)
{
    return !w->has_symplectic_end_corrections && w->corrected_curve.span.start_s == 0 && w->q_degree > 1 &&
           w->corrected_curve.curve.highest_order == w->q_degree;
}

static tvi_status step_with_one_taylor_curve(void *workspace, double h, const tvi_step_origin *origin,
                                             const tvi_increments *increments, tvi_stats *stats)
{
    work *w = workspace;
    step_attempt attempt = {w, origin, w->corrected_curve.span.tau_over_h * h, stats};
    tvi_status status = predict_centre_state(&attempt);
    if (status == TVI_OK && w->has_symplectic_end_corrections) status = run_corrector(&attempt);
    else if (status == TVI_OK) status = expand_curve(&attempt, w->predicted_state, compute_centre_time(&attempt));
    if (status != TVI_OK) return status;
    if (is_step_plain_taylor_curve(w)) {
        compute_plain_taylor_increments(w, h, increments);
        step_store_end_velocity(w);
        stats->tail = tvi_curve_compute_tail(&w->corrected_curve.curve);
    } else stats->tail = step_compute_increments_and_tail(w, increments->dq, increments->dp);
    return TVI_OK;
}

/* ---- Steps of adapted size --------------------------------------------------------------------------------------- */

/* Expands the curve with a time unit tau that is a power of 2 near the usable step, or near the largest step if that is
 * less. *usable_step becomes the size of the step that meets the tolerance. If `guess` is near that size, one expansion
 * is enough. */
static tvi_status expand_with_suitable_time_unit(step_attempt *attempt, double guess, double largest_step,
                                                 double *usable_step)
{
    const work *w = attempt->work;
    const tvi_curve *curve = &w->corrected_curve.curve;
    int exponent, highest;
    /* The least usable step that expansions with a too large tau have shown. A large tau shows terms that underflow
     * with a smaller one, so that the last expansion may not show them. */
    double least_usable_step = INFINITY;
    tvi_status status = TVI_OK;
    (void)frexp(guess, &exponent);
    (void)frexp(largest_step, &highest);
    for (int count = 0; count < STEP_SIZE_MAX_EXPANSIONS; count++) {
        attempt->time_unit = copysign(ldexp(1, exponent), largest_step);
        status = predict_centre_state(attempt);
        if (status == TVI_OK) status = expand_curve(attempt, w->predicted_state, compute_centre_time(attempt));
        if (status != TVI_OK && status != TVI_ENONFINITE) return status;
        double usable_s = 0; /* the usable step in units of tau; 0 if the coefficients overflow */
        if (status == TVI_OK) usable_s = tvi_curve_estimate_largest_usable_s(curve, w->log_adapted_step_tolerance);
        *usable_step = fmin(usable_s * fabs(attempt->time_unit), least_usable_step);
        usable_s = *usable_step / fabs(attempt->time_unit);
        if (usable_s >= 1 / STEP_SIZE_MAX_TAU_RATIO && (usable_s <= STEP_SIZE_MAX_TAU_RATIO || exponent >= highest))
            return TVI_OK;
        if (usable_s < 1 / STEP_SIZE_MAX_TAU_RATIO && usable_s > 0) {
            highest = exponent - 1;
            least_usable_step = *usable_step;
        }
        const int wanted = usable_s == 0        ? -4 * ilogb(STEP_SIZE_MAX_TAU_RATIO)
                           : isfinite(usable_s) ? ilogb(usable_s)
                                                : highest - exponent;
        exponent = exponent + wanted < highest ? exponent + wanted : highest;
    }
    return status == TVI_OK ? TVI_ENOCONV : status;
}

static tvi_status step_to_tolerance(void *workspace, double tolerance, double *h, const tvi_step_origin *origin,
                                    const tvi_increments *increments, tvi_stats *stats)
{
    work *w = workspace;
    tvi_curve *curve = &w->corrected_curve.curve;
    step_attempt attempt = {w, origin, 0, stats};
    const double before = *w->last_adapted_step_size;
    double usable_step;
    if (tolerance != w->adapted_step_tolerance) {
        w->adapted_step_tolerance = tolerance;
        w->log_adapted_step_tolerance = log(tolerance);
    }
    const tvi_status status = expand_with_suitable_time_unit(&attempt, before != 0 ? before : *h, *h, &usable_step);
    if (status != TVI_OK) { /* the curve could not be expanded with this tau */
        *h = attempt.time_unit;
        return status;
    }
    const bool must_check_end = usable_step > STEP_SIZE_CHECKED_GROWTH * before;
    if (before != 0) usable_step = fmin(usable_step, STEP_SIZE_MAX_GROWTH * before);
    bool is_chosen = usable_step < fabs(*h);
    if (is_chosen) *h = copysign(usable_step, *h);
    compute_plain_taylor_increments(w, *h, increments);
    while (must_check_end && !tvi_curve_matches_force_at_end(w, tolerance, *h, origin, increments) &&
           origin->t + *h != origin->t) {
        *h /= 2;
        is_chosen = true;
        compute_plain_taylor_increments(w, *h, increments);
    }
    if (is_chosen) *w->last_adapted_step_size = fabs(*h);
    if (is_chosen && origin->t + *h == origin->t) return TVI_ENOCONV;
    stats->tail = tvi_curve_compute_tail(curve);
    if (tvi_needs_refined_increments(w->corrected_curve.system, tolerance))
        tvi_compute_refined_increments(&w->refinement, curve, *h, origin, increments);
    return TVI_OK;
}

/* Computes the increments from the start of the step to its fraction theta, with the fraction theta of the corrections.
 */
static void compute_dense_output(void *workspace, double theta, double dq[], double dp[])
{
    work *w = workspace;
    const tvi_corrected_curve *c = &w->corrected_curve;
    const double at = c->span.start_s + theta * (c->span.end_s - c->span.start_s);
    tvi_combination_set_power_weights(&w->dense_output_q_weights, &c->curve, false, w->q_degree, 1, at, -1,
                                      c->span.start_s);
    tvi_combination_set_power_weights(&w->dense_output_scaled_p_weights, &c->curve, true, w->corrected_curve.p_degree,
                                      1, at, -1, c->span.start_s);
    step_compute_increments(w, &w->dense_output_q_weights, &w->dense_output_scaled_p_weights, theta, dq, dp);
}

static double bound_energy_change(const void *workspace)
{
    return tvi_curve_bound_energy_change(&((const work *)workspace)->corrected_curve.curve);
}

static tvi_tapes_of_steps find_used_tapes(const tvi_system *system, const tvi_options *options)
{
    const tvi_curve_definition *definition = &tvi_find_method(options)->curve;
    const bool has_symplectic_end_corrections = definition->equations.upper && options->passes != TVI_PREDICT_ONLY;
    const tvi_action shape = tvi_create_unallocated_action(system, options);
    return tvi_curve_find_used_tapes(system, options, shape.node_count,
                                     has_symplectic_end_corrections ? tvi_curve_choose_jacobian_method(system)
                                                                    : TVI_NO_JACOBIANS);
}

const tvi_stepper tvi_stepper_curve = {.allocate = tvi_curve_workspace_allocate,
                                       .set_tables = tvi_curve_workspace_compute_constant_tables,
                                       .step = step_with_one_taylor_curve,
                                       .interpolate = compute_dense_output,
                                       .list_tapes = find_used_tapes};
const tvi_stepper tvi_stepper_taylor = {.allocate = tvi_curve_workspace_allocate,
                                        .set_tables = tvi_curve_workspace_compute_constant_tables,
                                        .step = step_with_one_taylor_curve,
                                        .interpolate = compute_dense_output,
                                        .step_within_tolerance = step_to_tolerance,
                                        .bound_energy_change = bound_energy_change,
                                        .list_tapes = find_used_tapes};
