/* curve_step.h - makes the parts of a step of a method that expands one Taylor curve, and whole steps whose passes
 * converge as usual. curve_stepper.c and quick.h call it. Generated code includes this text (emit.c) with every size
 * as a constant. */
#ifndef TVI_SRC_GENERATING_CURVE_STEP_H
#define TVI_SRC_GENERATING_CURVE_STEP_H

#include "algebra/linear_small.h"
#include "generating/curve_stepper.h"
#include "generating/orders.h"
#include "generating/matrices.h"

/* Returns by how much the centre of the step is later than its start. */
static inline double step_time_to_centre(const tvi_curve_workspace *w, double tau)
{
    return -w->closure.span.from * tau;
}

/* Moves z to the centre, along the curve that starts at the start of the step. */
static inline void step_move_to_centre(const tvi_curve_workspace *w, double z[])
{
    const tvi_closure *c = &w->closure;
    CURVE_CALL(sum_combination, &c->curve, &w->q_centre, z);
    CURVE_CALL(sum_combination, &c->curve, &w->z_centre, z + curve_numbers(&c->curve));
}

/* Computes the natural sizes of the unknowns. If a body starts at rest, a curve of degree 0 or 1 knows only the
 * corrections, which are momenta: they are in the unit of the unknown, except for a Lagrangian. */
static inline void step_compute_unknown_sizes(const tvi_closure *c, double scale[])
{
    const tvi_curve *curve = &c->curve;
    const int numbers = curve_numbers(curve);
    CURVE_CALL(compute_data_sizes, curve, scale);
    if (curve_highest_order(curve) > 1 || curve_form(&c->curve) == TVI_LAGRANGIAN) return;
    for (int i = 0; i < numbers; i++) {
        const double kappa = fabs(c->curve.kappa[i / curve_width(curve)]);
        scale[i] += fabs(c->from_q[i]) + fabs(c->rise_q[i]);
        scale[numbers + i] += kappa * (fabs(c->from_p[i]) + fabs(c->rise_p[i]));
    }
}

/* Computes r = (q- + from_q - q0, kappa (p- + from_p - p0)), the small differences first. */
static inline void step_compute_residual(const tvi_curve_workspace *w, const tvi_batch_origin *origin,
                                         double *restrict r)
{
    const tvi_closure *c = &w->closure;
    const int numbers = curve_numbers(&c->curve), width = curve_width(&c->curve);
    const double *Q0 = tvi_curve_position_coefficients(&c->curve, 0);
    CURVE_CALL(sum_combination, &c->curve, &w->q_back, r);
    CURVE_CALL(sum_combination, &c->curve, &c->u_from, r + numbers);
    for (int i = 0; i < curve_dimension(&c->curve); i++) {
        const double kappa = c->curve.kappa[i];
        for (int at = i * width; at < (i + 1) * width; at++) {
            r[at] += (Q0[at] - origin->q[at]) + (c->from_q[at] - origin->q_low[at]);
            r[numbers + at] = (r[numbers + at] - kappa * origin->p[at]) + kappa * (c->from_p[at] - origin->p_low[at]);
        }
    }
}

/* Returns whether there are corrections; generated code has no steps without them. */
static inline bool step_has_corrections(const tvi_curve_workspace *w)
{
    (void)w;
    return CURVE_SIZE(true, w->corrects);
}

/* Computes out, the sum of the combination at z + dz, to first order in dz. */
static inline void step_sum_with_correction(const tvi_curve_workspace *w, const tvi_combination *combination,
                                            double out[])
{
    CURVE_CALL(sum_combination, &w->closure.curve, combination, out);
    if (!step_has_corrections(w)) return;
    CURVE_CALL(multiply_by_jacobian, &w->closure.curve, combination, w->shift);
    for (int i = 0; i < curve_numbers(&w->closure.curve); i++) out[i] += w->shift[i];
}

