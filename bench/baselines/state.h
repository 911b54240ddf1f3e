/* state.h - Declares positions and velocities with the low parts of their compensated sums. Letters as in
 * docs/method.md. */
#ifndef STATE_H
#define STATE_H

#include "baseline.h"

#include <math.h>

typedef struct {
    double q[BASELINE_N_MAX], v[BASELINE_N_MAX], q_low[BASELINE_N_MAX], v_low[BASELINE_N_MAX];
} state;

/* x + low <- x + low + d (Kahan): the low part holds what the rounding of x leaves over. */
static INLINE void add(double *x, double *low, double d)
{
    const double y = d + *low, sum = *x + y;
    *low = (*x - sum) + y;
    *x = sum;
}

static INLINE double mass_of(const baseline_task *task, int i) { return task->scene->mass ? task->scene->mass[i] : 1; }

/* v = p/m, to twice the digits. */
static inline void state_start(state *x, const baseline_task *task, const double q[], const double p[])
{
    *x = (state){0};
    for (int i = 0; i < task->scene->n; i++) {
        const double m = mass_of(task, i);
        x->q[i] = q[i];
        x->v[i] = p[i] / m;
        x->v_low[i] = -fma(x->v[i], m, -p[i]) / m;
    }
}

/* p = m v; TVI_ENONFINITE where the state is not finite. */
static inline tvi_status state_end(const state *x, const baseline_task *task, double q[], double p[])
{
    double sum = 0;
    for (int i = 0; i < task->scene->n; i++) {
        q[i] = x->q[i] + x->q_low[i];
        p[i] = mass_of(task, i) * (x->v[i] + x->v_low[i]);
        sum += fabs(q[i]) + fabs(p[i]);
    }
    return isfinite(sum) ? TVI_OK : TVI_ENONFINITE;
}

/* Whether the observer wants to go on. */
static inline bool observed(const state *x, const baseline_task *task, long step)
{
    double q[BASELINE_N_MAX], p[BASELINE_N_MAX];
    if (!task->observer) return true;
    for (int i = 0; i < task->scene->n; i++) {
        q[i] = x->q[i];
        p[i] = mass_of(task, i) * x->v[i];
    }
    return task->observer(step, (double)step * task->h, q, p, task->ctx) == 0;
}

#endif
