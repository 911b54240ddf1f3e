/* ends.h - Computes at both ends of a Galerkin step: at its start the motion of the unknowns without forces, and the
 * sizes by which movements are measured; at its end the sums of the impulses over the nodes, and from them the
 * increments and the tail (docs/method.md sections 4 to 6; algebra/tail.h). nodes.h has the letters. */
#ifndef TVI_SRC_GALERKIN_ENDS_H
#define TVI_SRC_GALERKIN_ENDS_H

#include "algebra/tail.h"
#include "galerkin/nodes.h"
#include "method/stepper.h"

/* [1] The change of an unknown is measured relative to its own size plus this number times the largest size of a
 * coordinate, or of a momentum, in its subsystem. A small unknown has the roundoff of a large one. */
#define GALERKIN_MIN_SHARE 1e-3 /* found: make longrun */

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

/* Sets the free motion of the unknowns first .. first + count - 1 to the constants q and q_low. */
JET_INLINE void set_constant_rows(const galerkin_nodes *nodes, int first, int count, const double *q,
                                  const double *q_low, const int lanes)
{
    for (int u = first; u < first + count; u++) {
        nodes->start[u] = q[u - first];
        for (int v = 0; v < lanes / NODE_VEC; v++) {
            node_store(nodes->free_motion + u * lanes, v, node_all(q[u - first]));
            node_store(nodes->free_motion_low + u * lanes, v, node_all(q_low[u - first]));
        }
    }
}

/* Sets the free motion for equations of first order: the state at the start, at all nodes. */
NODE_LOOP void nodes_set_constant_free_motion(const galerkin_nodes *nodes, const tvi_step_origin *origin)
{
    const int n = nodes->n;
    BY_LANES(lanes, nodes->lane_count, set_constant_rows(nodes, 0, n, origin->q, origin->q_low, lanes));
    BY_LANES(lanes, nodes->lane_count, set_constant_rows(nodes, n, n, origin->p, origin->p_low, lanes));
}

/* Sets the free motion of unknown u to q + q_low + c (move + move_low), as a number and a small low-order part. The
 * products with c are exact: if h is near a ratio of small integers, such as 1/10, rounded products would have the same
 * error in each step, and the errors would add up. A movement first adds the sum of the impulses to the low-order part,
 * whose rounding errors are far smaller than those of the number. */
JET_INLINE void set_linear_row(const galerkin_nodes *nodes, int u, const double *c, const tvi_step_origin *origin,
                               double move, double move_low, const int lanes)
{
    const node_vec q = node_all(origin->q[u]), low = node_all(origin->q_low[u]);
    nodes->start[u] = origin->q[u];
    for (int v = 0; v < lanes / NODE_VEC; v++) {
        const node_vec part = node_load(c, v), sum = part * move + q, added = sum - q;
        const node_vec lost = (q - (sum - added)) + (part * move - added);
        node_store(nodes->free_motion + u * lanes, v, sum);
        node_store(nodes->free_motion_low + u * lanes, v, (part * move_low + low) + lost);
    }
}

/* Sets the free motion for a separable system, in which positions move with the momentum, by c_i h M^-1 (p + p_low) at
 * node i. Also sets (move, move_low), the movement h M^-1 (p + p_low) over the whole step in two parts. */
NODE_LOOP void nodes_set_linear_free_motion(const galerkin_nodes *nodes, const double *c, const tvi_step_origin *origin,
                                            double *move, double *move_low)
{
    const int count = nodes->unknown_count;
    for (int u = 0; u < count; u++) {
        move[u] = nodes->scale[u] * origin->p[u];
        move_low[u] = fma(nodes->scale[u], origin->p[u], -move[u]) + nodes->scale[u] * origin->p_low[u];
    }
    BY_LANES(lanes, nodes->lane_count,
             for (int u = 0; u < count; u++) set_linear_row(nodes, u, c, origin, move[u], move_low[u], lanes));
}

/* ---- The sizes of the unknowns ----------------------------------------------------------------------------------- */

/* Returns the size of an unknown: |start| + |value at the last node - start|. */
JET_INLINE double node_size_of(const galerkin_nodes *nodes, int u)
{
    return fabs(nodes->start[u]) + fabs(nodes->x[(u + 1) * nodes->lane_count - 1] - nodes->start[u]);
}

/* Returns what is added to the size of each unknown of a subsystem (GALERKIN_MIN_SHARE), of which `largest` is the
 * largest size. It is 1 if all sizes are 0. */
JET_INLINE double node_size_addition(double largest)
{
    return largest > 0 ? GALERKIN_MIN_SHARE * largest + DBL_MIN : 1;
}