/* Computes dq = (q+ - q-) + rise_q and dp = (p+ - p-) + rise_p, or a part of the way. */
static inline void step_compute_increments(const tvi_curve_workspace *w, const tvi_combination *q_rise,
                                           const tvi_combination *u_rise, double part, double dq[], double dp[])
{
    const tvi_closure *c = &w->closure;
    const int width = curve_width(&c->curve);
    step_sum_with_correction(w, q_rise, dq);
    step_sum_with_correction(w, u_rise, dp);
    for (int i = 0; i < curve_numbers(&c->curve); i++) {
        dp[i] /= c->curve.kappa[i / width];
        if (!step_has_corrections(w)) continue;
        dq[i] += part * c->rise_q[i];
        dp[i] += part * c->rise_p[i];
    }
}

/* Stores the velocity at the end of a Lagrangian's curve: the search for the next step's velocity starts there. */
static inline void step_store_end_velocity(const tvi_curve_workspace *w)
{
    const tvi_curve *curve = &w->closure.curve;
    if (curve_form(curve) != TVI_LAGRANGIAN) return;
    CURVE_CALL(sum_combination, curve, &w->v_end, w->velocity);
    for (int i = 0; i < curve_dimension(curve); i++) w->velocity[i] /= curve->tau;
}

static inline void step_compute_tails(const tvi_curve *curve, double tail[])
{
    const int width = curve_width(curve);
    if (width == 1) tail[0] = CURVE_CALL(compute_tail, curve, 0);
    else curve_tails(curve, tail);
}

/* Computes the increments that the step returns from the curve, and the tails of the members. */
static inline void step_compute_results(const tvi_curve_workspace *w, double dq[], double dp[], double tail[])
{
    const tvi_curve *curve = &w->closure.curve;
    step_compute_increments(w, &w->closure.q_rise, &w->closure.u_rise, 1, dq, dp);
    step_store_end_velocity(w);
    CURVE_CALL(compute_size_sums, curve);
    step_compute_tails(curve, tail);
}

/* ---- A whole step ------------------------------------------------------------------------------------------------ */

/* The caller gives these functions of a curve: the series without Jacobians and with them, and the seeds, finite or
 * not. */
typedef struct {
    tvi_status (*expand)(tvi_curve *curve), (*expand_all)(tvi_curve *curve);
    tvi_status (*seed)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[]);
    /* Several members: leaves out those for which a tape has no values, in the block of the series or of the nodes. */
    void (*leave_outside)(const tvi_curve_workspace *work, bool at_nodes, long long is_moving[]);
} step_curve_functions;

/* A quick step holds the step that is being made, of the members that still move. */
typedef struct {
    tvi_curve_workspace *work;
    const step_curve_functions *makers;
    const tvi_batch_origin *origin;
    long long *is_moving;
    long factorisations;
} step_state;

/* Returns how many members move. */
static inline int step_count_moving_members(const step_state *a)
{
    int count = 0;
    for (int m = 0; m < curve_width(&a->work->closure.curve); m++) count += a->is_moving[m] != 0;
    return count;
}

/* Leaves out the members that a status of all is of. Returns whether some move on. */
static inline bool step_drop_failed_members(const step_state *a, tvi_status status, bool at_nodes)
{
    if (status == TVI_OK) return true;
    if (curve_width(&a->work->closure.curve) == 1) return false;
    a->makers->leave_outside(a->work, at_nodes, a->is_moving);
    return true;
}

/* Finds the members whose Jacobians are to be taken at z. Returns how many there are. */
static inline int step_find_due_jacobians(const step_state *a, const double z[])
{
    tvi_closure *c = &a->work->closure;
    long long is_due[CURVE_MOST_WIDTH];
    int count = 0;
    matrices_find_due_members(c, z, a->work->newton.scale, a->is_moving, is_due);
    for (int m = 0; m < curve_width(&c->curve); m++) {
        count += (is_due[m] & a->is_moving[m]) != 0;
        if (curve_width(&c->curve) > 1) c->curve.is_taken[m] = is_due[m];
    }
    c->curve.keeps = count < curve_width(&c->curve) && matrices_get_factors(c)->jacobian_count > 0;
    return count;
}

/* Factors new Jacobians. In the generating function's equations the second half may be of the coordinates, in another
 * unit than a Hamiltonian's p; in the corrector's it is of momenta, in another unit than a Lagrangian's tau v. Leaves
 * out members whose factors need exchanges of rows. */
