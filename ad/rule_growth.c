/* rule_growth.c - Defines the rules of functions z of one operand a with z' = s w a', s = 1 or -1: exponential,
 * trigonometric and hyperbolic functions, and the error function (docs/jets.md, section 4). The series w, called the
 * auxiliary series of z, is recorded with z, and read at lower orders only. */
#include "elementary.h"
#include "rule.h"

#include <math.h>

/* The series rule computes z_k:
 * k z_k = s sum_{j=1}^{k} j a_j w_{k-j}.   O(N^2). */
#define GROWTH_SERIES(V, S, s)                                                                                         \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k, (double)j *S(V, a, j) * S(V, w, k - j));                                                 \
        JET_AT(V, z, k) = sum * ((s) / (double)k);                                                                     \
    }

/* The tangent rule computes dz_k:
 * k dz_k = s sum_{j=1}^{k} j (a_j dw_{k-j} + w_{k-j} da_j);   dz_0 = s w_0 da_0. */
#define GROWTH_TANGENT(V, S, s)                                                                                        \
    {                                                                                                                  \
        V sum = (k == 0 ? 1.0 : 0.0) * S(V, w, 0) * JET_D_OF(V, da, 0);                                                \
        JET_SUM(V, sum, 1, k, (double)j *(S(V, a, j) * JET_D_OF(V, dw, k - j) + S(V, w, k - j) * JET_D_OF(V, da, j))); \
        JET_D_AT(V, dz, k) = sum * ((s) / (k > 0 ? (double)k : 1.0));                                                  \
    }

/* The adjoint rule updates the adjoints:
 * With t = s zbar_k / k:  abar_j += t j w_{k-j},  wbar_{k-j} += t j a_j  (j = 1..k);   abar_0 += s zbar_0 w_0. */
#define GROWTH_ADJOINT(V, S, s)                                                                                        \
    {                                                                                                                  \
        const V t = S(V, zbar, k) * ((s) / (k > 0 ? (double)k : 1.0));                                                 \
        if (k == 0) JET_AT(V, abar, 0) += t * S(V, w, 0);                                                              \
        JET_EACH(1, k, JET_AT(V, abar, j) += (double)j * t * S(V, w, k - j));                                          \
        JET_EACH(1, k, JET_AT(V, wbar, k - j) += (double)j * t * S(V, a, j));                                          \
    }

#define PLUS_SERIES(V, S)   GROWTH_SERIES(V, S, 1.0)
#define PLUS_TANGENT(V, S)  GROWTH_TANGENT(V, S, 1)
#define PLUS_ADJOINT(V, S)  GROWTH_ADJOINT(V, S, 1)
#define MINUS_SERIES(V, S)  GROWTH_SERIES(V, S, -1.0)
#define MINUS_TANGENT(V, S) GROWTH_TANGENT(V, S, -1)
#define MINUS_ADJOINT(V, S) GROWTH_ADJOINT(V, S, -1)

/* Defines the rule of z = function(a). SIGN names the bodies for s = 1 or -1. The functions exist for all numbers. */
#define GROWTH_RULES(name, function, SIGN, s)                                                                          \
    static bool evaluate_##name(double unused_exponent, int width, const double *a, const double *b,                   \
                                double *restrict z)                                                                    \
    {                                                                                                                  \
        (void)unused_exponent, (void)b;                                                                                \
        jet_array_##function(width, a, z);                                                                             \
        return true;                                                                                                   \
    }                                                                                                                  \
    JET_FRAMES(name, SIGN)                                                                                             \
    static jet record_##name##_pullback(struct jet_node *z, jet zbar, int operand_index)                               \
    {                                                                                                                  \
        (void)operand_index;                                                                                           \
        return jet_mul(s, jet_mul(zbar, jet_from_node(z->w)));                                                         \
    }                                                                                                                  \
    JET_RULE(name, 1, W_LOWER)

GROWTH_RULES(exp, exp, PLUS, 1)   /* w = z       */
GROWTH_RULES(sin, sin, PLUS, 1)   /* w = cos a   */
GROWTH_RULES(cos, cos, MINUS, -1) /* w = sin a   */
GROWTH_RULES(sinh, sinh, PLUS, 1) /* w = cosh a  */
GROWTH_RULES(cosh, cosh, PLUS, 1) /* w = sinh a  */
GROWTH_RULES(tan, tan, PLUS, 1)   /* w = 1 + z^2 */
GROWTH_RULES(tanh, tanh, PLUS, 1) /* w = sech2 a */
GROWTH_RULES(erf, erf, PLUS, 1)   /* w = 2 exp(-a^2) / sqrt(pi) */

/* ---- z = sech^2 a = 1 - w^2 with w = tanh a: the value without the cancellation, the series with w --------------- */

static bool evaluate_sech2(double unused_exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)unused_exponent, (void)b;
    jet_array_cosh(width, a, z);
    for (int i = 0; i < width; i++) z[i] = 1 / (z[i] * z[i]);
    return true;
}

/* The series rule computes z_k:
 * z_k = -(w^2)_k,  k >= 1. */
#define SECH2_SERIES(V, S)                                                                                             \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 0, k, S(V, w, j) * S(V, w, k - j));                                                            \
        JET_AT(V, z, k) = -sum;                                                                                        \
    }

/* The tangent rule computes dz_k:
 * dz_k = -2 sum_{j=0}^{k} w_j dw_{k-j}. */
#define SECH2_TANGENT(V, S)                                                                                            \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 0, k, S(V, w, j) * JET_D_OF(V, dw, k - j));                                                    \
        JET_D_AT(V, dz, k) = -2.0 * sum;                                                                               \
    }

/* The adjoint rule updates the adjoints:
 * wbar_j -= 2 zbar_k w_{k-j},  j = 0..k. */
#define SECH2_ADJOINT(V, S)                                                                                            \
    {                                                                                                                  \
        const V u = -2.0 * S(V, zbar, k);                                                                              \
        JET_EACH(0, k, JET_AT(V, wbar, j) += u * S(V, w, k - j));                                                      \
    }

JET_FRAMES(sech2, SECH2)

/* The derivative is dz/da = -2 w z. */
static jet record_sech2_pullback(struct jet_node *z, jet zbar, int operand_index)
{
    (void)operand_index;
    return jet_mul(-2, jet_mul(zbar, jet_mul(jet_from_node(z->w), jet_from_node(z))));
}

JET_RULE(sech2, 1, W_SAME)
