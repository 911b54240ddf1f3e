/* definition.c - Implements definition.h. */
#include "definition.h"

#include <math.h>
#include <string.h>

/* ---- The action -------------------------------------------------------------------------------------------------- */

/* The values that a method asks of z: the ends of the curve, and S. */
enum { FROM_Q = 0, TO_Q = n, FROM_P = 2 * n, TO_P = 3 * n, ACTION = 4 * n, Y = ACTION + 1 };

static real action_at_node(const method *m, const curve *g, int node)
{
    const bool truncated = m->k->nodes == TVI_NODES_TRUNCATED, poincare = m->k->method == TVI_POINCARE;
    const real c = m->nodes->c[node], s = (c - m->centre) * m->h, t = m->t + c * m->h;
    const int q_degree = truncated && c != 0 && c != 1 ? m->degree - 1 : m->degree;
    real q[n], v[n], p[n], H_p[n];
    for (int i = 0; i < n; i++) {
        q[i] = series_value(&g->q[i], q_degree, s);
        v[i] = series_slope(&g->q[i], m->degree, s);
        p[i] = series_value(&g->p[i], poincare ? m->degree : m->degree - 1, s);
    }
    if (m->k->method == TVI_TYPE1) return law_lagrangian(m->l, q, v, t);
    real S = -law_hamiltonian(m->l, q, p, t, H_p);
    for (int i = 0; i < n; i++) S += p[i] * (truncated ? H_p[i] : v[i]);
    return S;
}

static void shape(const method *m, const real z[], real y[])
{
    const curve g = law_expand(m->l, m->t + m->centre * m->h, z, z + n, m->k->method == TVI_TYPE1);
    const real from = -m->centre * m->h, to = from + m->h;
    const int p_degree = m->k->method == TVI_POINCARE ? m->degree : m->degree - 1;
    for (int i = 0; i < n; i++) {
        y[FROM_Q + i] = series_value(&g.q[i], m->degree, from);
        y[TO_Q + i] = series_value(&g.q[i], m->degree, to);
        y[FROM_P + i] = series_value(&g.p[i], p_degree, from);
        y[TO_P + i] = series_value(&g.p[i], p_degree, to);
    }
    y[ACTION] = 0;
    for (int node = 0; node < m->nodes->points; node++)
        y[ACTION] += m->h * m->nodes->b[node] * action_at_node(m, &g, node);
}

/* Differences of order 8: J[row][column] = dy_row/dz_column. */
typedef void vector_function(const void *self, const real z[], real y[]);
enum { STENCIL = 4, ROWS_MAX = 17, COLUMNS_MAX = 8 };

static void differentiate(vector_function *f, const void *self, int rows, int columns, const real at[],
                          real J[ROWS_MAX][COLUMNS_MAX])
{
    const real d = 0x1p-8L; /* z + s d and its multiples are exact */
    real z[COLUMNS_MAX], y[ROWS_MAX];
    memcpy(z, at, (size_t)columns * sizeof *z);
    for (int column = 0; column < columns; column++) {
        for (int row = 0; row < rows; row++) J[row][column] = 0;
        for (int s = -STENCIL; s <= STENCIL; s++) {
            if (s == 0) continue;
            real weight = 1 / (2 * d * s);
            for (int j = 1; j <= STENCIL; j++)
                if (j != s && j != -s) weight *= (real)(j * j) / (j * j - s * s);
            z[column] = at[column] + s * d;
            f(self, z, y);
            for (int row = 0; row < rows; row++) J[row][column] += weight * y[row];
        }
        z[column] = at[column];
    }
}

/* x <- A^-1 x; A is lost. */
static void solve(int size, real A[COLUMNS_MAX][COLUMNS_MAX], real x[])
{
    for (int k = 0; k < size; k++) {
        int pivot = k;
        for (int i = k + 1; i < size; i++)
            if (fabsl(A[i][k]) > fabsl(A[pivot][k])) pivot = i;
        for (int j = 0; j <= size; j++) { /* the right side too */
            real *const one = j < size ? &A[k][j] : &x[k], *const other = j < size ? &A[pivot][j] : &x[pivot],
                        kept = *one;
            *one = *other;
            *other = kept;
        }
        for (int i = 0; i < size; i++) {
            const real factor = i == k ? 0 : A[i][k] / A[k][k];
            for (int j = k; j < size; j++) A[i][j] -= factor * A[k][j];
            x[i] -= factor * x[k];
        }
    }
    for (int i = 0; i < size; i++) x[i] /= A[i][i];
}

