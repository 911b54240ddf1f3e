/* rule_power.c - Defines the rules of powers with a constant exponent. */
#include "elementary.h"
#include "roots.h"
#include "rule.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* ---- z = sqrt a,  a_0 > 0 ---------------------------------------------------------------------------------------- */

static bool sqrt_value(double c, int width, const double *a, const double *b, double *restrict z)
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
#define SQRT_SERIES(V, S)                                                                                              \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k - 1, S(V, z, j) * S(V, z, k - j));                                                        \
        JET_AT(V, z, k) = (S(V, a, k) - sum) / (2.0 * S(V, z, 0));                                                     \
    }

/* dz_k = (da_k - 2 sum_{j=1}^{k} z_j dz_{k-j}) / (2 z_0). */
#define SQRT_TANGENT(V, S)                                                                                             \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k, S(V, z, j) * JET_D_OF(V, dz, k - j));                                                    \
        JET_D_AT(V, dz, k) = (JET_D_OF(V, da, k) - 2.0 * sum) / (2.0 * S(V, z, 0));                                    \
    }

/* s_k = (zbar_k - 2 sum_{j=k+1}^{top} s_j z_{j-k}) / (2 z_0), in the place of zbar_k;  abar_k += s_k. */
#define SQRT_ADJOINT(V, S)                                                                                             \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        for (int j = top; j > k; j--) sum += S(V, zbar, j) * S(V, z, j - k);                                           \
        const V s = (S(V, zbar, k) - 2.0 * sum) / (2.0 * S(V, z, 0));                                                  \
        JET_AT(V, zbar, k) = s;                                                                                        \
        JET_ADD_TO(V, abar, 0, s);                                                                                     \
    }

JET_FRAMES(sqrt, SQRT)

/* dz/da = 1 / (2 z). */
static jet sqrt_pull(struct jet_node *z, jet zbar, int which)
{
    (void)which;
    return jet_div(jet_mul(0.5, zbar), jet_of_node(z));
}

JET_RULE(sqrt, 1, W_NONE)

/* ---- z = a^c,  a_0 != 0 where c is an integer, else a_0 > 0 ------------------------------------------------------ */

enum { QUARTERS_MAX = 32 };

/* a^(quarters/4) by multiplications and square roots, which are faster than pow. */
static void power_by_quarters(int quarters, int width, const double *a, double *restrict z)
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

static bool is_positive(int width, const double *a)
{
    int outside = 0;
    JET_IN_VECTORS
    for (int w = 0; w < width; w++) outside |= a[w] <= 0;
    return !outside;
}

static bool is_nonzero(int width, const double *a)
{
    int outside = 0;
    for (int w = 0; w < width; w++) outside |= a[w] == 0;
    return !outside;
}

/* Computes a^(-k/2), k = 7, 5, 3, 1, or the last few of them: the potential of gravity and its derivatives. The
 * compiler knows k, and how many powers there are. Each power takes `width` numbers of z. */
#ifdef HAS_ROOTS
typedef struct {
    roots a, bounded, y, square, e;
} inverse_root;

/* Computes y near a^(-1/2), with so few bits that y^3 is exact, and e = 1 - a y^2, |e| < 2^-12. */
JET_INLINE inverse_root near_inverse_root(roots a)
{
    const roots bounded = OF_ROOTS(min_pd)(OF_ROOTS(set1_pd)(DBL_MAX), a); /* a NaN stays */
    const roots y = ROOTS_BITS(roots_estimate(bounded), ~((1LL << 36) - 1));
    const roots square = y * y, e = OF_ROOTS(fnmadd_pd)(bounded, square, OF_ROOTS(set1_pd)(1));
    return (inverse_root){a, bounded, y, square, e};
}

/* Computes
 *    a^(-k/2) = y^k (1 - e)^(-k/2) = y^k (1 + k/2 e + k (k+2)/8 e^2 + k (k+2) (k+4)/48 e^3 + ...),
 * which is rounded once for k = 1, 3. A root, a product and a quotient round three times and take twice as long. If y^2
 * or a is infinite, y^k is infinite or 0; k = 1 then divides by the root, as it does if y is not near. */
