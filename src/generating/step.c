/* step.c - makes the steps of every method that expands one Taylor curve: it predicts the state z at the curve's
 * centre, runs the passes of the corrector and computes the increments. The integrator calls it through
 * tvi_stepper_curve and tvi_stepper_taylor. A method's descriptor (methods.c) says where the curve is expanded and
 * which equations correct its ends. A method without passes has no corrections. If such a method expands its curve at
 * the start, it is the plain Taylor method. */
#include "generating/step.h"
#include "method/method.h"

#include <math.h>
#include <string.h>

typedef tvi_curve_work work;

/* ---- The prediction ---------------------------------------------------------------------------------------------- */

static tvi_status expand_at(work *w, const double z[], double centre)
{
    w->step.stats->expansions++;
    curve_set_tau(&w->c.curve, w->step.tau);
    curve_set_z(&w->c.curve, z);
    return tvi_curve_expand(&w->c.curve, centre);
}

tvi_status tvi_step_expand(work *w, const double z[])
{
    return expand_at(w, z, w->step.origin->t + (w->step.origin->t_low + -w->c.span.start_s * w->step.tau));
}

tvi_status tvi_step_predict(work *w)
{
    const tvi_step_origin *origin = w->step.origin;
    const tvi_curve *curve = &w->c.curve;
    tvi_status status = tvi_legendre_compute_start(&w->predictor.legendre, curve->system, w->step.tau, origin->t,
                                                   origin->q, origin->p, w->predictor.velocity_guess, w->predictor.z);
    if (status != TVI_OK || w->c.span.start_s == 0) return status;
    status = expand_at(w, w->predictor.z, origin->t + origin->t_low);
    tvi_series_sum_compute(curve, &w->predictor.q_at_centre, w->predictor.z);
    tvi_series_sum_compute(curve, &w->predictor.v_at_centre, w->predictor.z + curve->n);
    return status;
}

/* ---- The equations of the corrector ------------------------------------------------------------------------------ */

/* Computes the natural sizes of z. A curve of degree 0 or 1 from a state of rest has size 0. For these degrees the
 * sizes of the last corrections of the ends are added. The sizes of a Lagrangian's unknowns stay unchanged, since these
 * corrections have another unit. */
static void compute_scale(void *self, double scale[])
{
    const tvi_corrected_curve *c = &((const work *)self)->c;
    const tvi_curve *curve = &c->curve;
    const int n = curve->n;
    tvi_curve_z_sizes(curve, scale);
    if (curve->highest_order > 1 || curve->system->form == TVI_LAGRANGIAN) return;
    for (int i = 0; i < n; i++) {
        scale[i] += fabs(c->start_correction_q[i]) + fabs(c->increment_correction_q[i]);
        scale[n + i] += fabs(curve->kappa[i]) * (fabs(c->start_correction_p[i]) + fabs(c->increment_correction_p[i]));
    }
}

/* Sets the corrections of both ends of the step from (x, y), the two halves of D_z that solve the step's equations, by
 * the formulas of method/descriptor.h. */
static void set_end_corrections(const tvi_corrected_curve *c)
{
    const tvi_curve_end_correction_factors *factors = &c->definition->end_correction_factors;
    const double *p0 = factors->start_p_correction_factor, *dp = factors->increment_p_correction_factor;
    const int n = c->curve.n;
    for (int i = 0; i < n; i++) {
        const double x = c->D_z[i], y = c->D_z[n + i], kappa_y = c->curve.kappa[i] * y;
        c->start_correction_q[i] = factors->start_q_correction_factor * kappa_y;
        c->increment_correction_q[i] = factors->increment_q_correction_factor * kappa_y;
        c->start_correction_p[i] = p0[0] * x + p0[1] * y;
        c->increment_correction_p[i] = dp[0] * x + dp[1] * y;
    }
}

/* Computes r = (q- + start_correction_q - q0, kappa (p- + start_correction_p - p0)), the difference between the
 * corrected start of the curve and the state (q0, p0). Small differences are added first. */