/* ---- The equations of the generating functions ------------------------------------------------------------------- */

static void shape_of(const void *self, const real z[], real y[]) { shape(self, z, y); }

/* sum_i x_i dy_{first + i}/dz_j. */
static real pulled(real J[ROWS_MAX][COLUMNS_MAX], int first, const real x[], int j)
{
    real total = 0;
    for (int i = 0; i < n; i++) total += x[i] * J[first + i][j];
    return total;
}

/* Solves sum_i (X_i dy_{x + i} + U_i dy_{u + i}) = gradient for (X, U). */
static void solve_pair(real J[ROWS_MAX][COLUMNS_MAX], int x, int u, real gradient[])
{
    real A[COLUMNS_MAX][COLUMNS_MAX];
    for (int j = 0; j < Z; j++)
        for (int i = 0; i < n; i++) {
            A[j][i] = J[x + i][j];
            A[j][n + i] = J[u + i][j];
        }
    solve(Z, A, gradient);
}

/* I: S = Ld(q-, q+), d Ld = p1 dq+ - p0 dq-. */
static void close_type1(const real y[], real J[ROWS_MAX][COLUMNS_MAX], ends *e)
{
    real X[Z];
    for (int j = 0; j < Z; j++) X[j] = J[ACTION][j];
    solve_pair(J, TO_Q, FROM_Q, X);
    for (int i = 0; i < n; i++) {
        e->q0[i] = y[FROM_Q + i], e->p0[i] = -X[n + i];
        e->q1[i] = y[TO_Q + i], e->p1[i] = X[i];
    }
}

/* II: Hd+(q-, p+) = p+.q+ - S, d Hd+ = p0 dq- + q1 dp+. */
static void close_type2(const real y[], real J[ROWS_MAX][COLUMNS_MAX], ends *e)
{
    real X[Z];
    for (int j = 0; j < Z; j++) X[j] = pulled(J, TO_Q, y + TO_P, j) + pulled(J, TO_P, y + TO_Q, j) - J[ACTION][j];
    solve_pair(J, FROM_Q, TO_P, X);
    for (int i = 0; i < n; i++) {
        e->q0[i] = y[FROM_Q + i], e->p0[i] = X[i];
        e->q1[i] = X[n + i], e->p1[i] = y[TO_P + i];
    }
}

/* III: Hd-(q+, p-) = -p-.q- - S, d Hd- = -p1 dq+ - q0 dp-. */
static void close_type3(const real y[], real J[ROWS_MAX][COLUMNS_MAX], ends *e)
{
    real X[Z];
    for (int j = 0; j < Z; j++)
        X[j] = pulled(J, FROM_Q, y + FROM_P, j) + pulled(J, FROM_P, y + FROM_Q, j) + J[ACTION][j];
    solve_pair(J, TO_Q, FROM_P, X);
    for (int i = 0; i < n; i++) {
        e->q0[i] = X[n + i], e->p0[i] = y[FROM_P + i];
        e->q1[i] = y[TO_Q + i], e->p1[i] = X[i];
    }
}

