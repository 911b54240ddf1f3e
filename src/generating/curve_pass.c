/* curve_pass.c - makes a pass of several members (curve_pass.h). The formulas are those of curve.c, action.c and
 * closure.c. */
#include "generating/curve_pass.h"

#include <math.h>
#include <string.h>

typedef tvi_curve_batch_work batch;

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

static tvi_curve_sums sums_of(const batch *w, const tvi_combination *combination)
{
    return (tvi_curve_sums){combination->of_momentum, {combination->weight, 1, w->curve.top + 1, 0, 1}};
}

/* Computes out [n][width], the sum over orders that stand `stride` apart. */
static void sum_orders(const batch *w, const tvi_combination *combination, const double *x, size_t stride, double *out)
{
    const int width = w->curve.width * w->curve.n;
    const tvi_curve_sums s = sums_of(w, combination);
    w->loops->combine(&s.weights, stride, width, x + (s.of_momentum ? width : 0), 0, out);
}

static void sum_curve(const batch *w, const tvi_combination *combination, double *out)
{
    sum_orders(w, combination, w->curve.x, w->curve.stride, out);
}

/* Returns the stride of the orders in a change of the coefficients, [top + 1][inputs][width]. */
static size_t stride_of_change(const batch *w) { return (size_t)w->system->inputs * (size_t)w->curve.width; }

static void sum_change(const batch *w, const tvi_combination *combination, const double *change, double *out)
{
    sum_orders(w, combination, change, stride_of_change(w), out);
}

/* Sums component i at the nodes. */
static void sum_at_nodes(const batch *w, int which, int i, double *out)
{
    const tvi_curve_sums *s = &w->node_sums[which];
    const int width = w->curve.width, row = i + (s->of_momentum ? w->curve.n : 0);
    w->loops->combine(&s->weights, w->curve.stride, width, w->curve.x + row * width, (size_t)width, out);
}

/* ---- The curves -------------------------------------------------------------------------------------------------- */

/* Leaves out the members that are outside of the domain of a tape: they make their step by themselves. */
static void leave_outside(batch *w, const jet_tape *tape, const double *x, int points)
{
    for (int m = 0; m < w->curve.width; m++)
        if (w->is_moving[m] && !tvi_single_is_inside(&w->by_itself, tape, x, points, m)) tvi_curve_leave(w, m);
}

/* Expands the curves from z, about t + (t_low + later). */
static void expand(batch *w, const tvi_batch_origin *origin, double later)
{
    const tvi_taylor_lanes *curve = &w->curve;
    const jet_tape *tape = w->system->field_series;
    const size_t numbers = (size_t)curve->n * (size_t)curve->width;
    const double *z = w->members.z;
    double *time = curve->x + w->system->inputs * curve->width;
    memcpy(curve->x, z, numbers * sizeof *z);
    memcpy(curve->has_masses ? curve->x + curve->stride : curve->x + numbers, z + numbers, numbers * sizeof *z);
    for (int m = 0; w->system->uses_time && m < curve->width; m++) {
        time[m] = origin->t[m] + (origin->t_low[m] + later);
        time[curve->stride + (size_t)m] = curve->tau;
    }
    if (!tvi_taylor_expand(w->series, curve, tape)) leave_outside(w, tape, curve->x, 1);
}

/* Sets the direction dz of the tangents to a unit vector. */
static void aim(const batch *w, int direction)
{
    const tvi_taylor_lanes *d = &w->tangent;
    const size_t width = (size_t)d->width, bytes = (size_t)w->system->inputs * width * sizeof *d->x;
    const bool is_second = d->has_masses && direction >= d->n;
    double *one = d->x + (is_second ? d->stride + (size_t)(direction - d->n) * width : (size_t)direction * width);
    memset(d->x, 0, bytes);
    if (d->has_masses) memset(d->x + d->stride, 0, bytes);
    for (size_t m = 0; m < width; m++) one[m] = 1;
}

