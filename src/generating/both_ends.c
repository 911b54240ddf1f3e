/* both_ends.c - makes steps of type I with a Taylor curve from each end of the step: the symmetric Taylor variational
 * integrator (docs/method.md section 4). The integrator calls it through tvi_stepper_both_ends. The curve a(s) starts
 * at (q0, v0), 0 <= s <= 1; the curve b(s - 1) starts at (q1, v1). Both have degree r. Each ends where the other
 * starts, a(1) = q1 and b(-1) = q0; l and m are the Lagrange multipliers of these two conditions. The nodes are on the
 * blend y of both curves. With a dot for d/ds
 *     y = (1-s) a + s b,     v = (1-s) a. + s b. (truncated)   or   v = y. = (1-s) a. + s b. - (a - b) (on-curve).
 * Let p_a and p_b be the momenta of the curves, pi = (1-s) p_a + s p_b, w_i the quadrature weight of node i, tau = h,
 * and dy_i, dv_i, da, db the Jacobians of y_i, v_i, a and b by (q0, v0, q1, v1). The gradient of the action in defect
 * form (action.h) is
 *     R = sum_i w_i [ dy_i^T (tau L_q - pi.)_i + dv_i^T (L_v - pi)_i ]      truncated: + sum_i w_i (da - db)_i^T pi_i,
 * and with R_q0 its part by q0 and so on, (A0, B0) = da(1)/d(q0, v0) and (A1, B1) = db(-1)/d(q1, v1),
 *     B0^T l = R_v0,   B1^T m = R_v1,   p0 = p_a(0) - R_q0 + A0^T l - m,   p1 = p_b(0) + R_q1 + l - A1^T m.
 * If the quadrature does not sum the derivative of dy^T pi exactly, the same formulas are used with pi = 0. */
#include "algebra/quadrature.h"
#include "generating/action.h"
#include "generating/newton.h"
#include "system/legendre.h"

#include <math.h>
#include <string.h>

/* One of the two curves a and b (head of this file). A curve starts at its own end of the step. */
typedef struct {
    tvi_curve curve;
    /* Tables of the nodes for this curve. The action of curve a also evaluates the Lagrangian on the blend. */
    tvi_action action;
    double sign;   /* The scaled time of the other end, and the sign of the curve in a - b: 1 for a, -1 for b. */
    double *blend; /* [points] The weight of the curve in y at each node: 1 - s for a, s for b. */
    double *P;     /* [degree][n] The coefficients of the momentum. */
    tvi_series_sum q_rise;  /* q at the other end of the step less q at the curve's own end. */
    tvi_series_sum u_start; /* U_0, the scaled momentum at the curve's own end. */
    /* The increments of q and u from the curve's own end to one point of dense output. */
    tvi_series_sum dense_q, dense_u;
    double *seed_Q;          /* [degree + 1][n] The derivatives of the action by the coefficients Q_k. */
    double *R;               /* [2n] The parts R_q and R_v of the gradient R by the curve's z. */
    double *q_rise_jacobian; /* [n][2n] The Jacobian of q_rise by z: (A0 - I, B0) for a, (A1 - I, B1) for b. */
    tvi_lu_factor B;         /* The matrix B0 or B1, factored. */
    double *multiplier;      /* [n] The Lagrange multiplier: l for a, m for b. */
    double *dz;              /* [2n] The last correction of z, which the increments contain to first order. */
} end_curve;

