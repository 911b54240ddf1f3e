/* spark_quad.c - Makes steps on constraints from their definition in quadruple precision (spark_quad.h). */
#include "spark_quad.h"

#include <check.h>
#include <quadmath.h>
#include <string.h>

enum { PASSES_MOST = 200, NEWTONS_MOST = 60, AT_ONCE = SPARK_NODES * SPARK_M };

/* Newton's iterations end below this; passes where they move by less than NEARLY_AT_REST, and no less than before: the
 * roundoff of phi, divided by h and by coefficients. */
static const quad AT_REST = 1e-32, NEARLY_AT_REST = 1e-28;

/* ---- The method -------------------------------------------------------------------------------------------------- */

/* P_s'(x) and P_s''(x), by (1 - x^2) P_s' = s (P_(s-1) - x P_s) and Legendre's equation. */
static void legendre_slopes(int s, quad x, quad *first, quad *second)
{
    quad before = 1, now = x;
    for (int k = 1; k < s; k++) {
        const quad next = ((2 * k + 1) * x * now - k * before) / (k + 1);
        before = now, now = next;
    }
    *first = s * (before - x * now) / (1 - x * x);
    *second = (2 * x * *first - s * (s + 1) * now) / (1 - x * x);
}

/* 0, 1 and the zeros of P_s'(2 d - 1): between them lie those of P_s, the Gauss nodes, where Newton begins in the
 * middle. */
static void set_lobatto(spark_method *method)
{
    const int s = method->count;
    method->d[0] = 0, method->d[s] = 1;
    for (int j = 1; j < s; j++) {
        quad x = method->c[j - 1] + method->c[j] - 1, first, second;
        for (int i = 0; i < NEWTONS_MOST; i++) {
            legendre_slopes(s, x, &first, &second);
            x -= first / second;
        }
        method->d[j] = (1 + x) / 2;
    }
}

static quad sigma(const spark_method *method, const quad A_x[], const quad A_y[])
{
    quad sum = 0;
    for (int k = 0; k < method->count; k++) sum += method->b[k] * A_x[k] * A_y[k];
    return sum;
}

spark_method spark_method_of(int count)
{
    const quad_method gauss = quad_method_gauss(TVI_AT_START, TVI_NODES_ON_CURVE, count, count);
    spark_method method = {.count = count};
    quad at_c[SPARK_NODES][SPARK_NODES], at_d[SPARK_NODES + 1][SPARK_NODES]; /* [i][k] */
    memcpy(method.b, gauss.b, sizeof method.b);
    memcpy(method.c, gauss.c, sizeof method.c);
    set_lobatto(&method);
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < count; i++)
            at_c[i][k] = method.A_at_c[k][i] = quad_method_integral(&gauss, k, method.c[i]) / method.b[k];
        for (int i = 0; i <= count; i++)
            at_d[i][k] = method.A_at_d[k][i] = quad_method_integral(&gauss, k, method.d[i]) / method.b[k];
    }
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < count; i++) method.mu_c[k][i] = 1 - method.A_at_c[k][i];
        for (int i = 0; i <= count; i++) method.mu_d[k][i] = 1 - method.A_at_d[k][i];
    }
    for (int i = 0; i < count; i++) {
        for (int l = 0; l < count; l++) method.nu_cc[i][l] = method.c[i] - sigma(&method, at_c[i], at_c[l]);
        for (int j = 0; j <= count; j++) {
            method.nu_cd[i][j] = method.c[i] - sigma(&method, at_c[i], at_d[j]);
            method.nu_dc[j][i] = method.d[j] - sigma(&method, at_d[j], at_c[i]);
        }
    }
    for (int i = 0; i <= count; i++)
        for (int j = 0; j <= count; j++) method.nu_dd[i][j] = method.d[i] - sigma(&method, at_d[i], at_d[j]);
    return method;
}

/* ---- Constraints of a state -------------------------------------------------------------------------------------- */

typedef struct {
    quad phi[SPARK_M], G[SPARK_M * SPARK_N], phi_t[SPARK_M];
} constraints;

static void set_W(const spark_problem *of, const spark_state *x, quad *W)
{
    quad Hq[SPARK_N], Hp[SPARK_N];
    memset(W, 0, SPARK_N * SPARK_N * sizeof *W);
    if (!of->is_separable) of->slopes(x->t, x->q, x->p, Hq, Hp, W);
    for (int i = 0; i < of->n && of->is_separable; i++) W[i * of->n + i] = 1 / of->masses[i];
}

static constraints constraints_at(const spark_problem *of, quad t, const quad q[])
{
    constraints c;
    memset(&c, 0, sizeof c);
    of->constrain(t, q, c.phi, c.G, c.phi_t);
    return c;
}

/* out = -G^T mu */
static void impulse(const spark_problem *of, const quad *G, const quad mu[], quad out[])
{
    for (int i = 0; i < of->n; i++) {
        out[i] = 0;
        for (int k = 0; k < of->m; k++) out[i] -= G[k * of->n + i] * mu[k];
    }
}