static void differentiate(batch *w)
{
    const jet_tape *tape = w->system->field_series;
    const tvi_taylor_lanes *d = &w->tangent;
    const size_t stride = stride_of_change(w);
    double *J = w->J;
    for (int direction = 0; direction < 2 * d->n; direction++) {
        aim(w, direction);
        for (int k = 0; k + (d->has_masses ? 2 : 1) <= d->top; k++) {
            tape->sweeps->tangents_in_lanes(tape, w->curve.x, d->x, k, d->width);
            w->series->advance(d, k);
        }
        for (int k = 0; k <= d->top; k++, J += stride) memcpy(J, d->x + (size_t)k * d->stride, stride * sizeof *J);
    }
}

/* Joins the transposed Jacobians of two combinations, [2n][2n][width], one beside the other. */
static void join_jacobians(const batch *w, const tvi_combination *first, const tvi_combination *second, double *out)
{
    const size_t half = (size_t)w->curve.n * (size_t)w->curve.width;
    const size_t of_direction = ((size_t)w->curve.top + 1) * stride_of_change(w);
    for (int d = 0; d < 2 * w->curve.n; d++, out += 2 * half) {
        sum_change(w, first, w->J + (size_t)d * of_direction, out);
        sum_change(w, second, w->J + (size_t)d * of_direction, out + half);
    }
}

/* ---- A pass ------------------------------------------------------------------------------------------------------ */

static void run_field(batch *w, const tvi_batch_origin *origin, double later)
{
    const jet_tape *tape = w->system->field_values;
    const tvi_action *action = &w->action;
    const int n = w->curve.n, width = w->curve.width, lanes = action->points * width;
    double *t = w->x + w->system->inputs * lanes;
    for (int i = 0; i < n; i++) sum_at_nodes(w, TVI_SUM_Q, i, w->x + i * lanes);
    for (int i = 0; i < n && !w->curve.has_masses; i++) sum_at_nodes(w, TVI_SUM_U, i, w->x + (n + i) * lanes);
    for (int node = 0; w->system->uses_time && node < action->points; node++)
        for (int m = 0; m < width; m++)
            *t++ = origin->t[m] + (origin->t_low[m] + later) + w->curve.tau * action->s[node];
    if (!tape->sweeps->values(tape, w->x, lanes)) leave_outside(w, tape, w->x, action->points);
}

/* Computes the defects of component i: on q, tau (F or -H_q) - dp/ds; on p / kappa, dq/ds - u of a separable system,
 * otherwise dq/ds - tau H_p. */
static void find_defects(const batch *w, int i)
{
    const bool is_separable = w->curve.has_masses;
    const int n = w->curve.n, lanes = w->action.points * w->curve.width;
    const int *output = w->system->field_values->output;
    const double tau = w->curve.tau, inverse = 1 / w->curve.kappa[i];
    sum_at_nodes(w, TVI_SUM_U_SLOPE, i, w->at_nodes[TVI_SUM_U_SLOPE]);
    w->loops->subtract(lanes, is_separable ? tau : -tau, w->x + output[i] * lanes, inverse,
                       w->at_nodes[TVI_SUM_U_SLOPE], w->defect);
    if (!w->action.has_momentum_defect) return;
    const double *rate = is_separable ? w->at_nodes[TVI_SUM_U] : w->x + output[n + i] * lanes;
    sum_at_nodes(w, TVI_SUM_Q_SLOPE, i, w->at_nodes[TVI_SUM_Q_SLOPE]);
    if (is_separable) sum_at_nodes(w, TVI_SUM_U, i, w->at_nodes[TVI_SUM_U]);
    w->loops->subtract(lanes, inverse, w->at_nodes[TVI_SUM_Q_SLOPE], is_separable ? inverse : tau * inverse, rate,
                       w->defect + lanes);
}

