/* seeds.h - the discrete action at its nodes, and the seeds of its gradient: part of the text of generated code
 * (emit.c), where every size is a constant.
 *
 * With p the curve's momentum series, w_i the weights in scaled time, and a dot for d/ds,
 *   Lagrange   D_z = sum_i w_i [ dq_i^T tau L_q - dg_i^T p. + dg.^T (L_v - p) ]
 *   Hamilton   D_z = sum_i w_i [ dp_i^T (g. - tau H_p) - dg_i^T (p. + tau H_q) ]                             on-curve
 *              D_z = sum_i w_i [ dq_i^T tau (H_qp p - H_q) + dp_i^T tau H_pp p - dg_i^T p. - dg.^T p ]      truncated,
 * q'_i = H_p and in both, with e_r the error of the quadrature for s^r,
 *            + sum_{j,k} (j+k) e_{j+k-1} (dQ_k/dz)^T P_j,
 * what summation by parts of (p^T dg). leaves when the quadrature is not exact to its degree: with it every quadrature
 * serves every degree. For a separable system L_v - p = 0, and g. - tau H_p = 0 where p has degree q_degree - 1. */
#ifndef TVI_SRC_GENERATING_SEEDS_H
#define TVI_SRC_GENERATING_SEEDS_H

#include "algebra/sizes.h"
#include "generating/series.h"
#include "method/origin.h"
#include "system/roundoff.h"
#include "vector.h"

#ifndef JET_EMITTED
#define SEEDS_VALUES(tape, x, lanes) jet_sweep_values(tape, x, lanes)
#endif

/* What the orders are at the nodes, [top + 1][points]. Where nodes mirror each other, the even and the odd orders at
 * the first half of them, [orders / 2][half]: at the other half these are the same but for a sign. Sums over the nodes
 * have their tables the other way round, [points][top + 1] and [half][seeds_width(orders / 2)]. */
typedef struct {
    double *full, *even, *odd;
    double mirrored; /* what even orders are multiplied by, 1 or -1 */
} tvi_node_table;

typedef struct tvi_action {
    bool is_hamilton; /* TVI_ACTION_HAMILTON */
    bool truncated;
    const jet_sweeps *sweeps;
    bool has_velocity_defect;               /* L_v - p is not 0 by construction */
    bool has_momentum_defect;               /* g. - tau H_p is not 0 by construction */
    int q_degree, p_degree, points, orders; /* orders: top + 1 */
    double *s, *weight;                     /* [points] in scaled time, sum of the weights = to - from */
    /* Nodes mirror each other: points first .. half - 1, and the others from there on. One at the centre is there
     * twice, with half its weight each; what is left of a half is the first node without weight. 0: they do not, or the
     * action is not plain. */
    int half;
    tvi_node_table power, slope; /* s_i^k and its derivative, 0 above q_degree */
    tvi_node_table second_slope; /* the second one, of all orders */
    tvi_node_table node_power; /* the same as `power` as far as q_i uses it: 0 where the node rule leaves a term out */
    tvi_node_table weighted_power, weighted_slope; /* times the weight, for sums over the nodes */
    double *row;                                   /* [top + 1] */
    double *by_parts; /* [q_degree + 1][p_degree + 1]: (j+k) (error of the quadrature for s^(j+k-1)); NULL: all 0 */
    double *x;        /* block of the field's values at the nodes, a lane each */
    double *bend;     /* truncated Hamiltonian: block of the bend's values */
    double *P;        /* [p_degree + 1][n] */
    double *momentum, *force;   /* [n][points]: p and p' (in s) of the curve at the nodes */
    double *on_q, *on_v, *on_p; /* [n][points]: what multiplies dq_i, dv_i (tau), dp_i in the gradient of the action */
    double *correction;         /* [n] */
    tvi_roundoff roundoff;      /* of the field at the nodes */
} tvi_action;

/* ---- The curve at the nodes -------------------------------------------------------------------------------------- */

/* Whole vectors. */
enum { SEEDS_MOST_HALF = (TVI_MAX_DEGREE + 2) / 2 + 4 };
static inline int seeds_width(int count) { return (count + 3) / 4 * 4; }

