/* coefficients.c - Computes the coefficients of Gauss collocation (coefficients.h). */
#include "galerkin/coefficients.h"
#include "algebra/quadrature.h"

#include <math.h>

enum { MAX_LANES = TVI_GALERKIN_MAX_LANES };

void tvi_galerkin_coefficients_take(galerkin_coefficients *w, tvi_arena *arena, int points, int lanes)
{
    const size_t width = (size_t)lanes;
    w->points = points;
    w->lanes = lanes;
    w->b = tvi_arena_doubles(arena, width);
    w->c = tvi_arena_doubles(arena, width);
    w->matrix = tvi_arena_doubles(arena, width * width);
    w->weights.points = points;
    w->weights.late = tvi_arena_doubles(arena, width);
    w->weights.last = tvi_arena_doubles(arena, width);
}

static double on_grid(long double x, int bits) { return (double)ldexpl(rintl(ldexpl(x, bits)), -bits); }

/* Sets the nodes and weights. c and b are on the grid 2^-53, where differences are exact: c_i + c_{m-1-i} = 1, b_i =
 * b_{m-1-i} and sum b_j = 1 hold for the doubles themselves. */
static void set_nodes(galerkin_coefficients *w)
{
    const int m = w->points;
    double left = 1;
    tvi_quadrature_compute_nodes(TVI_GAUSS, m, w->exact_node, w->exact_weight);
    for (int i = 0; i < m; i++) {
        w->exact_node[i] = (1 + w->exact_node[i]) / 2;
        w->exact_weight[i] /= 2;
    }
    for (int i = 0; i < (m + 1) / 2; i++) {
        w->c[i] = on_grid(w->exact_node[i], 53);
        w->c[m - 1 - i] = 1 - w->c[i];
        w->b[i] = w->b[m - 1 - i] = i < m - 1 - i ? on_grid(w->exact_weight[i], 53) : left;
        left -= 2 * w->b[i];
    }
    if (m % 2 == 0) w->b[m / 2 - 1] = w->b[m / 2] = w->b[m / 2] + left / 2;
    w->inverse_b = 1 / w->b[0];
    for (int i = m; i < w->lanes; i++) w->c[i] = w->c[m - 1];
}

/* Sets the weights of the sums at the end of a step. The last one is that of the tail. The rate of an unknown is sum_k
 * f_k P_k(x), x in [-1, 1], with P_k Legendre's polynomials; f_k, k = m - 1, is the last term at the ends. */
static void set_weights(galerkin_coefficients *w, const galerkin_dense *dense)
{
    const int m = w->points;
    for (int j = 0; j < m; j++) {
        w->weights.late[j] = 1 - w->c[j];
        w->weights.last[j] = dense->of_node[j * w->lanes + m - 1];
    }
}

/* The factor (i, j), i >= j, of impulses: (a a)_ij / b_j of a separable system, otherwise a_ij / b_j, from ab = a_ij /
 * b_j. The product a a is not the double integral, whose method is not symplectic. */
static long double impulse_factor(const galerkin_coefficients *w, bool is_second_order, long double ab[][MAX_LANES],
                                  int i, int j)
{
    long double square = 0;
    if (!is_second_order) return ab[i][j];
    for (int k = 0; k < w->points; k++) square += ab[i][k] * w->exact_weight[k] * ab[k][j];
    return square;
}

/* Sets the matrix. The elements nu_ij are on a grid, too. The entries above the diagonal follow from the condition of
 * symplecticity, which then holds exactly: nu_ij - nu_ji = c_i - c_j of a separable system, otherwise nu_ij + nu_ji =
 * 1; and from that of symmetry, nu_ij = nu_{m-1-j, m-1-i}. */
static void set_matrix(galerkin_coefficients *w, const galerkin_dense *dense, bool is_second_order)
{
    long double ab[MAX_LANES][MAX_LANES];
    const int m = w->points, lanes = w->lanes;
    double *matrix = w->matrix;
    for (int i = 0; i < m; i++) tvi_galerkin_dense_once(dense, w->exact_node[i], w->exact_node, ab[i]);
    for (int i = 0; i < m; i++)
        for (int j = 0; j <= i; j++) {
            const long double exact = impulse_factor(w, is_second_order, ab, i, j) +
                                      impulse_factor(w, is_second_order, ab, m - 1 - j, m - 1 - i);
            const double nu = on_grid(exact / 2, 52);
            matrix[j * lanes + i] = nu;
            matrix[i * lanes + j] = is_second_order ? nu - (w->c[i] - w->c[j]) : 1 - nu;
        }
    for (int lane = m; lane < lanes; lane++)
        for (int j = 0; j < m; j++) matrix[j * lanes + lane] = matrix[j * lanes + m - 1];
}

void tvi_galerkin_coefficients_prepare(galerkin_coefficients *w, galerkin_dense *dense, bool is_second_order)
{
    set_nodes(w);
    tvi_galerkin_dense_prepare(dense, w->lanes, w->exact_node);
    set_weights(w, dense);
    set_matrix(w, dense, is_second_order);
}
