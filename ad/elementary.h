/* elementary.h - Computes elementary functions of many numbers, z[i] = f(a[i]), i < width: jet_all_sin(width, a, z) and
 * so on. The rules call it. z must not overlap a.
 *
 * With JET_SLEEF the functions are SLEEF's (N. Shibata and F. Petrogalli, IEEE Transactions on Parallel and Distributed
 * Systems 31, 2020), a vector at a time and within 1 ulp. Without it, and for numbers that SLEEF's do not serve, they
 * are those of the mathematical library, one by one. The result for a number never depends on its neighbours. Each
 * instruction set has vectors of one width, and the last numbers fill up a vector. Numbers for which SLEEF would
 * compute all of a vector in another way get a vector of their own. */
#ifndef TVI_AD_ELEMENTARY_H
#define TVI_AD_ELEMENTARY_H

#include "vector.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

/* A range of |a|. No number is in the range jet_nowhere. */
typedef struct {
    double least, most;
} jet_range;
static const jet_range jet_angles = {0, 0x1.dffffffffffffp+3}, jet_far_angles = {15, 9e13}, jet_exponents = {0, 700},
                       jet_sines = {0, 1}, jet_numbers = {0, DBL_MAX}, jet_normal_numbers = {DBL_MIN, DBL_MAX},
                       jet_nowhere = {1, 0};

/* Lists the functions: the name, the range near 0 where SLEEF's function serves, and the range beyond, in which SLEEF
 * reduces angles in another way. */
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

/* Calls the function of the mathematical library. */
#define JET_ONE_BY_ONE(name, near, far)                                                                                \
    JET_INLINE void jet_all_##name(int width, const double *a, double *restrict z)                                     \
    {                                                                                                                  \
        for (int i = 0; i < width; i++) z[i] = name(a[i]);                                                             \
    }
JET_ONE_BY_ONE(asinh, , )
JET_ONE_BY_ONE(acosh, , )
JET_ONE_BY_ONE(atanh, , )
JET_ONE_BY_ONE(erf, , )

#ifndef JET_SLEEF

JET_ELEMENTARY_LIST(JET_ONE_BY_ONE)

/* z = sin a, w = cos a */
JET_INLINE void jet_all_sincos(int width, const double *a, double *restrict z, double *restrict w)
{
    jet_all_sin(width, a, z);
    jet_all_cos(width, a, w);
}