static tvi_status compute_residual(void *self, const double z[], double *restrict r)
{
    work *w = self;
    tvi_corrected_curve *c = &w->c;
    const tvi_step_origin *origin = w->step.origin;
    const int n = c->curve.n;
    const double *Q_0 = curve_Q(&c->curve, 0);
    tvi_status status = tvi_step_expand(w, z);
    if (status != TVI_OK) return status;
    w->step.stats->force_evaluations += w->options->quadrature_points;
    status = tvi_action_seeds(&w->action, &c->curve, c->seed_Q, c->seed_U);
    if (status == TVI_OK) status = c->solver->solve(c, z, w->newton.scale, w->step.stats);
    if (status != TVI_OK) return status;
    set_end_corrections(c);
    tvi_series_sum_compute(&c->curve, &w->q_start_minus_Q0, r);
    tvi_series_sum_compute(&c->curve, &c->ends[TVI_U_START], r + n);
    for (int i = 0; i < n; i++) {
        const double kappa = c->curve.kappa[i];
        r[i] += (Q_0[i] - origin->q[i]) + (c->start_correction_q[i] - origin->q_low[i]);
        r[n + i] = (r[n + i] - kappa * origin->p[i]) + kappa * (c->start_correction_p[i] - origin->p_low[i]);
    }
    return TVI_OK;
}

/* Computes J = d(q-, u-)/dz, the Jacobian of the residual without the derivatives of the small corrections. */
static bool compute_jacobian(void *self, double J[])
{
    const tvi_corrected_curve *c = &((work *)self)->c;
    return c->solver->jacobian(c, J);
}

/* Multiplies the correction by an approximate J^-1. */
static void apply_inverse_jacobian(void *self, double correction[])
{
    tvi_corrected_curve *c = &((work *)self)->c;
    c->solver->correct(c, correction);
}

/* Computes the roundoff of (q-, u-) from that of the field at the nodes. */
static void estimate_roundoff(void *self, double r[])
{
    work *w = self;
    const tvi_curve *curve = &w->c.curve;
    const int n = curve->n;
    const double h = (w->c.span.end_s - w->c.span.start_s) * w->step.tau;
    w->step.stats->force_evaluations +=
        tvi_action_end_roundoff(&w->action, curve, h, w->step.origin->q, w->step.origin->p, r, r + n);
    for (int i = 0; i < n; i++) r[n + i] *= fabs(curve->kappa[i]);
}

static tvi_status run_corrector(work *w)
{
    tvi_corrected_curve *c = &w->c;
    /* If the step starts at s = 0, (q-, u-) is z, and J is the identity. A Lagrangian is an exception: its z has v in
     * place of p. */
    const bool is_identity = c->span.start_s == 0 && c->curve.system->form != TVI_LAGRANGIAN;
    const tvi_equations equations = {.self = w,
                                     .residual = compute_residual,
                                     .scale = compute_scale,
                                     .jacobian = is_identity || !c->solver->jacobian ? NULL : compute_jacobian,
                                     .solve = is_identity || !c->solver->correct ? NULL : apply_inverse_jacobian,
                                     .roundoff = estimate_roundoff};
    c->solver->begin(c);
    memcpy(w->newton.x, w->predictor.z, 2 * (size_t)c->curve.n * sizeof *w->predictor.z);
    const tvi_status status = tvi_newton_solve(&w->newton, &equations, w->step.stats);
    if (status == TVI_OK) tvi_curve_set_dz(&c->curve, w->newton.correction);
    return status;
}

/* ---- The increments ---------------------------------------------------------------------------------------------- */

/* Computes out, the sum at z + dz to first order in dz, the last correction, which has not been added to z. */
static void sum_with_dz(const work *w, const tvi_series_sum *sum, double out[])
{
    tvi_series_sum_compute(&w->c.curve, sum, out);
    if (!w->has_corrections) return;
    tvi_series_sum_compute_change(&w->c.curve, sum, w->scratch);
    for (int i = 0; i < w->c.curve.n; i++) out[i] += w->scratch[i];
}

/* Computes dq = (q+ - q-) + theta increment_correction_q and dp = (p+ - p-) + theta increment_correction_p, with the
 * sums of the increments to the end of the step, theta = 1, or to a point within it. */
static void compute_increments(const work *w, const tvi_series_sum *q_sum, const tvi_series_sum *u_sum, double theta,
                               double dq[], double dp[])
{
    const tvi_corrected_curve *c = &w->c;
    sum_with_dz(w, q_sum, dq);
    sum_with_dz(w, u_sum, dp);
    for (int i = 0; i < c->curve.n; i++) {
        dp[i] /= c->curve.kappa[i];
        if (!w->has_corrections) continue;
        dq[i] += theta * c->increment_correction_q[i];
        dp[i] += theta * c->increment_correction_p[i];
    }
}

