/* rule_power.c - Defines the rules of the square root and of powers with a constant exponent (docs/jets.md, section
 * 4). */
#include "elementary.h"
#include "roots.h"
#include "rule.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* ---- z = sqrt a,  a_0 > 0 ---------------------------------------------------------------------------------------- */

static bool evaluate_sqrt(double exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)exponent, (void)b;
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
static jet record_sqrt_pullback(struct jet_node *z, jet zbar, int operand)
{
    (void)operand;
    return jet_div(jet_mul(0.5, zbar), jet_from_node(z));
}

JET_RULE(sqrt, 1, W_NONE)

/* ---- z = a^c,  a_0 != 0 where c is an integer, else a_0 > 0 ------------------------------------------------------ */

enum { QUARTERS_MAX = 32 };

/* Computes z = a^(quarters/4) by multiplications and square roots, which are faster than pow. */
static void compute_quarter_power(int quarters, int width, const double *a, double *restrict z)
{
    const int count = abs(quarters), rest = count % 4;
    for (int w = 0; w < width; w++) {
        const double root = rest ? sqrt(a[w]) : 1;
        z[w] = rest % 2 == 0 ? root : rest == 1 ? sqrt(root) : root * sqrt(root);
    }
    for (int i = 0; i < count / 4; i++)
        for (int w = 0; w < width; w++) z[w] *= a[w];
    for (int w = 0; w < width && quarters < 0; w++) z[w] = 1 / z[w];
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
    for (int w = 0; w < width; w++) outside |= a[w] == 0;
    return !outside;
}

/* The following functions compute a^(-k/2) for k = 7, 5, 3, 1, or for the last few of these k, as the potential of
 * gravity and its derivatives need them. k and the number of powers are constants for the compiler. Each power fills
 * `width` numbers of z. */
#ifdef HAS_ROOTS
typedef struct {
    roots_vector a, bounded, y, square, e;
} inverse_root_estimate;

/* Estimates the inverse square root: y is near a^(-1/2), with so few bits that y^3 is exact, and e = 1 - a y^2 is
 * the relative error of y^2, |e| < 2^-12. */
JET_INLINE inverse_root_estimate estimate_inverse_root(roots_vector a)
{
    /* min_pd returns its second operand if one of them is NaN; the result is thus NaN if a is. */
    const roots_vector bounded = OF_ROOTS(min_pd)(OF_ROOTS(set1_pd)(DBL_MAX), a);
    const roots_vector y = ROOTS_BITS(estimate_inverse_roots(bounded), ~((1LL << 36) - 1));
    const roots_vector square = y * y, e = OF_ROOTS(fnmadd_pd)(bounded, square, OF_ROOTS(set1_pd)(1));
    return (inverse_root_estimate){a, bounded, y, square, e};
}

/* Computes
 *     a^(-k/2) = y^k (1 - e)^(-k/2) = y^k (1 + k/2 e + k (k+2)/8 e^2 + k (k+2) (k+4)/48 e^3 + ...)
 * from the estimate y. The result is rounded once for k = 1 and 3; a root, a product and a quotient would round
 * three times and take twice as long. If y^2 or a is infinite, y^k is infinite or 0. For k = 1 the function then
 * divides by the square root instead, and likewise if y is not close enough. */
