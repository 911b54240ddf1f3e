/* both_ends.c - makes steps of type I with a Taylor curve from each end of the step: the symmetric Taylor variational
 * integrator (docs/method.md section 4). The integrator calls it through tvi_type1_both_ends. The curve a(s) starts at
 * (q0, v0), 0 <= s <= 1; the curve b(s - 1) starts at (q1, v1). Both have degree r, and each ends where the other
 * starts, a(1) = q1 and b(-1) = q0, with multipliers l, m. With w = 1 - s and a dot for d/ds
 *     y = w a + (1-w) b,     v = w a. + (1-w) b. (truncated)   or   v = y. = w a. + (1-w) b. - (a - b) (on-curve).
 * With pi = w p_a + (1-w) p_b, the momenta of the curves, the gradient of the action in defect form is
 *     R = sum_i w_i [ dy_i^T (tau L_q - pi.)_i + dv_i^T (L_v - pi)_i ]      truncated: + sum_i w_i (da - db)_i^T pi_i,
 * and with A0, B0 = da(1)/d(q0, v0), A1, B1 = db(-1)/d(q1, v1)
 *     B0^T l = R_v0,   B1^T m = R_v1,   p0 = p_a(0) - R_q0 + A0^T l - m,   p1 = p_b(0) + R_q1 + l - A1^T m.
 * If the quadrature does not sum the derivative of dy^T pi exactly, the same formulas are used with pi = 0. */
#include "generating/both_ends.h"
#include "algebra/quadrature.h"
#include "method/list.h"

#include <math.h>
#include <string.h>

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static void allocate_end_curve(tvi_end_curve *x, tvi_arena *arena, const tvi_system *system, const tvi_options *options,
                               double sign)
{
    tvi_options plain = *options; /* y is never truncated */
    plain.nodes = TVI_NODES_ON_CURVE;
    const int r = options->degree;
    const size_t n = (size_t)system->n;
    x->sign = x->end = sign;
    tvi_curve_allocate(&x->curve, arena, system, r, TVI_JACOBIAN_MATRICES, 1);
    tvi_allocate_action(&x->action, arena, system, &plain, TVI_ACTION_LAGRANGE, r, r - 1, r, false, 1);
    tvi_combination *const combinations[] = {&x->to_end, &x->near_u, &x->q_dense, &x->u_dense};
    for (size_t i = 0; i < sizeof combinations / sizeof *combinations; i++)
        *combinations[i] = tvi_combination_allocate(&x->curve, arena);
    x->blend = tvi_arena_allocate_doubles(arena, (size_t)options->quadrature_points);
    x->P = tvi_arena_allocate_doubles(arena, (size_t)r * n);
    x->seed = tvi_arena_allocate_doubles(arena, ((size_t)r + 1) * n);
    x->R = tvi_arena_allocate_doubles(arena, 2 * n);
    x->G = tvi_arena_allocate_doubles(arena, n * 2 * n);
    x->multiplier = tvi_arena_allocate_doubles(arena, n);
    x->dz = tvi_arena_allocate_doubles(arena, 2 * n);
    tvi_factor_allocate(&x->factor, arena, system->n, 1);
}

static void *allocate_stepper(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    tvi_both_ends_workspace *taken = tvi_arena_allocate(arena, sizeof *taken);
    tvi_both_ends_workspace w = {.system = system,
                                 .options = options,
                                 .n = system->n,
                                 .degree = options->degree,
                                 .points = options->quadrature_points};
    const size_t n = (size_t)system->n, points = (size_t)options->quadrature_points;
    allocate_end_curve(&w.a, arena, system, options, 1);
    allocate_end_curve(&w.b, arena, system, options, -1);
    w.has_pi = tvi_quadrature_order(options->quadrature, w.points) >= 2 * options->degree + 1;
    tvi_newton_allocate(&w.newton, arena, 3, system, true, 1);
    if (system->form == TVI_LAGRANGIAN) {
        tvi_legendre_allocate(&w.legendre, arena, system);
        w.velocity = tvi_arena_allocate_in_history(arena, n * sizeof *w.velocity);
    }
    w.q_unit = tvi_combination_allocate(&w.a.curve, arena);
    w.z_unit = tvi_combination_allocate(&w.a.curve, arena);
    double **const panels[] = {&w.y, &w.v, &w.pi, &w.pi_rate, &w.on_q, &w.on_v, &w.apart};
    for (size_t i = 0; i < sizeof panels / sizeof *panels; i++)
        *panels[i] = tvi_arena_allocate_doubles(arena, n * points);
    w.row = tvi_arena_allocate_doubles(arena, points);
    double **const vectors[] = {&w.z, &w.from_p, &w.rise_p, &w.dq, &w.dp, &w.shift};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        *vectors[i] = tvi_arena_allocate_doubles(arena, 2 * n);
    if (taken) *taken = w;
    return taken;
}

