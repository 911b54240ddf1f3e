/* origin.h - where a step starts, and how it is added; the places where a search looks at it. */
#ifndef TVI_SRC_METHOD_ORIGIN_H
#define TVI_SRC_METHOD_ORIGIN_H

#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* The start of a step. The low-order parts of the compensated sums belong to it: it is (t + t_low, q + q_low, p +
 * p_low). */
typedef struct {
    double t, t_low;
    const double *q, *q_low, *p, *p_low;
} tvi_origin;

/* A state as the steps have it, N = n of the system that they are made of: the user's q[n], p[n] and the time are q[i],
 * p[i], i < n, and q[n]. What the steps move in is q[N]: the time, or the s of a rescaled system, whose p[n] is e. Low:
 * low-order parts. */
typedef struct {
    double *q, *q_low; /* [N + 1] */
    double *p, *p_low; /* [N] */
} tvi_run_state;

/* What a step adds to the state, in two parts: dq + dq_low and dp + dp_low, as far as the method knows them; where its
 * increments are rounded to one number, the second parts are 0. */
typedef struct {
    double *dq, *dp, *dq_low, *dp_low; /* dq and dq_low [N + 1], dp and dp_low [N] */
} tvi_increments;

/* Steps without series are to be returned, whatever their energies, up to this tail and so many passes. */
typedef struct {
    double tail;
    int passes;
} tvi_sure;
/* Steps in a row: at most so many of size h, each of them sure; `by` has the increments of the last one. Of a rescaled
 * system q[time] is the time, which goes the way of h in each of them and comes to t_end in none; else time is -1. */
typedef struct {
    double h;
    long steps;
    tvi_sure sure;
    int time;
    double t_end;
    tvi_increments by;
} tvi_row;

/* Below the roundoff of its low-order part the time does not move, and no run would ever end. */
static inline double tvi_least_time(double t) { return DBL_EPSILON * DBL_EPSILON * fabs(t); }

/* Whether a step from q is one of these by its time. */
static inline bool tvi_row_is_in_time(const tvi_row *row, const double q[])
{
    if (row->time < 0) return true;
    const double t = q[row->time], way = row->h > 0 ? 1 : -1, dt = way * row->by.dq[row->time];
    return dt > tvi_least_time(t) && dt < way * (row->t_end - t);
}

/* a + b = sum + *rest, exactly (two-sum). */
static inline double tvi_two_sum(double a, double b, double *rest)
{
    const double sum = a + b, part = sum - a;
    *rest = (a - (sum - part)) + (b - part);
    return sum;
}

/* (x, low) <- x + low + d + d_low: what is lost is of the size of low's roundoff. */
static inline double tvi_add_compensated(double x, double *low, double d, double d_low)
{
    double rest;
    const double small = tvi_two_sum(*low, d, &rest), sum = tvi_two_sum(x, small, low);
    *low += rest + d_low;
    return sum;
}

/* The same of all components. 0 where all of them are finite then, and only there. */
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

/* Where a search for events looks at a step: at the ends of equal parts of it, but its start. */
enum { TVI_SAMPLES = 8 };
extern const double tvi_sample_place[TVI_SAMPLES]; /* dense.c */

#endif
