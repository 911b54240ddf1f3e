/* series_quad.h - Declares a problem's equations as power series in quadruple precision (gcc only): coefficient after
 * coefficient, from the naive recurrences. */
#ifndef TESTS_FUZZ_STEPS_SERIES_QUAD_H
#define TESTS_FUZZ_STEPS_SERIES_QUAD_H

#include "problem.h"
#include "references/recurrences_quad.h"

#include <stdbool.h>

enum { ORDERS = 16 };

typedef struct {
    const problem *source;
    quad (*c)[ORDERS]; /* [count] the series of every node */
    quad noise; /* each result is multiplied by 1 + noise times a number in [-1, 1] of its own: what roundoff does */
    bool only_slopes;
} quad_series;

quad_series quad_series_of(const problem *x);
void quad_series_free(quad_series *s);

/* The inputs at numbers. r: p or v. */
void quad_set(quad_series *s, quad t, const quad q[], const quad r[]);
/* Coefficient k of every node, from the inputs' up to k. */
void quad_run(quad_series *s, int k);

/* H_pp or L_vv at the numbers that are set, [n][n]: destroys the series from order 1 on. */
void quad_bend(quad_series *s, quad *A);

/* q' = H_p and p' = -H_q of a Hamiltonian, a potential or a force, at numbers. */
void quad_field(quad_series *s, quad t, const quad q[], const quad p[], quad dq[], quad dp[]);
/* r with H_p(q, r) = v, or L_v(q, r) = p: by Newton's method, from the r that is given. */
bool quad_legendre(quad_series *s, quad t, const quad q[], const quad goal[], quad r[]);
/* L at (q, v), H at (q, p); those of a potential include the kinetic energy. */
quad quad_energy_of(quad_series *s, quad t, const quad q[], const quad r[]);

/* Q[k][n], P[k][n], k <= degree, of the solution through (q, r) at t; r is v of a Lagrangian. */
bool quad_curve(quad_series *s, quad t, const quad q[], const quad r[], int degree, quad *Q, quad *P);

#endif
