/* elementary.h - Computes elementary functions of arrays: jet_array_sin(count, argument, result) sets result[i] =
 * sin(argument[i]), i < count, and the other functions have the same form. The rules (rule_*.c) call them. The arrays
 * must not overlap.
 *
 * If JET_SLEEF is defined, the functions call SLEEF (N. Shibata and F. Petrogalli, IEEE Transactions on Parallel and
 * Distributed Systems 31, 2020), which computes one vector at a time within 1 ulp. Otherwise, and for arguments
 * outside the ranges that SLEEF serves, they call the mathematical library for each number. The result for a number
 * never depends on its neighbours: SLEEF always gets whole vectors, and the last, incomplete vector is filled up.
 * SLEEF uses another algorithm for a whole vector as soon as one number is large; large numbers therefore get
 * vectors of their own. */
#ifndef TVI_AD_ELEMENTARY_H
#define TVI_AD_ELEMENTARY_H

#include "vector.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

/* A range of arguments of functions: the numbers a with least <= |a| <= most. The range jet_nowhere contains no
 * number. */
typedef struct {
    double least, most;
} jet_argument_magnitude_range;
static const jet_argument_magnitude_range jet_angles = {0, 0x1.dffffffffffffp+3}, jet_far_angles = {15, 9e13},
                                          jet_exponents = {0, 700}, jet_sines = {0, 1}, jet_numbers = {0, DBL_MAX},
                                          jet_normal_numbers = {DBL_MIN, DBL_MAX}, jet_nowhere = {1, 0};

/* Lists the functions. Each row has the name, the range near 0 in which SLEEF's function is used, and the range of
 * larger numbers in which SLEEF reduces angles by another algorithm. */
#define JET_ELEMENTARY_LIST(ROW)                                                                                       \
    ROW(sin, jet_angles, jet_far_angles)                                                                               \
    ROW(cos, jet_angles, jet_far_angles)                                                                               \
    ROW(tan, jet_angles, jet_far_angles)                                                                               \
    ROW(exp, jet_exponents, jet_nowhere)                                                                               \
    ROW(sinh, jet_exponents, jet_nowhere)                                                                              \
    ROW(cosh, jet_exponents, jet_nowhere)                                                                              \
    ROW(tanh, jet_numbers, jet_nowhere)                                                                                \
    ROW(log, jet_normal_numbers, jet_nowhere)                                                                          \
    ROW(asin, jet_sines, jet_nowhere)                                                                                  \
    ROW(acos, jet_sines, jet_nowhere)                                                                                  \
    ROW(atan, jet_numbers, jet_nowhere)

/* Defines a function that calls the mathematical library for each number. */
#define JET_ONE_BY_ONE(name, near_zero, far_from_zero)                                                                 \
    JET_INLINE void jet_array_##name(int count, const double *argument, double *restrict result)                       \
    {                                                                                                                  \
        for (int i = 0; i < count; i++) result[i] = name(argument[i]);                                                 \
    }
JET_ONE_BY_ONE(asinh, , )
JET_ONE_BY_ONE(acosh, , )
JET_ONE_BY_ONE(atanh, , )
JET_ONE_BY_ONE(erf, , )

#ifndef JET_SLEEF

JET_ELEMENTARY_LIST(JET_ONE_BY_ONE)

/* Sets result = argument^exponent. */
JET_INLINE void jet_array_pow(double exponent, int count, const double *argument, double *restrict result)
{
    for (int i = 0; i < count; i++) result[i] = pow(argument[i], exponent);
}

#else