JET_INLINE roots inverse_of_roots(int k, inverse_root root)
{
    const double c1 = k / 2.0, c2 = c1 * (k + 2) / 4, c3 = c2 * (k + 4) / 6, c4 = c3 * (k + 6) / 8;
    const roots e = root.e, squared = e * e, series = (c1 + e * c2) + squared * (c3 + e * c4);
    roots power = root.y;
    for (int i = 1; i < k; i += 2) power *= root.square;
    const roots_mask finite = ROOTS_WHERE(power, _CMP_NEQ_UQ, OF_ROOTS(set1_pd)(INFINITY));
    const roots rounded = ROOTS_CHOOSE(finite, OF_ROOTS(fmadd_pd)(power * e, series, power), power);
    if (k > 1) return rounded;
    const roots near = ROOTS_CHOOSE(ROOTS_WHERE(root.a, _CMP_EQ_OQ, root.bounded), squared, OF_ROOTS(set1_pd)(1));
    const roots_mask usual = ROOTS_WHERE(near, _CMP_LT_OQ, OF_ROOTS(set1_pd)(0x1p-20));
    if (ROOTS_ARE(usual) == (1 << ROOTS) - 1) return rounded;
    return ROOTS_CHOOSE(usual, rounded, 1 / OF_ROOTS(sqrt_pd)(root.a));
}

/* Computes `powers` powers of a block, from the first one on. */
enum { INVERSE_ROOTS = 4 };
typedef void powers_of_block(int k, int powers, roots a, roots power[]);

JET_INLINE void inverse_roots(int k, int powers, roots a, roots power[])
{
    const inverse_root root = near_inverse_root(a);
    for (int i = 0; i < powers; i++) power[i] = inverse_of_roots(k - 2 * i, root);
}

/* a^(quarters/4) for 3, -1, -3 and -5 quarters: with r = a^(-1/2), whose root is a^(-1/4), it is a^i r^j a^(-1/4). */
JET_INLINE void odd_quarters(int quarters, int powers, roots a, roots power[])
{
    const int ups = (quarters + 3) / 4;
    const roots bounded = ups > 0 ? OF_ROOTS(min_pd)(OF_ROOTS(set1_pd)(DBL_MAX), a) : a;
    const roots r = inverse_of_roots(1, near_inverse_root(bounded));
    (void)powers;
    *power = OF_ROOTS(sqrt_pd)(r);
    for (int i = quarters; i < -1; i += 2) *power *= r;
    for (int i = 0; i < ups; i++) *power *= a;
}

JET_INLINE bool in_blocks(powers_of_block *of_block, int k, int powers, int width, const double *a, double *restrict z)
{
    roots power[INVERSE_ROOTS];
    int outside = 0, w = 0;
    for (; w + ROOTS <= width; w += ROOTS) {
        const roots block = OF_ROOTS(loadu_pd)(a + w);
        outside |= ROOTS_ARE(ROOTS_WHERE(block, _CMP_LE_OQ, OF_ROOTS(setzero_pd)()));
        of_block(k, powers, block, power);
        for (int i = 0; i < powers; i++) OF_ROOTS(storeu_pd)(z + i * width + w, power[i]);
    }
    if (w + 1 == width) { /* a single number is not stored for a vector to wait for */
        const roots block = OF_ROOTS(set1_pd)(a[w]);
        outside |= a[w] <= 0;
        of_block(k, powers, block, power);
        for (int i = 0; i < powers; i++) z[i * width + w] = power[i][0];
    } else if (w < width) {
        const roots_mask rest = ROOTS_FIRST(width - w);
        const roots block = ROOTS_CHOOSE(rest, ROOTS_LOAD(rest, a + w), OF_ROOTS(set1_pd)(1));
        outside |= ROOTS_ARE(ROOTS_WHERE(block, _CMP_LE_OQ, OF_ROOTS(setzero_pd)()));
        of_block(k, powers, block, power);
        for (int i = 0; i < powers; i++) ROOTS_STORE(rest, z + i * width + w, power[i]);
    }
    return !outside;
}

#else

JET_INLINE void gravity_by_root(int k, int width, const double *a, double *restrict z)
{
    JET_IN_VECTORS
    for (int w = 0; w < width; w++) {
        double power = sqrt(a[w]);
        for (int i = 1; i < k; i += 2) power *= a[w];
        z[w] = 1 / power;
    }
}
#endif

