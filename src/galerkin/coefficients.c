/* coefficients.c - Computes the coefficients of Gauss collocation: its nodes and weights, and the matrix that turns the
 * impulses of the forces, h b_j F_j at node j, into the changes of the unknowns at all nodes. Also computes the
 * polynomials through the nodes (coefficients.h). The stepper of the Galerkin curve (galerkin.c) calls these functions
 * when it is made. */
#include "galerkin/coefficients.h"
#include "algebra/quadrature.h"

#include <math.h>

enum { MAX_LANES = TVI_GALERKIN_MAX_LANES };

/* ---- Polynomials through the nodes ------------------------------------------------------------------------------- */

void tvi_galerkin_allocate_node_polynomials(galerkin_node_polynomials *polynomials, tvi_arena *arena, int node_count,
                                            int lanes, const jet_sweeps *vectorised_loops)
{
    polynomials->node_count = node_count;
    polynomials->vectorised_loops = vectorised_loops;
    polynomials->legendre_coefficient = tvi_arena_allocate_doubles(arena, (size_t)node_count * (size_t)node_count);
    polynomials->transposed_legendre_coefficient =
        tvi_arena_allocate_doubles(arena, (size_t)node_count * (size_t)lanes);
    polynomials->integral_from_0_to_sample_theta = tvi_arena_allocate_doubles(arena, (size_t)lanes * TVI_SAMPLES);
    polynomials->double_integral_from_0_to_sample_theta =
        tvi_arena_allocate_doubles(arena, (size_t)lanes * TVI_SAMPLES);
}

/* Computes P_0 .. P_max_degree at x = 2 s - 1, max_degree >= 1, by (k+1) P_{k+1} = (2k+1) x P_k - k P_{k-1}. */
static void evaluate_legendre_polynomials(const galerkin_node_polynomials *polynomials, int max_degree, long double s,
                                          long double P[])
{
    const long double x = 2 * s - 1;
    P[0] = 1;
    P[1] = x;
    for (int k = 1; k < max_degree; k++)
        P[k + 1] = ((2 * k + 1) * x * P[k] - k * P[k - 1]) * polynomials->reciprocal_integer[k + 1];
}

/* Computes the factors (2 k + 1) P_k(2 c_j - 1) of the polynomials P_k(2 s - 1) in l_j(s) / b_j (coefficients.h). They
 * have this form because the Gauss rule is exact for l_j P_k. */
static void set_legendre_coefficients(galerkin_node_polynomials *polynomials, int lanes, const long double node[])
{
    const int m = polynomials->node_count;
    long double P[MAX_LANES + 1];
    for (int j = 0; j < m; j++) {
        evaluate_legendre_polynomials(polynomials, m, node[j], P);
        for (int k = 0; k < m; k++)
            polynomials->legendre_coefficient[k * m + j] = polynomials->transposed_legendre_coefficient[j * lanes + k] =
                (double)((2 * k + 1) * P[k]);
    }
}

/* Computes all tables of `polynomials` for the Gauss nodes of [0, 1]. */
static void set_tables_of_node_polynomials(galerkin_node_polynomials *polynomials, int lanes, const long double node[])
{
    double single_integral[MAX_LANES], double_integral[MAX_LANES];
    for (int k = 1; k < MAX_LANES + 2; k++) polynomials->reciprocal_integer[k] = 1 / (long double)k;
    for (int k = 1; k < MAX_LANES + 1; k++) polynomials->legendre_integral_factor[k] = 1 / (long double)(4 * k + 2);
    set_legendre_coefficients(polynomials, lanes, node);
    for (int place = 0; place < TVI_SAMPLES; place++) {
        tvi_galerkin_integrate_node_polynomials(polynomials, tvi_sample_theta[place], single_integral, double_integral);
        for (int j = 0; j < polynomials->node_count; j++) {
            polynomials->integral_from_0_to_sample_theta[j * TVI_SAMPLES + place] = single_integral[j];
            polynomials->double_integral_from_0_to_sample_theta[j * TVI_SAMPLES + place] = double_integral[j];
        }
    }
}

void tvi_galerkin_evaluate_legendre_polynomials(const galerkin_node_polynomials *polynomials, int lanes,
                                                const double s[], double *P)
{
    for (int i = 0; i < lanes; i++) P[i] = 1;
    for (int i = 0; i < lanes && polynomials->node_count > 1; i++) P[lanes + i] = 2 * s[i] - 1;
    for (int k = 1; k < polynomials->node_count - 1; k++) {
        const double rise = (2 * k + 1) / (k + 1.0), fall = k / (k + 1.0);
        double *now = P + k * lanes;
        for (int i = 0; i < lanes; i++) now[lanes + i] = rise * P[lanes + i] * now[i] - fall * now[i - lanes];
    }
}

