/* lobatto.c - Computes the tables of the Lobatto nodes (lobatto.h) when a stepper is made. */
#include "galerkin/lobatto.h"
#include "algebra/quadrature.h"

#include <math.h>

/* All nodes of a step, on the grid: the m Gauss nodes c_i, and then the m + 1 Lobatto nodes d_j. */
enum { MAX_NODES_OF_BOTH = TVI_MAX_NODES + LOBATTO_MAX };
typedef struct {
    int gauss, count;
    long double exact[MAX_NODES_OF_BOTH];
    double node[MAX_NODES_OF_BOTH];
    double sigma[MAX_NODES_OF_BOTH][MAX_NODES_OF_BOTH];
} both_nodes;

/* ---- Legendre's polynomials -------------------------------------------------------------------------------------- */

/* Computes P_0 .. P_k at 2 s - 1, k >= 1. */
static void evaluate_legendre(int k, long double s, long double P[])
{
    P[0] = 1;
    P[1] = 2 * s - 1;
    for (int i = 1; i < k; i++) P[i + 1] = ((2 * i + 1) * P[1] * P[i] - i * P[i - 1]) / (i + 1);
}

/* Computes I_k = int_0^s P_k(2 r - 1) dr, k <= most, and the integrals of these, int_0^s I_k. */
static void integrate_legendre(int most, long double s, long double I[], long double twice[])
{
    long double P[LOBATTO_MAX + 3], more[LOBATTO_MAX + 2];
    evaluate_legendre(most + 2, s, P);
    more[0] = s;
    for (int k = 1; k <= most + 1; k++) more[k] = (P[k + 1] - P[k - 1]) / (4 * k + 2);
    for (int k = 0; k <= most; k++) {
        I[k] = more[k];
        twice[k] = k > 0 ? (more[k + 1] - more[k - 1]) / (4 * k + 2) : s * s / 2;
    }
}

/* Returns the inverse of the sum w_j P_k^2 over the m + 1 Lobatto nodes: they integrate P_m^2 too large. */
static long double inverse_norm(int m, int k) { return k < m ? 2 * k + 1 : m; }

/* Computes the m + 1 Lobatto nodes of [0, 1], and their weights. */
static void lobatto_nodes(int m, long double d[], long double w[])
{
    tvi_quadrature_compute_nodes(TVI_LOBATTO, m + 1, d, w);
    for (int j = 0; j <= m; j++) {
        d[j] = (1 + d[j]) / 2;
        w[j] /= 2;
    }
}

void tvi_lobatto_integrate(const galerkin_lobatto *lobatto, double s, double single[], double twice[])
{
    const int m = lobatto->node_count;
    long double P[LOBATTO_MAX + 1], I[LOBATTO_MAX + 1], II[LOBATTO_MAX + 1];
    integrate_legendre(m, s, I, II);
    for (int j = 0; j <= m; j++) {
        long double first = 0, second = 0;
        evaluate_legendre(m, lobatto->exact_d[j], P);
        for (int k = m; k >= 0; k--) {
            first += inverse_norm(m, k) * P[k] * I[k];
            second += inverse_norm(m, k) * P[k] * II[k];
        }
        single[j] = (double)first;
        twice[j] = (double)second;
    }
}

/* ---- The kernel on the grid -------------------------------------------------------------------------------------- */

static int mirror_of(const both_nodes *nodes, int i)
{
    return i < nodes->gauss ? nodes->gauss - 1 - i : nodes->count - 1 - (i - nodes->gauss);
}

static long double exact_sigma(int m, long double x, long double y)
{
    long double a[LOBATTO_MAX + 1], b[LOBATTO_MAX + 1], unused[LOBATTO_MAX + 1], sum = 0;
    integrate_legendre(m, x, a, unused);
    integrate_legendre(m, y, b, unused);
    for (int k = m - 1; k >= 0; k--) sum += (2 * k + 1) * a[k] * b[k];
    return sum;
}

