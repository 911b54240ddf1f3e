/* rule.h - what each operation does, in every kind of sweep. One operation a line of the table in rule.c; the rules of
 * a family share a file, rule_*.c, and within it a recurrence.
 *
 * Series are normalised: x(s) = sum_k x_k s^k. Coefficient k of a series starts at x + k * stride and is `width`
 * numbers wide: equal operations side by side, times lanes. A rule's loops are made by the frames below from a body
 * that is written for a vector type V (vector.h); where a series meets the lanes of a tangent, S reads it. */
#ifndef TVI_AD_RULE_H
#define TVI_AD_RULE_H

#include "graph.h"
#include "vector.h"

/* z_0 from a_0 (and b_0), width of each; c is the node's number. false where a power series does not exist; a NaN is no
 * offence, it goes on to the outputs. z overlaps neither a nor b. */
typedef bool jet_value_rule(double c, int width, const double *a, const double *b, double *restrict z);

/* z_k from orders 0..k of a (and b) and 0..k-1 of z, k >= 1. */
typedef void jet_series_rule(double c, int k, size_t stride, int width, const double *a, const double *b, double *z);

/* A run's one-lane series (coefficient k at a[k * stride]) with its tangents (at da + k * dstride, each member's lanes
 * side by side). */
typedef struct {
    double c;
    size_t stride, dstride;
    int count, lanes;
    const double *a, *b, *z, *da, *db;
    double *dz;
} jet_tangent;

/* dz_k from orders 0..k of a, b, da, db, 0..k of z and 0..k-1 of dz, k >= 0. */
typedef void jet_tangent_rule(const jet_tangent *x, int k);

/* A run with the adjoints of all its coefficients, in the same layout. */
typedef struct {
    double c;
    size_t stride;
    int width;
    const double *a, *b, *z;
    double *abar, *bbar, *zbar;
} jet_adjoint;

/* What zbar_k, which is complete, adds to abar, bbar of orders 0..k and zbar of orders 0..k-1, k >= 0: the transpose of
 * the derivative of the series rule. */
typedef void jet_adjoint_rule(const jet_adjoint *x, int k);

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

/* Indexed by jet_op; NULL for INPUT, CONST and LINEAR, whose work needs no recurrence. MUL has a value, for
 * numbers, and a pull only, SQR, which no numbers make, a pull: on a tape both are sums of products (sums.h). */
#define jet_rules JET_FOR_ISA(jet_rules)
extern const jet_rule *const jet_rules[OP_COUNT];

static inline jet_b_role jet_role_of_b(jet_op op) { return jet_rules[op] ? jet_rules[op]->b : B_NONE; }

extern const jet_rule JET_RULE_OF(mul), JET_RULE_OF(sqr), JET_RULE_OF(div), JET_RULE_OF(sqrt), JET_RULE_OF(pow),
    JET_RULE_OF(exp), JET_RULE_OF(sin), JET_RULE_OF(cos), JET_RULE_OF(sinh), JET_RULE_OF(cosh), JET_RULE_OF(tan),
    JET_RULE_OF(tanh), JET_RULE_OF(sech2), JET_RULE_OF(log), JET_RULE_OF(asin), JET_RULE_OF(acos), JET_RULE_OF(atan);

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* Defines name_series from SERIES(V, S), which sets JET_AT(V, z, k). */
#define JET_SERIES_FRAME(name, SERIES)                                                                                 \
    static void name##_series(double c, int k, size_t stride, int width, const double *a, const double *b, double *z)  \
    {                                                                                                                  \
        (void)a, (void)b, (void)c;                                                                                     \
        JET_BLOCKS(width, SERIES, JET_OF);                                                                             \
    }

/* Defines name_tangent from TANGENT(V, S), which sets JET_D_AT(V, dz, k): across the members of the run where there is
 * one lane, else across the lanes of each member. */
#define JET_TANGENT_FRAME(name, TANGENT)                                                                               \
    static void name##_tangent(const jet_tangent *x, int k)                                                            \
    {                                                                                                                  \
        const size_t stride = x->stride, dstride = x->dstride, lanes = (size_t)x->lanes;                               \
        const double c = x->c, *a = x->a, *b = x->b, *z = x->z, *da = x->da, *db = x->db;                              \
        double *dz = x->dz;                                                                                            \
        (void)c, (void)a, (void)b, (void)z, (void)da, (void)db;                                                        \
        if (lanes == 1) {                                                                                              \
            JET_BLOCKS(x->count, TANGENT, JET_OF);                                                                     \
            return;                                                                                                    \
        }                                                                                                              \
        for (int i = 0; i < x->count; i++, a++, b++, z++, da += lanes, db += lanes, dz += lanes)                       \
            JET_BLOCKS(x->lanes, TANGENT, JET_ONE_OF);                                                                 \
    }

/* Defines name_adjoint from ADJOINT(V, S), which adds to JET_AT(V, abar, j) and the like. */
#define JET_ADJOINT_FRAME(name, ADJOINT)                                                                               \
    static void name##_adjoint(const jet_adjoint *x, int k)                                                            \
    {                                                                                                                  \
        const size_t stride = x->stride;                                                                               \
        const double c = x->c, *a = x->a, *b = x->b, *z = x->z;                                                        \
        double *abar = x->abar, *bbar = x->bbar, *zbar = x->zbar;                                                      \
        (void)c, (void)a, (void)b, (void)z, (void)abar, (void)bbar;                                                    \
        JET_BLOCKS(x->width, ADJOINT, JET_OF);                                                                         \
    }

/* All three, from KIND_SERIES, KIND_TANGENT and KIND_ADJOINT. */
#define JET_FRAMES(name, KIND)                                                                                         \
    JET_SERIES_FRAME(name, KIND##_SERIES)                                                                              \
    JET_TANGENT_FRAME(name, KIND##_TANGENT)                                                                            \
    JET_ADJOINT_FRAME(name, KIND##_ADJOINT)

/* The line of the table. */
#define JET_RULE(name, role)                                                                                           \
    const jet_rule JET_RULE_OF(name) = {role, name##_value, name##_series, name##_tangent, name##_adjoint, name##_pull};

#endif
