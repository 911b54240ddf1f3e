/* quad_series.h - Computes the series of the functions of functions.h by a route of their own: Cauchy's integral in
 * complex quadruple precision: gcc only (libquadmath). Elsewhere, or with TESTS_WITHOUT_QUAD, the tests that need it
 * are left out. */
#ifndef TVI_TESTS_AD_QUAD_SERIES_H
#define TVI_TESTS_AD_QUAD_SERIES_H

#include "functions.h"

#if !defined(__GNUC__) || defined(__clang__)
#ifndef TESTS_WITHOUT_QUAD
#define TESTS_WITHOUT_QUAD
#endif
#endif

/* z[output * (degree + 1) + k] = (1 / (M r^k)) sum_{j < M} f(x(r w^j)) w^(-jk),  w = exp(2 pi i / M), M = 256, for
 * f(x(s)) analytic in |s| < R with R > r: the relative error is about (r/R)^256 + 1e-33 (R/r)^k. */
void quad_series(const function *f, int degree, double radius, const double x[], double z[]);

/* dz = d/de z(x + e dx) at e = 0 by central differences of fourth order, e = 1e-5: error about 1e-20. */
void quad_tangent(const function *f, int degree, double radius, const double x[], const double dx[], double dz[]);

#endif
