/* quad.h - Declares a reference in quadruple precision (libquadmath, gcc only) that shares nothing with the library but
 * the recording of the user's function and its gradient: series by naive recurrences, Jacobians by differences, methods
 * from their definition.
 *
 * Letters as in docs/method.md. Every coordinate array has n entries; c[k * n + i] is coefficient k of coordinate i.
 * The results are NaN if the function has no value. Aborts without memory. */
#ifndef TVI_BENCH_QUAD_H
#define TVI_BENCH_QUAD_H

#include "references/recurrences_quad.h"
#include "tvi.h"

typedef struct quad_system quad_system;

/* M q'' = F(q, t) as in tvi_system_force and tvi_system_potential. Numbers that the recording folds are rounded to
 * double. NULL where the function is refused. */
quad_system *quad_system_force(int n, const double mass[], tvi_force_fn *force, void *ctx);
quad_system *quad_system_potential(int n, const double mass[], tvi_potential_fn *potential, void *ctx);
void quad_system_free(quad_system *system);

void quad_force(const quad_system *system, quad t, const quad q[], quad F[]);
/* H = sum p_i^2 / (2 m_i) + V(q, t); NaN for a system made from a force. */
quad quad_energy(const quad_system *system, quad t, const quad q[], const quad p[]);

/* c_0..c_N, N = degree >= 1, of the solution of M q'' = F with q(t) = q, q'(t) = v (method.md section 2). */
void quad_expand(const quad_system *system, quad t, const quad q[], const quad v[], int degree, quad c[]);
/* steps Taylor steps of size h: q to degree N, p = M q' to degree N - 1, so the order is N - 1. */
void quad_taylor(const quad_system *system, int degree, quad h, long steps, quad *t, quad q[], quad p[]);

enum { QUAD_MAX_POINTS = 64 };
/* A type I method with constant M: expansion TVI_AT_START, TVI_AT_MIDPOINT or TVI_AT_END; N = degree >= 1; quadrature
 * weights b and nodes c on [0, 1]. */
typedef struct {
    tvi_expansion expansion;
    tvi_nodes nodes;
    int degree, points;
    quad b[QUAD_MAX_POINTS], c[QUAD_MAX_POINTS];
} quad_method;

/* With 1 <= points <= QUAD_MAX_POINTS Gauss nodes. */
quad_method quad_method_gauss(tvi_expansion expansion, tvi_nodes nodes, int degree, int points);
/* The integral from 0 to s of the polynomial that is 1 at node j and 0 at the others; exact for Gauss nodes. */
quad quad_method_integral(const quad_method *method, int j, quad s);
/* One step of (I), method.md section 4, from the definition of S. false: Newton's method did not converge, and the
 * state is as it was. Derivatives of the curve by differences are exact to about 1e-28 relative. */
bool quad_tvi_step(const quad_system *system, const quad_method *method, quad h, quad *t, quad q[], quad p[]);

#endif
