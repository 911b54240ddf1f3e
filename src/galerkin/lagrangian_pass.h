/* lagrangian_pass.h - Makes passes for a Lagrangian L(q, v, t): the rate of the positions Q is V, with L_v(Q, V) = P,
 * and the rate of the momenta P is F = L_q(Q, V) (docs/method.md sections 4 and 5).
 *
 * A pass evaluates the gradient (L_q, L_v) at points (Q*, V*) near the nodes. It also evaluates the second derivatives
 * there, unless the last movement was small enough to use the old ones again. Then it iterates, with F expanded to
 * first order about (Q*, V*),
 *
 *     P = p0 + h a F,    V = V* + L_vv^-1 ((P - L_v) - L_vq (Q - Q*)),    Q = q0 + h a V,
 *
 * where L_v and its derivatives are those at (Q*, V*), h is the step size, a the matrix of Gauss collocation and (q0,
 * p0) the state at the start of the step. (Q*, V*) is (Q, V) at the start of the pass, with the last bits rounded off
 * (lagrangian_round). */
#ifndef TVI_GALERKIN_LAGRANGIAN_PASS_H
#define TVI_GALERKIN_LAGRANGIAN_PASS_H

#include "galerkin/nodes.h"
#include "tvi.h"

#include <float.h>

/* [1] Rows would have to be exchanged if a pivot is smaller, or larger, by this factor than the number on the diagonal
 * before the elimination. */
#define LINEAR_MIN_PIVOT_OF_INVERSE (1.0 / 16) /* found: make check-library */
/* [1] L'' is reused if (relative movement)^2 is at most this. */
#define LAGRANGIAN_HESSIAN_MAX_MOVEMENT 1e-8 /* found: make longrun */
/* [iterations] A pass for a Lagrangian has at most, and at least, this many inner iterations. More would cost more than
 * they save. After a single iteration F would not follow V, and the energy would drift by the error of V in the last
 * pass. */
#define LAGRANGIAN_MAX_ITERATIONS 3 /* found: make longrun */
#define LAGRANGIAN_MIN_ITERATIONS 2 /* found: make longrun */
/* [bits] This number of last bits is rounded off the coordinates and velocities of the nodes to give the points at
 * which a Lagrangian's gradient is evaluated. Fewer bits would not be the same in the last passes of a step. */
#define LAGRANGIAN_ROUNDED_BITS 6 /* found: make longrun */

/* An n x n matrix at each node, and its inverse. */
typedef struct {
    int n;
    double *matrix, *inverse; /* [n][n][lanes] The matrices and their inverses, an element of all nodes in a row. */
    double *scratch_column;   /* [n][lanes] Scratch: one column of numbers at each node. */
} node_matrix;

/* (Q*, V*) are the positions and velocities at which the Hessian was computed last. The rows of nodes.x are positions
 * Q, momenta P, velocities V, forces F = L_q, and the change of L_v by the displacement of Q, n each. */
typedef struct {
    /* The nodes with the rates V and F as unknowns. The prediction extrapolates them from the impulses of earlier
     * steps, with scale = 1 / h, and no free motion. */
    galerkin_nodes rates;
    double *q_moved;          /* [n][lanes] Q minus q at the start of the step. */
    double *start_minus_q[2]; /* [n][lanes] q at the start of the step minus Q*: a number and its low-order part. */
    double *gradient;         /* [2n][lanes] (L_q, L_v) at (Q*, V*). */
    double *displacement;     /* [2n][lanes] (Q, V) minus (Q*, V*). */
    /* The elements of the Hessian that are not always 0, row after row: the column of each, and its row in the block
     * with second derivatives; [2n] the index of the element at which each row ends. */
    const int *column, *slot, *row_end;
    node_matrix L_vv;
    /* Inverts L_vv with row exchanges, where elimination without them fails: tvi_galerkin_invert_by_exchanges of
     * forms.c. Generated code, too, calls it with arrays of the library (by_exchanges, L_vv_factor). If it passed the
     * address of a local array, a compiler would have to assume that other pointers may point to that array. */
    bool (*invert_by_exchanges)(const node_matrix *matrix, int lanes, void *lu_factor);
    const node_matrix *by_exchanges;
    void *L_vv_factor; /* the tvi_lu_factor of one node after the other */
    long inversions;   /* the number of times that L_vv was inverted at all nodes */
    /* The movement of the last pass, a sum of squares; INFINITY before the first pass of a step. */
    double last_movement;
} lagrangian_pass;

/* ---- Matrices at the nodes --------------------------------------------------------------------------------------- */

/* Returns |x|, and 0 for a NaN. */
JET_INLINE node_vec node_size(node_vec x) { return node_larger(node_larger(x, -x), (node_vec){0}); }