/* Poincare: S_P = S - pbar.(q+ - q-) of the mean of the ends, d S_P = Dp dqbar - Dq dpbar. */
static void close_poincare(const real y[], real J[ROWS_MAX][COLUMNS_MAX], ends *e)
{
    real A[COLUMNS_MAX][COLUMNS_MAX], X[Z];
    for (int j = 0; j < Z; j++) {
        X[j] = J[ACTION][j];
        for (int i = 0; i < n; i++) {
            const real mean = (y[FROM_P + i] + y[TO_P + i]) / 2, rise = y[TO_Q + i] - y[FROM_Q + i];
            A[j][i] = (J[FROM_Q + i][j] + J[TO_Q + i][j]) / 2;
            A[j][n + i] = (J[FROM_P + i][j] + J[TO_P + i][j]) / 2;
            X[j] -= mean * (J[TO_Q + i][j] - J[FROM_Q + i][j]) + rise * A[j][n + i];
        }
    }
    solve(Z, A, X);
    for (int i = 0; i < n; i++) {
        const real q = (y[FROM_Q + i] + y[TO_Q + i]) / 2, p = (y[FROM_P + i] + y[TO_P + i]) / 2;
        e->q0[i] = q + X[n + i] / 2, e->p0[i] = p - X[i] / 2;
        e->q1[i] = q - X[n + i] / 2, e->p1[i] = p + X[i] / 2;
    }
}

static void close_equations(const method *m, const real z[], real J[ROWS_MAX][COLUMNS_MAX], ends *e)
{
    real y[Y];
    shape(m, z, y);
    differentiate(shape_of, m, Y, Z, z, J);
    switch (m->k->method) {
    case TVI_TYPE1: close_type1(y, J, e); break;
    case TVI_TYPE2: close_type2(y, J, e); break;
    case TVI_TYPE3: close_type3(y, J, e); break;
    default: close_poincare(y, J, e);
    }
}

enum { PASSES = 60 };
static const real CONVERGED = 2e-16L;

/* x -= A^-1 r; false where the residual r is roundoff already. */
static bool correct(int size, real A[COLUMNS_MAX][COLUMNS_MAX], real r[], real x[])
{
    real largest = 0;
    for (int j = 0; j < size; j++) largest = fmaxl(largest, fabsl(r[j]));
    if (largest < CONVERGED) return false;
    solve(size, A, r);
    for (int j = 0; j < size; j++) x[j] -= r[j];
    return true;
}

/* z until the equations give the q0 and p0 of the state: corrected as if they were the curve's ends. */
void definition_step(const method *m, const test_state *start, ends *e)
{
    real z[Z], q[n], p[n], J[ROWS_MAX][COLUMNS_MAX], A[COLUMNS_MAX][COLUMNS_MAX], r[Z];
    for (int i = 0; i < n; i++) q[i] = start->q[i], p[i] = start->p[i];
    const curve g = law_expand(m->l, m->t, q, p, false);
    for (int i = 0; i < n; i++)
        q[i] = series_value(&g.q[i], TOP, m->centre * m->h), p[i] = series_value(&g.p[i], TOP, m->centre * m->h);
    (void)law_hamiltonian(m->l, q, p, m->t + m->centre * m->h, r);
    for (int i = 0; i < n; i++) z[i] = q[i], z[n + i] = m->k->method == TVI_TYPE1 ? r[i] : p[i];
    for (int pass = 0; pass < PASSES; pass++) {
        close_equations(m, z, J, e);
        for (int i = 0; i < n; i++) {
            r[i] = e->q0[i] - start->q[i];
            r[n + i] = e->p0[i] - start->p[i];
            memcpy(A[i], J[FROM_Q + i], sizeof A[i]);
            memcpy(A[n + i], J[FROM_P + i], sizeof A[i]);
        }
        if (m->degree == 1 && m->k->method == TVI_TYPE1) /* p- of degree 0 does not know v: p = m v does */
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++) A[n + i][n + j] = i == j ? law_mass(m->l, i, q) : 0;
        if (!correct(Z, A, r, z)) return;
    }
    ck_abort_msg("the definition is not solved");
}

/* ---- Both ends --------------------------------------------------------------------------------------------------- */

/* x = (q0, v0, q1, v1); y = (a(h), b(-h), S). */
enum { A_END = 0, B_END = n, BOTH_ACTION = 2 * n, BOTH_Y };

