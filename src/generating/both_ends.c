/* both_ends.c - makes steps of type I with a Taylor curve from each end of the step: the symmetric Taylor variational
 * integrator (docs/method.md section 4). The integrator calls it through tvi_stepper_both_ends. The curve a(s) starts
 * at (q0, v0), 0 <= s <= 1; the curve b(s - 1) starts at (q1, v1). Both have degree r. Each ends where the other
 * starts, a(1) = q1 and b(-1) = q0; l and m are the Lagrange multipliers of these two conditions. With w = 1 - s and a
 * dot for d/ds
 *     y = w a + (1-w) b,     v = w a. + (1-w) b. (truncated)   or   v = y. = w a. + (1-w) b. - (a - b) (on-curve).
 * Let p_a and p_b be the momenta of the curves, pi = w p_a + (1-w) p_b, w_i the quadrature weight of node i, tau = h,
 * and dy_i, dv_i, da, db the Jacobians of y_i, v_i, a and b by (q0, v0, q1, v1). The gradient of the action in defect
 * form (action.h) is
 *     R = sum_i w_i [ dy_i^T (tau L_q - pi.)_i + dv_i^T (L_v - pi)_i ]      truncated: + sum_i w_i (da - db)_i^T pi_i,
 * and with R_q0 its part by q0 and so on, (A0, B0) = da(1)/d(q0, v0) and (A1, B1) = db(-1)/d(q1, v1),
 *     B0^T l = R_v0,   B1^T m = R_v1,   p0 = p_a(0) - R_q0 + A0^T l - m,   p1 = p_b(0) + R_q1 + l - A1^T m.
 * If the quadrature does not sum the derivative of dy^T pi exactly, the same formulas are used with pi = 0. */
#include "generating/both_ends.h"
#include "algebra/quadrature.h"
#include "method/stepper.h"

#include <math.h>
#include <string.h>

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static void allocate_end_curve(tvi_one_end_curve *x, tvi_arena *arena, const tvi_system *system,
                               const tvi_options *options, double sign)
{
    /* The nodes of the action of one curve are on that curve with either node rule, since y blends whole curves. The
     * node rule only decides which of the two formulas gives v. */
    tvi_options plain = *options;
    plain.nodes = TVI_NODES_ON_CURVE;
    const int r = options->degree;
    const size_t n = (size_t)system->n;
    x->sign_in_curve_difference = x->other_end_scaled_time = sign;
    tvi_curve_allocate(&x->curve, arena, system, r, TVI_JACOBIAN_MATRICES);
    tvi_allocate_action(&x->action, arena, system, &plain);
    tvi_coefficient_combination *const weights[] = {&x->q_increment_weights, &x->scaled_p_at_expansion_point_weights,
                                                    &x->dense_output_q_weights, &x->dense_output_scaled_p_weights};
    for (size_t i = 0; i < sizeof weights / sizeof *weights; i++)
        *weights[i] = tvi_combination_allocate(&x->curve, arena);
    x->node_blend_weight = tvi_arena_allocate_doubles(arena, (size_t)options->quadrature_points);
    x->momentum_coefficients = tvi_arena_allocate_doubles(arena, (size_t)r * n);
    x->action_gradient_by_coefficients_Q = tvi_arena_allocate_doubles(arena, ((size_t)r + 1) * n);
    x->action_gradient_by_z = tvi_arena_allocate_doubles(arena, 2 * n);
    x->q_increment_jacobian = tvi_arena_allocate_doubles(arena, n * 2 * n);
    x->end_condition_multiplier = tvi_arena_allocate_doubles(arena, n);
    x->last_newton_dz = tvi_arena_allocate_doubles(arena, 2 * n);
    tvi_factor_allocate(&x->q_by_velocity_jacobian_lu, arena, system->n);
}