/* Computes I_k = int_0^s P_k(2 r - 1) dr, k <= node_count: I_0 = s, I_k = (P_{k+1} - P_{k-1})(2 s - 1) / (4 k + 2). */
static void integrate_legendre_polynomials(const galerkin_node_polynomials *polynomials, long double s, long double I[])
{
    long double P[MAX_LANES + 2];
    evaluate_legendre_polynomials(polynomials, polynomials->node_count + 1, s, P);
    I[0] = s;
    for (int k = 1; k <= polynomials->node_count; k++)
        I[k] = (P[k + 1] - P[k - 1]) * polynomials->legendre_integral_factor[k];
}

/* Computes single_integral[j] = int_0^s l_j / b_j in long double. `node` contains the Gauss nodes. */
static void integrate_node_polynomials(const galerkin_node_polynomials *polynomials, long double s,
                                       const long double node[], long double single_integral[])
{
    long double P[MAX_LANES + 1], I[MAX_LANES + 1];
    integrate_legendre_polynomials(polynomials, s, I);
    for (int j = 0; j < polynomials->node_count; j++) {
        evaluate_legendre_polynomials(polynomials, polynomials->node_count, node[j], P);
        single_integral[j] = 0;
        for (int k = polynomials->node_count - 1; k >= 0; k--) single_integral[j] += (2 * k + 1) * P[k] * I[k];
    }
}

/* Computes both integrals of l_j / b_j from those of Legendre's polynomials. The integral of I_k is s^2 / 2 for k = 0,
 * and (I_{k+1} - I_{k-1}) / (4 k + 2) otherwise. If s is small, I_{k+1} and I_{k-1} nearly cancel, but the difference
 * in long double still has the digits of a double. */
void tvi_galerkin_integrate_node_polynomials(const galerkin_node_polynomials *polynomials, double s,
                                             double single_integral[], double double_integral[])
{
    const int m = polynomials->node_count;
    long double I[MAX_LANES + 1];
    double first[MAX_LANES], second[MAX_LANES];
    integrate_legendre_polynomials(polynomials, s, I);
    for (int k = 0; k < m; k++) {
        first[k] = (double)I[k];
        second[k] =
            (double)(k > 0 ? (I[k + 1] - I[k - 1]) * polynomials->legendre_integral_factor[k] : I[0] * I[0] / 2);
    }
    polynomials->vectorised_loops->combine(m, first, 1, m, polynomials->legendre_coefficient, single_integral);
    polynomials->vectorised_loops->combine(m, second, 1, m, polynomials->legendre_coefficient, double_integral);
}

/* ---- Coefficients ------------------------------------------------------------------------------------------------ */

void tvi_galerkin_allocate_coefficients(galerkin_coefficients *coefficients, tvi_arena *arena, int node_count,
                                        int lanes)
{
    const size_t width = (size_t)lanes;
    coefficients->node_count = node_count;
    coefficients->lane_count = lanes;
    coefficients->node_weight = tvi_arena_allocate_doubles(arena, width);
    coefficients->node_abscissa = tvi_arena_allocate_doubles(arena, width);
    coefficients->node_impulse_to_node_unknown_matrix = tvi_arena_allocate_doubles(arena, width * width);
    coefficients->impulse_sum_weights.one_minus_abscissa = tvi_arena_allocate_doubles(arena, width);
    coefficients->impulse_sum_weights.last_term_weight = tvi_arena_allocate_doubles(arena, width);
}

static double round_to_binary_grid(long double x, int bits) { return (double)ldexpl(rintl(ldexpl(x, bits)), -bits); }

/* Sets the nodes c and the weights b, which are multiples of 2^-53. Differences of such numbers are exact, so that
 * c_i + c_{m-1-i} = 1, b_i = b_{m-1-i} and sum b_j = 1 hold for the doubles themselves. */