static void set_nodes(both_nodes *nodes, const galerkin_coefficients *coefficients)
{
    const int m = nodes->gauss = coefficients->node_count;
    long double w[LOBATTO_MAX];
    nodes->count = 2 * m + 1;
    for (int i = 0; i < m; i++) {
        nodes->exact[i] = coefficients->exact_c[i];
        nodes->node[i] = coefficients->c[i];
    }
    lobatto_nodes(m, nodes->exact + m, w);
    for (int i = m; i < nodes->count; i++) {
        const int mirror = mirror_of(nodes, i);
        nodes->node[i] = i < mirror    ? tvi_galerkin_round_to_grid(nodes->exact[i], 53)
                         : i == mirror ? 0.5
                                       : 1 - nodes->node[mirror];
    }
}

/* Sets sigma for all pairs of nodes. One of two mirrored pairs is rounded, after its error and that of the mirrored one
 * are averaged; the other follows from it. */
static void set_sigma(both_nodes *nodes)
{
    const int m = nodes->gauss;
    const double *x = nodes->node;
    const long double *exact = nodes->exact;
    bool is_set[MAX_NODES_OF_BOTH][MAX_NODES_OF_BOTH] = {{false}};
    for (int i = 0; i < nodes->count; i++)
        for (int j = 0; j < nodes->count; j++) {
            if (is_set[i][j]) continue;
            const int a = mirror_of(nodes, i), b = mirror_of(nodes, j);
            const long double mirrored = exact_sigma(m, exact[a], exact[b]) - 1 + exact[i] + exact[j];
            const double value =
                x[i] == 0 || x[j] == 0 ? 0
                : x[i] == 1            ? x[j]
                : x[j] == 1            ? x[i]
                            : tvi_galerkin_round_to_grid((exact_sigma(m, exact[i], exact[j]) + mirrored) / 2, 53);
            nodes->sigma[i][j] = nodes->sigma[j][i] = value;
            is_set[i][j] = is_set[j][i] = true;
            if (is_set[a][b]) continue;
            nodes->sigma[a][b] = nodes->sigma[b][a] = ((1 - x[i]) - x[j]) + value;
            is_set[a][b] = is_set[b][a] = true;
        }
}

static double nu_of(const both_nodes *nodes, int i, int j) { return nodes->node[i] - nodes->sigma[i][j]; }

/* ---- The tables -------------------------------------------------------------------------------------------------- */

/* Sets the integrals of l_i / b_i from 0 to d_j, on a grid on which those at mirrored nodes add up to 1. */
static void set_integrals(const galerkin_coefficients *coefficients, double integral[][LOBATTO_MAX])
{
    const int m = coefficients->node_count;
    long double d[LOBATTO_MAX], w[LOBATTO_MAX], P[LOBATTO_MAX + 1], I[LOBATTO_MAX + 1], unused[LOBATTO_MAX + 1];
    lobatto_nodes(m, d, w);
    for (int j = 0; 2 * j <= m; j++) {
        integrate_legendre(m, d[j], I, unused);
        for (int i = 0; i < m; i++) {
            long double sum = 0;
            evaluate_legendre(m, coefficients->exact_c[i], P);
            for (int k = m - 1; k >= 0; k--) sum += (2 * k + 1) * P[k] * I[k];
            if (2 * j == m && 2 * i >= m) sum = 2 * i + 1 == m ? 0.5L : 1 - integral[m - 1 - i][j];
            integral[i][j] = tvi_galerkin_round_to_grid(sum, 52);
            integral[m - 1 - i][m - j] = 1 - integral[i][j];
        }
    }
}

/* Inverts the matrix nu(d_i, d_j), i = 1 .. m, j = 0 .. m - 1, by elimination with row exchanges. */
static void set_inverse(galerkin_lobatto *lobatto, const both_nodes *nodes, int lanes)
{
    const int m = lobatto->node_count;
    long double a[TVI_MAX_NODES][2 * TVI_MAX_NODES];
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) {
            a[i][j] = nu_of(nodes, m + 1 + i, m + j);
            a[i][m + j] = i == j;
        }
    for (int k = 0; k < m; k++) {
        int pivot = k;
        for (int i = k + 1; i < m; i++)
            if (fabsl(a[i][k]) > fabsl(a[pivot][k])) pivot = i;
        for (int j = 0; j < 2 * m; j++) {
            const long double kept = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = kept;
        }
        for (int i = 0; i < m; i++) {
            const long double factor = i == k ? 0 : a[i][k] / a[k][k];
            for (int j = k; j < 2 * m && i != k; j++) a[i][j] -= factor * a[k][j];
        }
    }
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++) lobatto->target_to_source[i * lanes + j] = (double)(a[j][m + i] / a[j][j]);
}