static void *allocate_stepper(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    tvi_both_ends_workspace *workspace = tvi_arena_allocate(arena, sizeof *workspace);
    tvi_both_ends_workspace w = {.system = system,
                                 .options = options,
                                 .n = system->n,
                                 .degree = options->degree,
                                 .points = options->quadrature_points};
    const size_t n = (size_t)system->n, points = (size_t)options->quadrature_points;
    allocate_end_curve(&w.start_curve, arena, system, options, 1);
    allocate_end_curve(&w.end_curve, arena, system, options, -1);
    w.action_has_momentum_terms = tvi_quadrature_order(options->quadrature, w.points) >= 2 * options->degree + 1;
    tvi_newton_allocate(&w.newton, arena, 3, system, true);
    if (system->form == TVI_LAGRANGIAN) {
        tvi_legendre_allocate(&w.legendre_transform, arena, system);
        w.velocity_guess = tvi_arena_allocate_copied(arena, n * sizeof *w.velocity_guess);
    }
    w.q_at_end_weights = tvi_combination_allocate(&w.start_curve.curve, arena);
    w.velocity_at_end_weights = tvi_combination_allocate(&w.start_curve.curve, arena);
    double **const panels[] = {&w.q_at_nodes,
                               &w.v_at_nodes,
                               &w.p_at_nodes,
                               &w.dp_ds_at_nodes,
                               &w.action_gradient_by_q,
                               &w.action_gradient_by_v,
                               &w.action_gradient_by_difference};
    for (size_t i = 0; i < sizeof panels / sizeof *panels; i++)
        *panels[i] = tvi_arena_allocate_doubles(arena, n * points);
    w.series_value_at_node = tvi_arena_allocate_doubles(arena, points);
    double **const vectors[] = {&w.start_curve_z, &w.start_correction_p, &w.increment_correction_p,
                                &w.last_step_dq,  &w.last_step_dp,       &w.scratch};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        *vectors[i] = tvi_arena_allocate_doubles(arena, 2 * n);
    if (workspace) *workspace = w;
    return workspace;
}

static void set_end_curve_tables(tvi_both_ends_workspace *w, tvi_one_end_curve *x, tvi_step_span span)
{
    double powers[TVI_MAX_DEGREE + 1], zeroth[TVI_MAX_DEGREE + 1] = {1};
    for (int k = 0; k <= w->degree; k++) powers[k] = k == 0 ? 0 : pow(x->other_end_scaled_time, k);
    tvi_curve_fill_constant_tables(&x->curve);
    tvi_curve_set_summed_degrees(&x->curve, w->degree, w->degree - 1);
    tvi_prepare_action_tables(&x->action, w->options, span);
    tvi_combination_set_weights(&x->q_increment_weights, &x->curve, false, powers);
    tvi_combination_set_weights(&x->scaled_p_at_expansion_point_weights, &x->curve, true, zeroth);
    for (int node = 0; node < w->points; node++)
        x->node_blend_weight[node] = 1 - x->other_end_scaled_time * x->action.node_scaled_time[node];
}

static void prepare_stepper(void *workspace)
{
    tvi_both_ends_workspace *w = workspace;
    const bool hamiltonian = w->system->form == TVI_HAMILTONIAN;
    double ones[TVI_MAX_DEGREE + 1], slopes[TVI_MAX_DEGREE + 1];
    tvi_newton_set_pass_rules(&w->newton, w->options, true);
    set_end_curve_tables(w, &w->start_curve, (tvi_step_span){0, 1, 1});
    set_end_curve_tables(w, &w->end_curve, (tvi_step_span){-1, 0, 1});
    for (int k = 0; k <= w->degree; k++) {
        ones[k] = 1;
        slopes[k] = k;
    }
    tvi_combination_set_weights(&w->q_at_end_weights, &w->start_curve.curve, false, ones);
    tvi_combination_set_weights(&w->velocity_at_end_weights, &w->start_curve.curve, hamiltonian,
                                hamiltonian ? ones : slopes);
}

/* ---- The residual ------------------------------------------------------------------------------------------------ */

/* Solves B^T end_condition_multiplier = R_v. B is the Jacobian of the position at the curve's other end by the velocity
 * at its own end, and R_v is the action's gradient by that velocity. */
