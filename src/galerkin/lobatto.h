/* lobatto.h - Computes the tables of a constrained Galerkin step with m Gauss nodes c_i: the m + 1 Lobatto nodes d_j,
 * d_0 = 0 and d_m = 1, at which constraints act, and what impulses of either nodes do at both (docs/method.md, section
 * 12; Jay, SIAM J. Numer. Anal. 45, 2007). One kernel makes all of it,
 *   sigma(x, y) = sum_{k < m} (2 k + 1) I_k(x) I_k(y),  I_k(x) = int_0^x P_k(2 r - 1) dr,  nu(x, y) = x - sigma(x, y),
 * whose values are rounded to a grid, so that nu(x, y) - nu(y, x) = x - y and sigma(1 - x, 1 - y) = 1 - x - y +
 * sigma(x, y) hold for the numbers themselves: steps stay symplectic and symmetric to the last bit.
 *
 * Rows of lanes are of two kinds. Sources are the nodes d_0 .. d_{m-1}, whose impulses act inside the step; targets are
 * d_1 .. d_m, at which phi = 0 is asked for. Lanes after the last node repeat it as a target, and are 0 as a source. */
#ifndef TVI_SRC_GALERKIN_LOBATTO_H
#define TVI_SRC_GALERKIN_LOBATTO_H

#include "galerkin/tables.h"

/* The most Lobatto nodes. */
enum { LOBATTO_MAX = TVI_MAX_NODES + 1 };

typedef struct {
    int node_count; /* m, that of Gauss nodes */
    double *d;      /* [lanes] the targets d_1 .. d_m */
    double *w;      /* [m + 1] the weights w_j of quadrature */
    /* [j][i] What impulses of Gauss node j do at target i: nu(d_i, c_j), or in equations of first order the integral of
     * l_j / b_j from 0 to d_i. */
    double *gauss_to_target;
    /* [j][i] What impulses of source j do at Gauss node i: nu(c_i, d_j), or to the momenta, 1 minus that integral. */
    double *source_to_gauss;
    double *source_to_target; /* [j][i] nu(d_i, d_j) */
    double *target_to_source; /* [i][j] the inverse of the matrix nu(d_i, d_j) */
    double *one_minus_d;      /* [m] 1 - d_j, the weight of a source's impulse in the increment of q */
    /* [m + 1] The weights of impulses in the last term, of degree m, of the series of the forces of constraint in
     * Legendre polynomials, times h. */
    double *last_term;
    /* [2 (m + 1)][m + 1] and [m + 1][m + 1]: the factors of the multipliers of the last two steps, the last one first,
     * or of the last step alone, in those of the next step of the same size. */
    double *two_steps, *last_step;
    long double exact_d[LOBATTO_MAX];
    double *single_samples, *double_samples; /* [m + 1][TVI_SAMPLES] the integrals of tvi_lobatto_integrate */
} galerkin_lobatto;

void tvi_lobatto_allocate(galerkin_lobatto *lobatto, tvi_arena *arena, int node_count, int lanes);
/* Computes the tables, for Q'' = F if is_second_order is set. */
void tvi_lobatto_compute(galerkin_lobatto *lobatto, const galerkin_coefficients *coefficients, bool is_second_order);

/* Computes the integrals of the polynomials l_j of degree m through the Lobatto nodes: single[j] = int_0^s l_j(r) / w_j
 * dr and twice[j] = int_0^s (s - r) l_j(r) / w_j dr, j <= m. */
void tvi_lobatto_integrate(const galerkin_lobatto *lobatto, double s, double single[], double twice[]);

#endif
