/* coefficients.h - Computes the nodes c_i, the weights b_i and the matrix a_ij of Gauss collocation, and the
 * polynomials through the nodes. The elements of the matrix are divided by b_j, because they multiply impulses, which
 * are rates times h b_j (docs/method.md section 6). The stepper (galerkin.c), the predictor and the dense output use
 * these tables. */
#ifndef TVI_SRC_GALERKIN_COEFFICIENTS_H
#define TVI_SRC_GALERKIN_COEFFICIENTS_H

#include "galerkin/loops.h"
#include "method/stepper.h"

/* The polynomials l_j(s) / b_j and their integrals, where l_j is 1 at node j of the Galerkin curve and 0 at all other
 * nodes. These integrals times the impulses h b_j F_j give the curve at any point of the step. */
typedef struct {
    int node_count;
    /* The functions of the tapes for the instruction set. `combine`, which adds products, alone is called here. */
    const jet_sweeps *vectorised_loops;
    /* [k][j] The factor of Legendre's polynomial P_k(2 s - 1) in l_j(s) / b_j. */
    double *legendre_coefficient;
    long double reciprocal_integer[TVI_GALERKIN_MAX_LANES + 2]; /* [k] the number 1 / k */
    /* [k] 1 / (4 k + 2), a factor in integrals of Legendre's polynomials. */
    long double legendre_integral_factor[TVI_GALERKIN_MAX_LANES + 1];
    /* [j][lanes] legendre_coefficient, transposed: a row holds the factors of P_0, P_1, .. for one node */
    double *transposed_legendre_coefficient;
    /* [lanes][TVI_SAMPLES] The integrals and the double integrals of l_j / b_j from 0 to each sample point of a
     * step. */
    double *integral_from_0_to_sample_theta, *double_integral_from_0_to_sample_theta;
} galerkin_node_polynomials;

void tvi_galerkin_allocate_node_polynomials(galerkin_node_polynomials *polynomials, tvi_arena *arena, int node_count,
                                            int lanes, const jet_sweeps *vectorised_loops);
/* Computes P[k][i] = P_k(2 s_i - 1), k < node_count, i < lanes. */
void tvi_galerkin_evaluate_legendre_polynomials(const galerkin_node_polynomials *polynomials, int lanes,
                                                const double s[], double *P);
/* Computes single_integral[j] = int_0^s l_j(r) / b_j dr and double_integral[j] = int_0^s (s - r) l_j(r) / b_j dr. */
void tvi_galerkin_integrate_node_polynomials(const galerkin_node_polynomials *polynomials, double s,
                                             double single_integral[], double double_integral[]);

typedef struct {
    int node_count, lane_count;
    double *node_weight, *node_abscissa; /* [lanes] weights b_j and nodes c_j of the quadrature on [0, 1] */
    /* The reciprocal 1 / b_j for the first and the last node, whose weights are equal. */
    double inverse_weight_of_end_nodes;
    /* [j][i] The factor of the impulse of node j in an unknown at node i: a_ij / b_j, or sum_k a_ik a_kj / b_j for a
     * separable system. */
    double *node_impulse_to_node_unknown_matrix;
    galerkin_double_integral_and_tail_weights impulse_sum_weights;
    long double long_double_node_abscissa[TVI_GALERKIN_MAX_LANES], long_double_weight[TVI_GALERKIN_MAX_LANES];
} galerkin_coefficients;

void tvi_galerkin_allocate_coefficients(galerkin_coefficients *coefficients, tvi_arena *arena, int node_count,
                                        int lanes);
/* Computes the coefficients for Q'' = F if is_second_order is set, and for Q' = V, P' = F otherwise. Also prepares the
 * polynomials, whose integrals the coefficients use. */
void tvi_galerkin_compute_coefficients(galerkin_coefficients *coefficients, galerkin_node_polynomials *polynomials,
                                       bool is_second_order);
#endif