typedef struct {
    const tvi_system *system;
    const tvi_options *options;
    int n, degree, points;
    bool has_pi; /* If it is not set, the formulas have pi = 0. */
    end_curve a, b;
    tvi_newton newton; /* The corrector. Its unknowns are v0, q1, v1, scaled as the z of the curves. */
    /* The predictor. Its transform and its guess of the velocity are used for a Lagrangian only. */
    struct {
        tvi_legendre_transform legendre;
        /* q, and tau v (p for a Hamiltonian), at the end of curve a, which predict z of curve b. */
        tvi_series_sum q_at_end, v_at_end;
        double *velocity_guess; /* [n] The velocity at the last predictor; part of the history. */
    } predictor;
    /* The blend of the curves at the nodes, valid from one call of compute_gradient to the next. */
    struct {
        double *y, *v, *pi, *dpi_ds; /* [n][points] The blends y, v, pi and the derivative of pi. */
        /* [n][points] The derivatives of the action by y_i and v_i at node i, and by the difference a - b there. If v
         * is the derivative of the blend, the action depends on a - b also through v. */
        double *S_y, *S_v, *S_difference;
        double *row; /* [points] Scratch: one component of a series. */
    } blend;
    double *z_a;                    /* [2n] The z of curve a. */
    double *start_correction_p;     /* [n] What is added to p_a(0), the momentum of curve a at its start, to give p0. */
    double *increment_correction_p; /* [n] What is added to p_b(0) - p_a(0) to give p1 - p0. */
    double *last_dq, *last_dp;      /* [n] The increments of the last step. */
    double *scratch;                /* [n] */
    /* The step that is being made: valid until make_step returns. */
    struct {
        const tvi_step_origin *origin;
        double h;
        tvi_stats *stats;
    } step;
} work;

/* ---- Memory and tables ------------------------------------------------------------------------------------------- */

static void allocate_curve(end_curve *x, tvi_arena *arena, const tvi_system *system, const tvi_options *options,
                           double sign)
{
    /* The nodes of the action of one curve are on that curve with either node rule, since y blends whole curves. The
     * node rule only decides which of the two formulas gives v. */
    tvi_options plain = *options;
    plain.nodes = TVI_NODES_ON_CURVE;
    const size_t n = (size_t)system->n, degree = (size_t)options->degree;
    x->sign = sign;
    tvi_curve_allocate(&x->curve, arena, system, options->degree, TVI_JACOBIAN_MATRICES);
    tvi_action_allocate(&x->action, arena, system, &plain);
    tvi_series_sum *const sums[] = {&x->q_rise, &x->u_start, &x->dense_q, &x->dense_u};
    for (int i = 0; i < 4; i++) *sums[i] = tvi_series_sum_allocate(&x->curve, arena);
    x->blend = tvi_arena_allocate_doubles(arena, (size_t)options->quadrature_points);
    x->P = tvi_arena_allocate_doubles(arena, degree * n);
    x->seed_Q = tvi_arena_allocate_doubles(arena, (degree + 1) * n);
    x->q_rise_jacobian = tvi_arena_allocate_doubles(arena, n * 2 * n);
    tvi_arena_allocate_each(arena, 2 * n, (double **[]){&x->R, &x->multiplier, &x->dz, NULL});
    tvi_factor_allocate(&x->B, arena, system->n);
}

static void *allocate(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    const size_t n = (size_t)system->n, points = (size_t)options->quadrature_points;
    work *allocated = tvi_arena_allocate(arena, sizeof *allocated);
    work w = {.system = system,
              .options = options,
              .n = system->n,
              .degree = options->degree,
              .points = options->quadrature_points,
              .has_pi =
                  tvi_quadrature_order(options->quadrature, options->quadrature_points) >= 2 * options->degree + 1};
    allocate_curve(&w.a, arena, system, options, 1);
    allocate_curve(&w.b, arena, system, options, -1);
    tvi_newton_allocate(&w.newton, arena, 3, system, true);
    if (system->form == TVI_LAGRANGIAN) {
        tvi_legendre_allocate(&w.predictor.legendre, arena, system);
        w.predictor.velocity_guess = tvi_arena_allocate_copied(arena, n * sizeof *w.predictor.velocity_guess);
    }
    w.predictor.q_at_end = tvi_series_sum_allocate(&w.a.curve, arena);
    w.predictor.v_at_end = tvi_series_sum_allocate(&w.a.curve, arena);
    tvi_arena_allocate_each(arena, n * points,
                            (double **[]){&w.blend.y, &w.blend.v, &w.blend.pi, &w.blend.dpi_ds, &w.blend.S_y,
                                          &w.blend.S_v, &w.blend.S_difference, NULL});
    w.blend.row = tvi_arena_allocate_doubles(arena, points);
    tvi_arena_allocate_each(arena, 2 * n,
                            (double **[]){&w.z_a, &w.start_correction_p, &w.increment_correction_p, &w.last_dq,
                                          &w.last_dp, &w.scratch, NULL});
    if (allocated) *allocated = w;
    return allocated;
}

