/* automatic.c - Records the automatic time scale g for a system whose user gives none. Near a state, with G = H_pp as
 * it is there, the motion is dq'' = C dq' + D dq, where
 *     A = H_pq,  C = A - G A^T G^-1 = G Omega,  D = -G (H_qq - A^T G^-1 A) = -G W,  Omega^T = -Omega,  W^T = W,
 * and g^-4 = tr D^2 + (tr C^2)^2 / 4. A linear point transformation makes G = diag(d), and then
 *     tr D^2 = sum_ij d_i d_j W_ij^2,  -tr C^2 = sum_ij d_i d_j Omega_ij^2,  Omega_ij = A_ij / d_i - A_ji / d_j,
 * of which no term is negative if G is definite. If G is singular everywhere, g^-4 = tr (J H'')^4 / 2. */
#include "system/automatic.h"

#include <stdlib.h>

/* The matrices [n][n] of the motion near one state; W holds H_qq at first. */
typedef struct {
    int n;
    jet *G, *A, *W;
} linearised;

static bool is_zero(jet x) { return !x.node && x.number == 0; }

/* *x <- *x + c y */
static void add_multiple(jet *x, jet c, jet y)
{
    if (!is_zero(y)) *x = jet_add(*x, jet_mul(c, y));
}

/* ---- H'' --------------------------------------------------------------------------------------------------------- */

/* Computes row[i] = d x / d z_i, z = (q, p), in a recording whose inputs are q, t, p, e. */
static bool gradient(jet_graph *graph, jet x, int n, jet all[], jet row[])
{
    const bool derived = jet_gradient(graph, x, 2 * n + 1, all);
    for (int i = 0; i < 2 * n; i++) row[i] = all[i < n ? i : i + 1];
    return derived;
}

/* Records the second derivatives of H. first [2n], row [2n] and all [2n + 1] are scratch. */
static bool second_derivatives(jet_graph *graph, jet H, const linearised *at, jet first[], jet row[], jet all[])
{
    const int n = at->n;
    if (!gradient(graph, H, n, all, first)) return false;
    jet_graph_name_part(graph,
                        "the automatic g, which has no value there (take a smaller step, or give a g of your own)");
    for (int i = 0; i < n; i++) {
        if (!gradient(graph, first[i], n, all, row)) return false;
        for (int j = 0; j < n; j++) at->W[i * n + j] = row[j];
        if (!gradient(graph, first[n + i], n, all, row)) return false;
        for (int j = 0; j < n; j++) at->A[i * n + j] = row[j];
        for (int j = 0; j <= i; j++) at->G[i * n + j] = at->G[j * n + i] = row[n + j];
    }
    return true;
}

/* ---- Where G is regular ------------------------------------------------------------------------------------------ */

/* Replaces coordinate i by q_i - l q_j: A -> E A E^-1, W -> E^-T W E^-1. */
static void shear(const linearised *at, int i, int j, jet l)
{
    const int n = at->n;
    const jet less = jet_neg(l);
    for (int k = 0; k < n; k++) add_multiple(&at->A[i * n + k], less, at->A[j * n + k]);
    for (int k = 0; k < n; k++) add_multiple(&at->A[k * n + j], l, at->A[k * n + i]);
    for (int k = 0; k < n; k++) add_multiple(&at->W[k * n + j], l, at->W[k * n + i]);
    for (int k = 0; k < n; k++) add_multiple(&at->W[j * n + k], l, at->W[i * n + k]);
}

/* Makes G = diag(d) by elimination below the diagonal. The part above it is not used any more. */
static void make_diagonal(const linearised *at)
{
    const int n = at->n;
    for (int j = 0; j < n; j++)
        for (int i = j + 1; i < n; i++) {
            jet *row = at->G + i * n;
            if (is_zero(row[j])) continue;
            const jet l = jet_div(row[j], at->G[j * n + j]), less = jet_neg(l);
            for (int k = j + 1; k <= i; k++) add_multiple(&row[k], less, at->G[k * n + j]);
            shear(at, i, j, l);
        }
}

