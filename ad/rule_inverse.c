/* rule_inverse.c - Defines the rules of functions z of one operand a with z' = s a' / w, s = 1 or -1: the logarithm and
 * the inverse trigonometric and hyperbolic functions (docs/jets.md, section 4). The series w, called the auxiliary
 * series of z, is recorded with z, and read at lower orders only. */
#include "elementary.h"
#include "rule.h"

#include <math.h>

/* The series rule computes z_k:
 * w z' = s a'  =>  w_0 z_k = s a_k - (1/k) sum_{j=1}^{k-1} j z_j w_{k-j}.   O(N^2). */
#define INVERSE_SERIES(V, S, s)                                                                                        \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k - 1, (double)j * S(V, z, j) * S(V, w, k - j));                                            \
        JET_AT(V, z, k) = (s * S(V, a, k) - sum / (double)k) / S(V, w, 0);                                             \
    }

/* The tangent rule computes dz_k:
 * w_0 dz_k = s da_k - (1/k) sum_{j=1}^{k} j z_j dw_{k-j} - (1/k) sum_{j=1}^{k-1} (k-j) w_j dz_{k-j};
 * w_0 dz_0 = s da_0. */
#define INVERSE_TANGENT(V, S, s)                                                                                       \
    {                                                                                                                  \
        const double scale = k > 0 ? 1 / (double)k : 1;                                                                \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k, (double)j *S(V, z, j) * JET_D_OF(V, dw, k - j));                                         \
        JET_SUM(V, sum, 1, k - 1, (double)(k - j) * S(V, w, j) * JET_D_OF(V, dz, k - j));                              \
        JET_D_AT(V, dz, k) = (s * JET_D_OF(V, da, k) - scale * sum) / S(V, w, 0);                                      \
    }

/* The adjoint rule updates the adjoints:
 * With u = zbar_k / w_0:  abar_k += s u,  wbar_{k-j} -= (j/k) u z_j (j = 1..k),  zbar_j -= (j/k) u w_{k-j} (j
 * = 1..k-1). */
#define INVERSE_ADJOINT(V, S, s)                                                                                       \
    {                                                                                                                  \
        const V u = S(V, zbar, k) / S(V, w, 0);                                                                        \
        JET_AT(V, abar, k) += s * u;                                                                                   \
        JET_EACH(1, k, JET_AT(V, wbar, k - j) -= (j / (double)k) * u * S(V, z, j));                                    \
        JET_EACH(1, k - 1, JET_AT(V, zbar, j) -= (j / (double)k) * u * S(V, w, k - j));                                \
    }

#define PLUS_SERIES(V, S)   INVERSE_SERIES(V, S, 1.0)
#define PLUS_TANGENT(V, S)  INVERSE_TANGENT(V, S, 1.0)
#define PLUS_ADJOINT(V, S)  INVERSE_ADJOINT(V, S, 1.0)
#define MINUS_SERIES(V, S)  INVERSE_SERIES(V, S, -1.0)
#define MINUS_TANGENT(V, S) INVERSE_TANGENT(V, S, -1.0)
#define MINUS_ADJOINT(V, S) INVERSE_ADJOINT(V, S, -1.0)

/* Defines the rule of z = function(a). SIGN names the bodies for s = 1 or -1. z does not exist if outside(a) is
 * true. */
#define INVERSE_RULES(name, function, SIGN, s, outside)                                                                \
    static bool evaluate_##name(double unused_exponent, int width, const double *a, const double *b,                   \
                                double *restrict z)                                                                    \
    {                                                                                                                  \
        (void)unused_exponent, (void)b;                                                                                \
        int bad = 0;                                                                                                   \
        for (int i = 0; i < width; i++) bad |= outside(a[i]);                                                          \
        jet_array_##function(width, a, z);                                                                             \
        return !bad;                                                                                                   \
    }                                                                                                                  \
    JET_FRAMES(name, SIGN)                                                                                             \
    static jet record_##name##_pullback(struct jet_node *z, jet zbar, int operand_index)                               \
    {                                                                                                                  \
        (void)operand_index;                                                                                           \
        return jet_mul(s, jet_div(zbar, jet_from_node(z->w)));                                                         \
    }                                                                                                                  \
    JET_RULE(name, 1, W_LOWER)

#define NOT_POSITIVE(a) ((a) <= 0)
#define BEYOND_ONE(a)   ((a) <= -1 || (a) >= 1)
#define UP_TO_ONE(a)    ((a) <= 1)
#define NOWHERE(a)      ((void)(a), 0)

INVERSE_RULES(log, log, PLUS, 1, NOT_POSITIVE) /* w = a                */
INVERSE_RULES(asin, asin, PLUS, 1, BEYOND_ONE) /* w = sqrt((1-a)(1+a)) */
INVERSE_RULES(acos, acos, MINUS, -1, BEYOND_ONE)
INVERSE_RULES(atan, atan, PLUS, 1, NOWHERE)      /* w = 1 + a^2          */
INVERSE_RULES(asinh, asinh, PLUS, 1, NOWHERE)    /* w = sqrt(1 + a^2)    */
INVERSE_RULES(acosh, acosh, PLUS, 1, UP_TO_ONE)  /* w = sqrt((a-1)(a+1)) */
INVERSE_RULES(atanh, atanh, PLUS, 1, BEYOND_ONE) /* w = (1-a)(1+a)       */
