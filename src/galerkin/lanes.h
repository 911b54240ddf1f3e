/* lanes.h - Defines what the loops over lanes in the kernels of a Galerkin step share (loops.h). A lane is
 * a node of the quadrature. The macro ALL_LANES divides a constant number of lanes into the
 * widest vectors that fit. For any number of lanes, two functions follow. One sets the
 * impulses, which are step size times quadrature weight times rate for each node; the other evaluates the curve of the
 * step at given points. The last section defines the types and the unit in which the inner iterations of a pass
 * (kernel_inner.h) store changes of the unknowns in single precision. Files that are compiled once for each instruction
 * set (ad/vector.h) and generated code include this file. */
#ifndef TVI_SRC_GALERKIN_LANES_H
#define TVI_SRC_GALERKIN_LANES_H

#include "galerkin/in_library.h"
#include "galerkin/loops.h"
#include "rule.h"
#include "vector.h"

#include <math.h>

#define KERNEL_JOIN(f, suffix) f##_##suffix
#define KERNEL_NAME(f, suffix) KERNEL_JOIN(f, suffix)

/* ALL_LANES calls BODY(V, blocks) with the widest vector type V that divides the number of lanes, and with the
 * number of such vectors in all lanes. WIDEST is the number of elements of the widest type of the instruction set. */
enum { WIDEST = sizeof(jet_widest) / sizeof(double) };
#define ALL_LANES(lanes, BODY)                                                                                         \
    if (WIDEST >= 8 && lanes % 8 == 0) BODY(jet_v8, (lanes / 8))                                                       \
    else if (WIDEST >= 4 && lanes % 4 == 0) BODY(jet_v4, (lanes / 4))                                                  \
    else if (lanes % 2 == 0) BODY(jet_v2, (lanes / 2))                                                                 \
    else BODY(jet_v1, lanes)

/* A sum is split into this many partial sums, which the processor computes in parallel. */
enum { PARTIAL_SUM_COUNT = 4 };

/* These functions return the sum of a vector's elements, by adding its halves. */
JET_INLINE double jet_add_lanes_of_jet_v1(jet_v1 vector) { return vector; }
JET_INLINE double jet_add_lanes_of_jet_v2(jet_v2 vector) { return vector[0] + vector[1]; }
JET_INLINE double jet_add_lanes_of_jet_v4(jet_v4 vector)
{
    return jet_add_lanes_of_jet_v2((jet_v2){vector[0], vector[1]} + (jet_v2){vector[2], vector[3]});
}
JET_INLINE double jet_add_lanes_of_jet_v8(jet_v8 vector)
{
    return jet_add_lanes_of_jet_v4((jet_v4){vector[0], vector[1], vector[2], vector[3]} +
                                   (jet_v4){vector[4], vector[5], vector[6], vector[7]});
}

/* These macros access vector k of an array, to write and to read. */
#define BLOCK_AT(V, array, k) (*(V *)((array) + (size_t)(k) * (sizeof(V) / sizeof(double))))
#define BLOCK_OF(V, array, k) (*(const V *)((array) + (size_t)(k) * (sizeof(V) / sizeof(double))))

/* ---- Impulses and curves ----------------------------------------------------------------------------------------- */

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
JET_INLINE void set_impulses_to_weight_times_rate_plus_change(const double *weight, const double *rate,
                                                              const double *change, double *restrict impulse, int lanes)
{
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) impulse[i] = multiply_add_rounded_once(weight[i], rate[i], change[i]);
}

#define EVALUATE(V, S)                                                                                                 \
    {                                                                                                                  \
        const V theta = *(const V *)(inputs->theta + here);                                                            \
        V row[TVI_GALERKIN_MAX_LANES];                                                                                 \
        for (int j = 0; j < lanes; j++) row[j] = *(const V *)(integral_table + j * point_count + here);                \
        for (int u = 0; u < count; u++) {                                                                              \
            V sums[PARTIAL_SUM_COUNT] = {0};                                                                           \
            for (int j = 0; j < lanes; j++)                                                                            \
                sums[j % PARTIAL_SUM_COUNT] += row[j] * impulses[(size_t)u * (size_t)lanes + (size_t)j];               \
            *(V *)(out + u * point_count + here) =                                                                     \
                start[u] + (theta * drift[u] + scale[u] * ((sums[0] + sums[1]) + (sums[2] + sums[3])));                \
        }                                                                                                              \
    }

JET_INLINE void evaluate_curve_at_points(const galerkin_curve_at_points_inputs *inputs, const double *integral_table,
                                         const double *impulses, double *restrict out, int lanes, int point_count)
{
    const double *start = inputs->start_values, *drift = inputs->drift, *scale = inputs->change_per_impulse;
    const int count = inputs->component_count;
    JET_BLOCKS(point_count, EVALUATE, );
}

/* ---- Inner iterations in single precision (kernel_inner.h) ------------------------------------------------------ */

/* Inner iterations store the relative changes of the unknowns in this unit. The square of the least change that
 * matters, 2^-72 (GALERKIN_HESSIAN_GOAL), would underflow in single precision; in this unit it is 2^-64. */
#define INNER_MOVEMENT_UNIT 0x1p-40

typedef float jet_single_jet_v8 JET_VECTOR(float, 8);
typedef float jet_single_jet_v4 JET_VECTOR(float, 4);
typedef float jet_single_jet_v2 JET_VECTOR(float, 2);
typedef float jet_single_jet_v1;

/* These macros convert vectors from double to single precision, and back. */
#define JET_NARROW_jet_v8(x) JET_CONVERT(jet_single_jet_v8, x)
#define JET_NARROW_jet_v4(x) JET_CONVERT(jet_single_jet_v4, x)
#define JET_NARROW_jet_v2(x) JET_CONVERT(jet_single_jet_v2, x)
#define JET_NARROW_jet_v1(x) ((float)(x))
#define JET_WIDEN_jet_v8(x)  JET_CONVERT(jet_v8, x)
#define JET_WIDEN_jet_v4(x)  JET_CONVERT(jet_v4, x)
#define JET_WIDEN_jet_v2(x)  JET_CONVERT(jet_v2, x)
#define JET_WIDEN_jet_v1(x)  ((double)(x))

#endif
