/* curve_step.h - makes the parts of a step of a method that expands one curve. It is part of the text of generated code
 * (emit.c), where every size is a constant. */
#ifndef TVI_SRC_GENERATING_CURVE_STEP_H
#define TVI_SRC_GENERATING_CURVE_STEP_H

#include "algebra/linear_small.h"
#include "generating/curve_stepper.h"
#include "generating/lagrangian_orders.h"
#include "generating/matrices.h"

/* Returns the time about which the curve of the step is expanded. */
static inline double step_centre(const tvi_curve_work *w, const tvi_origin *origin, double tau)
{
    return origin->t + (origin->t_low - w->closure.span.from * tau);
}

/* Moves z to the centre, along the curve that starts at the start of the step. */
static inline void step_move_to_centre(const tvi_curve_work *w, double z[])
{
    const tvi_closure *c = &w->closure;
    CURVE_CALL(sum, &c->curve, &w->q_centre, z);
    CURVE_CALL(sum, &c->curve, &w->z_centre, z + curve_n(&c->curve));
}

/* Computes the natural sizes of the unknowns. If a body starts at rest, a curve of degree 0 or 1 knows only the
 * corrections, which are momenta: they are in the unit of the unknown, except for a Lagrangian. */
static inline void step_set_scale(const tvi_closure *c, double scale[])
{
    const tvi_curve *curve = &c->curve;
    const int n = curve_n(&c->curve);
    CURVE_CALL(sizes, curve, scale);
    if (curve_top(curve) > 1 || curve_form(&c->curve) == TVI_LAGRANGIAN) return;
    for (int i = 0; i < n; i++) {
        scale[i] += fabs(c->from_q[i]) + fabs(c->rise_q[i]);
        scale[n + i] += fabs(c->curve.kappa[i]) * (fabs(c->from_p[i]) + fabs(c->rise_p[i]));
    }
}

/* Computes r = (q- + from_q - q0, kappa (p- + from_p - p0)), the small differences first. */
static inline void step_form_residual(const tvi_curve_work *w, const tvi_origin *origin, double r[])
{
    const tvi_closure *c = &w->closure;
    const int n = curve_n(&c->curve);
    const double *Q0 = tvi_curve_Q(&c->curve, 0);
    CURVE_CALL(sum, &c->curve, &w->q_back, r);
    CURVE_CALL(sum, &c->curve, &c->u_from, r + n);
    for (int i = 0; i < n; i++) {
        const double kappa = c->curve.kappa[i];
        r[i] += (Q0[i] - origin->q[i]) + (c->from_q[i] - origin->q_low[i]);
        r[n + i] = (r[n + i] - kappa * origin->p[i]) + kappa * (c->from_p[i] - origin->p_low[i]);
    }
}

/* Returns whether there are corrections; generated code has no steps without them. */
static inline bool step_corrects(const tvi_curve_work *w)
{
    (void)w;
    return CURVE_SIZE(true, w->corrects);
}

/* Computes out, the sum of the combination at z + dz, to first order in dz. */
static inline void step_sum_and_push(const tvi_curve_work *w, const tvi_combination *combination, double out[])
{
    CURVE_CALL(sum, &w->closure.curve, combination, out);
    if (!step_corrects(w)) return;
    CURVE_CALL(push, &w->closure.curve, combination, w->shift);
    for (int i = 0; i < curve_n(&w->closure.curve); i++) out[i] += w->shift[i];
}

/* Computes dq = (q+ - q-) + rise_q and dp = (p+ - p-) + rise_p, or a part of the way. */
static inline void step_increments(const tvi_curve_work *w, const tvi_combination *q_rise,
                                   const tvi_combination *u_rise, double part, double dq[], double dp[])
{
    const tvi_closure *c = &w->closure;
    step_sum_and_push(w, q_rise, dq);
    step_sum_and_push(w, u_rise, dp);
    for (int i = 0; i < curve_n(&c->curve); i++) {
        dp[i] /= c->curve.kappa[i];
        if (!step_corrects(w)) continue;
        dq[i] += part * c->rise_q[i];
        dp[i] += part * c->rise_p[i];
    }
}

