/* tables.h - Computes the nodes c_i, the weights b_i and the matrix nu_ij of Gauss collocation, the polynomials through
 * the nodes, and the factors by which the rates of one or two steps are extrapolated to the next. Elements of the
 * matrix are divided by b_j, because they multiply impulses, which are rates times h b_j (docs/method.md section 6).
 * The file is compiled once, for all instruction sets: tables have the same bits in all of them. */
#ifndef TVI_SRC_GALERKIN_TABLES_H
#define TVI_SRC_GALERKIN_TABLES_H

#include "algebra/arena.h"
#include "galerkin/nodes.h"
#include "method/stepper.h"

/* The polynomials l_j(s) / b_j and their integrals, where l_j is 1 at node j of the Galerkin curve and 0 at all other
 * nodes. These integrals times the impulses h b_j F_j give the curve at any point of the step. */
typedef struct {
    int node_count;
    double *legendre_factor; /* [k][j] the factor of Legendre's polynomial P_k(2 s - 1) in l_j(s) / b_j */
    /* [j][lanes] The same factors, a row for each node j: the factors of P_0, P_1, ... in l_j / b_j. */
    double *legendre_factor_by_node;
    long double reciprocal[GALERKIN_MAX_LANES + 2];      /* [k] 1 / k */
    long double integral_factor[GALERKIN_MAX_LANES + 1]; /* [k] 1 / (4 k + 2) */
    /* [lanes][TVI_SAMPLES] The integrals and the double integrals of l_j / b_j from 0 to each sample of a step. */
    double *to_samples, *twice_to_samples;
} galerkin_polynomials;

/* Computes P[k][i] = P_k(2 s_i - 1), k < node_count, i < lanes. */
void tvi_galerkin_legendre(const galerkin_polynomials *polynomials, int lanes, const double s[], double *P);
/* Computes single[j] = int_0^s l_j(r) / b_j dr and twice[j] = int_0^s (s - r) l_j(r) / b_j dr. */
void tvi_galerkin_integrate(const galerkin_polynomials *polynomials, double s, double single[], double twice[]);

typedef struct {
    int node_count, lane_count;
    double *b, *c;       /* [lanes] weights and nodes of the quadrature on [0, 1] */
    double *nu;          /* [j][i] the matrix nu_ij: a_ij / b_j, or sum_k a_ik a_kj / b_j for a separable system */
    double *one_minus_c; /* [lanes] 1 - c_j, the weight of an impulse in the increment of a separable system's q */
    double *last_term;   /* [lanes] the weight of an impulse in the last term of the rate's Legendre series */
    long double exact_c[GALERKIN_MAX_LANES], exact_b[GALERKIN_MAX_LANES];
} galerkin_coefficients;

void tvi_galerkin_allocate_tables(galerkin_coefficients *coefficients, galerkin_polynomials *polynomials,
                                  tvi_arena *arena, int node_count, int lanes);
/* Computes the coefficients and the polynomials, for Q'' = F if is_second_order is set, and for Q' = V, P' = F
 * otherwise. */
void tvi_galerkin_compute_tables(galerkin_coefficients *coefficients, galerkin_polynomials *polynomials,
                                 bool is_second_order);

/* Rounds x to a multiple of 2^-bits. */
double tvi_galerkin_round_to_grid(long double x, int bits);

/* Computes factors[point][next]: the factor of the rate at `point` of the last step_count steps in the rate that a fit
 * by polynomials of this degree predicts at node `next` of the next step, for m nodes in [0, 1] and steps of one size.
 * Points of the last step come first. */
void tvi_galerkin_fit_factors(int m, const long double node[], int step_count, int degree,
                              long double factors[][GALERKIN_MAX_LANES]);

/* Computes table [step_count][j][i]: the factors of the impulses of the last step_count steps in what is predicted for
 * the next one, all of the same size. The rates are fitted by polynomials of this degree; per_impulse [j][i] is what an
 * impulse of the next step would make of its rate. */
void tvi_galerkin_extrapolation(const galerkin_coefficients *coefficients, int step_count, int degree,
                                const double *per_impulse, double *table);

#endif