static void set_curve_tables(const work *w, end_curve *x, tvi_step_span span)
{
    double powers[TVI_MAX_DEGREE + 1], zeroth[TVI_MAX_DEGREE + 1] = {1};
    for (int k = 0; k <= w->degree; k++) powers[k] = k == 0 ? 0 : pow(x->sign, k);
    tvi_curve_fill_tables(&x->curve);
    tvi_curve_set_degrees(&x->curve, w->degree, w->degree - 1);
    tvi_action_set_tables(&x->action, w->options, span);
    tvi_series_sum_set(&x->q_rise, &x->curve, false, powers);
    tvi_series_sum_set(&x->u_start, &x->curve, true, zeroth);
    for (int node = 0; node < w->points; node++) x->blend[node] = 1 - x->sign * x->action.tables.s[node];
}

static void set_tables(void *self)
{
    work *w = self;
    const bool hamiltonian = w->system->form == TVI_HAMILTONIAN;
    double ones[TVI_MAX_DEGREE + 1], slopes[TVI_MAX_DEGREE + 1];
    tvi_newton_set_rules(&w->newton, w->options, true);
    set_curve_tables(w, &w->a, (tvi_step_span){0, 1, 1});
    set_curve_tables(w, &w->b, (tvi_step_span){-1, 0, 1});
    for (int k = 0; k <= w->degree; k++) {
        ones[k] = 1;
        slopes[k] = k;
    }
    tvi_series_sum_set(&w->predictor.q_at_end, &w->a.curve, false, ones);
    tvi_series_sum_set(&w->predictor.v_at_end, &w->a.curve, hamiltonian, hamiltonian ? ones : slopes);
}

/* ---- The gradient of the action ---------------------------------------------------------------------------------- */

/* Sets w->blend.row to the sum of c_k table_k at the nodes for the orders k = lowest .. degree, with c_k =
 * c[k * stride]. */
static void set_row_to_series(const work *w, int lowest, int degree, const double *c, size_t stride,
                              const double *table)
{
    for (int node = 0; node < w->points; node++) w->blend.row[node] = 0;
    for (int k = degree; k >= lowest; k--)
        for (int node = 0; node < w->points; node++)
            w->blend.row[node] += c[(size_t)k * stride] * table[k * w->points + node];
}

/* Adds the blended part of one curve, (1 - s) a or s b, to out. */
static void add_blended_series(const work *w, const end_curve *x, int degree, const double *c, size_t stride,
                               const double *table, double out[])
{
    set_row_to_series(w, 0, degree, c, stride, table);
    for (int node = 0; node < w->points; node++) out[node] += x->blend[node] * w->blend.row[node];
}

/* Adds one curve's part to the difference b - a in out: it subtracts the terms of curve a, or adds those of curve b,
 * from order 1 on. The coefficients of order 0 nearly cancel; for either curve half of their difference a_0 - b_0 is
 * subtracted. */
static void add_to_b_minus_a(const work *w, const end_curve *x, int degree, const double *c, size_t stride,
                             double difference_0, double out[])
{
    set_row_to_series(w, 1, degree, c, stride, x->action.tables.power.all);
    for (int node = 0; node < w->points; node++) out[node] -= x->sign * w->blend.row[node] + difference_0 / 2;
}

