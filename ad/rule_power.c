/* rule_power.c - Defines the rules of the square root and of powers with a constant exponent (docs/jets.md, section
 * 4). */
#include "elementary.h"
#include "rule.h"

#include <math.h>
#include <stdlib.h>

/* ---- z = sqrt a,  a_0 > 0 ---------------------------------------------------------------------------------------- */

static bool evaluate_sqrt(double unused_exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)unused_exponent, (void)b;
    int outside = 0;
    for (int w = 0; w < width; w++) {
        outside |= a[w] <= 0;
        z[w] = sqrt(a[w]);
    }
    return !outside;
}

/* The series rule computes z_k:
 * a = z^2  =>  z_k = (a_k - sum_{j=1}^{k-1} z_j z_{k-j}) / (2 z_0).   O(N^2). */
#define SQRT_SERIES(V, S)                                                                                              \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k - 1, S(V, z, j) * S(V, z, k - j));                                                        \
        JET_AT(V, z, k) = (S(V, a, k) - sum) / (2.0 * S(V, z, 0));                                                     \
    }

/* The tangent rule computes dz_k:
 * dz_k = (da_k - 2 sum_{j=1}^{k} z_j dz_{k-j}) / (2 z_0). */
#define SQRT_TANGENT(V, S)                                                                                             \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k, S(V, z, j) * JET_D_OF(V, dz, k - j));                                                    \
        JET_D_AT(V, dz, k) = (JET_D_OF(V, da, k) - 2.0 * sum) / (2.0 * S(V, z, 0));                                    \
    }

/* The adjoint rule updates the adjoints:
 * s_k = (zbar_k - 2 sum_{j=k+1}^{top} s_j z_{j-k}) / (2 z_0) is stored in the place of zbar_k;  abar_k += s_k. */
#define SQRT_ADJOINT(V, S)                                                                                             \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        for (int j = top; j > k; j--) sum += S(V, zbar, j) * S(V, z, j - k);                                           \
        const V s = (S(V, zbar, k) - 2.0 * sum) / (2.0 * S(V, z, 0));                                                  \
        JET_AT(V, zbar, k) = s;                                                                                        \
        JET_AT(V, abar, k) += s;                                                                                       \
    }

JET_FRAMES(sqrt, SQRT)

/* The derivative is dz/da = 1 / (2 z). */
static jet record_sqrt_pullback(struct jet_node *z, jet zbar, int operand_index)
{
    (void)operand_index;
    return jet_div(jet_mul(0.5, zbar), jet_from_node(z));
}

JET_RULE(sqrt, 1, W_NONE)

/* ---- z = a^c,  a_0 != 0 where c is an integer, else a_0 > 0 ------------------------------------------------------ */

/* Computes z = a^(exponent_in_quarters / 4) by multiplications and square roots, which are faster than pow. */
static void compute_quarter_multiple_power(int exponent_in_quarters, int width, const double *a, double *restrict z)
{
    const int count = abs(exponent_in_quarters), rest = count % 4;
    JET_IN_VECTORS
    for (int w = 0; w < width; w++) {
        const double root = rest ? sqrt(a[w]) : 1;
        z[w] = rest % 2 == 0 ? root : rest == 1 ? sqrt(root) : root * sqrt(root);
    }
    for (int i = 0; i < count / 4; i++) {
        JET_IN_VECTORS
        for (int w = 0; w < width; w++) z[w] *= a[w];
    }
    if (exponent_in_quarters < 0) {
        JET_IN_VECTORS
        for (int w = 0; w < width; w++) z[w] = 1 / z[w];
    }
}

static bool are_all_positive(int width, const double *a)
{
    int outside = 0;
    JET_IN_VECTORS
    for (int w = 0; w < width; w++) outside |= a[w] <= 0;
    return !outside;
}

static bool are_all_nonzero(int width, const double *a)
{
    int outside = 0;
    JET_IN_VECTORS
    for (int w = 0; w < width; w++) outside |= a[w] == 0;
    return !outside;
}

/* Computes z = a^(-minus_exponent_in_halves / 2) for an odd number that the compiler knows, as the potential of gravity
 * and its derivatives need it. Returns whether all numbers a are positive. */
JET_INLINE bool compute_inverse_half_power(int minus_exponent_in_halves, int width, const double *a, double *restrict z)
{
    JET_IN_VECTORS
    for (int w = 0; w < width; w++) {
        double power = sqrt(a[w]);
        for (int i = 1; i < minus_exponent_in_halves; i += 2) power *= a[w];
        z[w] = 1 / power;
    }
    return are_all_positive(width, a);
}