/* Stores the velocity at the end of a Lagrangian's curve: the search for the next step's velocity starts there. */
static inline void step_leave_velocity(const tvi_curve_work *w)
{
    const tvi_curve *curve = &w->closure.curve;
    if (curve_form(curve) != TVI_LAGRANGIAN) return;
    CURVE_CALL(sum, curve, &w->v_end, w->velocity);
    for (int i = 0; i < curve_n(curve); i++) w->velocity[i] /= curve->tau;
}

/* Computes the increments that the step returns from the curve. Returns its tail. */
static inline double step_finish(const tvi_curve_work *w, double dq[], double dp[])
{
    const tvi_curve *curve = &w->closure.curve;
    step_increments(w, &w->closure.q_rise, &w->closure.u_rise, 1, dq, dp);
    step_leave_velocity(w);
    CURVE_CALL(measure, curve);
    return CURVE_CALL(tail, curve);
}

/* ---- A whole step ------------------------------------------------------------------------------------------------ */

/* The caller gives these functions of a curve's code: the series without Jacobians and with them, and the seeds, finite
 * or not. */
typedef struct {
    tvi_status (*expand)(tvi_curve *curve), (*expand_all)(tvi_curve *curve);
    tvi_status (*seed)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[]);
} step_makers;

/* A quick step holds the step that is being made. */
typedef struct {
    tvi_curve_work *work;
    const step_makers *makers;
    int factorisations;
} step_quick;

/* Factors new Jacobians. In the generating function's equations the second half may be of the coordinates, in another
 * unit than a Hamiltonian's p; in the corrector's it is of momenta, in another unit than a Lagrangian's tau v. */
static inline bool step_factor(step_quick *a, const double z[])
{
    const tvi_closure *c = &a->work->closure;
    const tvi_form form = curve_form(&c->curve);
    const int n = curve_n(&c->curve), size = 2 * n;
    const bool has_momenta = c->mean->has_momenta;
    tvi_factor *full = &matrices_of(c)->full, *back = &a->work->newton.factor;
    matrices_take(c, z);
    matrices_join(c, &c->q_mean, has_momenta ? &c->u_mean : &c->q_rise, full->lu);
    const bool has_back = matrices_jacobian(c, back->lu);
    const bool is_safe = linear_unpivoted_factor(size, form != TVI_HAMILTONIAN || has_momenta ? size : n, full);
    a->factorisations += 1 + has_back;
    return is_safe && (!has_back || linear_unpivoted_factor(size, form != TVI_LAGRANGIAN ? size : n, back));
}

/* Computes the correction of a pass at x, and its size. Returns false if the quick step does not make this pass, for
 * example if a number on the way to the correction is not finite. */
static inline bool step_pass(step_quick *a, const tvi_origin *origin, bool is_first, tvi_newton_size *correction)
{
    tvi_curve_work *w = a->work;
    tvi_closure *c = &w->closure;
    tvi_newton *newton = &w->newton;
    const int size = 2 * curve_n(&c->curve);
    double *x = newton->x, *r = newton->correction;
    const bool is_due = matrices_are_due(c, x, newton->scale);
    curve_place(&c->curve, x);
    if ((is_due ? a->makers->expand_all : a->makers->expand)(&c->curve) != TVI_OK) return false;
    if (a->makers->seed(&w->action, &c->curve, c->seed_Q, c->seed_U) != TVI_OK) return false;
    if (is_due && !step_factor(a, x)) return false;
    CURVE_CALL(pull, &c->curve, c->seed_Q, c->seed_U, c->D);
    linear_unpivoted_solve_transposed(size, &matrices_of(c)->full, c->D);
    closure_correct_ends(c);
    step_form_residual(w, origin, r);
    if (is_first) {
        step_set_scale(c, newton->scale);
        newton_fill_scale(newton);
    }
    for (int i = 0; i < size; i++) r[i] = -r[i];
    linear_unpivoted_solve(size, &newton->factor, r);
    *correction = newton_measure(newton, newton->scale);
    return tvi_all_finite(size, r);
}

