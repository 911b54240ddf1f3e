/* Products and quotients: plain convolutions. */
#include "convolve.h"
#include "rule.h"

/* ---- z = a b ----------------------------------------------------------------------------------------------------- */

bool jet_mul_value(double c, int width, const double *a, const double *b, double *z)
{
    (void)c;
    for (int w = 0; w < width; w++) z[w] = a[w] * b[w];
    return true;
}

/* z_k = sum_{j=0}^{k} a_j b_{k-j}.   O(N^2). */
void jet_mul_series(double c, int k, size_t stride, int width, const double *a, const double *b, double *z)
{
    (void)c;
    double *zk = z + (size_t)k * stride;
    for (int w = 0; w < width; w++) zk[w] = 0;
    convolve(zk, WEIGHT_ONE, 0, k, k, stride, width, a, b);
}

/* dz_k = sum_{j=0}^{k} (b_j da_{k-j} + a_j db_{k-j}). */
void jet_mul_tangent(const jet_tangent *x, int k)
{
    double *dz = x->dz + (size_t)k * x->dstride;
    for (int w = 0; w < x->lanes; w++) dz[w] = 0;
    broadcast(dz, 1, WEIGHT_ONE, 0, k, k, x->stride, x->b, x->dstride, x->da, x->lanes);
    broadcast(dz, 1, WEIGHT_ONE, 0, k, k, x->stride, x->a, x->dstride, x->db, x->lanes);
}

jet jet_mul_pull(struct jet_node *z, jet zbar, int which)
{
    return jet_mul(zbar, jet_of_node(which == 0 ? z->b : z->a));
}

/* ---- z = a^2 ----------------------------------------------------------------------------------------------------- */

bool jet_sqr_value(double c, int width, const double *a, const double *b, double *z)
{
    (void)c, (void)b;
    for (int w = 0; w < width; w++) z[w] = a[w] * a[w];
    return true;
}

/* z_k = 2 sum_{j < k/2} a_j a_{k-j} + (a_{k/2}^2 for even k): half the products of a b. */
void jet_sqr_series(double c, int k, size_t stride, int width, const double *a, const double *b, double *z)
{
    (void)c, (void)b;
    double *zk = z + (size_t)k * stride;
    for (int w = 0; w < width; w++) zk[w] = 0;
    convolve(zk, WEIGHT_ONE, 0, (k - 1) / 2, k, stride, width, a, a);
    const double *half = a + (size_t)(k / 2) * stride;
    const double even = k % 2 == 0 ? 1 : 0;
    for (int w = 0; w < width; w++) zk[w] = 2 * zk[w] + even * (half[w] * half[w]);
}

/* dz_k = 2 sum_{j=0}^{k} a_j da_{k-j}. */
void jet_sqr_tangent(const jet_tangent *x, int k)
{
    double *dz = x->dz + (size_t)k * x->dstride;
    for (int w = 0; w < x->lanes; w++) dz[w] = 0;
    broadcast(dz, 2, WEIGHT_ONE, 0, k, k, x->stride, x->a, x->dstride, x->da, x->lanes);
}

jet jet_sqr_pull(struct jet_node *z, jet zbar, int which)
{
    (void)which;
    return jet_mul(2, jet_mul(zbar, jet_of_node(z->a)));
}

/* ---- z = a / b,  b_0 != 0 ---------------------------------------------------------------------------------------- */

bool jet_div_value(double c, int width, const double *a, const double *b, double *z)
{
    (void)c;
    int outside = 0;
    for (int w = 0; w < width; w++) {
        outside |= b[w] == 0;
        z[w] = a[w] / b[w];
    }
    return !outside;
}

/* a = z b  =>  z_k = (a_k - sum_{j=1}^{k} b_j z_{k-j}) / b_0.   O(N^2). */
void jet_div_series(double c, int k, size_t stride, int width, const double *a, const double *b, double *z)
{
    (void)c;
    const double *ak = a + (size_t)k * stride;
    double *zk = z + (size_t)k * stride;
    for (int w = 0; w < width; w++) zk[w] = 0;
    convolve(zk, WEIGHT_ONE, 1, k, k, stride, width, b, z);
    for (int w = 0; w < width; w++) zk[w] = (ak[w] - zk[w]) / b[w];
}

/* dz_k = (da_k - sum_{j=0}^{k} z_j db_{k-j} - sum_{j=1}^{k} b_j dz_{k-j}) / b_0. */
void jet_div_tangent(const jet_tangent *x, int k)
{
    const double *da = x->da + (size_t)k * x->dstride;
    double *dz = x->dz + (size_t)k * x->dstride;
    for (int w = 0; w < x->lanes; w++) dz[w] = da[w];
    broadcast(dz, -1, WEIGHT_ONE, 0, k, k, x->stride, x->z, x->dstride, x->db, x->lanes);
    broadcast(dz, -1, WEIGHT_ONE, 1, k, k, x->stride, x->b, x->dstride, x->dz, x->lanes);
    for (int w = 0; w < x->lanes; w++) dz[w] /= x->b[0];
}

/* dz/da = 1 / b,  dz/db = -z / b. */
jet jet_div_pull(struct jet_node *z, jet zbar, int which)
{
    const jet quotient = jet_div(zbar, jet_of_node(z->b));
    return which == 0 ? quotient : jet_neg(jet_mul(quotient, jet_of_node(z)));
}
