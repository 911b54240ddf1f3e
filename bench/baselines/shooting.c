/* shooting.c - Runs shooting-based variational integrators (ShVI) of orders 4 and 6: M. Leok and T. Shingel, General
 * techniques for constructing variational integrators, Front. Math. China 7 (2012), as the paper compares with.
 *
 * A Runge-Kutta step Psi_t on (q, v) goes from each quadrature node to the next, from (q0, v) with v such that the last
 * node, c_m = 1, has q_m = q1, and so defines
 *   Ld(q0, q1) = h sum_i b_i L(q_i, v_i),  (q_i, v_i) = Psi_{(c_i - c_{i-1}) h}(q_{i-1}, v_{i-1}).
 * The order is min(order of Psi, order of the quadrature):
 *   order 4: the classical Runge-Kutta method and Simpson's rule (2 steps of 4 stages);
 *   order 6: Luther's method of 7 stages and Lobatto's rule of 4 points (3 steps of 7 stages).
 * The discrete Legendre transforms p0 = -D1 Ld, p1 = D2 Ld come from the tangents X_i = dq_i/d(q0,v), Y_i =
 * dv_i/d(q0,v), carried through every stage with the force's Jacobian: exact derivatives of the discrete flow. As for
 * any one-step method (docs/method.md section 4, type I at the start), with [A B] = X_m and S = Ld as a function of
 * (q0, v),
 *   B^T p1 = S_v,   p0 = A^T p1 - S_q,   S_z = h sum_i b_i (X_i^T F(q_i) + Y_i^T M v_i).
 * Splitting off the free motion, B = h + B', dv_i/dv = 1 + Y', v_i = v + u_i, leaves nothing to cancel:
 *   p1 = M v + g,  B^T g = h sum_i b_i ((dq_i/dv)^T F_i + Y'^T M v_i + M u_i) - B'^T M v,
 *   p1 - p0 = S_q - (A - 1)^T p1.
 * v is found by the Newton iteration with M for its matrix, dp0/dv = M + O(h^order): M (v - v0) <- (p1 - p0) - g with
 * M v0 = p0, which contracts by O(h^order) a pass, to roundoff. */
#include "forces.h"
#include "jacobians.h"
#include "state.h"

#include <string.h>

#define LANES 1
#include "force_kernels.h"
#undef LANES

enum { STAGES_MAX = 7, NODES_MAX = 4, MOST_PASSES = 50, COLUMNS_MAX = 2 * BASELINE_N_MAX };
static const double ROUNDOFF = 1e-13; /* relative: below it, passes that no longer converge are at roundoff */
static const double NEGLIGIBLE = 1e-18;

/* ---- The rules --------------------------------------------------------------------------------------------------- */

/* A Runge-Kutta method for q'' = a(q): c, A^2, b and b A instead of c, A, b. It is the same method. */
typedef struct {
    int stages, nodes;
    double c[STAGES_MAX], a2[STAGES_MAX][STAGES_MAX], b[STAGES_MAX], b2[STAGES_MAX];
    double node[NODES_MAX], weight[NODES_MAX];
} shooting_rule;

static void set_runge_kutta(shooting_rule *r, int stages, double a[STAGES_MAX][STAGES_MAX], const double b[])
{
    r->stages = stages;
    memset(r->c, 0, sizeof r->c);
    memset(r->b2, 0, sizeof r->b2);
    memset(r->a2, 0, sizeof r->a2);
    for (int i = 0; i < stages; i++) {
        r->b[i] = b[i];
        for (int j = 0; j < stages; j++) {
            r->c[i] += a[i][j];
            r->b2[i] += b[j] * a[j][i];
            for (int k = 0; k < stages; k++) r->a2[i][j] += a[i][k] * a[k][j];
        }
    }
}