/* Inverts the matrix of each lane by Gauss-Jordan elimination without row exchanges. Returns false, with `inverse`
 * undefined, if some pivot is much smaller or larger than the diagonal element in its place, or a NaN. */
JET_INLINE bool invert_matrix_of_each_lane(const node_matrix *all, const int lanes)
{
    const int n = all->n;
    double worst[GALERKIN_MAX_LANES];
    bool is_safe = true;
    memcpy(all->inverse, all->matrix, (size_t)(n * n * lanes) * sizeof *all->matrix);
    for (int i = 0; i < lanes; i++) worst[i] = -INFINITY;
    for (int j = 0; j < n; j++) {
        double *const row = all->inverse + j * n * lanes;
        for (int v = 0; v < lanes / NODE_VEC; v++) {
            const node_vec inverse = 1 / node_load(row + j * lanes, v),
                           part = node_size(node_load(all->matrix + (j * n + j) * lanes, v) * inverse);
            const node_vec excess =
                node_larger(LINEAR_MIN_PIVOT_OF_INVERSE - part, part - 1 / LINEAR_MIN_PIVOT_OF_INVERSE);
            node_store(worst, v, node_larger(excess, node_load(worst, v)));
            for (int k = 0; k < n; k++) node_store(row + k * lanes, v, node_load(row + k * lanes, v) * inverse);
            node_store(row + j * lanes, v, inverse);
        }
        for (int i = 0; i < n; i++) {
            double *const other = all->inverse + i * n * lanes;
            for (int v = 0; v < (i == j ? 0 : lanes / NODE_VEC); v++) {
                const node_vec part = node_load(other + j * lanes, v);
                node_store(other + j * lanes, v, (node_vec){0});
                for (int k = 0; k < n; k++)
                    node_store(other + k * lanes, v,
                               node_load(other + k * lanes, v) - part * node_load(row + k * lanes, v));
            }
        }
    }
    for (int i = 0; i < lanes; i++) is_safe &= worst[i] < 0;
    return is_safe;
}

NODE_LOOP bool nodes_invert(const node_matrix *matrix, int lane_count)
{
    bool is_safe;
    BY_LANES(lanes, lane_count, is_safe = invert_matrix_of_each_lane(matrix, lanes));
    return is_safe;
}

/* Sets the velocities V = centre_V + L_vv^-1 ((P - L_v) - L_v_change), [n][lanes] each. centre_V is V*, L_v is the
 * gradient by v at (Q*, V*), and L_v_change is L_vq (Q - Q*), its change to first order by the displacement of Q (head
 * of this file). */
JET_INLINE void correct_velocity_rows(const node_matrix *L_vv, const double *P, const double *L_v,
                                      const double *L_v_change, const double *centre_V, double *V, const int lanes)
{
    const int n = L_vv->n;
    double *const x = L_vv->scratch_column;
    for (int v = 0; v < n * lanes / NODE_VEC; v++)
        node_store(x, v, (node_load(P, v) - node_load(L_v, v)) - node_load(L_v_change, v));
    for (int i = 0; i < n; i++)
        for (int v = 0; v < lanes / NODE_VEC; v++) {
            node_vec sum = {0};
            for (int j = 0; j < n; j++)
                sum += node_load(L_vv->inverse + (i * n + j) * lanes, v) * node_load(x + j * lanes, v);
            node_store(V + i * lanes, v, node_load(centre_V + i * lanes, v) + sum);
        }
}

NODE_LOOP void nodes_correct_velocities(const node_matrix *L_vv, int lane_count, const double *P, const double *L_v,
                                        const double *L_v_change, const double *centre_V, double *V)
{
    BY_LANES(lanes, lane_count, correct_velocity_rows(L_vv, P, L_v, L_v_change, centre_V, V, lanes));
}

/* Sets the first n rows of `out` [2n][lanes] to L_q at the displaced point, to first order, and the last n rows to the
 * change of L_v by the displacement of q alone. Products are added before the gradient, which is larger. The outer loop
 * is unrolled: in generated code the elements are constants, and then all bounds of the inner loops are, too. */
JET_INLINE void linearise_rows(const lagrangian_pass *pass, int n, const double *block, double *out, const int lanes)
{
    JET_UNROLL(8) for (int i = 0; i < 2 * n; i++)
    {
        node_vec sum[MAX_VECTORS] = {0};
        for (int k = i > 0 ? pass->row_end[i - 1] : 0; k < pass->row_end[i]; k++) {
            const int column = pass->column[k], slot = pass->slot[k];
            for (int v = 0; v < (i >= n && column >= n ? 0 : lanes / NODE_VEC); v++)
                sum[v] += node_load(block + slot * lanes, v) * node_load(pass->displacement + column * lanes, v);
        }
        for (int v = 0; v < lanes / NODE_VEC; v++) {
            if (i < n) sum[v] += node_load(pass->gradient + i * lanes, v);
            node_store(out + i * lanes, v, sum[v]);
        }
    }
}

