/* nodes.h - Computes with the unknowns of a Galerkin step at its nodes (docs/method.md section 5): their drift without
 * forces, their prediction, the sizes by which movements are measured, and the movement of a pass. These loops take all
 * the time of a step but that of the field; those at its end are in ends.h.
 *
 * Letters: h is the size of the step, c_i the nodes and b_i the weights of Gauss quadrature on [0, 1], a_ij the matrix
 * of collocation. The rate F_j of an unknown at node j acts only through the impulse L_j = h b_j F_j, which is rounded
 * once. All sums use the rounded number, so that conservation laws of these sums do not depend on rounding.
 *
 * An array of an unknown has a lane for each node: 4, 8 or 12 lanes, of which those after the last node repeat it with
 * weight 0. Loops go over vectors of nodes, as wide as the instruction set has them. The number of lanes is a constant
 * in each loop (BY_LANES), in generated code that of its system. */
#ifndef TVI_SRC_GALERKIN_NODES_H
#define TVI_SRC_GALERKIN_NODES_H

#include "algebra/passes.h"
#include "algebra/subsystems.h"
#include "algebra/tail.h"
#include "method/stepper.h"
#include "vector.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* [1] A movement is measured relative to the size of its component plus this part of the largest component of the
 * subsystem: the roundoff of a small component is no smaller than that of a large one. */
#define GALERKIN_MIN_SHARE 1e-3 /* found: make longrun */

enum { GALERKIN_MAX_LANES = 12 };
/* The number of steps whose impulses are stored: the last two steps and the current step. */
enum { GALERKIN_RING_LENGTH = 3 };

/* ---- Vectors of nodes -------------------------------------------------------------------------------------------- */

/* Vectors of successive nodes, in double and in single precision. */
#if defined(JET_WIDE) && (!defined(GALERKIN_LANES) || GALERKIN_LANES == 8)
typedef jet_v8 node_vec;
typedef float node_single JET_VECTOR(float, 8);
typedef jet_mask_of_jet_v8 jet_mask_of_node_vec;
#elif defined(__AVX__)
typedef jet_v4 node_vec;
typedef float node_single JET_VECTOR(float, 4);
typedef jet_mask_of_jet_v4 jet_mask_of_node_vec;
#else
typedef jet_v2 node_vec;
typedef float node_single JET_VECTOR(float, 2);
typedef jet_mask_of_jet_v2 jet_mask_of_node_vec;
#endif
enum { NODE_VEC = sizeof(node_vec) / sizeof(double), MAX_VECTORS = GALERKIN_MAX_LANES / NODE_VEC };

/* Vector v of a row of nodes. */
JET_INLINE node_vec node_load(const double *row, int v) { return *(const node_vec *)(row + v * NODE_VEC); }
JET_INLINE void node_store(double *row, int v, node_vec x) { *(node_vec *)(row + v * NODE_VEC) = x; }
JET_INLINE node_vec node_all(double x) { return x - (node_vec){0}; }
JET_INLINE node_vec node_larger(node_vec a, node_vec b) { return JET_CHOOSE(node_vec, a > b, a, b); }

/* In the library a loop is a function of its own, which can use all registers. In generated code, where all sizes are
 * constants, it is inlined. BY_LANES executes the call, which reads the constant `lanes`. A set with vectors of 8 nodes
 * is used with 8 lanes alone (generating/methods.c). */
#define WITH_LANES(count, call)                                                                                        \
    {                                                                                                                  \
        enum { lanes = count };                                                                                        \
        call;                                                                                                          \
    }
#ifdef GALERKIN_LANES
#define NODE_LOOP            JET_INLINE
#define NODE_COUNT_OF(nodes) ((void)(nodes), GALERKIN_NODE_COUNT)
#define BY_LANES(number, call)                                                                                         \
    (void)(number);                                                                                                    \
    WITH_LANES(GALERKIN_LANES, call)
#else
#define NODE_LOOP            JET_APART
#define NODE_COUNT_OF(nodes) ((nodes)->node_count)
#define BY_LANES(number, call)                                                                                         \
    if (NODE_VEC == 8 || (number) == 8) WITH_LANES(8, call)                                                            \
    else if ((number) == 4) WITH_LANES(4, call)                                                                        \
    else WITH_LANES(12, call)
#endif

/* ---- The unknowns at the nodes ----------------------------------------------------------------------------------- */

/* The unknowns x of a step at its nodes: x = drift + drift_low + scale sum_j nu_ij L_j, with nu_ij = a_ij / b_j, or
 * sum_k a_ik a_kj / b_j for a separable system, whose unknowns are the coordinates alone. Arrays are
 * [unknown_count][lane_count] unless noted otherwise. */