/* G1 W G0^T, [m][m] */
static void set_S(const spark_problem *of, const quad *G1, const quad *W, const quad *G0, quad *S)
{
    const int n = of->n;
    for (int k = 0; k < of->m; k++)
        for (int l = 0; l < of->m; l++) {
            quad sum = 0;
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++) sum += G1[k * n + i] * W[i * n + j] * G0[l * n + j];
            S[k * of->m + l] = sum;
        }
}

/* Moves p along G(q)^T to G H_p + phi_t = 0. */
static void project_p(const spark_problem *of, spark_state *x)
{
    quad W[SPARK_N * SPARK_N], S[SPARK_M * SPARK_M], r[SPARK_M], K[SPARK_N], Hq[SPARK_N], Hp[SPARK_N];
    const constraints c = constraints_at(of, x->t, x->q);
    for (int round = 0; round < NEWTONS_MOST; round++) {
        of->slopes(x->t, x->q, x->p, Hq, Hp, NULL);
        quad worst = 0;
        for (int k = 0; k < of->m; k++) {
            r[k] = c.phi_t[k];
            for (int i = 0; i < of->n; i++) r[k] += c.G[k * of->n + i] * Hp[i];
            worst = fmaxq(worst, fabsq(r[k]));
        }
        set_W(of, x, W);
        set_S(of, c.G, W, c.G, S);
        ck_assert(quad_solve(of->m, S, r));
        impulse(of, c.G, r, K);
        for (int i = 0; i < of->n; i++) x->p[i] += K[i];
        if (worst < AT_REST) return;
    }
    ck_abort_msg("%s: p finds no place", of->name);
}

void spark_project(const spark_problem *of, spark_state *x)
{
    quad W[SPARK_N * SPARK_N], S[SPARK_M * SPARK_M], K[SPARK_N], worst = 1;
    set_W(of, x, W);
    for (int round = 0; worst > AT_REST; round++) {
        constraints c = constraints_at(of, x->t, x->q);
        ck_assert_int_lt(round, NEWTONS_MOST);
        worst = 0;
        for (int k = 0; k < of->m; k++) worst = fmaxq(worst, fabsq(c.phi[k]));
        set_S(of, c.G, W, c.G, S);
        ck_assert(quad_solve(of->m, S, c.phi));
        impulse(of, c.G, c.phi, K);
        for (int i = 0; i < of->n; i++)
            for (int j = 0; j < of->n; j++) x->q[i] += W[i * of->n + j] * K[j];
    }
    project_p(of, x);
}

spark_state spark_start(const spark_problem *of)
{
    spark_state x = {.t = of->t};
    for (int i = 0; i < of->n; i++) x.q[i] = of->q[i], x.p[i] = of->p[i];
    spark_project(of, &x);
    return x;
}