static void find_seeds(const batch *w)
{
    const int n = w->curve.n, width = w->curve.width, lanes = w->action.points * width;
    const size_t stride = stride_of_change(w), row = (size_t)width;
    for (int i = 0; i < n; i++) {
        find_defects(w, i);
        w->loops->combine(&w->seeds_q, row, width, w->defect, stride, w->seed + i * width);
        if (w->curve.has_masses) continue;
        w->loops->combine(&w->seeds_p, row, width, w->defect + lanes, stride, w->seed + (n + i) * width);
    }
}

/* Computes the corrections of the ends. */
static void close(const batch *w)
{
    const tvi_closure *c = &w->single->closure;
    const tvi_curve_members *members = &w->members;
    const int size = 2 * members->n, rows = (w->curve.top + 1) * w->system->inputs;
    join_jacobians(w, &c->q_mean, w->closing->has_momenta ? &c->u_mean : &c->q_rise, w->full);
    w->loops->pull(rows, size, members->width, w->seed, w->J, members->D);
    w->loops->factor(size, members->width, w->full, members->least);
    w->loops->solve(size, members->width, w->full, members->D);
    w->loops->close(members, w->closing);
}

static void find_scale(const batch *w)
{
    const tvi_curve_members *members = &w->members;
    const int width = members->n * members->width;
    const tvi_weights q = {w->q_sizes, 1, w->curve.top + 1, 0, 1}, z = {w->z_sizes, 1, w->curve.top + 1, 0, 1};
    w->loops->combine_sizes(&q, w->curve.stride, width, w->curve.x, 0, members->scale);
    w->loops->combine_sizes(&z, w->curve.stride, width, w->curve.x + (w->curve.has_masses ? 0 : width), 0,
                            members->scale + width);
    w->loops->fill_scale(members);
}

void tvi_curve_pass(batch *w, const tvi_batch_origin *origin, bool is_first)
{
    const tvi_closure *c = &w->single->closure;
    const tvi_curve_members *members = &w->members;
    const int size = 2 * members->n, half = members->n * members->width;
    const double later = -c->span.from * w->curve.tau;
    for (int m = 0; m < members->width; m++) members->least[m] = INFINITY;
    expand(w, origin, later);
    run_field(w, origin, later);
    find_seeds(w);
    differentiate(w);
    close(w);
    sum_curve(w, &w->single->q_back, members->correction);
    sum_curve(w, &c->u_from, members->correction + half);
    w->loops->residual(members, w->curve.x, origin);
    if (is_first) find_scale(w);
    join_jacobians(w, &c->q_from, &c->u_from, w->back);
    w->loops->factor(size, members->width, w->back, members->least);
    w->loops->solve_transposed(size, members->width, w->back, members->correction);
    w->loops->measure(members);
}

/* ---- The ends of a step ------------------------------------------------------------------------------------------ */

void tvi_curve_predict_members(batch *w, const tvi_batch_origin *origin)
{
    const int half = w->members.n * w->members.width;
    expand(w, origin, 0);
    sum_curve(w, &w->single->q_centre, w->members.z);
    sum_curve(w, &w->single->z_centre, w->members.z + half);
}

void tvi_curve_finish_members(batch *w)
{
    const tvi_closure *c = &w->single->closure;
    const tvi_curve_members *members = &w->members;
    const int half = members->n * members->width, rows = (w->curve.top + 1) * w->system->inputs;
    w->loops->push(rows, 2 * members->n, members->width, w->J, members->correction, w->seed);
    sum_curve(w, &c->q_rise, w->values);
    sum_curve(w, &c->u_rise, w->values + half);
    sum_change(w, &c->q_rise, w->seed, w->change);
    sum_change(w, &c->u_rise, w->seed, w->change + half);
    w->loops->end(members, w->values, w->change, w->dq, w->dp);
    if (c->p_degree > 1) {
        const int q_degree = w->single->q_degree;
        w->series->measure(&w->curve, q_degree, c->p_degree, &w->sizes);
        w->series->tail(&w->curve, q_degree, c->p_degree, &w->sizes, w->share, w->ratio, w->tail);
    }
}
