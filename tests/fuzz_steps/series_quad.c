/* series_quad.c - Implements series_quad.h. */
#include "series_quad.h"

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

quad_series quad_series_of(const problem *x)
{
    quad_series s = {.source = x, .c = calloc((size_t)x->f.count, sizeof *s.c)};
    if (!s.c) abort();
    return s;
}

void quad_series_free(quad_series *s) { free(s->c); }

/* ---- Coefficient k, by comparing coefficients -------------------------------------------------------------------- */

/* a z' = c z a', z = a^c; a product where c is 0, 1 or 2, so that a may be 0. */
static quad power_of(const quad *a, const quad *z, quad c, int k)
{
    if (c == 0) return k == 0;
    if (c == 1) return a[k];
    if (c == 2) return quad_product(a, a, k);
    if (k == 0) return powq(a[0], c);
    quad sum = 0;
    for (int j = 1; j <= k; j++) sum += (c * j - (k - j)) * a[j] * z[k - j];
    return sum / (k * a[0]);
}

static quad coefficient(const formula_node *x, quad (*all)[ORDERS], quad *z, int k)
{
    const quad *a = all[x->a], *b = all[x->b];
    switch (x->op) {
    case X_NUMBER: return k ? 0 : x->number;
    case X_ADD: return a[k] + b[k];
    case X_SUB: return a[k] - b[k];
    case X_MUL: return quad_product(a, b, k);
    case X_DIV: return quad_quotient(a, b, z, k);
    case X_POW: return power_of(a, z, x->number, k);
    case X_NEG: return -a[k];
    case X_SQRT: return quad_root(a, z, k);
    case X_EXP: return k ? quad_chain(a, z, k) : expq(a[0]);
    case X_LOG: return k ? quad_inverse_chain(a, a, z, k) : logq(a[0]);
    case X_SIN: return k ? quad_chain(a, b, k) : sinq(a[0]);
    case X_COS: return k ? -quad_chain(a, b, k) : cosq(a[0]);
    case X_SINH: return k ? quad_chain(a, b, k) : sinhq(a[0]);
    case X_COSH: return k ? quad_chain(a, b, k) : coshq(a[0]);
    case X_ASIN: return k ? quad_inverse_chain(a, b, z, k) : asinq(a[0]);
    case X_ATAN: return k ? quad_inverse_chain(a, b, z, k) : atanq(a[0]);
    case X_ACOS: { /* -asin, but for its value */
        if (k == 0) return acosq(a[0]);
        quad sum = -k * a[k];
        for (int j = 1; j < k; j++) sum -= j * z[j] * b[k - j];
        return sum / (k * b[0]);
    }
    default: return b[k]; /* sqr, tan, tanh: what they are equal to */
    }
}

/* A number in [-1, 1] of node i. */
static quad jitter(int i) { return sinq((quad)12.9898 * i * i + (quad)78.233 * i); }

void quad_run(quad_series *s, int k)
{
    const formula *f = &s->source->f;
    for (int i = f->inputs; i < f->count; i++) {
        s->c[i][k] = coefficient(&f->nodes[i], s->c, s->c[i], k);
        if (s->noise != 0) s->c[i][k] *= 1 + s->noise * jitter(i);
    }
}

void quad_set(quad_series *s, quad t, const quad q[], const quad r[])
{
    for (int i = 0; i < s->source->n; i++) s->c[i][0] = q[i], s->c[SECOND + i][0] = r[i];
    s->c[TIME][0] = t;
    s->c[TIME][1] = 1;
    for (int k = 2; k < ORDERS; k++) s->c[TIME][k] = 0;
}

/* ---- The equations ----------------------------------------------------------------------------------------------- */

static bool is_separable(const problem *x) { return x->form == OF_FORCE || x->form == OF_POTENTIAL; }

/* Coefficient k of q' and p'. */
static quad rate_q(const quad_series *s, int i, int k)
{
    return is_separable(s->source) ? s->c[SECOND + i][k] / s->source->mass[i] : s->c[s->source->dp[i]][k];
}

static quad rate_p(const quad_series *s, int i, int k)
{
    return s->source->form == OF_FORCE ? s->c[s->source->dq[i]][k] : -s->c[s->source->dq[i]][k];
}