void tvi_lobatto_allocate(galerkin_lobatto *lobatto, tvi_arena *arena, int node_count, int lanes)
{
    const size_t width = (size_t)lanes, all = (size_t)node_count + 1;
    lobatto->node_count = node_count;
    lobatto->d = tvi_arena_allocate_doubles(arena, width);
    tvi_arena_allocate_each(arena, all, (double **[]){&lobatto->w, &lobatto->one_minus_d, &lobatto->last_term, NULL});
    tvi_arena_allocate_each(arena, width * width,
                            (double **[]){&lobatto->gauss_to_target, &lobatto->source_to_gauss,
                                          &lobatto->source_to_target, &lobatto->target_to_source, NULL});
    lobatto->two_steps = tvi_arena_allocate_doubles(arena, 2 * all * all);
    lobatto->last_step = tvi_arena_allocate_doubles(arena, all * all);
    lobatto->single_samples = tvi_arena_allocate_doubles(arena, all * TVI_SAMPLES);
    lobatto->double_samples = tvi_arena_allocate_doubles(arena, all * TVI_SAMPLES);
}

static void set_fit(int m, const long double d[], int step_count, int degree, double *table)
{
    long double factors[2 * GALERKIN_MAX_LANES][GALERKIN_MAX_LANES];
    tvi_galerkin_fit_factors(m + 1, d, step_count, degree, factors);
    for (int point = 0; point < step_count * (m + 1); point++)
        for (int next = 0; next <= m; next++) table[point * (m + 1) + next] = (double)factors[point][next];
}

/* Sets what belongs to each node alone, and the samples. */
static void set_weights(galerkin_lobatto *lobatto, const both_nodes *nodes)
{
    const int m = lobatto->node_count;
    long double *d = lobatto->exact_d, w[LOBATTO_MAX], P[LOBATTO_MAX + 1];
    double single[LOBATTO_MAX], twice[LOBATTO_MAX];
    lobatto_nodes(m, d, w);
    for (int j = 0; j <= m; j++) {
        evaluate_legendre(m, d[j], P);
        lobatto->w[j] = (double)w[j];
        lobatto->one_minus_d[j] = 1 - nodes->node[m + j];
        lobatto->last_term[j] = (double)(m * P[m]);
    }
    set_fit(m, d, 2, m > 1 ? 3 * m / 2 : 1, lobatto->two_steps);
    set_fit(m, d, 1, m, lobatto->last_step);
    for (int place = 0; place < TVI_SAMPLES; place++) {
        tvi_lobatto_integrate(lobatto, tvi_sample_theta[place], single, twice);
        for (int j = 0; j <= m; j++) {
            lobatto->single_samples[j * TVI_SAMPLES + place] = single[j];
            lobatto->double_samples[j * TVI_SAMPLES + place] = twice[j];
        }
    }
}

void tvi_lobatto_compute(galerkin_lobatto *lobatto, const galerkin_coefficients *coefficients, bool is_second_order)
{
    const int m = lobatto->node_count, lanes = coefficients->lane_count;
    both_nodes nodes;
    double integral[TVI_MAX_NODES][LOBATTO_MAX];
    set_nodes(&nodes, coefficients);
    set_sigma(&nodes);
    set_integrals(coefficients, integral);
    set_weights(lobatto, &nodes);
    set_inverse(lobatto, &nodes, lanes);
    for (int lane = 0; lane < lanes; lane++) {
        const int i = lane < m ? lane : m - 1, target = m + 1 + i;
        lobatto->d[lane] = nodes.node[target];
        for (int j = 0; j < m; j++) {
            lobatto->gauss_to_target[j * lanes + lane] =
                is_second_order ? nu_of(&nodes, target, j) : integral[j][i + 1];
            lobatto->source_to_gauss[j * lanes + lane] = is_second_order ? nu_of(&nodes, i, m + j) : 1 - integral[i][j];
            lobatto->source_to_target[j * lanes + lane] = nu_of(&nodes, target, m + j);
        }
    }
}