void tvi_step_taylor_increments(work *w, double h, const tvi_increments *increments)
{
    tvi_curve *curve = &w->c.curve;
    tvi_curve_rescale(curve, h / curve->tau, increments->dq, increments->dp);
    for (int i = 0; i < curve->n; i++) increments->dp[i] /= curve->kappa[i];
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

static tvi_status make_step(void *self, double h, const tvi_step_origin *origin, const tvi_increments *increments,
                            tvi_stats *stats)
{
    work *w = self;
    const tvi_corrected_curve *c = &w->c;
    const tvi_curve *curve = &c->curve;
    w->step.origin = origin;
    w->step.stats = stats;
    w->step.tau = c->span.tau_over_h * h;
    tvi_status status = tvi_step_predict(w);
    if (status == TVI_OK) status = w->has_corrections ? run_corrector(w) : tvi_step_expand(w, w->predictor.z);
    if (status != TVI_OK) return status;
    /* The plain Taylor method sums all orders of a curve from the start. */
    const bool is_taylor =
        !w->has_corrections && c->span.start_s == 0 && curve->q_degree > 1 && curve->highest_order == curve->q_degree;
    if (is_taylor) tvi_step_taylor_increments(w, h, increments);
    else compute_increments(w, &c->ends[TVI_Q_STEP], &c->ends[TVI_U_STEP], 1, increments->dq, increments->dp);
    if (curve->system->form == TVI_LAGRANGIAN) { /* from this velocity the next step searches its initial velocity */
        tvi_series_sum_compute(curve, &w->predictor.v_at_end, w->predictor.velocity_guess);
        for (int i = 0; i < curve->n; i++) w->predictor.velocity_guess[i] /= curve->tau;
    }
    if (!is_taylor) tvi_curve_compute_sizes(curve);
    stats->tail = tvi_curve_tail(curve);
    return TVI_OK;
}

/* Computes the increments from the start of the step to its fraction theta, with the fraction theta of the
 * corrections. */
static void compute_dense_output(void *self, double theta, double dq[], double dp[])
{
    work *w = self;
    const tvi_curve *curve = &w->c.curve;
    const double start = w->c.span.start_s, at = start + theta * (w->c.span.end_s - start);
    tvi_series_sum_set_powers(&w->dense_q, curve, false, curve->q_degree, 1, at, -1, start);
    tvi_series_sum_set_powers(&w->dense_u, curve, true, curve->p_degree, 1, at, -1, start);
    compute_increments(w, &w->dense_q, &w->dense_u, theta, dq, dp);
}

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static tvi_jacobians choose_jacobians(const tvi_system *system, const tvi_options *options)
{
    const bool has_corrections =
        tvi_find_method(options)->curve.equations.upper_sum != TVI_NO_SUM && options->passes != TVI_PREDICT_ONLY;
    return has_corrections ? tvi_curve_choose_jacobians(system) : TVI_NO_JACOBIANS;
}

static tvi_tapes_of_steps list_tapes(const tvi_system *system, const tvi_options *options)
{
    return tvi_curve_list_tapes(system, options, tvi_action_shape(system, options).nodes,
                                choose_jacobians(system, options));
}

static void *allocate(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    work *allocated = tvi_arena_allocate(arena, sizeof *allocated), w = {.options = options};
    const tvi_curve_definition *definition = &tvi_find_method(options)->curve;
    const tvi_action shape = tvi_action_shape(system, options);
    const tvi_jacobians jacobians = choose_jacobians(system, options);
    const size_t n = (size_t)system->n;
    tvi_corrected_curve *c = &w.c;
    w.has_corrections = jacobians != TVI_NO_JACOBIANS;
    c->definition = definition;
    c->span = definition->step_span;
    tvi_curve_allocate(&c->curve, arena, system, shape.order_count - 1, jacobians);
    c->curve.q_degree = options->degree;
    c->curve.p_degree = shape.p_degree;
    for (int i = TVI_NO_SUM + 1; i < TVI_END_SUMS; i++) c->ends[i] = tvi_series_sum_allocate(&c->curve, arena);
    tvi_series_sum *const sums[] = {
        &c->p_size_sum, &w.q_start_minus_Q0, &w.predictor.q_at_centre, &w.predictor.v_at_centre, &w.predictor.v_at_end,
        &w.dense_q,     &w.dense_u};
    for (size_t i = 0; i < sizeof sums / sizeof *sums; i++) *sums[i] = tvi_series_sum_allocate(&c->curve, arena);
    if (system->form == TVI_LAGRANGIAN) {
        tvi_legendre_allocate(&w.predictor.legendre, arena, system);
        w.predictor.velocity_guess = tvi_arena_allocate_copied(arena, n * sizeof *w.predictor.velocity_guess);
    }
    w.predictor.z = tvi_arena_allocate_doubles(arena, 2 * n);
    w.scratch = tvi_arena_allocate_doubles(arena, n);
    if (definition->equations.upper_sum == TVI_NO_SUM) tvi_taylor_allocate(&w, arena);
    if (w.has_corrections) {
        tvi_arena_allocate_each(arena, n,
                                (double **[]){&c->p_size, &c->start_correction_q, &c->start_correction_p,
                                              &c->increment_correction_q, &c->increment_correction_p, NULL});
        tvi_arena_allocate_each(arena, (size_t)shape.order_count * n, (double **[]){&c->seed_Q, &c->seed_U, NULL});
        c->D_z = tvi_arena_allocate_doubles(arena, 2 * n);
        c->solver = jacobians == TVI_JACOBIAN_PRODUCTS ? &tvi_solver_by_products : &tvi_solver_by_matrices;
        c->solver->allocate(c, arena);
        tvi_action_allocate(&w.action, arena, system, options);
        tvi_newton_allocate(&w.newton, arena, 2, system, c->solver->jacobian != NULL);
    }
    if (allocated) *allocated = w;
    return allocated;
}

static void set_tables(void *self)
{
    work *w = self;
    tvi_corrected_curve *c = &w->c;
    tvi_curve *curve = &c->curve;
    const double from = c->span.start_s, to = c->span.end_s, length = to - from, s = -from;
    /* The weights at s+ and at s- of the sums START, END, STEP and MEAN. */
    const double factor[4][2] = {{0, 1}, {1, 0}, {1, -1}, {-from / length, to / length}};
    const bool hamiltonian = curve->system->form == TVI_HAMILTONIAN;
    double weight[TVI_MAX_DEGREE + 2], end_weight[TVI_MAX_DEGREE + 2];
    tvi_curve_fill_tables(curve);
    tvi_curve_set_degrees(curve, curve->q_degree, curve->p_degree);
    if (w->adapted.refinement.high_weight) {
        tvi_defect_set_tables(&w->adapted.defect, curve);
        tvi_refine_set_tables(&w->adapted.refinement, curve);
    }
    for (int i = 0; i < 4; i++) {
        tvi_series_sum_set_powers(&c->ends[TVI_Q_START + i], curve, false, curve->q_degree, factor[i][0], to,
                                  factor[i][1], from);
        tvi_series_sum_set_powers(&c->ends[TVI_U_START + i], curve, true, curve->p_degree, factor[i][0], to,
                                  factor[i][1], from);
    }
    tvi_series_sum_set_powers(&c->p_size_sum, curve, true, curve->p_degree, 1, 1, 0, 0);
    tvi_series_sum_set_powers(&w->q_start_minus_Q0, curve, false, curve->q_degree, 1, from, -1, 0);
    tvi_series_sum_set_powers(&w->predictor.q_at_centre, curve, false, curve->highest_order, 1, s, 0, 0);
    for (int k = 0; k <= curve->highest_order; k++) {
        weight[k] = hamiltonian ? pow(s, k) : k > 0 ? k * pow(s, k - 1) : 0;
        end_weight[k] = k > 0 ? k * pow(to, k - 1) : 0;
    }
    tvi_series_sum_set(&w->predictor.v_at_centre, curve, hamiltonian, weight);
    tvi_series_sum_set(&w->predictor.v_at_end, curve, false, end_weight);
    if (!w->has_corrections) return;
    tvi_action_set_tables(&w->action, w->options, c->span);
    /* A curve of degree 0 is constant, so that passes correct q and p alternately. The contraction of the first pass
     * then does not show that of the later ones. */
    tvi_newton_set_rules(&w->newton, w->options, c->definition->needs_extra_newton_pass || curve->q_degree == 0);
}

const tvi_stepper tvi_stepper_curve = {.allocate = allocate,
                                       .set_tables = set_tables,
                                       .step = make_step,
                                       .interpolate = compute_dense_output,
                                       .list_tapes = list_tapes};
const tvi_stepper tvi_stepper_taylor = {.allocate = allocate,
                                        .set_tables = set_tables,
                                        .step = make_step,
                                        .interpolate = compute_dense_output,
                                        .step_within_tolerance = tvi_taylor_step_to_tolerance,
                                        .bound_energy_change = tvi_taylor_bound_energy_change,
                                        .list_tapes = list_tapes};
