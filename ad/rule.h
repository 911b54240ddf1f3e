/* rule.h - what each operation does, in every kind of sweep. One rule a line of the table in rule.c; the rules of a
 * family share a file, rule_*.c, and within it a recurrence.
 *
 * Series are normalised: x(s) = sum_k x_k s^k. Coefficient k of a series starts at x + k * stride and is `width` numbers
 * wide: equal operations side by side, times lanes. */
#ifndef TVI_AD_RULE_H
#define TVI_AD_RULE_H

#include "graph.h"

/* z_0 from a_0 (and b_0), width of each; c is the node's number. false where a power series does not exist; a NaN is no
 * offence, it goes on to the outputs. */
typedef bool jet_value_rule(double c, int width, const double *a, const double *b, double *z);

/* z_k from orders 0..k of a (and b) and 0..k-1 of z, k >= 1. */
typedef void jet_series_rule(double c, int k, size_t stride, int width, const double *a, const double *b, double *z);

/* One member's scalar series (coefficient k at a[k * stride]) with its tangents (at da + k * dstride, lanes wide). */
typedef struct {
    double c;
    size_t stride, dstride;
    int lanes;
    const double *a, *b, *z, *da, *db;
    double *dz;
} jet_tangent;

/* dz_k from orders 0..k of a, b, da, db, 0..k of z and 0..k-1 of dz, k >= 0. */
typedef void jet_tangent_rule(const jet_tangent *x, int k);

/* Symbolic: what z-bar adds to the adjoint of z's operand a (which = 0) or b (which = 1). */
typedef jet jet_pull_rule(struct jet_node *z, jet zbar, int which);

typedef enum {
    B_NONE,          /* there is no b                                               */
    B_OPERAND,       /* b is read at the order being computed                       */
    B_PARTNER,       /* b is read at lower orders only, and not at all for values   */
    B_PARTNER_SERIES /* b is read at the order being computed, but not for values   */
} jet_b_role;

typedef struct {
    jet_b_role b;
    jet_value_rule *value;
    jet_series_rule *series;
    jet_tangent_rule *tangent;
    jet_pull_rule *pull;
} jet_rule;

/* Indexed by jet_op; empty for INPUT, CONST and LINEAR, whose work needs no recurrence (see sweep.c). */
extern const jet_rule jet_rules[OP_COUNT];

/* The rules, by family. */
#define JET_DECLARE_RULES(name)                                                                                        \
    jet_value_rule jet_##name##_value;                                                                                 \
    jet_series_rule jet_##name##_series;                                                                               \
    jet_tangent_rule jet_##name##_tangent;                                                                             \
    jet_pull_rule jet_##name##_pull;
JET_DECLARE_RULES(mul)
JET_DECLARE_RULES(sqr)
JET_DECLARE_RULES(div)
JET_DECLARE_RULES(sqrt)
JET_DECLARE_RULES(pow)
JET_DECLARE_RULES(exp)
JET_DECLARE_RULES(sin)
JET_DECLARE_RULES(cos)
JET_DECLARE_RULES(sinh)
JET_DECLARE_RULES(cosh)
JET_DECLARE_RULES(tan)
JET_DECLARE_RULES(tanh)
JET_DECLARE_RULES(sech2)
JET_DECLARE_RULES(log)
JET_DECLARE_RULES(asin)
JET_DECLARE_RULES(acos)
JET_DECLARE_RULES(atan)
#undef JET_DECLARE_RULES

#endif