static inline void step_factor_jacobians(step_state *a, int due, const double z[])
{
    const tvi_closure *c = &a->work->closure;
    const tvi_form form = curve_form(&c->curve);
    const int n = curve_dimension(&c->curve), size = 2 * n, width = curve_width(&c->curve);
    const bool has_momenta = c->mean->has_momenta;
    tvi_lu_factor *full = &matrices_get_factors(c)->full_factor, *back = &a->work->newton.factor;
    matrices_record_jacobians(c, z);
    matrices_stack_jacobians(c, &c->q_mean, has_momenta ? &c->u_mean : &c->q_rise, full->lu);
    const bool has_back = matrices_renew_corrector_jacobian(c, back->lu);
    linear_unpivoted_factor(size, form != TVI_HAMILTONIAN || has_momenta ? size : n, width, full, a->is_moving);
    if (has_back) linear_unpivoted_factor(size, form != TVI_LAGRANGIAN ? size : n, width, back, a->is_moving);
    a->factorisations += due * (1 + has_back);
}

/* Computes the corrections of a pass. Returns false if no member goes on. */
static inline bool step_run_pass(step_state *a, bool is_first)
{
    tvi_curve_workspace *w = a->work;
    tvi_closure *c = &w->closure;
    tvi_newton *newton = &w->newton;
    const int size = 2 * curve_dimension(&c->curve), width = curve_width(&c->curve);
    double *x = newton->x, *r = newton->correction;
    const int due = step_find_due_jacobians(a, x);
    curve_set_centre_data(&c->curve, x);
    if (!step_drop_failed_members(a, (due > 0 ? a->makers->expand_all : a->makers->expand)(&c->curve), false))
        return false;
    if (!step_drop_failed_members(a, a->makers->seed(&w->action, &c->curve, c->seed_Q, c->seed_U), true)) return false;
    if (due > 0) step_factor_jacobians(a, due, x);
    if (step_count_moving_members(a) == 0) return false;
    CURVE_CALL(multiply_by_transposes, &c->curve, c->seed_Q, c->seed_U, c->D);
    linear_unpivoted_solve_transposed(size, width, &matrices_get_factors(c)->full_factor, c->D);
    closure_correct_ends(c);
    step_compute_residual(w, a->origin, r);
    if (is_first) {
        step_compute_unknown_sizes(c, newton->scale);
        for (int m = 0; m < width; m++) newton_fill_missing_scales(newton, m);
    }
    for (int i = 0; i < size * width; i++) r[i] = -r[i];
    linear_unpivoted_solve(size, width, &newton->factor, r);
    return true;
}

/* Judges the correction of member m, which stops moving if it is the last one, or if the quick step does not make this
 * step, for example if a number is not finite. */
static inline void step_judge_member(const step_state *a, tvi_newton_passes *passes, const tvi_correction_sizes *sizes,
                                     int m, const tvi_quick_step_results *end)
{
    const tvi_newton *newton = &a->work->newton;
    const tvi_correction_size size = {sizes->relative[m], sizes->of_group[m]};
    tvi_passes_verdict verdict = TVI_PASSES_STUCK;
    if (isfinite(size.relative)) verdict = tvi_newton_judge_pass(passes, &newton->rules, size);
    if (verdict != TVI_PASSES_GO_ON) a->is_moving[m] = 0;
    if (verdict != TVI_PASSES_MAY_END) return;
    tvi_newton_store_slack(&newton->history[m], passes);
    end->residual[m] = size.relative;
    end->passes[m] = passes->of_each.count;
}

/* Adds the corrections of the members that move. */
static inline void step_apply_corrections(const step_state *a)
{
    const tvi_newton *newton = &a->work->newton;
    const int width = curve_width(&a->work->closure.curve);
    const double *correction = newton->correction;
    double *restrict x = newton->x;
    for (int i = 0; i < newton_count_unknowns(newton); i++, x += width, correction += width)
        for (int m = 0; m < width; m++) x[m] = a->is_moving[m] ? x[m] + correction[m] : x[m];
}

