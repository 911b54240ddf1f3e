/* quadmath.h - Takes the place of libquadmath's header where long double has quadruple precision, as on aarch64. The
 * quadruple tests are compiled there with this file before all others and run on the functions of the C library. */
#ifndef TESTS_ARM_QUADMATH_H
#define TESTS_ARM_QUADMATH_H

#include <float.h>
#include <math.h>
#include <stdio.h>

_Static_assert(LDBL_MANT_DIG == 113, "long double has quadruple precision");

#define __float128 long double
typedef _Complex long double __complex128;

#define M_PIq       3.141592653589793238462643383279502884L
#define M_2_SQRTPIq 1.128379167095512573896158903121545172L

#define acoshq  acoshl
#define acosq   acosl
#define asinhq  asinhl
#define asinq   asinl
#define atan2q  atan2l
#define atanhq  atanhl
#define atanq   atanl
#define cbrtq   cbrtl
#define coshq   coshl
#define cosq    cosl
#define erfq    erfl
#define expq    expl
#define fabsq   fabsl
#define finiteq isfinite
#define fmaxq   fmaxl
#define fminq   fminl
#define log10q  log10l
#define logq    logl
#define nanq    nanl
#define powq    powl
#define sinhq   sinhl
#define sinq    sinl
#define sqrtq   sqrtl
#define tanhq   tanhl
#define tanq    tanl

/* complex.h is not included, since it defines I. */
#define cacoshq   __builtin_cacoshl
#define cacosq    __builtin_cacosl
#define casinhq   __builtin_casinhl
#define casinq    __builtin_casinl
#define catanhq   __builtin_catanhl
#define catanq    __builtin_catanl
#define ccoshq    __builtin_ccoshl
#define ccosq     __builtin_ccosl
#define cexpq     __builtin_cexpl
#define cimagq    __builtin_cimagl
#define clogq     __builtin_clogl
#define cpowq     __builtin_cpowl
#define crealq    __builtin_creall
#define csinhq    __builtin_csinhl
#define csinq     __builtin_csinl
#define csqrtq    __builtin_csqrtl
#define ctanhq    __builtin_ctanhl
#define ctanq     __builtin_ctanl
#define cexpiq(x) __builtin_complex(cosl(x), sinl(x))

/* The tests have one format. */
#define quadmath_snprintf(text, size, format, x) snprintf(text, size, "%.25Le", x)

#endif
