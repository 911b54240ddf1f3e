/* curve_stepper.c - the step of every method that expands one curve: predictor, residual of the passes, increments. The
 * generating function is data: where the curve is expanded, and how its equations are closed (method/descriptor.h).
 * Without passes the corrections are left out; at the start that is the plain Taylor method. */
#include "generating/closure.h"
#include "system/legendre.h"
#include "method/method.h"
#include "generating/newton.h"
#include "algebra/sizes.h"
#include "method/stepper.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What reused Jacobians may do to the state, relative to it: well below the roundoff of a step. */
static const double STALE = DBL_EPSILON / 16;

typedef struct {
    tvi_closure closure;
    tvi_close_fn *close; /* NULL: no corrections */
    bool is_rough;
    const tvi_options *options;
    tvi_stats *stats; /* of the step at hand */
    const tvi_origin *origin;
    int q_degree, p_degree;
    tvi_action action;
    tvi_newton newton;
    tvi_legendre legendre;
    tvi_combination q_back;             /* q- - Q_0 */
    tvi_combination q_centre, z_centre; /* the centre data, of the curve that starts at (q0, p0) */
    tvi_combination dense_q, dense_u;   /* for one point of dense output */
    double *z;                          /* [2n] predictor */
    double *dz;                         /* [2n] what z lacks at the end of the passes */
    double *z_jacobian;                 /* [2n] where the Jacobians of the curve were taken */
    bool has_jacobian;                  /* they were, in the step at hand */
    bool is_new_jacobian;               /* they were, since the corrector last asked */
    double *p_size;                     /* [n] sum_k |P_k| */
    double *velocity;                   /* [n] of the last predictor, Lagrangian; in the history */
    double *shift;                      /* [n] */
} work;

static void take_closure(tvi_closure *c, tvi_arena *arena, const tvi_system *system, const tvi_expanded *expanded,
                         int degree, bool corrects)
{
    const size_t n = (size_t)system->n;
    const bool one_more = expanded->has_top_momentum && system->form == TVI_SEPARABLE; /* p_N is from Q_{N+1} */
    c->system = system;
    c->n = system->n;
    c->span = expanded->span;
    tvi_curve_take(&c->curve, arena, system, degree + one_more,
                   corrects ? tvi_curve_jacobians_for(system) : TVI_NO_JACOBIANS);
    tvi_combination *const combinations[] = {&c->q_from, &c->q_to, &c->q_rise, &c->q_mean,
                                             &c->u_from, &c->u_to, &c->u_rise, &c->u_mean};
    for (size_t i = 0; i < sizeof combinations / sizeof *combinations; i++)
        *combinations[i] = tvi_combination_take(&c->curve, arena);
    double **const corrections[] = {&c->from_q, &c->from_p, &c->rise_q, &c->rise_p};
    for (size_t i = 0; i < sizeof corrections / sizeof *corrections; i++) *corrections[i] = tvi_arena_doubles(arena, n);
    if (corrects) tvi_close_take(c, arena);
}

static void *take(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    work *taken = tvi_arena_take(arena, sizeof *taken);
    const tvi_expanded *expanded = &tvi_method_of(options)->curve;
    const bool corrects = expanded->close && options->passes != TVI_PREDICT_ONLY;
    const int degree = options->degree;
    const size_t n = (size_t)system->n;
    work w = {.close = corrects ? expanded->close : NULL,
              .is_rough = expanded->is_rough,
              .options = options,
              .q_degree = degree,
              .p_degree = expanded->has_top_momentum ? degree : degree - 1};
    take_closure(&w.closure, arena, system, expanded, degree, corrects);
    const tvi_curve *curve = &w.closure.curve;
    const size_t seeds = ((size_t)curve->top + 1) * n;
    tvi_combination *const combinations[] = {&w.q_back, &w.q_centre, &w.z_centre, &w.dense_q, &w.dense_u};
    for (size_t i = 0; i < sizeof combinations / sizeof *combinations; i++)
        *combinations[i] = tvi_combination_take(curve, arena);
    if (system->form == TVI_LAGRANGIAN) {
        tvi_legendre_take(&w.legendre, arena, system);
        w.velocity = tvi_arena_history(arena, n * sizeof *w.velocity);
    }
    w.shift = tvi_arena_doubles(arena, n);
    w.z = tvi_arena_doubles(arena, 2 * n);
    w.dz = tvi_arena_doubles(arena, 2 * n);
    w.z_jacobian = tvi_arena_doubles(arena, 2 * n);
    w.p_size = tvi_arena_doubles(arena, n);
    if (corrects) {
        tvi_action_take(&w.action, arena, system, options, expanded->action, w.q_degree, w.p_degree, curve->top);
        tvi_newton_take(&w.newton, arena, 2 * system->n, system->n, !tvi_curve_has_products(&w.closure.curve));
        w.closure.seed_Q = tvi_arena_doubles(arena, seeds);
        w.closure.seed_U = tvi_arena_doubles(arena, seeds);
    }
    if (taken) *taken = w;
    return taken;
}

