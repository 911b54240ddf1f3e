/* coefficients.c - Computes the coefficients of Gauss collocation (coefficients.h). */
#include "galerkin/coefficients.h"
#include "algebra/quadrature.h"

#include <math.h>

enum { MAX_LANES = TVI_GALERKIN_MAX_LANES };

void tvi_galerkin_allocate_coefficients(galerkin_coefficients *coefficients, tvi_arena *arena, int node_count,
                                        int lanes)
{
    const size_t width = (size_t)lanes;
    coefficients->node_count = node_count;
    coefficients->lanes = lanes;
    coefficients->node_weight = tvi_arena_allocate_doubles(arena, width);
    coefficients->node_abscissa = tvi_arena_allocate_doubles(arena, width);
    coefficients->impulse_matrix = tvi_arena_allocate_doubles(arena, width * width);
    coefficients->end_weights.node_count = node_count;
    coefficients->end_weights.one_minus_abscissa = tvi_arena_allocate_doubles(arena, width);
    coefficients->end_weights.last_term_weight = tvi_arena_allocate_doubles(arena, width);
}

static double round_to_binary_grid(long double x, int bits) { return (double)ldexpl(rintl(ldexpl(x, bits)), -bits); }

/* Sets the nodes c and the weights b, which are multiples of 2^-53. Differences of such numbers are exact, so that
 * c_i + c_{m-1-i} = 1, b_i = b_{m-1-i} and sum b_j = 1 hold for the doubles themselves. */
static void set_nodes_and_weights(galerkin_coefficients *coefficients)
{
    const int m = coefficients->node_count;
    double left = 1;
    tvi_quadrature_compute_nodes(TVI_GAUSS, m, coefficients->long_abscissa, coefficients->long_weight);
    for (int i = 0; i < m; i++) {
        coefficients->long_abscissa[i] = (1 + coefficients->long_abscissa[i]) / 2;
        coefficients->long_weight[i] /= 2;
    }
    for (int i = 0; i < (m + 1) / 2; i++) {
        coefficients->node_abscissa[i] = round_to_binary_grid(coefficients->long_abscissa[i], 53);
        coefficients->node_abscissa[m - 1 - i] = 1 - coefficients->node_abscissa[i];
        coefficients->node_weight[i] = coefficients->node_weight[m - 1 - i] =
            i < m - 1 - i ? round_to_binary_grid(coefficients->long_weight[i], 53) : left;
        left -= 2 * coefficients->node_weight[i];
    }
    if (m % 2 == 0)
        coefficients->node_weight[m / 2 - 1] = coefficients->node_weight[m / 2] =
            coefficients->node_weight[m / 2] + left / 2;
    coefficients->inverse_end_weight = 1 / coefficients->node_weight[0];
    for (int i = m; i < coefficients->lanes; i++) coefficients->node_abscissa[i] = coefficients->node_abscissa[m - 1];
}

/* Sets the weights of the sums at the end of a step. The rate of an unknown is sum_k f_k P_k(x), x in [-1, 1], with
 * P_k Legendre's polynomials. last_term_weight gives f_{m-1}, which is the size of the last term at the ends of the
 * step. */
static void set_end_weights(galerkin_coefficients *coefficients, const galerkin_node_polynomials *polynomials)
{
    const int m = coefficients->node_count;
    for (int j = 0; j < m; j++) {
        coefficients->end_weights.one_minus_abscissa[j] = 1 - coefficients->node_abscissa[j];
        coefficients->end_weights.last_term_weight[j] =
            polynomials->transposed_coefficient[j * coefficients->lanes + m - 1];
    }
}

/* Returns the element (i, j), i >= j, of the impulse matrix: sum_k a_ik a_kj / b_j for a separable system, and a_ij
 * / b_j for any other. The element (i, j) of collocation_matrix is a_ij / b_j. The exact double integral of l_j must
 * not replace a a, since the method would not be symplectic. */
static long double compute_impulse_factor(const galerkin_coefficients *coefficients, bool is_second_order,
                                          long double collocation_matrix[][MAX_LANES], int i, int j)
{
    long double square = 0;
    if (!is_second_order) return collocation_matrix[i][j];
    for (int k = 0; k < coefficients->node_count; k++)
        square += collocation_matrix[i][k] * coefficients->long_weight[k] * collocation_matrix[k][j];
    return square;
}

/* Sets the impulse matrix nu. Its elements are multiples of 2^-52. The elements above the diagonal follow from the
 * condition of symplecticity, which then holds exactly: nu_ij - nu_ji = c_i - c_j for a separable system, and nu_ij
 * + nu_ji = 1 for any other. The condition of symmetry, nu_ij = nu_{m-1-j, m-1-i}, holds, too. */
static void set_impulse_matrix(galerkin_coefficients *coefficients, const galerkin_node_polynomials *polynomials,
                               bool is_second_order)
{
    long double collocation_matrix[MAX_LANES][MAX_LANES];
    const int m = coefficients->node_count, lanes = coefficients->lanes;
    double *matrix = coefficients->impulse_matrix;
    for (int i = 0; i < m; i++)
        tvi_galerkin_integrate_node_polynomials(polynomials, coefficients->long_abscissa[i],
                                                coefficients->long_abscissa, collocation_matrix[i]);
    for (int i = 0; i < m; i++)
        for (int j = 0; j <= i; j++) {
            const long double exact =
                compute_impulse_factor(coefficients, is_second_order, collocation_matrix, i, j) +
                compute_impulse_factor(coefficients, is_second_order, collocation_matrix, m - 1 - j, m - 1 - i);
            const double nu = round_to_binary_grid(exact / 2, 52);
            matrix[j * lanes + i] = nu;
            matrix[i * lanes + j] =
                is_second_order ? nu - (coefficients->node_abscissa[i] - coefficients->node_abscissa[j]) : 1 - nu;
        }
    for (int lane = m; lane < lanes; lane++)
        for (int j = 0; j < m; j++) matrix[j * lanes + lane] = matrix[j * lanes + m - 1];
}

void tvi_galerkin_compute_coefficients(galerkin_coefficients *coefficients, galerkin_node_polynomials *polynomials,
                                       bool is_second_order)
{
    set_nodes_and_weights(coefficients);
    tvi_galerkin_prepare_node_polynomials(polynomials, coefficients->lanes, coefficients->long_abscissa);
    set_end_weights(coefficients, polynomials);
    set_impulse_matrix(coefficients, polynomials, is_second_order);
}
