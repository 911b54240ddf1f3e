/* definition_law.c - Computes the problem of the definition, and its curve: see definition.h. */
#include "definition.h"

#include <math.h>

/* ---- The problem: H = sum_i (p_i - a f_i)^2 / (2 m_i) + V -------------------------------------------------------- */

static const real frequency = 1.25;

real law_mass(const law *l, int i, const real q[]) { return i == 0 ? 1.5L * (1 + l->b * q[1] * q[1]) : 0.5L; }

static real gauge(const law *l, int i, const real q[], real t)
{
    return l->a * (i == 0 ? q[1] * cosl(frequency * t) : q[0] * q[0]);
}

static real potential(const real q[], real t)
{
    return 2 * q[0] * q[0] + q[0] * q[0] * q[1] + 0.75L * powl(q[1], 4) + q[0] * cosl(frequency * t) / 2;
}

real law_lagrangian(const law *l, const real q[], const real v[], real t)
{
    real L = -potential(q, t);
    for (int i = 0; i < n; i++) L += law_mass(l, i, q) * v[i] * v[i] / 2 + gauge(l, i, q, t) * v[i];
    return L;
}

/* v = H_p, and H. */
real law_hamiltonian(const law *l, const real q[], const real p[], real t, real v[])
{
    real H = potential(q, t);
    for (int i = 0; i < n; i++) {
        v[i] = (p[i] - gauge(l, i, q, t)) / law_mass(l, i, q);
        H += law_mass(l, i, q) * v[i] * v[i] / 2;
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

jet law_record_lagrangian(const jet q[], const jet v[], jet t, void *ctx) { return record(ctx, q, v, t, false); }
jet law_record_hamiltonian(const jet q[], const jet p[], jet t, void *ctx) { return record(ctx, q, p, t, true); }

/* ---- The curve --------------------------------------------------------------------------------------------------- */

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

/* From (q, p) at t; from velocities where p = m v + a f is to be formed first. */
curve law_expand(const law *l, real t, const real q[], const real second[], bool of_velocities)
{
    const series C = cosine(t);
    series dq[n], dp[n];
    curve g;
    memset(&g, 0, sizeof g);
    for (int i = 0; i < n; i++) {
        g.q[i].c[0] = q[i];
        g.p[i].c[0] = of_velocities ? law_mass(l, i, q) * second[i] + gauge(l, i, q, t) : second[i];
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

real series_value(const series *x, int degree, real s)
{
    real sum_of_terms = 0;
    for (int k = degree; k >= 0; k--) sum_of_terms = sum_of_terms * s + x->c[k];
    return sum_of_terms;
}

real series_slope(const series *x, int degree, real s)
{
    real sum_of_terms = 0;
    for (int k = degree; k >= 1; k--) sum_of_terms = sum_of_terms * s + k * x->c[k];
    return sum_of_terms;
}
