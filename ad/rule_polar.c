/* rule_polar.c - Defines the rules of polar coordinates, z = sqrt(a^2 + b^2) and z = atan2(a, b) (docs/jets.md,
 * section 4). Neither function exists at a = b = 0. */
#include "rule.h"

#include <math.h>

static bool is_any_at_origin(int width, const double *a, const double *b)
{
    int at_origin = 0;
    for (int i = 0; i < width; i++) at_origin |= a[i] == 0 && b[i] == 0;
    return at_origin;
}

/* ---- z = sqrt(a^2 + b^2), whose value neither overflows nor underflows ------------------------------------------- */

static bool evaluate_hypot(double unused_exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)unused_exponent;
    for (int i = 0; i < width; i++) z[i] = hypot(a[i], b[i]);
    return !is_any_at_origin(width, a, b);
}

/* The series rule computes z_k:
 * z^2 = a^2 + b^2  =>  z_0 z_k = a_0 a_k + b_0 b_k + (1/2) sum_{j=1}^{k-1} (a_j a_{k-j} + b_j b_{k-j} - z_j z_{k-j}).
 * O(N^2). All rules divide a factor of each product by z_0 first, since products of two coefficients may overflow. */
#define HYPOT_SERIES(V, S)                                                                                             \
    {                                                                                                                  \
        const V inverse = ((V){0} + 1) / S(V, z, 0);                                                                   \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k - 1,                                                                                      \
                (inverse * S(V, a, j)) * S(V, a, k - j) + (inverse * S(V, b, j)) * S(V, b, k - j) -                    \
                    (inverse * S(V, z, j)) * S(V, z, k - j));                                                          \
        JET_AT(V, z, k) = (inverse * S(V, a, 0)) * S(V, a, k) + (inverse * S(V, b, 0)) * S(V, b, k) + 0.5 * sum;       \
    }

/* The tangent rule computes dz_k:
 * z_0 dz_k = sum_{j=0}^{k} (a_j da_{k-j} + b_j db_{k-j}) - sum_{j=1}^{k} z_j dz_{k-j}. */
#define HYPOT_TANGENT(V, S)                                                                                            \
    {                                                                                                                  \
        const V inverse = ((V){0} + 1) / S(V, z, 0);                                                                   \
        V sum = (inverse * S(V, a, 0)) * JET_D_OF(V, da, k) + (inverse * S(V, b, 0)) * JET_D_OF(V, db, k);             \
        JET_SUM(V, sum, 1, k,                                                                                          \
                (inverse * S(V, a, j)) * JET_D_OF(V, da, k - j) + (inverse * S(V, b, j)) * JET_D_OF(V, db, k - j) -    \
                    (inverse * S(V, z, j)) * JET_D_OF(V, dz, k - j));                                                  \
        JET_D_AT(V, dz, k) = sum;                                                                                      \
    }

/* The adjoint rule updates the adjoints:
 * With u = zbar_k:  abar_{k-j} += u a_j / z_0,  bbar_{k-j} += u b_j / z_0 (j = 0..k),  zbar_{k-j} -= u z_j / z_0 (j =
 * 1..k). */
#define HYPOT_ADJOINT(V, S)                                                                                            \
    {                                                                                                                  \
        const V inverse = ((V){0} + 1) / S(V, z, 0), u = S(V, zbar, k);                                                \
        JET_EACH(0, k, JET_AT(V, abar, k - j) += u * (inverse * S(V, a, j)));                                          \
        JET_EACH(0, k, JET_AT(V, bbar, k - j) += u * (inverse * S(V, b, j)));                                          \
        JET_EACH(1, k, JET_AT(V, zbar, k - j) -= u * (inverse * S(V, z, j)));                                          \
    }

JET_FRAMES(hypot, HYPOT)

/* The derivatives are dz/da = a / z and dz/db = b / z. */
static jet record_hypot_pullback(struct jet_node *z, jet zbar, int operand_index)
{
    return jet_mul(zbar, jet_div(jet_from_node(operand_index == 0 ? z->a : z->b), jet_from_node(z)));
}