typedef struct {
    int lane_count, node_count, unknown_count;
    int n; /* the number of coordinates */
    /* A pass moves all unknowns if moving_count is their number, and otherwise the first moving_count coordinates and
     * the first moving_count momenta: the last coordinates are cyclic, and their momenta constant. */
    int moving_count;
    double *x; /* the unknowns; of GALERKIN_PLAIN (steps.h) the block of the tape, which begins with them */
    double *drift, *drift_low; /* the unknowns without impulses, in two parts */
    double *impulse;           /* the impulses L_j of the last movement, stored in the history */
    double *start;             /* [unknown_count] the unknowns at the start of the step */
    double *scale;             /* [unknown_count] the factor of the impulses' sum in the change of an unknown */
    double *inverse_size;      /* [unknown_count] 1 / size of each unknown, by which movements are measured */
    double *hb;                /* [lane_count] h b_j */
    double *m_over_h;          /* [n] the momentum that moves a coordinate by 1 in the step; INFINITY without masses */
    const double *nu;          /* [j][i] nu_ij, by which an impulse of node j moves node i */
    tvi_subsystems subsystems;
} galerkin_nodes;

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

/* Sets the drift of the unknowns first .. first + count - 1 to q and q_low. */
JET_INLINE void set_constant_rows(const galerkin_nodes *nodes, int first, int count, const double *q,
                                  const double *q_low, const int lanes)
{
    for (int u = first; u < first + count; u++) {
        nodes->start[u] = q[u - first];
        for (int v = 0; v < lanes / NODE_VEC; v++) {
            node_store(nodes->drift + u * lanes, v, node_all(q[u - first]));
            node_store(nodes->drift_low + u * lanes, v, node_all(q_low[u - first]));
        }
    }
}

/* The drift of equations of first order is the state at the start. */
NODE_LOOP void nodes_set_constant_drift(const galerkin_nodes *nodes, const tvi_step_origin *origin)
{
    const int n = nodes->n;
    BY_LANES(nodes->lane_count, set_constant_rows(nodes, 0, n, origin->q, origin->q_low, lanes));
    BY_LANES(nodes->lane_count, set_constant_rows(nodes, n, n, origin->p, origin->p_low, lanes));
}

/* Sets the drift of unknown u to q + q_low + c (move + move_low), as a number and a small low-order part. The products
 * with c are exact: if h is near a ratio of small integers, such as 1/10, rounded products would have the same error in
 * each step, and the errors would add up. A movement first adds the sum of the impulses to the low-order part, whose
 * rounding errors are far smaller than those of the number. */
JET_INLINE void set_linear_row(const galerkin_nodes *nodes, int u, const double *c, const tvi_step_origin *origin,
                               double move, double move_low, const int lanes)
{
    const node_vec q = node_all(origin->q[u]), low = node_all(origin->q_low[u]);
    nodes->start[u] = origin->q[u];
    for (int v = 0; v < lanes / NODE_VEC; v++) {
        const node_vec part = node_load(c, v), sum = part * move + q, added = sum - q;
        const node_vec lost = (q - (sum - added)) + (part * move - added);
        node_store(nodes->drift + u * lanes, v, sum);
        node_store(nodes->drift_low + u * lanes, v, (part * move_low + low) + lost);
    }
}

/* Positions of a separable system drift with the momentum: by c_i h M^-1 (p + p_low) at node i. Also sets this drift
 * over the whole step, in two parts. */
NODE_LOOP void nodes_set_linear_drift(const galerkin_nodes *nodes, const double *c, const tvi_step_origin *origin,
                                      double *move, double *move_low)
{
    const int count = nodes->unknown_count;
    for (int u = 0; u < count; u++) {
        move[u] = nodes->scale[u] * origin->p[u];
        move_low[u] = fma(nodes->scale[u], origin->p[u], -move[u]) + nodes->scale[u] * origin->p_low[u];
    }
    BY_LANES(nodes->lane_count,
             for (int u = 0; u < count; u++) set_linear_row(nodes, u, c, origin, move[u], move_low[u], lanes));
}

/* ---- Sums over the nodes ----------------------------------------------------------------------------------------- */

/* A sum is split into this many partial sums, which the processor computes in parallel. */
enum { PARTIAL_SUMS = 4 };
/* The most vectors of a row whose sums are computed together: each L_j is loaded once for all of them. */
enum { MAX_BLOCK = 2 };

/* A table [j][lanes] of factors in sums over the nodes j: a local copy, which stays in registers, if a row is one
 * vector. */
typedef struct {
    const double *factor;
    node_vec row[NODE_VEC];
} node_table;