/* Passes of the corrector run until each member's may end. */
static inline void step_run_passes(step_state *a, const tvi_quick_step_results *end)
{
    const tvi_newton *newton = &a->work->newton;
    const int width = curve_width(&a->work->closure.curve);
    tvi_newton_passes passes[CURVE_MOST_WIDTH];
    for (int m = 0; m < width; m++)
        tvi_newton_begin_passes(&passes[m], &newton->history[m], &newton->rules, newton->is_rough);
    matrices_discard_factors(matrices_get_factors(&a->work->closure));
    for (int count = 1; count <= newton->rules.of_each.max_passes; count++) {
        tvi_correction_sizes sizes;
        if (!step_run_pass(a, count == 1)) return;
        newton_measure_corrections(newton, newton->scale, &sizes);
        for (int m = 0; m < width; m++)
            if (a->is_moving[m]) step_judge_member(a, &passes[m], &sizes, m, end);
        if (step_count_moving_members(a) == 0) return;
        step_apply_corrections(a);
    }
}

/* Finds the velocity of a Lagrangian that belongs to the momentum, by Newton's method from the velocity at the end of
 * the step before, as nearly as predictors need it. Returns false if that velocity was far away. */
static inline bool step_find_velocity(tvi_curve_workspace *w, const double p[], double v[])
{
    enum { MOST = 4 };
    static const double near = 1e-8;
    tvi_curve *curve = &w->closure.curve;
    const int n = curve_dimension(curve);
    double largest = INFINITY, size = 0;
    for (int i = 0; i < n; i++) v[i] = w->velocity[i];
    for (int count = 0; count < MOST && !(largest <= near * size); count++) {
        if (orders_compute_order(curve, 0) != TVI_OK) return false;
        for (int i = 0; i < n; i++) curve->velocity_residual[i] = p[i] - tvi_curve_field_output(curve, 0, n + i);
        orders_solve_for_velocity(curve, 1, curve->velocity_residual, w->shift);
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
static inline bool step_set_start_data(tvi_curve_workspace *w, const tvi_batch_origin *origin, double z[])
{
    tvi_curve *curve = &w->closure.curve;
    const int n = curve_dimension(curve), width = curve_width(curve);
    for (int i = 0; i < n; i++)
        for (int at = i * width; at < (i + 1) * width; at++) {
            z[at] = origin->q[at];
            z[n * width + at] = curve->kappa[i] * origin->p[at];
        }
    curve_set_centre_data(curve, z);
    curve_set_centre_time(curve, origin->t, origin->t_low, 0);
    if (curve_form(curve) != TVI_LAGRANGIAN) return true;
    return step_find_velocity(w, origin->p, tvi_curve_inputs_of_order(curve, 0) + n);
}

/* Makes the steps of the members whose passes converge as usual, for the generating functions that
 * tvi_close_by_mean_of_ends closes. Returns whether any member's step was made; curve_stepper.c makes the others. */
static inline bool step_by_quick_passes(tvi_curve_workspace *w, const step_curve_functions *makers, double tau,
                                        const tvi_batch_origin *origin, const tvi_quick_step_results *end,
                                        tvi_stats *stats)
{
    tvi_curve *curve = &w->closure.curve;
    step_state a = {w, makers, origin, end->is_moving, 0};
    int made = 0, passes = 0;
    curve_set_time_unit(curve, tau);
    for (int m = 0; m < curve_width(curve); m++) end->passes[m] = TVI_NOT_MADE;
    if (!step_set_start_data(w, origin, w->newton.x) || !step_drop_failed_members(&a, makers->expand(curve), false))
        return false;
    step_move_to_centre(w, w->newton.x);
    curve_set_centre_time(curve, origin->t, origin->t_low, step_time_to_centre(w, tau));
    step_run_passes(&a, end);
    for (int m = 0; m < curve_width(curve); m++) {
        if (end->passes[m] == TVI_NOT_MADE) continue;
        made++;
        passes += end->passes[m];
    }
    if (made == 0) return false;
    for (int i = 0; i < 2 * curve_numbers(curve); i++) curve->product_direction[i] = w->newton.correction[i];
    step_compute_results(w, end->dq, end->dp, end->tail);
    stats->passes += passes;
    stats->expansions += made + passes;
    stats->factorisations += a.factorisations;
    stats->force_evaluations += passes * w->options->quadrature_points;
    return true;
}

#endif
