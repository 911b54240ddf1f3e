/* automatic.c - Records the automatic time scale g = dt/ds of a rescaled system whose user gives none
 * (docs/adaptive.md). rescaled.c calls it. The scale follows from the linear motion near a state, and thus from H'',
 * the second derivatives of the Hamiltonian H, with the blocks H_qq, A = H_pq and H_pp. If H_pp is held constant, a
 * small change dq of the coordinates moves by dq'' = C dq' + D dq, where
 *     C = A - H_pp A^T H_pp^-1 = H_pp Omega,  Omega^T = -Omega,
 *     D = -H_pp (H_qq - A^T H_pp^-1 A) = -H_pp W,  W^T = W.
 * If H_pp is regular, g is defined by g^-4 = tr D^2 + (tr C^2)^2 / 4. A linear transformation of the coordinates makes
 * H_pp = diag(d_1, ..., d_n). Then
 *     tr D^2 = sum_ij d_i d_j W_ij^2,  -tr C^2 = sum_ij d_i d_j Omega_ij^2,  Omega_ij = A_ij / d_i - A_ji / d_j.
 * No term of these sums is negative if H_pp is definite. If H_pp is singular everywhere, g is defined by g^-4 = tr (J
 * H'')^4 / 2 with J = [0 I; -I 0]. */
#include "system/system.h"

#include <stdlib.h>

/* The matrices [n][n] of the linear motion near a state, as jets: H_pp, A = H_pq, and W. record_second_derivatives sets
 * W to H_qq, and reduce_H_qq_to_W makes it H_qq - A^T H_pp^-1 A. */
typedef struct {
    int n;
    jet *H_pp, *A, *W;
} linearised_motion;

/* Records *x + c y, and stores it in *x. It records nothing if y is 0. */
static void add_multiple(jet *x, jet c, jet y)
{
    if (!jet_is_zero(y)) *x = jet_add(*x, jet_mul(c, y));
}

/* ---- H'' --------------------------------------------------------------------------------------------------------- */

/* Records the second derivatives of H: H_pp, A = H_pq, and H_qq in W. The inputs of the graph are q, t, p, e. gradient
 * and row [2n + 1] are scratch. */
static bool record_second_derivatives(jet_graph *graph, jet H, const linearised_motion *motion, jet gradient[],
                                      jet row[])
{
    const int n = motion->n, first_p = n + 1, inputs = 2 * n + 1;
    if (!jet_record_gradient(graph, H, inputs, gradient)) return false;
    jet_graph_begin_library_nodes(
        graph, "the automatic g, which has no value there (take a smaller step, or give a g of your own)");
    for (int i = 0; i < n; i++) {
        if (!jet_record_gradient(graph, gradient[i], inputs, row)) return false;
        for (int j = 0; j < n; j++) motion->W[i * n + j] = row[j];
        if (!jet_record_gradient(graph, gradient[first_p + i], inputs, row)) return false;
        for (int j = 0; j < n; j++) motion->A[i * n + j] = row[j];
        for (int j = 0; j <= i; j++) motion->H_pp[i * n + j] = motion->H_pp[j * n + i] = row[first_p + j];
    }
    return true;
}

/* ---- H_pp is regular --------------------------------------------------------------------------------------------- */

/* Replaces coordinate q_i by q_i - subtracted_q_j_factor q_j. With the matrix E of this transformation, A = H_pq
 * becomes E A E^-1, and W, which is still H_qq, becomes E^-T W E^-1. */
static void change_coordinate_q_i(const linearised_motion *motion, int i, int j, jet subtracted_q_j_factor)
{
    const int n = motion->n;
    const jet negative_factor = jet_neg(subtracted_q_j_factor);
    for (int k = 0; k < n; k++) add_multiple(&motion->A[i * n + k], negative_factor, motion->A[j * n + k]);
    for (int k = 0; k < n; k++) add_multiple(&motion->A[k * n + j], subtracted_q_j_factor, motion->A[k * n + i]);
    for (int k = 0; k < n; k++) add_multiple(&motion->W[k * n + j], subtracted_q_j_factor, motion->W[k * n + i]);
    for (int k = 0; k < n; k++) add_multiple(&motion->W[j * n + k], subtracted_q_j_factor, motion->W[i * n + k]);
}

/* Makes H_pp = diag(d) by elimination below the diagonal, and transforms A and W in the same way. The entries of H_pp
 * above its diagonal are not used any more. */
static void diagonalise_H_pp(const linearised_motion *motion)
{
    const int n = motion->n;
    for (int j = 0; j < n; j++)
        for (int i = j + 1; i < n; i++) {
            jet *row = motion->H_pp + i * n;
            if (jet_is_zero(row[j])) continue;
            const jet l = jet_div(row[j], motion->H_pp[j * n + j]), negative_l = jet_neg(l);
            for (int k = j + 1; k <= i; k++) add_multiple(&row[k], negative_l, motion->H_pp[k * n + j]);
            change_coordinate_q_i(motion, i, j, l);
        }
}

/* Subtracts A^T H_pp^-1 A from W = H_qq for H_pp = diag(d), except for the terms A_ii^2 / d_i of the diagonal.
 * record_D2_trace_summand adds these terms without a division. A system with one degree of freedom then needs no
 * division at all. */
