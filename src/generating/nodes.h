/* nodes.h - evaluates the curve and the field at the nodes of the discrete action. It is part of the text of generated
 * code (emit.c), where every size is a constant. */
#ifndef TVI_SRC_GENERATING_NODES_H
#define TVI_SRC_GENERATING_NODES_H

#include "algebra/sizes.h"
#include "generating/series.h"
#include "system/roundoff.h"
#include "vector.h"

/* A table holds the values of the orders at the nodes, [top + 1][points]. If nodes mirror each other, it also holds the
 * even and the odd orders at the first half of the nodes, [orders / 2][half]: at the other half these are the same
 * except for a sign. Sums over the nodes have their tables the other way round, [points][top + 1] and
 * [half][seeds_width(orders / 2)]. */
typedef struct {
    double *full, *even, *odd;
    double mirrored; /* the factor of even orders at the other half, 1 or -1 */
} tvi_node_table;

typedef struct tvi_action {
    bool is_hamilton; /* TVI_ACTION_HAMILTON */
    bool truncated;
    const jet_sweeps *sweeps;
    const jet_tape *field;    /* at the nodes: its values, or all that tangents need where momenta are found by them */
    bool has_velocity_defect; /* L_v - p is not 0 by construction */
    bool has_momentum_defect; /* g. - tau H_p is not 0 by construction */
    int q_degree, p_degree, points, orders; /* orders: top + 1 */
    double *s, *weight;                     /* [points] in scaled time, sum of the weights = to - from */
    /* If nodes mirror each other, the first half are 0 .. half - 1, and the others follow. A node at the centre is
     * there twice, with half its weight each; points that are left of a half repeat the first node without weight. half
     * is 0 if they do not, or if the action is not plain. */
    int half;
    tvi_node_table power, slope;                   /* s_i^k and its derivative, 0 above q_degree */
    tvi_node_table second_slope;                   /* the second derivative, of all orders */
    tvi_node_table node_power;                     /* `power` as q_i uses it: 0 if the node rule leaves the term out */
    tvi_node_table weighted_power, weighted_slope; /* these times the weight, for sums over the nodes */
    double *row;                                   /* [top + 1] */
    double *by_parts; /* [q_degree + 1][p_degree + 1]: (j+k) (error of the quadrature for s^(j+k-1)); NULL: all 0 */
    double *x;        /* block of the field's values at the nodes, a lane each */
    double *bend;     /* truncated Hamiltonian: block of the bend's values */
    double *P;        /* [p_degree + 1][n] */
    double *momentum, *force;   /* [n][points]: p and p' (in s) of the curve at the nodes */
    double *on_q, *on_v, *on_p; /* [n][points]: the factors of dq_i, dv_i (tau), dp_i in the gradient of the action */
    double *correction;         /* [n][points] of the momenta at the nodes, of a Hamiltonian's velocities */
    double *H_pp;               /* [n][n][points] H_pp or its inverse */
    double *dx;                 /* the block of one tangent of the field at each node */
    tvi_roundoff roundoff;      /* the roundoff of the field at the nodes */
} tvi_action;

/* ---- The curve at the nodes -------------------------------------------------------------------------------------- */

/* Lengths of halves are padded to whole vectors. */
enum { SEEDS_MOST_HALF = (TVI_MAX_DEGREE + 2) / 2 + 4 };
static inline int seeds_width(int count) { return (count + 3) / 4 * 4; }

/* Computes row[node] = sum_{k <= degree} coefficient_k table_k(node), with coefficient_k at first + k * stride. */
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

/* Writes q at the nodes, and the time, into the inputs of a block. */
static inline void seeds_place_positions(const tvi_action *action, const tvi_curve *curve, double *x)
{
    const tvi_system *system = curve->system;
    const size_t stride = (size_t)system->field_series->slots;
    for (int i = 0; i < curve_n(curve); i++)
        seeds_at_nodes(action, action->q_degree, tvi_curve_Q(curve, 0) + i, stride, &action->node_power,
                       x + i * action->points);
    seeds_place_times(action, curve, x);
}

/* Writes v = g./tau at the nodes into the second input. */
static inline void seeds_place_velocities(const tvi_action *action, const tvi_curve *curve, double *v)
{
    const int points = action->points;
    const size_t stride = tvi_curve_slots(curve);
    for (int i = 0; i < curve_n(curve); i++) {
        seeds_at_nodes(action, action->q_degree, tvi_curve_Q(curve, 0) + i, stride, &action->slope, v + i * points);
        for (int node = 0; node < points; node++) v[i * points + node] /= curve->tau;
    }
}

/* Computes the momentum of the curve at the nodes, if it is needed. */
static inline void seeds_momenta_at_nodes(tvi_action *action, const tvi_curve *curve)
{
    const int n = curve_n(curve), points = action->points, degree = action->p_degree;
    const bool has_momenta = action->is_hamilton || action->has_velocity_defect;
    if (!has_momenta && !action->by_parts && curve_form(curve) == TVI_SEPARABLE) return;
    curve_momenta(curve, degree, action->P);
    for (int i = 0; i < n && has_momenta; i++)
        seeds_at_nodes(action, degree, action->P + i, (size_t)n, &action->power, action->momentum + i * points);
}

/* Divides the row, by the inverse of the divisor and the remainder: many quotients take long. */
static inline void seeds_divide(int points, double divisor, double row[])
{
    const double inverse = 1 / divisor;
    JET_IN_VECTORS
    for (int node = 0; node < points; node++) {
        const double quotient = row[node] * inverse;
        row[node] = quotient + inverse * (row[node] - quotient * divisor);
    }
}

/* Computes the derivative of this momentum, which is M q'' / tau of a separable system. */
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

/* ---- The field at the nodes -------------------------------------------------------------------------------------- */

static inline tvi_status seeds_run_field(const tvi_action *action)
{
    return SEEDS_VALUES(action->field, action->x, action->points) ? TVI_OK : TVI_EDOMAIN;
}

/* Computes panel = factor * outputs first .. first + n - 1 of the field. */
static inline void seeds_copy_outputs(const tvi_action *action, const tvi_curve *curve, int first, double factor,
                                      double *restrict panel)
{
    for (int i = 0; i < curve_n(curve); i++) {
        const double *row = seeds_output_row(action, action->field, action->x, first + i);
        JET_IN_VECTORS
        for (int node = 0; node < action->points; node++) panel[i * action->points + node] = factor * row[node];
    }
}

/* Subtracts `other` from the panel. */
static inline void seeds_subtract(const tvi_action *action, int n, const double *other, double *restrict panel)
{
    for (int i = 0; i < n * action->points; i++) panel[i] -= other[i];
}

#endif
