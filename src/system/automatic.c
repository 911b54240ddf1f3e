/* automatic.c - the automatic g. Near a state, with G = H_pp as it is there, the motion is dq'' = C dq' + D dq, where
 *     A = H_pq,  C = A - G A^T G^-1 = G Omega,  D = -G (H_qq - A^T G^-1 A) = -G W,  Omega^T = -Omega,  W^T = W,
 * and g^-4 = tr D^2 + (tr C^2)^2 / 4. A linear point transformation makes G = diag(d), and then
 *     tr D^2 = sum_ij d_i d_j W_ij^2,  -tr C^2 = sum_ij d_i d_j Omega_ij^2,  Omega_ij = A_ij / d_i - A_ji / d_j,
 * of which no term is negative where G is definite. Where G is singular everywhere, g^-4 = tr (J H'')^4 / 2. */
#include "system/automatic.h"

#include <stdlib.h>

/* [n][n] each, of one state; W = H_qq at first. */
typedef struct {
    int n;
    jet *G, *A, *W;
} linearised;

static bool is_zero(jet x) { return !x.node && x.number == 0; }

/* *x + c y */
static void add_multiple(jet *x, jet c, jet y)
{
    if (!is_zero(y)) *x = jet_add(*x, jet_mul(c, y));
}

/* ---- H'' --------------------------------------------------------------------------------------------------------- */

/* row[i] = d x / d z_i, z = (q, p), of a recording whose inputs are q, t, p, e. */
static bool gradient(jet_graph *graph, jet x, int n, jet all[], jet row[])
{
    const bool derived = jet_gradient(graph, x, 2 * n + 1, all);
    for (int i = 0; i < 2 * n; i++) row[i] = all[i < n ? i : i + 1];
    return derived;
}

/* first, row [2n], all [2n + 1] are scratch. */
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

/* Coordinate i becomes q_i - l q_j: A -> E A E^-1, W -> E^-T W E^-1. */
static void turn(const linearised *at, int i, int j, jet l)
{
    const int n = at->n;
    const jet less = jet_neg(l);
    for (int k = 0; k < n; k++) add_multiple(&at->A[i * n + k], less, at->A[j * n + k]);
    for (int k = 0; k < n; k++) add_multiple(&at->A[k * n + j], l, at->A[k * n + i]);
    for (int k = 0; k < n; k++) add_multiple(&at->W[k * n + j], l, at->W[k * n + i]);
    for (int k = 0; k < n; k++) add_multiple(&at->W[j * n + k], l, at->W[i * n + k]);
}

/* G = diag(d), by elimination below the diagonal; what is above is not looked at any more. */
static void make_diagonal(const linearised *at)
{
    const int n = at->n;
    for (int j = 0; j < n; j++)
        for (int i = j + 1; i < n; i++) {
            jet *row = at->G + i * n;
            if (is_zero(row[j])) continue;
            const jet l = jet_div(row[j], at->G[j * n + j]), less = jet_neg(l);
            for (int k = j + 1; k <= i; k++) add_multiple(&row[k], less, at->G[k * n + j]);
            turn(at, i, j, l);
        }
}

/* W = H_qq - A^T G^-1 A, but for A_ii^2 / d_i: one degree of freedom need not divide. */
static void subtract_turning(const linearised *at)
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

/* d_i d_j W_ij^2. */
static jet pull(const linearised *at, int i, int j)
{
    const int n = at->n;
    const jet d = at->G[i * n + i], W = at->W[i * n + j];
    if (i == j) return jet_sqr(jet_sub(jet_mul(d, W), jet_sqr(at->A[i * n + i])));
    return jet_mul(jet_mul(d, at->G[j * n + j]), jet_sqr(W));
}

/* d_i d_j Omega_ij^2. */
static jet turning(const linearised *at, int i, int j)
{
    const int n = at->n;
    const jet A = at->A[i * n + j], B = at->A[j * n + i], d = at->G[i * n + i], e = at->G[j * n + j];
    if (is_zero(A) && is_zero(B)) return A;
    return jet_mul(jet_mul(d, e), jet_sqr(jet_sub(jet_div(A, d), jet_div(B, e))));
}

/* sum_ij of what is symmetric; terms [n^2] is scratch. */
static jet sum_of(const linearised *at, jet term(const linearised *, int, int), jet terms[])
{
    int count = 0;
    for (int i = 0; i < at->n; i++)
        for (int j = 0; j <= i; j++) terms[count++] = jet_mul(i == j ? 1 : 2, term(at, i, j));
    return jet_sum(terms, count);
}

static jet of_regular(const linearised *at, jet terms[])
{
    make_diagonal(at);
    subtract_turning(at);
    const jet square = sum_of(at, pull, terms);
    return jet_add(square, jet_mul(0.25, jet_sqr(sum_of(at, turning, terms))));
}

/* ---- Where it is not --------------------------------------------------------------------------------------------- */

/* (x y)_ij */
static jet product(int n, const jet x[], const jet y[], int i, int j)
{
    jet sum = jet_const(0);
    for (int k = 0; k < n; k++) sum = jet_add(sum, jet_mul(x[i * n + k], y[k * n + j]));
    return sum;
}

/* (J H'')^2 = (P, Q; R, P^T), P = A^2 - G W, Q = A G - (A G)^T, R = (W A)^T - W A: P_ij P_ji + Q_ij R_ji. */
static jet of_field(const linearised *at, int i, int j)
{
    const int n = at->n;
    const jet *A = at->A, *G = at->G, *W = at->W;
    const jet P = jet_sub(product(n, A, A, i, j), product(n, G, W, i, j));
    const jet Pt = jet_sub(product(n, A, A, j, i), product(n, G, W, j, i));
    const jet Q = jet_sub(product(n, A, G, i, j), product(n, A, G, j, i));
    const jet R = jet_sub(product(n, W, A, i, j), product(n, W, A, j, i));
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
        sum = base->regular ? of_regular(&at, terms) : sum_of(&at, of_field, terms);
    free(jets);
    return jet_pow(sum, -0.25);
}