JET_RULE(hypot, 2, W_NONE)

/* ---- z = (a^2 + b^2) / r_0, the auxiliary series of atan2 -------------------------------------------------------- */

/* The constant divisor r_0 = sqrt(a_0^2 + b_0^2) is the value of z, and keeps its coefficients from overflow. It drops
 * out of atan2, so that tangents and adjoints do not differentiate it. */
static bool evaluate_radius(double unused_exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)unused_exponent;
    for (int i = 0; i < width; i++) z[i] = hypot(a[i], b[i]);
    return true;
}

/* The series rule computes z_k:
 * r_0 z_k = sum_{j=0}^{k} (a_j a_{k-j} + b_j b_{k-j}).   O(N^2). */
#define RADIUS_SERIES(V, S)                                                                                            \
    {                                                                                                                  \
        const V inverse = ((V){0} + 1) / S(V, z, 0);                                                                   \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 0, k, (inverse * S(V, a, j)) * S(V, a, k - j) + (inverse * S(V, b, j)) * S(V, b, k - j));      \
        JET_AT(V, z, k) = sum;                                                                                         \
    }

/* The tangent rule computes dz_k:
 * r_0 dz_k = 2 sum_{j=0}^{k} (a_j da_{k-j} + b_j db_{k-j}). */
#define RADIUS_TANGENT(V, S)                                                                                           \
    {                                                                                                                  \
        const V twice = ((V){0} + 2) / S(V, z, 0);                                                                     \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 0, k,                                                                                          \
                (twice * S(V, a, j)) * JET_D_OF(V, da, k - j) + (twice * S(V, b, j)) * JET_D_OF(V, db, k - j));        \
        JET_D_AT(V, dz, k) = sum;                                                                                      \
    }

/* The adjoint rule updates the adjoints:
 * With u = 2 zbar_k:  abar_{k-j} += u a_j / r_0,  bbar_{k-j} += u b_j / r_0 (j = 0..k). */
#define RADIUS_ADJOINT(V, S)                                                                                           \
    {                                                                                                                  \
        const V twice = ((V){0} + 2) / S(V, z, 0), u = S(V, zbar, k);                                                  \
        JET_EACH(0, k, JET_AT(V, abar, k - j) += u * (twice * S(V, a, j)));                                            \
        JET_EACH(0, k, JET_AT(V, bbar, k - j) += u * (twice * S(V, b, j)));                                            \
    }

JET_FRAMES(radius, RADIUS)

/* No value depends on this series. */
static jet record_radius_pullback(struct jet_node *z, jet zbar, int operand_index)
{
    (void)z, (void)operand_index;
    return zbar;
}

JET_RULE(radius, 2, W_NONE)

/* ---- z = atan2(a, b), w = (a^2 + b^2) / r_0 ---------------------------------------------------------------------- */

static bool evaluate_atan2(double unused_exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)unused_exponent;
    for (int i = 0; i < width; i++) z[i] = atan2(a[i], b[i]);
    return !is_any_at_origin(width, a, b);
}

/* The series rule computes z_k. The divisor r_0 = w_0 of w divides a, too:
 * (a^2 + b^2) z' = b a' - a b', whose sum_j j (a_j b_{k-j} - b_j a_{k-j}) is sum_j (2j - k) a_j b_{k-j}:
 * k w_0 z_k = sum_{j=0}^{k} (2j - k) (a_j / r_0) b_{k-j} - sum_{j=1}^{k-1} j z_j w_{k-j}.   O(N^2). */
#define ATAN2_SERIES(V, S)                                                                                             \
    {                                                                                                                  \
        const V inverse = ((V){0} + 1) / S(V, w, 0);                                                                   \
        V sum = ((double)-k * inverse * S(V, a, 0)) * S(V, b, k);                                                      \
        JET_SUM(V, sum, 1, k, ((double)(2 * j - k) * inverse * S(V, a, j)) * S(V, b, k - j));                          \
        JET_SUM(V, sum, 1, k - 1, (double)-j * S(V, z, j) * S(V, w, k - j));                                           \
        JET_AT(V, z, k) = sum / ((double)k * S(V, w, 0));                                                              \
    }

