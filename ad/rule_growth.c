/* Functions whose derivative is another series times that of the argument, z' = s b a' with s = 1 or -1: exponential,
 * trigonometric and hyperbolic functions. The partner b is computed beside z and read at lower orders only. */
#include "rule.h"

#include <math.h>

/* k z_k = s sum_{j=1}^{k} j a_j b_{k-j}.   O(N^2). */
#define GROWTH_SERIES(V, S, s)                                                                                         \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k, (double)j *S(V, a, j) * S(V, b, k - j));                                                 \
        JET_AT(V, z, k) = sum * ((s) / (double)k);                                                                     \
    }

/* k dz_k = s sum_{j=1}^{k} j (a_j db_{k-j} + b_{k-j} da_j);   dz_0 = s b_0 da_0. */
#define GROWTH_TANGENT(V, S, s)                                                                                        \
    {                                                                                                                  \
        V sum = (k == 0 ? 1.0 : 0.0) * S(V, b, 0) * JET_D_OF(V, da, 0);                                                \
        JET_SUM(V, sum, 1, k, (double)j *(S(V, a, j) * JET_D_OF(V, db, k - j) + S(V, b, k - j) * JET_D_OF(V, da, j))); \
        JET_D_AT(V, dz, k) = sum * ((s) / (k > 0 ? (double)k : 1.0));                                                  \
    }

/* With t = s zbar_k / k:  abar_j += t j b_{k-j},  bbar_{k-j} += t j a_j  (j = 1..k);   abar_0 += s zbar_0 b_0. */
#define GROWTH_ADJOINT(V, S, s)                                                                                        \
    {                                                                                                                  \
        const V t = S(V, zbar, k) * ((s) / (k > 0 ? (double)k : 1.0));                                                 \
        if (k == 0) JET_AT(V, abar, 0) += t * S(V, b, 0);                                                              \
        JET_EACH(1, k, JET_AT(V, abar, j) += (double)j * t * S(V, b, k - j));                                          \
        JET_EACH(1, k, JET_AT(V, bbar, k - j) += (double)j * t * S(V, a, j));                                          \
    }

#define PLUS_SERIES(V, S)   GROWTH_SERIES(V, S, 1.0)
#define PLUS_TANGENT(V, S)  GROWTH_TANGENT(V, S, 1)
#define PLUS_ADJOINT(V, S)  GROWTH_ADJOINT(V, S, 1)
#define MINUS_SERIES(V, S)  GROWTH_SERIES(V, S, -1.0)
#define MINUS_TANGENT(V, S) GROWTH_TANGENT(V, S, -1)
#define MINUS_ADJOINT(V, S) GROWTH_ADJOINT(V, S, -1)

/* The rules of z = function(a) with the sign's bodies; the functions exist everywhere. */
#define GROWTH_RULES(name, function, SIGN, s)                                                                          \
    static bool name##_value(double c, int width, const double *a, const double *b, double *restrict z)                \
    {                                                                                                                  \
        (void)c, (void)b;                                                                                              \
        for (int i = 0; i < width; i++) z[i] = function(a[i]);                                                         \
        return true;                                                                                                   \
    }                                                                                                                  \
    JET_FRAMES(name, SIGN)                                                                                             \
    static jet name##_pull(struct jet_node *z, jet zbar, int which)                                                    \
    {                                                                                                                  \
        (void)which;                                                                                                   \
        return jet_mul(s, jet_mul(zbar, jet_of_node(z->b)));                                                           \
    }                                                                                                                  \
    JET_RULE(name, B_PARTNER)

GROWTH_RULES(exp, exp, PLUS, 1)   /* b = z       */
GROWTH_RULES(sin, sin, PLUS, 1)   /* b = cos a   */
GROWTH_RULES(cos, cos, MINUS, -1) /* b = sin a   */
GROWTH_RULES(sinh, sinh, PLUS, 1) /* b = cosh a  */
GROWTH_RULES(cosh, cosh, PLUS, 1) /* b = sinh a  */
GROWTH_RULES(tan, tan, PLUS, 1)   /* b = 1 + z^2 */
GROWTH_RULES(tanh, tanh, PLUS, 1) /* b = sech2 a */

/* ---- z = sech^2 a = 1 - b^2 with b = tanh a: the value without the cancellation, the series with b --------------- */

static bool sech2_value(double c, int width, const double *a, const double *b, double *restrict z)
{
    (void)c, (void)b;
    for (int i = 0; i < width; i++) {
        const double cosine = cosh(a[i]);
        z[i] = 1 / (cosine * cosine);
    }
    return true;
}

/* z_k = -(b^2)_k,  k >= 1. */
#define SECH2_SERIES(V, S)                                                                                             \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 0, k, S(V, b, j) * S(V, b, k - j));                                                            \
        JET_AT(V, z, k) = -sum;                                                                                        \
    }

/* dz_k = -2 sum_{j=0}^{k} b_j db_{k-j}. */
#define SECH2_TANGENT(V, S)                                                                                            \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 0, k, S(V, b, j) * JET_D_OF(V, db, k - j));                                                    \
        JET_D_AT(V, dz, k) = -2.0 * sum;                                                                               \
    }

/* bbar_j -= 2 zbar_k b_{k-j},  j = 0..k. */
#define SECH2_ADJOINT(V, S)                                                                                            \
    {                                                                                                                  \
        const V bar = -2.0 * S(V, zbar, k);                                                                            \
        JET_EACH(0, k, JET_AT(V, bbar, j) += bar * S(V, b, k - j));                                                    \
    }

JET_FRAMES(sech2, SECH2)

/* dz/da = -2 b z. */
static jet sech2_pull(struct jet_node *z, jet zbar, int which)
{
    (void)which;
    return jet_mul(-2, jet_mul(zbar, jet_mul(jet_of_node(z->b), jet_of_node(z))));
}

JET_RULE(sech2, B_PARTNER_SERIES)