JET_INLINE node_table node_table_of(const double *factor, const int lanes)
{
    node_table table = {.factor = factor};
    for (int j = 0; j < (lanes == NODE_VEC ? lanes : 0); j++) table.row[j] = node_load(factor + j * lanes, 0);
    return table;
}

/* Adds sum_j table_jv L_j to the partial sums of the vectors v of a block that begins with vector `first`. */
JET_INLINE void add_products(node_vec sum[][PARTIAL_SUMS], const node_table *table, const double L[], int first,
                             const int block, const int lanes)
{
    for (int j = 0; j < lanes; j++)
        for (int b = 0; b < block; b++)
            sum[b][j % PARTIAL_SUMS] +=
                (lanes == NODE_VEC ? table->row[j] : node_load(table->factor + j * lanes, first + b)) * L[j];
}

JET_INLINE node_vec join_partial_sums(const node_vec sum[]) { return (sum[0] + sum[2]) + (sum[1] + sum[3]); }

/* The sum over the elements of a vector, by halves. */
JET_INLINE double node_sum(node_vec x)
{
    double part[NODE_VEC];
    node_store(part, 0, x);
    for (int half = NODE_VEC / 2; half > 0; half /= 2)
        for (int i = 0; i < half; i++) part[i] += part[i + half];
    return part[0];
}

/* ---- The prediction ---------------------------------------------------------------------------------------------- */

/* The impulses of earlier steps, and the tables of factors that predict the unknowns of a step from them: both of the
 * last two steps, with two_step_table [2][j][i], whose second half belongs to the earlier step; or, if no earlier step
 * has the same size or the prediction of the last step was rough, the last step alone, with last_step_table [j][i]. */
typedef struct {
    const double *two_step_table, *last_step_table, *last_impulse, *impulse_before;
    bool uses_last_step_only;
} galerkin_extrapolation;

/* Predicts the unknowns. The impulses of the latest step, which have the largest factors, are added last. */
JET_INLINE void predict_rows(const galerkin_nodes *of, const galerkin_extrapolation *by, const int lanes)
{
    const int block = lanes / NODE_VEC % MAX_BLOCK == 0 ? MAX_BLOCK : 1;
    const galerkin_nodes copy = *of, *const nodes = &copy;
    const galerkin_extrapolation from = *by;
    const bool only_last = from.uses_last_step_only;
    const node_table last = node_table_of(only_last ? from.last_step_table : from.two_step_table, lanes);
    const node_table before = node_table_of(from.two_step_table + (only_last ? 0 : lanes * lanes), lanes);
    for (int u = 0; u < nodes->unknown_count; u++) {
        const double *drift = nodes->drift + u * lanes, *low = nodes->drift_low + u * lanes;
        for (int first = 0; first < lanes / NODE_VEC; first += block) {
            node_vec sum[MAX_BLOCK][PARTIAL_SUMS] = {0};
            if (!only_last) add_products(sum, &before, from.impulse_before + u * lanes, first, block, lanes);
            add_products(sum, &last, from.last_impulse + u * lanes, first, block, lanes);
            for (int v = first; v < first + block; v++)
                node_store(nodes->x + u * lanes, v,
                           node_load(drift, v) +
                               (join_partial_sums(sum[v - first]) * nodes->scale[u] + node_load(low, v)));
        }
    }
}

NODE_LOOP void nodes_predict(const galerkin_nodes *nodes, const galerkin_extrapolation *by)
{
    BY_LANES(nodes->lane_count, predict_rows(nodes, by, lanes));
}

/* ---- Sizes ------------------------------------------------------------------------------------------------------- */

/* Returns the size of an unknown: |start| + |value at the last node - start|. */
JET_INLINE double node_size_of(const galerkin_nodes *nodes, int u)
{
    return fabs(nodes->start[u]) + fabs(nodes->x[(u + 1) * nodes->lane_count - 1] - nodes->start[u]);
}

/* Returns what is added to the sizes of unknowns of which this is the largest one. */
JET_INLINE double node_least_size(double largest) { return largest > 0 ? GALERKIN_MIN_SHARE * largest + DBL_MIN : 1; }

/* Sets inverse_size for the unknowns of one subsystem. To the size of each unknown it adds a small part of the largest
 * size in its subsystem (GALERKIN_MIN_SHARE). If masses are known, no more is added to the size of a momentum than
 * m_over_h times the part that is added to its coordinate. There are no branches, because the processor could not
 * predict which number is larger. */
JET_INLINE void set_sizes_of_subsystem(const galerkin_nodes *nodes, int first, int end)
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
    const double least_q = node_least_size(largest_q), least_p = node_least_size(largest_p);
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
        set_sizes_of_subsystem(nodes, first, end);
    }
}

