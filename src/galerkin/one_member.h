/* one_member.h - Defines the loops that only a single member has: impulses in two parts, and the curve at other
 * points. */
#ifndef TVI_SRC_GALERKIN_ONE_MEMBER_H
#define TVI_SRC_GALERKIN_ONE_MEMBER_H

#include "galerkin/lanes.h"
#include "rule.h"

#include <math.h>

/* a b + c, rounded once if c is small beside a b; without fused operations by Dekker's product. */
JET_INLINE double product_and(double a, double b, double c)
{
#ifdef __FMA__
    return JET_FMA_OF_NUMBERS(a, b, c);
#else
    const double split = 0x1p27 + 1, product = a * b, big_a = split * a, big_b = split * b;
    const double high_a = big_a - (big_a - a), high_b = big_b - (big_b - b), low_a = a - high_a, low_b = b - high_b;
    return product + ((((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b) + c);
#endif
}

/* Sets the impulses L = weight F + change. If rates and changes were added first, a change of less than a unit of the
 * rate would be rounded in the same way from step to step (docs/method.md section 6). */
JET_INLINE void set_impulses_with_changes(const double *weight, const double *rate, const double *change,
                                          double *restrict impulse, int lanes)
{
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) impulse[i] = product_and(weight[i], rate[i], change[i]);
}

#define EVALUATE(V, S)                                                                                                 \
    {                                                                                                                  \
        const V theta = *(const V *)(p->theta + here);                                                                 \
        V row[TVI_GALERKIN_MAX_LANES];                                                                                 \
        for (int j = 0; j < lanes; j++) row[j] = *(const V *)(table + j * places + here);                              \
        for (int u = 0; u < count; u++) {                                                                              \
            V sums[CHAINS] = {0};                                                                                      \
            for (int j = 0; j < lanes; j++)                                                                            \
                sums[j % CHAINS] += row[j] * impulses[(size_t)u * (size_t)lanes + (size_t)j];                          \
            *(V *)(out + u * places + here) =                                                                          \
                start[u] + (theta * drift[u] + scale[u] * ((sums[0] + sums[1]) + (sums[2] + sums[3])));                \
        }                                                                                                              \
    }

JET_INLINE void evaluate_count(const galerkin_evaluation *p, const double *table, const double *impulses,
                               double *restrict out, int lanes, int places)
{
    const double *start = p->start, *drift = p->drift, *scale = p->scale;
    const int count = p->count;
    JET_BLOCKS(places, EVALUATE, );
}

JET_INLINE void evaluate_lanes(const galerkin_evaluation *p, const double *table, const double *impulses, double *out,
                               int lanes)
{
    if (p->places == TVI_SAMPLES) evaluate_count(p, table, impulses, out, lanes, TVI_SAMPLES);
    else evaluate_count(p, table, impulses, out, lanes, p->places);
}

#endif