JET_INLINE roots_vector refine_inverse_power(int k, inverse_root_estimate root)
{
    const double c1 = k / 2.0, c2 = c1 * (k + 2) / 4, c3 = c2 * (k + 4) / 6, c4 = c3 * (k + 6) / 8;
    const roots_vector e = root.e, squared = e * e, series = (c1 + e * c2) + squared * (c3 + e * c4);
    roots_vector power = root.y;
    for (int i = 1; i < k; i += 2) power *= root.square;
    const roots_mask finite = ROOTS_WHERE(power, _CMP_NEQ_UQ, OF_ROOTS(set1_pd)(INFINITY));
    const roots_vector rounded = ROOTS_CHOOSE(finite, OF_ROOTS(fmadd_pd)(power * e, series, power), power);
    if (k > 1) return rounded;
    const roots_vector near =
        ROOTS_CHOOSE(ROOTS_WHERE(root.a, _CMP_EQ_OQ, root.bounded), squared, OF_ROOTS(set1_pd)(1));
    const roots_mask usual = ROOTS_WHERE(near, _CMP_LT_OQ, OF_ROOTS(set1_pd)(0x1p-20));
    if (ROOTS_ARE(usual) == (1 << ROOTS) - 1) return rounded;
    return ROOTS_CHOOSE(usual, rounded, 1 / OF_ROOTS(sqrt_pd)(root.a));
}

enum { INVERSE_ROOTS = 4 };
/* The type of a function that computes powers of one vector: a^(-k/2) and those that follow it. */
typedef void powers_of_block(int k, int powers, roots_vector a, roots_vector power[]);

JET_INLINE void compute_inverse_root_powers(int k, int powers, roots_vector a, roots_vector power[])
{
    const inverse_root_estimate root = estimate_inverse_root(a);
    for (int i = 0; i < powers; i++) power[i] = refine_inverse_power(k - 2 * i, root);
}

/* Computes a^(quarters/4) for 3, -1, -3 and -5 quarters, as a^i r^j a^(-1/4). Here r = a^(-1/2), and a^(-1/4) is the
 * square root of r. */
JET_INLINE void compute_odd_quarter_power(int quarters, int powers, roots_vector a, roots_vector power[])
{
    const int ups = (quarters + 3) / 4;
    const roots_vector bounded = ups > 0 ? OF_ROOTS(min_pd)(OF_ROOTS(set1_pd)(DBL_MAX), a) : a;
    const roots_vector r = refine_inverse_power(1, estimate_inverse_root(bounded));
    (void)powers;
    *power = OF_ROOTS(sqrt_pd)(r);
    for (int i = quarters; i < -1; i += 2) *power *= r;
    for (int i = 0; i < ups; i++) *power *= a;
}

JET_INLINE bool apply_in_vector_blocks(powers_of_block *of_block, int k, int powers, int width, const double *a,
                                       double *restrict z)
{
    roots_vector power[INVERSE_ROOTS];
    int outside = 0, w = 0;
    for (; w + ROOTS <= width; w += ROOTS) {
        const roots_vector block = OF_ROOTS(loadu_pd)(a + w);
        outside |= ROOTS_ARE(ROOTS_WHERE(block, _CMP_LE_OQ, OF_ROOTS(setzero_pd)()));
        of_block(k, powers, block, power);
        for (int i = 0; i < powers; i++) OF_ROOTS(storeu_pd)(z + i * width + w, power[i]);
    }
    /* A single number is stored as a number: a load of one number would have to wait for a vector's store. */
    if (w + 1 == width) {
        const roots_vector block = OF_ROOTS(set1_pd)(a[w]);
        outside |= a[w] <= 0;
        of_block(k, powers, block, power);
        for (int i = 0; i < powers; i++) z[i * width + w] = power[i][0];
    } else if (w < width) {
        const roots_mask rest = ROOTS_FIRST(width - w);
        const roots_vector block = ROOTS_CHOOSE(rest, ROOTS_LOAD(rest, a + w), OF_ROOTS(set1_pd)(1));
        outside |= ROOTS_ARE(ROOTS_WHERE(block, _CMP_LE_OQ, OF_ROOTS(setzero_pd)()));
        of_block(k, powers, block, power);
        for (int i = 0; i < powers; i++) ROOTS_STORE(rest, z + i * width + w, power[i]);
    }
    return !outside;
}

#else

JET_INLINE void compute_inverse_root_power(int k, int width, const double *a, double *restrict z)
{
    JET_IN_VECTORS
    for (int w = 0; w < width; w++) {
        double power = sqrt(a[w]);
        for (int i = 1; i < k; i += 2) power *= a[w];
        z[w] = 1 / power;
    }
}
#endif

