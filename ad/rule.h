/* rule.h - Declares the rule of each operation: functions that compute its values, its series, and their tangents and
 * adjoints (docs/jets.md, sections 3 and 4). sweep.c has the table of rules, and calls them. Operations with similar
 * recurrences share a file rule_*.c.
 *
 * Series are normalised: x(s) = sum_k x_k s^k. The macros below make the loops of a rule from a body that is written
 * once, for a vector type V (vector.h). The body reads a series by a macro that is its parameter S. S is JET_OF, which
 * reads a vector, or JET_ONE_OF if the tangents of several directions belong to one series: it then reads one number,
 * and uses it for all directions. */
#ifndef TVI_AD_RULE_H
#define TVI_AD_RULE_H

#include "tape.h"
#include "vector.h"

/* [1] Powers with exponents k/4 or k/2 up to this size are products and square roots, not calls of pow (suite
 * elementary of build/check/ad). */
#define TAPE_POWER_MAX_EXPONENT 8 /* found: make devices */

/* In the rules, a is the first operand, b the second one, w the auxiliary series, and z the result. a_k is the
 * coefficient of order k of the series of a, da_k that of its tangent along a direction, and abar_k its adjoint: the
 * derivative of a scalar by a_k. */

/* Computes z_0 from a_0 and b_0, arrays of `width` numbers. The exponent is that of pow. Returns false if no power
 * series exists at one of the numbers. A NaN is allowed, and propagates to z. z overlaps neither a nor b. */
typedef bool jet_values_rule(double exponent, int width, const double *a, const double *b, double *restrict z);

/* The other rules work on all operations of a run, in blocks as tape.h defines them: x is the block of the series, dx
 * that of the tangents, and bar that of the adjoints. In a block of one lane, consecutive orders are `stride` numbers
 * apart. */

/* Computes z_k, k >= 1, from orders 0..k of a, b, w and orders 0..k-1 of z. */
typedef void jet_series_rule(const jet_run_of_operations *run, double *x, int k, size_t stride, int lanes);

/* Computes dz_k, k >= 0, from orders 0..k of a, b, w, z, da, db, dw and orders 0..k-1 of dz. x has one lane, and dx
 * has several. */
typedef void jet_tangent_rule(const jet_run_of_operations *run, const double *x, double *dx, int k, size_t stride,
                              int lanes);

/* Applies the transpose of the derivative of the series rule, for one lane and k = top, ..., 0 in turn. A rule does
 * this in one of two ways. It adds all that zbar_k, which is complete, contributes to the adjoints of orders 0..k of
 * a, b, w and 0..k-1 of z. Or it adds all that zbar of orders k..top contribute to the adjoints of order k; it then
 * stores intermediate numbers of its own in the place of zbar_k. */
typedef void jet_adjoint_rule(const jet_run_of_operations *run, const double *x, double *bar, int k, int top,
                              size_t stride);

/* Records the contribution of the node z, whose adjoint is zbar, to the adjoint of an operand: zbar times the partial
 * derivative of z by a (operand_index = 0) or b (operand_index = 1). */
typedef jet jet_pullback_rule(struct jet_node *z, jet zbar, int operand_index);

/* The orders of the auxiliary series w from which order k of z is computed. Values (order 0) do not need it. */
typedef enum {
    W_NONE,  /* The operation has no auxiliary series. */
    W_LOWER, /* Order k of z needs orders 0..k-1 of w. */
    W_SAME   /* Order k of z needs orders 0..k of w; only for operations with one operand. */
} jet_auxiliary_orders;

/* The rule of one operation. */
typedef struct {
    int operand_count; /* The number of operands of the operation, 1 or 2. */
    jet_auxiliary_orders auxiliary_series_orders_read;
    jet_values_rule *compute_values;
    jet_series_rule *compute_series_order;
    jet_tangent_rule *compute_tangents;
    jet_adjoint_rule *add_adjoints;
    jet_pullback_rule *record_pullback;
} jet_rule;

#define JET_RULE_OF(name) jet_rule_##name

/* The table of rules, indexed by jet_op. It has NULL for INPUT, CONST, PARAMETER and LINEAR, which need no
 * recurrence. MUL and SQR have no sweeps, since they become sums of products on a tape (sums.h); MUL has a value
 * rule, which folds numbers, and both have pullbacks. */
extern const jet_rule *const jet_rules[OP_COUNT];

/* Lists all rules in the order of jet_op, with the operation and the name of the rule. */
#define JET_RULE_LIST(ROW)                                                                                             \
    ROW(OP_MUL, mul)                                                                                                   \
    ROW(OP_SQR, sqr)                                                                                                   \
    ROW(OP_DIV, div)                                                                                                   \
    ROW(OP_SQRT, sqrt)                                                                                                 \
    ROW(OP_POW, pow)                                                                                                   \
    ROW(OP_HYPOT, hypot)                                                                                               \
    ROW(OP_ATAN2, atan2)                                                                                               \
    ROW(OP_EXP, exp)                                                                                                   \
    ROW(OP_SIN, sin)                                                                                                   \
    ROW(OP_COS, cos)                                                                                                   \
    ROW(OP_SINH, sinh)                                                                                                 \
    ROW(OP_COSH, cosh)                                                                                                 \
    ROW(OP_TAN, tan)                                                                                                   \
    ROW(OP_TANH, tanh)                                                                                                 \
    ROW(OP_SECH2, sech2)                                                                                               \
    ROW(OP_ERF, erf)                                                                                                   \
    ROW(OP_LOG, log)                                                                                                   \
    ROW(OP_ASIN, asin)                                                                                                 \
    ROW(OP_ACOS, acos)                                                                                                 \
    ROW(OP_ATAN, atan)                                                                                                 \
    ROW(OP_ASINH, asinh)                                                                                               \
    ROW(OP_ACOSH, acosh)                                                                                               \
    ROW(OP_ATANH, atanh)                                                                                               \
    ROW(OP_RADIUS, radius)