static void prepare_end_curve(tvi_both_ends_workspace *w, tvi_end_curve *x, tvi_scaled_span span)
{
    double powers[TVI_MAX_DEGREE + 1], zeroth[TVI_MAX_DEGREE + 1] = {1};
    for (int k = 0; k <= w->degree; k++) powers[k] = k == 0 ? 0 : pow(x->end, k);
    tvi_curve_fill_constant_tables(&x->curve);
    tvi_curve_prepare_tail(&x->curve, w->degree, w->degree - 1);
    tvi_prepare_action_tables(&x->action, w->options, span, w->degree);
    tvi_combination_set_weights(&x->to_end, &x->curve, false, powers);
    tvi_combination_set_weights(&x->near_u, &x->curve, true, zeroth);
    for (int node = 0; node < w->points; node++) x->blend[node] = 1 - x->end * x->action.node_s[node];
}

static void prepare_stepper(void *taken)
{
    tvi_both_ends_workspace *w = taken;
    const bool hamiltonian = w->system->form == TVI_HAMILTONIAN;
    double ones[TVI_MAX_DEGREE + 1], slopes[TVI_MAX_DEGREE + 1];
    tvi_newton_set_rules(&w->newton, w->options, true);
    prepare_end_curve(w, &w->a, (tvi_scaled_span){0, 1, 1});
    prepare_end_curve(w, &w->b, (tvi_scaled_span){-1, 0, 1});
    for (int k = 0; k <= w->degree; k++) {
        ones[k] = 1;
        slopes[k] = k;
    }
    tvi_combination_set_weights(&w->q_unit, &w->a.curve, false, ones);
    tvi_combination_set_weights(&w->z_unit, &w->a.curve, hamiltonian, hamiltonian ? ones : slopes);
}

/* ---- The residual ------------------------------------------------------------------------------------------------ */

/* Solves B^T multiplier = R_v. */
static tvi_status solve_multiplier(const tvi_both_ends_workspace *w, tvi_end_curve *x, tvi_stats *stats)
{
    const size_t n = (size_t)w->n;
    tvi_curve_sum_jacobian(&x->curve, &x->to_end, x->G);
    for (size_t i = 0; i < n; i++) memcpy(x->factor.lu + i * n, x->G + i * 2 * n + n, n * sizeof(double));
    memcpy(x->multiplier, x->R + n, n * sizeof(double));
    stats->factorisations++;
    const tvi_status status = tvi_factor_compute(&x->factor);
    if (status == TVI_OK) tvi_factor_solve_transposed(&x->factor, x->multiplier);
    return status;
}

/* Returns component j of (A - I)^T multiplier. */
static double sum_multiplied_column(const tvi_both_ends_workspace *w, const tvi_end_curve *x, int j)
{
    double sum = 0;
    for (int i = 0; i < w->n; i++) sum += x->G[i * 2 * w->n + j] * x->multiplier[i];
    return sum;
}

static tvi_status close_equations(tvi_both_ends_workspace *w, tvi_stats *stats)
{
    tvi_status status = solve_multiplier(w, &w->a, stats);
    if (status == TVI_OK) status = solve_multiplier(w, &w->b, stats);
    if (status != TVI_OK) return status;
    for (int i = 0; i < w->n; i++) {
        const double at_a = sum_multiplied_column(w, &w->a, i), at_b = sum_multiplied_column(w, &w->b, i);
        w->from_p[i] = -w->a.R[i] + at_a + (w->a.multiplier[i] - w->b.multiplier[i]);
        w->rise_p[i] = w->a.R[i] + w->b.R[i] - at_a - at_b;
    }
    return TVI_OK;
}