static tvi_status solve_for_end_condition_multiplier(const tvi_both_ends_workspace *w, tvi_one_end_curve *x,
                                                     tvi_stats *stats)
{
    const size_t n = (size_t)w->n;
    tvi_curve_sum_combination_jacobian(&x->curve, &x->q_increment_weights, x->q_increment_jacobian);
    for (size_t i = 0; i < n; i++)
        memcpy(x->q_by_velocity_jacobian_lu.lu + i * n, x->q_increment_jacobian + i * 2 * n + n, n * sizeof(double));
    memcpy(x->end_condition_multiplier, x->action_gradient_by_z + n, n * sizeof(double));
    stats->factorisations++;
    const tvi_status status = tvi_factor_compute(&x->q_by_velocity_jacobian_lu);
    if (status == TVI_OK) tvi_factor_solve_transposed(&x->q_by_velocity_jacobian_lu, x->end_condition_multiplier);
    return status;
}

/* Returns component j of (A - I)^T end_condition_multiplier, with A the Jacobian of the position at the curve's other
 * end by the position at its own end. */
static double compute_jacobian_column_dot_multiplier(const tvi_both_ends_workspace *w, const tvi_one_end_curve *x,
                                                     int j)
{
    double sum = 0;
    for (int i = 0; i < w->n; i++) sum += x->q_increment_jacobian[i * 2 * w->n + j] * x->end_condition_multiplier[i];
    return sum;
}

static tvi_status compute_momentum_corrections(tvi_both_ends_workspace *w, tvi_stats *stats)
{
    tvi_status status = solve_for_end_condition_multiplier(w, &w->start_curve, stats);
    if (status == TVI_OK) status = solve_for_end_condition_multiplier(w, &w->end_curve, stats);
    if (status != TVI_OK) return status;
    for (int i = 0; i < w->n; i++) {
        const double at_a = compute_jacobian_column_dot_multiplier(w, &w->start_curve, i),
                     at_b = compute_jacobian_column_dot_multiplier(w, &w->end_curve, i);
        w->start_correction_p[i] =
            -w->start_curve.action_gradient_by_z[i] + at_a +
            (w->start_curve.end_condition_multiplier[i] - w->end_curve.end_condition_multiplier[i]);
        w->increment_correction_p[i] =
            w->start_curve.action_gradient_by_z[i] + w->end_curve.action_gradient_by_z[i] - at_a - at_b;
    }
    return TVI_OK;
}

/* The step that the stepper tries to make. tvi_equations.self points to this structure, which the functions of the
 * residual read. */
typedef struct {
    tvi_both_ends_workspace *work;
    const tvi_step_origin *origin;
    double h;
    tvi_stats *stats;
} step_attempt;

static tvi_status expand_end_curve(const step_attempt *attempt, tvi_one_end_curve *x, const double z[], double centre)
{
    attempt->stats->expansions++;
    curve_set_time_unit(&x->curve, attempt->h);
    curve_set_centre_state(&x->curve, z);
    return tvi_curve_expand(&x->curve, centre);
}

static void compute_unknown_scales(void *self, double scale[])
{
    const tvi_both_ends_workspace *w = ((const step_attempt *)self)->work;
    const int n = w->n;
    tvi_curve_compute_centre_state_sizes(&w->start_curve.curve, scale);
    memcpy(scale, scale + n, (size_t)n * sizeof *scale);
    tvi_curve_compute_centre_state_sizes(&w->end_curve.curve, scale + n);
    if (w->degree > 1) return;
    /* The size of a velocity, from the coefficients of a curve of degree 1 that starts at rest, is 0. The magnitudes of
     * the momentum corrections are therefore added to the sizes of v0 and v1. */
    for (int i = 0; i < n; i++) {
        const double change = fabs(w->start_curve.curve.momentum_scale_factor[i]) *
                              (fabs(w->start_correction_p[i]) + fabs(w->increment_correction_p[i]));
        scale[i] += change;
        scale[2 * n + i] += change;
    }
}