JET_INLINE bool compute_inverse_half_powers(int k, int powers, int width, const double *a, double *restrict z)
{
#ifdef HAS_ROOTS
    return apply_in_vector_blocks(compute_inverse_root_powers, k, powers, width, a, z);
#else
    for (int p = 0; p < powers; p++, k -= 2, z += width) compute_inverse_root_power(k, width, a, z);
    return are_all_positive(width, a);
#endif
}

JET_INLINE bool compute_general_power(double exponent, int width, const double *a, double *restrict z)
{
#ifdef HAS_ROOTS
    if (exponent == 0.75 || exponent == -0.25 || exponent == -0.75 || exponent == -1.25)
        return apply_in_vector_blocks(compute_odd_quarter_power, (int)(4 * exponent), 1, width, a, z);
#endif
    if (fabs(4 * exponent) <= QUARTERS_MAX && 4 * exponent == floor(4 * exponent))
        compute_quarter_power((int)(4 * exponent), width, a, z);
    else jet_array_pow(exponent, width, a, z);
    return exponent == floor(exponent) ? are_all_nonzero(width, a) : are_all_positive(width, a);
}

/* Computes a power whose exponent is no constant for the compiler. It is a function of its own, so that
 * compute_inverse_half_powers need not save registers for it. */
JET_APART bool compute_variable_power(double exponent, int width, const double *a, double *restrict z)
{
    return compute_general_power(exponent, width, a, z);
}

static bool evaluate_pow(double exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)b;
    return exponent == -0.5      ? compute_inverse_half_powers(1, 1, width, a, z)
           : exponent == -1.5    ? compute_inverse_half_powers(3, 1, width, a, z)
           : exponent == -2.5    ? compute_inverse_half_powers(5, 1, width, a, z)
           : exponent == -3.5    ? compute_inverse_half_powers(7, 1, width, a, z)
           : JET_KNOWS(exponent) ? compute_general_power(exponent, width, a, z)
                                 : compute_variable_power(exponent, width, a, z);
}

/* The series rule computes z_k:
 * a z' = c a' z  =>  z_k = 1/(k a_0) sum_{j=1}^{k} (c j - (k-j)) a_j z_{k-j}.   O(N^2).
 * The term of a_k is separate, since a_k is known last; one operation then follows it. If k is a constant for the
 * compiler and a single number is computed, the other terms are (c+1) sum i a_i z_{k-i} - k sum a_i z_{k-i}. One vector
 * then holds both sums, and its factors made from a_i are the same for all k. */
#define POW_SERIES(V, S)                                                                                               \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        const V inverse = 1 / ((double)k * S(V, a, 0)), last = c * k * S(V, z, 0);                                     \
        if (JET_KNOWS(k) && sizeof(V) == sizeof(double)) {                                                             \
            jet_v2 both = {0};                                                                                         \
            JET_SUM(jet_v2, both, 1, k - 1, ((jet_v2){(c + 1) * (k - j), 1} * S(jet_v1, a, k - j)) * S(jet_v1, z, j)); \
            sum += both[0] - k * both[1];                                                                              \
        } else JET_SUM(V, sum, 1, k - 1, ((c + 1) * (k - j) - k) * S(V, a, k - j) * S(V, z, j));                       \
        JET_AT(V, z, k) =                                                                                              \
            JET_KNOWS(k) ? sum * inverse + last * inverse * S(V, a, k) : (sum + last * S(V, a, k)) * inverse;          \
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
 * The numbers that are known last, zbar_k and s_k, enter few operations. */
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
static jet record_pow_pullback(struct jet_node *z, jet zbar, int operand)
{
    (void)operand;
    return jet_mul(z->number, jet_mul(zbar, jet_pow(jet_from_node(z->a), z->number - 1)));
}

JET_RULE(pow, 1, W_NONE)