static void reduce_H_qq_to_W(const linearised_motion *motion)
{
    const int n = motion->n;
    for (int k = 0; k < n; k++)
        for (int i = 0; i < n; i++) {
            const jet *row = motion->A + k * n;
            if (jet_is_zero(row[i])) continue;
            for (int j = 0; j <= i; j++)
                if (!jet_is_zero(row[j]) && (i != k || j != k))
                    motion->W[i * n + j] =
                        jet_sub(motion->W[i * n + j], jet_div(jet_mul(row[i], row[j]), motion->H_pp[k * n + k]));
        }
}

/* Records the term d_i d_j W_ij^2 of tr D^2. */
static jet record_D2_trace_summand(const linearised_motion *motion, int i, int j)
{
    const int n = motion->n;
    const jet d = motion->H_pp[i * n + i], W = motion->W[i * n + j];
    if (i == j) return jet_sqr(jet_sub(jet_mul(d, W), jet_sqr(motion->A[i * n + i])));
    return jet_mul(jet_mul(d, motion->H_pp[j * n + j]), jet_sqr(W));
}

/* Records the term d_i d_j Omega_ij^2 of -tr C^2. */
static jet record_C2_trace_summand(const linearised_motion *motion, int i, int j)
{
    const int n = motion->n;
    const jet A = motion->A[i * n + j], B = motion->A[j * n + i], d = motion->H_pp[i * n + i],
              e = motion->H_pp[j * n + j];
    if (jet_is_zero(A) && jet_is_zero(B)) return A;
    return jet_mul(jet_mul(d, e), jet_sqr(jet_sub(jet_div(A, d), jet_div(B, e))));
}

/* Records the sum over all i and j of summand(i, j), which is symmetric in i and j. scratch has n^2 jets. */
static jet record_sum_over_symmetric_terms(const linearised_motion *motion,
                                           jet summand(const linearised_motion *, int, int), jet scratch[])
{
    int count = 0;
    for (int i = 0; i < motion->n; i++)
        for (int j = 0; j <= i; j++) scratch[count++] = jet_mul(i == j ? 1 : 2, summand(motion, i, j));
    return jet_sum(scratch, count);
}

/* Records tr D^2 + (tr C^2)^2 / 4, which is g^-4 if H_pp is regular. */
static jet record_regular_trace_sum(const linearised_motion *motion, jet scratch[])
{
    diagonalise_H_pp(motion);
    reduce_H_qq_to_W(motion);
    const jet square = record_sum_over_symmetric_terms(motion, record_D2_trace_summand, scratch);
    return jet_add(square,
                   jet_mul(0.25, jet_sqr(record_sum_over_symmetric_terms(motion, record_C2_trace_summand, scratch))));
}

/* ---- H_pp is singular everywhere --------------------------------------------------------------------------------- */

/* Records the entry (i, j) of the matrix product x y. */
static jet record_matrix_product_entry(int n, const jet x[], const jet y[], int i, int j)
{
    jet sum = jet_const(0);
    for (int k = 0; k < n; k++) sum = jet_add(sum, jet_mul(x[i * n + k], y[k * n + j]));
    return sum;
}

/* Records P_ij P_ji + Q_ij R_ji, the summand of tr (J H'')^4 / 2 for i and j, where (J H'')^2 is [P Q; R P^T] with P
 * = A^2 - H_pp W, Q = A H_pp - (A H_pp)^T, R = (W A)^T - W A, and W = H_qq. */
static jet record_JH4_trace_summand(const linearised_motion *motion, int i, int j)
{
    const int n = motion->n;
    const jet *A = motion->A, *H_pp = motion->H_pp, *W = motion->W;
    const jet P = jet_sub(record_matrix_product_entry(n, A, A, i, j), record_matrix_product_entry(n, H_pp, W, i, j));
    const jet Pt = jet_sub(record_matrix_product_entry(n, A, A, j, i), record_matrix_product_entry(n, H_pp, W, j, i));
    const jet Q = jet_sub(record_matrix_product_entry(n, A, H_pp, i, j), record_matrix_product_entry(n, A, H_pp, j, i));
    const jet R = jet_sub(record_matrix_product_entry(n, W, A, i, j), record_matrix_product_entry(n, W, A, j, i));
    return jet_add(jet_mul(P, Pt), jet_mul(Q, R));
}

/* ------------------------------------------------------------------------------------------------------------------ */

jet tvi_record_automatic_time_scale(const tvi_system *base, jet H)
{
    const size_t n = (size_t)base->n;
    jet_graph *graph;
    const jet refused = jet_find_common_graph_or_poison(1, &H, &graph);
    if (refused.node) return refused;
    jet *jets = malloc((4 * n * n + 4 * n + 2) * sizeof *jets), sum = jet_make_poison(JET_NO_MEMORY);
    if (!jets) return sum;
    const linearised_motion motion = {base->n, jets, jets + n * n, jets + 2 * n * n};
    jet *scratch = jets + 3 * n * n, *gradient = scratch + n * n, *row = gradient + 2 * n + 1;
    if (!graph) sum = jet_const(0); /* H depends on no input, and its derivatives are 0. */
    else if (record_second_derivatives(graph, H, &motion, gradient, row))
        sum = base->is_regular ? record_regular_trace_sum(&motion, scratch)
                               : record_sum_over_symmetric_terms(&motion, record_JH4_trace_summand, scratch);
    free(jets);
    return jet_pow(sum, -0.25);
}
