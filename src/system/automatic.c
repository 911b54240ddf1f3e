/* automatic.c - Records the automatic time scale g from the linear motion near a state (docs/adaptive.md). With G =
 * H_pp held constant, the linear motion is dq'' = C dq' + D dq, where
 *     A = H_pq,  C = A - G A^T G^-1 = G Omega,  D = -G (H_qq - A^T G^-1 A) = -G W,  Omega^T = -Omega,  W^T = W,
 * and g is defined by g^-4 = tr D^2 + (tr C^2)^2 / 4. A linear transformation of the coordinates makes G = diag(d).
 * Then
 *     tr D^2 = sum_ij d_i d_j W_ij^2,  -tr C^2 = sum_ij d_i d_j Omega_ij^2,  Omega_ij = A_ij / d_i - A_ji / d_j.
 * No term is negative if G is definite. If G is singular everywhere, g^-4 = tr (J H'')^4 / 2. */
#include "system/automatic.h"

#include <stdlib.h>

/* The matrices [n][n] of the linear motion near a state, as jets. W contains H_qq at first. */
typedef struct {
    int n;
    jet *G, *A, *W;
} linearised_motion;

static bool is_zero(jet x) { return !x.node && x.number == 0; }

/* Records *x + c y, and stores it in *x. */
static void add_multiple(jet *x, jet c, jet y)
{
    if (!is_zero(y)) *x = jet_add(*x, jet_mul(c, y));
}

/* ---- H'' --------------------------------------------------------------------------------------------------------- */

/* Records row[i] = d x / d z_i for z = (q, p). The inputs of the graph are q, t, p, e; `all` has room for the
 * derivatives by q, t and p. */
static bool record_gradient_in_q_p(jet_graph *graph, jet x, int n, jet all[], jet row[])
{
    const bool derived = jet_record_gradient(graph, x, 2 * n + 1, all);
    for (int i = 0; i < 2 * n; i++) row[i] = all[i < n ? i : i + 1];
    return derived;
}

/* Records the second derivatives of H in the three matrices. first [2n], row [2n] and all [2n + 1] are scratch. */
static bool record_second_derivatives(jet_graph *graph, jet H, const linearised_motion *motion, jet first[], jet row[],
                                      jet all[])
{
    const int n = motion->n;
    if (!record_gradient_in_q_p(graph, H, n, all, first)) return false;
    jet_graph_begin_derived_part(
        graph, "the automatic g, which has no value there (take a smaller step, or give a g of your own)");
    for (int i = 0; i < n; i++) {
        if (!record_gradient_in_q_p(graph, first[i], n, all, row)) return false;
        for (int j = 0; j < n; j++) motion->W[i * n + j] = row[j];
        if (!record_gradient_in_q_p(graph, first[n + i], n, all, row)) return false;
        for (int j = 0; j < n; j++) motion->A[i * n + j] = row[j];
        for (int j = 0; j <= i; j++) motion->G[i * n + j] = motion->G[j * n + i] = row[n + j];
    }
    return true;
}

/* ---- Where G is regular ------------------------------------------------------------------------------------------ */

/* Replaces coordinate i by q_i - l q_j. With the matrix E of this transformation, A becomes E A E^-1, and W becomes
 * E^-T W E^-1. */
static void change_coordinate(const linearised_motion *motion, int i, int j, jet l)
{
    const int n = motion->n;
    const jet negative_l = jet_neg(l);
    for (int k = 0; k < n; k++) add_multiple(&motion->A[i * n + k], negative_l, motion->A[j * n + k]);
    for (int k = 0; k < n; k++) add_multiple(&motion->A[k * n + j], l, motion->A[k * n + i]);
    for (int k = 0; k < n; k++) add_multiple(&motion->W[k * n + j], l, motion->W[k * n + i]);
    for (int k = 0; k < n; k++) add_multiple(&motion->W[j * n + k], l, motion->W[i * n + k]);
}

/* Makes G = diag(d) by elimination below the diagonal, and transforms the other matrices. The entries above the
 * diagonal are not used any more. */
static void diagonalise_G(const linearised_motion *motion)
{
    const int n = motion->n;
    for (int j = 0; j < n; j++)
        for (int i = j + 1; i < n; i++) {
            jet *row = motion->G + i * n;
            if (is_zero(row[j])) continue;
            const jet l = jet_div(row[j], motion->G[j * n + j]), negative_l = jet_neg(l);
            for (int k = j + 1; k <= i; k++) add_multiple(&row[k], negative_l, motion->G[k * n + j]);
            change_coordinate(motion, i, j, l);
        }
}

/* Computes W = H_qq - A^T G^-1 A, except for the terms A_ii^2 / d_i of the diagonal. stiffness_term adds them
 * without a division, which a system with one degree of freedom then does not need at all. */