/* An attempt holds the step that is being made. */
typedef struct {
    tvi_both_ends_workspace *work;
    const tvi_step_origin *origin;
    double h;
    tvi_stats *stats;
} step_attempt;

static tvi_status expand_end_curve(const step_attempt *attempt, tvi_end_curve *x, const double z[], double centre)
{
    attempt->stats->expansions++;
    tvi_curve_set_time_unit_and_data(&x->curve, attempt->h, z);
    return tvi_curve_expand(&x->curve, centre);
}

static void compute_unknown_scales(void *self, double scale[])
{
    const tvi_both_ends_workspace *w = ((const step_attempt *)self)->work;
    const int n = w->n;
    const bool hamiltonian = w->system->form == TVI_HAMILTONIAN;
    memset(scale, 0, 3 * (size_t)n * sizeof *scale);
    for (int k = w->degree; k >= 0; k--) {
        const double *a = tvi_curve_position_coefficients(&w->a.curve, k),
                     *b = tvi_curve_position_coefficients(&w->b.curve, k);
        for (int i = 0; i < n; i++) {
            scale[n + i] += fabs(b[i]);
            if (k == 0 && !hamiltonian) continue;
            scale[i] += fabs(a[i + (hamiltonian ? n : 0)]);
            scale[2 * n + i] += fabs(b[i + (hamiltonian ? n : 0)]);
        }
    }
    for (int i = 0; w->degree == 1 && i < n; i++) { /* if a body is at rest, curves of degree 1 know only this */
        const double change = fabs(w->a.curve.kappa[i]) * (fabs(w->from_p[i]) + fabs(w->rise_p[i]));
        scale[i] += change;
        scale[2 * n + i] += change;
    }
}

/* Computes r = (a(1) - q1, b(-1) - q0, kappa (p_a(0) + from_p - p0)). */
static void compute_end_differences(const step_attempt *attempt, const double q1[], double r[])
{
    tvi_both_ends_workspace *w = attempt->work;
    const tvi_step_origin *origin = attempt->origin;
    const int n = w->n;
    tvi_curve_sum_combination(&w->a.curve, &w->a.to_end, r);
    tvi_curve_sum_combination(&w->b.curve, &w->b.to_end, r + n);
    tvi_curve_sum_combination(&w->a.curve, &w->a.near_u, r + 2 * n);
    const double pi = w->has_pi ? 1 : 0;
    for (int i = 0; i < n; i++) {
        const double kappa = w->a.curve.kappa[i], change = q1[i] - origin->q[i];
        r[i] -= change - origin->q_low[i];
        r[n + i] += change - origin->q_low[i];
        r[2 * n + i] = (pi * r[2 * n + i] - kappa * origin->p[i]) + kappa * (w->from_p[i] - origin->p_low[i]);
    }
}

static tvi_status compute_residual(void *self, const double x[], double r[])
{
    const step_attempt *attempt = self;
    tvi_both_ends_workspace *w = attempt->work;
    const tvi_step_origin *origin = attempt->origin;
    const size_t n = (size_t)w->n;
    memcpy(w->z, origin->q, n * sizeof *x);
    memcpy(w->z + n, x, n * sizeof *x);
    tvi_status status = expand_end_curve(attempt, &w->a, w->z, origin->t + origin->t_low);
    if (status == TVI_OK) status = expand_end_curve(attempt, &w->b, x + n, origin->t + (origin->t_low + attempt->h));
    if (status != TVI_OK) return status;
    tvi_curve_differentiate(&w->a.curve);
    tvi_curve_differentiate(&w->b.curve);
    status = tvi_both_ends_compute_gradient(w, attempt->stats);
    if (status == TVI_OK) status = close_equations(w, attempt->stats);
    if (status != TVI_OK) return status;
    compute_end_differences(attempt, x + n, r);
    return TVI_OK;
}