/* Computes the residual r = (a(1) - q1, b(-1) - q0, kappa (p_a(0) + start_correction_p - p0)) of the corrector. */
static void compute_end_condition_residual(const step_attempt *attempt, const double q1[], double r[])
{
    tvi_both_ends_workspace *w = attempt->work;
    const tvi_step_origin *origin = attempt->origin;
    const int n = w->n;
    tvi_curve_sum_combination(&w->start_curve.curve, &w->start_curve.q_increment_weights, r);
    tvi_curve_sum_combination(&w->end_curve.curve, &w->end_curve.q_increment_weights, r + n);
    tvi_curve_sum_combination(&w->start_curve.curve, &w->start_curve.scaled_p_at_expansion_point_weights, r + 2 * n);
    const double pi = w->action_has_momentum_terms ? 1 : 0;
    for (int i = 0; i < n; i++) {
        const double kappa = w->start_curve.curve.momentum_scale_factor[i], change = q1[i] - origin->q[i];
        r[i] -= change - origin->q_low[i];
        r[n + i] += change - origin->q_low[i];
        r[2 * n + i] =
            (pi * r[2 * n + i] - kappa * origin->p[i]) + kappa * (w->start_correction_p[i] - origin->p_low[i]);
    }
}

static tvi_status compute_residual(void *self, const double x[], double r[])
{
    const step_attempt *attempt = self;
    tvi_both_ends_workspace *w = attempt->work;
    const tvi_step_origin *origin = attempt->origin;
    const size_t n = (size_t)w->n;
    memcpy(w->start_curve_z, origin->q, n * sizeof *x);
    memcpy(w->start_curve_z + n, x, n * sizeof *x);
    tvi_status status = expand_end_curve(attempt, &w->start_curve, w->start_curve_z, origin->t + origin->t_low);
    if (status == TVI_OK)
        status = expand_end_curve(attempt, &w->end_curve, x + n, origin->t + (origin->t_low + attempt->h));
    if (status != TVI_OK) return status;
    tvi_curve_compute_jacobians(&w->start_curve.curve);
    tvi_curve_compute_jacobians(&w->end_curve.curve);
    status = tvi_both_ends_compute_action_gradient(w, attempt->stats);
    if (status == TVI_OK) status = compute_momentum_corrections(w, attempt->stats);
    if (status != TVI_OK) return status;
    compute_end_condition_residual(attempt, x + n, r);
    return TVI_OK;
}

/* Fills in the residual's Jacobian, without the derivatives of the small corrections. Its columns belong to v0, q1, v1,
 * and its rows are B0 -I 0 ; 0 A1 B1 ; dU_a/dv0 0 0. */
static bool compute_jacobian(void *self, double matrix[])
{
    const tvi_both_ends_workspace *w = ((const step_attempt *)self)->work;
    const size_t n = (size_t)w->n, row = 3 * n;
    memset(matrix, 0, row * row * sizeof *matrix);
    tvi_curve_sum_combination_jacobian(&w->start_curve.curve, &w->start_curve.scaled_p_at_expansion_point_weights,
                                       w->end_curve.q_increment_jacobian);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            matrix[(2 * n + i) * row + j] = w->end_curve.q_increment_jacobian[i * 2 * n + n + j];
    tvi_curve_sum_combination_jacobian(&w->end_curve.curve, &w->end_curve.q_increment_weights,
                                       w->end_curve.q_increment_jacobian);
    for (size_t i = 0; i < n; i++) {
        memcpy(matrix + i * row, w->start_curve.q_increment_jacobian + i * 2 * n + n, n * sizeof *matrix);
        matrix[i * row + n + i] = -1;
        memcpy(matrix + (n + i) * row + n, w->end_curve.q_increment_jacobian + i * 2 * n, 2 * n * sizeof *matrix);
        matrix[(n + i) * row + n + i] += 1;
    }
    return true;
}