NODE_LOOP void nodes_linearise(const lagrangian_pass *pass, int n, int lane_count, const double *block, double *out)
{
    BY_LANES(lanes, lane_count, linearise_rows(pass, n, block, out, lanes));
}

/* ---- Movements --------------------------------------------------------------------------------------------------- */

/* Returns one half of the unknowns (Q, P) as nodes of their own: Q if `first` is 0, and P if it is n. */
static inline galerkin_nodes lagrangian_half(const galerkin_nodes *all, int first)
{
    galerkin_nodes half = *all;
    const int offset = first * half.lane_count;
    half.unknown_count = half.moving_count = half.n;
    half.x += offset;
    half.free_motion += offset;
    half.free_motion_low += offset;
    half.impulse += offset;
    half.start += first;
    half.scale += first;
    half.inverse_size += first;
    return half;
}

/* Moves P by the rates F. Returns the movement. */
static inline double lagrangian_move_p(const galerkin_nodes *nodes, const int rate_row[])
{
    const galerkin_nodes momenta = lagrangian_half(nodes, nodes->n);
    return nodes_move_by_rates(&momenta, nodes->x, rate_row + nodes->n, NULL);
}

/* Moves Q by the rates V. Returns the movement. */
static inline double lagrangian_move_q(const lagrangian_pass *pass, const galerkin_nodes *nodes, const int rate_row[])
{
    const galerkin_nodes positions = lagrangian_half(nodes, 0);
    return nodes_move_by_rates(&positions, nodes->x, rate_row, pass->q_moved);
}

/* Moves Q and P by the current rates V and F. */
static inline void lagrangian_move_by_rates(lagrangian_pass *pass, const galerkin_nodes *nodes, const int rate_row[])
{
    (void)lagrangian_move_p(nodes, rate_row);
    (void)lagrangian_move_q(pass, nodes, rate_row);
    pass->last_movement = INFINITY;
}

/* Predicts the rates from the impulses of earlier steps, and moves the unknowns by them. */
static inline void lagrangian_predict(lagrangian_pass *pass, const galerkin_nodes *nodes, const int rate_row[],
                                      const galerkin_extrapolation *by)
{
    nodes_predict(&pass->rates, by);
    lagrangian_move_by_rates(pass, nodes, rate_row);
}

/* ---- A pass ------------------------------------------------------------------------------------------------------ */

/* The square of a relative movement that is only roundoff. A pass makes at least LAGRANGIAN_MIN_ITERATIONS iterations,
 * and ends when an iteration moves the unknowns by no more than this number. */
#define LAGRANGIAN_ROUNDOFF_SQUARE (0.25 * DBL_EPSILON * DBL_EPSILON)

/* The points (Q*, V*) are the nodes with their last LAGRANGIAN_ROUNDED_BITS bits rounded away, so that the last passes
 * of a step use the same points. If the gradient were evaluated at the nodes themselves, its roundoff would change with
 * their last bits. The iteration would stop where that roundoff happens to be small, more often on the side from which
 * the nodes come, and the energy would drift. */
static inline void lagrangian_round(int count, const double *x, double *rounded)
{
    const uint64_t unit = UINT64_C(1) << LAGRANGIAN_ROUNDED_BITS;
    for (int i = 0; i < count; i++) {
        const uint64_t bits = (tvi_double_bits(x[i]) + unit / 2) & ~(unit - 1);
        memcpy(&rounded[i], &bits, sizeof bits);
    }
}

static inline bool lagrangian_evaluate(lagrangian_pass *pass, const galerkin_nodes *nodes,
                                       const galerkin_field_at_nodes *field, bool with_hessian)
{
    const int lanes = nodes->lane_count, half = nodes->n * lanes;
    lagrangian_round(half, nodes->x, field->block[false]);
    lagrangian_round(half, nodes->x + 2 * half, field->block[false] + half);
    const double *block = galerkin_evaluate_gradient(field, with_hessian);
    for (int i = 0; block && i < 2 * nodes->n; i++)
        memcpy(pass->gradient + i * lanes, block + field->slot[with_hessian][i] * lanes, (size_t)lanes * sizeof *block);
    return block != NULL;
}

/* Inverts L_vv at each node, from the second derivatives in the block. Returns TVI_ENONFINITE or TVI_ESINGULAR if it
 * fails. */
