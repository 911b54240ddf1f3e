/* ends.h - Sums the impulses of a Galerkin step over its nodes, computes the increments and the tail from the sums, and
 * evaluates the curve of a step at other points (docs/method.md section 5). nodes.h has the letters. */
#ifndef TVI_SRC_GALERKIN_ENDS_H
#define TVI_SRC_GALERKIN_ENDS_H

#include "galerkin/nodes.h"

/* ---- The sums at the end of a step ------------------------------------------------------------------------------- */

/* The sums of a step's impulses over its nodes, [unknowns] each, with room for seven more numbers, so that a vector can
 * be stored at the last one: `once` = sum_j L_j, and its low-order part; `twice` = sum_j (1 - c_j) L_j, the double
 * integral of the rate divided by h; last_term, the magnitude of the last term of the rate's Legendre series; `ends`,
 * |L_j| of the first node plus that of the last one. */
typedef struct {
    double *once, *once_low, *twice, *twice_low, *last_term, *ends;
} galerkin_sums;

/* [lanes] The weights of the impulses in these sums: 1 - c_j, and that of the last term of the Legendre series. */
typedef struct {
    double *one_minus_c, *last_term;
} galerkin_sum_weights;

/* A vector of unknowns at one node. */
#ifdef __AVX__
typedef jet_v4 unknown_vec;
typedef jet_mask_of_jet_v4 jet_mask_of_unknown_vec;
JET_INLINE unknown_vec unknowns_at_node(const double *const row[], int j)
{
    return (unknown_vec){row[0][j], row[1][j], row[2][j], row[3][j]};
}
#else
typedef jet_v2 unknown_vec;
typedef jet_mask_of_jet_v2 jet_mask_of_unknown_vec;
JET_INLINE unknown_vec unknowns_at_node(const double *const row[], int j)
{
    return (unknown_vec){row[0][j], row[1][j]};
}
#endif
enum { UNKNOWN_VEC = sizeof(unknown_vec) / sizeof(double) };

/* The sums over nodes are compensated: the rounding errors of the additions are summed separately, and the low-order
 * part of the result is the rounding error of adding the two sums. Odd and even nodes have separate partial sums, which
 * the processor computes in parallel. */
typedef struct {
    unknown_vec total[2], loss[2];
} compensated_sum;

/* Adds weight term to *total, and the rounding error of this addition to *loss. */
JET_INLINE void add_compensated(unknown_vec *total, unknown_vec *loss, double weight, unknown_vec term)
{
    const unknown_vec next = term * weight + *total, added = next - *total;
    *loss += (*total - (next - added)) + (term * weight - added);
    *total = next;
}

JET_INLINE void store_compensated(compensated_sum *sum, double *whole, double *low)
{
    add_compensated(&sum->total[0], &sum->loss[0], 1, sum->total[1]);
    const unknown_vec loss = sum->loss[0] + sum->loss[1], both = sum->total[0] + loss;
    *(unknown_vec *)whole = both;
    *(unknown_vec *)low = loss - (both - sum->total[0]);
}

JET_INLINE void sum_rows(const galerkin_nodes *nodes, const galerkin_sum_weights *weights, const galerkin_sums *sums,
                         const int lanes)
{
    for (int u = 0; u < nodes->unknown_count; u += UNKNOWN_VEC) {
        const double *row[UNKNOWN_VEC];
        compensated_sum once = {0}, twice = {0};
        unknown_vec last = {0};
        for (int k = 0; k < UNKNOWN_VEC; k++)
            row[k] = nodes->impulse + (u + k < nodes->unknown_count ? u + k : nodes->unknown_count - 1) * lanes;
        for (int j = 0; j < lanes; j++) {
            const unknown_vec L = unknowns_at_node(row, j);
            add_compensated(&once.total[j % 2], &once.loss[j % 2], 1, L);
            add_compensated(&twice.total[j % 2], &twice.loss[j % 2], weights->one_minus_c[j], L);
            last += L * weights->last_term[j];
        }
        store_compensated(&once, sums->once + u, sums->once_low + u);
        store_compensated(&twice, sums->twice + u, sums->twice_low + u);
        *(unknown_vec *)(sums->last_term + u) = JET_ABS(unknown_vec, last);
        *(unknown_vec *)(sums->ends + u) = JET_ABS(unknown_vec, unknowns_at_node(row, 0)) +
                                           JET_ABS(unknown_vec, unknowns_at_node(row, NODE_COUNT_OF(nodes) - 1));
    }
}