static void set_nodes_and_weights(galerkin_coefficients *coefficients)
{
    const int m = coefficients->node_count;
    double left = 1;
    tvi_quadrature_compute_nodes(TVI_GAUSS, m, coefficients->long_double_node_abscissa,
                                 coefficients->long_double_weight);
    for (int i = 0; i < m; i++) {
        coefficients->long_double_node_abscissa[i] = (1 + coefficients->long_double_node_abscissa[i]) / 2;
        coefficients->long_double_weight[i] /= 2;
    }
    for (int i = 0; i < (m + 1) / 2; i++) {
        coefficients->node_abscissa[i] = round_to_binary_grid(coefficients->long_double_node_abscissa[i], 53);
        coefficients->node_abscissa[m - 1 - i] = 1 - coefficients->node_abscissa[i];
        coefficients->node_weight[i] = coefficients->node_weight[m - 1 - i] =
            i < m - 1 - i ? round_to_binary_grid(coefficients->long_double_weight[i], 53) : left;
        left -= 2 * coefficients->node_weight[i];
    }
    if (m % 2 == 0)
        coefficients->node_weight[m / 2 - 1] = coefficients->node_weight[m / 2] =
            coefficients->node_weight[m / 2] + left / 2;
    coefficients->inverse_weight_of_end_nodes = 1 / coefficients->node_weight[0];
    for (int i = m; i < coefficients->lane_count; i++)
        coefficients->node_abscissa[i] = coefficients->node_abscissa[m - 1];
}

/* Sets the weights of the sums at the end of a step. The rate of an unknown is sum_k f_k P_k(x), x in [-1, 1], with
 * P_k Legendre's polynomials. last_term_weight gives f_{m-1}, which is the size of the last term at the ends of the
 * step. */
static void set_impulse_sum_weights(galerkin_coefficients *coefficients, const galerkin_node_polynomials *polynomials)
{
    const int m = coefficients->node_count;
    for (int j = 0; j < m; j++) {
        coefficients->impulse_sum_weights.one_minus_abscissa[j] = 1 - coefficients->node_abscissa[j];
        coefficients->impulse_sum_weights.last_term_weight[j] =
            polynomials->transposed_legendre_coefficient[j * coefficients->lane_count + m - 1];
    }
}

/* Returns the element (i, j), i >= j, of the impulse matrix: sum_k a_ik a_kj / b_j for a separable system, and a_ij /
 * b_j for any other, where a_ij is the integral of l_j from 0 to c_i. The element (i, j) of collocation_matrix is a_ij
 * / b_j. The exact double integral of l_j must not replace the sum, since the method would not be symplectic. */
static long double compute_impulse_matrix_element(const galerkin_coefficients *coefficients, bool is_second_order,
                                                  long double collocation_matrix[][MAX_LANES], int i, int j)
{
    long double square = 0;
    if (!is_second_order) return collocation_matrix[i][j];
    for (int k = 0; k < coefficients->node_count; k++)
        square += collocation_matrix[i][k] * coefficients->long_double_weight[k] * collocation_matrix[k][j];
    return square;
}

/* Sets the impulse matrix nu (coefficients.h) for m nodes c_i. Its elements are multiples of 2^-52. The elements above
 * the diagonal follow from the condition of symplecticity, which then holds exactly: nu_ij - nu_ji = c_i - c_j for a
 * separable system, and nu_ij + nu_ji = 1 for any other. The condition of symmetry, nu_ij = nu_{m-1-j, m-1-i}, holds,
 * too. */
static void set_impulse_matrix(galerkin_coefficients *coefficients, const galerkin_node_polynomials *polynomials,
                               bool is_second_order)
{
    long double collocation_matrix[MAX_LANES][MAX_LANES];
    const int m = coefficients->node_count, lanes = coefficients->lane_count;
    double *matrix = coefficients->node_impulse_to_node_unknown_matrix;
    for (int i = 0; i < m; i++)
        integrate_node_polynomials(polynomials, coefficients->long_double_node_abscissa[i],
                                   coefficients->long_double_node_abscissa, collocation_matrix[i]);
    for (int i = 0; i < m; i++)
        for (int j = 0; j <= i; j++) {
            const long double exact =
                compute_impulse_matrix_element(coefficients, is_second_order, collocation_matrix, i, j) +
                compute_impulse_matrix_element(coefficients, is_second_order, collocation_matrix, m - 1 - j, m - 1 - i);
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
    set_tables_of_node_polynomials(polynomials, coefficients->lane_count, coefficients->long_double_node_abscissa);
    set_impulse_sum_weights(coefficients, polynomials);
    set_impulse_matrix(coefficients, polynomials, is_second_order);
}
