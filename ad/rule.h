/* rule.h - Declares what each operation does in every kind of sweep. Each operation is a line of the table in rule.c.
 * The rules of a family share a file, rule_*.c, and within it a recurrence.
 *
 * Series are normalised: x(s) = sum_k x_k s^k. The frames below make a rule's loops from a body that is written for a
 * vector type V (vector.h). S reads a series that meets the lanes of a tangent. */
#ifndef TVI_AD_RULE_H
#define TVI_AD_RULE_H

#include "tape.h"
#include "vector.h"

/* In the rules below a is the operand, b the second one and w the partner, if the operation has them. Other rules leave
 * these alone. */

/* Computes z_0 from a_0 (and b_0), width numbers each; c is the node's number. Returns false if a power series does not
 * exist. A NaN is allowed, and goes on to the outputs. z overlaps neither a nor b. */
typedef bool jet_value_rule(double c, int width, const double *a, const double *b, double *restrict z);

/* The other rules work on the members of a run, in blocks as the sweeps have them (tape.h), whose orders are `stride`
 * numbers apart for one lane. */

/* Computes z_k from orders 0..k of a, b, w and 0..k-1 of z, k >= 1. */
typedef void jet_series_rule(const jet_run *run, double *x, int k, size_t stride, int lanes);

/* Computes dz_k from orders 0..k of a, b, w, da, db, dw, 0..k of z and 0..k-1 of dz, k >= 0; x has one lane, dx
 * several. */
typedef void jet_tangent_rule(const jet_run *run, const double *x, double *dx, int k, size_t stride, int lanes);

/* Applies the transpose of the derivative of the series rule, for k = top, ..., 0. It adds either what zbar_k, which is
 * complete, contributes to abar, bbar, wbar of orders 0..k and zbar of orders 0..k-1; or all that zbar of orders k..top
 * contribute to order k, and then the rule keeps its own numbers in the place of zbar_k from there on. It has one
 * lane. */
typedef void jet_adjoint_rule(const jet_run *run, const double *x, double *bar, int k, int top, size_t stride);

/* Records what z-bar adds to the adjoint of z's operand a (which = 0) or b (which = 1). */
typedef jet jet_pull_rule(struct jet_node *z, jet zbar, int which);

/* The orders of the partner that order k of z reads. No rule reads it for values. */
typedef enum {
    W_NONE,  /* there is none */
    W_LOWER, /* orders below k only */
    W_SAME   /* order k too, one operand */
} jet_partner_role;

typedef struct {
    int operands; /* 1 or 2 */
    jet_partner_role partner;
    jet_value_rule *value;
    jet_series_rule *series;
    jet_tangent_rule *tangent;
    jet_adjoint_rule *adjoint;
    jet_pull_rule *pull;
} jet_rule;

/* Names of what is compiled once for each instruction set. */
#ifndef JET_ISA
#define JET_ISA base
#endif
#define JET_PASTE_NOW(name, isa) name##_##isa
#define JET_PASTE(name, isa)     JET_PASTE_NOW(name, isa)
#define JET_FOR_ISA(name)        JET_PASTE(name, JET_ISA)
#define JET_RULE_OF(name)        JET_FOR_ISA(jet_rule_##name)

/* The table of rules, indexed by jet_op; NULL for INPUT, CONST and LINEAR, whose work needs no recurrence. MUL has only
 * a value, for numbers, and a pull. SQR, which no numbers make, has a pull. On a tape both are sums of products
 * (sums.h). */
#define jet_rules JET_FOR_ISA(jet_rules)
extern const jet_rule *const jet_rules[OP_COUNT];

/* Computes the values of two runs together (jet_run.together), which costs little more than those of one. */
#define jet_sine_cosine JET_FOR_ISA(jet_sine_cosine)
void jet_sine_cosine(const jet_run *sine, const jet_run *cosine, double *x, int lanes);
/* Computes the values of up to four powers together, with the same bits as one by one. */
#define jet_inverse_roots JET_FOR_ISA(jet_inverse_roots)
bool jet_inverse_roots(const jet_run *run, int powers, double *x, int lanes);

/* Every rule and its row of the table, in the order of jet_op. */
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
    ROW(OP_ATANH, atanh)
#ifndef JET_EMITTED
#define JET_DECLARE_RULE(op, name) extern const jet_rule JET_RULE_OF(name);
JET_RULE_LIST(JET_DECLARE_RULE)
#undef JET_DECLARE_RULE
#endif

/* Tells whether the operation has a value at positive numbers alone. */
static inline bool jet_needs_positive(const jet_run *run)
{
    return run->op == OP_SQRT || run->op == OP_LOG || (run->op == OP_POW && run->c != JET_FLOOR(run->c));
}