/* z = a^c */
JET_INLINE void jet_all_pow(double c, int width, const double *a, double *restrict z)
{
    for (int i = 0; i < width; i++) z[i] = pow(a[i], c);
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
typedef double jet_native JET_REGISTER(double, JET_NATIVE);

/* A function, or two functions of one argument: of a vector, and of a number. c is the exponent of pow. */
typedef void jet_of_vector(double c, jet_native x, jet_native out[2]);
typedef void jet_of_number(double c, double x, double *z, double *w);

JET_INLINE bool jet_is_in(jet_range range, double x) { return range.least <= fabs(x) && fabs(x) <= range.most; }

JET_INLINE bool jet_all_are_in(jet_range range, int width, const double *a)
{
    int outside = 0;
    JET_IN_VECTORS
    for (int i = 0; i < width; i++) outside |= !jet_is_in(range, a[i]);
    return !outside;
}

JET_INLINE void jet_block(jet_of_vector *f, double c, const double *a, double *z, double *w)
{
    jet_native x, out[2];
    memcpy(&x, a, sizeof x);
    f(c, x, out);
    memcpy(z, &out[0], sizeof x);
    if (w) memcpy(w, &out[1], sizeof x);
}

/* Computes the numbers of a block of at most JET_NATIVE that are in the range; 1 takes the place of the others. */
JET_INLINE void jet_part(jet_of_vector *f, double c, jet_range range, int count, const double *a, double *z, double *w)
{
    double x[JET_NATIVE], of_z[JET_NATIVE], of_w[JET_NATIVE];
    bool is_in[JET_NATIVE], any = false;
    for (int i = 0; i < JET_NATIVE; i++) {
        is_in[i] = i < count && jet_is_in(range, a[i]);
        x[i] = is_in[i] ? a[i] : 1;
        any |= is_in[i];
    }
    if (!any) return;
    jet_block(f, c, x, of_z, w ? of_w : NULL);
    for (int i = 0; i < JET_NATIVE; i++) {
        if (is_in[i]) z[i] = of_z[i];
        if (is_in[i] && w) w[i] = of_w[i];
    }
}

/* Computes numbers in all ranges. */
JET_INLINE void jet_mixed(jet_of_vector *f, jet_of_number *one, jet_range near, jet_range far, double c, int width,
                          const double *a, double *z, double *w)
{
    for (int i = 0; i < width; i++)
        if (!jet_is_in(near, a[i]) && !jet_is_in(far, a[i])) one(c, a[i], z + i, w ? w + i : NULL);
    for (int here = 0; here < width; here += JET_NATIVE) {
        double *const w_here = w ? w + here : NULL;
        jet_part(f, c, near, width - here, a + here, z + here, w_here);
        jet_part(f, c, far, width - here, a + here, z + here, w_here);
    }
}

JET_INLINE void jet_near(jet_of_vector *f, jet_range near, double c, int width, const double *a, double *z, double *w)
{
    int here = 0;
    for (; here + JET_NATIVE <= width; here += JET_NATIVE) jet_block(f, c, a + here, z + here, w ? w + here : NULL);
    if (here < width) jet_part(f, c, near, width - here, a + here, z + here, w ? w + here : NULL);
}

/* Defines jet_all_name for numbers that are all near 0, most of the time. */
#define JET_ALL_OF(name, near, far, c, parameters, w)                                                                  \
    JET_APART void jet_mixed_##name parameters                                                                         \
    {                                                                                                                  \
        jet_mixed(jet_vector_##name, jet_number_##name, near, far, c, width, a, z, w);                                 \
    }                                                                                                                  \
    JET_INLINE void jet_all_##name parameters

#define JET_ALL(name, near, far)                                                                                       \
    extern jet_native JET_SLEEF_OF(name)(jet_native);                                                                  \
    JET_INLINE void jet_vector_##name(double c, jet_native x, jet_native out[2])                                       \
    {                                                                                                                  \
        (void)c;                                                                                                       \
        out[0] = JET_SLEEF_OF(name)(x);                                                                                \
    }                                                                                                                  \
    JET_INLINE void jet_number_##name(double c, double x, double *z, double *w)                                        \
    {                                                                                                                  \
        (void)c, (void)w;                                                                                              \
        *z = name(x);                                                                                                  \
    }                                                                                                                  \
    JET_ALL_OF(name, near, far, 0, (int width, const double *a, double *restrict z), NULL)                             \
    {                                                                                                                  \
        if (jet_all_are_in(near, width, a)) jet_near(jet_vector_##name, near, 0, width, a, z, NULL);                   \
        else jet_mixed_##name(width, a, z);                                                                            \
    }
JET_ELEMENTARY_LIST(JET_ALL)

/* z = sin a, w = cos a */
typedef struct {
    jet_native sine, cosine;
} jet_sine_and_cosine;
extern jet_sine_and_cosine JET_SLEEF_OF(sincos)(jet_native);
JET_INLINE void jet_vector_sincos(double c, jet_native x, jet_native out[2])
{
    const jet_sine_and_cosine both = JET_SLEEF_OF(sincos)(x);
    (void)c;
    out[0] = both.sine;
    out[1] = both.cosine;
}
JET_INLINE void jet_number_sincos(double c, double x, double *z, double *w)
{
    (void)c;
    *z = sin(x);
    *w = cos(x);
}
JET_ALL_OF(sincos, jet_angles, jet_far_angles, 0, (int width, const double *a, double *restrict z, double *restrict w),
           w)
{
    if (jet_all_are_in(jet_angles, width, a)) jet_near(jet_vector_sincos, jet_angles, 0, width, a, z, w);
    else jet_mixed_sincos(width, a, z, w);
}

/* z = a^c, by SLEEF's pow if a and z are far from the limits of the exponent */
extern jet_native JET_SLEEF_OF(pow)(jet_native, jet_native);
JET_INLINE void jet_vector_pow(double c, jet_native x, jet_native out[2])
{
    out[0] = JET_SLEEF_OF(pow)(x, (jet_native){0} + c);
}
JET_INLINE void jet_number_pow(double c, double x, double *z, double *w)
{
    (void)w;
    *z = pow(x, c);
}
JET_INLINE jet_range jet_bases(double c)
{
    const double bits = 1000 / fmax(fabs(c), 1), most = bits >= 1 ? ldexp(1, (int)bits) : 1;
    return (jet_range){1 / most, most};
}
JET_ALL_OF(pow, jet_bases(c), jet_nowhere, c, (double c, int width, const double *a, double *restrict z), NULL)
{
    const jet_range near = jet_bases(c);
    if (jet_all_are_in(near, width, a)) jet_near(jet_vector_pow, near, c, width, a, z, NULL);
    else jet_mixed_pow(c, width, a, z);
}

#endif
#endif