/* ---- The movement of a pass -------------------------------------------------------------------------------------- */

/* Sets the impulses L_j = h b_j F_j from the rates: row slot[u] of `rates` has those of unknown u. */
JET_INLINE void set_impulse_rows(const galerkin_nodes *of, const double *rates, const int slot[], const int lanes)
{
    const galerkin_nodes copy = *of, *const nodes = &copy;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int v = 0; v < lanes / NODE_VEC; v++)
            node_store(nodes->impulse + u * lanes, v, node_load(nodes->hb, v) * node_load(rates + slot[u] * lanes, v));
}

/* Returns a b + c, rounded once if c is small compared with a b. Without a fused operation it uses Dekker's product. */
JET_INLINE double multiply_add_once(double a, double b, double c)
{
#ifdef __FMA__
    return JET_FMA_OF_NUMBERS(a, b, c);
#else
    const double split = 0x1p27 + 1, product = a * b, big_a = split * a, big_b = split * b;
    const double high_a = big_a - (big_a - a), high_b = big_b - (big_b - b), low_a = a - high_a, low_b = b - high_b;
    return product + ((((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b) + c);
#endif
}

/* Sets the impulses L_j = h b_j F_j + change_j. If the change were added to the rate before the multiplication, a
 * change below the roundoff of the rate would be lost or rounded up in the same way in each step (docs/method.md
 * section 6). */
JET_INLINE void set_changed_impulse_rows(const galerkin_nodes *nodes, const double *rates, const double *change,
                                         const int slot[], const int lanes)
{
    for (int u = 0; u < nodes->unknown_count; u++) {
        const double *restrict hb = nodes->hb, *restrict rate = rates + slot[u] * lanes;
        double *restrict L = nodes->impulse + u * lanes;
        JET_IN_VECTORS
        for (int i = 0; i < lanes; i++) L[i] = multiply_add_once(hb[i], rate[i], change[u * lanes + i]);
    }
}

/* Moves the unknowns by the impulses: x = drift + y with y = drift_low + scale sum_j nu_ij L_j. If `moved`
 * [unknowns][lanes] is not NULL, it gets y. Returns the movement: the sum of the squares of (change of x) inverse_size,
 * which is a NaN if any change is a NaN. */
JET_INLINE double move_unknowns(const galerkin_nodes *of, double *moved, const int lanes)
{
    const int block = lanes / NODE_VEC % MAX_BLOCK == 0 ? MAX_BLOCK : 1;
    const galerkin_nodes copy = *of, *const nodes = &copy;
    const int moving = nodes->moving_count, all = moving < nodes->unknown_count ? 2 * moving : nodes->unknown_count;
    const node_table nu = node_table_of(nodes->nu, lanes);
    node_vec squares[MAX_VECTORS] = {0}, total = {0};
    for (int k = 0; k < all; k++) {
        const int u = k < moving ? k : k - moving + nodes->n;
        const double *drift = nodes->drift + u * lanes, *low = nodes->drift_low + u * lanes;
        double *x = nodes->x + u * lanes;
        for (int first = 0; first < lanes / NODE_VEC; first += block) {
            node_vec sum[MAX_BLOCK][PARTIAL_SUMS] = {0};
            add_products(sum, &nu, nodes->impulse + u * lanes, first, block, lanes);
            for (int v = first; v < first + block; v++) {
                const node_vec y = join_partial_sums(sum[v - first]) * nodes->scale[u] + node_load(low, v),
                               next = node_load(drift, v) + y;
                const node_vec change = (next - node_load(x, v)) * nodes->inverse_size[u];
                squares[v] += change * change;
                node_store(x, v, next);
                if (moved) node_store(moved + u * lanes, v, y);
            }
        }
    }
    for (int v = 0; v < lanes / NODE_VEC; v++) total += squares[v];
    return node_sum(total);
}

/* Sets the impulses from the rates, and moves the unknowns. */
NODE_LOOP double nodes_move(const galerkin_nodes *nodes, const double *rates, const int slot[], double *moved)
{
    double movement;
    BY_LANES(nodes->lane_count, set_impulse_rows(nodes, rates, slot, lanes);
             movement = move_unknowns(nodes, moved, lanes));
    return movement;
}

/* As nodes_move, with the impulses L_j = h b_j F_j + change_j. */
NODE_LOOP double nodes_move_with_changes(const galerkin_nodes *nodes, const double *rates, const double *change,
                                         const int slot[])
{
    double movement;
    BY_LANES(nodes->lane_count, set_changed_impulse_rows(nodes, rates, change, slot, lanes);
             movement = move_unknowns(nodes, NULL, lanes));
    return movement;
}

#endif