static void shape_of_both(const void *self, const real x[], real y[])
{
    const method *m = self;
    const curve a = law_expand(m->l, m->t, x, x + n, true), b = law_expand(m->l, m->t + m->h, x + Z, x + Z + n, true);
    const int r = m->degree;
    for (int i = 0; i < n; i++) {
        y[A_END + i] = series_value(&a.q[i], r, m->h);
        y[B_END + i] = series_value(&b.q[i], r, -m->h);
    }
    y[BOTH_ACTION] = 0;
    for (int node = 0; node < m->nodes->points; node++) {
        const real c = m->nodes->c[node], s = c * m->h, w = 1 - c;
        real q[n], v[n];
        for (int i = 0; i < n; i++) {
            const real at_a = series_value(&a.q[i], r, s), at_b = series_value(&b.q[i], r, s - m->h);
            q[i] = w * at_a + c * at_b;
            v[i] = w * series_slope(&a.q[i], r, s) + c * series_slope(&b.q[i], r, s - m->h);
            if (m->k->nodes == TVI_NODES_ON_CURVE) v[i] -= (at_a - at_b) / m->h;
        }
        y[BOTH_ACTION] += m->h * m->nodes->b[node] * law_lagrangian(m->l, q, v, m->t + s);
    }
}

/* B^T multiplier = S_v of the columns first ... */
static void multiplier(real J[ROWS_MAX][COLUMNS_MAX], int row, int first, real out[])
{
    real A[COLUMNS_MAX][COLUMNS_MAX];
    for (int j = 0; j < n; j++) {
        out[j] = J[BOTH_ACTION][first + j];
        for (int i = 0; i < n; i++) A[j][i] = J[row + i][first + j];
    }
    solve(n, A, out);
}

/* B0^T l = S_v0, B1^T m = S_v1, p0 = -S_q0 + A0^T l - m, p1 = S_q1 + l - A1^T m. */
static void close_both(const method *m, const real x[], real y[], real J[ROWS_MAX][COLUMNS_MAX], ends *e)
{
    real lambda[n], mu[n];
    shape_of_both(m, x, y);
    differentiate(shape_of_both, m, BOTH_Y, 2 * Z, x, J);
    multiplier(J, A_END, n, lambda);
    multiplier(J, B_END, Z + n, mu);
    for (int i = 0; i < n; i++) {
        e->q1[i] = x[Z + i];
        e->p0[i] = -J[BOTH_ACTION][i] + pulled(J, A_END, lambda, i) - mu[i];
        e->p1[i] = J[BOTH_ACTION][Z + i] + lambda[i] - pulled(J, B_END, mu, Z + i);
    }
}

/* a(h) = q1, b(-h) = q0 and p0, for (v0, q1, v1). */
void definition_step_both(const method *m, const test_state *start, ends *e)
{
    enum { UNKNOWNS = 3 * n };
    real x[2 * Z], y[BOTH_Y], p[n], J[ROWS_MAX][COLUMNS_MAX], A[COLUMNS_MAX][COLUMNS_MAX], r[UNKNOWNS];
    for (int i = 0; i < n; i++) x[i] = start->q[i], p[i] = start->p[i];
    (void)law_hamiltonian(m->l, x, p, m->t, x + n);
    const curve g = law_expand(m->l, m->t, x, x + n, true);
    for (int i = 0; i < n; i++)
        x[Z + i] = series_value(&g.q[i], TOP, m->h), x[Z + n + i] = series_slope(&g.q[i], TOP, m->h);
    for (int pass = 0; pass < PASSES; pass++) {
        close_both(m, x, y, J, e);
        memset(A, 0, sizeof A);
        for (int i = 0; i < n; i++) {
            r[i] = y[A_END + i] - x[Z + i];
            r[n + i] = y[B_END + i] - start->q[i];
            r[2 * n + i] = e->p0[i] - start->p[i];
            A[i][n + i] = -1;
            A[2 * n + i][i] = law_mass(m->l, i, x);
            for (int j = 0; j < n; j++) A[i][j] = J[A_END + i][n + j];
            for (int j = 0; j < Z; j++) A[n + i][n + j] = J[B_END + i][Z + j];
        }
        if (!correct(UNKNOWNS, A, r, x + n)) return;
    }
    ck_abort_msg("the definition is not solved");
}