/* row[node] = sum_{k <= degree} coefficient_k table_k(node), coefficient_k at first + k * stride. */
static inline void seeds_at_nodes(const tvi_action *action, int degree, const double *first, size_t stride,
                                  const tvi_node_table *table, double row[])
{
    const int half = action->half;
    double even[SEEDS_MOST_HALF], odd[SEEDS_MOST_HALF];
    if (half == 0) {
        CURVE_COMBINE(action, degree + 1, first, stride, action->points, table->full, row);
        return;
    }
    CURVE_COMBINE(action, degree / 2 + 1, first, 2 * stride, half, table->even, even);
    CURVE_COMBINE(action, (degree + 1) / 2, first + stride, 2 * stride, half, table->odd, odd);
    JET_IN_VECTORS
    for (int i = 0; i < half; i++) row[i] = even[i] + odd[i];
    JET_IN_VECTORS
    for (int i = 0; i < half; i++) row[half + i] = table->mirrored * (even[i] - odd[i]);
}

static inline void seeds_place_times(const tvi_action *action, const tvi_curve *curve, double *x)
{
    double *t = x + curve_inputs(curve) * action->points;
    if (!curve_uses_time(curve)) return;
    for (int node = 0; node < action->points; node++) t[node] = curve->centre + curve->tau * action->s[node];
}

/* q at the nodes into the inputs of a block; the time too. */
static inline void seeds_place_positions(const tvi_action *action, const tvi_curve *curve, double *x)
{
    const tvi_system *system = curve->system;
    const size_t stride = (size_t)system->field_series->slots;
    for (int i = 0; i < curve_n(curve); i++)
        seeds_at_nodes(action, action->q_degree, tvi_curve_Q(curve, 0) + i, stride, &action->node_power,
                       x + i * action->points);
    seeds_place_times(action, curve, x);
}

/* v = g./tau at the nodes into the second input. */
static inline void seeds_place_velocities(const tvi_action *action, const tvi_curve *curve, double *v)
{
    const int points = action->points;
    const size_t stride = tvi_curve_slots(curve);
    for (int i = 0; i < curve_n(curve); i++) {
        seeds_at_nodes(action, action->q_degree, tvi_curve_Q(curve, 0) + i, stride, &action->slope, v + i * points);
        for (int node = 0; node < points; node++) v[i * points + node] /= curve->tau;
    }
}

/* The momentum of the curve, where it is needed. */
static inline void seeds_momenta_at_nodes(tvi_action *action, const tvi_curve *curve)
{
    const int n = curve_n(curve), points = action->points, degree = action->p_degree;
    const bool has_momenta = action->is_hamilton || action->has_velocity_defect;
    if (!has_momenta && !action->by_parts && curve_form(curve) == TVI_SEPARABLE) return;
    curve_momenta(curve, degree, action->P);
    for (int i = 0; i < n && has_momenta; i++)
        seeds_at_nodes(action, degree, action->P + i, (size_t)n, &action->power, action->momentum + i * points);
}

/* row /= divisor, by its inverse and what that leaves: many quotients take long. */
static inline void seeds_divide(int points, double divisor, double row[])
{
    const double inverse = 1 / divisor;
    JET_IN_VECTORS
    for (int node = 0; node < points; node++) {
        const double quotient = row[node] * inverse;
        row[node] = quotient + inverse * (row[node] - quotient * divisor);
    }
}

/* Its derivative, which is M q'' / tau of a separable system. */
static inline void seeds_forces_at_nodes(tvi_action *action, const tvi_curve *curve)
{
    const int n = curve_n(curve), points = action->points, degree = action->p_degree;
    const size_t stride = tvi_curve_slots(curve);
    double *force = action->force;
    for (int i = 0; i < n; i++, force += points)
        if (curve_form(curve) == TVI_SEPARABLE) {
            seeds_at_nodes(action, degree + 1, tvi_curve_Q(curve, 0) + i, stride, &action->second_slope, force);
            seeds_divide(points, curve->kappa[i], force);
        } else {
            seeds_at_nodes(action, degree, action->P + i, (size_t)n, &action->slope, force);
        }
}

static inline const double *seeds_output_row(const tvi_action *action, const jet_tape *tape, const double *x, int i)
{
    (void)tape;
    return x + (size_t)CURVE_SIZE(CURVE_VALUES_SLOT, tape->output)[i] * (size_t)action->points;
}

/* ---- What multiplies dq_i, dv_i and dp_i ------------------------------------------------------------------------- */

static inline tvi_status seeds_run_field(const tvi_action *action, const tvi_curve *curve)
{
    return SEEDS_VALUES(curve->system->field_values, action->x, action->points) ? TVI_OK : TVI_EDOMAIN;
}

/* panel = factor * outputs first .. first + n - 1 of the field. */
static inline void seeds_copy_outputs(const tvi_action *action, const tvi_curve *curve, int first, double factor,
                                      double *restrict panel)
{
    for (int i = 0; i < curve_n(curve); i++) {
        const double *row = seeds_output_row(action, curve->system->field_values, action->x, first + i);
        JET_IN_VECTORS
        for (int node = 0; node < action->points; node++) panel[i * action->points + node] = factor * row[node];
    }
}

