/* rule_product.c - Defines the rule of quotients. Also defines how products and squares are differentiated when a
 * derivative is recorded as operations of its own, and how they are computed for constants (docs/jets.md, section 4).
 * Tapes contain products and squares as sums of products, which sum_products.c computes. */
#include "rule.h"

/* ---- z = a b ----------------------------------------------------------------------------------------------------- */

static bool evaluate_mul(double unused_exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)unused_exponent;
    for (int w = 0; w < width; w++) z[w] = a[w] * b[w];
    return true;
}

static jet record_mul_pullback(struct jet_node *z, jet zbar, int operand_index)
{
    return jet_mul(zbar, jet_from_node(operand_index == 0 ? z->b : z->a));
}

JET_RULE_ROW(mul, .operand_count = 2, .compute_values = evaluate_mul, .record_pullback = record_mul_pullback)

/* ---- z = a^2 ----------------------------------------------------------------------------------------------------- */

/* The pullback is 2 a zbar. If zbar is c + k a with numbers c and k, as for a^3 = a z, it is recorded as the sum 2 c a
 * + 2 k z, which needs no product, since z = a^2 is recorded already. */
static jet record_sqr_pullback(struct jet_node *z, jet zbar, int operand_index)
{
    (void)operand_index;
    const jet a = jet_from_node(z->a);
    const struct jet_node *factor = zbar.node;
    if (!factor || factor->op != OP_LINEAR || factor->count != 1 || factor->terms[0].node != z->a)
        return jet_mul(2, jet_mul(zbar, a));
    const double twice[] = {2 * factor->number, 2 * factor->terms[0].coefficient};
    return jet_record_linear_combination(2, twice, (const jet[]){a, jet_from_node(z)});
}

JET_RULE_ROW(sqr, .operand_count = 1, .record_pullback = record_sqr_pullback)

/* ---- z = a / b,  b_0 != 0 ---------------------------------------------------------------------------------------- */

static bool evaluate_div(double unused_exponent, int width, const double *a, const double *b, double *restrict z)
{
    (void)unused_exponent;
    int outside = 0;
    for (int w = 0; w < width; w++) {
        outside |= b[w] == 0;
        z[w] = a[w] / b[w];
    }
    return !outside;
}

/* The series rule computes z_k:
 * a = z b  =>  z_k = (a_k - sum_{j=1}^{k} b_j z_{k-j}) / b_0.   O(N^2). */
#define DIV_SERIES(V, S)                                                                                               \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        JET_SUM(V, sum, 1, k, S(V, b, j) * S(V, z, k - j));                                                            \
        JET_AT(V, z, k) = (S(V, a, k) - sum) / S(V, b, 0);                                                             \
    }

/* The tangent rule computes dz_k:
 * dz_k = (da_k - sum_{j=0}^{k} z_j db_{k-j} - sum_{j=1}^{k} b_j dz_{k-j}) / b_0. */
#define DIV_TANGENT(V, S)                                                                                              \
    {                                                                                                                  \
        V sum = S(V, z, 0) * JET_D_OF(V, db, k);                                                                       \
        JET_SUM(V, sum, 1, k, S(V, z, j) * JET_D_OF(V, db, k - j) + S(V, b, j) * JET_D_OF(V, dz, k - j));              \
        JET_D_AT(V, dz, k) = (JET_D_OF(V, da, k) - sum) / S(V, b, 0);                                                  \
    }

/* The adjoint rule updates the adjoints:
 * With s = zbar_k / b_0:  abar_k += s,  bbar_j -= s z_{k-j} (j = 0..k),  zbar_{k-j} -= s b_j (j = 1..k). */
#define DIV_ADJOINT(V, S)                                                                                              \
    {                                                                                                                  \
        const V s = S(V, zbar, k) / S(V, b, 0);                                                                        \
        JET_AT(V, abar, k) += s;                                                                                       \
        JET_EACH(0, k, JET_AT(V, bbar, j) -= s * S(V, z, k - j));                                                      \
        JET_EACH(1, k, JET_AT(V, zbar, k - j) -= s * S(V, b, j));                                                      \
    }

JET_FRAMES(div, DIV)

/* The derivatives are dz/da = 1 / b and dz/db = -z / b. */
static jet record_div_pullback(struct jet_node *z, jet zbar, int operand_index)
{
    const jet quotient = jet_div(zbar, jet_from_node(z->b));
    return operand_index == 0 ? quotient : jet_neg(jet_mul(quotient, jet_from_node(z)));
}

JET_RULE(div, 2, W_NONE)
