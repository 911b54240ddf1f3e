/* test_definition.c - steps of the library against the same methods from their definition (docs/method.md sections 3
 * and 4): the discrete action S(z) summed at the nodes, differentiated by differences, and the generating function's
 * equations with whole actions, no defects, solved in long double. Shares nothing with the library. */
#include "generating.h"
#include "models.h"
#include "method/method.h"

#include <math.h>
#include <string.h>

typedef long double real;
enum { n = 2, Z = 2 * n, TOP = 5, NODES_MAX = 3 };

/* ---- The problem: H = sum_i (p_i - a f_i)^2 / (2 m_i) + V -------------------------------------------------------- */

/* m = (3/2 (1 + b q_1^2), 1/2), f = (q_1 C, q_0^2), V = 2 q_0^2 + q_0^2 q_1 + 3/4 q_1^4 + q_0 C / 2, C = cos(5/4 t):
 * separable for a = b = 0. L = sum_i m_i v_i^2/2 + a f.v - V. */
typedef struct {
    real a, b;
} law;

static const law separable = {0, 0}, general = {0.75, 0.5};
static const real frequency = 1.25;

static real mass(const law *l, int i, const real q[]) { return i == 0 ? 1.5L * (1 + l->b * q[1] * q[1]) : 0.5L; }

static real gauge(const law *l, int i, const real q[], real t)
{
    return l->a * (i == 0 ? q[1] * cosl(frequency * t) : q[0] * q[0]);
}

static real potential(const real q[], real t)
{
    return 2 * q[0] * q[0] + q[0] * q[0] * q[1] + 0.75L * powl(q[1], 4) + q[0] * cosl(frequency * t) / 2;
}

static real lagrangian(const law *l, const real q[], const real v[], real t)
{
    real L = -potential(q, t);
    for (int i = 0; i < n; i++) L += mass(l, i, q) * v[i] * v[i] / 2 + gauge(l, i, q, t) * v[i];
    return L;
}

/* v = H_p, and H. */
static real hamiltonian(const law *l, const real q[], const real p[], real t, real v[])
{
    real H = potential(q, t);
    for (int i = 0; i < n; i++) {
        v[i] = (p[i] - gauge(l, i, q, t)) / mass(l, i, q);
        H += mass(l, i, q) * v[i] * v[i] / 2;
    }
    return H;
}

/* The same once more, for the library. */
static jet record(const law *l, const jet q[], const jet second[], jet t, bool of_momenta)
{
    jet C = jet_cos(jet_mul((double)frequency, t)), f[n], m[n], terms[n];
    f[0] = jet_mul((double)l->a, jet_mul(q[1], C));
    f[1] = jet_mul((double)l->a, jet_sqr(q[0]));
    m[0] = jet_mul(1.5, jet_add(1, jet_mul((double)l->b, jet_sqr(q[1]))));
    m[1] = jet_const(0.5);
    for (int i = 0; i < n; i++)
        terms[i] = of_momenta ? jet_div(jet_sqr(jet_sub(second[i], f[i])), jet_mul(2, m[i]))
                              : jet_add(jet_mul(0.5, jet_mul(m[i], jet_sqr(second[i]))), jet_mul(f[i], second[i]));
    jet V = jet_add(jet_mul(jet_sqr(q[0]), jet_add(2, q[1])), jet_mul(0.75, jet_pow(q[1], 4)));
    V = jet_add(V, jet_mul(0.5, jet_mul(q[0], C)));
    return of_momenta ? jet_add(jet_sum(terms, n), V) : jet_sub(jet_sum(terms, n), V);
}

static jet record_lagrangian(const jet q[], const jet v[], jet t, void *ctx) { return record(ctx, q, v, t, false); }
static jet record_hamiltonian(const jet q[], const jet p[], jet t, void *ctx) { return record(ctx, q, p, t, true); }

/* ---- The curve --------------------------------------------------------------------------------------------------- */

typedef struct {
    real c[TOP + 1];
} series;

/* Of the coefficients up to K only. */
static series scaled(int K, real factor, series x)
{
    for (int k = 0; k <= K; k++) x.c[k] *= factor;
    return x;
}

static series sum(int K, series x, series y)
{
    for (int k = 0; k <= K; k++) x.c[k] += y.c[k];
    return x;
}

static series product(int K, series x, series y)
{
    series z = {{0}};
    for (int k = 0; k <= K; k++)
        for (int j = 0; j <= k; j++) z.c[k] += x.c[j] * y.c[k - j];
    return z;
}