/* Adds one curve's part to component i of y, dy/ds, pi and dpi/ds. */
static void blend_component(const work *w, const end_curve *x, int i)
{
    const size_t at = (size_t)i * (size_t)w->points, n = (size_t)w->n, stride = curve_stride(&x->curve);
    const int degree = w->degree;
    const double *Q = curve_Q(&x->curve, 0) + i, *P = x->P + i;
    const double *power = x->action.tables.power.all, *slope = x->action.tables.slope.all;
    const double Q_0_difference = curve_Q(&w->a.curve, 0)[i] - curve_Q(&w->b.curve, 0)[i],
                 P_0_difference = w->a.P[i] - w->b.P[i];
    add_blended_series(w, x, degree, Q, stride, power, w->blend.y + at);
    add_blended_series(w, x, degree, Q, stride, slope, w->blend.v + at);
    if (w->options->nodes == TVI_NODES_ON_CURVE)
        add_to_b_minus_a(w, x, degree, Q, stride, Q_0_difference, w->blend.v + at);
    add_blended_series(w, x, degree - 1, P, n, power, w->blend.pi + at);
    add_blended_series(w, x, degree - 1, P, n, slope, w->blend.dpi_ds + at);
    add_to_b_minus_a(w, x, degree - 1, P, n, P_0_difference, w->blend.dpi_ds + at);
}

/* Computes R of one curve from the seeds, the derivatives of the action by each coefficient Q_k. */
static void compute_gradient_R(const work *w, end_curve *x)
{
    const int n = w->n, points = w->points;
    for (int i = 0; i < n; i++)
        for (int k = 0; k <= w->degree; k++) {
            const double *power = x->action.tables.power.all + k * points,
                         *slope = x->action.tables.slope.all + k * points;
            double sum = 0;
            for (int node = 0; node < points; node++) {
                const int at = i * points + node;
                const double blended =
                    x->blend[node] * (power[node] * w->blend.S_y[at] + slope[node] * w->blend.S_v[at]);
                sum += w->a.action.tables.weight[node] * (blended + x->sign * power[node] * w->blend.S_difference[at]);
            }
            x->seed_Q[k * n + i] = sum;
        }
    tvi_curve_multiply_seeds(&x->curve, x->seed_Q, NULL, x->R);
}

/* Computes R of both curves. Returns TVI_EDOMAIN if the field has no value at a node; if the momenta that belong to a
 * Hamiltonian's velocities are not found, TVI_ESINGULAR, TVI_ENONFINITE or TVI_ENOCONV. */
static tvi_status compute_gradient(work *w)
{
    const int count = w->n * w->points;
    const bool on_curve = w->options->nodes == TVI_NODES_ON_CURVE;
    double *const panels[] = {w->blend.y, w->blend.v, w->blend.pi, w->blend.dpi_ds};
    for (int i = 0; i < 4; i++) memset(panels[i], 0, (size_t)count * sizeof *panels[i]);
    curve_compute_P(&w->a.curve, w->degree - 1, w->a.P);
    curve_compute_P(&w->b.curve, w->degree - 1, w->b.P);
    for (int i = 0; i < w->n; i++) {
        blend_component(w, &w->a, i);
        blend_component(w, &w->b, i);
    }
    for (int i = 0; i < count; i++) w->blend.v[i] /= w->a.curve.tau;
    w->step.stats->force_evaluations += w->points;
    const tvi_status status =
        tvi_action_evaluate_lagrangian(&w->a.action, &w->a.curve, w->blend.y, w->blend.v, w->blend.pi);
    if (status != TVI_OK) return status;
    for (int i = 0; i < count; i++) {
        w->blend.S_y[i] = w->a.action.at_nodes.by_q[i] - (w->has_pi ? w->blend.dpi_ds[i] : 0);
        w->blend.S_v[i] = w->a.action.at_nodes.by_v[i] + (w->has_pi ? 0 : w->blend.pi[i]);
        w->blend.S_difference[i] = on_curve ? -w->blend.S_v[i] : w->has_pi ? w->blend.pi[i] : 0;
    }
    compute_gradient_R(w, &w->a);
    compute_gradient_R(w, &w->b);
    return TVI_OK;
}

/* ---- The equations of the corrector ------------------------------------------------------------------------------ */