JET_INLINE bool compute_general_power(double exponent, int width, const double *a, double *restrict z)
{
    if (fabs(4 * exponent) <= 4 * TAPE_POWER_MAX_EXPONENT && 4 * exponent == floor(4 * exponent))
        compute_quarter_multiple_power((int)(4 * exponent), width, a, z);
    else jet_array_pow(exponent, width, a, z);
    return exponent == floor(exponent) ? are_all_nonzero(width, a) : are_all_positive(width, a);
}

/* Computes z = a^exponent for an exponent that the compiler does not know. The function is not inlined, so that its
 * caller need not save registers for a call of pow. */
JET_APART bool compute_power_out_of_line(double exponent, int width, const double *a, double *restrict z)
{
    return compute_general_power(exponent, width, a, z);
}

static bool evaluate_pow(double exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)b;
    return exponent == -0.5      ? compute_inverse_half_power(1, width, a, z)
           : exponent == -1.5    ? compute_inverse_half_power(3, width, a, z)
           : exponent == -2.5    ? compute_inverse_half_power(5, width, a, z)
           : exponent == -3.5    ? compute_inverse_half_power(7, width, a, z)
           : JET_KNOWS(exponent) ? compute_general_power(exponent, width, a, z)
                                 : compute_power_out_of_line(exponent, width, a, z);
}

/* The series rule computes z_k:
 * a z' = c a' z  =>  z_k = 1/(k a_0) sum_{j=1}^{k} (c j - (k-j)) a_j z_{k-j}.   O(N^2).
 * The term of a_k is added last, since a_k is computed last; few operations then wait for it. */
#define POW_SERIES(V, S)                                                                                               \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        const V inverse = 1 / ((double)k * S(V, a, 0)), last = c * k * S(V, z, 0);                                     \
        JET_SUM(V, sum, 1, k - 1, ((c + 1) * (k - j) - k) * S(V, a, k - j) * S(V, z, j));                              \
        JET_AT(V, z, k) = (sum + last * S(V, a, k)) * inverse;                                                         \
    }

/* The tangent rule computes dz_k:
 * k a_0 dz_k = sum_{j=1}^{k} (c j - (k-j)) (a_j dz_{k-j} + z_{k-j} da_j) - k z_k da_0;   dz_0 = c z_0 / a_0 da_0. */
#define POW_TANGENT(V, S)                                                                                              \
    {                                                                                                                  \
        const double order = k > 0 ? k : 1;                                                                            \
        V sum = (k > 0 ? -k : c) * S(V, z, k) * JET_D_OF(V, da, 0);                                                    \
        JET_SUM(V, sum, 1, k,                                                                                          \
                ((c + 1) * j - k) * (S(V, a, j) * JET_D_OF(V, dz, k - j) + S(V, z, k - j) * JET_D_OF(V, da, j)));      \
        JET_D_AT(V, dz, k) = sum * (1 / (order * S(V, a, 0)));                                                         \
    }

/* The adjoint rule updates the adjoints:
 * s_k = (zbar_k + sum_{j=k+1}^{top} (c (j-k) - k) s_j a_{j-k}) / (k a_0) is stored in the place of zbar_k.
 * abar_k += sum_{j=k}^{top} (c k - (j-k)) s_j z_{j-k}.   For k = 0 the divisor is a_0, and the factor of s_0 z_0 is c.
 * The numbers that are computed last, zbar_k and s_k, enter few operations. */
#define POW_ADJOINT(V, S)                                                                                              \
    {                                                                                                                  \
        const V inverse = 1.0 / ((k > 0 ? (double)k : 1.0) * S(V, a, 0));                                              \
        V of_z = {0}, of_a = {0};                                                                                      \
        for (int j = top; j > k; j--) {                                                                                \
            of_z += ((c + 1) * (j - k) - j) * S(V, zbar, j) * S(V, a, j - k);                                          \
            of_a += ((c + 1) * k - j) * S(V, zbar, j) * S(V, z, j - k);                                                \
        }                                                                                                              \
        const V s = (S(V, zbar, k) + of_z) * inverse;                                                                  \
        JET_AT(V, zbar, k) = s;                                                                                        \
        JET_AT(V, abar, k) += of_a + c * (k > 0 ? k : 1) * s * S(V, z, 0);                                             \
    }

JET_FRAMES(pow, POW)

/* The derivative is dz/da = c a^(c-1). */
static jet record_pow_pullback(struct jet_node *z, jet zbar, int operand_index)
{
    (void)operand_index;
    return jet_mul(z->number, jet_mul(zbar, jet_pow(jet_from_node(z->a), z->number - 1)));
}

JET_RULE(pow, 1, W_NONE)