#ifdef JET_WIDE
enum { JET_NATIVE = 8 };
#define JET_SLEEF_OF(name) Sleef_##name##d8_u10avx512f
#elif defined(__AVX2__)
enum { JET_NATIVE = 4 };
#define JET_SLEEF_OF(name) Sleef_##name##d4_u10avx2
#elif defined(__x86_64__)
enum { JET_NATIVE = 2 };
#define JET_SLEEF_OF(name) Sleef_##name##d2_u10sse2
#else
enum { JET_NATIVE = 2 };
#define JET_SLEEF_OF(name) Sleef_##name##d2_u10
#endif
typedef double jet_native_vector JET_REGISTER(double, JET_NATIVE);

/* Tells whether SLEEF serves the rounding mode of the thread. Its functions for SSE2, which has no instruction that
 * rounds to an integer, add and subtract a large number for that, and have errors of 1e-9 if this is not to nearest.
 * Bits 13 and 14 of the control register MXCSR are the mode, 0 to nearest. */
JET_INLINE bool jet_sleef_serves_rounding_mode(void)
{
#if defined(__x86_64__) && !defined(__AVX2__)
    return (__builtin_ia32_stmxcsr() & 0x6000) == 0;
#else
    return true;
#endif
}

/* The types of a function of one vector, and of one number. The exponent is for pow, and other functions ignore it. */
typedef jet_native_vector jet_vector_function(double exponent, jet_native_vector x);
typedef double jet_scalar_function(double exponent, double x);

JET_INLINE bool jet_is_in_range(jet_argument_magnitude_range range, double x)
{
    return range.least <= fabs(x) && fabs(x) <= range.most;
}

JET_INLINE bool jet_are_all_in_range(jet_argument_magnitude_range range, int count, const double *argument)
{
    int outside = 0;
    JET_IN_VECTORS
    for (int i = 0; i < count; i++) outside |= !jet_is_in_range(range, argument[i]);
    return !outside && jet_sleef_serves_rounding_mode();
}

JET_INLINE void jet_apply_to_one_native_vector(jet_vector_function *vector_function, double exponent,
                                               const double *argument, double *result)
{
    jet_native_vector x;
    memcpy(&x, argument, sizeof x);
    x = vector_function(exponent, x);
    memcpy(result, &x, sizeof x);
}

/* Computes the function for those of the first numbers, at most `count` and at most one vector, that are in the range.
 * The results of all other numbers stay as they were; in the vector, 1 takes the place of these numbers. */
JET_INLINE void jet_apply_where_in_range(jet_vector_function *vector_function, double exponent,
                                         jet_argument_magnitude_range range, int count, const double *argument,
                                         double *result)
{
    double x[JET_NATIVE], z[JET_NATIVE];
    bool is_in[JET_NATIVE], any = false;
    for (int i = 0; i < JET_NATIVE; i++) {
        is_in[i] = i < count && jet_is_in_range(range, argument[i]);
        x[i] = is_in[i] ? argument[i] : 1;
        any |= is_in[i];
    }
    if (!any) return;
    jet_apply_to_one_native_vector(vector_function, exponent, x, z);
    for (int i = 0; i < JET_NATIVE; i++)
        if (is_in[i]) result[i] = z[i];
}

/* Computes the function for numbers of every size: by the vector function in the ranges near_zero and far_from_zero of
 * |x|, where it is accurate, and by the scalar function elsewhere. */
JET_INLINE void jet_apply_in_any_range(jet_vector_function *vector_function, jet_scalar_function *scalar_function,
                                       jet_argument_magnitude_range near_zero,
                                       jet_argument_magnitude_range far_from_zero, double exponent, int count,
                                       const double *argument, double *result)
{
    const bool is_served = jet_sleef_serves_rounding_mode();
    for (int i = 0; i < count; i++)
        if (!is_served || (!jet_is_in_range(near_zero, argument[i]) && !jet_is_in_range(far_from_zero, argument[i])))
            result[i] = scalar_function(exponent, argument[i]);
    for (int here = 0; is_served && here < count; here += JET_NATIVE) {
        jet_apply_where_in_range(vector_function, exponent, near_zero, count - here, argument + here, result + here);
        jet_apply_where_in_range(vector_function, exponent, far_from_zero, count - here, argument + here,
                                 result + here);
    }
}