NODE_LOOP void nodes_sum_impulses(const galerkin_nodes *nodes, const galerkin_sum_weights *weights,
                                  const galerkin_sums *sums)
{
    BY_LANES(nodes->lane_count, sum_rows(nodes, weights, sums, lanes));
}

/* The increments of a separable system, from the drift of the positions and the sums `once` and `twice` of the
 * impulses: dq = (move + move_low) + scale twice and dp = once, in two parts. */
NODE_LOOP void nodes_set_drifting_increments(const galerkin_nodes *nodes, const galerkin_sums *sums, const double *move,
                                             const double *move_low, const tvi_increments *to)
{
    for (int u = 0; u < nodes->unknown_count; u++) {
        const double scale = nodes->scale[u], rise = scale * sums->twice[u];
        double rest;
        to->dq[u] = tvi_two_sum(move[u], rise, &rest);
        to->dq_low[u] = rest + (fma(scale, sums->twice[u], -rise) + fma(scale, sums->twice_low[u], move_low[u]));
        to->dp[u] = sums->once[u];
        to->dp_low[u] = sums->once_low[u];
    }
}

/* The increments of equations of first order: (dq, dp) is scale, which is 1 for q and for p 1 or -1, times the sum
 * `once` of the impulses. */
NODE_LOOP void nodes_set_increments(const galerkin_nodes *nodes, const galerkin_sums *sums, const tvi_increments *to)
{
    const int n = nodes->n;
    for (int i = 0; i < n; i++) {
        to->dq[i] = nodes->scale[i] * sums->once[i];
        to->dq_low[i] = nodes->scale[i] * sums->once_low[i];
        to->dp[i] = nodes->scale[n + i] * sums->once[n + i];
        to->dp_low[i] = nodes->scale[n + i] * sums->once_low[n + i];
    }
}

/* ---- The tail ---------------------------------------------------------------------------------------------------- */

/* What the tail of a step is computed from: the last term of the polynomial of the rates relative to the momentum or
 * the movement (algebra/tail.h). */
typedef struct {
    int n;
    /* is_separable: the equations are Q'' = F. has_masses: the share of a component in the motion is that of its
     * movement, without its momentum (tvi_system.has_tail_shares_without_momenta). */
    bool is_separable, has_masses;
    tvi_subsystems subsystems;
    galerkin_sums sums;
    double inverse_end_weight; /* 1 / b_j of the first and the last node */
    const double *scale;       /* [n] that of the nodes */
    double *inverse_scale;     /* [n] 1 / |scale| */
    const double *q, *p, *dp;  /* [n] the state at the start of the step, and the increment of p */
    double *share, *ratio;     /* [n] scratch space: the share of each component, and its last term's ratio */
} galerkin_tail;