static series quotient(int K, series x, series y)
{
    series z = x;
    for (int k = 0; k <= K; k++) {
        for (int j = 0; j < k; j++) z.c[k] -= z.c[j] * y.c[k - j];
        z.c[k] /= y.c[0];
    }
    return z;
}

/* cos(w (t + s)). */
static series cosine(real t)
{
    series z;
    real factor = 1;
    for (int k = 0; k <= TOP; k++) {
        z.c[k] = factor * (k % 2 ? sinl(frequency * t) : cosl(frequency * t)) * (k % 4 == 1 || k % 4 == 2 ? -1 : 1);
        factor *= frequency / (k + 1);
    }
    return z;
}

/* q' = (p - a f)/m, p' = a sum_i v_i df_i/dq + v_0^2/2 dm_0/dq - V_q. */
static void slopes(int K, const law *l, const series q[n], const series p[n], series C, series dq[n], series dp[n])
{
    const series squares[] = {product(K, q[0], q[0]), product(K, q[1], q[1])};
    series m0 = scaled(K, 1.5L * l->b, squares[1]);
    m0.c[0] += 1.5L;
    dq[0] = quotient(K, sum(K, p[0], scaled(K, -l->a, product(K, q[1], C))), m0);
    dq[1] = scaled(K, 2, sum(K, p[1], scaled(K, -l->a, squares[0])));
    dp[0] = sum(K, scaled(K, 2 * l->a, product(K, q[0], dq[1])), scaled(K, -4, q[0]));
    dp[0] = sum(K, dp[0], sum(K, scaled(K, -2, product(K, q[0], q[1])), scaled(K, -0.5L, C)));
    dp[1] = sum(K, scaled(K, l->a, product(K, dq[0], C)),
                scaled(K, 1.5L * l->b, product(K, q[1], product(K, dq[0], dq[0]))));
    dp[1] = sum(K, dp[1], sum(K, scaled(K, -1, squares[0]), scaled(K, -3, product(K, q[1], squares[1]))));
}

typedef struct {
    series q[n], p[n];
} curve;

/* From (q, p) at t; from velocities where p = m v + a f is to be formed first. */
static curve expand(const law *l, real t, const real q[], const real second[], bool of_velocities)
{
    const series C = cosine(t);
    series dq[n], dp[n];
    curve g;
    memset(&g, 0, sizeof g);
    for (int i = 0; i < n; i++) {
        g.q[i].c[0] = q[i];
        g.p[i].c[0] = of_velocities ? mass(l, i, q) * second[i] + gauge(l, i, q, t) : second[i];
    }
    for (int k = 0; k < TOP; k++) {
        slopes(k, l, g.q, g.p, C, dq, dp);
        for (int i = 0; i < n; i++) {
            g.q[i].c[k + 1] = dq[i].c[k] / (k + 1);
            g.p[i].c[k + 1] = dp[i].c[k] / (k + 1);
        }
    }
    return g;
}

static real value(const series *x, int degree, real s)
{
    real sum_of_terms = 0;
    for (int k = degree; k >= 0; k--) sum_of_terms = sum_of_terms * s + x->c[k];
    return sum_of_terms;
}

static real slope(const series *x, int degree, real s)
{
    real sum_of_terms = 0;
    for (int k = degree; k >= 1; k--) sum_of_terms = sum_of_terms * s + k * x->c[k];
    return sum_of_terms;
}

/* ---- The action -------------------------------------------------------------------------------------------------- */

typedef struct {
    tvi_quadrature quadrature;
    int points;
    real b[NODES_MAX], c[NODES_MAX];
} rule;

typedef struct {
    const law *l;
    const kind *k;
    const rule *nodes;
    int degree;
    real t, h, centre; /* the centre is at t + centre h */
} method;

/* What a method asks of z: the ends of the curve, and S. */
enum { FROM_Q = 0, TO_Q = n, FROM_P = 2 * n, TO_P = 3 * n, ACTION = 4 * n, Y = ACTION + 1 };