static void set_order_4(shooting_rule *r)
{
    double a[STAGES_MAX][STAGES_MAX] = {{0}, {1.0 / 2}, {0, 1.0 / 2}, {0, 0, 1}};
    const double b[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    set_runge_kutta(r, 4, a, b);
    r->nodes = 3;
    memcpy(r->node, (const double[NODES_MAX]){0, 0.5, 1}, sizeof r->node);
    memcpy(r->weight, (const double[NODES_MAX]){1.0 / 6, 2.0 / 3, 1.0 / 6}, sizeof r->weight);
}

/* H. A. Luther, An explicit sixth-order Runge-Kutta formula, Math. Comp. 22 (1968), with nu = 1. */
static void set_order_6(shooting_rule *r)
{
    const double z = sqrt(21), x = 1 / sqrt(5);
    double a[STAGES_MAX][STAGES_MAX] = {
        {0},
        {1},
        {3.0 / 8, 1.0 / 8},
        {8.0 / 27, 2.0 / 27, 8.0 / 27},
        {3 * (3 * z - 7) / 392, -8 * (7 - z) / 392, 48 * (7 - z) / 392, -3 * (21 - z) / 392},
        {-5 * (231 + 51 * z) / 1960, -40 * (7 + z) / 1960, -320 * z / 1960, 3 * (21 + 121 * z) / 1960,
         392 * (6 + z) / 1960},
        {15 * (22 + 7 * z) / 180, 120.0 / 180, 40 * (7 * z - 5) / 180, -63 * (3 * z - 2) / 180,
         -14 * (49 + 9 * z) / 180, 70 * (7 - z) / 180},
    };
    const double b[] = {9.0 / 180, 0, 64.0 / 180, 0, 49.0 / 180, 49.0 / 180, 9.0 / 180};
    set_runge_kutta(r, 7, a, b);
    r->nodes = 4;
    memcpy(r->node, (const double[NODES_MAX]){0, (1 - x) / 2, (1 + x) / 2, 1}, sizeof r->node);
    memcpy(r->weight, (const double[NODES_MAX]){1.0 / 12, 5.0 / 12, 5.0 / 12, 1.0 / 12}, sizeof r->weight);
}

/* ---- One step of the Runge-Kutta method with its tangents -------------------------------------------------------- */

typedef void force_fn(const double *restrict q, double *restrict a);
typedef void jacobian_fn(const double *q, double *J);

/* At time t after the start: q_i = q0 + d, v_i = v + u, dq_i/d(q0,v) = [1, t] + X, dv_i/d(q0,v) = [0, 1] + Y. */
typedef struct {
    double t, d[BASELINE_N_MAX], u[BASELINE_N_MAX];
    _Alignas(64) double X[BASELINE_N_MAX * COLUMNS_MAX], Y[BASELINE_N_MAX * COLUMNS_MAX];
} flow;

/* Values and tangents of the accelerations at the stages. */
typedef struct {
    double a[STAGES_MAX][BASELINE_N_MAX];
    _Alignas(64) double K[STAGES_MAX * BASELINE_N_MAX * COLUMNS_MAX]; /* [stage][n][2 n] */
} stages;

/* out += sum_j w_j k_j, j < count. */
static INLINE void accumulate(int size, int count, const double *w, double scale, const double *k, int stride,
                              double *out)
{
    for (int j = 0; j < count; j++) {
        const double weight = scale * w[j];
        if (weight == 0) continue;
        for (int i = 0; i < size; i++) out[i] += weight * k[j * stride + i];
    }
}

/* K_j = J ([1, t] + X + s Y + tau^2 sum_l a2_jl K_l), the tangent of stage j; s = c_j tau, t from the step's start. */
static INLINE void stage_tangent(int n, const shooting_rule *r, int j, double tau, jacobian_fn *jacobian,
                                 const double *q, const flow *f, stages *k)
{
    double J[BASELINE_N_MAX * BASELINE_N_MAX], Z[BASELINE_N_MAX * COLUMNS_MAX];
    const int size = 2 * n * n, columns = 2 * n;
    const double s = r->c[j] * tau;
    for (int i = 0; i < size; i++) Z[i] = f->X[i] + s * f->Y[i];
    accumulate(size, j, r->a2[j], tau * tau, k->K, size, Z);
    for (int i = 0; i < n; i++) {
        Z[i * columns + i] += 1;
        Z[i * columns + n + i] += f->t + s;
    }
    jacobian(q, J);
    for (int i = 0; i < n; i++) {
        double K[COLUMNS_MAX] = {0};
        for (int m = 0; m < n; m++)
            for (int c = 0; c < columns; c++) K[c] += J[i * n + m] * Z[m * columns + c];
        for (int c = 0; c < columns; c++) k->K[j * size + i * columns + c] = K[c];
    }
}

/* f <- Psi_tau(f); k->a[0] is the acceleration at f already. */
static INLINE void runge_kutta(int n, const shooting_rule *r, double tau, force_fn *force, jacobian_fn *jacobian,
                               const double *q0, const double *v, flow *f, stages *k)
{
    const int size = 2 * n * n;
    for (int j = 0; j < r->stages; j++) {
        double q[BASELINE_N_MAX], d[BASELINE_N_MAX];
        for (int i = 0; i < n; i++) d[i] = f->d[i] + r->c[j] * tau * (v[i] + f->u[i]);
        accumulate(n, j, r->a2[j], tau * tau, k->a[0], BASELINE_N_MAX, d);
        for (int i = 0; i < n; i++) q[i] = q0[i] + d[i];
        if (j > 0) force(q, k->a[j]);
        stage_tangent(n, r, j, tau, jacobian, q, f, k);
    }
    for (int i = 0; i < n; i++) f->d[i] += tau * (v[i] + f->u[i]);
    for (int i = 0; i < size; i++) f->X[i] += tau * f->Y[i];
    accumulate(n, r->stages, r->b2, tau * tau, k->a[0], BASELINE_N_MAX, f->d);
    accumulate(n, r->stages, r->b, tau, k->a[0], BASELINE_N_MAX, f->u);
    accumulate(size, r->stages, r->b2, tau * tau, k->K, size, f->X);
    accumulate(size, r->stages, r->b, tau, k->K, size, f->Y);
    f->t += tau;
}

/* ---- The discrete Legendre transforms ---------------------------------------------------------------------------- */

/* Gaussian elimination with row exchanges: b <- A^-1 b; A is overwritten. false: singular. */
static INLINE bool solve(int n, double *A, double *b)
{
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(A[i * n + k]) > fabs(A[pivot * n + k])) pivot = i;
        for (int j = k; j < n; j++) {
            const double t = A[k * n + j];
            A[k * n + j] = A[pivot * n + j], A[pivot * n + j] = t;
        }
        const double t = b[k];
        b[k] = b[pivot], b[pivot] = t;
        if (!(fabs(A[k * n + k]) > 0)) return false;
        for (int i = k + 1; i < n; i++) {
            const double factor = A[i * n + k] / A[k * n + k];
            for (int j = k + 1; j < n; j++) A[i * n + j] -= factor * A[k * n + j];
            b[i] -= factor * b[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++) b[k] -= A[k * n + j] * b[j];
        b[k] /= A[k * n + k];
    }
    return true;
}

