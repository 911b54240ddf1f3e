/* dense.c - Computes polynomials through the nodes, and their integrals (dense.h). */
#include "galerkin/dense.h"

enum { MAX_POINTS = TVI_GALERKIN_MAX_LANES };

void tvi_galerkin_allocate_node_polynomials(galerkin_node_polynomials *polynomials, tvi_arena *arena, int node_count,
                                            int lanes, const jet_sweeps *sweeps)
{
    polynomials->node_count = node_count;
    polynomials->sweeps = sweeps;
    polynomials->legendre_coefficient = tvi_arena_allocate_doubles(arena, (size_t)node_count * (size_t)node_count);
    polynomials->transposed_coefficient = tvi_arena_allocate_doubles(arena, (size_t)node_count * (size_t)lanes);
    polynomials->single_integral = tvi_arena_allocate_doubles(arena, (size_t)lanes * TVI_SAMPLES);
    polynomials->double_integral = tvi_arena_allocate_doubles(arena, (size_t)lanes * TVI_SAMPLES);
}

/* Computes P_0 .. P_top at x = 2 s - 1, top >= 1, by (k+1) P_{k+1} = (2k+1) x P_k - k P_{k-1}. */
static void evaluate_legendre_polynomials(const galerkin_node_polynomials *polynomials, int top, long double s,
                                          long double P[])
{
    const long double x = 2 * s - 1;
    P[0] = 1;
    P[1] = x;
    for (int k = 1; k < top; k++) P[k + 1] = ((2 * k + 1) * x * P[k] - k * P[k - 1]) * polynomials->reciprocal[k + 1];
}

/* Computes the coefficients (2 k + 1) P_k(2 c_j - 1) of l_j / b_j, since the Gauss rule is exact for l_j P_k. */
static void set_legendre_coefficients(galerkin_node_polynomials *polynomials, int lanes, const long double node[])
{
    const int m = polynomials->node_count;
    long double P[MAX_POINTS + 1];
    for (int j = 0; j < m; j++) {
        evaluate_legendre_polynomials(polynomials, m, node[j], P);
        for (int k = 0; k < m; k++)
            polynomials->legendre_coefficient[k * m + j] = polynomials->transposed_coefficient[j * lanes + k] =
                (double)((2 * k + 1) * P[k]);
    }
}

void tvi_galerkin_prepare_node_polynomials(galerkin_node_polynomials *polynomials, int lanes, const long double node[])
{
    double single_integral[MAX_POINTS], double_integral[MAX_POINTS];
    for (int k = 1; k < MAX_POINTS + 2; k++) polynomials->reciprocal[k] = 1 / (long double)k;
    for (int k = 1; k < MAX_POINTS + 1; k++) polynomials->legendre_integral_factor[k] = 1 / (long double)(4 * k + 2);
    set_legendre_coefficients(polynomials, lanes, node);
    for (int place = 0; place < TVI_SAMPLES; place++) {
        tvi_galerkin_integrate_twice(polynomials, tvi_sample_theta[place], single_integral, double_integral);
        for (int j = 0; j < polynomials->node_count; j++) {
            polynomials->single_integral[j * TVI_SAMPLES + place] = single_integral[j];
            polynomials->double_integral[j * TVI_SAMPLES + place] = double_integral[j];
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
    long double P[MAX_POINTS + 2];
    evaluate_legendre_polynomials(polynomials, polynomials->node_count + 1, s, P);
    I[0] = s;
    for (int k = 1; k <= polynomials->node_count; k++)
        I[k] = (P[k + 1] - P[k - 1]) * polynomials->legendre_integral_factor[k];
}

void tvi_galerkin_integrate_node_polynomials(const galerkin_node_polynomials *polynomials, long double s,
                                             const long double node[], long double single_integral[])
{
    long double P[MAX_POINTS + 1], I[MAX_POINTS + 1];
    integrate_legendre_polynomials(polynomials, s, I);
    for (int j = 0; j < polynomials->node_count; j++) {
        evaluate_legendre_polynomials(polynomials, polynomials->node_count, node[j], P);
        single_integral[j] = 0;
        for (int k = polynomials->node_count - 1; k >= 0; k--) single_integral[j] += (2 * k + 1) * P[k] * I[k];
    }
}

/* Computes both integrals. The integral of I_k is s^2 / 2 for k = 0, and (I_{k+1} - I_{k-1}) / (4 k + 2) otherwise.
 * If s is small, I_{k+1} and I_{k-1} nearly cancel, but the difference in long double still has the digits of a
 * double. */
void tvi_galerkin_integrate_twice(const galerkin_node_polynomials *polynomials, double s, double single_integral[],
                                  double double_integral[])
{
    const int m = polynomials->node_count;
    long double I[MAX_POINTS + 1];
    double first[MAX_POINTS], second[MAX_POINTS];
    integrate_legendre_polynomials(polynomials, s, I);
    for (int k = 0; k < m; k++) {
        first[k] = (double)I[k];
        second[k] =
            (double)(k > 0 ? (I[k + 1] - I[k - 1]) * polynomials->legendre_integral_factor[k] : I[0] * I[0] / 2);
    }
    polynomials->sweeps->combine(m, first, 1, m, polynomials->legendre_coefficient, single_integral);
    polynomials->sweeps->combine(m, second, 1, m, polynomials->legendre_coefficient, double_integral);
}