/* Estimates r [3n], the roundoff of the corrector's residual, from that of the field at the nodes. Its three parts of n
 * numbers are the roundoff of the position a(1) at the end of the start curve, that of the position b(-1) where the end
 * curve meets the start of the step, and that of kappa p_a(0), the momentum of the start curve at its start, multiplied
 * by the factor kappa that scales momenta. */
static void estimate_residual_roundoff(void *self, double r[])
{
    const step_attempt *attempt = self;
    tvi_both_ends_workspace *w = attempt->work;
    const int n = w->n;
    double *of_u = r + 2 * n;
    attempt->stats->force_evaluations += tvi_estimate_end_state_roundoff(
        &w->start_curve.action, &w->start_curve.curve, attempt->h, attempt->origin->q, attempt->origin->p, r, of_u);
    memcpy(r + n, r, (size_t)n * sizeof *r);
    for (int i = 0; i < n; i++) of_u[i] *= fabs(w->start_curve.curve.momentum_scale_factor[i]);
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

/* Expands the start curve from (q0, p0), and predicts the end curve's centre state as the end of the start curve. */
static tvi_status predict_unknowns(const step_attempt *attempt)
{
    tvi_both_ends_workspace *w = attempt->work;
    const size_t n = (size_t)w->n;
    const tvi_step_origin *origin = attempt->origin;
    tvi_status status = tvi_legendre_compute_start(&w->legendre_transform, w->system, attempt->h, origin->t, origin->q,
                                                   origin->p, w->velocity_guess, w->start_curve_z);
    if (status != TVI_OK) return status;
    status = expand_end_curve(attempt, &w->start_curve, w->start_curve_z, origin->t + origin->t_low);
    memcpy(w->newton.x, w->start_curve_z + n, n * sizeof(double));
    tvi_curve_sum_combination(&w->start_curve.curve, &w->q_at_end_weights, w->newton.x + n);
    tvi_curve_sum_combination(&w->start_curve.curve, &w->velocity_at_end_weights, w->newton.x + 2 * n);
    return status;
}

/* Stores the correction of each curve's centre state that has not been applied: the low-order part of q0, and the
 * corrections of v0, q1 and v1 by the last pass. */
static void store_last_newton_dz_of_both_curves(tvi_both_ends_workspace *w, const tvi_step_origin *origin)
{
    const size_t n = (size_t)w->n, bytes = n * sizeof(double);
    memcpy(w->start_curve.last_newton_dz, origin->q_low, bytes);
    memcpy(w->start_curve.last_newton_dz + n, w->newton.correction, bytes);
    memcpy(w->end_curve.last_newton_dz, w->newton.correction + n, 2 * bytes);
    tvi_curve_set_product_direction(&w->start_curve.curve, w->start_curve.last_newton_dz);
    tvi_curve_set_product_direction(&w->end_curve.curve, w->end_curve.last_newton_dz);
}

/* Computes the increments of the step, dq = a(1) - q0 and kappa dp = (U_b - U_a) + kappa increment_correction_p, with
 * U_a and U_b the scaled momenta of the curves at their own ends. The unapplied correction is added to first order. */
static void compute_increments(tvi_both_ends_workspace *w, double dq[], double dp[])
{
    const int n = w->n;
    const tvi_one_end_curve *a = &w->start_curve, *b = &w->end_curve;
    tvi_curve_sum_combination(&a->curve, &a->q_increment_weights, dq);
    tvi_curve_differentiate_sum_along_set_dz(&a->curve, &a->q_increment_weights, w->scratch);
    for (int i = 0; i < n; i++) dq[i] += w->scratch[i];
    tvi_curve_sum_combination(&b->curve, &b->scaled_p_at_expansion_point_weights, dp);
    tvi_curve_sum_combination(&a->curve, &a->scaled_p_at_expansion_point_weights, w->scratch);
    for (int i = 0; i < n; i++) dp[i] = w->action_has_momentum_terms ? dp[i] - w->scratch[i] : 0;
    tvi_curve_differentiate_sum_along_set_dz(&b->curve, &b->scaled_p_at_expansion_point_weights, w->scratch);
    for (int i = 0; i < n; i++) dp[i] += w->scratch[i];
    tvi_curve_differentiate_sum_along_set_dz(&a->curve, &a->scaled_p_at_expansion_point_weights, w->scratch);
    for (int i = 0; i < n; i++)
        dp[i] = (dp[i] - w->scratch[i]) / a->curve.momentum_scale_factor[i] + w->increment_correction_p[i];
}

static tvi_status step_both_ends(void *workspace, double h, const tvi_step_origin *origin,
                                 const tvi_increments *increments, tvi_stats *stats)
{
    tvi_both_ends_workspace *w = workspace;
    const size_t bytes = (size_t)w->n * sizeof *increments->dq;
    step_attempt attempt = {w, origin, h, stats};
    const tvi_equations equations = {.self = &attempt,
                                     .residual = compute_residual,
                                     .scale = compute_unknown_scales,
                                     .jacobian = compute_jacobian,
                                     .roundoff = estimate_residual_roundoff};
    tvi_status status = predict_unknowns(&attempt);
    if (status == TVI_OK) status = tvi_newton_solve(&w->newton, &equations, stats);
    if (status != TVI_OK) return status;
    store_last_newton_dz_of_both_curves(w, origin);
    compute_increments(w, increments->dq, increments->dp);
    memcpy(w->last_step_dq, increments->dq, bytes);
    memcpy(w->last_step_dp, increments->dp, bytes);
    tvi_curve_compute_displacement_sizes(&w->start_curve.curve);
    tvi_curve_compute_displacement_sizes(&w->end_curve.curve);
    stats->tail = fmax(tvi_curve_compute_tail(&w->start_curve.curve), tvi_curve_compute_tail(&w->end_curve.curve));
    return TVI_OK;
}

/* Adds weight (q(s) - q(0)) of the curve to dq, and weight (p(s) - p(0)) to dp. */
static void add_weighted_curve_increments(tvi_both_ends_workspace *w, tvi_one_end_curve *x, double s, double weight,
                                          double dq[], double dp[])
{
    tvi_combination_set_power_weights(&x->dense_output_q_weights, &x->curve, false, w->degree, 1, s, -1, 0);
    tvi_combination_set_power_weights(&x->dense_output_scaled_p_weights, &x->curve, true, w->degree - 1, 1, s, -1, 0);
    tvi_curve_sum_combination(&x->curve, &x->dense_output_q_weights, w->scratch);
    for (int i = 0; i < w->n; i++) dq[i] += weight * w->scratch[i];
    tvi_curve_sum_combination(&x->curve, &x->dense_output_scaled_p_weights, w->scratch);
    for (int i = 0; i < w->n; i++) dp[i] += weight * w->scratch[i] / x->curve.momentum_scale_factor[i];
}

/* Computes the increments at the fraction theta of the step, by a blend of the curves: the start curve has weight 1 -
 * theta, and the end curve, which is measured from the end of the step, has weight theta. */
static void compute_dense_output(void *workspace, double theta, double dq[], double dp[])
{
    tvi_both_ends_workspace *w = workspace;
    for (int i = 0; i < w->n; i++) {
        dq[i] = theta * w->last_step_dq[i];
        dp[i] = theta * w->last_step_dp[i];
    }
    add_weighted_curve_increments(w, &w->start_curve, theta, 1 - theta, dq, dp);
    add_weighted_curve_increments(w, &w->end_curve, theta - 1, theta, dq, dp);
}

static tvi_tapes_of_steps find_used_tapes(const tvi_system *system, const tvi_options *options)
{
    return tvi_curve_find_used_tapes(system, options, options->quadrature_points, TVI_JACOBIAN_MATRICES);
}

const tvi_stepper tvi_stepper_both_ends = {.allocate = allocate_stepper,
                                           .set_tables = prepare_stepper,
                                           .step = step_both_ends,
                                           .interpolate = compute_dense_output,
                                           .list_tapes = find_used_tapes};