static void subtract_gyroscopic(const linearised_motion *motion)
{
    const int n = motion->n;
    for (int k = 0; k < n; k++)
        for (int i = 0; i < n; i++) {
            const jet *row = motion->A + k * n;
            if (is_zero(row[i])) continue;
            for (int j = 0; j <= i; j++)
                if (!is_zero(row[j]) && (i != k || j != k))
                    motion->W[i * n + j] =
                        jet_sub(motion->W[i * n + j], jet_div(jet_mul(row[i], row[j]), motion->G[k * n + k]));
        }
}

/* Records the term d_i d_j W_ij^2 of tr D^2. */
static jet stiffness_term(const linearised_motion *motion, int i, int j)
{
    const int n = motion->n;
    const jet d = motion->G[i * n + i], W = motion->W[i * n + j];
    if (i == j) return jet_sqr(jet_sub(jet_mul(d, W), jet_sqr(motion->A[i * n + i])));
    return jet_mul(jet_mul(d, motion->G[j * n + j]), jet_sqr(W));
}

/* Records the term d_i d_j Omega_ij^2 of -tr C^2. */
static jet gyroscopic_term(const linearised_motion *motion, int i, int j)
{
    const int n = motion->n;
    const jet A = motion->A[i * n + j], B = motion->A[j * n + i], d = motion->G[i * n + i], e = motion->G[j * n + j];
    if (is_zero(A) && is_zero(B)) return A;
    return jet_mul(jet_mul(d, e), jet_sqr(jet_sub(jet_div(A, d), jet_div(B, e))));
}

/* Records the sum of term(i, j) over all i and j, for a term that is symmetric in i and j. terms [n^2] is scratch. */
static jet sum_symmetric(const linearised_motion *motion, jet term(const linearised_motion *, int, int), jet terms[])
{
    int count = 0;
    for (int i = 0; i < motion->n; i++)
        for (int j = 0; j <= i; j++) terms[count++] = jet_mul(i == j ? 1 : 2, term(motion, i, j));
    return jet_sum(terms, count);
}

static jet record_sum_for_regular_G(const linearised_motion *motion, jet terms[])
{
    diagonalise_G(motion);
    subtract_gyroscopic(motion);
    const jet square = sum_symmetric(motion, stiffness_term, terms);
    return jet_add(square, jet_mul(0.25, jet_sqr(sum_symmetric(motion, gyroscopic_term, terms))));
}

/* ---- Where it is not --------------------------------------------------------------------------------------------- */

/* Records the entry (i, j) of the matrix product x y. */
static jet product_entry(int n, const jet x[], const jet y[], int i, int j)
{
    jet sum = jet_const(0);
    for (int k = 0; k < n; k++) sum = jet_add(sum, jet_mul(x[i * n + k], y[k * n + j]));
    return sum;
}

/* Records the term P_ij P_ji + Q_ij R_ji of tr (J H'')^4 / 2. Here (J H'')^2 has the blocks P, Q; R, P^T with P =
 * A^2 - G W, Q = A G - (A G)^T, R = (W A)^T - W A. */
static jet hessian_power_term(const linearised_motion *motion, int i, int j)
{
    const int n = motion->n;
    const jet *A = motion->A, *G = motion->G, *W = motion->W;
    const jet P = jet_sub(product_entry(n, A, A, i, j), product_entry(n, G, W, i, j));
    const jet Pt = jet_sub(product_entry(n, A, A, j, i), product_entry(n, G, W, j, i));
    const jet Q = jet_sub(product_entry(n, A, G, i, j), product_entry(n, A, G, j, i));
    const jet R = jet_sub(product_entry(n, W, A, i, j), product_entry(n, W, A, j, i));
    return jet_add(jet_mul(P, Pt), jet_mul(Q, R));
}

/* ------------------------------------------------------------------------------------------------------------------ */

jet tvi_record_automatic_scale(const tvi_system *base, jet H)
{
    const size_t n = (size_t)base->n;
    jet_graph *graph;
    const jet refused = jet_find_graph_or_poison(1, &H, &graph);
    if (refused.node) return refused;
    jet *jets = malloc((4 * n * n + 6 * n + 1) * sizeof *jets), sum = jet_make_poison(JET_NO_MEMORY);
    if (!jets) return sum;
    const linearised_motion motion = {base->n, jets, jets + n * n, jets + 2 * n * n};
    jet *terms = jets + 3 * n * n, *first = terms + n * n, *row = first + 2 * n, *all = row + 2 * n;
    if (!graph) sum = jet_const(0); /* H is a number. */
    else if (record_second_derivatives(graph, H, &motion, first, row, all))
        sum = base->regular ? record_sum_for_regular_G(&motion, terms)
                            : sum_symmetric(&motion, hessian_power_term, terms);
    free(jets);
    return jet_pow(sum, -0.25);
}
