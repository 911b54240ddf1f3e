/* nodes.h - evaluates the curve and the field at the nodes of the discrete action. It is part of the text of generated
 * code (emit.c), where every size is a constant. */
#ifndef TVI_SRC_GENERATING_NODES_H
#define TVI_SRC_GENERATING_NODES_H

#include "algebra/sizes.h"
#include "fused.h"
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
    int width;                              /* that of the curve: rows of nodes are [points][width] */
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
enum { SEEDS_HALF = (TVI_MAX_DEGREE + 2) / 2 + 4, SEEDS_MOST_HALF = SEEDS_HALF * CURVE_MOST_WIDTH };
static inline int seeds_width(int count) { return (count + 3) / 4 * 4; }

/* Returns how many numbers a row of the nodes has. */
static inline int seeds_lanes(const tvi_action *action) { return action->points * CURVE_WIDTH(action); }

/* Computes out[o] = sum_{j < count} c_j table[j][o], o < outs, c_j = c[j * stride], for each member. */
static inline void seeds_combine(const tvi_action *action, int count, const double *c, size_t stride, int outs,
                                 const double *table, double *out)
{
    const int width = CURVE_WIDTH(action);
    if (width == 1) CURVE_COMBINE(action, count, c, stride, outs, table, out);
    for (int o = 0; width > 1 && o < outs; o++)
        CURVE_COMBINE_EACH(count, table + o, (size_t)outs, width, stride, c, out + o * width);
}

/* Computes row[node] = sum_{k <= degree} coefficient_k table_k(node), with coefficient_k at first + k * stride. */
static inline void seeds_at_nodes(const tvi_action *action, int degree, const double *first, size_t stride,
                                  const tvi_node_table *table, double row[])
{
    const int lanes = seeds_lanes(action) / 2;
    double even[SEEDS_MOST_HALF], odd[SEEDS_MOST_HALF];
    if (action->half == 0) {
        seeds_combine(action, degree + 1, first, stride, action->points, table->full, row);
        return;
    }
    seeds_combine(action, degree / 2 + 1, first, 2 * stride, action->half, table->even, even);
    seeds_combine(action, (degree + 1) / 2, first + stride, 2 * stride, action->half, table->odd, odd);
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) row[i] = even[i] + odd[i];
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) row[lanes + i] = table->mirrored * (even[i] - odd[i]);
}

static inline void seeds_place_times(const tvi_action *action, const tvi_curve *curve, double *x)
{
    double *t = x + curve_inputs(curve) * seeds_lanes(action);
    if (!curve_uses_time(curve)) return;
    for (int node = 0; node < action->points; node++)
        for (int m = 0; m < curve_width(curve); m++)
            *t++ = JET_FUSED(jet_v1, curve->tau, action->s[node], curve_time(curve, 0)[m]);
}

/* Writes q at the nodes, and the time, into the inputs of a block. */
static inline void seeds_place_positions(const tvi_action *action, const tvi_curve *curve, double *x)
{
    const int width = curve_width(curve);
    for (int i = 0; i < curve_n(curve); i++)
        seeds_at_nodes(action, action->q_degree, tvi_curve_Q(curve, 0) + i * width, tvi_curve_slots(curve),
                       &action->node_power, x + i * seeds_lanes(action));
    seeds_place_times(action, curve, x);
}

/* Writes v = g./tau at the nodes into the second input. */
static inline void seeds_place_velocities(const tvi_action *action, const tvi_curve *curve, double *v)
{
    const int lanes = seeds_lanes(action), width = curve_width(curve);
    for (int i = 0; i < curve_n(curve); i++) {
        seeds_at_nodes(action, action->q_degree, tvi_curve_Q(curve, 0) + i * width, tvi_curve_slots(curve),
                       &action->slope, v + i * lanes);
        for (int at = i * lanes; at < (i + 1) * lanes; at++) v[at] /= curve->tau;
    }
}

/* Computes the momentum of the curve at the nodes, if it is needed. */
static inline void seeds_momenta_at_nodes(tvi_action *action, const tvi_curve *curve)
{
    const int width = curve_width(curve), lanes = seeds_lanes(action), degree = action->p_degree;
    const bool has_momenta = action->is_hamilton || action->has_velocity_defect;
    if (!has_momenta && !action->by_parts && curve_form(curve) == TVI_SEPARABLE) return;
    curve_momenta(curve, degree, action->P);
    for (int i = 0; i < curve_n(curve) && has_momenta; i++)
        seeds_at_nodes(action, degree, action->P + i * width, (size_t)curve_numbers(curve), &action->power,
                       action->momentum + i * lanes);
}

/* Divides the row, by the inverse of the divisor and the remainder: many quotients take long. */
static inline void seeds_divide(int lanes, double divisor, double row[])
{
    const double inverse = 1 / divisor;
    JET_IN_VECTORS
    for (int node = 0; node < lanes; node++) {
        const double quotient = row[node] * inverse;
        row[node] = quotient + inverse * (row[node] - quotient * divisor);
    }
}

/* Computes the derivative of this momentum, which is M q'' / tau of a separable system. */
static inline void seeds_forces_at_nodes(tvi_action *action, const tvi_curve *curve)
{
    const int width = curve_width(curve), lanes = seeds_lanes(action), degree = action->p_degree;
    const size_t stride = tvi_curve_slots(curve);
    double *force = action->force;
    for (int i = 0; i < curve_n(curve); i++, force += lanes)
        if (curve_form(curve) == TVI_SEPARABLE) {
            seeds_at_nodes(action, degree + 1, tvi_curve_Q(curve, 0) + i * width, stride, &action->second_slope, force);
            seeds_divide(lanes, curve->kappa[i], force);
        } else {
            seeds_at_nodes(action, degree, action->P + i * width, (size_t)curve_numbers(curve), &action->slope, force);
        }
}

static inline const double *seeds_output_row(const tvi_action *action, const jet_tape *tape, const double *x, int i)
{
    (void)tape;
    return x + (size_t)CURVE_SIZE(CURVE_VALUES_SLOT, tape->output)[i] * (size_t)seeds_lanes(action);
}

/* ---- The field at the nodes -------------------------------------------------------------------------------------- */

static inline tvi_status seeds_run_field(const tvi_action *action)
{
    return SEEDS_VALUES(action->field, action->x, seeds_lanes(action)) ? TVI_OK : TVI_EDOMAIN;
}

/* Computes panel = factor * outputs first .. first + n - 1 of the field. */
static inline void seeds_copy_outputs(const tvi_action *action, const tvi_curve *curve, int first, double factor,
                                      double *restrict panel)
{
    const int lanes = seeds_lanes(action);
    for (int i = 0; i < curve_n(curve); i++) {
        const double *row = seeds_output_row(action, action->field, action->x, first + i);
        JET_IN_VECTORS
        for (int node = 0; node < lanes; node++) panel[i * lanes + node] = factor * row[node];
    }
}

/* Subtracts `other` from the panel. */
static inline void seeds_subtract(const tvi_action *action, int n, const double *other, double *restrict panel)
{
    for (int i = 0; i < n * seeds_lanes(action); i++) panel[i] -= other[i];
}

#endif
