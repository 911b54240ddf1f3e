/* first_order.h - Declares y = (q, v), y' = (v, a(q)): what the libraries integrate. */
#ifndef FIRST_ORDER_H
#define FIRST_ORDER_H

#include "forces.h"
#include "state.h"

#include <string.h>

enum { FIRST_ORDER_MAX = 2 * BASELINE_N_MAX };

#define LANES 1
#include "force_kernels.h"
#undef LANES

typedef void slope_fn(const double *y, double *slope);

/* One function for each force, so that n is known to the compiler. */
#define SLOPE(name, n)                                                                                                 \
    static void name##_slope(const double *y, double *slope)                                                           \
    {                                                                                                                  \
        memcpy(slope, y + (n), (n) * sizeof *y);                                                                       \
        name##_1(y, slope + (n));                                                                                      \
    }
FORCES_BY_HAND(SLOPE)

typedef struct {
    const baseline_task *task;
    slope_fn *slope;
    int n;
    long evaluations, steps;
} first_order;

static inline first_order first_order_of(const baseline_task *task)
{
#define ROW(name, n) name##_slope,
    static slope_fn *const slopes[FORCES] = { FORCES_BY_HAND(ROW) };
#undef ROW
    return (first_order){.task = task, .slope = slopes[force_of(task->scene)], .n = task->scene->n};
}

static inline void first_order_slope(first_order *f, const double y[], double slope[])
{
    f->slope(y, slope);
    f->evaluations++;
}

static inline void first_order_start(const first_order *f, const double q[], const double p[], double y[])
{
    for (int i = 0; i < f->n; i++) {
        y[i] = q[i];
        y[f->n + i] = p[i] / mass_of(f->task, i);
    }
}

static inline tvi_status first_order_end(const first_order *f, const double y[], double q[], double p[],
                                         baseline_counts *counts)
{
    double sum = 0;
    *counts = (baseline_counts){.steps = f->steps, .force_evaluations = f->evaluations};
    for (int i = 0; i < f->n; i++) {
        q[i] = y[i];
        p[i] = mass_of(f->task, i) * y[f->n + i];
        sum += fabs(q[i]) + fabs(p[i]);
    }
    return isfinite(sum) ? TVI_OK : TVI_ENONFINITE;
}

/* After a step: counts it, and asks the observer whether to go on. */
static inline bool first_order_goes_on(first_order *f, double t, const double y[])
{
    double p[BASELINE_N_MAX];
    f->steps++;
    if (!f->task->observer) return true;
    for (int i = 0; i < f->n; i++) p[i] = mass_of(f->task, i) * y[f->n + i];
    return f->task->observer(f->steps, t, y, p, f->task->ctx) == 0;
}

/* The absolute tolerance: a hundredth of the relative one, in units of the largest speed at the start. */
static inline double first_order_absolute(const first_order *f, const double y[])
{
    double speed = 0;
    for (int i = 0; i < f->n; i++) speed = fmax(speed, fabs(y[f->n + i]));
    return f->task->tolerance * 0.01 * (speed > 0 ? speed : 1);
}

#endif