static tvi_status expand(const work *w, end_curve *x, const double z[], double centre)
{
    w->step.stats->expansions++;
    curve_set_tau(&x->curve, w->step.h);
    curve_set_z(&x->curve, z);
    return tvi_curve_expand(&x->curve, centre);
}

static void compute_scale(void *self, double scale[])
{
    const work *w = self;
    const int n = w->n;
    tvi_curve_z_sizes(&w->a.curve, scale);
    memcpy(scale, scale + n, (size_t)n * sizeof *scale);
    tvi_curve_z_sizes(&w->b.curve, scale + n);
    if (w->degree > 1) return;
    /* The size of a velocity, from the coefficients of a curve of degree 1 that starts at rest, is 0. The magnitudes of
     * the momentum corrections are therefore added to the sizes of v0 and v1. */
    for (int i = 0; i < n; i++) {
        const double change =
            fabs(w->a.curve.kappa[i]) * (fabs(w->start_correction_p[i]) + fabs(w->increment_correction_p[i]));
        scale[i] += change;
        scale[2 * n + i] += change;
    }
}

/* Solves B0^T l = R_v0 for curve a, or B1^T m = R_v1 for curve b. */
static tvi_status solve_for_multiplier(const work *w, end_curve *x)
{
    const size_t n = (size_t)w->n;
    tvi_series_sum_compute_jacobian(&x->curve, &x->q_rise, x->q_rise_jacobian);
    for (size_t i = 0; i < n; i++) memcpy(x->B.lu + i * n, x->q_rise_jacobian + i * 2 * n + n, n * sizeof(double));
    memcpy(x->multiplier, x->R + n, n * sizeof(double));
    w->step.stats->factorisations++;
    const tvi_status status = tvi_factor_compute(&x->B);
    if (status == TVI_OK) tvi_factor_solve_transposed(&x->B, x->multiplier);
    return status;
}

/* Returns component j of (A0 - I)^T l for curve a, or of (A1 - I)^T m for curve b. */
static double rise_of_multiplier(const work *w, const end_curve *x, int j)
{
    double sum = 0;
    for (int i = 0; i < w->n; i++) sum += x->q_rise_jacobian[i * 2 * w->n + j] * x->multiplier[i];
    return sum;
}

/* Computes r = (a(1) - q1, b(-1) - q0, kappa (p_a(0) + start_correction_p - p0)). */
static tvi_status compute_residual(void *self, const double x[], double r[])
{
    work *w = self;
    end_curve *a = &w->a, *b = &w->b;
    const tvi_step_origin *origin = w->step.origin;
    const int n = w->n;
    const double *q1 = x + n, has_pi = w->has_pi ? 1 : 0;
    memcpy(w->z_a, origin->q, (size_t)n * sizeof *x);
    memcpy(w->z_a + n, x, (size_t)n * sizeof *x);
    tvi_status status = expand(w, a, w->z_a, origin->t + origin->t_low);
    if (status == TVI_OK) status = expand(w, b, q1, origin->t + (origin->t_low + w->step.h));
    if (status != TVI_OK) return status;
    tvi_curve_compute_jacobians(&a->curve);
    tvi_curve_compute_jacobians(&b->curve);
    status = compute_gradient(w);
    if (status == TVI_OK) status = solve_for_multiplier(w, a);
    if (status == TVI_OK) status = solve_for_multiplier(w, b);
    if (status != TVI_OK) return status;
    tvi_series_sum_compute(&a->curve, &a->q_rise, r);
    tvi_series_sum_compute(&b->curve, &b->q_rise, r + n);
    tvi_series_sum_compute(&a->curve, &a->u_start, r + 2 * n);
    for (int i = 0; i < n; i++) {
        const double of_l = rise_of_multiplier(w, a, i), of_m = rise_of_multiplier(w, b, i);
        w->start_correction_p[i] = -a->R[i] + of_l + (a->multiplier[i] - b->multiplier[i]);
        w->increment_correction_p[i] = a->R[i] + b->R[i] - of_l - of_m;
        const double kappa = a->curve.kappa[i], change = q1[i] - origin->q[i];
        r[i] -= change - origin->q_low[i];
        r[n + i] += change - origin->q_low[i];
        r[2 * n + i] =
            (has_pi * r[2 * n + i] - kappa * origin->p[i]) + kappa * (w->start_correction_p[i] - origin->p_low[i]);
    }
    return TVI_OK;
}

