/* dense.c - Computes polynomials through the nodes, and their integrals (dense.h). */
#include "galerkin/dense.h"

enum { MAX_POINTS = TVI_GALERKIN_MAX_LANES };

void tvi_galerkin_dense_take(galerkin_dense *dense, tvi_arena *arena, int points, int lanes, const jet_sweeps *sweeps)
{
    dense->points = points;
    dense->sweeps = sweeps;
    dense->shape = tvi_arena_doubles(arena, (size_t)points * (size_t)points);
    dense->of_node = tvi_arena_doubles(arena, (size_t)points * (size_t)lanes);
    dense->once = tvi_arena_doubles(arena, (size_t)lanes * TVI_SAMPLES);
    dense->twice = tvi_arena_doubles(arena, (size_t)lanes * TVI_SAMPLES);
}

/* Computes P_0 .. P_top of x = 2 s - 1, top >= 1, by (k+1) P_{k+1} = (2k+1) x P_k - k P_{k-1}. */
static void set_legendre(const galerkin_dense *dense, int top, long double s, long double P[])
{
    const long double x = 2 * s - 1;
    P[0] = 1;
    P[1] = x;
    for (int k = 1; k < top; k++) P[k + 1] = ((2 * k + 1) * x * P[k] - k * P[k - 1]) * dense->inverse[k + 1];
}

/* Computes shape_kj = (2 k + 1) P_k(2 c_j - 1), since the Gauss rule is exact for l_j P_k. */
static void set_shape(galerkin_dense *dense, int lanes, const long double node[])
{
    const int m = dense->points;
    long double P[MAX_POINTS + 1];
    for (int j = 0; j < m; j++) {
        set_legendre(dense, m, node[j], P);
        for (int k = 0; k < m; k++)
            dense->shape[k * m + j] = dense->of_node[j * lanes + k] = (double)((2 * k + 1) * P[k]);
    }
}

void tvi_galerkin_dense_prepare(galerkin_dense *dense, int lanes, const long double node[])
{
    double once[MAX_POINTS], twice[MAX_POINTS];
    for (int k = 1; k < MAX_POINTS + 2; k++) dense->inverse[k] = 1 / (long double)k;
    for (int k = 1; k < MAX_POINTS + 1; k++) dense->integral[k] = 1 / (long double)(4 * k + 2);
    set_shape(dense, lanes, node);
    for (int place = 0; place < TVI_SAMPLES; place++) {
        tvi_galerkin_dense_integrate(dense, tvi_sample_theta[place], once, twice);
        for (int j = 0; j < dense->points; j++) {
            dense->once[j * TVI_SAMPLES + place] = once[j];
            dense->twice[j * TVI_SAMPLES + place] = twice[j];
        }
    }
}

void tvi_galerkin_dense_legendre(const galerkin_dense *dense, int lanes, const double s[], double *P)
{
    for (int i = 0; i < lanes; i++) P[i] = 1;
    for (int i = 0; i < lanes && dense->points > 1; i++) P[lanes + i] = 2 * s[i] - 1;
    for (int k = 1; k < dense->points - 1; k++) {
        const double rise = (2 * k + 1) / (k + 1.0), fall = k / (k + 1.0);
        double *now = P + k * lanes;
        for (int i = 0; i < lanes; i++) now[lanes + i] = rise * P[lanes + i] * now[i] - fall * now[i - lanes];
    }
}

/* Computes I_k = int_0^s P_k(2 r - 1) dr, k <= points: I_0 = s, I_k = (P_{k+1} - P_{k-1})(2 s - 1) / (4 k + 2). */
static void set_integrals(const galerkin_dense *dense, long double s, long double I[])
{
    long double P[MAX_POINTS + 2];
    set_legendre(dense, dense->points + 1, s, P);
    I[0] = s;
    for (int k = 1; k <= dense->points; k++) I[k] = (P[k + 1] - P[k - 1]) * dense->integral[k];
}

void tvi_galerkin_dense_once(const galerkin_dense *dense, long double s, const long double node[], long double once[])
{
    long double P[MAX_POINTS + 1], I[MAX_POINTS + 1];
    set_integrals(dense, s, I);
    for (int j = 0; j < dense->points; j++) {
        set_legendre(dense, dense->points, node[j], P);
        once[j] = 0;
        for (int k = dense->points - 1; k >= 0; k--) once[j] += (2 * k + 1) * P[k] * I[k];
    }
}

/* Computes the integrals once and twice. The integral of I_k is s^2 / 2 or (I_{k+1} - I_{k-1}) / (4 k + 2). For a small
 * s these differences lose digits beyond those of a double. */
void tvi_galerkin_dense_integrate(const galerkin_dense *dense, double s, double once[], double twice[])
{
    const int m = dense->points;
    long double I[MAX_POINTS + 1];
    double first[MAX_POINTS], second[MAX_POINTS];
    set_integrals(dense, s, I);
    for (int k = 0; k < m; k++) {
        first[k] = (double)I[k];
        second[k] = (double)(k > 0 ? (I[k + 1] - I[k - 1]) * dense->integral[k] : I[0] * I[0] / 2);
    }
    dense->sweeps->combine(m, first, 1, m, dense->shape, once);
    dense->sweeps->combine(m, second, 1, m, dense->shape, twice);
}
