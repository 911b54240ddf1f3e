/* tables.c - Computes the coefficients of Gauss collocation, the polynomials through its nodes and the factors of
 * extrapolation (tables.h), when a stepper is made. */
#include "galerkin/tables.h"
#include "algebra/quadrature.h"

#include <math.h>

enum { MAX_LANES = GALERKIN_MAX_LANES };

/* ---- Polynomials through the nodes ------------------------------------------------------------------------------- */

/* Computes P_0 .. P_max_degree at x = 2 s - 1, max_degree >= 1, by (k+1) P_{k+1} = (2k+1) x P_k - k P_{k-1}. */
static void evaluate_legendre_polynomials(const galerkin_polynomials *polynomials, int max_degree, long double s,
                                          long double P[])
{
    const long double x = 2 * s - 1;
    P[0] = 1;
    P[1] = x;
    for (int k = 1; k < max_degree; k++)
        P[k + 1] = ((2 * k + 1) * x * P[k] - k * P[k - 1]) * polynomials->reciprocal[k + 1];
}

/* Computes the factors (2 k + 1) P_k(2 c_j - 1) of the polynomials P_k(2 s - 1) in l_j(s) / b_j (tables.h). They
 * have this form because the Gauss rule is exact for l_j P_k. */
static void set_legendre_coefficients(galerkin_polynomials *polynomials, int lanes, const long double node[])
{
    const int m = polynomials->node_count;
    long double P[MAX_LANES + 1];
    for (int j = 0; j < m; j++) {
        evaluate_legendre_polynomials(polynomials, m, node[j], P);
        for (int k = 0; k < m; k++)
            polynomials->legendre_factor[k * m + j] = polynomials->legendre_factor_by_node[j * lanes + k] =
                (double)((2 * k + 1) * P[k]);
    }
}

/* Computes all tables of `polynomials` for the Gauss nodes of [0, 1]. */
static void set_polynomials(galerkin_polynomials *polynomials, int lanes, const long double node[])
{
    double single[MAX_LANES], twice[MAX_LANES];
    for (int k = 1; k < MAX_LANES + 2; k++) polynomials->reciprocal[k] = 1 / (long double)k;
    for (int k = 1; k < MAX_LANES + 1; k++) polynomials->integral_factor[k] = 1 / (long double)(4 * k + 2);
    set_legendre_coefficients(polynomials, lanes, node);
    for (int place = 0; place < TVI_SAMPLES; place++) {
        tvi_galerkin_integrate(polynomials, tvi_sample_theta[place], single, twice);
        for (int j = 0; j < polynomials->node_count; j++) {
            polynomials->to_samples[j * TVI_SAMPLES + place] = single[j];
            polynomials->twice_to_samples[j * TVI_SAMPLES + place] = twice[j];
        }
    }
}

void tvi_galerkin_legendre(const galerkin_polynomials *polynomials, int lanes, const double s[], double *P)
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
static void integrate_legendre_polynomials(const galerkin_polynomials *polynomials, long double s, long double I[])
{
    long double P[MAX_LANES + 2];
    evaluate_legendre_polynomials(polynomials, polynomials->node_count + 1, s, P);
    I[0] = s;
    for (int k = 1; k <= polynomials->node_count; k++) I[k] = (P[k + 1] - P[k - 1]) * polynomials->integral_factor[k];
}

/* Computes single[j] = int_0^s l_j / b_j in long double. `node` contains the Gauss nodes. */
static void integrate_node_polynomials(const galerkin_polynomials *polynomials, long double s, const long double node[],
                                       long double single[])
{
    long double P[MAX_LANES + 1], I[MAX_LANES + 1];
    integrate_legendre_polynomials(polynomials, s, I);
    for (int j = 0; j < polynomials->node_count; j++) {
        evaluate_legendre_polynomials(polynomials, polynomials->node_count, node[j], P);
        single[j] = 0;
        for (int k = polynomials->node_count - 1; k >= 0; k--) single[j] += (2 * k + 1) * P[k] * I[k];
    }
}

/* Computes both integrals of l_j / b_j from those of Legendre's polynomials. The integral of I_k is s^2 / 2 for k = 0,
 * and (I_{k+1} - I_{k-1}) / (4 k + 2) otherwise. If s is small, I_{k+1} and I_{k-1} nearly cancel, but the difference
 * in long double still has the digits of a double. */