/* ---- The weights of the ends ------------------------------------------------------------------------------------- */

/* z_centre: tau v = sum k Q_k s^(k-1), but p of a Hamiltonian, s = -from. */
static void set_centre(work *w)
{
    const tvi_curve *curve = &w->closure.curve;
    const bool hamiltonian = w->closure.system->form == TVI_HAMILTONIAN;
    const double s = -w->closure.span.from;
    double weight[TVI_MAX_DEGREE + 2] = {0};
    for (int k = 0; k <= curve->top; k++) weight[k] = hamiltonian ? pow(s, k) : k > 0 ? k * pow(s, k - 1) : 0;
    tvi_combination_set(&w->z_centre, curve, hamiltonian, weight);
    tvi_combination_set_powers(&w->q_centre, curve, false, curve->top, 1, s, 0, 0);
}

static void prepare(void *taken)
{
    work *w = taken;
    tvi_closure *c = &w->closure;
    tvi_combination *const ends[2][4] = {{&c->q_from, &c->q_to, &c->q_rise, &c->q_mean},
                                         {&c->u_from, &c->u_to, &c->u_rise, &c->u_mean}};
    const double from = c->span.from, to = c->span.to;
    tvi_curve_prepare(&c->curve);
    for (int of_momentum = 0; of_momentum < 2; of_momentum++) {
        const int degree = of_momentum ? w->p_degree : w->q_degree;
        tvi_combination_set_powers(ends[of_momentum][0], &c->curve, of_momentum, degree, 0, 0, 1, from);
        tvi_combination_set_powers(ends[of_momentum][1], &c->curve, of_momentum, degree, 1, to, 0, 0);
        tvi_combination_set_powers(ends[of_momentum][2], &c->curve, of_momentum, degree, 1, to, -1, from);
        tvi_combination_set_powers(ends[of_momentum][3], &c->curve, of_momentum, degree, -from / (to - from), to,
                                   to / (to - from), from);
    }
    tvi_combination_set_powers(&w->q_back, &c->curve, false, w->q_degree, 1, from, -1, 0);
    set_centre(w);
    if (c->system->form == TVI_LAGRANGIAN) tvi_legendre_prepare(&w->legendre);
    if (w->close) tvi_action_prepare(&w->action, c->system, w->options, c->span, c->curve.top);
}

/* ---- The predictor ----------------------------------------------------------------------------------------------- */

static tvi_status expand(work *w, const double z[], double centre)
{
    w->stats->expansions++;
    tvi_curve_set(&w->closure.curve, z);
    return tvi_curve_expand(&w->closure.curve, centre);
}

/* z at the centre, by the curve that starts at (q0, p0). */
static tvi_status predict(work *w)
{
    const tvi_origin *origin = w->origin;
    tvi_status status = tvi_legendre_start(&w->legendre, w->closure.system, w->closure.curve.tau, origin->t, origin->q,
                                           origin->p, w->velocity, w->z);
    if (status != TVI_OK || w->closure.span.from == 0) return status;
    status = expand(w, w->z, origin->t + origin->t_low);
    tvi_curve_sum(&w->closure.curve, &w->q_centre, w->z);
    tvi_curve_sum(&w->closure.curve, &w->z_centre, w->z + w->closure.n);
    return status;
}