/* Returns the magnitudes of component i from which its tail is computed; of_p is the index of its momentum's sums. */
JET_INLINE tvi_component_sizes_in_step galerkin_component_sizes(const galerkin_tail *tail, int i, int of_p)
{
    const double *last = tail->sums.last_term, *ends = tail->sums.ends;
    tvi_component_sizes_in_step sizes = {.momentum_size = fabs(tail->p[i]) +
                                                          (fabs(tail->dp[i]) + ends[of_p] * tail->inverse_end_weight),
                                         .p_change_by_last_term = last[of_p],
                                         .q_change_by_last_term = tail->is_separable ? 0 : last[i],
                                         .coordinate_size = fabs(tail->q[i])};
    sizes.one_over_momentum_size = 1 / tvi_larger(sizes.momentum_size, TVI_LEAST_SIZE);
    sizes.q_change_size =
        tail->is_separable ? fabs(tail->scale[i]) * sizes.momentum_size : ends[i] * tail->inverse_end_weight;
    sizes.one_over_q_change_size = tail->is_separable ? tail->inverse_scale[i] * sizes.one_over_momentum_size
                                                      : 1 / tvi_larger(sizes.q_change_size, TVI_LEAST_SIZE);
    return sizes;
}

/* is_separable is a constant in each call, so that the loop over the components has no branches. */
JET_INLINE double compute_tail_of_form(const galerkin_tail *of, const bool is_separable)
{
    galerkin_tail tail = *of;
    double *restrict share = tail.share, *restrict ratio = tail.ratio;
    tail.is_separable = is_separable;
    for (int i = 0; i < tail.n; i++) {
        const tvi_component_sizes_in_step sizes = galerkin_component_sizes(&tail, i, is_separable ? i : i + tail.n);
        share[i] = tvi_component_motion_share(&sizes, is_separable || tail.has_masses);
        ratio[i] = tvi_component_last_term_ratio(&sizes);
    }
    return tvi_compute_tail(&tail.subsystems, tail.n, share, ratio);
}

NODE_LOOP double galerkin_compute_tail(const galerkin_tail *tail)
{
    return tail->is_separable ? compute_tail_of_form(tail, true) : compute_tail_of_form(tail, false);
}

/* ---- The curve at other points ----------------------------------------------------------------------------------- */

/* Components of the curve at several points: out[u][k] = start[u] + (theta[k] move[u] + scale[u] sum_j table_jk
 * L[u][j]), for u < count and k < points. The number of points is 1, the number of lanes or TVI_SAMPLES. */
typedef struct {
    int lane_count, points, count;
    const double *theta, *start, *move, *scale;
} galerkin_curve_points;

JET_INLINE void evaluate_vectors(const galerkin_curve_points *at, const double *table, const double *L,
                                 double *restrict out, const int lanes, const int points)
{
    for (int v = 0; v < points / NODE_VEC; v++) {
        const node_vec theta = node_load(at->theta, v);
        node_vec row[GALERKIN_MAX_LANES];
        for (int j = 0; j < lanes; j++) row[j] = node_load(table + j * points, v);
        for (int u = 0; u < at->count; u++) {
            node_vec sum[PARTIAL_SUMS] = {0};
            for (int j = 0; j < lanes; j++) sum[j % PARTIAL_SUMS] += row[j] * L[u * lanes + j];
            node_store(out + u * points, v,
                       at->start[u] + (theta * at->move[u] + at->scale[u] * ((sum[0] + sum[1]) + (sum[2] + sum[3]))));
        }
    }
}

JET_INLINE void evaluate_one(const galerkin_curve_points *at, const double *table, const double *L,
                             double *restrict out, const int lanes)
{
    for (int u = 0; u < at->count; u++) {
        double sum[PARTIAL_SUMS] = {0};
        for (int j = 0; j < lanes; j++) sum[j % PARTIAL_SUMS] += table[j] * L[u * lanes + j];
        out[u] = at->start[u] + (at->theta[0] * at->move[u] + at->scale[u] * ((sum[0] + sum[1]) + (sum[2] + sum[3])));
    }
}

NODE_LOOP void galerkin_evaluate(const galerkin_curve_points *at, const double *table, const double *L, double *out)
{
    BY_LANES(at->lane_count, if (at->points == 1) evaluate_one(at, table, L, out, lanes);
             else if (at->points == TVI_SAMPLES) evaluate_vectors(at, table, L, out, lanes, TVI_SAMPLES);
             else evaluate_vectors(at, table, L, out, lanes, lanes));
}

#endif
