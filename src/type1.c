/* type1.c - the type I generating function Ld(q0, q1), with the curve expanded at the start or at the midpoint
 * (docs/method.md section 4). The momenta at the ends are those of the curve plus a small correction,
 *     p0 = p- + d0,  p1 = p+ + d1,      G+^T d1 - G-^T d0 = D_z,      q-(z) = q0,      q1 = q+(z),         (I-defect)
 * where p-, p+ are the curve's momenta at its ends, G-, G+ = dq-/dz, dq+/dz and D_z comes from action.c.
 *
 * Written for u = tau q' and momenta scaled by tau/m, so that all unknowns have the unit of q. Without passes the
 * corrections are left out; at the start that is the plain Taylor method. */
#include "action.h"
#include "newton.h"
#include "stepper.h"

#include <math.h>
#include <string.h>

typedef struct {
    const tvi_system *system;
    const tvi_options *options;
    tvi_stats *stats; /* of the step at hand */
    const tvi_origin *origin;
    tvi_span span;
    int n, degree;
    bool corrects; /* false: no pass, the predictor is the step */
    double tau;
    tvi_curve curve;
    tvi_action action;
    tvi_newton newton;
    tvi_factor boundary;            /* of the equations for d0, d1 */
    double *q_from, *u_from;        /* [N + 1] weights of C_k in q- and u- */
    double *q_to, *u_to;            /* ... in q+ and u+ */
    double *q_back;                 /* ... in q- - C_0 */
    double *q_rise, *u_rise;        /* ... in q+ - q- and u+ - u- */
    double *q_mean;                 /* ... in (q- + q+)/2 */
    double *seed;                   /* [N + 1][n] */
    double *D;                      /* [2n] */
    double *d0, *rise;              /* [n] d0 and d1 - d0 */
    double *G;                      /* [n][2n] d(q+ - q-)/dz */
    double *dz;                     /* [2n] what z lacks at the end of the passes */
    double *shift;                  /* [n] */
} type1;

static tvi_span span_of(const tvi_options *options)
{
    return options->expansion == TVI_AT_MIDPOINT ? (tvi_span){-1, 1, 0.5} : (tvi_span){0, 1, 1};
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    type1 *work = tvi_arena_take(arena, sizeof *work);
    type1 w = {.system = system, .options = options, .span = span_of(options), .n = system->n, .degree = options->degree};
    const size_t n = (size_t)system->n, orders = (size_t)options->degree + 1;
    const int unknowns = options->expansion == TVI_AT_MIDPOINT ? 2 * system->n : system->n;
    w.corrects = options->passes != TVI_PREDICT_ONLY && options->method != TVI_TAYLOR;
    tvi_curve_take(&w.curve, arena, system, options->degree, w.corrects);
    double **const weights[] = {&w.q_from, &w.u_from, &w.q_to, &w.u_to, &w.q_back, &w.q_rise, &w.u_rise, &w.q_mean};
    for (size_t i = 0; i < sizeof weights / sizeof *weights; i++) *weights[i] = tvi_arena_doubles(arena, orders);
    w.shift = tvi_arena_doubles(arena, n);
    w.rise = tvi_arena_doubles(arena, n);
    if (w.corrects) {
        tvi_action_take(&w.action, arena, system, options);
        tvi_newton_take(&w.newton, arena, unknowns);
        tvi_factor_take(&w.boundary, arena, unknowns);
        w.seed = tvi_arena_doubles(arena, orders * n);
        w.D = tvi_arena_doubles(arena, 2 * n);
        w.d0 = tvi_arena_doubles(arena, n);
        w.G = tvi_arena_doubles(arena, n * 2 * n);
        w.dz = tvi_arena_doubles(arena, 2 * n);
    }
    if (work) *work = w;
    return work;
}

static void prepare(void *work)
{
    type1 *w = work;
    for (int k = 0; k <= w->degree; k++) {
        w->q_from[k] = pow(w->span.from, k);
        w->q_to[k] = pow(w->span.to, k);
        w->u_from[k] = k == 0 ? 0 : k * pow(w->span.from, k - 1);
        w->u_to[k] = k == 0 ? 0 : k * pow(w->span.to, k - 1);
        w->q_back[k] = k == 0 ? 0 : w->q_from[k];
        w->q_rise[k] = w->q_to[k] - w->q_from[k];
        w->u_rise[k] = w->u_to[k] - w->u_from[k];
        w->q_mean[k] = (w->q_to[k] + w->q_from[k]) / 2;
    }
    tvi_curve_prepare(&w->curve);
    if (w->corrects) tvi_action_prepare(&w->action, w->system, w->options, w->span);
}

/* ---- The predictor ------------------------------------------------------------------------------------------------- */

static tvi_status expand(type1 *w, double centre)
{
    w->stats->expansions++;
    return tvi_curve_expand(&w->curve, centre, w->tau);
}

