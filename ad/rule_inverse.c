/* Functions whose derivative divides by another series, z' = s a' / w with s = 1 or -1: the logarithm and the inverse
 * trigonometric functions. The partner w is read at lower orders only. */
#include "convolve.h"
#include "rule.h"

#include <math.h>

/* w z' = s a'  =>  w_0 z_k = s a_k - (1/k) sum_{j=1}^{k-1} j z_j w_{k-j}.   O(N^2). */
static void inverse_series(double s, int k, size_t stride, int width, const double *a, const double *w, double *z)
{
    const double *ak = a + (size_t)k * stride;
    double *zk = z + (size_t)k * stride;
    for (int i = 0; i < width; i++) zk[i] = 0;
    convolve(zk, WEIGHT_J, 1, k - 1, k, stride, width, z, w);
    for (int i = 0; i < width; i++) zk[i] = (s * ak[i] - zk[i] / k) / w[i];
}

/* w_0 dz_k = s da_k - z_k dw_0 - (1/k) sum_{j=1}^{k-1} j (z_j dw_{k-j} + w_{k-j} dz_j);   w_0 dz_0 = s da_0. */
static void inverse_tangent(double s, const jet_tangent *x, int k)
{
    const double *da = x->da + (size_t)k * x->dstride;
    double *dz = x->dz + (size_t)k * x->dstride;
    for (int i = 0; i < x->lanes; i++) dz[i] = s * da[i];
    if (k > 0) {
        broadcast(dz, -1, WEIGHT_ONE, k, k, k, x->stride, x->z, x->dstride, x->db, x->lanes);
        broadcast(dz, -1.0 / k, WEIGHT_J, 1, k - 1, k, x->stride, x->z, x->dstride, x->db, x->lanes);
        broadcast(dz, -1.0 / k, (jet_weight){-1, k}, 1, k - 1, k, x->stride, x->b, x->dstride, x->dz, x->lanes);
    }
    for (int i = 0; i < x->lanes; i++) dz[i] /= x->b[0];
}

/* The rules of z = function(a) with sign s, which does not exist where outside(a). */
#define INVERSE_RULES(name, function, s, outside)                                                                      \
    bool jet_##name##_value(double c, int width, const double *a, const double *b, double *z)                          \
    {                                                                                                                  \
        (void)c, (void)b;                                                                                              \
        int bad = 0;                                                                                                   \
        for (int i = 0; i < width; i++) {                                                                              \
            bad |= outside(a[i]);                                                                                      \
            z[i] = function(a[i]);                                                                                     \
        }                                                                                                              \
        return !bad;                                                                                                   \
    }                                                                                                                  \
    void jet_##name##_series(double c, int k, size_t stride, int width, const double *a, const double *b, double *z)   \
    {                                                                                                                  \
        (void)c;                                                                                                       \
        inverse_series(s, k, stride, width, a, b, z);                                                                  \
    }                                                                                                                  \
    void jet_##name##_tangent(const jet_tangent *x, int k) { inverse_tangent(s, x, k); }                               \
    jet jet_##name##_pull(struct jet_node *z, jet zbar, int which)                                                     \
    {                                                                                                                  \
        (void)which;                                                                                                   \
        return jet_mul(s, jet_div(zbar, jet_of_node(z->b)));                                                           \
    }

#define NOT_POSITIVE(a) ((a) <= 0)
#define BEYOND_ONE(a)   ((a) <= -1 || (a) >= 1)
#define NOWHERE(a)      ((void)(a), 0)

INVERSE_RULES(log, log, 1, NOT_POSITIVE) /* w = a                */
INVERSE_RULES(asin, asin, 1, BEYOND_ONE) /* w = sqrt((1-a)(1+a)) */
INVERSE_RULES(acos, acos, -1, BEYOND_ONE)
INVERSE_RULES(atan, atan, 1, NOWHERE) /* w = 1 + a^2          */