/* Sets inverse_size for the unknowns of one subsystem. To the size of each unknown it adds a small part of the largest
 * size in its subsystem (GALERKIN_MIN_SHARE). If masses are known, no more is added to the size of a momentum than
 * m_over_h times the part that is added to its coordinate. There are no branches, because the processor could not
 * predict which number is larger. */
JET_INLINE void set_inverse_sizes_of_subsystem(const galerkin_nodes *nodes, int first, int end)
{
    const int n = nodes->n;
    const bool has_momenta = nodes->unknown_count > n;
    double largest_q = 0, largest_p = 0;
    for (int k = first; k < end; k++) {
        const int i = tvi_subsystems_component_at(&nodes->subsystems, k);
        const double size = node_size_of(nodes, i);
        nodes->inverse_size[i] = size;
        largest_q = tvi_larger(size, largest_q);
        if (!has_momenta) continue;
        const double of_p = node_size_of(nodes, n + i);
        nodes->inverse_size[n + i] = of_p;
        largest_p = tvi_larger(of_p, largest_p);
    }
    const double least_q = node_size_addition(largest_q), least_p = node_size_addition(largest_p);
    for (int k = first; k < end; k++) {
        const int i = tvi_subsystems_component_at(&nodes->subsystems, k);
        nodes->inverse_size[i] = 1 / (nodes->inverse_size[i] + least_q);
        if (!has_momenta) continue;
        const double own = nodes->m_over_h[i] * least_q, least = least_p > own ? own : least_p;
        nodes->inverse_size[n + i] = 1 / (nodes->inverse_size[n + i] + least);
    }
}

NODE_LOOP void nodes_set_sizes(const galerkin_nodes *nodes)
{
    const tvi_subsystems parts = nodes->subsystems;
    for (int k = 0, first = 0, end; k < parts.count; k++, first = end) {
        end = tvi_subsystems_end(&parts, k, nodes->n);
        set_inverse_sizes_of_subsystem(nodes, first, end);
    }
}

/* ---- The sums at the end of a step ------------------------------------------------------------------------------- */

/* The sums of a step's impulses over its nodes, [unknowns] each, with room for seven more numbers, so that a vector can
 * be stored at the last one. */
typedef struct {
    double *once, *once_low;   /* sum_j L_j, the integral of the rate over the step, and its low-order part. */
    double *twice, *twice_low; /* sum_j (1 - c_j) L_j, the double integral of the rate divided by h, in two parts. */
    double *last_term; /* The magnitude of h times the last term of the rate's series in Legendre polynomials. */
    double *ends;      /* |L_j| of the first node plus |L_j| of the last node. */
} galerkin_sums;

/* The weights of the impulses in galerkin_sums, [lanes] each. */
typedef struct {
    double *one_minus_c; /* 1 - c_j, the weight of L_j in `twice`. */
    double *last_term;   /* The weight of L_j in the last term of the Legendre series (set_sum_weights in tables.c). */
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
    BY_LANES(lanes, nodes->lane_count, sum_rows(nodes, weights, sums, lanes));
}

/* Sets the increments of a separable system from the free motion (move, move_low) of the positions over the step and
 * the sums `once` and `twice` of the impulses: dq = (move + move_low) + scale twice and dp = once, in two parts. */
NODE_LOOP void nodes_set_separable_increments(const galerkin_nodes *nodes, const galerkin_sums *sums,
                                              const double *move, const double *move_low, const tvi_increments *to)
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

/* Sets the increments of equations of first order: (dq, dp) = scale once, with the sum `once` of the impulses. The
 * scale of q is 1. The scale of p is 1 for a Lagrangian, whose rate is L_q, and -1 for a Hamiltonian, whose tape
 * computes H_q where the rate is -H_q. */
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

/* The numbers from which the tail of a step is computed. The tail is the last term of the polynomial of the rates
 * relative to the momentum or the movement (algebra/tail.h). */
typedef struct {
    int n;
    bool is_separable; /* The equations are Q'' = F. */
    /* The share of a component in the motion is its squared movement; its momentum does not count
     * (tvi_system.tail). */
    bool has_masses;
    tvi_subsystems subsystems;
    galerkin_sums sums;
    double inverse_end_weight; /* 1 / b_j of the first and the last node */
    const double *scale;       /* [n] what an impulse moves a coordinate by, h / m (galerkin_nodes.scale) */
    double *inverse_scale;     /* [n] 1 / |scale| */
    const double *q, *p, *dp;  /* [n] the state at the start of the step, and the increment of p */
    double *share, *ratio; /* [n] scratch: the share of each component in the motion, and the ratio of its last term */
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

/* Computes the tail. is_separable is a constant in each call, so that the loop over the components has no branches. */
JET_INLINE double compute_tail_of_form(const galerkin_tail *given, const bool is_separable)
{
    galerkin_tail tail = *given;
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

#endif
