/* Powers with a constant exponent. */
#include "convolve.h"
#include "rule.h"

#include <math.h>
#include <stdlib.h>

/* ---- z = sqrt a,  a_0 > 0 ---------------------------------------------------------------------------------------- */

bool jet_sqrt_value(double c, int width, const double *a, const double *b, double *z)
{
    (void)c, (void)b;
    int outside = 0;
    for (int w = 0; w < width; w++) {
        outside |= a[w] <= 0;
        z[w] = sqrt(a[w]);
    }
    return !outside;
}

/* a = z^2  =>  z_k = (a_k - sum_{j=1}^{k-1} z_j z_{k-j}) / (2 z_0).   O(N^2). */
void jet_sqrt_series(double c, int k, size_t stride, int width, const double *a, const double *b, double *z)
{
    (void)c, (void)b;
    const double *ak = a + (size_t)k * stride;
    double *zk = z + (size_t)k * stride;
    for (int w = 0; w < width; w++) zk[w] = 0;
    convolve(zk, WEIGHT_ONE, 1, k - 1, k, stride, width, z, z);
    for (int w = 0; w < width; w++) zk[w] = (ak[w] - zk[w]) / (2 * z[w]);
}

/* dz_k = (da_k - 2 sum_{j=1}^{k} z_j dz_{k-j}) / (2 z_0). */
void jet_sqrt_tangent(const jet_tangent *x, int k)
{
    const double *da = x->da + (size_t)k * x->dstride;
    double *dz = x->dz + (size_t)k * x->dstride;
    for (int w = 0; w < x->lanes; w++) dz[w] = da[w];
    broadcast(dz, -2, WEIGHT_ONE, 1, k, k, x->stride, x->z, x->dstride, x->dz, x->lanes);
    for (int w = 0; w < x->lanes; w++) dz[w] /= 2 * x->z[0];
}

/* dz/da = 1 / (2 z). */
jet jet_sqrt_pull(struct jet_node *z, jet zbar, int which)
{
    (void)which;
    return jet_div(jet_mul(0.5, zbar), jet_of_node(z));
}

/* ---- z = a^c,  a_0 != 0 where c is an integer, else a_0 > 0 ------------------------------------------------------ */

enum { HALVES_MAX = 16 };

/* a^(halves/2) by multiplications and a square root: it vectorises, where pow does not. */
static void power_by_halves(int halves, int width, const double *a, double *z)
{
    const int count = abs(halves);
    for (int w = 0; w < width; w++) {
        double power = count % 2 ? sqrt(a[w]) : 1;
        for (int i = 0; i < count / 2; i++) power *= a[w];
        z[w] = halves < 0 ? 1 / power : power;
    }
}

bool jet_pow_value(double c, int width, const double *a, const double *b, double *z)
{
    (void)b;
    const bool integer = c == floor(c);
    int outside = 0;
    for (int w = 0; w < width; w++) outside |= a[w] == 0 || (!integer && a[w] < 0);
    if (fabs(2 * c) <= HALVES_MAX && 2 * c == floor(2 * c)) {
        power_by_halves((int)(2 * c), width, a, z);
    } else {
        for (int w = 0; w < width; w++) z[w] = pow(a[w], c);
    }
    return !outside;
}

/* a z' = c a' z  =>  z_k = 1/(k a_0) sum_{j=1}^{k} (c j - (k-j)) a_j z_{k-j}.   O(N^2). */
void jet_pow_series(double c, int k, size_t stride, int width, const double *a, const double *b, double *z)
{
    (void)b;
    double *zk = z + (size_t)k * stride;
    for (int w = 0; w < width; w++) zk[w] = 0;
    convolve(zk, (jet_weight){c + 1, -k}, 1, k, k, stride, width, a, z);
    for (int w = 0; w < width; w++) zk[w] /= k * a[w];
}

/* k a_0 dz_k = sum_{j=1}^{k} (c j - (k-j)) (a_j dz_{k-j} + z_{k-j} da_j) - k z_k da_0;   dz_0 = c z_0 / a_0 da_0.
 * With i = k - j in the second sum the weight is c (k - i) - i. */
void jet_pow_tangent(const jet_tangent *x, int k)
{
    const double *da0 = x->da;
    double *dz = x->dz + (size_t)k * x->dstride;
    if (k == 0) {
        for (int w = 0; w < x->lanes; w++) dz[w] = x->c * x->z[0] / x->a[0] * da0[w];
        return;
    }
    const double zk = x->z[(size_t)k * x->stride];
    for (int w = 0; w < x->lanes; w++) dz[w] = -k * zk * da0[w];
    broadcast(dz, 1, (jet_weight){x->c + 1, -k}, 1, k, k, x->stride, x->a, x->dstride, x->dz, x->lanes);
    broadcast(dz, 1, (jet_weight){-x->c - 1, x->c * k}, 0, k - 1, k, x->stride, x->z, x->dstride, x->da, x->lanes);
    for (int w = 0; w < x->lanes; w++) dz[w] /= k * x->a[0];
}

/* dz/da = c a^(c-1). */
jet jet_pow_pull(struct jet_node *z, jet zbar, int which)
{
    (void)which;
    return jet_mul(z->number, jet_mul(zbar, jet_pow(jet_of_node(z->a), z->number - 1)));
}
