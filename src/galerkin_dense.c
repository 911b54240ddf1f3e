/* galerkin_dense.c - see galerkin_dense.h. */
#include "galerkin_dense.h"
#include "galerkin.h"
#include "stepper.h"

void galerkin_dense_take(galerkin_dense *dense, tvi_arena *arena, int points)
{
    const size_t m = (size_t)points;
    dense->points = points;
    dense->shape = tvi_arena_doubles(arena, m * m);
    dense->once = tvi_arena_doubles(arena, m * TVI_SAMPLES);
    dense->twice = tvi_arena_doubles(arena, m * TVI_SAMPLES);
}

/* P_0(x) .. P_top(x), top >= 1, by (k+1) P_{k+1} = (2k+1) x P_k - k P_{k-1}. */
static void set_legendre(int top, long double x, long double P[])
{
    P[0] = 1;
    P[1] = x;
    for (int k = 1; k < top; k++) P[k + 1] = ((2 * k + 1) * x * P[k] - k * P[k - 1]) / (k + 1);
}

/* shape_kj = (2 k + 1) b_j P_k(2 c_j - 1), since the Gauss rule is exact for l_j P_k. */
static void set_shape(galerkin_dense *dense, const long double node[], const long double weight[])
{
    const int m = dense->points;
    long double P[TVI_GALERKIN_MAX_LANES + 1];
    for (int j = 0; j < m; j++) {
        set_legendre(m, 2 * node[j] - 1, P);
        for (int k = 0; k < m; k++) dense->shape[k * m + j] = (double)((2 * k + 1) * weight[j] * P[k]);
    }
}

void galerkin_dense_prepare(galerkin_dense *dense, const long double node[], const long double weight[])
{
    set_shape(dense, node, weight);
    for (int place = 0; place < TVI_SAMPLES; place++)
        galerkin_dense_integrate(dense, tvi_sample_place[place], TVI_SAMPLES, dense->once + place,
                                 dense->twice + place);
}

/* The integral of P_k(2 r - 1) is I_0 = s, I_k = (P_{k+1} - P_{k-1})(2 s - 1) / (4 k + 2); that of I_k in turn is
 * s^2 / 2, (I_{k+1} - I_{k-1}) / (4 k + 2). Their differences would lose digits of a double where s is small. */
void galerkin_dense_integrate(const galerkin_dense *dense, double s, int stride, double once[], double twice[])
{
    const int m = dense->points;
    long double P[TVI_GALERKIN_MAX_LANES + 2], I[TVI_GALERKIN_MAX_LANES + 1];
    set_legendre(m + 1, 2 * (long double)s - 1, P);
    I[0] = s;
    for (int k = 1; k <= m; k++) I[k] = (P[k + 1] - P[k - 1]) / (4 * k + 2);
    for (int j = 0; j < m; j++) once[j * stride] = twice[j * stride] = 0;
    for (int k = 0; k < m; k++) {
        const double first = (double)I[k];
        const double second = (double)(k > 0 ? (I[k + 1] - I[k - 1]) / (4 * k + 2) : I[0] * I[0] / 2);
        for (int j = 0; j < m; j++) {
            once[j * stride] += first * dense->shape[k * m + j];
            twice[j * stride] += second * dense->shape[k * m + j];
        }
    }
}
