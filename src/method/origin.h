/* origin.h - Declares the start of a step, its increments, and how increments are added by compensated summation. */
#ifndef TVI_SRC_METHOD_ORIGIN_H
#define TVI_SRC_METHOD_ORIGIN_H

#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* The start of a step. It includes the low-order parts of the compensated sums: the state is (t + t_low, q + q_low, p +
 * p_low). */
typedef struct {
    double t, t_low;
    const double *q, *q_low, *p, *p_low;
} tvi_origin;

/* A state of the stepped system with N = n degrees of freedom. The user's q[n], p[n] and time are q[i], p[i], i < n,
 * and q[n]. q[N] is the independent variable of the steps: the time, or s of a rescaled system, whose p[n] is e. `_low`
 * are low-order parts. */
typedef struct {
    double *q, *q_low; /* [N + 1] */
    double *p, *p_low; /* [N] */
} tvi_run_state;

/* The increments of a step, in two parts: dq + dq_low and dp + dp_low. The second parts are 0 if the method rounds its
 * increments to one number. */
typedef struct {
    double *dq, *dp, *dq_low, *dp_low; /* dq, dq_low [N + 1]; dp, dp_low [N] */
} tvi_increments;

/* Limits of the tail and of the passes, up to which a step without series needs no check of its energy. */
typedef struct {
    double tail;
    int passes;
} tvi_skip_limits;
/* Steps that are made without checks between them: at most `steps` of size h, each within `skip_limits`. `increments`
 * gets those of the last step. In a rescaled system q[time] is the time, which has to move in the direction of h and to
 * stay before t_end; otherwise `time` is -1. */
typedef struct {
    double h;
    long steps;
    tvi_skip_limits skip_limits;
    int time;
    double t_end;
    tvi_increments increments;
} tvi_step_run;

/* The least change of the time in a step, the roundoff of its low-order part. With less a run would never end. */
static inline double tvi_least_time(double t) { return DBL_EPSILON * DBL_EPSILON * fabs(t); }

/* Tells whether the time moves in the direction of h in a step from q, and stays before t_end. */
static inline bool tvi_step_ends_before(const tvi_step_run *row, const double q[])
{
    if (row->time < 0) return true;
    const double t = q[row->time], way = row->h > 0 ? 1 : -1, dt = way * row->increments.dq[row->time];
    return dt > tvi_least_time(t) && dt < way * (row->t_end - t);
}

/* a + b = sum + *rest, exactly (two-sum). */
static inline double tvi_two_sum(double a, double b, double *rest)
{
    const double sum = a + b, part = sum - a;
    *rest = (a - (sum - part)) + (b - part);
    return sum;
}

/* (x, low) <- x + low + d + d_low. The error is of the size of low's roundoff. */
static inline double tvi_add_compensated(double x, double *low, double d, double d_low)
{
    double rest;
    const double small = tvi_two_sum(*low, d, &rest), sum = tvi_two_sum(x, small, low);
    *low += rest + d_low;
    return sum;
}

/* Adds all components in this way. The result is 0 if and only if all sums are finite. */
static inline uint64_t tvi_add_all_compensated(int count, double *restrict x, double *restrict low,
                                               const double *restrict d, const double *restrict d_low)
{
    uint64_t any = 0;
    for (int i = 0; i < count; i++) {
        const double sum = tvi_add_compensated(x[i], &low[i], d[i], d_low[i]);
        any |= tvi_bits_of_infinite(sum);
        x[i] = sum;
        JET_SINGLY(count, x[i]);
    }
    return any;
}

/* The starts of the steps of several members of an ensemble, each in a lane of its own: [components][width], the member
 * fastest; t and t_low [width]. */
typedef struct {
    const double *t, *t_low;
    const double *q, *q_low, *p, *p_low;
} tvi_batch_origin;

/* The start of the step of one member. */
static inline tvi_batch_origin tvi_origin_of_one(const tvi_origin *o)
{
    return (tvi_batch_origin){&o->t, &o->t_low, o->q, o->q_low, o->p, o->p_low};
}

/* The number of points at which a search for events samples a step: the ends of equal parts of the step. */
enum { TVI_SAMPLES = 8 };
extern const double tvi_sample_theta[TVI_SAMPLES]; /* dense.c */

#endif
