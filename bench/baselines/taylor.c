/* taylor.c - the explicit Taylor method with hand-written recurrences, for Kepler and the Solar System: what a Taylor
 * series costs when nothing is recorded. Not symplectic.
 *
 * Coefficients are scaled by the step: x_k = h^k x^(k)/k!, so that a curve's value at t + h is their plain sum.
 *   (k+1) q_{k+1} = h v_k,  (k+1) v_{k+1} = h a_k,  k = 0..N-1,  a = -G m w d summed over the other bodies,
 *   s = d.d:  s_k = sum_{j=0}^k d_j.d_{k-j},    (w d)_k = sum_{j=0}^k w_j d_{k-j},
 *   w = s^(-3/2), s w' = -3/2 w s':  k s_0 w_k = sum_{j=1}^k (-3/2 j - (k-j)) s_j w_{k-j}.
 * q and v both to degree N: order N. O(N^2). */
#include "forces.h"
#include "state.h"

enum { DEGREE_MAX = 24 };

/* x + sum_{k=1}^N x_k, the small terms first. */
static INLINE void sum_up(int N, const double *c, int stride, double *x, double *low)
{
    double sum = 0;
    for (int k = N; k > 0; k--) sum += c[k * stride];
    add(x, low, sum);
}

/* (-3/2 j - (k-j))/k of the recurrence of w. */
typedef struct {
    double of[DEGREE_MAX + 1][DEGREE_MAX + 1]; /* [k][j] */
} power_weights;

static void set_power_weights(int N, power_weights *w)
{
    for (int k = 1; k <= N; k++)
        for (int j = 1; j <= k; j++) w->of[k][j] = (-1.5 * j - (k - j)) / k;
}

/* ---- Kepler ------------------------------------------------------------------------------------------------------- */

typedef struct {
    double x[DEGREE_MAX + 1], y[DEGREE_MAX + 1], u[DEGREE_MAX + 1], v[DEGREE_MAX + 1]; /* q = (x, y), q' = (u, v) */
    double s[DEGREE_MAX + 1], w[DEGREE_MAX + 1];
} kepler_series;

/* Coefficient k of s and w from those of x and y up to k. */
static INLINE void kepler_power(int k, const power_weights *weights, kepler_series *c)
{
    double s = 0, w = 0;
    for (int j = 0; 2 * j < k; j++) s += 2 * (c->x[j] * c->x[k - j] + c->y[j] * c->y[k - j]);
    if (k % 2 == 0) s += c->x[k / 2] * c->x[k / 2] + c->y[k / 2] * c->y[k / 2];
    c->s[k] = s;
    for (int j = 1; j <= k; j++) w += weights->of[k][j] * c->s[j] * c->w[k - j];
    c->w[k] = k == 0 ? 1 / (s * sqrt(s)) : w / c->s[0];
}

static INLINE void kepler_expand(int N, double h, const power_weights *weights, kepler_series *c)
{
    for (int k = 0; k < N; k++) {
        double ax = 0, ay = 0;
        kepler_power(k, weights, c);
        for (int j = 0; j <= k; j++) {
            ax -= c->w[j] * c->x[k - j];
            ay -= c->w[j] * c->y[k - j];
        }
        const double scale = h / (k + 1);
        c->x[k + 1] = scale * c->u[k], c->y[k + 1] = scale * c->v[k];
        c->u[k + 1] = scale * ax, c->v[k + 1] = scale * ay;
    }
}

static void kepler_step(int N, double h, const power_weights *weights, state *x)
{
    kepler_series c;
    c.x[0] = x->q[0], c.y[0] = x->q[1], c.u[0] = x->v[0], c.v[0] = x->v[1];
    kepler_expand(N, h, weights, &c);
    c.x[1] += h * x->v_low[0], c.y[1] += h * x->v_low[1];
    sum_up(N, c.x, 1, &x->q[0], &x->q_low[0]);
    sum_up(N, c.y, 1, &x->q[1], &x->q_low[1]);
    sum_up(N, c.u, 1, &x->v[0], &x->v_low[0]);
    sum_up(N, c.v, 1, &x->v[1], &x->v_low[1]);
}

/* ---- The Solar System: its 15 pairs are lanes, with one that repeats the first ------------------------------------ */

enum { BODIES = 6, PAIRS = 15, LANES = 16 };
typedef double lanes[LANES];

typedef struct {
    _Alignas(64) lanes x[DEGREE_MAX + 1], y[DEGREE_MAX + 1], z[DEGREE_MAX + 1], s[DEGREE_MAX + 1], w[DEGREE_MAX + 1];
    double q[DEGREE_MAX + 1][18], v[DEGREE_MAX + 1][18];
} solar_series;