static double centre(const work *w)
{
    return w->origin->t + (w->origin->t_low - w->closure.span.from * w->closure.curve.tau);
}

/* ---- The residual ------------------------------------------------------------------------------------------------ */

/* The natural sizes of the unknowns: sum_k |Q_k|, and sum_{k>=1} |Q_k| for tau v or sum_k |P_k| for p. All that a curve
 * of degree 0 or 1 knows of a body that starts at rest is the corrections, which are momenta: in the unit of the
 * unknown but for a Lagrangian. */
static void set_scale(void *self, double scale[])
{
    const work *w = self;
    const tvi_closure *c = &w->closure;
    const tvi_curve *curve = &w->closure.curve;
    const int n = w->closure.n;
    const bool hamiltonian = w->closure.system->form == TVI_HAMILTONIAN;
    memset(scale, 0, 2 * (size_t)n * sizeof *scale);
    for (int k = curve->top; k >= 0; k--) {
        const double *Q = tvi_curve_Q(curve, k), *second = hamiltonian ? Q + n : Q;
        for (int i = 0; i < n; i++) {
            scale[i] += fabs(Q[i]);
            if (k > 0 || hamiltonian) scale[n + i] += fabs(second[i]);
        }
    }
    if (curve->top > 1 || c->system->form == TVI_LAGRANGIAN) return;
    for (int i = 0; i < n; i++) {
        scale[i] += fabs(c->from_q[i]) + fabs(c->rise_q[i]);
        scale[n + i] += fabs(c->curve.kappa[i]) * (fabs(c->from_p[i]) + fabs(c->rise_p[i]));
    }
}

/* r = (q- + from_q - q0, kappa (p- + from_p - p0)), the small differences first. */
static void form_residual(work *w, double r[])
{
    const tvi_closure *c = &w->closure;
    const tvi_origin *origin = w->origin;
    const int n = c->n;
    const double *Q0 = tvi_curve_Q(&c->curve, 0);
    tvi_curve_sum(&c->curve, &w->q_back, r);
    tvi_curve_sum(&c->curve, &c->u_from, r + n);
    for (int i = 0; i < n; i++) {
        const double kappa = c->curve.kappa[i];
        r[i] += (Q0[i] - origin->q[i]) + (c->from_q[i] - origin->q_low[i]);
        r[n + i] = (r[n + i] - kappa * origin->p[i]) + kappa * (c->from_p[i] - origin->p_low[i]);
    }
}

static void set_momentum_size(work *w)
{
    const tvi_curve *curve = &w->closure.curve;
    memset(w->p_size, 0, (size_t)w->closure.n * sizeof *w->p_size);
    for (int k = w->p_degree; k >= 0; k--) {
        tvi_curve_momentum(curve, k, w->shift);
        for (int i = 0; i < w->closure.n; i++) w->p_size[i] += fabs(w->shift[i]);
    }
}

static void differentiate(work *w, const double z[])
{
    tvi_curve_differentiate(&w->closure.curve);
    memcpy(w->z_jacobian, z, 2 * (size_t)w->closure.n * sizeof *z);
    w->has_jacobian = w->is_new_jacobian = w->closure.is_fresh = true;
}

/* D_z, and the corrections of the generating function. */
static tvi_status close_equations(work *w)
{
    tvi_closure *c = &w->closure;
    if (c->is_fresh) w->stats->factorisations++;
    const tvi_status status = w->close(c);
    c->is_fresh = false;
    return status;
}

/* sum_k |seed_k| of component i. */
static double seed_size(const tvi_closure *c, const double seed[], int i)
{
    double size = 0;
    for (int k = 0; k <= c->curve.top; k++) size += fabs(seed[k * c->n + i]);
    return size;
}