/* C_0 = q0 and C_1 = tau M^-1 p0. */
static void start_curve(type1 *w)
{
    const tvi_origin *origin = w->origin;
    double *C0 = tvi_curve_coefficient(&w->curve, 0), *C1 = tvi_curve_coefficient(&w->curve, 1);
    for (int i = 0; i < w->n; i++) {
        C0[i] = origin->q[i];
        C1[i] = w->tau / w->system->mass[i] * origin->p[i];
    }
}

/* Sets the centre data of the curve: at the start from (q0, p0), at the midpoint from the curve that starts there. */
static tvi_status predict(type1 *w)
{
    start_curve(w);
    if (w->span.from == 0) return TVI_OK;
    const tvi_status status = expand(w, w->origin->t + w->origin->t_low);
    if (status != TVI_OK) return status;
    /* a step of -from in scaled time: both ends of the span are a unit away from the centre */
    tvi_curve_sum(&w->curve, w->q_to, w->rise);
    tvi_curve_sum(&w->curve, w->u_to, w->shift);
    memcpy(tvi_curve_coefficient(&w->curve, 0), w->rise, (size_t)w->n * sizeof(double));
    memcpy(tvi_curve_coefficient(&w->curve, 1), w->shift, (size_t)w->n * sizeof(double));
    return TVI_OK;
}

static tvi_status expand_at_centre(type1 *w)
{
    return expand(w, w->origin->t + (w->origin->t_low - w->span.from * w->tau));
}

/* ---- The residual -------------------------------------------------------------------------------------------------- */

/* The curve from its centre data, its Jacobians and D_z. */
static tvi_status gradient_of_action(type1 *w)
{
    tvi_status status = expand_at_centre(w);
    if (status != TVI_OK) return status;
    tvi_curve_differentiate(&w->curve);
    w->stats->force_evaluations += w->action.points;
    status = tvi_action_seed(&w->action, &w->curve, w->seed);
    if (status == TVI_OK) tvi_curve_pull(&w->curve, w->seed, w->D);
    return status;
}

/* Start, z = (q0, v), G- = (I, 0), G+ = (A, B):  B^T d1 = D_v,  d0 = A^T d1 - D_q,  d1 - d0 = D_q - (A - I)^T d1. */
static tvi_status boundary_at_start(type1 *w)
{
    const int n = w->n;
    tvi_curve_sum_jacobian(&w->curve, w->q_rise, w->G); /* (A - I, B) */
    double *d1 = w->D + n;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) w->boundary.lu[i * n + j] = w->G[i * 2 * n + n + j];
    w->stats->factorisations++;
    const tvi_status status = tvi_factor_compute(&w->boundary);
    if (status != TVI_OK) return status;
    tvi_factor_solve_transposed(&w->boundary, d1);
    for (int j = 0; j < n; j++) {
        w->rise[j] = w->D[j];
        for (int i = 0; i < n; i++) w->rise[j] -= w->G[i * 2 * n + j] * d1[i];
        w->d0[j] = d1[j] - w->rise[j];
    }
    return TVI_OK;
}

/* In the mean and half the difference of the ends, ((G+ + G-)/2)^T (d1 - d0) + ((G+ - G-)/2)^T (d1 + d0) = D_z: at the
 * midpoint the matrix is I + O(h). */
static tvi_status boundary_at_midpoint(type1 *w)
{
    const int n = w->n;
    double *half_rise = w->boundary.lu + 2 * n * n;
    tvi_curve_sum_jacobian(&w->curve, w->q_mean, w->boundary.lu);
    tvi_curve_sum_jacobian(&w->curve, w->q_rise, half_rise);
    for (int i = 0; i < 2 * n * n; i++) half_rise[i] /= 2;
    w->stats->factorisations++;
    const tvi_status status = tvi_factor_compute(&w->boundary);
    if (status != TVI_OK) return status;
    tvi_factor_solve_transposed(&w->boundary, w->D);
    for (int i = 0; i < n; i++) {
        w->rise[i] = w->D[i];
        w->d0[i] = (w->D[n + i] - w->D[i]) / 2;
    }
    return TVI_OK;
}

/* r[n] = u- + (tau/m) d0 - (tau/m) p0. */
static void momentum_residual(type1 *w, double r[])
{
    tvi_curve_sum(&w->curve, w->u_from, r);
    for (int i = 0; i < w->n; i++) {
        const double scale = w->tau / w->system->mass[i];
        r[i] = (r[i] - scale * w->origin->p[i]) + scale * (w->d0[i] - w->origin->p_low[i]);
    }
}

/* The size of component i of the curve: sum_{k >= first} |C_k|. */
static double curve_size(const type1 *w, int i, int first)
{
    double size = 0;
    for (int k = w->degree; k >= first; k--) size += fabs(tvi_curve_coefficient(&w->curve, k)[i]);
    return size;
}