double spark_defect(const spark_problem *of, const spark_state *x)
{
    const constraints c = constraints_at(of, x->t, x->q);
    quad Hq[SPARK_N], Hp[SPARK_N], worst = 0;
    of->slopes(x->t, x->q, x->p, Hq, Hp, NULL);
    for (int k = 0; k < of->m; k++) {
        quad rate = c.phi_t[k];
        for (int i = 0; i < of->n; i++) rate += c.G[k * of->n + i] * Hp[i];
        worst = fmaxq(worst, fmaxq(fabsq(c.phi[k]), fabsq(rate)));
    }
    return (double)worst;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* The unknowns of a step: L_l and U_l = h b_l V_l at the Gauss nodes, mu_j and K_j at the Lobatto nodes. */
typedef struct {
    const spark_problem *of;
    const spark_method *method;
    const spark_state *from;
    quad h, W[SPARK_N * SPARK_N];
    quad L[SPARK_NODES][SPARK_N], U[SPARK_NODES][SPARK_N];
    quad Q[SPARK_NODES][SPARK_N], P[SPARK_NODES][SPARK_N], X[SPARK_NODES + 1][SPARK_N];
    quad mu[SPARK_NODES + 1][SPARK_M], K[SPARK_NODES + 1][SPARK_N];
    constraints at[SPARK_NODES + 1];
} task;

/* q0 + x h M^-1 p0 + h M^-1 (sum_l nu(x, c_l) L_l + sum_(j < m) nu(x, d_j) K_j) */
static quad place(const task *s, int i, quad x, const quad nu_c[], const quad nu_d[])
{
    quad sum = x * s->from->p[i];
    for (int l = 0; l < s->method->count; l++) sum += nu_c[l] * s->L[l][i] + nu_d[l] * s->K[l][i];
    return s->from->q[i] + s->h * sum / s->of->masses[i];
}

static void set_places_separable(task *s)
{
    const spark_method *method = s->method;
    for (int i = 0; i < s->of->n; i++) {
        for (int k = 0; k < method->count; k++)
            s->Q[k][i] = place(s, i, method->c[k], method->nu_cc[k], method->nu_cd[k]);
        for (int k = 1; k <= method->count; k++)
            s->X[k][i] = place(s, i, method->d[k], method->nu_dc[k], method->nu_dd[k]);
    }
}

/* Q_k = q0 + sum_l A_l(c_k) U_l, X_k = q0 + sum_l A_l(d_k) U_l, P_k = p0 + sum_l (1 - A_k(c_l)) L_l + sum_j (1 -
 * A_k(d_j)) K_j. */
static void set_places(task *s)
{
    const spark_method *method = s->method;
    if (s->of->is_separable) {
        set_places_separable(s);
        return;
    }
    for (int i = 0; i < s->of->n; i++) {
        for (int k = 0; k < method->count; k++) {
            s->Q[k][i] = s->from->q[i], s->P[k][i] = s->from->p[i];
            for (int l = 0; l < method->count; l++) {
                s->Q[k][i] += method->A_at_c[l][k] * s->U[l][i];
                s->P[k][i] += method->mu_c[k][l] * s->L[l][i] + method->mu_d[k][l] * s->K[l][i];
            }
        }
        for (int k = 1; k <= method->count; k++) {
            s->X[k][i] = s->from->q[i];
            for (int l = 0; l < method->count; l++) s->X[k][i] += method->A_at_d[l][k] * s->U[l][i];
        }
    }
}

static void set_forces(task *s)
{
    const quad *const b = s->method->b;
    for (int l = 0; l < s->method->count; l++) {
        quad Hq[SPARK_N], Hp[SPARK_N];
        s->of->slopes(s->from->t + s->method->c[l] * s->h, s->Q[l], s->P[l], Hq, Hp, NULL);
        for (int i = 0; i < s->of->n; i++) s->L[l][i] = -s->h * b[l] * Hq[i], s->U[l][i] = s->h * b[l] * Hp[i];
    }
}

static void set_impulses(task *s)
{
    for (int j = 0; j <= s->method->count; j++) {
        if (j) s->at[j] = constraints_at(s->of, s->from->t + s->method->d[j] * s->h, s->X[j]);
        impulse(s->of, s->at[j].G, s->mu[j], s->K[j]);
    }
}

/* Newton's method for phi(X_i) = 0, i >= 1, in mu_j, j < m, with what the X_i are moved by to first order in h: h
 * nu(d_i, d_j) G_i W G_j^T. */
static void correct_mu(task *s)
{
    const int count = s->method->count, m = s->of->m, size = count * m;
    quad A[AT_ONCE * AT_ONCE], S[SPARK_M * SPARK_M], r[AT_ONCE];
    for (int i = 1; i <= count; i++) {
        for (int j = 0; j < count; j++) {
            set_S(s->of, s->at[i].G, s->W, s->at[j].G, S);
            for (int k = 0; k < m; k++)
                for (int l = 0; l < m; l++)
                    A[((i - 1) * m + k) * size + j * m + l] = s->h * s->method->nu_dd[i][j] * S[k * m + l];
        }
        for (int k = 0; k < m; k++) r[(i - 1) * m + k] = s->at[i].phi[k];
    }
    ck_assert(quad_solve(size, A, r));
    for (int j = 0; j < count; j++)
        for (int k = 0; k < m; k++) s->mu[j][k] += r[j * m + k];
}

/* The largest change of an impulse, or phi. */
static quad movement(const task *s, const quad L[][SPARK_N], const quad K[][SPARK_N])
{
    quad most = 0;
    for (int j = 0; j < s->method->count; j++) {
        for (int i = 0; i < s->of->n; i++)
            most = fmaxq(most, fmaxq(fabsq(s->K[j][i] - K[j][i]), fabsq(s->L[j][i] - L[j][i])));
        for (int k = 0; k < s->of->m; k++) most = fmaxq(most, fabsq(s->at[j + 1].phi[k]));
    }
    return most;
}

void spark_step(const spark_problem *of, const spark_method *method, quad h, spark_state *x)
{
    static task s; /* the tests have one thread */
    s = (task){.of = of, .method = method, .from = x, .h = h};
    const int count = method->count;
    quad L[SPARK_NODES][SPARK_N], K[SPARK_NODES][SPARK_N], moved = 1, last = 2;
    set_W(of, x, s.W);
    for (int k = 0; k <= count; k++) {
        memcpy(s.X[k], x->q, sizeof x->q);
        if (k < count) memcpy(s.Q[k], x->q, sizeof x->q), memcpy(s.P[k], x->p, sizeof x->p);
    }
    s.at[0] = constraints_at(of, x->t, x->q);
    for (int pass = 0; moved < last || moved > NEARLY_AT_REST; pass++) {
        ck_assert_msg(pass < PASSES_MOST, "%s: passes move by %.1e", of->name, (double)moved);
        last = moved;
        memcpy(L, s.L, sizeof L), memcpy(K, s.K, sizeof K);
        set_forces(&s);
        set_places(&s);
        set_impulses(&s);
        correct_mu(&s);
        set_impulses(&s);
        set_places(&s);
        moved = movement(&s, (const quad(*)[SPARK_N])L, (const quad(*)[SPARK_N])K);
    }
    x->t += h;
    memcpy(x->q, s.X[count], sizeof x->q);
    for (int i = 0; i < of->n; i++)
        for (int l = 0; l < count; l++) x->p[i] += s.L[l][i] + s.K[l][i];
    project_p(of, x); /* K_m */
}