static inline tvi_status lagrangian_invert(lagrangian_pass *pass, int n, int lanes, const double *block)
{
    const size_t bytes = (size_t)(n * n * lanes) * sizeof *block;
    double *L_vv = pass->L_vv.matrix;
    memset(L_vv, 0, bytes);
    for (int i = n; i < 2 * n; i++)
        for (int k = pass->row_end[i - 1]; k < pass->row_end[i]; k++)
            if (pass->column[k] >= n)
                memcpy(L_vv + ((i - n) * n + pass->column[k] - n) * lanes, block + pass->slot[k] * lanes,
                       (size_t)lanes * sizeof *block);
    pass->inversions++;
    if (nodes_invert(&pass->L_vv, lanes)) return TVI_OK;
    memmove(pass->by_exchanges->matrix, L_vv, bytes);
    if (pass->invert_by_exchanges(pass->by_exchanges, lanes, pass->L_vv_factor)) {
        memmove(pass->L_vv.inverse, pass->by_exchanges->inverse, bytes);
        return TVI_OK;
    }
    for (int k = pass->row_end[n - 1]; k < pass->row_end[2 * n - 1]; k++)
        if (!tvi_all_finite(lanes, block + pass->slot[k] * lanes)) return TVI_ENONFINITE;
    return TVI_ESINGULAR;
}

/* Sets start_minus_q to the exact difference of q at the start and Q*, in two parts. */
static inline void lagrangian_set_start_minus_q(lagrangian_pass *pass, const galerkin_nodes *nodes, const double *Q)
{
    for (int v = 0; v < nodes->n * nodes->lane_count / NODE_VEC; v++) {
        const node_vec q = node_load(nodes->free_motion, v), rise = q - node_load(Q, v), less = q - rise;
        node_store(pass->start_minus_q[0], v, rise);
        node_store(pass->start_minus_q[1], v, (q - (rise + less)) + (less - node_load(Q, v)));
    }
}

/* Sets the rows F to L_q at Q and V, and the last n rows to the change of L_v by the displacement of Q, both to first
 * order. The displacement of Q is a sum of differences, which do not contain the rounding of Q. */
static inline void lagrangian_linearise(lagrangian_pass *pass, const galerkin_nodes *nodes,
                                        const galerkin_field_at_nodes *field)
{
    const int half = nodes->n * nodes->lane_count;
    const double *V = nodes->x + 2 * half, *centre_V = field->block[false] + half;
    double *moved = pass->displacement;
    for (int v = 0; v < half / NODE_VEC; v++) {
        node_store(moved, v,
                   (node_load(pass->start_minus_q[0], v) + node_load(pass->q_moved, v)) +
                       node_load(pass->start_minus_q[1], v));
        node_store(moved + half, v, node_load(V, v) - node_load(centre_V, v));
    }
    nodes_linearise(pass, nodes->n, nodes->lane_count, field->block[true], nodes->x + 3 * half);
}

/* Makes a pass: moves P, V and Q in turn by the linearised gradient, until the movement is roundoff. The movement is
 * the sum of the squares of the relative changes of P and Q. Returns TVI_EDOMAIN, TVI_ENONFINITE or TVI_ESINGULAR if
 * it fails. */
static inline tvi_status lagrangian_make_pass(lagrangian_pass *pass, const galerkin_nodes *nodes,
                                              const galerkin_field_at_nodes *field, const int rate_row[])
{
    const int n = nodes->n, lanes = nodes->lane_count, half = n * lanes, numbers = 2 * half;
    const bool is_new = !(pass->last_movement <= LAGRANGIAN_HESSIAN_MAX_MOVEMENT * numbers);
    if (!lagrangian_evaluate(pass, nodes, field, is_new)) return TVI_EDOMAIN;
    if (is_new) {
        const tvi_status inverted = lagrangian_invert(pass, n, lanes, field->block[true]);
        if (inverted != TVI_OK) return inverted;
    }
    double moved = pass->last_movement = 0;
    lagrangian_set_start_minus_q(pass, nodes, field->block[false]);
    for (int i = 0; i < LAGRANGIAN_MAX_ITERATIONS; i++) {
        if (i >= LAGRANGIAN_MIN_ITERATIONS && moved <= LAGRANGIAN_ROUNDOFF_SQUARE * numbers) break;
        lagrangian_linearise(pass, nodes, field);
        moved = lagrangian_move_p(nodes, rate_row);
        nodes_correct_velocities(&pass->L_vv, lanes, nodes->x + half, pass->gradient + half, nodes->x + 4 * half,
                                 field->block[false] + half, nodes->x + 2 * half);
        pass->last_movement += moved += lagrangian_move_q(pass, nodes, rate_row);
    }
    return TVI_OK;
}

#endif
