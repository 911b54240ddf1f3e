/* taylor.c - Runs the explicit Taylor method with hand-written recurrences, for Kepler and the Solar System: what a
 * Taylor series costs when nothing is recorded. Not symplectic.
 *
 * Coefficients are scaled by the step: x_k = h^k x^(k)/k!, so that a curve's value at t + h is their plain sum.
 *   (k+1) q_{k+1} = h v_k,  (k+1) v_{k+1} = h a_k,  k = 0..N-1, with a as in series_by_hand.h.
 * q and v both to degree N: order N. O(N^2). */
#include "series_by_hand.h"
#include "state.h"

/* x + sum_{k=1}^N x_k, the small terms first. */
static INLINE void sum_up(int N, const double *c, int stride, double *x, double *low)
{
    double sum = 0;
    for (int k = N; k > 0; k--) sum += c[k * stride];
    add(x, low, sum);
}

/* ---- Kepler ------------------------------------------------------------------------------------------------------ */

static INLINE void kepler_expand(int N, double h, const power_weights *weights, kepler_series *c)
{
    for (int k = 0; k < N; k++) {
        double a[2];
        kepler_acceleration(k, weights, c, a);
        const double scale = h / (k + 1);
        c->x[k + 1] = scale * c->u[k], c->y[k + 1] = scale * c->v[k];
        c->u[k + 1] = scale * a[0], c->v[k + 1] = scale * a[1];
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

/* ---- The Solar System -------------------------------------------------------------------------------------------- */

static void solar_step(int N, double h, const power_weights *weights, state *x)
{
    solar_series c;
    for (int i = 0; i < 18; i++) c.q[0][i] = x->q[i], c.v[0][i] = x->v[i];
    for (int k = 0; k < N; k++) {
        double a[18];
        solar_acceleration(k, weights, &c, a);
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

/* ---- The method -------------------------------------------------------------------------------------------------- */

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

#define BASELINE(order_)                                                                                               \
    {                                                                                                                  \
        .name = "taylor-by-hand", .order = order_, .serves = serves, .run = run                                        \
    }
const baseline baselines_taylor[] = {BASELINE(4),  BASELINE(6),  BASELINE(8),  BASELINE(10),  BASELINE(12),
                                     BASELINE(16), BASELINE(20), BASELINE(24), {.name = NULL}};