void tvi_galerkin_integrate(const galerkin_polynomials *polynomials, double s, double single[], double twice[])
{
    const int m = polynomials->node_count;
    long double I[MAX_LANES + 1];
    double first[MAX_LANES], second[MAX_LANES];
    integrate_legendre_polynomials(polynomials, s, I);
    for (int k = 0; k < m; k++) {
        first[k] = (double)I[k];
        second[k] = (double)(k > 0 ? (I[k + 1] - I[k - 1]) * polynomials->integral_factor[k] : I[0] * I[0] / 2);
    }
    for (int j = 0; j < m; j++) single[j] = twice[j] = 0;
    for (int k = 0; k < m; k++)
        for (int j = 0; j < m; j++) {
            single[j] += first[k] * polynomials->legendre_factor[k * m + j];
            twice[j] += second[k] * polynomials->legendre_factor[k * m + j];
        }
}

/* ---- Coefficients ------------------------------------------------------------------------------------------------ */

void tvi_galerkin_allocate_tables(galerkin_coefficients *coefficients, galerkin_polynomials *polynomials,
                                  tvi_arena *arena, int node_count, int lanes)
{
    const size_t width = (size_t)lanes, nodes = (size_t)node_count;
    polynomials->node_count = coefficients->node_count = node_count;
    polynomials->legendre_factor = tvi_arena_allocate_doubles(arena, nodes * nodes);
    polynomials->legendre_factor_by_node = tvi_arena_allocate_doubles(arena, nodes * width);
    polynomials->to_samples = tvi_arena_allocate_doubles(arena, width * TVI_SAMPLES);
    polynomials->twice_to_samples = tvi_arena_allocate_doubles(arena, width * TVI_SAMPLES);
    coefficients->lane_count = lanes;
    tvi_arena_allocate_each(
        arena, width,
        (double **[]){&coefficients->b, &coefficients->c, &coefficients->one_minus_c, &coefficients->last_term, NULL});
    coefficients->nu = tvi_arena_allocate_doubles(arena, width * width);
}

double tvi_galerkin_round_to_grid(long double x, int bits) { return (double)ldexpl(rintl(ldexpl(x, bits)), -bits); }

/* Sets the nodes c and the weights b, which are multiples of 2^-53. Differences of such numbers are exact, so that
 * c_i + c_{m-1-i} = 1, b_i = b_{m-1-i} and sum b_j = 1 hold for the doubles themselves. */
static void set_nodes_and_weights(galerkin_coefficients *coefficients)
{
    const int m = coefficients->node_count;
    double left = 1;
    tvi_quadrature_compute_nodes(TVI_GAUSS, m, coefficients->exact_c, coefficients->exact_b);
    for (int i = 0; i < m; i++) {
        coefficients->exact_c[i] = (1 + coefficients->exact_c[i]) / 2;
        coefficients->exact_b[i] /= 2;
    }
    for (int i = 0; i < (m + 1) / 2; i++) {
        coefficients->c[i] = tvi_galerkin_round_to_grid(coefficients->exact_c[i], 53);
        coefficients->c[m - 1 - i] = 1 - coefficients->c[i];
        coefficients->b[i] = coefficients->b[m - 1 - i] =
            i < m - 1 - i ? tvi_galerkin_round_to_grid(coefficients->exact_b[i], 53) : left;
        left -= 2 * coefficients->b[i];
    }
    if (m % 2 == 0) coefficients->b[m / 2 - 1] = coefficients->b[m / 2] = coefficients->b[m / 2] + left / 2;
    for (int i = m; i < coefficients->lane_count; i++) coefficients->c[i] = coefficients->c[m - 1];
}

/* Sets the weights of the sums at the end of a step. The rate of an unknown is sum_k f_k P_k(x), x in [-1, 1], with
 * P_k Legendre's polynomials. last_term gives f_{m-1}, which is the size of the last term at the ends of the
 * step. */
static void set_sum_weights(galerkin_coefficients *coefficients, const galerkin_polynomials *polynomials)
{
    const int m = coefficients->node_count;
    for (int j = 0; j < m; j++) {
        coefficients->one_minus_c[j] = 1 - coefficients->c[j];
        coefficients->last_term[j] = polynomials->legendre_factor_by_node[j * coefficients->lane_count + m - 1];
    }
}

/* Returns the element (i, j), i >= j, of the impulse matrix: sum_k a_ik a_kj / b_j for a separable system, and a_ij /
 * b_j for any other, where a_ij is the integral of l_j from 0 to c_i. The element (i, j) of a_over_b is a_ij
 * / b_j. The exact double integral of l_j must not replace the sum, since the method would not be symplectic. */
static long double exact_nu(const galerkin_coefficients *coefficients, bool is_second_order,
                            long double a_over_b[][MAX_LANES], int i, int j)
{
    long double square = 0;
    if (!is_second_order) return a_over_b[i][j];
    for (int k = 0; k < coefficients->node_count; k++)
        square += a_over_b[i][k] * coefficients->exact_b[k] * a_over_b[k][j];
    return square;
}