/* x = C_1. */
static tvi_status residual_at_start(void *self, const double x[], double r[], double scale[])
{
    type1 *w = self;
    memcpy(tvi_curve_coefficient(&w->curve, 0), w->origin->q, (size_t)w->n * sizeof *x);
    memcpy(tvi_curve_coefficient(&w->curve, 1), x, (size_t)w->n * sizeof *x);
    tvi_status status = gradient_of_action(w);
    if (status == TVI_OK) status = boundary_at_start(w);
    if (status != TVI_OK) return status;
    momentum_residual(w, r);
    for (int i = 0; i < w->n; i++) scale[i] = curve_size(w, i, 1);
    return TVI_OK;
}

/* x = (C_0, C_1);  r = (q- - q0, momentum residual). */
static tvi_status residual_at_midpoint(void *self, const double x[], double r[], double scale[])
{
    type1 *w = self;
    const int n = w->n;
    memcpy(tvi_curve_coefficient(&w->curve, 0), x, (size_t)n * sizeof *x);
    memcpy(tvi_curve_coefficient(&w->curve, 1), x + n, (size_t)n * sizeof *x);
    tvi_status status = gradient_of_action(w);
    if (status == TVI_OK) status = boundary_at_midpoint(w);
    if (status != TVI_OK) return status;
    tvi_curve_sum(&w->curve, w->q_back, r);
    for (int i = 0; i < n; i++) r[i] += (x[i] - w->origin->q[i]) - w->origin->q_low[i];
    momentum_residual(w, r + n);
    for (int i = 0; i < n; i++) {
        scale[i] = curve_size(w, i, 0);
        scale[n + i] = curve_size(w, i, 1);
    }
    return TVI_OK;
}

/* d(q-, u-)/dz: the residual without the change of the small d0. At the start the same is the identity. */
static void jacobian_at_midpoint(void *self, double matrix[])
{
    type1 *w = self;
    tvi_curve_sum_jacobian(&w->curve, w->q_from, matrix);
    tvi_curve_sum_jacobian(&w->curve, w->u_from, matrix + 2 * w->n * w->n);
}

/* ---- The step ------------------------------------------------------------------------------------------------------ */

static tvi_status correct(type1 *w)
{
    const size_t n = (size_t)w->n, bytes = n * sizeof(double);
    const bool at_start = w->span.from == 0;
    const tvi_equations equations = {w, at_start ? residual_at_start : residual_at_midpoint,
                                     at_start ? NULL : jacobian_at_midpoint};
    memcpy(w->newton.x, tvi_curve_coefficient(&w->curve, at_start ? 1 : 0), bytes);
    if (!at_start) memcpy(w->newton.x + n, tvi_curve_coefficient(&w->curve, 1), bytes);
    const tvi_status status = tvi_newton_solve(&w->newton, &equations, w->options, w->stats);
    if (status != TVI_OK) return status;
    if (at_start) memcpy(w->dz, w->origin->q_low, bytes);
    memcpy(w->dz + (at_start ? n : 0), w->newton.correction, (at_start ? 1 : 2) * bytes);
    return TVI_OK;
}

/* dq = q+ - q-, dp = (p+ - p-) + (d1 - d0), the curve's part with what z lacks to first order. */
static void increments(type1 *w, double dq[], double dp[])
{
    tvi_curve_sum(&w->curve, w->q_rise, dq);
    tvi_curve_sum(&w->curve, w->u_rise, dp);
    if (w->corrects) {
        tvi_curve_push(&w->curve, w->q_rise, w->dz, w->shift);
        for (int i = 0; i < w->n; i++) dq[i] += w->shift[i];
        tvi_curve_push(&w->curve, w->u_rise, w->dz, w->shift);
        for (int i = 0; i < w->n; i++) dp[i] += w->shift[i];
    }
    for (int i = 0; i < w->n; i++) dp[i] = w->system->mass[i] / w->tau * dp[i] + (w->corrects ? w->rise[i] : 0);
}

/* |C_N| / |q|: both ends are a unit of scaled time away from the centre, or at it. */
static double tail(const type1 *w)
{
    double last = 0, q = 0;
    for (int i = 0; i < w->n; i++) {
        last = fmax(last, fabs(tvi_curve_coefficient(&w->curve, w->degree)[i]));
        q = fmax(q, fabs(w->origin->q[i]));
    }
    return q > 0 ? last / q : 0;
}

static tvi_status step(void *work, double h, const tvi_origin *origin, double dq[], double dp[], tvi_stats *stats)
{
    type1 *w = work;
    w->origin = origin;
    w->stats = stats;
    w->tau = w->span.tau * h;
    tvi_status status = predict(w);
    if (status == TVI_OK) status = w->corrects ? correct(w) : expand_at_centre(w);
    if (status != TVI_OK) return status;
    increments(w, dq, dp);
    stats->tail = tail(w);
    return TVI_OK;
}

const tvi_stepper tvi_stepper_type1 = {take, prepare, step};