/* s_q, s_v += weight (dq/dz^T F + dv/dz^T M (v + u)) of one node, s_v without the part weight M v of the free
 * motion. */
static INLINE void add_node(int n, double weight, const double *m, const double *v, const flow *f, const double *a,
                            double *s_q, double *s_v)
{
    const int columns = 2 * n;
    for (int i = 0; i < n; i++) {
        const double F = weight * m[i] * a[i], P = weight * m[i] * (v[i] + f->u[i]);
        s_q[i] += F;
        s_v[i] += f->t * F + weight * m[i] * f->u[i];
        for (int c = 0; c < n; c++) {
            s_q[c] += f->X[i * columns + c] * F + f->Y[i * columns + c] * P;
            s_v[c] += f->X[i * columns + n + c] * F + f->Y[i * columns + n + c] * P;
        }
    }
}

/* B^T g = s_v - B'^T M v into s_v; then s_q <- s_q - (A - 1)^T (M v + g) = p1 - p0. false: B is singular. */
static INLINE bool legendre(int n, const double *m, const double *v, const flow *f, double *s_q, double *s_v)
{
    const int columns = 2 * n;
    double B[BASELINE_N_MAX * BASELINE_N_MAX];
    for (int i = 0; i < n; i++)
        for (int c = 0; c < n; c++) {
            const double x = f->X[i * columns + n + c];
            B[c * n + i] = x + (c == i ? f->t : 0);
            s_v[c] -= x * m[i] * v[i];
        }
    if (!solve(n, B, s_v)) return false;
    for (int i = 0; i < n; i++)
        for (int c = 0; c < n; c++) s_q[c] -= f->X[i * columns + c] * (m[i] * v[i] + s_v[i]);
    return true;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

typedef struct {
    double v[BASELINE_N_MAX]; /* at the start of the curve */
    double g[BASELINE_N_MAX], dp[BASELINE_N_MAX];
    flow f;
    stages k;
} shot;

/* From v: the curve, g and p1 - p0. false: B is singular. */
static INLINE bool shoot(int n, const shooting_rule *r, double h, force_fn *force, jacobian_fn *jacobian,
                         const double *m, const double *q0, shot *x)
{
    double q[BASELINE_N_MAX];
    x->f.t = 0;
    for (int k = 0; k < n; k++) x->f.d[k] = x->f.u[k] = x->g[k] = x->dp[k] = 0;
    for (int k = 0; k < 2 * n * n; k++) x->f.X[k] = x->f.Y[k] = 0;
    for (int i = 0; i < r->nodes; i++) {
        if (i > 0) runge_kutta(n, r, h * (r->node[i] - r->node[i - 1]), force, jacobian, q0, x->v, &x->f, &x->k);
        for (int k = 0; k < n; k++) q[k] = q0[k] + x->f.d[k];
        force(q, x->k.a[0]);
        add_node(n, h * r->weight[i], m, x->v, &x->f, x->k.a[0], x->dp, x->g);
    }
    return legendre(n, m, x->v, &x->f, x->dp, x->g);
}

/* Whether the next pass is the last: what it would leave, judged by the last two, is far below roundoff (anything
 * nearer would push the energy one way), or the passes no longer converge, at roundoff. */
static INLINE bool settled(double before, double now, double size)
{
    return (before < INFINITY && now * (now / before) <= NEGLIGIBLE * size) || (now >= before && now < ROUNDOFF * size);
}

/* v <- v0 + ((p1 - p0) - g)/M until it has settled; the result is that of the last pass. correction: v - v0, at first a
 * guess of it. */
static INLINE tvi_status iterate(int n, const shooting_rule *r, double h, force_fn *force, jacobian_fn *jacobian,
                                 const double *m, const state *at, double *correction, shot *x, long *passes)
{
    double before = INFINITY;
    bool last = false;
    for (int pass = 0; pass < MOST_PASSES; pass++) {
        double now = 0, size = 0;
        for (int k = 0; k < n; k++) x->v[k] = at->v[k] + (at->v_low[k] + correction[k]);
        if (!shoot(n, r, h, force, jacobian, m, at->q, x)) return TVI_ESINGULAR;
        ++*passes;
        for (int k = 0; k < n; k++) {
            const double next = (x->dp[k] - x->g[k]) / m[k];
            now += fabs(next - correction[k]);
            size += fabs(x->v[k]) + fabs(x->f.u[k]);
            correction[k] = next;
        }
        if (last || now == 0) return TVI_OK;
        if (!(now < INFINITY)) return TVI_ENOCONV;
        last = settled(before, now, size);
        before = now;
    }
    return TVI_ENOCONV;
}

static INLINE tvi_status integrate(int n, const shooting_rule *r, force_fn *force, jacobian_fn *jacobian,
                                   const baseline_task *task, double q[], double p[], baseline_counts *counts)
{
    double m[BASELINE_N_MAX], correction[BASELINE_N_MAX] = {0};
    state x;
    shot last;
    for (int k = 0; k < n; k++) m[k] = mass_of(task, k);
    state_start(&x, task, q, p);
    for (long step = 1; step <= task->steps; step++) {
        const tvi_status status = iterate(n, r, task->h, force, jacobian, m, &x, correction, &last, &counts->passes);
        if (status != TVI_OK) return status;
        for (int k = 0; k < n; k++) {
            add(&x.q[k], &x.q_low[k], last.f.d[k]);
            add(&x.v[k], &x.v_low[k], last.dp[k] / m[k]);
        }
        if (!observed(&x, task, step)) return TVI_ESTOPPED;
    }
    counts->steps = task->steps;
    counts->force_evaluations = counts->passes * (r->stages * (r->nodes - 1) + 1);
    return state_end(&x, task, q, p);
}

typedef tvi_status shooting_fn(const shooting_rule *r, const baseline_task *task, double q[], double p[],
                               baseline_counts *counts);

#define SHOOT(name, n)                                                                                                 \
    static tvi_status name##_shoot(const shooting_rule *r, const baseline_task *task, double q[], double p[],          \
                                   baseline_counts *counts)                                                            \
    {                                                                                                                  \
        return integrate(n, r, name##_1, name##_jacobian, task, q, p, counts);                                         \
    }
FORCES_BY_HAND(SHOOT)

#define ROW(name, n) name##_shoot,
static shooting_fn *const functions[FORCES] = {FORCES_BY_HAND(ROW)};

static tvi_status run(const baseline *self, const baseline_task *task, double q[], double p[], baseline_counts *counts)
{
    shooting_rule rule;
    *counts = (baseline_counts){0};
    if (self->order == 4) set_order_4(&rule);
    else set_order_6(&rule);
    return functions[force_of(task->scene)](&rule, task, q, p, counts);
}

const baseline baselines_shooting[] = {
    {.name = "shooting", .order = 4, .symplectic = true, .run = run},
    {.name = "shooting", .order = 6, .symplectic = true, .run = run},
    {.name = NULL},
};