/* s_k = 2 sum_{2j<k} d_j.d_{k-j} + |d_{k/2}|^2 for even k. */
static INLINE void solar_square(int k, solar_series *c)
{
    lanes sum = {0};
    for (int j = 0; 2 * j < k; j++)
        FOR_LANES(l, LANES)
            sum[l] += c->x[j][l] * c->x[k - j][l] + c->y[j][l] * c->y[k - j][l] + c->z[j][l] * c->z[k - j][l];
    FOR_LANES(l, LANES) sum[l] *= 2;
    if (k % 2 == 0) {
        const double *x = c->x[k / 2], *y = c->y[k / 2], *z = c->z[k / 2];
        FOR_LANES(l, LANES) sum[l] += x[l] * x[l] + y[l] * y[l] + z[l] * z[l];
    }
    FOR_LANES(l, LANES) c->s[k][l] = sum[l];
}

/* Coefficient k of s and w from those of d up to k. */
static INLINE void solar_power(int k, const power_weights *weights, solar_series *c)
{
    lanes sum = {0};
    solar_square(k, c);
    if (k == 0) {
        FOR_LANES(l, LANES) c->w[0][l] = 1 / (c->s[0][l] * sqrt(c->s[0][l]));
        return;
    }
    for (int j = 1; j <= k; j++) FOR_LANES(l, LANES) sum[l] += weights->of[k][j] * c->s[j][l] * c->w[k - j][l];
    FOR_LANES(l, LANES) c->w[k][l] = sum[l] / c->s[0][l];
}

static INLINE void solar_distances(int k, solar_series *c)
{
    int l = 0;
    for (int i = 1; i < BODIES; i++)
        for (int j = 0; j < i; j++, l++) {
            c->x[k][l] = c->q[k][3 * i] - c->q[k][3 * j];
            c->y[k][l] = c->q[k][3 * i + 1] - c->q[k][3 * j + 1];
            c->z[k][l] = c->q[k][3 * i + 2] - c->q[k][3 * j + 2];
        }
    c->x[k][PAIRS] = c->x[k][0], c->y[k][PAIRS] = c->y[k][0], c->z[k][PAIRS] = c->z[k][0];
}

/* a_i -= G m_j w d, a_j += G m_i w d. */
static INLINE void solar_acceleration(int k, const solar_series *c, double *a)
{
    lanes f[3] = {{0}};
    for (int j = 0; j <= k; j++)
        FOR_LANES(l, LANES) {
            f[0][l] += c->w[j][l] * c->x[k - j][l];
            f[1][l] += c->w[j][l] * c->y[k - j][l];
            f[2][l] += c->w[j][l] * c->z[k - j][l];
        }
    for (int i = 0; i < 3 * BODIES; i++) a[i] = 0;
    int l = 0;
    for (int i = 1; i < BODIES; i++)
        for (int j = 0; j < i; j++, l++)
            for (int m = 0; m < 3; m++) {
                a[3 * i + m] -= SOLAR_G * SOLAR_MASS[j] * f[m][l];
                a[3 * j + m] += SOLAR_G * SOLAR_MASS[i] * f[m][l];
            }
}

static void solar_step(int N, double h, const power_weights *weights, state *x)
{
    solar_series c;
    for (int i = 0; i < 18; i++) c.q[0][i] = x->q[i], c.v[0][i] = x->v[i];
    for (int k = 0; k < N; k++) {
        double a[18];
        solar_distances(k, &c);
        solar_power(k, weights, &c);
        solar_acceleration(k, &c, a);
        const double scale = h / (k + 1);
        for (int i = 0; i < 18; i++) {
            c.q[k + 1][i] = scale * c.v[k][i];
            c.v[k + 1][i] = scale * a[i];
        }
    }
    for (int i = 0; i < 18; i++) {
        c.q[1][i] += h * x->v_low[i];
        sum_up(N, &c.q[0][i], 18, &x->q[i], &x->q_low[i]);
        sum_up(N, &c.v[0][i], 18, &x->v[i], &x->v_low[i]);
    }
}

/* ---- The method --------------------------------------------------------------------------------------------------- */

typedef void step_fn(int N, double h, const power_weights *weights, state *x);

static step_fn *step_of(const scene *s)
{
    const force_id id = force_of(s);
    return id == FORCE_KEPLER ? kepler_step : id == FORCE_SOLAR ? solar_step : NULL;
}

static bool serves(const baseline *self, const scene *s)
{
    (void)self;
    return step_of(s) != NULL;
}

static tvi_status run(const baseline *self, const baseline_task *task, double q[], double p[], baseline_counts *counts)
{
    step_fn *const step_once = step_of(task->scene);
    power_weights weights;
    state x;
    set_power_weights(self->order, &weights);
    state_start(&x, task, q, p);
    for (long step = 1; step <= task->steps; step++) {
        step_once(self->order, task->h, &weights, &x);
        if (!observed(&x, task, step)) return TVI_ESTOPPED;
    }
    *counts = (baseline_counts){.steps = task->steps};
    return state_end(&x, task, q, p);
}

#define BASELINE(order_) {.name = "taylor-by-hand", .order = order_, .serves = serves, .run = run}
const baseline baselines_taylor[] = {BASELINE(4),  BASELINE(6),  BASELINE(8),  BASELINE(10), BASELINE(12),
                                     BASELINE(16), BASELINE(20), BASELINE(24), {.name = NULL}};
