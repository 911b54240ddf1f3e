/* one_member.h - Defines the loops for a single member alone: they add small changes to impulses, and evaluate the
 * curve at points between the nodes. */
#ifndef TVI_SRC_GALERKIN_ONE_MEMBER_H
#define TVI_SRC_GALERKIN_ONE_MEMBER_H

#include "galerkin/lanes.h"
#include "rule.h"

#include <math.h>

/* Returns a b + c, rounded once if c is small compared with a b. Without a fused operation it uses Dekker's product. */
JET_INLINE double multiply_add_rounded_once(double a, double b, double c)
{
#ifdef __FMA__
    return JET_FMA_OF_NUMBERS(a, b, c);
#else
    const double split = 0x1p27 + 1, product = a * b, big_a = split * a, big_b = split * b;
    const double high_a = big_a - (big_a - a), high_b = big_b - (big_b - b), low_a = a - high_a, low_b = b - high_b;
    return product + ((((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b) + c);
#endif
}

/* Sets the impulses L = weight F + change. If the change were added to the rate before the multiplication, a change
 * below the roundoff of the rate would be lost or rounded up in the same way in each step (docs/method.md section
 * 6). */
JET_INLINE void set_impulses_with_changes(const double *weight, const double *rate, const double *change,
                                          double *restrict impulse, int lanes)
{
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) impulse[i] = multiply_add_rounded_once(weight[i], rate[i], change[i]);
}

#define EVALUATE(V, S)                                                                                                 \
    {                                                                                                                  \
        const V theta = *(const V *)(evaluation->theta + here);                                                        \
        V row[TVI_GALERKIN_MAX_LANES];                                                                                 \
        for (int j = 0; j < lanes; j++) row[j] = *(const V *)(integral_table + j * point_count + here);                \
        for (int u = 0; u < count; u++) {                                                                              \
            V sums[CHAINS] = {0};                                                                                      \
            for (int j = 0; j < lanes; j++)                                                                            \
                sums[j % CHAINS] += row[j] * impulses[(size_t)u * (size_t)lanes + (size_t)j];                          \
            *(V *)(out + u * point_count + here) =                                                                     \
                start[u] + (theta * drift[u] + scale[u] * ((sums[0] + sums[1]) + (sums[2] + sums[3])));                \
        }                                                                                                              \
    }

JET_INLINE void evaluate_curve_at_points(const galerkin_curve_evaluation *evaluation, const double *integral_table,
                                         const double *impulses, double *restrict out, int lanes, int point_count)
{
    const double *start = evaluation->start_values, *drift = evaluation->drift, *scale = evaluation->impulse_scale;
    const int count = evaluation->component_count;
    JET_BLOCKS(point_count, EVALUATE, );
}

#endif