/* Computes W = H_qq - A^T G^-1 A without A_ii^2 / d_i, so that one degree of freedom needs no division. */
static void subtract_gyroscopic(const linearised *at)
{
    const int n = at->n;
    for (int k = 0; k < n; k++)
        for (int i = 0; i < n; i++) {
            const jet *row = at->A + k * n;
            if (is_zero(row[i])) continue;
            for (int j = 0; j <= i; j++)
                if (!is_zero(row[j]) && (i != k || j != k))
                    at->W[i * n + j] = jet_sub(at->W[i * n + j], jet_div(jet_mul(row[i], row[j]), at->G[k * n + k]));
        }
}

/* The term d_i d_j W_ij^2. */
static jet stiffness_term(const linearised *at, int i, int j)
{
    const int n = at->n;
    const jet d = at->G[i * n + i], W = at->W[i * n + j];
    if (i == j) return jet_sqr(jet_sub(jet_mul(d, W), jet_sqr(at->A[i * n + i])));
    return jet_mul(jet_mul(d, at->G[j * n + j]), jet_sqr(W));
}

/* The term d_i d_j Omega_ij^2. */
static jet gyroscopic_term(const linearised *at, int i, int j)
{
    const int n = at->n;
    const jet A = at->A[i * n + j], B = at->A[j * n + i], d = at->G[i * n + i], e = at->G[j * n + j];
    if (is_zero(A) && is_zero(B)) return A;
    return jet_mul(jet_mul(d, e), jet_sqr(jet_sub(jet_div(A, d), jet_div(B, e))));
}

/* Sums a symmetric term over i and j; terms [n^2] is scratch. */
static jet sum_symmetric(const linearised *at, jet term(const linearised *, int, int), jet terms[])
{
    int count = 0;
    for (int i = 0; i < at->n; i++)
        for (int j = 0; j <= i; j++) terms[count++] = jet_mul(i == j ? 1 : 2, term(at, i, j));
    return jet_sum(terms, count);
}

static jet of_regular(const linearised *at, jet terms[])
{
    make_diagonal(at);
    subtract_gyroscopic(at);
    const jet square = sum_symmetric(at, stiffness_term, terms);
    return jet_add(square, jet_mul(0.25, jet_sqr(sum_symmetric(at, gyroscopic_term, terms))));
}

/* ---- Where it is not --------------------------------------------------------------------------------------------- */

/* The entry (x y)_ij of a product of matrices. */
static jet product_entry(int n, const jet x[], const jet y[], int i, int j)
{
    jet sum = jet_const(0);
    for (int k = 0; k < n; k++) sum = jet_add(sum, jet_mul(x[i * n + k], y[k * n + j]));
    return sum;
}

/* The term P_ij P_ji + Q_ij R_ji of tr (J H'')^4 / 2, where (J H'')^2 = (P, Q; R, P^T), P = A^2 - G W, Q = A G - (A
 * G)^T, R = (W A)^T - W A. */
static jet general_term(const linearised *at, int i, int j)
{
    const int n = at->n;
    const jet *A = at->A, *G = at->G, *W = at->W;
    const jet P = jet_sub(product_entry(n, A, A, i, j), product_entry(n, G, W, i, j));
    const jet Pt = jet_sub(product_entry(n, A, A, j, i), product_entry(n, G, W, j, i));
    const jet Q = jet_sub(product_entry(n, A, G, i, j), product_entry(n, A, G, j, i));
    const jet R = jet_sub(product_entry(n, W, A, i, j), product_entry(n, W, A, j, i));
    return jet_add(jet_mul(P, Pt), jet_mul(Q, R));
}

/* ------------------------------------------------------------------------------------------------------------------ */

jet tvi_automatic_scale(const tvi_system *base, jet H)
{
    const size_t n = (size_t)base->n;
    jet_graph *graph;
    const jet refused = jet_graph_of(1, &H, &graph);
    if (refused.node) return refused;
    jet *jets = malloc((4 * n * n + 6 * n + 1) * sizeof *jets), sum = jet_poison(JET_NO_MEMORY);
    if (!jets) return sum;
    const linearised at = {base->n, jets, jets + n * n, jets + 2 * n * n};
    jet *terms = jets + 3 * n * n, *first = terms + n * n, *row = first + 2 * n, *all = row + 2 * n;
    if (!graph) sum = jet_const(0); /* H is a number */
    else if (second_derivatives(graph, H, &at, first, row, all))
        sum = base->regular ? of_regular(&at, terms) : sum_symmetric(&at, general_term, terms);
    free(jets);
    return jet_pow(sum, -0.25);
}