/* Passes of the corrector run until they may end, and at most this often; otherwise the number of passes is 0. */
enum { STEP_QUICK_PASSES = 8 };
static inline int step_passes(step_quick *a, const tvi_origin *origin, double *size)
{
    tvi_newton *newton = &a->work->newton;
    tvi_newton_passes passes;
    tvi_newton_begin(&passes, newton->history, &newton->rules, newton->is_rough);
    matrices_begin(matrices_of(&a->work->closure));
    for (int count = 1; count <= STEP_QUICK_PASSES; count++) {
        tvi_newton_size correction;
        if (!step_pass(a, origin, count == 1, &correction)) break;
        const tvi_passes_verdict verdict = tvi_newton_judge(&passes, &newton->rules, correction);
        if (verdict == TVI_PASSES_STUCK) break;
        if (verdict == TVI_PASSES_MAY_END) {
            tvi_newton_learn(newton->history, &passes);
            *size = correction.relative;
            return count;
        }
        for (int i = 0; i < newton->size; i++) newton->x[i] += newton->correction[i];
    }
    return 0;
}

/* Finds the velocity of a Lagrangian that belongs to the momentum, by Newton's method from the velocity at the end of
 * the step before, as nearly as predictors need it. Returns false if that velocity was far away. */
static inline bool step_find_velocity(tvi_curve_work *w, const double p[], double v[])
{
    enum { MOST = 4 };
    static const double near = 1e-8;
    tvi_curve *curve = &w->closure.curve;
    const int n = curve_n(curve);
    double largest = INFINITY, size = 0;
    for (int i = 0; i < n; i++) v[i] = w->velocity[i];
    for (int count = 0; count < MOST && !(largest <= near * size); count++) {
        if (orders_expand(curve, 0) != TVI_OK) return false;
        for (int i = 0; i < n; i++) curve->rest[i] = p[i] - tvi_curve_field(curve, 0, n + i);
        orders_divide(curve, 1, curve->rest, w->shift);
        largest = size = 0;
        for (int i = 0; i < n; i++) {
            v[i] += w->shift[i];
            largest = tvi_larger(fabs(w->shift[i]), largest);
            size = tvi_larger(fabs(v[i]), size);
        }
    }
    return largest <= near * size;
}

/* Sets the centre data of the curve to the start of the step. */
static inline bool step_place_start(tvi_curve_work *w, const tvi_origin *origin)
{
    tvi_curve *curve = &w->closure.curve;
    const int n = curve_n(curve);
    double *z = w->newton.x;
    curve->centre = origin->t + origin->t_low;
    for (int i = 0; i < n; i++) {
        z[i] = origin->q[i];
        z[n + i] = curve->kappa[i] * origin->p[i];
    }
    curve_place(curve, z);
    curve_place_time(curve);
    if (curve_form(curve) != TVI_LAGRANGIAN) return true;
    return step_find_velocity(w, origin->p, tvi_curve_input(curve, 0) + n);
}

/* Makes a step whose passes converge as they mostly do, for the generating functions of tvi_close_mean. Returns false
 * if nothing is made; then curve_stepper.c makes the step. */
static inline bool step_quickly(tvi_curve_work *w, const step_makers *makers, double tau, const tvi_origin *origin,
                                double dq[], double dp[], tvi_stats *stats)
{
    tvi_curve *curve = &w->closure.curve;
    curve_set_step(curve, tau);
    if (!step_place_start(w, origin) || makers->expand(curve) != TVI_OK) return false;
    step_move_to_centre(w, w->newton.x);
    curve->centre = step_centre(w, origin, tau);
    curve_place_time(curve);
    step_quick at_hand = {w, makers, 0};
    const int passes = step_passes(&at_hand, origin, &stats->residual);
    if (passes == 0) return false;
    for (int i = 0; i < 2 * curve_n(curve); i++) curve->dz[i] = w->newton.correction[i];
    stats->tail = step_finish(w, dq, dp);
    stats->passes += passes;
    stats->expansions += 1 + passes;
    stats->factorisations += at_hand.factorisations;
    stats->force_evaluations += passes * w->options->quadrature_points;
    return true;
}

#endif