/* Fills in the residual's Jacobian without the change of the small corrections. Its columns v0,
 * q1, v1 are, by rows of r,
 *     B0 -I  0 ;   0  A1  B1 ;   dU_a/dv0  0  0. */
static bool compute_jacobian(void *self, double matrix[])
{
    const tvi_both_ends_workspace *w = ((const step_attempt *)self)->work;
    const size_t n = (size_t)w->n, row = 3 * n;
    memset(matrix, 0, row * row * sizeof *matrix);
    tvi_curve_sum_jacobian(&w->a.curve, &w->a.near_u, w->b.G);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) matrix[(2 * n + i) * row + j] = w->b.G[i * 2 * n + n + j];
    tvi_curve_sum_jacobian(&w->b.curve, &w->b.to_end, w->b.G);
    for (size_t i = 0; i < n; i++) {
        memcpy(matrix + i * row, w->a.G + i * 2 * n + n, n * sizeof *matrix);
        matrix[i * row + n + i] = -1;
        memcpy(matrix + (n + i) * row + n, w->b.G + i * 2 * n, 2 * n * sizeof *matrix);
        matrix[(n + i) * row + n + i] += 1;
    }
    return true;
}

/* Computes the roundoff of (a(1), b(-1), kappa p_a(0)) from that of the field at the nodes. */
static void estimate_residual_roundoff(void *self, double r[])
{
    const step_attempt *attempt = self;
    tvi_both_ends_workspace *w = attempt->work;
    const int n = w->n;
    double *of_u = r + 2 * n;
    attempt->stats->force_evaluations += tvi_estimate_end_roundoff(&w->a.action, &w->a.curve, attempt->h,
                                                                   attempt->origin->q, attempt->origin->p, r, of_u);
    memcpy(r + n, r, (size_t)n * sizeof *r);
    for (int i = 0; i < n; i++) of_u[i] *= fabs(w->a.curve.kappa[i]);
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

/* Expands the curve a from (q0, p0), and predicts the data of b as the end of a. */
static tvi_status predict_unknowns(const step_attempt *attempt)
{
    tvi_both_ends_workspace *w = attempt->work;
    const size_t n = (size_t)w->n;
    const tvi_step_origin *origin = attempt->origin;
    tvi_status status = tvi_legendre_compute_start_data(&w->legendre, w->system, attempt->h, origin->t, origin->q,
                                                        origin->p, w->velocity, w->z);
    if (status != TVI_OK) return status;
    status = expand_end_curve(attempt, &w->a, w->z, origin->t + origin->t_low);
    memcpy(w->newton.x, w->z + n, n * sizeof(double));
    tvi_curve_sum_combination(&w->a.curve, &w->q_unit, w->newton.x + n);
    tvi_curve_sum_combination(&w->a.curve, &w->z_unit, w->newton.x + 2 * n);
    return status;
}

/* Stores in dz what z of the curves lacks: the low-order part of q0, and the last correction. */
static void store_last_correction(tvi_both_ends_workspace *w, const tvi_step_origin *origin)
{
    const size_t n = (size_t)w->n, bytes = n * sizeof(double);
    memcpy(w->a.dz, origin->q_low, bytes);
    memcpy(w->a.dz + n, w->newton.correction, bytes);
    memcpy(w->b.dz, w->newton.correction + n, 2 * bytes);
    tvi_curve_set_product_direction(&w->a.curve, w->a.dz);
    tvi_curve_set_product_direction(&w->b.curve, w->b.dz);
}

/* Computes dq = a(1) - q0 and kappa dp = (U_b - U_a) + kappa rise_p, with what z lacks to first order. */
static void compute_increments(tvi_both_ends_workspace *w, double dq[], double dp[])
{
    const int n = w->n;
    tvi_curve_sum_combination(&w->a.curve, &w->a.to_end, dq);
    tvi_curve_multiply_by_jacobian(&w->a.curve, &w->a.to_end, w->shift);
    for (int i = 0; i < n; i++) dq[i] += w->shift[i];
    tvi_curve_sum_combination(&w->b.curve, &w->b.near_u, dp);
    tvi_curve_sum_combination(&w->a.curve, &w->a.near_u, w->shift);
    for (int i = 0; i < n; i++) dp[i] = w->has_pi ? dp[i] - w->shift[i] : 0;
    tvi_curve_multiply_by_jacobian(&w->b.curve, &w->b.near_u, w->shift);
    for (int i = 0; i < n; i++) dp[i] += w->shift[i];
    tvi_curve_multiply_by_jacobian(&w->a.curve, &w->a.near_u, w->shift);
    for (int i = 0; i < n; i++) dp[i] = (dp[i] - w->shift[i]) / w->a.curve.kappa[i] + w->rise_p[i];
}

static tvi_status step_both_ends(void *taken, double h, const tvi_step_origin *origin, const tvi_increments *increments,
                                 tvi_stats *stats)
{
    tvi_both_ends_workspace *w = taken;
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
    store_last_correction(w, origin);
    compute_increments(w, increments->dq, increments->dp);
    memcpy(w->dq, increments->dq, bytes);
    memcpy(w->dp, increments->dp, bytes);
    tvi_curve_compute_size_sums(&w->a.curve);
    tvi_curve_compute_size_sums(&w->b.curve);
    stats->tail = fmax(tvi_curve_compute_tail(&w->a.curve), tvi_curve_compute_tail(&w->b.curve));
    return TVI_OK;
}

/* Adds blend (x(at) - x(0)) to dq, and the same of the momenta to dp. */
static void add_blended_curve(tvi_both_ends_workspace *w, tvi_end_curve *x, double at, double blend, double dq[],
                              double dp[])
{
    tvi_combination_set_power_weights(&x->q_dense, &x->curve, false, w->degree, 1, at, -1, 0);
    tvi_combination_set_power_weights(&x->u_dense, &x->curve, true, w->degree - 1, 1, at, -1, 0);
    tvi_curve_sum_combination(&x->curve, &x->q_dense, w->shift);
    for (int i = 0; i < w->n; i++) dq[i] += blend * w->shift[i];
    tvi_curve_sum_combination(&x->curve, &x->u_dense, w->shift);
    for (int i = 0; i < w->n; i++) dp[i] += blend * w->shift[i] / x->curve.kappa[i];
}

/* Evaluates the blend of the curves; the curve b is measured from the end of the step. */
static void compute_dense_output(void *taken, double theta, double dq[], double dp[])
{
    tvi_both_ends_workspace *w = taken;
    for (int i = 0; i < w->n; i++) {
        dq[i] = theta * w->dq[i];
        dp[i] = theta * w->dp[i];
    }
    add_blended_curve(w, &w->a, theta, 1 - theta, dq, dp);
    add_blended_curve(w, &w->b, theta - 1, theta, dq, dp);
}

static tvi_used_tapes find_used_sweeps(const tvi_system *system, const tvi_options *options)
{
    return tvi_curve_find_used_sweeps(system, options, options->degree, options->quadrature_points,
                                      TVI_JACOBIAN_MATRICES);
}

static const tvi_stepper stepper = {.take = allocate_stepper,
                                    .prepare = prepare_stepper,
                                    .step = step_both_ends,
                                    .dense = compute_dense_output,
                                    .uses = find_used_sweeps};

const tvi_descriptor tvi_type1_both_ends = {
    .method = TVI_TYPE1,
    .expansion = TVI_AT_BOTH_ENDS,
    .title = "type I, both ends",
    .nodes = {[TVI_NODES_ON_CURVE] = {"both-ends", 2, 0}, [TVI_NODES_TRUNCATED] = {"symmetric-tvi", 1, 0}},
    .least_degree = 1,
    .most_degree = TVI_MAX_DEGREE,
    .supports = &tvi_supports_type1,
    .adjoint = &tvi_type1_both_ends,
    .quadrature = TVI_FREE_QUADRATURE,
    .needs_conjugate_momenta = true,
    .stepper = &stepper,
    .predictor = &tvi_stepper_curve,
    .curve = {.span = {0, 1, 1}},
};
