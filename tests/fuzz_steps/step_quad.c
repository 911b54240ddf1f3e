/* step_quad.c - Implements step_quad.h. */
#include "step_quad.h"
#include "method/method.h"

#include "references/quad.h"

#include <quadmath.h>
#include <string.h>

enum { DATA = 2 * N_MOST, COEFFICIENTS = ORDERS * N_MOST, PASSES = 60 };

/* A method at work on a step. */
typedef struct {
    quad_series *s;
    const tvi_options *options;
    int n, q_degree, p_degree;
    quad a;             /* the size of q, whose roundoff is that of all differences */
    quad t0, h, from;   /* the step is from + [0, 1] times h about the centre */
    quad_method rule;   /* its nodes in [0, 1], and weights */
    quad guess[N_MOST]; /* p or v at the last node */
    quad far[N_MOST];   /* both ends: p or v at the other end */
} task;

/* The ends of a curve in the step, and its action. */
typedef struct {
    quad q[2][N_MOST], p[2][N_MOST], S;
} ends;

static quad dot(int n, const quad a[], const quad b[])
{
    quad sum = 0;
    for (int i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* The largest coordinate, or 1. */
static quad size_of(int n, const quad q[])
{
    quad size = 1;
    for (int i = 0; i < n; i++) size = fmaxq(size, fabsq(q[i]));
    return size;
}

/* sum_{k <= degree} C_k t^k, and its derivative. */
static void value_of(int n, int degree, const quad *C, quad t, quad x[])
{
    for (int i = 0; i < n; i++) {
        x[i] = 0;
        for (int k = degree; k >= 0; k--) x[i] = x[i] * t + C[k * n + i];
    }
}

static void slope_of(int n, int degree, const quad *C, quad t, quad x[])
{
    for (int i = 0; i < n; i++) {
        x[i] = 0;
        for (int k = degree; k >= 1; k--) x[i] = x[i] * t + k * C[k * n + i];
    }
}

/* ---- The action -------------------------------------------------------------------------------------------------- */

/* L(q, v, t) = p.v - H(q, p, t) with H_p(q, p) = v. */
static bool lagrangian(task *x, quad t, const quad q[], const quad v[], quad *L)
{
    if (x->s->source->form == OF_LAGRANGIAN) {
        *L = quad_energy_of(x->s, t, q, v);
        return true;
    }
    if (!quad_legendre(x->s, t, q, v, x->guess)) return false;
    *L = dot(x->n, x->guess, v) - quad_energy_of(x->s, t, q, x->guess);
    return true;
}

/* L, or p.q' - H, at node i of the curve; its time is that of the centre plus s. */
static bool integrand(task *x, int i, quad centre, const quad *Q, const quad *P, quad *value)
{
    const bool truncated = x->options->nodes == TVI_NODES_TRUNCATED, at_end = x->rule.c[i] == 0 || x->rule.c[i] == 1;
    const quad s = (x->from + x->rule.c[i]) * x->h, t = centre + s;
    quad q[N_MOST], p[N_MOST], v[N_MOST], force[N_MOST];
    value_of(x->n, x->q_degree - (truncated && !at_end), Q, s, q);
    slope_of(x->n, x->q_degree, Q, s, v);
    if (x->options->method == TVI_TYPE1) return lagrangian(x, t, q, v, value);
    value_of(x->n, x->p_degree, P, s, p);
    if (truncated) quad_field(x->s, t, q, p, v, force);
    *value = dot(x->n, p, v) - quad_energy_of(x->s, t, q, p);
    return true;
}

/* Computes the curve with data z = (q, p) or (q, v) at the centre. */
static bool ends_of(task *x, const quad z[], ends *e)
{
    quad Q[COEFFICIENTS], P[COEFFICIENTS], value;
    const quad centre = x->t0 - x->from * x->h;
    if (!quad_curve(x->s, centre, z, z + x->n, x->q_degree, Q, P)) return false;
    for (int side = 0; side < 2; side++) {
        value_of(x->n, x->q_degree, Q, (x->from + side) * x->h, e->q[side]);
        value_of(x->n, x->p_degree, P, (x->from + side) * x->h, e->p[side]);
    }
    e->S = 0;
    for (int i = 0; i < x->rule.points; i++) {
        if (!integrand(x, i, centre, Q, P, &value)) return false;
        e->S += x->h * x->rule.b[i] * value;
    }
    return true;
}

/* The curve b of the other end, which leads back to q0: b(-h) = q0, its p or v in x->far, by Newton's method with the
 * slope of a straight line. */
static bool curve_back(task *x, const quad q0[], const quad q1[], quad *Q, quad *P)
{
    quad back[N_MOST], A[N_MOST * N_MOST], size = 1, before;
    for (int pass = 0; pass < 2 * PASSES; pass++) {
        if (!quad_curve(x->s, x->t0 + x->h, q1, x->far, x->q_degree, Q, P)) return false;
        value_of(x->n, x->q_degree, Q, -x->h, back);
        for (int i = 0; i < x->n; i++) back[i] = (back[i] - q0[i]) / x->h;
        if (x->s->source->form != OF_LAGRANGIAN) {
            quad_set(x->s, x->t0 + x->h, q1, x->far);
            quad_bend(x->s, A);
            if (!quad_solve(x->n, A, back)) return false;
        }
        before = size, size = 0;
        for (int i = 0; i < x->n; i++) size = fmaxq(size, fabsq(back[i]));
        if (!finiteq(size)) return false;
        if (size < 1e-31 || (size < 1e-28 * x->a / fabsq(x->h) && size >= before)) return true;
        for (int i = 0; i < x->n; i++) x->far[i] += back[i];
    }
    return false;
}

/* z = (q0, p0 or v0); y = w a + (1 - w) b with w = 1 - s. */
static bool ends_of_both(task *x, const quad z[], ends *e)
{
    const int n = x->n, N = x->q_degree;
    quad A[COEFFICIENTS], B[COEFFICIENTS], P[COEFFICIENTS], value, q[2][N_MOST], v[2][N_MOST];
    if (!quad_curve(x->s, x->t0, z, z + n, N, A, P)) return false;
    value_of(n, N, A, 0, e->q[0]);
    value_of(n, N, A, x->h, e->q[1]);
    value_of(n, x->p_degree, P, 0, e->p[0]);
    if (!curve_back(x, e->q[0], e->q[1], B, P)) return false;
    value_of(n, x->p_degree, P, 0, e->p[1]);
    e->S = 0;
    for (int k = 0; k < x->rule.points; k++) {
        const quad s = x->rule.c[k], t = x->t0 + s * x->h;
        value_of(n, N, A, s * x->h, q[0]), value_of(n, N, B, (s - 1) * x->h, q[1]);
        slope_of(n, N, A, s * x->h, v[0]), slope_of(n, N, B, (s - 1) * x->h, v[1]);
        for (int i = 0; i < n; i++) {
            const quad apart = x->options->nodes == TVI_NODES_ON_CURVE ? (q[0][i] - q[1][i]) / x->h : 0;
            q[0][i] = (1 - s) * q[0][i] + s * q[1][i];
            v[0][i] = (1 - s) * v[0][i] + s * v[1][i] - apart;
        }
        if (!lagrangian(x, t, q[0], v[0], &value)) return false;
        e->S += x->h * x->rule.b[k] * value;
    }
    return true;
}

static bool curve_ends(task *x, const quad z[], ends *e)
{
    return x->options->expansion == TVI_AT_BOTH_ENDS ? ends_of_both(x, z, e) : ends_of(x, z, e);
}

/* ---- The generating function ------------------------------------------------------------------------------------- */

/* W and its arguments a, b [n]: dW = A.da + B.db is
 *   type I    W = S             dS = p1.dq+ - p0.dq-          type II   W = p+.q+ - S      dW = q1.dp+ + p0.dq-
 *   type III  W = -p-.q- - S    dW = -p1.dq+ - q0.dp-         Poincare  W = S - pm.(q+ - q-)   dW = -(q1 - q0).dpm +
 * (p1 - p0).dqm, qm, pm the means of the ends. */
static quad generating(const task *x, const ends *e, quad a[], quad b[])
{
    const tvi_method method = x->options->method;
    quad rise = 0;
    for (int i = 0; i < x->n; i++) {
        const quad qm = (e->q[0][i] + e->q[1][i]) / 2, pm = (e->p[0][i] + e->p[1][i]) / 2;
        a[i] = method == TVI_TYPE2 ? e->p[1][i] : method == TVI_POINCARE ? pm : e->q[1][i];
        b[i] = method == TVI_TYPE3 ? e->p[0][i] : method == TVI_POINCARE ? qm : e->q[0][i];
        rise += pm * (e->q[1][i] - e->q[0][i]);
    }
    switch (method) {
    case TVI_TYPE1: return e->S;
    case TVI_TYPE2: return dot(x->n, e->p[1], e->q[1]) - e->S;
    case TVI_TYPE3: return -dot(x->n, e->p[0], e->q[0]) - e->S;
    default: return e->S - rise;
    }
}

/* The ends that A and B of dW = A.da + B.db, and the curve's a and b, are. */
static void assign(const task *x, const ends *e, const quad A[], const quad B[], ends *map)
{
    const tvi_method method = x->options->method;
    *map = *e;
    for (int i = 0; i < x->n; i++) {
        const quad qm = (e->q[0][i] + e->q[1][i]) / 2, pm = (e->p[0][i] + e->p[1][i]) / 2;
        if (method == TVI_TYPE1) map->p[1][i] = A[i], map->p[0][i] = -B[i];
        if (method == TVI_TYPE2) map->q[1][i] = A[i], map->p[0][i] = B[i];
        if (method == TVI_TYPE3) map->p[1][i] = -A[i], map->q[0][i] = -B[i];
        if (method != TVI_POINCARE) continue;
        map->q[0][i] = qm + A[i] / 2, map->q[1][i] = qm - A[i] / 2;
        map->p[0][i] = pm - B[i] / 2, map->p[1][i] = pm + B[i] / 2;
    }
}

/* The state before and after the step that belongs to z; K [2n][2n], where it is not NULL: the derivatives of the
 * curve's (q-, p-), which are nearly those of the state before. */
static bool map_of(task *x, const quad z[], ends *map, quad *K)
{
    const int n = x->n, rows = 2 * n;
    const quad d = 1e-11 * cbrtq(x->a); /* the error d^2 is the roundoff a / d */
    quad G[DATA * DATA], W[DATA], moved[DATA], a[2][N_MOST], b[2][N_MOST];
    ends centre, e[2];
    if (!curve_ends(x, z, &centre)) return false;
    for (int j = 0; j < rows; j++) {
        quad w[2];
        for (int sign = 0; sign < 2; sign++) {
            memcpy(moved, z, sizeof moved);
            moved[j] += sign ? d : -d;
            if (!curve_ends(x, moved, &e[sign])) return false;
            w[sign] = generating(x, &e[sign], a[sign], b[sign]);
        }
        W[j] = (w[1] - w[0]) / (2 * d);
        for (int i = 0; i < n; i++) {
            G[j * rows + i] = (a[1][i] - a[0][i]) / (2 * d);
            G[j * rows + n + i] = (b[1][i] - b[0][i]) / (2 * d);
            if (K) K[i * rows + j] = (e[1].q[0][i] - e[0].q[0][i]) / (2 * d);
            if (K) K[(n + i) * rows + j] = (e[1].p[0][i] - e[0].p[0][i]) / (2 * d);
        }
    }
    if (!quad_solve(rows, G, W)) return false;
    assign(x, &centre, W, W + n, map);
    return true;
}

/* K += (R - (R_before + K dz)) dz^T / dz.dz, and R_before + K dz = 0 (Broyden). */
static void update(int rows, quad *K, const quad R[], const quad dz[])
{
    const quad size = dot(rows, dz, dz);
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < rows; j++) K[i * rows + j] += R[i] * dz[j] / size;
}

/* The z whose state before the step is (q, p); that after it is put there. */
static bool solve_step(task *x, quad z[], quad q[], quad p[])
{
    const int n = x->n, rows = 2 * n;
    quad K[DATA * DATA], kept[DATA * DATA], dz[DATA], R[DATA];
    ends map;
    if (!map_of(x, z, &map, K)) return false;
    for (int pass = 0; pass < PASSES; pass++) {
        quad size = 0;
        for (int i = 0; i < n; i++) R[i] = map.q[0][i] - q[i], R[n + i] = map.p[0][i] - p[i];
        if (pass > 0) update(rows, K, R, dz);
        for (int i = 0; i < rows; i++) size = fmaxq(size, fabsq(R[i])), dz[i] = -R[i];
        if (!finiteq(size)) return false;
        if (size < 1e-19 * x->a) {
            for (int i = 0; i < n; i++) q[i] = map.q[1][i], p[i] = map.p[1][i];
            return true;
        }
        memcpy(kept, K, sizeof kept);
        if (!quad_solve(rows, kept, dz)) return false;
        for (int i = 0; i < rows; i++) z[i] += dz[i];
        if (!map_of(x, z, &map, NULL)) return false;
    }
    return false;
}

static bool generated_step(quad_series *s, const tvi_options *options, quad h, quad t, quad q[], quad p[])
{
    const int n = s->source->n, N = options->degree, p_degree = options->method == TVI_POINCARE ? N : N - 1;
    const tvi_step_span span = tvi_find_method(options)->curve.step_span;
    const quad from = span.start_s / ((quad)span.end_s - span.start_s);
    task x = {s, options, n, N, p_degree, size_of(n, q), t, h, from, .rule = {.points = 2}};
    quad z[DATA] = {0}, Q[COEFFICIENTS], P[COEFFICIENTS];
    x.rule = quad_method_gauss(TVI_AT_START, TVI_NODES_ON_CURVE, 1, options->quadrature_points);
    if (options->quadrature == TVI_TRAPEZOID)
        x.rule = (quad_method){.points = 2, .b = {(quad)0.5, (quad)0.5}, .c = {0, 1}};
    for (int i = 0; i < n; i++) z[i] = q[i], z[n + i] = p[i];
    if (s->source->form == OF_LAGRANGIAN && !quad_legendre(s, t, q, p, z + n)) return false;
    const bool moves = quad_curve(s, t, z, z + n, N + 1, Q, P);
    memcpy(x.guess, z + n, sizeof x.guess);
    memcpy(x.far, z + n, sizeof x.far);
    value_of(n, N + 1, Q, -from * h, z);
    if (s->source->form == OF_LAGRANGIAN) slope_of(n, N + 1, Q, -from * h, z + n);
    else value_of(n, N + 1, P, -from * h, z + n);
    return moves && solve_step(&x, z, q, p);
}

/* ---- The other methods ------------------------------------------------------------------------------------------- */

/* q to degree N, p to degree N - 1. */
static bool taylor(quad_series *s, int degree, int p_degree, quad h, quad t, quad q[], quad p[])
{
    quad Q[COEFFICIENTS], P[COEFFICIENTS], r[N_MOST];
    memcpy(r, p, sizeof r);
    if (s->source->form == OF_LAGRANGIAN && !quad_legendre(s, t, q, p, r)) return false;
    if (!quad_curve(s, t, q, r, degree, Q, P)) return false;
    value_of(s->source->n, degree, Q, h, q);
    value_of(s->source->n, p_degree, P, h, p);
    return true;
}

bool quad_flow(quad_series *s, quad h, quad t, quad q[], quad p[])
{
    return taylor(s, ORDERS - 2, ORDERS - 2, h, t, q, p);
}

static void kick(quad_series *s, quad h, quad t, const quad q[], quad p[])
{
    quad v[N_MOST], F[N_MOST];
    quad_field(s, t, q, p, v, F);
    for (int i = 0; i < s->source->n; i++) p[i] += h / 2 * F[i];
}

static bool verlet(quad_series *s, quad h, quad t, quad q[], quad p[])
{
    kick(s, h, t, q, p);
    for (int i = 0; i < s->source->n; i++) q[i] += h * p[i] / (quad)s->source->mass[i];
    kick(s, h, t + h, q, p);
    return true;
}

/* (q', p') at a node: (v, L_q) with L_v(q, v) = p for a Lagrangian. */
static bool rates(quad_series *s, quad t, const quad q[], const quad p[], quad v[], quad force[])
{
    if (s->source->form != OF_LAGRANGIAN) {
        quad_field(s, t, q, p, v, force);
        return true;
    }
    if (!quad_legendre(s, t, q, p, v)) return false;
    quad_set(s, t, q, v);
    quad_run(s, 0);
    for (int i = 0; i < s->source->n; i++) force[i] = s->c[s->source->dq[i]][0];
    return true;
}

/* Gauss collocation: X_i = x0 + h sum_j a_ij X'_j, x1 = x0 + h sum_j b_j X'_j. */
static bool collocate(quad_series *s, int m, quad h, quad t, quad q[], quad p[])
{
    const quad_method gauss = quad_method_gauss(TVI_AT_START, TVI_NODES_ON_CURVE, 1, m);
    const int n = s->source->n;
    const quad least = 1e-29 * size_of(n, q);
    quad x[TVI_MAX_NODES + 1][DATA], rate[TVI_MAX_NODES][DATA] = {{0}}, a[TVI_MAX_NODES + 1][TVI_MAX_NODES], change = 1;
    for (int i = 0; i <= m; i++)
        for (int j = 0; j < m; j++) a[i][j] = i < m ? quad_method_integral(&gauss, j, gauss.c[i]) : gauss.b[j];
    for (int i = 0; i < m; i++) memcpy(x[i], q, (size_t)n * sizeof *q), memcpy(x[i] + n, p, (size_t)n * sizeof *p);
    for (int pass = 0; pass < 4 * PASSES && change > least; pass++) {
        for (int j = 0; j < m; j++)
            if (!rates(s, t + gauss.c[j] * h, x[j], x[j] + n, rate[j], rate[j] + n)) return false;
        change = 0;
        for (int i = 0; i <= m; i++)
            for (int k = 0; k < 2 * n; k++) {
                quad sum = k < n ? q[k] : p[k - n];
                for (int j = 0; j < m; j++) sum += h * a[i][j] * rate[j][k];
                if (i < m) change = fmaxq(change, fabsq(sum - x[i][k]));
                x[i][k] = sum;
            }
    }
    memcpy(q, x[m], (size_t)n * sizeof *q);
    memcpy(p, x[m] + n, (size_t)n * sizeof *p);
    return change <= least;
}

static bool one_step(quad_series *s, const tvi_options *options, quad h, quad t, quad q[], quad p[])
{
    if (options->method == TVI_TAYLOR) return taylor(s, options->degree, options->degree - 1, h, t, q, p);
    if (options->method == TVI_STORMER_VERLET) return verlet(s, h, t, q, p);
    if (options->expansion == TVI_AT_NODES) return collocate(s, options->degree, h, t, q, p);
    return generated_step(s, options, h, t, q, p);
}

bool quad_step(quad_series *s, const tvi_options *options, quad h, quad t, quad q[], quad p[])
{
    if (!options->compose_adjoint) return one_step(s, options, h, t, q, p);
    const tvi_options adjoint = tvi_adjoint_options(options);
    return one_step(s, options, h / 2, t, q, p) && one_step(s, &adjoint, h / 2, t + h / 2, q, p);
}