/* Jacobians that were taken at another z are wrong by about the relative distance to it. They multiply the seeds, which
 * need not be as small as the D_z that they add up to, and the corrections: this bounds what that does to the state,
 * relative to the state. */
static double staleness(work *w, const double z[])
{
    const tvi_closure *c = &w->closure;
    const double *scale = w->newton.scale;
    double distance = 0, part = 0;
    set_momentum_size(w);
    for (int i = 0; i < 2 * c->n; i++) distance = fmax(distance, tvi_ratio(fabs(z[i] - w->z_jacobian[i]), scale[i]));
    for (int i = 0; i < c->n; i++) {
        const double of_q = fabs(c->curve.kappa[i]) * seed_size(c, c->seed_U, i), of_p = seed_size(c, c->seed_Q, i);
        part = fmax(part, tvi_ratio(fabs(c->from_q[i]) + fabs(c->rise_q[i]) + of_q, scale[i]));
        part = fmax(part, tvi_ratio(fabs(c->from_p[i]) + fabs(c->rise_p[i]) + of_p, w->p_size[i]));
    }
    return distance * part;
}

/* The Jacobians of the first pass serve the later ones as long as that shows nowhere. */
static tvi_status close_by_matrices(work *w, const double z[])
{
    const bool reuses = w->has_jacobian;
    if (!reuses) differentiate(w, z);
    tvi_status status = close_equations(w);
    if (reuses && (status != TVI_OK || staleness(w, z) > STALE)) {
        differentiate(w, z);
        status = close_equations(w);
    }
    return status;
}

/* The momentum that moves a body by the size of its position in the time of the step; where all is at the origin, 1. */
static double momentum_unit(const tvi_closure *c)
{
    double largest = 0;
    for (int k = 0; k <= c->curve.top; k++)
        for (int i = 0; i < c->n; i++) largest = fmax(largest, fabs(tvi_curve_Q(&c->curve, k)[i] / c->curve.kappa[i]));
    return largest > 0 ? largest : 1;
}

/* The unknowns of the closing are momenta, or u / kappa. A body whose curve has none is measured by the others, and
 * where none has any, as at rest with degree 1, by their positions. */
static tvi_status close_by_products(work *w)
{
    tvi_closure *c = &w->closure;
    double largest = 0;
    set_momentum_size(w);
    for (int i = 0; i < c->n; i++) largest = fmax(largest, w->p_size[i]);
    if (largest == 0) largest = momentum_unit(c);
    for (int i = 0; i < c->n; i++)
        c->iteration.size[i] = w->p_size[i] > 0 ? fmax(w->p_size[i], TVI_LEAST_SHARE * largest) : largest;
    return w->close(c);
}

static tvi_status residual(void *self, const double z[], double r[])
{
    work *w = self;
    tvi_closure *c = &w->closure;
    tvi_status status = expand(w, z, centre(w));
    if (status != TVI_OK) return status;
    w->stats->force_evaluations += w->action.points;
    status = tvi_action_seed(&w->action, &c->curve, c->seed_Q, c->seed_U);
    if (status != TVI_OK) return status;
    status = tvi_curve_has_products(&w->closure.curve) ? close_by_products(w) : close_by_matrices(w, z);
    if (status == TVI_OK) form_residual(w, r);
    return status;
}

/* d(q-, kappa p-)/dz: the residual's without the change of the small corrections. */
static bool jacobian(void *self, double matrix[])
{
    work *w = self;
    const tvi_closure *c = &w->closure;
    if (!w->is_new_jacobian) return false;
    w->is_new_jacobian = false;
    tvi_curve_sum_jacobian(&c->curve, &c->q_from, matrix);
    tvi_curve_sum_jacobian(&c->curve, &c->u_from, matrix + 2 * (size_t)c->n * (size_t)c->n);
    return true;
}

/* What the field at the nodes makes of (q-, kappa p-). */
static void residual_roundoff(void *self, double r[])
{
    work *w = self;
    const tvi_closure *c = &w->closure;
    const double h = (c->span.to - c->span.from) * c->curve.tau;
    w->stats->force_evaluations +=
        tvi_action_roundoff(&w->action, &c->curve, h, w->origin->q, w->origin->p, r, r + c->n);
    for (int i = 0; i < c->n; i++) r[c->n + i] *= fabs(c->curve.kappa[i]);
}

