/* definition.h - Declares a step of a generating function from its definition (docs/method.md sections 3 and 4): the
 * discrete action S(z) summed at the nodes, differentiated by differences, and the generating function's equations with
 * whole actions, no defects, solved in long double. Shares nothing with the library. */
#ifndef TESTS_GENERATING_DEFINITION_H
#define TESTS_GENERATING_DEFINITION_H

#include "models.h"

typedef long double real;
enum { n = 2, Z = 2 * n, TOP = 5, NODES_MAX = 3 };

/* ---- The problem (definition_law.c) ------------------------------------------------------------------------------ */

/* m = (3/2 (1 + b q_1^2), 1/2), f = (q_1 C, q_0^2), V = 2 q_0^2 + q_0^2 q_1 + 3/4 q_1^4 + q_0 C / 2, C = cos(5/4 t):
 * separable for a = b = 0. L = sum_i m_i v_i^2/2 + a f.v - V. */
typedef struct {
    real a, b;
} law;

real law_mass(const law *l, int i, const real q[]);
real law_lagrangian(const law *l, const real q[], const real v[], real t);
/* And v = H_p. */
real law_hamiltonian(const law *l, const real q[], const real p[], real t, real v[]);
jet law_record_lagrangian(const jet q[], const jet v[], jet t, void *ctx); /* ctx: the law */
jet law_record_hamiltonian(const jet q[], const jet p[], jet t, void *ctx);

/* ---- Its curve --------------------------------------------------------------------------------------------------- */

typedef struct {
    real c[TOP + 1];
} series;

/* Uses only the coefficients up to K. */
typedef struct {
    series q[n], p[n];
} curve;

curve law_expand(const law *l, real t, const real q[], const real second[], bool of_velocities);
real series_value(const series *x, int degree, real s);
real series_slope(const series *x, int degree, real s);

/* ---- The step ---------------------------------------------------------------------------------------------------- */

typedef struct {
    tvi_quadrature quadrature;
    int points;
    real b[NODES_MAX], c[NODES_MAX];
} rule;

typedef struct {
    const law *l;
    const kind *k;
    const rule *nodes;
    int degree;
    real t, h, centre; /* the centre is at t + centre h */
} method;

/* The state before and after the step. */
typedef struct {
    real q0[n], p0[n], q1[n], p1[n];
} ends;

/* From the start, by a method with one curve, and by one with a curve from each end. The test fails where the equations
 * are not solved. */
void definition_step(const method *m, const test_state *start, ends *e);
void definition_step_both(const method *m, const test_state *start, ends *e);

#endif
