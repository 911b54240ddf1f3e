/* one_member.h - loops that only a member by itself has: the impulses of two parts, and the curve at other places. */
#ifndef TVI_SRC_GALERKIN_ONE_MEMBER_H
#define TVI_SRC_GALERKIN_ONE_MEMBER_H

#include "galerkin/lanes.h"
#include "rule.h"

#include <math.h>

/* a b + c, rounded once where c is small beside a b; without fused operations by Dekker's product. */
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

/* The impulses L = weight F + change. If drives and changes were added first, a change of less than a unit of the
 * drive would be rounded by what repeats itself from step to step (docs/method.md section 6). */
JET_INLINE void weigh_both(const double *weight, const double *drive, const double *change, double *restrict impulse,
                           int lanes)
{
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) impulse[i] = product_and(weight[i], drive[i], change[i]);
}

#define PLACE(V, S)                                                                                                    \
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

JET_INLINE void place_count(const galerkin_places *p, const double *table, const double *impulses, double *restrict out,
                            int lanes, int places)
{
    const double *start = p->start, *drift = p->drift, *scale = p->scale;
    const int count = p->count;
    JET_BLOCKS(places, PLACE, );
}

JET_INLINE void place_lanes(const galerkin_places *p, const double *table, const double *impulses, double *out,
                            int lanes)
{
    if (p->places == TVI_SAMPLES) place_count(p, table, impulses, out, lanes, TVI_SAMPLES);
    else place_count(p, table, impulses, out, lanes, p->places);
}

#endif