static void correct_by_product(void *self, double correction[])
{
    work *w = self;
    tvi_close_correct(&w->closure, correction);
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

static tvi_status correct(work *w)
{
    const size_t unknowns = 2 * (size_t)w->closure.n;
    /* at the start q- and kappa p- are z itself, but for a Lagrangian, whose p is not v */
    const bool is_identity = w->closure.span.from == 0 && w->closure.system->form != TVI_LAGRANGIAN;
    /* degree 0, which leaves all to the corrections, moves q and p in turns, each as little as the other was wrong */
    const bool is_rough = w->is_rough || w->q_degree == 0;
    const bool products = tvi_curve_has_products(&w->closure.curve);
    const tvi_equations equations = {.self = w,
                                     .residual = residual,
                                     .scale = set_scale,
                                     .jacobian = is_identity || products ? NULL : jacobian,
                                     .solve = is_identity || !products ? NULL : correct_by_product,
                                     .roundoff = residual_roundoff,
                                     .is_rough = is_rough};
    w->closure.iteration.has_guess = false;
    memcpy(w->newton.x, w->z, unknowns * sizeof *w->z);
    const tvi_status status = tvi_newton_solve(&w->newton, &equations, w->options, w->stats);
    memcpy(w->dz, w->newton.correction, unknowns * sizeof *w->dz);
    if (status == TVI_OK) tvi_curve_aim(&w->closure.curve, w->dz);
    return status;
}

/* out = sum of the combination at z + dz, to first order in dz. */
static void sum_and_push(work *w, const tvi_combination *combination, double out[])
{
    tvi_curve_sum(&w->closure.curve, combination, out);
    if (!w->close) return;
    tvi_curve_push(&w->closure.curve, combination, w->shift);
    for (int i = 0; i < w->closure.n; i++) out[i] += w->shift[i];
}

/* dq = (q+ - q-) + rise_q and dp = (p+ - p-) + rise_p, or a part of the way. */
static void increments(work *w, const tvi_combination *q_rise, const tvi_combination *u_rise, double part, double dq[],
                       double dp[])
{
    const tvi_closure *c = &w->closure;
    sum_and_push(w, q_rise, dq);
    sum_and_push(w, u_rise, dp);
    for (int i = 0; i < c->n; i++) {
        dp[i] /= c->curve.kappa[i];
        if (!w->close) continue;
        dq[i] += part * c->rise_q[i];
        dp[i] += part * c->rise_p[i];
    }
}

static tvi_status step(void *taken, double h, const tvi_origin *origin, double dq[], double dp[], tvi_stats *stats)
{
    work *w = taken;
    w->origin = origin;
    w->stats = stats;
    w->has_jacobian = false;
    w->closure.curve.tau = w->closure.span.tau * h;
    tvi_status status = predict(w);
    if (status == TVI_OK) status = w->close ? correct(w) : expand(w, w->z, centre(w));
    if (status != TVI_OK) return status;
    increments(w, &w->closure.q_rise, &w->closure.u_rise, 1, dq, dp);
    stats->tail = tvi_curve_tail(&w->closure.curve, w->q_degree, w->p_degree);
    return TVI_OK;
}

/* The curve, with the corrections growing linearly. */
static void dense(void *taken, double theta, double dq[], double dp[])
{
    work *w = taken;
    const tvi_closure *c = &w->closure;
    const double at = c->span.from + theta * (c->span.to - c->span.from);
    tvi_combination_set_powers(&w->dense_q, &c->curve, false, w->q_degree, 1, at, -1, c->span.from);
    tvi_combination_set_powers(&w->dense_u, &c->curve, true, w->p_degree, 1, at, -1, c->span.from);
    increments(w, &w->dense_q, &w->dense_u, theta, dq, dp);
}

const tvi_stepper tvi_stepper_curve = {take, prepare, step, dense, NULL, false};
