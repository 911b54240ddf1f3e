/* Functions whose derivative is another series times that of the argument, z' = s w a' with s = 1 or -1: exponential,
 * trigonometric and hyperbolic functions. The partner w is computed beside z and read at lower orders only. */
#include "convolve.h"
#include "rule.h"

#include <math.h>

/* k z_k = s sum_{j=1}^{k} j a_j w_{k-j}.   O(N^2). */
static void growth_series(double s, int k, size_t stride, int width, const double *a, const double *w, double *z)
{
    double *zk = z + (size_t)k * stride;
    for (int i = 0; i < width; i++) zk[i] = 0;
    convolve(zk, WEIGHT_J, 1, k, k, stride, width, a, w);
    for (int i = 0; i < width; i++) zk[i] *= s / k;
}

/* k dz_k = s sum_{j=1}^{k} j (a_j dw_{k-j} + w_{k-j} da_j);   dz_0 = s w_0 da_0. */
static void growth_tangent(double s, const jet_tangent *x, int k)
{
    double *dz = x->dz + (size_t)k * x->dstride;
    if (k == 0) {
        for (int i = 0; i < x->lanes; i++) dz[i] = s * x->b[0] * x->da[i];
        return;
    }
    for (int i = 0; i < x->lanes; i++) dz[i] = 0;
    broadcast(dz, s / k, WEIGHT_J, 1, k, k, x->stride, x->a, x->dstride, x->db, x->lanes);
    broadcast(dz, s / k, (jet_weight){-1, k}, 0, k - 1, k, x->stride, x->b, x->dstride, x->da, x->lanes);
}

/* The rules of z = function(a) with sign s; the functions exist everywhere. */
#define GROWTH_RULES(name, function, s)                                                                                \
    bool jet_##name##_value(double c, int width, const double *a, const double *b, double *z)                          \
    {                                                                                                                  \
        (void)c, (void)b;                                                                                              \
        for (int i = 0; i < width; i++) z[i] = function(a[i]);                                                         \
        return true;                                                                                                   \
    }                                                                                                                  \
    void jet_##name##_series(double c, int k, size_t stride, int width, const double *a, const double *b, double *z)   \
    {                                                                                                                  \
        (void)c;                                                                                                       \
        growth_series(s, k, stride, width, a, b, z);                                                                   \
    }                                                                                                                  \
    void jet_##name##_tangent(const jet_tangent *x, int k) { growth_tangent(s, x, k); }                                \
    jet jet_##name##_pull(struct jet_node *z, jet zbar, int which)                                                     \
    {                                                                                                                  \
        (void)which;                                                                                                   \
        return jet_mul(s, jet_mul(zbar, jet_of_node(z->b)));                                                           \
    }

GROWTH_RULES(exp, exp, 1)   /* w = z      */
GROWTH_RULES(sin, sin, 1)   /* w = cos a  */
GROWTH_RULES(cos, cos, -1)  /* w = sin a  */
GROWTH_RULES(sinh, sinh, 1) /* w = cosh a */
GROWTH_RULES(cosh, cosh, 1) /* w = sinh a */
GROWTH_RULES(tan, tan, 1)   /* w = 1 + z^2 */
GROWTH_RULES(tanh, tanh, 1) /* w = sech2 a */

/* ---- z = sech^2 a = 1 - w^2 with w = tanh a: the value without the cancellation, the series with w --------------- */

bool jet_sech2_value(double c, int width, const double *a, const double *b, double *z)
{
    (void)c, (void)b;
    for (int i = 0; i < width; i++) {
        const double cosine = cosh(a[i]);
        z[i] = 1 / (cosine * cosine);
    }
    return true;
}

/* z_k = -(w^2)_k,  k >= 1. */
void jet_sech2_series(double c, int k, size_t stride, int width, const double *a, const double *b, double *z)
{
    (void)a;
    double *zk = z + (size_t)k * stride;
    jet_sqr_series(c, k, stride, width, b, NULL, z);
    for (int i = 0; i < width; i++) zk[i] = -zk[i];
}

/* dz_k = -2 sum_{j=0}^{k} w_j dw_{k-j}. */
void jet_sech2_tangent(const jet_tangent *x, int k)
{
    double *dz = x->dz + (size_t)k * x->dstride;
    for (int i = 0; i < x->lanes; i++) dz[i] = 0;
    broadcast(dz, -2, WEIGHT_ONE, 0, k, k, x->stride, x->b, x->dstride, x->db, x->lanes);
}

/* dz/da = -2 w z. */
jet jet_sech2_pull(struct jet_node *z, jet zbar, int which)
{
    (void)which;
    return jet_mul(-2, jet_mul(zbar, jet_mul(jet_of_node(z->b), jet_of_node(z))));
}