/* panel -= other. */
static inline void seeds_subtract(const tvi_action *action, int n, const double *other, double *restrict panel)
{
    for (int i = 0; i < n * action->points; i++) panel[i] -= other[i];
}

/* Separable: on_q = tau F; L_v = p on the curve. */
static inline tvi_status seeds_force_terms(tvi_action *action, const tvi_curve *curve)
{
    const tvi_status status = seeds_run_field(action, curve);
    seeds_copy_outputs(action, curve, 0, curve->tau, action->on_q);
    return status;
}

/* On-curve: on_q = -tau H_q, on_p = g. - tau H_p. */
static inline tvi_status seeds_hamilton_terms(tvi_action *action, const tvi_curve *curve)
{
    const int n = curve_n(curve), points = action->points;
    const bool separable = curve_form(curve) == TVI_SEPARABLE;
    if (!separable) memcpy(action->x + n * points, action->momentum, (size_t)(n * points) * sizeof(double));
    const tvi_status status = seeds_run_field(action, curve);
    if (status != TVI_OK) return status;
    seeds_copy_outputs(action, curve, 0, separable ? curve->tau : -curve->tau, action->on_q);
    if (!action->has_momentum_defect) return TVI_OK;
    seeds_place_velocities(action, curve, action->on_p);
    for (int i = 0; i < n; i++) {
        const double *H_p = separable ? NULL : seeds_output_row(action, curve->system->field_values, action->x, n + i);
        for (int node = 0; node < points; node++) {
            const int place = i * points + node;
            const double rate = separable ? action->momentum[place] / curve->system->mass[i] : H_p[node];
            action->on_p[place] = curve->tau * (action->on_p[place] - rate);
        }
    }
    return status;
}

/* ---- The seeds --------------------------------------------------------------------------------------------------- */

/* row[k] = sum over the nodes of weight * power (or slope) * x[node], for all orders k. */
static inline const double *seeds_over_nodes(const tvi_action *action, const tvi_node_table *weighted, const double *x)
{
    const int half = action->half, orders = action->orders, width = seeds_width((orders + 1) / 2);
    double sum[SEEDS_MOST_HALF], difference[SEEDS_MOST_HALF], even[SEEDS_MOST_HALF], odd[SEEDS_MOST_HALF];
    if (half == 0) {
        CURVE_COMBINE(action, action->points, x, 1, orders, weighted->full, action->row);
        return action->row;
    }
    JET_IN_VECTORS
    for (int i = 0; i < half; i++) {
        sum[i] = x[i] + x[half + i];
        difference[i] = x[i] - x[half + i];
    }
    const bool keeps = weighted->mirrored > 0;
    CURVE_COMBINE(action, half, keeps ? sum : difference, 1, width, weighted->even, even);
    CURVE_COMBINE(action, half, keeps ? difference : sum, 1, width, weighted->odd, odd);
    for (int k = 0; k < orders; k++) action->row[k] = k % 2 == 0 ? even[k / 2] : odd[k / 2];
    return action->row;
}

/* dq_i^T on_q - dg_i^T p. as one defect, less what a truncated node leaves out of dq_i. */
static inline void seeds_positions(tvi_action *action, int n, double seed[])
{
    const int points = action->points, N = action->q_degree;
    seeds_subtract(action, n, action->force, action->on_q); /* the defect */
    for (int i = 0; i < n; i++) {
        const double *defect = action->on_q + i * points, *force = action->force + i * points;
        const double *row = seeds_over_nodes(action, &action->weighted_power, defect);
        for (int k = 0; k <= N; k++) seed[k * n + i] = row[k];
        if (!action->truncated) continue;
        for (int node = 0; node < points; node++)
            seed[N * n + i] -= action->weight[node] * (defect[node] + force[node]) *
                               (action->power.full[N * points + node] - action->node_power.full[N * points + node]);
    }
}

static inline void seeds_velocities(const tvi_action *action, int n, double seed[])
{
    for (int i = 0; i < n; i++) {
        const double *row = seeds_over_nodes(action, &action->weighted_slope, action->on_v + i * action->points);
        for (int k = 1; k <= action->q_degree; k++) seed[k * n + i] += row[k];
    }
}