/* The tangent rule computes dz_k:
 * k w_0 dz_k = sum_{j=0}^{k} (2j - k) (b_{k-j} da_j - a_{k-j} db_j) / r_0 - sum_{j=1}^{k} j z_j dw_{k-j}
 *            - sum_{j=1}^{k-1} j w_{k-j} dz_j;   w_0 dz_0 = (b_0 da_0 - a_0 db_0) / r_0. */
#define ATAN2_TANGENT(V, S)                                                                                            \
    {                                                                                                                  \
        const double order = k > 0 ? k : 1, first = k > 0 ? -k : 1;                                                    \
        const V inverse = ((V){0} + 1) / S(V, w, 0);                                                                   \
        V sum = first * ((inverse * S(V, b, k)) * JET_D_OF(V, da, 0) - (inverse * S(V, a, k)) * JET_D_OF(V, db, 0));   \
        JET_SUM(V, sum, 1, k,                                                                                          \
                (double)(2 * j - k) * ((inverse * S(V, b, k - j)) * JET_D_OF(V, da, j) -                               \
                                       (inverse * S(V, a, k - j)) * JET_D_OF(V, db, j)));                              \
        JET_SUM(V, sum, 1, k, (double)-j *S(V, z, j) * JET_D_OF(V, dw, k - j));                                        \
        JET_SUM(V, sum, 1, k - 1, (double)-j * S(V, w, k - j) * JET_D_OF(V, dz, j));                                   \
        JET_D_AT(V, dz, k) = sum / (order * S(V, w, 0));                                                               \
    }

/* The adjoint rule updates the adjoints:
 * With u = zbar_k / (k w_0):  abar_j += u (2j - k) b_{k-j} / r_0,  bbar_j -= u (2j - k) a_{k-j} / r_0 (j = 0..k),
 * wbar_{k-j} -= u j z_j (j = 1..k),  zbar_j -= u j w_{k-j} (j = 1..k-1).
 * At k = 0, with u = zbar_0 / w_0:  abar_0 += u b_0 / r_0,  bbar_0 -= u a_0 / r_0. */
#define ATAN2_ADJOINT(V, S)                                                                                            \
    {                                                                                                                  \
        const double order = k > 0 ? k : 1, first = k > 0 ? -k : 1;                                                    \
        const V inverse = ((V){0} + 1) / S(V, w, 0), u = S(V, zbar, k) / (order * S(V, w, 0));                         \
        JET_AT(V, abar, 0) += first * u * (inverse * S(V, b, k));                                                      \
        JET_AT(V, bbar, 0) -= first * u * (inverse * S(V, a, k));                                                      \
        JET_EACH(1, k, JET_AT(V, abar, j) += (double)(2 * j - k) * u * (inverse * S(V, b, k - j)));                    \
        JET_EACH(1, k, JET_AT(V, bbar, j) -= (double)(2 * j - k) * u * (inverse * S(V, a, k - j)));                    \
        JET_EACH(1, k, JET_AT(V, wbar, k - j) -= (double)j * u * S(V, z, j));                                          \
        JET_EACH(1, k - 1, JET_AT(V, zbar, j) -= (double)j * u * S(V, w, k - j));                                      \
    }

JET_FRAMES(atan2, ATAN2)

/* The derivatives are dz/da = (b / r) / r and dz/db = -(a / r) / r with r = sqrt(a^2 + b^2), whose square may overflow.
 */
static jet record_atan2_pullback(struct jet_node *z, jet zbar, int operand_index)
{
    const jet a = jet_from_node(z->a), b = jet_from_node(z->b), r = jet_hypot(a, b), quotient = jet_div(zbar, r);
    return operand_index == 0 ? jet_mul(quotient, jet_div(b, r)) : jet_neg(jet_mul(quotient, jet_div(a, r)));
}

JET_RULE(atan2, 2, W_LOWER)
