/* origin.h - Declares the origin of a step, which is the state at its start, and the increments that a step makes. Adds
 * increments to states by compensated summation. All steppers and runs use the file. */
#ifndef TVI_SRC_METHOD_ORIGIN_H
#define TVI_SRC_METHOD_ORIGIN_H

#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* The origin of a step: the state at its start, with the low-order parts of the compensated sums. The state is (t +
 * t_low, q + q_low, p + p_low). */
typedef struct {
    double t, t_low;
    const double *q, *q_low, *p, *p_low;
} tvi_step_origin;

/* A state between steps, for a system in which steps are made (tvi_system.stepped_system) with N degrees of freedom.
 * q[N] is the independent variable of the steps: the time, or s of a rescaled system. If the user's system has n < N
 * degrees of freedom, it is rescaled; q[n] is then the time, and p[n] is e = -H. The arrays q_low and p_low are the
 * low-order parts of the compensated sums. */
typedef struct {
    double *q, *q_low; /* [N + 1] coordinates and independent variable, and their low-order parts */
    double *p, *p_low; /* [N] the momenta, and their low-order parts */
} tvi_run_state;

/* The increments of a step, in two parts: dq + dq_low and dp + dp_low. The second parts are 0 if the method rounds
 * its increments to one number. */
typedef struct {
    /* The increments of N coordinates and of the time, dq [N + 1], and of N momenta, dp [N], and their low-order
     * parts. */
    double *dq, *dp, *dq_low, *dp_low;
} tvi_increments;

/* Limits of the tail of a step and of the number of its passes. A step within both limits is accepted without a check
 * of its energy. */
typedef struct {
    double max_tail;
    int max_passes;
} tvi_unchecked_step_limits;

/* A request to make several steps without checks between them: at most `max_steps` steps of size h, each within
 * `unchecked_limits`. `last_step_increments_out` gets the increments of the last step, except for the increment of the
 * independent variable, dq[N], which the caller sets to h. In a rescaled system the time is the coordinate
 * q[index_of_time_in_q]. It must move in the direction of h and stay before t_end. In other systems index_of_time_in_q
 * is -1. */
typedef struct {
    double h;
    long max_steps;
    tvi_unchecked_step_limits unchecked_limits;
    int index_of_time_in_q;
    double t_end;
    tvi_increments last_step_increments_out;
} tvi_run_request;

/* Returns the least change of the time in a step, which is the roundoff of its low-order part. With smaller changes
 * a run would never end. */
static inline double tvi_least_time_change(double t) { return DBL_EPSILON * DBL_EPSILON * fabs(t); }

/* Tells whether the time moves in the direction of h in a step from q, and stays before t_end. */
static inline bool tvi_step_ends_before_t_end(const tvi_run_request *request, const double q[])
{
    if (request->index_of_time_in_q < 0) return true;
    const double t = q[request->index_of_time_in_q], way = request->h > 0 ? 1 : -1,
                 dt = way * request->last_step_increments_out.dq[request->index_of_time_in_q];
    return dt > tvi_least_time_change(t) && dt < way * (request->t_end - t);
}

/* Returns the rounded sum of a and b, and sets *rest to its exact rounding error (two-sum). */
static inline double tvi_two_sum(double a, double b, double *rest)
{
    const double sum = a + b, part = sum - a;
    *rest = (a - (sum - part)) + (b - part);
    return sum;
}

/* Adds (increment, increment_low) to (x, *low). Returns the new x, and updates *low. The error is of the size of the
 * roundoff of *low. */
static inline double tvi_add_compensated(double x, double *low, double increment, double increment_low)
{
    double rest;
    const double small = tvi_two_sum(*low, increment, &rest), sum = tvi_two_sum(x, small, low);
    *low += rest + increment_low;
    return sum;
}

/* Adds the increments of all components by compensated summation, as tvi_add_compensated does. Returns 0 if all sums
 * are finite, and otherwise another number. */
static inline uint64_t tvi_add_all_compensated(int count, double *restrict x, double *restrict low,
                                               const double *restrict increment, const double *restrict increment_low)
{
    uint64_t any = 0;
    for (int i = 0; i < count; i++) {
        const double sum = tvi_add_compensated(x[i], &low[i], increment[i], increment_low[i]);
        any |= tvi_nonzero_if_nonfinite(sum);
        x[i] = sum;
    }
    return any;
}

/* The number of points at which a search for events samples a step. */
enum { TVI_SAMPLES = 8 };
/* The positions theta of the points: t0 + theta h is the time (integrator/dense.c). */
extern const double tvi_sample_theta[TVI_SAMPLES];

#endif