/* Fills in the residual's Jacobian, without the derivatives of the small corrections. Its columns belong to v0, q1, v1,
 * and its rows are B0 -I 0 ; 0 A1 B1 ; dU_a/dv0 0 0. */
static bool compute_jacobian(void *self, double matrix[])
{
    const work *w = self;
    const size_t n = (size_t)w->n, row = 3 * n, bytes = n * sizeof *matrix;
    double *u_jacobian = w->a.curve.jacobians.of_sum;
    memset(matrix, 0, row * row * sizeof *matrix);
    tvi_series_sum_compute_jacobian(&w->a.curve, &w->a.u_start, u_jacobian);
    for (size_t i = 0; i < n; i++) memcpy(matrix + (2 * n + i) * row, u_jacobian + i * 2 * n + n, bytes);
    for (size_t i = 0; i < n; i++) {
        memcpy(matrix + i * row, w->a.q_rise_jacobian + i * 2 * n + n, bytes);
        matrix[i * row + n + i] = -1;
        memcpy(matrix + (n + i) * row + n, w->b.q_rise_jacobian + i * 2 * n, 2 * bytes);
        matrix[(n + i) * row + n + i] += 1;
    }
    return true;
}

/* Estimates r [3n], the roundoff of the residual, from that of the field at the nodes: that of a(1), of b(-1), and of
 * kappa p_a(0). */