/* Makes a run of one lane of a run of several, whose members and lanes stand side by side. */
JET_INLINE jet_run jet_flatten_lanes(const jet_run *run, int lanes)
{
    return (jet_run){.op = run->op,
                     .count = run->count * lanes,
                     .z = run->z * lanes,
                     .a = run->a * lanes,
                     .b = run->b * lanes,
                     .w = run->w * lanes,
                     .c = run->c};
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* Defines name_series from SERIES(V, S), which sets JET_AT(V, z, k). */
#define JET_SERIES_FRAME(name, SERIES)                                                                                 \
    static void name##_series(const jet_run *run, double *x, int k, size_t slots, int lanes)                           \
    {                                                                                                                  \
        const size_t each = (size_t)lanes, stride = slots * each;                                                      \
        const double c = run->c, *a = x + (size_t)run->a * each, *b = x + (size_t)run->b * each;                       \
        const double *w = x + (size_t)run->w * each;                                                                   \
        double *z = x + (size_t)run->z * each;                                                                         \
        const int width = run->count * lanes;                                                                          \
        (void)c, (void)a, (void)b, (void)w;                                                                            \
        JET_BLOCKS(width, SERIES, JET_OF);                                                                             \
    }

/* Defines name_tangent from TANGENT(V, S), which sets JET_D_AT(V, dz, k). With one lane it goes across the members of
 * the run, otherwise across the lanes of each member. */
#define JET_TANGENT_FRAME(name, TANGENT)                                                                               \
    static void name##_tangent(const jet_run *run, const double *x, double *dx, int k, size_t stride, int lanes)       \
    {                                                                                                                  \
        const size_t each = (size_t)lanes, dstride = stride * each;                                                    \
        const double c = run->c, *a = x + run->a, *b = x + run->b, *w = x + run->w, *z = x + run->z;                   \
        const double *da = dx + (size_t)run->a * each, *db = dx + (size_t)run->b * each;                               \
        const double *dw = dx + (size_t)run->w * each;                                                                 \
        double *dz = dx + (size_t)run->z * each;                                                                       \
        (void)c, (void)a, (void)b, (void)w, (void)z, (void)da, (void)db, (void)dw;                                     \
        if (lanes == 1) {                                                                                              \
            JET_BLOCKS(run->count, TANGENT, JET_OF);                                                                   \
            return;                                                                                                    \
        }                                                                                                              \
        for (int i = 0; i < run->count; i++) {                                                                         \
            JET_BLOCKS(lanes, TANGENT, JET_ONE_OF);                                                                    \
            a++, b++, w++, z++, da += each, db += each, dw += each, dz += each;                                        \
        }                                                                                                              \
    }

/* bar_k += x, or bar_k = x if nothing is there yet. bar is the adjoint of an operand of the run: operand 0 is a, and
 * the factors of term t are operands 2 t and 2 t + 1. */
#define JET_ADD_TO(V, bar, operand, x)                                                                                 \
    do {                                                                                                               \
        if (JET_IS_FRESH(run, operand)) JET_AT(V, bar, k) = (x);                                                       \
        else JET_AT(V, bar, k) += (x);                                                                                 \
    } while (0)
#ifdef JET_EMITTED
#define JET_IS_FRESH(run, operand) ((run)->fresh >> (operand)&1)
#else
#define JET_IS_FRESH(run, operand) false
#endif

/* Defines name_adjoint from ADJOINT(V, S), which adds to JET_AT(V, abar, j) and the like. */
#define JET_ADJOINT_FRAME(name, ADJOINT)                                                                               \
    static void name##_adjoint(const jet_run *run, const double *x, double *bar, int k, int top, size_t stride)        \
    {                                                                                                                  \
        const double c = run->c, *a = x + run->a, *b = x + run->b, *w = x + run->w, *z = x + run->z;                   \
        double *abar = bar + run->a, *bbar = bar + run->b, *wbar = bar + run->w, *zbar = bar + run->z;                 \
        (void)c, (void)a, (void)b, (void)w, (void)z, (void)abar, (void)bbar, (void)wbar, (void)top;                    \
        JET_BLOCKS(run->count, ADJOINT, JET_OF);                                                                       \
    }

/* Defines all three from KIND_SERIES, KIND_TANGENT and KIND_ADJOINT. */
#define JET_FRAMES(name, KIND)                                                                                         \
    JET_SERIES_FRAME(name, KIND##_SERIES)                                                                              \
    JET_TANGENT_FRAME(name, KIND##_TANGENT)                                                                            \
    JET_ADJOINT_FRAME(name, KIND##_ADJOINT)

/* Defines the row of the table; generated code (emit.h) has no table. */
#ifndef JET_EMITTED
#define JET_RULE_ROW(name, ...) const jet_rule JET_RULE_OF(name) = {__VA_ARGS__};
#else
#define JET_RULE_ROW(name, ...)
#endif
#define JET_RULE(name, operands, partner)                                                                              \
    JET_RULE_ROW(name, operands, partner, name##_value, name##_series, name##_tangent, name##_adjoint, name##_pull)

#endif