JET_INLINE bool gravity(int k, int powers, int width, const double *a, double *restrict z)
{
#ifdef HAS_ROOTS
    return in_blocks(inverse_roots, k, powers, width, a, z);
#else
    for (int p = 0; p < powers; p++, k -= 2, z += width) gravity_by_root(k, width, a, z);
    return is_positive(width, a);
#endif
}

JET_INLINE bool other_power(double c, int width, const double *a, double *restrict z)
{
#ifdef HAS_ROOTS
    if (c == 0.75 || c == -0.25 || c == -0.75 || c == -1.25)
        return in_blocks(odd_quarters, (int)(4 * c), 1, width, a, z);
#endif
    if (fabs(4 * c) <= QUARTERS_MAX && 4 * c == floor(4 * c)) power_by_quarters((int)(4 * c), width, a, z);
    else jet_all_pow(c, width, a, z);
    return c == floor(c) ? is_nonzero(width, a) : is_positive(width, a);
}

/* A power that the compiler does not know, in a function of its own, so that gravity does not pay for the registers of
 * others. */
JET_APART bool any_power(double c, int width, const double *a, double *restrict z)
{
    return other_power(c, width, a, z);
}

static bool pow_value(double c, int width, const double *a, const double *b, double *restrict z)
{
    (void)b;
    return c == -0.5      ? gravity(1, 1, width, a, z)
           : c == -1.5    ? gravity(3, 1, width, a, z)
           : c == -2.5    ? gravity(5, 1, width, a, z)
           : c == -3.5    ? gravity(7, 1, width, a, z)
           : JET_KNOWS(c) ? other_power(c, width, a, z)
                          : any_power(c, width, a, z);
}

bool jet_inverse_roots(const jet_run *run, int powers, double *x, int lanes)
{
    const int width = run->count * lanes;
    const double *a = x + (size_t)run->a * (size_t)lanes;
    double *z = x + (size_t)run->z * (size_t)lanes;
    return powers == 2   ? gravity(3, 2, width, a, z)
           : powers == 3 ? gravity(5, 3, width, a, z)
                         : gravity(7, 4, width, a, z);
}

/* a z' = c a' z  =>  z_k = 1/(k a_0) sum_{j=1}^{k} (c j - (k-j)) a_j z_{k-j}.   O(N^2). The term with a_k, which is
 * known last, takes one operation. If the compiler knows all orders of one number, the other terms are (c+1) sum i a_i
 * z_{k-i} - k sum a_i z_{k-i} in one vector, and the two numbers that it has of a_i serve all k. */
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

/* k a_0 dz_k = sum_{j=1}^{k} (c j - (k-j)) (a_j dz_{k-j} + z_{k-j} da_j) - k z_k da_0;   dz_0 = c z_0 / a_0 da_0. */
#define POW_TANGENT(V, S)                                                                                              \
    {                                                                                                                  \
        const double order = k > 0 ? k : 1;                                                                            \
        V sum = (k > 0 ? -k : c) * S(V, z, k) * JET_D_OF(V, da, 0);                                                    \
        JET_SUM(V, sum, 1, k,                                                                                          \
                ((c + 1) * j - k) * (S(V, a, j) * JET_D_OF(V, dz, k - j) + S(V, z, k - j) * JET_D_OF(V, da, j)));      \
        JET_D_AT(V, dz, k) = sum * (1 / (order * S(V, a, 0)));                                                         \
    }

/* s_k = (zbar_k + sum_{j=k+1}^{top} (c (j-k) - k) s_j a_{j-k}) / (k a_0), in the place of zbar_k;
 * abar_k += sum_{j=k}^{top} (c k - (j-k)) s_j z_{j-k}.   For k = 0 the factor k is 1, and that of s_0 z_0 is c. Numbers
 * that are known last enter few operations. */
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
        JET_ADD_TO(V, abar, 0, of_a + c * (k > 0 ? k : 1) * s * S(V, z, 0));                                           \
    }

JET_FRAMES(pow, POW)

/* dz/da = c a^(c-1). */
static jet pow_pull(struct jet_node *z, jet zbar, int which)
{
    (void)which;
    return jet_mul(z->number, jet_mul(zbar, jet_pow(jet_of_node(z->a), z->number - 1)));
}

JET_RULE(pow, 1, W_NONE)