static void estimate_roundoff(void *self, double r[])
{
    work *w = self;
    const int n = w->n;
    double *of_u = r + 2 * n;
    w->step.stats->force_evaluations +=
        tvi_action_end_roundoff(&w->a.action, &w->a.curve, w->step.h, w->step.origin->q, w->step.origin->p, r, of_u);
    memcpy(r + n, r, (size_t)n * sizeof *r);
    for (int i = 0; i < n; i++) of_u[i] *= fabs(w->a.curve.kappa[i]);
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

/* Expands curve a from (q0, p0). Its end predicts z of curve b. */
static tvi_status predict(work *w)
{
    const size_t n = (size_t)w->n;
    const tvi_step_origin *origin = w->step.origin;
    tvi_status status = tvi_legendre_compute_start(&w->predictor.legendre, w->system, w->step.h, origin->t, origin->q,
                                                   origin->p, w->predictor.velocity_guess, w->z_a);
    if (status != TVI_OK) return status;
    status = expand(w, &w->a, w->z_a, origin->t + origin->t_low);
    memcpy(w->newton.x, w->z_a + n, n * sizeof(double));
    tvi_series_sum_compute(&w->a.curve, &w->predictor.q_at_end, w->newton.x + n);
    tvi_series_sum_compute(&w->a.curve, &w->predictor.v_at_end, w->newton.x + 2 * n);
    return status;
}

/* Computes dq = a(1) - q0 and kappa dp = (U_b - U_a) + kappa increment_correction_p, with U_a and U_b the scaled
 * momenta of the curves at their own ends. The corrections that have not been applied, the low-order part of q0 and
 * those of v0, q1 and v1 by the last pass, are added to first order. */
static void compute_increments(work *w, double dq[], double dp[])
{
    const int n = w->n;
    const size_t bytes = (size_t)n * sizeof(double);
    end_curve *a = &w->a, *b = &w->b;
    memcpy(a->dz, w->step.origin->q_low, bytes);
    memcpy(a->dz + n, w->newton.correction, bytes);
    memcpy(b->dz, w->newton.correction + n, 2 * bytes);
    tvi_curve_set_dz(&a->curve, a->dz);
    tvi_curve_set_dz(&b->curve, b->dz);
    tvi_series_sum_compute(&a->curve, &a->q_rise, dq);
    tvi_series_sum_compute_change(&a->curve, &a->q_rise, w->scratch);
    for (int i = 0; i < n; i++) dq[i] += w->scratch[i];
    tvi_series_sum_compute(&b->curve, &b->u_start, dp);
    tvi_series_sum_compute(&a->curve, &a->u_start, w->scratch);
    for (int i = 0; i < n; i++) dp[i] = w->has_pi ? dp[i] - w->scratch[i] : 0;
    tvi_series_sum_compute_change(&b->curve, &b->u_start, w->scratch);
    for (int i = 0; i < n; i++) dp[i] += w->scratch[i];
    tvi_series_sum_compute_change(&a->curve, &a->u_start, w->scratch);
    for (int i = 0; i < n; i++) dp[i] = (dp[i] - w->scratch[i]) / a->curve.kappa[i] + w->increment_correction_p[i];
}

static tvi_status make_step(void *self, double h, const tvi_step_origin *origin, const tvi_increments *increments,
                            tvi_stats *stats)
{
    work *w = self;
    const size_t bytes = (size_t)w->n * sizeof *increments->dq;
    const tvi_equations equations = {.self = w,
                                     .residual = compute_residual,
                                     .scale = compute_scale,
                                     .jacobian = compute_jacobian,
                                     .roundoff = estimate_roundoff};
    w->step.origin = origin;
    w->step.h = h;
    w->step.stats = stats;
    tvi_status status = predict(w);
    if (status == TVI_OK) status = tvi_newton_solve(&w->newton, &equations, stats);
    if (status != TVI_OK) return status;
    compute_increments(w, increments->dq, increments->dp);
    memcpy(w->last_dq, increments->dq, bytes);
    memcpy(w->last_dp, increments->dp, bytes);
    tvi_curve_compute_sizes(&w->a.curve);
    tvi_curve_compute_sizes(&w->b.curve);
    stats->tail = fmax(tvi_curve_tail(&w->a.curve), tvi_curve_tail(&w->b.curve));
    return TVI_OK;
}

/* Adds weight (q(s) - q(0)) of the curve to dq, and weight (p(s) - p(0)) to dp. */
static void add_weighted_increments(work *w, end_curve *x, double s, double weight, double dq[], double dp[])
{
    tvi_series_sum_set_powers(&x->dense_q, &x->curve, false, w->degree, 1, s, -1, 0);
    tvi_series_sum_set_powers(&x->dense_u, &x->curve, true, w->degree - 1, 1, s, -1, 0);
    tvi_series_sum_compute(&x->curve, &x->dense_q, w->scratch);
    for (int i = 0; i < w->n; i++) dq[i] += weight * w->scratch[i];
    tvi_series_sum_compute(&x->curve, &x->dense_u, w->scratch);
    for (int i = 0; i < w->n; i++) dp[i] += weight * w->scratch[i] / x->curve.kappa[i];
}

/* Computes the increments at the fraction theta of the step, by a blend of the curves: curve a has the weight 1 -
 * theta, and curve b, whose time begins at the end of the step, has the weight theta. */
static void compute_dense_output(void *self, double theta, double dq[], double dp[])
{
    work *w = self;
    for (int i = 0; i < w->n; i++) {
        dq[i] = theta * w->last_dq[i];
        dp[i] = theta * w->last_dp[i];
    }
    add_weighted_increments(w, &w->a, theta, 1 - theta, dq, dp);
    add_weighted_increments(w, &w->b, theta - 1, theta, dq, dp);
}

static tvi_tapes_of_steps list_tapes(const tvi_system *system, const tvi_options *options)
{
    return tvi_curve_list_tapes(system, options, options->quadrature_points, TVI_JACOBIAN_MATRICES);
}

const tvi_stepper tvi_stepper_both_ends = {.allocate = allocate,
                                           .set_tables = set_tables,
                                           .step = make_step,
                                           .interpolate = compute_dense_output,
                                           .list_tapes = list_tapes};