/* Computes the function for `count` numbers, all of which the caller has found to be in known_range. Nothing is tested
 * here: the vector function is used for all numbers. The range serves to fill up the last vector. */
JET_INLINE void jet_apply_in_known_range(jet_vector_function *vector_function, jet_argument_magnitude_range known_range,
                                         double exponent, int count, const double *argument, double *result)
{
    int here = 0;
    for (; here + JET_NATIVE <= count; here += JET_NATIVE)
        jet_apply_to_one_native_vector(vector_function, exponent, argument + here, result + here);
    if (here < count)
        jet_apply_where_in_range(vector_function, exponent, known_range, count - here, argument + here, result + here);
}

/* Defines the function jet_array_NAME. It is inlined for numbers that are all in the range near 0; the code for
 * other numbers is a function of its own. */
#define JET_ALL_OF(name, near_zero, far_from_zero, exponent, parameters)                                               \
    JET_APART void jet_any_range_##name parameters                                                                     \
    {                                                                                                                  \
        jet_apply_in_any_range(jet_vector_##name, jet_scalar_##name, near_zero, far_from_zero, exponent, count,        \
                               argument, result);                                                                      \
    }                                                                                                                  \
    JET_INLINE void jet_array_##name parameters

#define JET_ALL(name, near_zero, far_from_zero)                                                                        \
    extern jet_native_vector JET_SLEEF_OF(name)(jet_native_vector);                                                    \
    JET_INLINE jet_native_vector jet_vector_##name(double exponent, jet_native_vector x)                               \
    {                                                                                                                  \
        (void)exponent;                                                                                                \
        return JET_SLEEF_OF(name)(x);                                                                                  \
    }                                                                                                                  \
    JET_INLINE double jet_scalar_##name(double exponent, double x)                                                     \
    {                                                                                                                  \
        (void)exponent;                                                                                                \
        return name(x);                                                                                                \
    }                                                                                                                  \
    JET_ALL_OF(name, near_zero, far_from_zero, 0, (int count, const double *argument, double *restrict result))        \
    {                                                                                                                  \
        if (jet_are_all_in_range(near_zero, count, argument))                                                          \
            jet_apply_in_known_range(jet_vector_##name, near_zero, 0, count, argument, result);                        \
        else jet_any_range_##name(count, argument, result);                                                            \
    }
JET_ELEMENTARY_LIST(JET_ALL)

/* The following functions set result = argument^exponent. They call SLEEF's pow for arguments in
 * jet_sleef_pow_base_range: there the argument and the result are far from overflow and underflow. */
extern jet_native_vector JET_SLEEF_OF(pow)(jet_native_vector, jet_native_vector);
JET_INLINE jet_native_vector jet_vector_pow(double exponent, jet_native_vector x)
{
    return JET_SLEEF_OF(pow)(x, (jet_native_vector){0} + exponent);
}
JET_INLINE double jet_scalar_pow(double exponent, double x) { return pow(x, exponent); }
JET_INLINE jet_argument_magnitude_range jet_sleef_pow_base_range(double exponent)
{
    const double bits = 1000 / fmax(fabs(exponent), 1), most = bits >= 1 ? ldexp(1, (int)bits) : 1;
    return (jet_argument_magnitude_range){1 / most, most};
}
JET_ALL_OF(pow, jet_sleef_pow_base_range(exponent), jet_nowhere, exponent,
           (double exponent, int count, const double *argument, double *restrict result))
{
    const jet_argument_magnitude_range near_zero = jet_sleef_pow_base_range(exponent);
    if (jet_are_all_in_range(near_zero, count, argument))
        jet_apply_in_known_range(jet_vector_pow, near_zero, exponent, count, argument, result);
    else jet_any_range_pow(exponent, count, argument, result);
}

#endif
#endif