static real action_at_node(const method *m, const curve *g, int node)
{
    const bool truncated = m->k->nodes == TVI_NODES_TRUNCATED, poincare = m->k->method == TVI_POINCARE;
    const real c = m->nodes->c[node], s = (c - m->centre) * m->h, t = m->t + c * m->h;
    const int q_degree = truncated && c != 0 && c != 1 ? m->degree - 1 : m->degree;
    real q[n], v[n], p[n], H_p[n];
    for (int i = 0; i < n; i++) {
        q[i] = value(&g->q[i], q_degree, s);
        v[i] = slope(&g->q[i], m->degree, s);
        p[i] = value(&g->p[i], poincare ? m->degree : m->degree - 1, s);
    }
    if (m->k->method == TVI_TYPE1) return lagrangian(m->l, q, v, t);
    real S = -hamiltonian(m->l, q, p, t, H_p);
    for (int i = 0; i < n; i++) S += p[i] * (truncated ? H_p[i] : v[i]);
    return S;
}

static void shape(const method *m, const real z[], real y[])
{
    const curve g = expand(m->l, m->t + m->centre * m->h, z, z + n, m->k->method == TVI_TYPE1);
    const real from = -m->centre * m->h, to = from + m->h;
    const int p_degree = m->k->method == TVI_POINCARE ? m->degree : m->degree - 1;
    for (int i = 0; i < n; i++) {
        y[FROM_Q + i] = value(&g.q[i], m->degree, from);
        y[TO_Q + i] = value(&g.q[i], m->degree, to);
        y[FROM_P + i] = value(&g.p[i], p_degree, from);
        y[TO_P + i] = value(&g.p[i], p_degree, to);
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

/* The state before and after the step. */
typedef struct {
    real q0[n], p0[n], q1[n], p1[n];
} ends;

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
static void definition_step(const method *m, const test_state *start, ends *e)
{
    real z[Z], q[n], p[n], J[ROWS_MAX][COLUMNS_MAX], A[COLUMNS_MAX][COLUMNS_MAX], r[Z];
    for (int i = 0; i < n; i++) q[i] = start->q[i], p[i] = start->p[i];
    const curve g = expand(m->l, m->t, q, p, false);
    for (int i = 0; i < n; i++)
        q[i] = value(&g.q[i], TOP, m->centre * m->h), p[i] = value(&g.p[i], TOP, m->centre * m->h);
    (void)hamiltonian(m->l, q, p, m->t + m->centre * m->h, r);
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
                for (int j = 0; j < n; j++) A[n + i][n + j] = i == j ? mass(m->l, i, q) : 0;
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
    const curve a = expand(m->l, m->t, x, x + n, true), b = expand(m->l, m->t + m->h, x + Z, x + Z + n, true);
    const int r = m->degree;
    for (int i = 0; i < n; i++) {
        y[A_END + i] = value(&a.q[i], r, m->h);
        y[B_END + i] = value(&b.q[i], r, -m->h);
    }
    y[BOTH_ACTION] = 0;
    for (int node = 0; node < m->nodes->points; node++) {
        const real c = m->nodes->c[node], s = c * m->h, w = 1 - c;
        real q[n], v[n];
        for (int i = 0; i < n; i++) {
            const real at_a = value(&a.q[i], r, s), at_b = value(&b.q[i], r, s - m->h);
            q[i] = w * at_a + c * at_b;
            v[i] = w * slope(&a.q[i], r, s) + c * slope(&b.q[i], r, s - m->h);
            if (m->k->nodes == TVI_NODES_ON_CURVE) v[i] -= (at_a - at_b) / m->h;
        }
        y[BOTH_ACTION] += m->h * m->nodes->b[node] * lagrangian(m->l, q, v, m->t + s);
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
static void definition_step_both(const method *m, const test_state *start, ends *e)
{
    enum { UNKNOWNS = 3 * n };
    real x[2 * Z], y[BOTH_Y], p[n], J[ROWS_MAX][COLUMNS_MAX], A[COLUMNS_MAX][COLUMNS_MAX], r[UNKNOWNS];
    for (int i = 0; i < n; i++) x[i] = start->q[i], p[i] = start->p[i];
    (void)hamiltonian(m->l, x, p, m->t, x + n);
    const curve g = expand(m->l, m->t, x, x + n, true);
    for (int i = 0; i < n; i++) x[Z + i] = value(&g.q[i], TOP, m->h), x[Z + n + i] = slope(&g.q[i], TOP, m->h);
    for (int pass = 0; pass < PASSES; pass++) {
        close_both(m, x, y, J, e);
        memset(A, 0, sizeof A);
        for (int i = 0; i < n; i++) {
            r[i] = y[A_END + i] - x[Z + i];
            r[n + i] = y[B_END + i] - start->q[i];
            r[2 * n + i] = e->p0[i] - start->p[i];
            A[i][n + i] = -1;
            A[2 * n + i][i] = mass(m->l, i, x);
            for (int j = 0; j < n; j++) A[i][j] = J[A_END + i][n + j];
            for (int j = 0; j < Z; j++) A[n + i][n + j] = J[B_END + i][Z + j];
        }
        if (!correct(UNKNOWNS, A, r, x + n)) return;
    }
    ck_abort_msg("the definition is not solved");
}

/* ---- The comparison ---------------------------------------------------------------------------------------------- */

#define ROOT_3  1.7320508075688772935274463L
#define ROOT_15 3.8729833462074168851792654L
static const rule rules[] = {
    {TVI_GAUSS, 2, {0.5L, 0.5L}, {(3 - ROOT_3) / 6, (3 + ROOT_3) / 6}},
    {TVI_GAUSS, 3, {5 / 18.0L, 8 / 18.0L, 5 / 18.0L}, {(5 - ROOT_15) / 10, 0.5L, (5 + ROOT_15) / 10}},
    {TVI_LOBATTO, 3, {1 / 6.0L, 4 / 6.0L, 1 / 6.0L}, {0, 0.5L, 1}},
    {TVI_TRAPEZOID, 2, {0.5L, 0.5L}, {0, 1}},
    {TVI_RECTANGLE_START, 1, {1}, {0}},
    {TVI_RECTANGLE_END, 1, {1}, {1}},
};
enum {
    RULES = sizeof rules / sizeof *rules,
    STATEMENTS = 3,
    SMALL_STEPS = 1
}; /* the first rule with a small step too */

/* The separable problem, and the general one as a Lagrangian and as a Hamiltonian. */
static tvi_system *stated(int statement)
{
    law l = statement == 0 ? separable : general;
    tvi_system *system;
    const tvi_status status = statement == 1 ? tvi_system_lagrangian(&system, n, record_lagrangian, &l)
                                             : tvi_system_hamiltonian(&system, n, record_hamiltonian, &l);
    ck_assert_int_eq(status, TVI_OK);
    return system;
}

static void check_step(const tvi_system *system, const method *m)
{
    const test_state start = {.t = 0.3, .q = {0.4, -0.3}, .p = {0.5, 0.2}};
    tvi_options options = kind_options_with(m->k, m->degree, m->nodes->quadrature, m->nodes->points);
    const char *why;
    if (tvi_options_check(system, &options, &why) == TVI_EINVAL && m->degree == 0)
        return; /* the rectangle is of order 1 */
    tvi_integrator *integrator = integrator_of(system, &options);
    test_state x = start;
    ends e;
    go(integrator, (double)m->h, 1, &x);
    if (m->k->expansion == TVI_AT_BOTH_ENDS) definition_step_both(m, &start, &e);
    else definition_step(m, &start, &e);
    real error = 0;
    for (int i = 0; i < n; i++) error = fmaxl(error, fmaxl(fabsl(x.q[i] - e.q1[i]), fabsl(x.p[i] - e.p1[i])));
    ck_assert_msg(error < 1e-15L, "%s, form of system %d: %.1e", describe(&options), options.method, (double)error);
    tvi_integrator_free(integrator);
}

START_TEST(step_is_that_of_the_definition)
{
    const kind *k = &kinds[_i % kind_count];
    const tvi_options options = kind_options(k, 1);
    const tvi_span span = tvi_method_of(&options)->curve.span;
    const int statement = _i / kind_count;
    if (statement == 1 && k->method != TVI_TYPE1) return;
    tvi_system *system = stated(statement);
    for (int degree = kind_least_degree(k); degree < TOP; degree++)
        for (int which = 0; which < RULES + SMALL_STEPS; which++) {
            const method m = {.l = statement == 0 ? &separable : &general,
                              .k = k,
                              .nodes = &rules[which % RULES],
                              .degree = degree,
                              .t = 0.3,
                              .h = which < RULES ? 0.0625 : 0.0117,
                              .centre = -span.from / ((real)span.to - span.from)};
            check_step(system, &m);
        }
    tvi_system_free(system);
}
END_TEST

Suite *suite_definition(void)
{
    Suite *suite = suite_create("definition");
    TCase *tcase = tcase_create("definition");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, step_is_that_of_the_definition, 0, STATEMENTS * kind_count);
    suite_add_tcase(suite, tcase);
    return suite;
}