#ifndef JET_EMITTED
#define JET_DECLARE_RULE(op, name) extern const jet_rule JET_RULE_OF(name);
JET_RULE_LIST(JET_DECLARE_RULE)
#undef JET_DECLARE_RULE
#endif

/* Returns the run for a block of one lane that covers all operations and lanes of a run in a block of several lanes.
 * Both runs cover the same consecutive numbers. */
JET_INLINE jet_run_of_operations jet_flatten_run_lanes(const jet_run_of_operations *run, int lanes)
{
    return (jet_run_of_operations){.op = run->op,
                                   .operation_count = run->operation_count * lanes,
                                   .z = run->z * lanes,
                                   .a = run->a * lanes,
                                   .b = run->b * lanes,
                                   .w = run->w * lanes,
                                   .exponent = run->exponent};
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* Defines the function name_series from the body SERIES(V, S), which sets JET_AT(V, z, k), that is z_k. */
#define JET_SERIES_FRAME(name, SERIES)                                                                                 \
    static void name##_series(const jet_run_of_operations *run, double *x, int k, size_t slots, int lanes)             \
    {                                                                                                                  \
        const size_t each = (size_t)lanes, stride = slots * each;                                                      \
        const double c = run->exponent, *a = x + (size_t)run->a * each, *b = x + (size_t)run->b * each;                \
        const double *w = x + (size_t)run->w * each;                                                                   \
        double *z = x + (size_t)run->z * each;                                                                         \
        const int width = run->operation_count * lanes;                                                                \
        (void)c, (void)a, (void)b, (void)w;                                                                            \
        JET_BLOCKS(width, SERIES, JET_OF);                                                                             \
    }

/* Defines the function name_tangent from the body TANGENT(V, S), which sets JET_D_AT(V, dz, k), that is dz_k. With one
 * lane, its vectors go across the operations of the run; with several lanes, across the lanes of each operation. */
#define JET_TANGENT_FRAME(name, TANGENT)                                                                               \
    static void name##_tangent(const jet_run_of_operations *run, const double *x, double *dx, int k, size_t stride,    \
                               int lanes)                                                                              \
    {                                                                                                                  \
        const size_t each = (size_t)lanes, dstride = stride * each;                                                    \
        const double c = run->exponent, *a = x + run->a, *b = x + run->b, *w = x + run->w, *z = x + run->z;            \
        const double *da = dx + (size_t)run->a * each, *db = dx + (size_t)run->b * each;                               \
        const double *dw = dx + (size_t)run->w * each;                                                                 \
        double *dz = dx + (size_t)run->z * each;                                                                       \
        (void)c, (void)a, (void)b, (void)w, (void)z, (void)da, (void)db, (void)dw;                                     \
        if (lanes == 1) {                                                                                              \
            JET_BLOCKS(run->operation_count, TANGENT, JET_OF);                                                         \
            return;                                                                                                    \
        }                                                                                                              \
        for (int i = 0; i < run->operation_count; i++) {                                                               \
            JET_BLOCKS(lanes, TANGENT, JET_ONE_OF);                                                                    \
            a++, b++, w++, z++, da += each, db += each, dw += each, dz += each;                                        \
        }                                                                                                              \
    }

/* Defines the function name_adjoint, which adds the contributions of order k of a result z to the adjoints of its
 * operands a and b and of its auxiliary series w. It calls the body ADJOINT(V, S) for each vector type V; S reads a
 * coefficient of a series, and JET_AT(V, abar, j) is the adjoint of the coefficient of order j of a. */
#define JET_ADJOINT_FRAME(name, ADJOINT)                                                                               \
    static void name##_adjoint(const jet_run_of_operations *run, const double *x, double *bar, int k, int top,         \
                               size_t stride)                                                                          \
    {                                                                                                                  \
        const double c = run->exponent, *a = x + run->a, *b = x + run->b, *w = x + run->w, *z = x + run->z;            \
        double *abar = bar + run->a, *bbar = bar + run->b, *wbar = bar + run->w, *zbar = bar + run->z;                 \
        (void)c, (void)a, (void)b, (void)w, (void)z, (void)abar, (void)bbar, (void)wbar, (void)top;                    \
        JET_BLOCKS(run->operation_count, ADJOINT, JET_OF);                                                             \
    }

/* Defines the three functions of a rule from the bodies KIND_SERIES, KIND_TANGENT and KIND_ADJOINT. */
#define JET_FRAMES(name, KIND)                                                                                         \
    JET_SERIES_FRAME(name, KIND##_SERIES)                                                                              \
    JET_TANGENT_FRAME(name, KIND##_TANGENT)                                                                            \
    JET_ADJOINT_FRAME(name, KIND##_ADJOINT)

/* Defines the rule's row of the table. Generated code (emit.h) has no table. */
#ifndef JET_EMITTED
#define JET_RULE_ROW(name, ...) const jet_rule JET_RULE_OF(name) = {__VA_ARGS__};
#else
#define JET_RULE_ROW(name, ...)
#endif
#define JET_RULE(name, operands, auxiliary_orders)                                                                     \
    JET_RULE_ROW(name, operands, auxiliary_orders, evaluate_##name, name##_series, name##_tangent, name##_adjoint,     \
                 record_##name##_pullback)

#endif