void quad_field(quad_series *s, quad t, const quad q[], const quad p[], quad dq[], quad dp[])
{
    quad_set(s, t, q, p);
    quad_run(s, 0);
    for (int i = 0; i < s->source->n; i++) dq[i] = rate_q(s, i, 0), dp[i] = rate_p(s, i, 0);
}

/* Column j is the first coefficient along r_j. */
void quad_bend(quad_series *s, quad *A)
{
    const int n = s->source->n;
    for (int i = 0; i < n; i++) s->c[i][1] = s->c[SECOND + i][1] = 0;
    s->c[TIME][1] = 0;
    quad_run(s, 0);
    for (int j = 0; j < n; j++) {
        s->c[SECOND + j][1] = 1;
        quad_run(s, 1);
        for (int i = 0; i < n; i++) A[i * n + j] = rate_q(s, i, 1);
        s->c[SECOND + j][1] = 0;
    }
    s->c[TIME][1] = 1;
}

bool quad_legendre(quad_series *s, quad t, const quad q[], const quad goal[], quad r[])
{
    const int n = s->source->n;
    quad A[N_MOST * N_MOST], change[N_MOST], size = 1, before;
    for (int pass = 0; pass < 60; pass++) {
        quad_set(s, t, q, r);
        quad_bend(s, A);
        for (int i = 0; i < n; i++) change[i] = goal[i] - rate_q(s, i, 0);
        if (!quad_solve(n, A, change)) return false;
        before = size, size = 0;
        for (int i = 0; i < n; i++) {
            r[i] += change[i];
            size = fmaxq(size, fabsq(change[i]));
        }
        if (!finiteq(size)) return false;
        if (size < 1e-32 || (size < 1e-28 && size >= before)) return true;
    }
    return false;
}

quad quad_energy_of(quad_series *s, quad t, const quad q[], const quad r[])
{
    quad_set(s, t, q, r);
    quad_run(s, 0);
    quad sum = s->c[s->source->energy][0];
    for (int i = 0; is_separable(s->source) && i < s->source->n; i++)
        sum += r[i] * r[i] / (2 * (quad)s->source->mass[i]);
    return sum;
}

static bool lagrangian_curve(quad_series *s, int degree, quad *Q, quad *P)
{
    const int n = s->source->n;
    quad A[N_MOST * N_MOST], bend[N_MOST * N_MOST], change[N_MOST];
    quad_bend(s, bend);
    for (int i = 0; i < n; i++) s->c[i][1] = s->c[SECOND + i][0];
    for (int k = 0;; k++) {
        for (int i = 0; i < n; i++) {
            Q[k * n + i] = s->c[i][k];
            P[k * n + i] = s->c[s->source->dp[i]][k];
        }
        if (k == degree) return true;
        for (int i = 0; i < n; i++) {
            s->c[SECOND + i][k + 1] = 0;
            s->c[i][k + 1] = s->c[SECOND + i][k] / (k + 1);
        }
        quad_run(s, k + 1);
        for (int i = 0; i < n; i++) change[i] = s->c[s->source->dq[i]][k] / (k + 1) - s->c[s->source->dp[i]][k + 1];
        memcpy(A, bend, sizeof A);
        if (!quad_solve(n, A, change)) return false;
        for (int i = 0; i < n; i++) s->c[SECOND + i][k + 1] = change[i];
        quad_run(s, k + 1);
    }
}

bool quad_curve(quad_series *s, quad t, const quad q[], const quad r[], int degree, quad *Q, quad *P)
{
    const int n = s->source->n;
    quad_set(s, t, q, r);
    if (s->source->form == OF_LAGRANGIAN) return lagrangian_curve(s, degree, Q, P);
    for (int k = 0;; k++) {
        for (int i = 0; i < n; i++) Q[k * n + i] = s->c[i][k], P[k * n + i] = s->c[SECOND + i][k];
        if (k == degree) return true;
        quad_run(s, k);
        for (int i = 0; i < n; i++) {
            s->c[i][k + 1] = rate_q(s, i, k) / (k + 1);
            s->c[SECOND + i][k + 1] = rate_p(s, i, k) / (k + 1);
        }
    }
}