/* Sets the impulse matrix nu (tables.h) for m nodes c_i. Its elements are multiples of 2^-52. The elements above
 * the diagonal follow from the condition of symplecticity, which then holds exactly: nu_ij - nu_ji = c_i - c_j for a
 * separable system, and nu_ij + nu_ji = 1 for any other. The condition of symmetry, nu_ij = nu_{m-1-j, m-1-i}, holds,
 * too. */
static void set_nu(galerkin_coefficients *coefficients, const galerkin_polynomials *polynomials, bool is_second_order)
{
    long double a_over_b[MAX_LANES][MAX_LANES];
    const int m = coefficients->node_count, lanes = coefficients->lane_count;
    double *matrix = coefficients->nu;
    for (int i = 0; i < m; i++)
        integrate_node_polynomials(polynomials, coefficients->exact_c[i], coefficients->exact_c, a_over_b[i]);
    for (int i = 0; i < m; i++)
        for (int j = 0; j <= i; j++) {
            const long double exact = exact_nu(coefficients, is_second_order, a_over_b, i, j) +
                                      exact_nu(coefficients, is_second_order, a_over_b, m - 1 - j, m - 1 - i);
            const double nu = tvi_galerkin_round_to_grid(exact / 2, 52);
            matrix[j * lanes + i] = nu;
            matrix[i * lanes + j] = is_second_order ? nu - (coefficients->c[i] - coefficients->c[j]) : 1 - nu;
        }
    for (int lane = m; lane < lanes; lane++)
        for (int j = 0; j < m; j++) matrix[j * lanes + lane] = matrix[j * lanes + m - 1];
}

void tvi_galerkin_compute_tables(galerkin_coefficients *coefficients, galerkin_polynomials *polynomials,
                                 bool is_second_order)
{
    set_nodes_and_weights(coefficients);
    set_polynomials(polynomials, coefficients->lane_count, coefficients->exact_c);
    set_sum_weights(coefficients, polynomials);
    set_nu(coefficients, polynomials, is_second_order);
}

/* ---- Extrapolation ----------------------------------------------------------------------------------------------- */

/* Computes basis[k][i]: polynomials of degree k at 3 m points, orthonormal on the first fitted_point_count of these
 * points. The points are the nodes of the last step, of the step before it, and of the next one. */
static void set_orthonormal_polynomials(int m, const long double node[], int fitted_point_count, int degree,
                                        long double basis[][3 * MAX_LANES])
{
    for (int k = 0; k <= degree; k++) {
        long double *now = basis[k];
        for (int i = 0; i < 3 * m; i++) {
            const long double s = node[i % m] + (i < m ? 0 : i < 2 * m ? -1 : 1);
            now[i] = k > 0 ? s * basis[k - 1][i] : 1;
        }
        /* If before == k, the product is the square of the norm of basis[k]. */
        for (int before = 0; before <= k; before++) {
            long double product = 0;
            /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): 3 m >= 3 numbers of `now` are set. */
            for (int i = 0; i < fitted_point_count; i++) product += now[i] * basis[before][i];
            for (int i = 0; i < 3 * m && before < k; i++) now[i] -= product * basis[before][i];
            for (int i = 0; i < 3 * m && before == k; i++) now[i] /= sqrtl(product);
        }
    }
}

/* The prediction is a least-squares fit by polynomials, so that the factor is sum_k pi_k(1 + c_next) pi_k(s_point),
 * with the polynomials pi_k of set_orthonormal_polynomials. s_point is the time of the point from the start of the last
 * step, in units of the step. */
void tvi_galerkin_fit_factors(int m, const long double node[], int step_count, int degree,
                              long double factors[][MAX_LANES])
{
    long double basis[2 * MAX_LANES][3 * MAX_LANES];
    set_orthonormal_polynomials(m, node, step_count * m, degree, basis);
    for (int point = 0; point < step_count * m; point++)
        for (int next = 0; next < m; next++) {
            factors[point][next] = 0;
            for (int k = 0; k <= degree; k++) factors[point][next] += basis[k][2 * m + next] * basis[k][point];
        }
}

void tvi_galerkin_extrapolation(const galerkin_coefficients *coefficients, int step_count, int degree,
                                const double *per_impulse, double *table)
{
    long double factors[2 * MAX_LANES][MAX_LANES];
    const int m = coefficients->node_count, lanes = coefficients->lane_count;
    tvi_galerkin_fit_factors(m, coefficients->exact_c, step_count, degree, factors);
    for (int point = 0; point < step_count * m; point++)
        for (int next = 0; next < m; next++) {
            double *column = table + (point / m * lanes + point % m) * lanes;
            const double factor =
                (double)(factors[point][next] * coefficients->exact_b[next] / coefficients->exact_b[point % m]);
            for (int i = 0; i < lanes; i++) column[i] += factor * per_impulse[next * lanes + i];
        }
}