/* dp^T on_p; for a separable system kappa P_k = (k+1) Q_{k+1}. */
static inline void seeds_momenta(const tvi_action *action, const tvi_curve *curve, double seed_Q[], double seed_U[])
{
    const int n = curve_n(curve);
    for (int i = 0; i < n; i++) {
        const double *row = seeds_over_nodes(action, &action->weighted_power, action->on_p + i * action->points);
        for (int k = 0; k <= action->p_degree; k++) {
            const double seed = row[k] / curve->kappa[i];
            if (curve_form(curve) != TVI_SEPARABLE) seed_U[k * n + i] = seed;
            else if (k < curve_top(curve)) seed_Q[(k + 1) * n + i] += (k + 1) * seed;
        }
    }
}

static inline void seeds_by_parts(const tvi_action *action, const tvi_curve *curve, double seed[])
{
    const int n = curve_n(curve);
    for (int k = 0; k <= action->q_degree; k++)
        for (int j = 0; j <= action->p_degree; j++) {
            const double error = action->by_parts[k * (curve_top(curve) + 1) + j];
            if (error == 0) continue;
            for (int i = 0; i < n; i++) seed[k * n + i] += error * action->P[j * n + i];
        }
}

/* ---- All of them ------------------------------------------------------------------------------------------------- */

/* The curve at the nodes. Seeds that are not set are 0; those of U, which a separable system has not, are never set. */
static inline void seeds_begin(tvi_action *action, const tvi_curve *curve, double seed_Q[], double seed_U[])
{
    for (int i = (action->q_degree + 1) * curve_n(curve); i < (curve_top(curve) + 1) * curve_n(curve); i++)
        seed_Q[i] = 0;
    for (int i = 0; i < (curve_top(curve) + 1) * curve_n(curve) && curve_form(curve) != TVI_SEPARABLE; i++)
        seed_U[i] = 0;
    seeds_momenta_at_nodes(action, curve);
    seeds_forces_at_nodes(action, curve);
    seeds_place_positions(action, curve, action->x);
}

/* From the terms at the nodes. */
static inline void seeds_end(tvi_action *action, const tvi_curve *curve, double seed_Q[], double seed_U[])
{
    const int n = curve_n(curve);
    const bool is_bent = action->is_hamilton && action->truncated;
    seeds_positions(action, n, seed_Q);
    if (is_bent || action->has_velocity_defect) seeds_velocities(action, n, seed_Q);
    if (is_bent || action->has_momentum_defect) seeds_momenta(action, curve, seed_Q, seed_U);
    if (action->by_parts) seeds_by_parts(action, curve, seed_Q);
}

/* Of a field at nodes on the curve that has no velocity defect. */
static inline bool seeds_are_plain(const tvi_action *action)
{
    return !action->has_velocity_defect && !(action->is_hamilton && action->truncated);
}

static inline tvi_status seeds_plainly(tvi_action *action, const tvi_curve *curve, double seed_Q[], double seed_U[])
{
    seeds_begin(action, curve, seed_Q, seed_U);
    const tvi_status status =
        action->is_hamilton ? seeds_hamilton_terms(action, curve) : seeds_force_terms(action, curve);
    if (status == TVI_OK) seeds_end(action, curve, seed_Q, seed_U);
    return status;
}

/* ---- What generated code has ------------------------------------------------------------------------------------- */

/* The functions of curve.h and action.h, for curves and actions of these sizes. */
struct tvi_curve_work;
struct tvi_solver;
typedef struct tvi_curve_code {
    int top;
    /* The whole series from the centre data; NULL: order by order. */
    tvi_status (*expand)(tvi_curve *curve);
    void (*differentiate)(tvi_curve *curve);
    void (*sizes)(const tvi_curve *curve, double size[]);
    void (*sum)(const tvi_curve *curve, const tvi_combination *combination, double out[]);
    void (*measure)(const tvi_curve *curve);
    double (*tail)(const tvi_curve *curve);
    /* Of steps that adapt. */
    double (*reach)(const tvi_curve *curve, double log_tolerance);
    void (*end_at)(tvi_curve *curve, double factor, double q[], double u[]);
    double (*change)(const tvi_curve *curve);
    void (*sum_jacobian)(const tvi_curve *curve, const tvi_combination *combination, double matrix[]);
    void (*aim)(tvi_curve *curve, const double dz[]);
    void (*push)(const tvi_curve *curve, const tvi_combination *combination, double out[]);
    void (*pull)(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[]);
    const struct tvi_solver *solver; /* but for `take`; NULL: the library's own */
    /* Of plain seeds, finite or not; NULL: the library's own. */
    tvi_status (*seed)(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[]);
    /* Of step_quickly (curve_step.h); NULL: there is none. */
    bool (*step)(struct tvi_curve_work *work, double tau, const tvi_origin *origin, double dq[], double dp[],
                 tvi_stats *stats);
} tvi_curve_code;

#endif
